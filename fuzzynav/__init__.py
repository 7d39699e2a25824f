"""Autonomous navigation of wheeled robots: the package behind the course notebooks.

Every module is one topic; `README.md` lists them beside the chapter that teaches each.
"""

__version__ = "0.1.0"
