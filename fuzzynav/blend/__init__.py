"""Tracking and avoidance blended by a fuzzy weight (chapter 08): the blend as printed, and a safe form of it.

Both take the same two ideas: feedback linearization drives, a fuzzy weight F says how much avoidance has to say.
"""

from fuzzynav.blend.controllers import PrintedBlend, SafeBlend
from fuzzynav.blend.equations import avoidance_yaw_rate, hybrid, mixed, safety_switch
from fuzzynav.blend.rules import reach_of, rule_base, table_5_1
from fuzzynav.blend.runs import BEAMS, LAP, avoidance_times, delay, drive, last_avoidance
from fuzzynav.blend.schemes import PrintedScheme, SafeScheme

__all__ = [
    "BEAMS",
    "LAP",
    "PrintedBlend",
    "PrintedScheme",
    "SafeBlend",
    "SafeScheme",
    "avoidance_times",
    "avoidance_yaw_rate",
    "delay",
    "drive",
    "hybrid",
    "last_avoidance",
    "mixed",
    "reach_of",
    "rule_base",
    "safety_switch",
    "table_5_1",
]
