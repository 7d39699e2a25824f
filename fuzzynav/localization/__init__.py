"""Where am I? Kalman filters and particles (chapter 02)."""

from fuzzynav.localization import particles
from fuzzynav.localization.kalman import (
    Belief,
    Correction,
    LandmarkSensor,
    MotionNoise,
    Track,
    correct,
    dead_reckoning,
    ellipse,
    expected,
    motion_jacobians,
    nees,
    nees_bounds,
    predict,
    sample_motions,
    see_landmarks,
    track,
    trilaterate,
)

__all__ = [
    "Belief",
    "Correction",
    "LandmarkSensor",
    "MotionNoise",
    "Track",
    "correct",
    "dead_reckoning",
    "ellipse",
    "expected",
    "motion_jacobians",
    "nees",
    "nees_bounds",
    "particles",
    "predict",
    "sample_motions",
    "see_landmarks",
    "track",
    "trilaterate",
]
