"""Trajectory tracking: every law of the course under one name.

The topics have a module each: `dfl` (dynamic feedback linearization and its linear baseline), `rivals` (Kanayama,
PID, sliding mode), `lqr`, `mpc`, `observers` (derivatives of measured positions), `laws` (the compiled
steps), `tracker` (the controller object) and `loop` (the closed loop with disturbances).
"""
# ruff: noqa: F403

from fuzzynav.tracking.dfl import *
from fuzzynav.tracking.follow import *
from fuzzynav.tracking.laws import *
from fuzzynav.tracking.lqr import *
from fuzzynav.tracking.mpc import *
from fuzzynav.tracking.observers import *
from fuzzynav.tracking.tracker import *
