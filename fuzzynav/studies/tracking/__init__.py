"""Studies of trajectory tracking (chapter 04)."""
