"""Studies of the dynamic window (chapter 06)."""
