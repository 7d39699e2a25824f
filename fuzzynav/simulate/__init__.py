"""The one closed loop and the record it leaves (chapters 04 and 06)."""

from fuzzynav.simulate.disturbance import UNDISTURBED, Disturbance
from fuzzynav.simulate.loop import (
    IDEAL,
    STATUSES,
    Loop,
    Playback,
    Run,
    Sensing,
    run,
    stands_free,
)

__all__ = [
    "UNDISTURBED",
    "Disturbance",
    "IDEAL",
    "Loop",
    "Playback",
    "Run",
    "STATUSES",
    "Sensing",
    "run",
    "stands_free",
]
