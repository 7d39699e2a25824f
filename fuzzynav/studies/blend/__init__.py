"""Studies of the fuzzy blend (chapter 08)."""
