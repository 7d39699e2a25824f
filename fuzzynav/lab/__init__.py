"""The live parts of the course: pictures that follow sliders, players, and painting."""

from fuzzynav.lab.controls import Choice, Slider
from fuzzynav.lab.paint import Paint
from fuzzynav.lab.panel import Panel, Player

__all__ = ["Choice", "Paint", "Panel", "Player", "Slider"]
