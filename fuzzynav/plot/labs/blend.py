"""Labs of the fuzzy blend: a block dragged over the map, and the breakpoints of table 5.1."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from fuzzynav import blend
from fuzzynav.plot.base import COLORS, draw_path, metric_axes
from fuzzynav.plot.blend import block_corners, draw_block, draw_gate, weight_surface
from fuzzynav.plot.blit import Update
from fuzzynav.simulate.record import Run
from fuzzynav.tracking.reference import FigureEight

__all__ = ["block_lab", "weight_lab"]

HALF = FigureEight(duration=blend.LAP / 2.0)  # the upper loop


def _ending(run: Run) -> str:
    if run.status == "collided":
        return f"contact at {run.t[-1]:.1f} s"
    return f"clearance {run.min_clearance:.2f} m, largest distance {run.distance.max():.2f} m"


def block_lab(figure: Figure) -> Update:
    """Printed and safe blend past a block at x, y [m], turned by an angle [deg]; printed gate [deg] and d0 [m]."""
    axes = figure.subplot_mosaic([["map", "share"], ["map", "gap"]], width_ratios=[1.25, 1.0])
    metric_axes(axes["map"], (-2.6, 2.6, -0.7, 2.7))
    draw_path(
        axes["map"],
        HALF.sample(np.linspace(0, HALF.duration, 400)).position,
        role="reference",
        linestyle="--",
        label="reference",
    )
    shape = draw_block(axes["map"], [0.0, 1.9, 0.2, 0.3, 0.0])
    printed = draw_path(axes["map"], np.zeros((0, 2)), role="path", label="printed")
    safe = draw_path(axes["map"], np.zeros((0, 2)), role="robot", label="safe")
    (end,) = axes["map"].plot([], [], marker="x", markersize=9, color="black", linestyle="", zorder=8)
    axes["map"].legend(loc="lower center", ncols=3, fontsize=8)
    colours = (COLORS["path"], COLORS["robot"])
    shares = [axes["share"].plot([], [], color=c)[0] for c in colours]
    gaps = [axes["gap"].plot([], [], color=c)[0] for c in colours]
    axes["share"].set(xlim=(0, 66), ylim=(-0.05, 1.05), ylabel="share of avoidance")
    axes["gap"].set(xlim=(0, 66), ylim=(0, 1.0), xlabel="t [s]", ylabel="clearance [m]")

    def update(x: float, y: float, turn: float, gate: float, d0: float) -> tuple[list[Artist], str]:
        place = np.array([x, y, 0.2, 0.3, np.radians(turn)])
        scheme = blend.PrintedScheme(gate=np.radians(gate), d0=d0)
        runs = [blend.drive(s, place, reference=HALF) for s in (scheme, blend.SafeScheme())]
        shape.set_xy(block_corners(place))
        for run, path, share, gap in zip(runs, (printed, safe), shares, gaps, strict=True):
            path.set_data(*run.poses[:, :2].T)
            share.set_data(run.t[:-1], run.log["weight"])
            gap.set_data(run.t[:-1], run.clearance)
        hit = runs[0].status == "collided"
        end.set_data(*(runs[0].poses[-1:, :2].T if hit else np.zeros((2, 0))))
        text = f"printed: {_ending(runs[0])}; safe: {_ending(runs[1])}"
        return [shape, printed, safe, end, *shares, *gaps], text

    return update


def weight_lab(figure: Figure) -> Update:
    """Surface of F and the path of the printed blend (gate 90 deg) for breakpoints of distance, bearing and F."""
    axes = figure.subplot_mosaic([["surface", "map"]], width_ratios=[1.0, 1.25])
    image = draw_gate(axes["surface"], weight_surface(blend.table_5_1(), (21, 41)), gate=np.pi / 2.0)
    axes["surface"].set_title("F")
    figure.colorbar(image, ax=axes["surface"], shrink=0.85)
    place = np.array([0.0, 1.9, 0.2, 0.3, 0.0])
    metric_axes(axes["map"], (-1.6, 1.6, 1.0, 2.8))
    draw_path(
        axes["map"],
        HALF.sample(np.linspace(0, HALF.duration, 400)).position,
        role="reference",
        linestyle="--",
        label="reference",
    )
    draw_block(axes["map"], place)
    driven = draw_path(axes["map"], np.zeros((0, 2)), role="path", label="driven")
    axes["map"].legend(loc="upper right", fontsize=8)

    def update(close: float, far: float, ahead: float, peak: float) -> tuple[list[Artist], str]:
        if far <= close:
            raise ValueError(f"Far must end above Close: {far:g} m is not above {close:g} m")
        system = blend.rule_base(close, far, ahead, peak)
        run = blend.drive(blend.PrintedScheme(gate=np.pi / 2.0), place, reference=HALF, system=system)
        image.set_data(weight_surface(system, (21, 41)))
        driven.set_data(*run.poses[:, :2].T)
        low, high = blend.reach_of(system)
        used = run.log["F"].max()
        return [image, driven], f"F from {low:.2f} to {high:.2f}; largest F used {used:.2f}; {_ending(run)}"

    return update
