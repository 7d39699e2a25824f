"""Trajectory tracking (chapter 04): `Tracker(reference, law)`, the laws, and `follow`, which drives them.

The topics have a file each: `dfl` (dynamic feedback linearization and its linear baseline), `laws` (Kanayama, PID,
sliding mode), `lqr`, `mpc`, `observers` (derivatives of measured positions), `law` (what a law is), `tracker` (the
controller object), `driving` (the closed loop with disturbances) and `kernels` (the compiled steps).
"""
# ruff: noqa: F403

from fuzzynav.tracking.dfl import *
from fuzzynav.tracking.driving import *
from fuzzynav.tracking.law import *
from fuzzynav.tracking.laws import *
from fuzzynav.tracking.lqr import *
from fuzzynav.tracking.mpc import *
from fuzzynav.tracking.observers import *
from fuzzynav.tracking.tracker import *
