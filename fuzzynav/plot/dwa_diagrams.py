"""The boxes and arrows of the fuzzy dynamic window approach."""

from __future__ import annotations

from matplotlib.axes import Axes

from fuzzynav.plot.base import arrow, block, diagram

__all__ = ["fuzzy_dwa_flowchart", "fuzzy_dwa_loop", "fuzzy_weight_tuner"]


def fuzzy_dwa_flowchart(ax: Axes) -> Axes:
    """The steps of one cycle, from the sensed points to the command and back."""
    diagram(ax, 13.0, 5.4)
    size = (2.15, 1.0)
    sense, window, safe, score, best = (
        block(ax, (1.2 + 2.62 * k, 3.1), text, size=size, role=role)
        for k, (text, role) in enumerate(
            (
                ("pose, speed,\nsensed points", ""),
                ("window $V_s, V_d$\n(3.15)", "accent"),
                ("stop in time?\n$V_a$ (3.15)", "accent"),
                ("scores\n(3.18-3.21)", "accent"),
                ("largest $G$\n(3.17)", "accent"),
            )
        )
    )
    fuzzy = block(ax, (6.44, 4.8), "rule base, table 3.2", size=(3.4, 0.9), role="goal")
    brake = block(ax, (6.44, 1.3), "none: brake\non the arc", size=size, role="path")
    drive = block(ax, (11.68, 1.3), "drive for\none step", size=size)
    for a, b in ((sense, window), (window, safe), (safe, score), (score, best)):
        arrow(ax, a.right, b.left)
    arrow(ax, sense.top, fuzzy.left, "heading, distance, speed", bend=-0.3, offset=(-0.75, 0.75))
    arrow(ax, fuzzy.right, best.top, r"$\alpha, \beta, \gamma$", bend=-0.3, offset=(0.9, 0.55))
    arrow(ax, safe.bottom, brake.top)
    arrow(ax, best.bottom, drive.top)
    arrow(ax, brake.right, drive.left)
    x, y = drive.bottom
    ax.plot([x, x, sense.bottom[0]], [y, 0.35, 0.35], color="#333333", linestyle="-", linewidth=1.2)
    arrow(ax, (sense.bottom[0], 0.34), sense.bottom)
    ax.text(6.44, 0.12, "until the goal is within its tolerance", ha="center", va="center", fontsize=8.5)
    return ax


def fuzzy_weight_tuner(ax: Axes) -> Axes:
    """The fuzzy tuner: three readings in, three weights out."""
    diagram(ax, 10.4, 3.9)
    inputs = [
        block(ax, (1.3, y), name, size=(2.0, 0.7))
        for y, name in ((3.2, "headGoal [deg]"), (2.1, "distObs [m]"), (1.0, "velRob [m/s]"))
    ]
    fuzzify = block(ax, (3.9, 2.1), "fuzzify:\n3 terms each", size=(1.7, 1.0), role="accent")
    infer = block(ax, (6.0, 2.1), "inference:\nmin, max", size=(1.6, 1.0), role="accent")
    rules = block(ax, (6.0, 3.4), "9 rules, table 3.2", size=(2.2, 0.7), role="goal")
    centroid = block(ax, (8.0, 2.1), "centroid", size=(1.4, 1.0), role="accent")
    for one in inputs:
        arrow(ax, one.right, fuzzify.left)
    arrow(ax, fuzzify.right, infer.left)
    arrow(ax, rules.bottom, infer.top)
    arrow(ax, infer.right, centroid.left)
    for y, name in ((3.0, r"$\alpha$"), (2.1, r"$\beta$"), (1.2, r"$\gamma$")):
        arrow(ax, centroid.right, (9.7, y))
        ax.text(9.95, y, name, ha="center", va="center", fontsize=11)
    return ax


def fuzzy_dwa_loop(ax: Axes) -> Axes:
    """The closed loop: the planner drives the robot, the map feeds the tuner of its weights."""
    diagram(ax, 10.4, 4.2)
    planner = block(ax, (3.6, 3.0), "dynamic window\napproach", size=(2.4, 1.0), role="accent")
    robot = block(ax, (7.4, 3.0), "robot", size=(1.6, 1.0), role="robot")
    world = block(ax, (7.4, 1.0), "map, sensed points", size=(2.4, 0.9))
    fuzzy = block(ax, (3.6, 1.0), "fuzzy tuner", size=(2.4, 0.9), role="goal")
    arrow(ax, (0.6, 3.0), planner.left, "goal", offset=(0.0, 0.22))
    arrow(ax, planner.right, robot.left, r"$v, \omega$", offset=(0.0, 0.25))
    arrow(ax, robot.bottom, world.top, "pose, speed", offset=(0.85, 0.0))
    arrow(ax, world.left, fuzzy.right, "headGoal,\ndistObs, velRob", offset=(0.05, -0.45))
    arrow(ax, fuzzy.top, planner.bottom, r"$\alpha, \beta, \gamma$", offset=(-0.65, 0.0))
    arrow(ax, world.at(-0.6, 1.0), planner.at(0.7, -1.0), "obstacles", offset=(0.35, 0.3))
    return ax
