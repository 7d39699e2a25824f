"""Tracking and avoidance blended by a fuzzy weight (chapter 08)."""

from fuzzynav.blend.controllers import (
    LAP,
    FuzzyRun,
    PrintedBlend,
    PrintedScheme,
    SafeBlend,
    SafeScheme,
    avoidance_yaw_rate,
    blend,
    drive,
    hybrid,
    reach_of,
    rescaled,
    rule_base,
    safety_switch,
    table_5_1,
)

__all__ = [
    "FuzzyRun",
    "LAP",
    "PrintedBlend",
    "PrintedScheme",
    "SafeBlend",
    "SafeScheme",
    "avoidance_yaw_rate",
    "blend",
    "drive",
    "hybrid",
    "reach_of",
    "rescaled",
    "rule_base",
    "safety_switch",
    "table_5_1",
]
