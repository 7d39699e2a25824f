"""Autonomous navigation of wheeled robots: the package behind the course notebooks.

Every module is one topic; `README.md` lists them beside the chapter that teaches each.
"""

from fuzzynav.stale import forget_stale

__version__ = "0.1.0"

forget_stale()  # what a reader changes is what runs
del forget_stale
