"""Trajectory tracking: every law of the course under one name.

The topics have a module each: `dfl` (dynamic feedback linearization and its linear baseline), `rivals` (Kanayama,
PID, sliding mode), `lqr`, `mpc`, `observers` (derivatives of measured positions), `laws` (the compiled
steps), `tracker` (the controller object) and `loop` (the closed loop with disturbances).
"""
# ruff: noqa: F403

from fuzzynav.dfl import *
from fuzzynav.loop import *
from fuzzynav.lqr import *
from fuzzynav.mpc import *
from fuzzynav.observers import *
from fuzzynav.rivals import *
from fuzzynav.tracker import *
