"""Fuzzy-APF: obstacles that the paper shows without places, its counts, and traps (chapter 09)."""
