"""The controls of a lab, described without drawing them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import ipywidgets as widgets

__all__ = ["Choice", "Slider", "widget_of"]


@dataclass(frozen=True, slots=True)
class Slider:
    """One slider: label, range, first value, step and unit; whole numbers give a whole-number slider.

    Raises ValueError if the range is empty, the step is not positive or the value lies outside.
    """

    label: str
    low: float
    high: float
    value: float
    step: float
    unit: str = ""

    def __post_init__(self) -> None:
        if not self.low < self.high:
            raise ValueError(f"slider '{self.label}': low {self.low} must lie below high {self.high}")
        if not self.step > 0:
            raise ValueError(f"slider '{self.label}': step must be positive, got {self.step}")
        if not self.low <= self.value <= self.high:
            raise ValueError(f"slider '{self.label}': value {self.value} lies outside {self.low} to {self.high}")

    @property
    def whole(self) -> bool:
        """Whether the slider moves over whole numbers."""
        return all(isinstance(v, int) for v in (self.low, self.high, self.value, self.step))

    def rounded(self, value: float) -> float:
        """The nearest value that the slider can stand at, without the dust of adding steps."""
        if self.whole:
            return int(value)
        steps = round((value - self.low) / self.step)
        return min(max(round(self.low + steps * self.step, 9), self.low), self.high)

    @property
    def name(self) -> str:
        """Label with unit, as it stands over the slider."""
        return f"{self.label} [{self.unit}]" if self.unit else self.label


@dataclass(frozen=True, slots=True)
class Choice:
    """One list to choose from; raises ValueError if the first value is not in it."""

    label: str
    options: tuple[str, ...]
    value: str

    def rounded(self, value: str) -> str:
        """The option itself."""
        return value

    @property
    def name(self) -> str:
        """Label as it stands over the list."""
        return self.label

    def __post_init__(self) -> None:
        if self.value not in self.options:
            raise ValueError(f"choice '{self.label}': value '{self.value}' is not one of {', '.join(self.options)}")


def widget_of(control: Slider | Choice) -> widgets.ValueWidget:
    """The widget that stands for a control."""
    style = {"description_width": "initial"}
    if isinstance(control, Choice):
        return widgets.Dropdown(options=control.options, value=control.value, description=control.name, style=style)
    kind = widgets.IntSlider if control.whole else widgets.FloatSlider
    readout = {} if control.whole else {"readout_format": f".{_decimals(control.step)}f"}
    return kind(
        value=control.value,
        min=control.low,
        max=control.high,
        step=control.step,
        description=control.name,
        continuous_update=True,
        style=style,
        **readout,
    )


def _decimals(step: float) -> int:
    return max(0, min(6, math.ceil(-math.log10(step) - 1e-9) + (0 if _is_power(step) else 1)))


def _is_power(step: float) -> bool:
    return round(step / 10 ** math.floor(math.log10(step) + 1e-9), 9) in (1.0, 2.0, 5.0)
