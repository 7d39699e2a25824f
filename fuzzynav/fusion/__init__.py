"""Plan and react: a global path, a local window among moving obstacles, and what keeps both safe (chapter 07)."""

from fuzzynav.fusion.task import Method, Task

__all__ = ["Method", "Task"]
