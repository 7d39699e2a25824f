"""Speed of a lab: from a slider's value to the new picture, for the surface of the 27-rule planner."""

import io
import time
from pathlib import Path
from statistics import median

import numpy as np
from PIL import Image

from fuzzynav import lab
from fuzzynav.fuzzy import FuzzySystem

PLANNER = Path(__file__).resolve().parents[2] / "data" / "fuzzy" / "fuzzy_planner_table_i.fll"
GOAL, OBSTACLE = np.meshgrid(np.linspace(0, 1, 31), np.linspace(0, 1, 31))
SLIDER = {"steer": lab.Slider("third input", 0.0, 1.0, 0.5, 0.05)}
VALUES = np.linspace(0.0, 1.0, 21)


def surface(figure):
    """The planner's speed over two inputs, 31 x 31; the slider moves the third."""
    system = FuzzySystem.load(PLANNER)
    ax = figure.add_subplot()
    mesh = ax.pcolormesh(GOAL, OBSTACLE, np.zeros_like(GOAL), vmin=0, vmax=1)
    figure.colorbar(mesh, label="speed")
    ax.set(xlabel="distance to goal", ylabel="distance to obstacle", title="27 rules")

    def update(steer):
        mesh.set_array(system(GOAL, np.full_like(GOAL, steer), OBSTACLE)[0])
        return [mesh], f"third input {steer:.2f}"

    return update


def pixels(png):
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(int)


def timed(action):
    """Median milliseconds of `action(value)` over the slider's values."""
    times = []
    for value in VALUES:
        begin = time.perf_counter()
        action(float(value))
        times.append(1e3 * (time.perf_counter() - begin))
    return median(times)


def rows():
    panel = lab.Panel(surface, SLIDER, title="surface")
    ours = timed(lambda value: panel.set(steer=value))

    other = lab.Panel(surface, SLIDER, title="surface")

    def whole(value):
        other._update(value)
        return other._blit.png(None)

    peer = timed(whole)
    apart = np.abs(pixels(panel.png) - pixels(whole(float(VALUES[-1])))).max()
    return [
        {
            "task": "slider to picture, 27-rule surface 31 x 31",
            "unit": "ms",
            "ours": ours,
            "peer": peer,
            "peer_name": "matplotlib, whole figure drawn anew (same PNG encoder)",
            "ratio": peer / ours,
            "agreement": f"largest difference of a pixel: {apart} of 255",
        }
    ]
