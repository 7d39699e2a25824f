"""The one closed loop and the record it leaves (chapters 04 and 06)."""

from fuzzynav.simulate.disturbance import UNDISTURBED, Disturbance
from fuzzynav.simulate.loop import IDEAL_LASER, Loop, Playback, run, stands_free
from fuzzynav.simulate.record import STATUSES, Run

__all__ = ["IDEAL_LASER", "STATUSES", "UNDISTURBED", "Disturbance", "Loop", "Playback", "Run", "run", "stands_free"]
