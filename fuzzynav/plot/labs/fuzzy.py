"""The labs of chapter 03: inference under moving breakpoints, the planner's surface, the gaps of a rule base."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from fuzzynav.fuzzy import FuzzySystem, Variable
from fuzzynav.fuzzy.inference import Inference
from fuzzynav.fuzzy.membership import breakpoints
from fuzzynav.plot.base import COLORS, CYCLE
from fuzzynav.plot.fuzzy import DASHES, draw_surface, membership_axes, outline
from fuzzynav.studies.fuzzy import SpeedSets, planner, rule_base, speed_system

__all__ = ["gap_lab", "inference_lab", "surface_lab"]

Update = Callable[..., tuple[list[Artist], str]]


class _Terms:
    """The terms of one variable as lines that can be moved."""

    def __init__(self, ax: Axes, variable: Variable) -> None:
        membership_axes(ax, variable)
        ax.set_ylim(0.0, 1.05)
        self.lines: list[Line2D] = []
        for k, term in enumerate(variable.terms):
            self.lines += ax.plot([], [], color=CYCLE[k], linestyle=DASHES[k])
            at = (k + 0.5) / len(variable.terms)  # a legend would be drawn anew with every picture: texts stay
            ax.text(at, 1.02, term.name, color=CYCLE[k], transform=ax.transAxes, ha="center", va="bottom", fontsize=9)

    def place(self, variable: Variable) -> list[Artist]:
        for line, term in zip(self.lines, variable.terms, strict=True):
            x = np.unique(np.clip([variable.low, *breakpoints(term), variable.high], variable.low, variable.high))
            line.set_data(x, term.membership(x))
        return list(self.lines)


class _Reading:
    """A crisp reading: its line, and a dot on each term."""

    def __init__(self, ax: Axes, terms: _Terms) -> None:
        self.line = ax.axvline(0.0, color="black", linestyle="-", linewidth=1.0)
        self.dots = [
            ax.plot([], [], marker="o", linestyle="", color=line.get_color(), zorder=6)[0] for line in terms.lines
        ]

    def place(self, variable: Variable, value: float) -> list[Artist]:
        self.line.set_xdata([value, value])
        for dot, m in zip(self.dots, variable.fuzzify(value), strict=True):
            dot.set_data([value] if m > 0.0 else [], [m] if m > 0.0 else [])
        return [self.line, *self.dots]


class _Output:
    """Clipped sets, their aggregate and its centroid."""

    def __init__(self, ax: Axes, terms: _Terms) -> None:
        self.clipped = [ax.plot([], [], color="black", linestyle="-", linewidth=0.7)[0] for _ in terms.lines]
        self.shade = Polygon(np.zeros((3, 2)), facecolor=COLORS["accent"], alpha=0.55, edgecolor=COLORS["robot"])
        ax.add_patch(self.shade)
        self.value = ax.axvline(0.0, color=COLORS["path"], linestyle="-", linewidth=2.5)

    def place(self, found: Inference) -> list[Artist]:
        output = found.outputs[0]
        parts = found.clipped(output.name)
        for line, part in zip(self.clipped, parts, strict=False):
            line.set_data(part.x, part.mu)
        joined = found.aggregated[output.name]
        self.shade.set_xy(outline(joined.x, joined.mu))
        value = float(found.values[0])
        self.value.set_xdata([value, value])
        self.value.set_visible(bool(np.isfinite(value)))
        return [*self.clipped[: len(parts)], self.shade, self.value]


def inference_lab(figure: Figure) -> Update:
    """The four-rule speed controller at one point; readings and any breakpoint of `SpeedSets` may be moved."""
    system = speed_system()
    axes = figure.subplots(1, 3, sharey=True)
    terms = [_Terms(ax, v) for ax, v in zip(axes, (*system.inputs, *system.outputs), strict=True)]
    readings = [_Reading(ax, t) for ax, t in zip(axes[:2], terms[:2], strict=True)]
    output = _Output(axes[2], terms[2])
    for ax in axes[1:]:
        ax.set_ylabel("")

    def update(distance: float = 1.5, error: float = 30.0, **moved: float) -> tuple[list[Artist], str]:
        system = speed_system(replace(SpeedSets(), **moved))
        found = system.evaluate(distance, error)
        artists: list[Artist] = []
        for t, variable in zip(terms, (*system.inputs, *system.outputs), strict=True):
            artists += t.place(variable)
        for r, variable, value in zip(readings, system.inputs, (distance, error), strict=True):
            artists += r.place(variable, value)
        return artists + output.place(found), _speed_words(found)

    return update


def _speed_words(found: Inference) -> str:
    strengths = ", ".join(f"{r + 1}: {m:.2f}" for r, m in enumerate(found.firing))
    value = float(found.values[0])
    if not np.isfinite(value):
        return f"Rules {strengths}. No rule fires: there is no speed here."
    return f"Rules {strengths}. Speed {value:.3f} m/s."


def surface_lab(figure: Figure) -> Update:
    """Speed and yaw rate of the 27-rule planner over D_G and D_S, at a chosen D_obs and width of the sets."""
    grid = np.linspace(0.0, 1.0, 31)
    axes = figure.subplots(1, 2, sharey=True)
    empty = np.zeros((31, 31))
    images = [
        draw_surface(axes[0], grid, grid, empty, labels=("D_G", "D_S", "v [m/s]"), limits=(0.0, 1.0)),
        draw_surface(axes[1], grid, grid, empty, labels=("D_G", "D_S", "omega [deg/s]"), limits=(0.0, 90.0)),
    ]
    axes[1].set_ylabel("")
    marks = [
        ax.plot([], [], marker="o", linestyle="", color=COLORS["path"], markeredgecolor="white", markersize=9)[0]
        for ax in axes
    ]

    def update(d_g: float, d_s: float, d_obs: float, sigma: float) -> tuple[list[Artist], str]:
        system = planner(sigma)
        for image, z in zip(images, system(grid[None, :], grid[:, None], d_obs), strict=True):
            image.set_data(z)
        for mark in marks:
            mark.set_data([d_g], [d_s])
        v, omega = system(d_g, d_s, d_obs)
        text = f"At ({d_g:.2f}, {d_s:.2f}, {d_obs:.2f}): v = {v:.3f} m/s, omega = {omega:.1f} deg/s."
        return [*images, *marks], text

    return update


def gap_lab(figure: Figure) -> Update:
    """Strongest rule of thesis table 3.2 over heading and speed; the sets can be widened about their peaks."""
    ax = figure.add_subplot()
    heading, speed = np.linspace(0.0, 180.0, 61), np.linspace(0.0, 1.0, 61)
    image = draw_surface(
        ax,
        heading,
        speed,
        np.zeros((61, 61)),
        limits=(0.0, 1.0),
        labels=("headGoal [deg]", "velRob [m/s]", "strongest rule (orange: none)"),
    )
    ax.set_facecolor(COLORS["path"])
    (mark,) = ax.plot([], [], marker="o", linestyle="", color="white", markeredgecolor="black", markersize=9)

    def update(head_goal: float, vel_rob: float, dist_obs: float, width: float) -> tuple[list[Artist], str]:
        system = widened(rule_base("thesis_table_3_2"), width)
        firing = system.evaluate(heading[None, :], dist_obs, speed[:, None]).firing.max(axis=-1)
        image.set_data(np.ma.masked_equal(firing, 0.0))
        mark.set_data([head_goal], [vel_rob])
        silent = 100.0 * float(np.mean(firing == 0.0))
        words = _weight_words(system, head_goal, dist_obs, vel_rob)
        return [image, mark], f"{silent:.1f} % of the picture is silent. {words}"

    return update


def widened(system: FuzzySystem, width: float) -> FuzzySystem:
    """The system with the feet of its input triangles moved away from the peaks by the factor `width`."""
    changed = {}
    for variable in system.inputs:
        for term in variable.terms:
            a, b, c = term.parameters
            changed[variable.name, term.name] = (b - width * (b - a), b, b + width * (c - b))
    return system.with_terms(changed)


def _weight_words(system: FuzzySystem, head_goal: float, dist_obs: float, vel_rob: float) -> str:
    found = system.evaluate(head_goal, dist_obs, vel_rob)
    weights = ", ".join(f"{v.name} {float(x):.2f}" for v, x in zip(system.outputs, found.values, strict=True))
    if found.firing.max() == 0.0:
        return f"At the dot no rule fires; the stated defaults answer: {weights}."
    return f"At the dot rule {int(found.firing.argmax()) + 1} is strongest ({found.firing.max():.2f}): {weights}."
