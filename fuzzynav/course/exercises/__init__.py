"""The exercises of every chapter, with their checks and hints."""
