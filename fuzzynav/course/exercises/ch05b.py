"""Exercises of chapter 05b: turning points, ends of a spline, a second derivative, an eta vector for a robot."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np

from fuzzynav import smoothing
from fuzzynav.course.exercise import Exercise, Wrong
from fuzzynav.course.exercises.answers import array, close, integers, named, numbers
from fuzzynav.course.exercises.ch05a import random_map
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar

__all__ = ["EXERCISES"]

Function = Callable[..., Any]
END = (4.0, 3.0, 0.0)  # of exercise 05.8
MOST_BENT, LONGEST = 0.8, 5.4  # [1/m], [m]


# --- 05.5


def _check_shorten(answer: Function) -> str:
    """Kept indices on seeded paths: ends kept, every leg free, and few: as the greedy rule, or none that can go."""
    rng = np.random.default_rng(55)
    kept, tried = [], 0
    while tried < 12:
        grid = random_map(rng, 16, 0.2)
        cells = astar.search(grid, (0, 0), (15, 15)).cells
        if len(cells) < 3:
            continue
        tried += 1
        centers, count = grid.center_of(cells), len(cells)

        def free(a: int, b: int, grid: GridMap = grid, centers: Array = centers) -> bool:
            return bool(grid.clear_line(centers[a], centers[b], 0.3))

        told = _kept(answer(count, free), count)
        for a, b in pairwise(told):
            if b > a + 1 and not free(a, b):
                raise Wrong(f"You kept the nodes {a} and {b}, but the straight leg between them hits an obstacle.")
        kept.append((told, count, free))
    if all(len(told) == count for told, count, _ in kept):
        raise Wrong("You kept all nodes: skip those that a free leg can skip.")
    for told, count, free in kept:
        _name_kept(told, count, free)
    return "Every leg is free, and no node is kept that a free leg can skip."


def _greedy(count: int, free: Function) -> list[int]:
    """The nodes kept when each leg is led on until it is first blocked."""
    kept = [0]
    for k in range(2, count):
        if not free(kept[-1], k):
            kept.append(k - 1)
    return [*kept, count - 1]


def _name_kept(told: list[int], count: int, free: Function) -> None:
    """Say that too many nodes were kept: by the printed restart, or because one can go."""
    forward, backward = _greedy(count, free), _greedy(count, lambda a, b: free(count - 1 - b, count - 1 - a))
    triples = zip(told, told[1:], told[2:], strict=False)
    a, b, c = next((t for t in triples if free(t[0], t[2])), (0, 0, 0))
    if c == 0 or len(told) <= max(len(forward), len(backward)):
        return
    printed, base = {0, count - 1}, 0
    for k in range(2, count):
        if k > base + 1 and not free(base, k):
            printed |= {k - 1, k}
            base = k
    if told == sorted(printed):
        raise Wrong(
            f"Of {count} nodes you kept {len(told)}, {len(forward)} are enough: after a blocked leg go on from the "
            "last node that was in sight, not from the one that was not (T22)."
        )
    raise Wrong(f"You kept the nodes {a}, {b} and {c}, but the leg from {a} to {c} is free: node {b} can go.")


def _kept(value: Any, count: int) -> list[int]:
    told = integers(value, -1, "The numbers of the kept nodes")
    if told[:1] != [0] or told[-1:] != [count - 1]:
        raise Wrong(f"The path must begin with node 0 and end with node {count - 1}; yours are {told}.")
    if sorted(set(told)) != told:
        raise Wrong(f"The numbers must rise: {told} do not.")
    return told


# --- 05.6


def _check_ends(answer: Function) -> str:
    """The free spline on the returned points passes through both ends, along the first and the last leg."""
    rng = np.random.default_rng(56)
    for _ in range(10):
        points = np.cumsum(rng.uniform(0.3, 2.0, (int(rng.integers(5, 9)), 2)), axis=0)
        controls = array(answer(points.copy()), (-1, 2), "The control points")
        if (np.hypot(*np.diff(controls, axis=0).T) < 1e-9).any():
            raise Wrong(
                "Repeated points do end a uniform spline there, but bspline takes no two that coincide: put one new "
                "point beyond each end instead."
            )
        if len(controls) < 4:
            raise Wrong("A cubic spline needs four control points or more.")
        _name_ends(controls, points)
    return "The curve starts and ends where the path does, along its legs."


def _name_ends(controls: Array, points: Array) -> None:
    """Say what is wrong in control points that should end the curve at the ends of these points."""
    spline = smoothing.bspline(controls, "free")
    met = spline.points(2)
    if np.hypot(*(met[-1] - points[0])) < 1e-6 and np.hypot(*(met[0] - points[-1])) < 1e-6:
        raise Wrong("The curve runs from the goal to the start: the points are in the wrong order.")
    for name, end, given in (("start", met[0], points[0]), ("goal", met[1], points[-1])):
        gap = float(np.hypot(*(end - given)))
        if gap > 1e-6:
            raise Wrong(f"The curve misses the {name} by {gap:.3f} m: (C_0 + 4 C_1 + C_2) / 6 is where it begins.")
    if len(controls) > len(points) + 4:
        raise Wrong(f"{len(controls) - len(points)} points were added; one beyond each end is enough.")
    low, high = spline.span
    for name, leg, way in (
        ("start", points[1] - points[0], spline.derivative(low, 1)),
        ("goal", points[-1] - points[-2], spline.derivative(high, 1)),
    ):
        if abs(leg[0] * way[1] - leg[1] * way[0]) > 1e-6 * float(np.hypot(*way)) or leg @ way <= 0:
            raise Wrong(f"The curve meets the {name}, but not along the leg there.")
    gaps = np.hypot(*(controls[:, None] - points[None, 1:-1]).T)
    if (gaps.min(axis=1) > 1e-6).any():
        raise Wrong("The ends are right, but points of the path between them are gone: keep them all.")


# --- 05.7


def _check_second(answer: Function) -> str:
    """p''(0) of an eta-cubed curve from eta_1, eta_3, heading and curvature."""
    cases = np.random.default_rng(57).uniform([0.5, 0.5, -3, -3, -1], [4, 4, 3, 3, 1], (10, 5))
    told, wanted = [], []
    for e1, e2, e3, theta, kappa in cases.tolist():
        told.append(numbers(answer(e1, e3, theta, kappa), 2, "The second derivative"))
        wanted.append(smoothing.eta3([0, 0, theta, kappa], [5, 1, 0], [e1, e2, e3]).derivative(0.0, 2))
    if close(told, wanted):
        return "Tangential eta_3, normal eta_1 squared times the curvature: the printed eta_2 has no place there (T5)."
    e1, _, e3, theta, kappa = cases.T
    tangent, normal = np.stack([np.cos(theta), np.sin(theta)], 1), np.stack([-np.sin(theta), np.cos(theta)], 1)

    def parts(along: Array, across: Array) -> Array:
        return np.asarray(along[:, None] * tangent + across[:, None] * normal)

    named(
        np.array(told),
        (
            parts(e3, e1 * kappa),
            "The part across grows with the square of the speed eta_1: yours is only proportional.",
        ),
        (parts(e3, -(e1**2) * kappa), "A positive curvature bends to the left: your part across points to the right."),
        (parts(e3, kappa), "A faster run through the same bend needs more: the speed eta_1 is missing across."),
        (parts(e3, 0 * kappa), "A curve that bends is drawn across its heading too: yours only along it."),
        (
            parts(0 * e3, e1**2 * kappa),
            "The part along the heading is missing: there stands an acceleration of the vector.",
        ),
        (parts(e1, e1**2 * kappa), "Along the heading stands an acceleration, not the speed eta_1."),
        (parts(e1**2 * kappa, e3), "The parts along and across are swapped."),
        (np.stack([e3, e1**2 * kappa], 1), "Both parts are right as the robot sees them: turn them by the heading."),
    )
    k = int(np.argmax(np.abs(np.subtract(told, wanted)).max(axis=1)))
    raise Wrong(
        f"At eta_1 = {e1[k]:.2f}, eta_3 = {e3[k]:.2f}, curvature {kappa[k]:.2f}: along the heading it is "
        f"{wanted[k] @ tangent[k]:.3f} and across {wanted[k] @ normal[k]:.3f}, yours {told[k] @ tangent[k]:.3f} and "
        f"{told[k] @ normal[k]:.3f}."
    )


# --- 05.8


def _check_eta(answer: Any) -> str:
    """Two to six numbers whose curve bends and stretches little enough."""
    eta = numbers(answer, -1, "The eta vector")
    if not 2 <= len(eta) <= 6:
        raise Wrong("An eta vector has two to six numbers: two speeds, then two accelerations, then two jerks.")
    if min(eta[:2]) <= 0:
        raise Wrong("eta_1 and eta_2 are speeds and must be positive.")
    curve = smoothing.eta3([0.0, 0.0, 0.0], END, eta)
    sharp = float(np.abs(curve.curvature(np.linspace(0.0, 1.0, 801))).max())
    if sharp > MOST_BENT:
        raise Wrong(
            f"The sharpest curvature is {sharp:.4g} 1/m, a turning radius of {1 / sharp:.4g} m; the robot "
            f"needs {1 / MOST_BENT:.2f} m, that is {MOST_BENT} 1/m."
        )
    if curve.length > LONGEST:
        raise Wrong(f"It turns gently enough but is {curve.length:.4f} m long; {LONGEST} m are allowed.")
    return f"Sharpest curvature {sharp:.2f} 1/m, length {curve.length:.2f} m."


EXERCISES: tuple[Exercise, ...] = (
    Exercise("05.5", "Keep only the turning points", 3, (
        "Hold the last kept node and walk on until the leg to node k is blocked. Which node do you keep?",
        "Keep k - 1, and let it be the new base. At the end add the last node.",
    ), _check_shorten),
    Exercise("05.6", "A spline that starts at the start", 2, (
        "A uniform cubic spline starts at (C_0 + 4 C_1 + C_2) / 6. Put one point before P_0 so that this equals P_0.",
        "With C_1 = P_0 and C_2 = P_1 you need C_0 = 2 P_0 - P_1. The same beyond the goal.",
    ), _check_ends),
    Exercise("05.7", "The second derivative at the start", 2, (
        "Write p'' as a part along the heading and a part to its left.",
        "p'' = eta_3 t + eta_1^2 kappa n, with t = (cos, sin) and n = (-sin, cos) of the heading.",
    ), _check_second),
    Exercise("05.8", "Tune an eta vector to a robot", 2, (
        "Move the sliders of the eta lab. What do larger speeds do to the middle of the curve?",
        "Small speeds with a positive eta_3 and a negative eta_4 bend least: try eta_1 = eta_2 = 2.",
    ), _check_eta),
)  # fmt: skip
