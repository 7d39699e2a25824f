"""Pictures of fuzzy sets, rules and inference."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure, SubFigure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from numpy.typing import ArrayLike

from fuzzynav.fuzzy import FuzzySystem, Term, Variable, defuzzify, sets
from fuzzynav.fuzzy.inference import Inference
from fuzzynav.fuzzy.rules import propositions
from fuzzynav.geometry import Array
from fuzzynav.plot.base import COLORS, CYCLE, arrow, block, diagram

__all__ = [
    "draw_controller",
    "draw_defuzzified",
    "draw_fuzzy_reading",
    "draw_gaps",
    "draw_inference",
    "draw_operators",
    "draw_output",
    "draw_reading",
    "draw_relation",
    "draw_rule_by_rule",
    "draw_set_notions",
    "draw_surface",
    "draw_terms",
    "membership_axes",
    "outline",
]

DASHES = ("-", "--", "-.", ":", "-", "--", "-.")


def outline(x: Array, mu: Array) -> Array:
    """Corners (n + 2, 2) of the area between a sampled set and the axis."""
    return np.column_stack([np.concatenate([x[:1], x, x[-1:]]), np.concatenate([[0.0], mu, [0.0]])])


def membership_axes(ax: Axes, variable: Variable, *, title: str = "") -> Axes:
    """Axes over the range of a variable, membership from 0 to 1, room for the names of the terms."""
    label = f"{variable.name} [{variable.unit}]" if variable.unit else variable.name
    ax.set(xlim=(variable.low, variable.high), ylim=(0.0, 1.16), xlabel=label, ylabel="membership")
    ax.set_yticks([0.0, 0.5, 1.0])
    if title:
        ax.set_title(title)
    return ax


def _peak(term: Term, x: Array) -> tuple[float, float]:
    """Where the name of a term belongs: the middle of its greatest membership."""
    mu = term.membership(x)
    return float(defuzzify.mean_of_maximum(x, mu)), float(mu.max())


def draw_terms(ax: Axes, variable: Variable, *, title: str = "", names: bool = True) -> list[Line2D]:
    """The terms of a variable, each named at its peak; one line for each term."""
    membership_axes(ax, variable, title=title)
    x = np.linspace(variable.low, variable.high, 801)
    lines = []
    for k, term in enumerate(variable.terms):
        color, dash = CYCLE[k % len(CYCLE)], DASHES[k % len(DASHES)]
        (line,) = ax.plot(x, term.membership(x), color=color, linestyle=dash, label=term.name)
        lines.append(line)
        if names:
            place, top = _peak(term, x)
            width = variable.high - variable.low
            side = "left" if place < variable.low + 0.06 * width else "center"
            side = "right" if place > variable.high - 0.06 * width else side
            ax.text(place, top + 0.03, term.name, color=color, ha=side, va="bottom", fontsize=9)
    return lines


def draw_reading(ax: Axes, variable: Variable, value: float) -> list[Artist]:
    """A crisp reading on the axes of `draw_terms`: its line, and a dot at each membership above 0."""
    degrees = variable.fuzzify(value)
    line = ax.axvline(value, color="black", linestyle="-", linewidth=1.0)
    dots = []
    for k, m in enumerate(degrees):
        if m > 0.0:
            dots += ax.plot([value], [m], marker="o", color=CYCLE[k % len(CYCLE)], linestyle="", zorder=6)
        if m >= 0.02:
            _degree(ax, value, float(m))
    return [line, *dots]


def _degree(ax: Axes, x: float, m: float) -> None:
    """A degree written beside its dot."""
    ax.annotate(
        f"{m:.2f}",
        (x, m),
        xytext=(7, -2),
        textcoords="offset points",
        va="center",
        fontsize=9,
        zorder=7,
        bbox={"facecolor": "white", "alpha": 0.75, "edgecolor": "none", "pad": 0.5},
    )


def draw_fuzzy_reading(ax: Axes, variable: Variable, reading: Term) -> list[Artist]:
    """An uncertain reading over the terms: its set, shaded, and a dot where it meets each term highest (sup-min)."""
    x = np.linspace(variable.low, variable.high, 2001)
    mu = reading.membership(x)
    shade = Polygon(outline(x, mu), facecolor=COLORS["unknown"], alpha=0.5, edgecolor="black")
    ax.add_patch(shade)
    dots = []
    for k, term in enumerate(variable.terms):
        both = np.minimum(mu, term.membership(x))
        at = int(both.argmax())
        if both[at] > 0.0:
            dots += ax.plot([x[at]], [both[at]], marker="o", color=CYCLE[k % len(CYCLE)], linestyle="", zorder=6)
            _degree(ax, float(x[at]), float(both[at]))
    return [shade, *dots]


def draw_set_notions(ax: Axes, variable: Variable, term: Term, alpha: float) -> Line2D:
    """A set with its support, core and alpha-cut as bars under the curve."""
    membership_axes(ax, variable)
    x = np.linspace(variable.low, variable.high, 2001)
    mu = term.membership(x)
    (line,) = ax.plot(x, mu, color=COLORS["robot"], linestyle="-")
    cut = sets.alpha_cut(x, mu, alpha)
    ax.plot(cut[[0, -1]], [alpha, alpha], color=COLORS["path"], linestyle="-", linewidth=4.0)
    ax.text(cut.mean(), alpha + 0.02, f"cut at {alpha:g}", ha="center", va="bottom", color=COLORS["path"], fontsize=9)
    core, support = sets.core(x, mu), sets.support(x, mu)
    if core.size:
        ax.plot(core[[0, -1]], [1.0, 1.0], color=COLORS["reference"], linestyle="-", linewidth=4.0)
        ax.text(core.mean(), 1.02, "core", ha="center", va="bottom", color=COLORS["reference"], fontsize=9)
    ax.plot(support[[0, -1]], [0.012, 0.012], color=COLORS["obstacle"], linestyle="-", linewidth=4.0)
    ax.text(support.mean(), 0.04, "support", ha="center", va="bottom", color=COLORS["obstacle"], fontsize=9)
    return line


def draw_operators(axes: Sequence[Axes], variable: Variable, first: Term, second: Term) -> list[Polygon]:
    """AND, OR and NOT of two sets on one universe, shaded."""
    x = np.linspace(variable.low, variable.high, 801)
    a, b = first.membership(x), second.membership(x)
    titles = (f"{first.name} and {second.name}", f"{first.name} or {second.name}", f"not {first.name}")
    patches = []
    for ax, title, mu in zip(axes, titles, (np.minimum(a, b), np.maximum(a, b), 1.0 - a), strict=True):
        membership_axes(ax, variable, title=title)
        ax.plot(x, a, color=CYCLE[0], linestyle="-", label=first.name)
        if title.startswith("not") is False:
            ax.plot(x, b, color=CYCLE[1], linestyle="--", label=second.name)
        patches.append(Polygon(outline(x, mu), facecolor=COLORS["accent"], alpha=0.6))
        ax.add_patch(patches[-1])
    return patches


def draw_relation(ax: Axes, x: ArrayLike, y: ArrayLike, relation: ArrayLike, *, labels: tuple[str, str]) -> AxesImage:
    """A fuzzy relation (n_x, n_y) as a picture, x to the right and y upwards."""
    places, heights = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    image = ax.imshow(
        np.asarray(relation).T,
        origin="lower",
        aspect="auto",
        vmin=0.0,
        vmax=1.0,
        cmap="cividis",
        extent=(places[0], places[-1], heights[0], heights[-1]),
    )
    ax.grid(False)
    ax.set(xlabel=labels[0], ylabel=labels[1])
    return image


def draw_controller(ax: Axes) -> Axes:
    """The four blocks of a fuzzy controller and what flows between them."""
    diagram(ax, 10.0, 3.6)
    fuzzifier = block(ax, (2.2, 1.1), "fuzzification", role="accent")
    inference = block(ax, (5.0, 1.1), "inference", role="accent")
    defuzzifier = block(ax, (7.8, 1.1), "defuzzification", role="accent", size=(2.2, 0.9))
    knowledge = block(ax, (5.0, 2.9), "knowledge base:\ndata base and rules", role="goal", size=(3.0, 1.0))
    arrow(ax, (0.2, 1.1), fuzzifier.left, "crisp\ninputs", offset=(0.0, 0.42))
    arrow(ax, fuzzifier.right, inference.left)
    arrow(ax, inference.right, defuzzifier.left)
    arrow(ax, defuzzifier.right, (9.8, 1.1), "crisp\noutputs", offset=(0.05, 0.42))
    ax.text(3.6, 0.45, "fuzzy inputs", ha="center", fontsize=8.5)
    ax.text(6.35, 0.45, "fuzzy output", ha="center", fontsize=8.5)
    arrow(ax, knowledge.bottom, inference.top)
    arrow(ax, (3.5, 2.9), fuzzifier.top, bend=0.25)
    arrow(ax, (6.5, 2.9), defuzzifier.top, bend=-0.25)
    return ax


def draw_defuzzified(ax: Axes, variable: Variable, x: ArrayLike, mu: ArrayLike, values: dict[str, float]) -> Polygon:
    """An output set, shaded, and a vertical line for each named crisp value."""
    membership_axes(ax, variable)
    places, degrees = np.asarray(x, dtype=float), np.asarray(mu, dtype=float)
    shade = Polygon(outline(places, degrees), facecolor=COLORS["accent"], alpha=0.5, edgecolor=COLORS["robot"])
    ax.add_patch(shade)
    for k, (name, value) in enumerate(values.items()):
        ax.axvline(value, color=CYCLE[(k + 1) % len(CYCLE)], linestyle=DASHES[k % len(DASHES)], label=name)
    ax.legend(loc="upper right")
    return shade


def draw_output(ax: Axes, inference: Inference, output: str, *, title: str = "") -> list[Artist]:
    """Terms of an output, the sets as clipped by the rules, their aggregate, and the crisp value; one point only."""
    variable = next(v for v in inference.outputs if v.name == output)
    artists: list[Artist] = list(draw_terms(ax, variable, title=title))
    joined = inference.aggregated[output]
    for part in inference.clipped(output):
        artists += ax.plot(part.x, part.mu, color="black", linestyle="-", linewidth=0.7)
    shade = Polygon(outline(joined.x, joined.mu), facecolor=COLORS["accent"], alpha=0.5, edgecolor=COLORS["robot"])
    artists.append(ax.add_patch(shade))
    value = float(inference.values[[v.name for v in inference.outputs].index(output)])
    artists.append(ax.axvline(value, color=COLORS["path"], linestyle="-", linewidth=2.0))
    return artists


def draw_inference(figure: Figure | SubFigure, inference: Inference) -> list[Axes]:
    """One point worked through: each input with its reading, each output with its clipped sets and its value."""
    axes = list(np.ravel(figure.subplots(1, len(inference.inputs) + len(inference.outputs), sharey=True)))
    for ax, variable, reading in zip(axes, inference.inputs, inference.readings, strict=False):
        draw_terms(ax, variable)
        draw_reading(ax, variable, float(reading))
    for ax, output in zip(axes[len(inference.inputs) :], inference.outputs, strict=True):
        draw_output(ax, inference, output.name)
    for ax in axes[1:]:
        ax.set_ylabel("")
    return axes


def draw_rule_by_rule(figure: Figure | SubFigure, system: FuzzySystem, *values: float) -> list[Axes]:
    """The classic picture of max-min inference: a row for each rule, a column for each variable.

    For rules of plain propositions and one output. The last row holds the aggregate and the crisp value.
    """
    found = system.evaluate(*values)
    variables, output = (*system.inputs, *system.outputs), system.outputs[0]
    axes = figure.subplots(len(system.rules) + 1, len(variables), sharey=True, squeeze=False)
    for row, rule in zip(axes, system.rules, strict=False):
        used = {p.variable: p.term for p in [*propositions(rule.antecedent), *rule.consequents]}
        strength = float(found.firing[list(system.rules).index(rule)])
        for ax, variable, value in zip(row, variables, [*values, None], strict=True):
            x = np.linspace(variable.low, variable.high, 401)
            membership_axes(ax, variable).set(xlabel="", ylabel="", xticklabels=[])
            if variable.name not in used:
                continue
            mu = variable.term(used[variable.name]).membership(x)
            level = strength if value is None else float(variable.term(used[variable.name]).membership(value))
            ax.plot(x, mu, color=CYCLE[0], linestyle="-")
            ax.add_patch(Polygon(outline(x, np.minimum(level, mu)), facecolor=COLORS["accent"], alpha=0.6))
            ax.text(0.02, 0.98, used[variable.name], transform=ax.transAxes, va="top", fontsize=8.5)
            ax.text(0.98, 0.98, f"{level:.2f}", transform=ax.transAxes, va="top", ha="right", fontsize=8.5)
            if value is not None:
                ax.axvline(value, color="black", linestyle="-", linewidth=0.9)
    _bottom_row(axes[-1], found, output.name)
    return list(axes.ravel())


def _bottom_row(row: Sequence[Axes], found: Inference, output: str) -> None:
    """Axes labels, and the aggregate of `draw_rule_by_rule`."""
    for ax, variable in zip(row[:-1], found.inputs, strict=True):
        membership_axes(ax, variable).set(ylabel="")
        ax.axvline(
            float(found.readings[[v.name for v in found.inputs].index(variable.name)]),
            color="black",
            linestyle="-",
            linewidth=0.9,
        )
    variable = next(v for v in found.outputs if v.name == output)
    membership_axes(row[-1], variable).set(ylabel="")
    joined = found.aggregated[output]
    row[-1].add_patch(Polygon(outline(joined.x, joined.mu), facecolor=COLORS["accent"], alpha=0.6))
    row[-1].axvline(float(found.values[0]), color=COLORS["path"], linestyle="-", linewidth=2.0)


def draw_surface(
    ax: Axes, x: ArrayLike, y: ArrayLike, z: ArrayLike, *, labels: tuple[str, str, str], limits: tuple[float, float]
) -> AxesImage:
    """A control surface z (n_y, n_x) as a picture with a colour bar over the output's limits."""
    places, heights = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    dx, dy = np.diff(places).mean() / 2.0, np.diff(heights).mean() / 2.0
    image = ax.imshow(
        z,
        origin="lower",
        aspect="auto",
        vmin=limits[0],
        vmax=limits[1],
        cmap="cividis",
        extent=(places[0] - dx, places[-1] + dx, heights[0] - dy, heights[-1] + dy),
    )
    ax.grid(False)
    ax.set(xlabel=labels[0], ylabel=labels[1])
    bar = ax.figure.colorbar(image, ax=ax)
    bar.set_label(labels[2])
    return image


def draw_gaps(ax: Axes, system: FuzzySystem, across: str, up: str, **others: float) -> AxesImage:
    """Strength of the strongest rule over two inputs, the others fixed; orange where no rule fires."""
    by_name = {v.name: v for v in system.inputs}
    x, y = (np.linspace(by_name[name].low, by_name[name].high, 91) for name in (across, up))
    readings: dict[str, Any] = {across: x[None, :], up: y[:, None], **others}
    strength = system.evaluate(*(readings[v.name] for v in system.inputs)).firing.max(axis=-1)
    right, above = (f"{n} [{by_name[n].unit}]" if by_name[n].unit else n for n in (across, up))
    image = draw_surface(
        ax, x, y, np.ma.masked_equal(strength, 0.0), labels=(right, above, "strongest rule"), limits=(0.0, 1.0)
    )
    ax.set_facecolor(COLORS["path"])
    return image
