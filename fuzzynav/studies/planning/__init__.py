"""Studies of global planning (chapter 05)."""
