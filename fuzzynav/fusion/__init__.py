"""Plan and react: a global path, a local window among moving obstacles, and what keeps both safe (chapter 07)."""

from fuzzynav.fusion.task import Method, Task
from fuzzynav.fusion.tracks import Tracker, TrackParams, Tracks, kalman_step

__all__ = ["Method", "Task", "TrackParams", "Tracker", "Tracks", "kalman_step"]
