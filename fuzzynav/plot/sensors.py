"""Pictures of chapter 01: kinds of robots, how each sensor works, and what its readings look like."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.patches import Arc, Circle, Polygon, Rectangle, Wedge
from matplotlib.transforms import Affine2D
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, to_world
from fuzzynav.plot.base import COLORS, arrow, block, diagram
from fuzzynav.robot import Robot, rims_from_turn
from fuzzynav.sensors import SPEED_OF_SOUND, Scan, cameras, wheel_angle

__all__ = [
    "draw_beams",
    "draw_cone",
    "draw_scan",
    "echo_sketch",
    "encoder_disc",
    "encoder_signals",
    "fusion_pipeline",
    "laser_sketch",
    "navigation_architectures",
    "pinhole_picture",
    "pinhole_side",
    "robot_kinds",
    "turning_sketch",
    "wheeled_base",
]

CUBE = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
EDGES = tuple((i, j) for i in range(8) for j in range(i + 1, 8) if np.abs(CUBE[i] - CUBE[j]).sum() == 1.0)


# --- readings ----------------------------------------------------------------------------------


def draw_beams(ax: Axes, pose: ArrayLike, scan: Scan) -> LineCollection:
    """The beams of a scan from a pose in the world: solid where they hit, full length and pale where not."""
    beams = LineCollection([], linewidths=0.5, zorder=2)
    place_beams(beams, pose, scan)
    ax.add_collection(beams, autolim=False)
    return beams


def place_beams(beams: LineCollection, pose: ArrayLike, scan: Scan) -> None:
    """Move the drawing of `draw_beams` to another pose and scan."""
    length = np.where(scan.hits, scan.ranges, scan.range_max)
    length = np.where(np.isnan(scan.ranges), 0.0, length)
    ends = np.stack([length * np.cos(scan.angles), length * np.sin(scan.angles)], axis=-1)
    start = np.broadcast_to(np.asarray(pose, dtype=float)[:2], ends.shape)
    beams.set_segments(list(np.stack([start, to_world(pose, ends)], axis=1)))
    beams.set_color([COLORS["accent"] if hit else "#D8D8D8" for hit in scan.hits])


def draw_scan(ax: Axes, pose: ArrayLike, scan: Scan, *, role: str = "path", label: str = "") -> PathCollection:
    """The measured points of a scan in the world."""
    points = scan.world_points(pose)
    dots = ax.scatter(points[:, 0], points[:, 1], s=7, color=COLORS[role], zorder=6)
    if label:
        dots.set_label(label)
    return dots


def draw_cone(ax: Axes, pose: ArrayLike, opening: float, reading: float, *, role: str = "accent") -> Wedge:
    """A sonar's cone of `opening` [rad] up to its reading [m], from a pose."""
    x, y, theta = np.asarray(pose, dtype=float)
    middle, half = np.rad2deg(theta), np.rad2deg(opening) / 2.0
    cone = Wedge(
        (x, y), reading, middle - half, middle + half, facecolor=COLORS[role] + "40", edgecolor=COLORS[role], zorder=2
    )
    ax.add_patch(cone)
    return cone


# --- kinds of robots, figures 1.1 to 1.3 and 1.8 -----------------------------------------------


def robot_kinds(ax: Axes) -> None:
    """The tree of robot families of figure 1.1."""
    diagram(ax, 12.8, 5.2)
    root = block(ax, (7.0, 4.7), "robots", size=(1.8, 0.7))
    kinds = {
        "fixed": (1.65, ["manipulator", "robotic arm"]),
        "mobile": (7.0, ["wheeled", "legged", "humanoid", "underwater", "aerial"]),
        "hybrid": (11.7, ["wheeled base\nwith an arm"]),
    }
    for name, (x, members) in kinds.items():
        top = block(ax, (x, 3.4), name, size=(1.8, 0.7), role="robot" if name == "mobile" else "")
        arrow(ax, root.bottom, top.top)
        wide = 1.35 if name == "mobile" else 1.5
        places = x + (np.arange(len(members)) - (len(members) - 1) / 2.0) * (wide + 0.1)
        for place, member in zip(places, members, strict=True):
            role = "robot" if member == "wheeled" else ""
            leaf = block(ax, (place, 2.1), member, size=(wide, 0.8), role=role, fontsize=8.0)
            arrow(ax, top.bottom, leaf.top)
            if role:
                _wheeled_kinds(ax, leaf.bottom)


def _wheeled_kinds(ax: Axes, start: Array) -> None:
    for x, text in ((2.6, "differential drive"), (5.0, "car-like"), (7.4, "omnidirectional")):
        leaf = block(ax, (x, 0.7), text, size=(2.2, 0.7), role="robot" if x == 2.6 else "", fontsize=8.0)
        arrow(ax, start, leaf.top)


def navigation_architectures(ax: Axes) -> None:
    """The three ways to navigate of figure 1.3: sense-plan-act, sense-act, and both together."""
    diagram(ax, 12.0, 5.6)
    for y, name, steps in ((4.8, "deliberative", "sense model plan act"), (3.3, "reactive", "sense act")):
        ax.text(0.1, y, name, va="center", fontsize=9.5, fontweight="bold")
        words = steps.split()
        places = zip(np.linspace(3.6, 10.8, len(words)), words, strict=True)
        boxes = [block(ax, (x, y), word, role="robot" if word == "act" else "") for x, word in places]
        for left, right in pairwise(boxes):
            arrow(ax, left.right, right.left)
    ax.text(0.1, 1.3, "hybrid", va="center", fontsize=9.5, fontweight="bold")
    sense = block(ax, (3.6, 1.3), "sense")
    plan, react = block(ax, (6.6, 1.9), "plan, slow"), block(ax, (6.6, 0.6), "react, fast")
    act = block(ax, (10.8, 1.3), "act", role="robot")
    for way in (plan, react):
        arrow(ax, sense.right, way.left)
        arrow(ax, way.right, act.left)
    arrow(ax, plan.bottom, react.top, "sub-goal", offset=(0.75, 0.0))


def fusion_pipeline(ax: Axes) -> None:
    """The sensor fusion process of figure 1.8: readings, features, association, one estimate, use."""
    diagram(ax, 12.0, 4.4)
    names = ["wheel encoders", "sonar", "laser scanner", "camera"]
    sources = [block(ax, (1.4, 3.8 - k), name, size=(2.3, 0.75), role="accent") for k, name in enumerate(names)]
    align = block(ax, (4.6, 2.3), "same time,\nsame frame", size=(2.0, 1.2))
    match = block(ax, (7.2, 2.3), "which reading\nbelongs to what", size=(2.2, 1.2))
    fuse = block(ax, (9.9, 2.3), "fuse: weigh by\nuncertainty", size=(2.2, 1.2), role="robot")
    for source in sources:
        arrow(ax, source.right, align.left)
    arrow(ax, align.right, match.left)
    arrow(ax, match.right, fuse.left)
    arrow(ax, fuse.right, (11.9, 2.3))
    ax.text(11.2, 3.15, "pose, map,\nobstacles", ha="center", va="center", fontsize=8.5)
    arrow(ax, fuse.bottom, match.bottom, "prediction", bend=-0.4, linestyle="--", offset=(0.0, -0.85))


def _tyre(
    ax: Axes,
    center: tuple[float, float],
    angle: float = 0.0,
    size: tuple[float, float] = (0.34, 0.12),
    role: str = "obstacle",
) -> Rectangle:
    x, y = center
    tyre = Rectangle((x - size[0] / 2, y - size[1] / 2), *size, facecolor=COLORS[role], edgecolor="black", zorder=4)
    tyre.set_transform(Affine2D().rotate_around(x, y, angle) + ax.transData)
    ax.add_patch(tyre)
    return tyre


def wheeled_base(ax: Axes, kind: str) -> None:
    """One of the bases of figure 1.2, seen from above: 'differential', 'car' or 'omni'; driven wheels are blue.

    Raises ValueError for another kind.
    """
    draw = {"differential": _differential_base, "car": _car_base, "omni": _omni_base}
    if kind not in draw:
        raise ValueError(f"kind must be one of {', '.join(draw)}, got '{kind}'")
    ax.set(xlim=(-0.95, 0.95), ylim=(-0.85, 1.25))
    ax.set_aspect("equal")
    ax.axis("off")
    draw[kind](ax)


def _differential_base(ax: Axes) -> None:
    ax.add_patch(Circle((0.0, 0.0), 0.5, facecolor="#F4F4F4", edgecolor="black"))
    for y in (0.38, -0.38):
        _tyre(ax, (0.0, y), role="robot")
    ax.add_patch(Circle((-0.36, 0.0), 0.06, facecolor=COLORS["obstacle"], zorder=4))
    ax.plot([0, 0], [-0.8, 1.0], color=COLORS["path"], linestyle="--", linewidth=1.0)
    arrow(ax, (0.55, 0.0), (0.9, 0.0))
    ax.text(0.0, 1.1, "turns about any point of the axle", ha="center", fontsize=8)


def _car_base(ax: Axes) -> None:
    ax.add_patch(Rectangle((-0.5, -0.32), 1.0, 0.64, facecolor="#F4F4F4", edgecolor="black"))
    turn = np.array([-0.35, 0.95])
    for y in (0.34, -0.34):
        _tyre(ax, (-0.35, y), role="robot")
        axle = np.array([0.35, y]) - turn
        _tyre(ax, (0.35, y), float(np.arctan2(axle[1], axle[0]) + np.pi / 2))
        ax.plot([0.35, turn[0]], [y, turn[1]], color=COLORS["path"], linestyle="--", linewidth=1.0)
    ax.plot([-0.35, turn[0]], [-0.34, turn[1]], color=COLORS["path"], linestyle="--", linewidth=1.0)
    ax.plot(*turn, marker="o", color=COLORS["path"])
    ax.text(0.0, 1.1, "turns about a point far off", ha="center", fontsize=8)


def _omni_base(ax: Axes) -> None:
    ax.add_patch(Circle((0.0, 0.0), 0.45, facecolor="#F4F4F4", edgecolor="black"))
    for angle in np.deg2rad([60.0, 180.0, 300.0]):
        x, y = 0.52 * np.cos(angle), 0.52 * np.sin(angle)
        _tyre(ax, (x, y), angle + np.pi / 2, role="robot")
        for side in (-0.1, 0.0, 0.1):
            roll = np.array([x, y]) + side * np.array([-np.sin(angle), np.cos(angle)])
            ax.plot(*roll, marker="o", color="white", markersize=3, zorder=5)
    for angle in np.deg2rad([0.0, 90.0, -90.0]):
        arrow(ax, (0, 0), (0.36 * np.cos(angle), 0.36 * np.sin(angle)))
    ax.text(0.0, 1.1, "moves any way: wheels of rollers", ha="center", fontsize=8)


def turning_sketch(ax: Axes, omega: float, radius: float, robot: Robot) -> tuple[float, float]:
    """A robot that turns with omega [rad/s] about a point radius [m] to its left; returns the rim speeds drawn."""
    half, scale = robot.track / 2.0, 0.5
    right, left = (float(v) for v in rims_from_turn(omega, radius, robot))
    ax.set_aspect("equal")
    ax.axis("off")
    ax.add_patch(Circle((0, 0), 1.25 * half, facecolor="#F4F4F4", edgecolor="black"))
    ax.plot([0, 0], [-half, radius], color=COLORS["path"], linestyle="--", linewidth=1.0)
    for y, speed, name in ((-half, right, "v_R"), (half, left, "v_L"), (0.0, omega * radius, "v")):
        if name != "v":
            _tyre(ax, (0.0, y), size=(0.6 * half, 0.2 * half), role="robot")
        arrow(ax, (0.0, y), (scale * speed, y))
        ax.text(max(scale * speed, 1.25 * half) + 0.015, y, f"{name} = {speed:.3f} m/s", va="center", fontsize=9)
    ax.plot(0, radius, marker="o", color=COLORS["path"])
    ax.text(0.03, radius, f"turning centre, omega = {omega} rad/s", va="center", fontsize=9)
    ax.annotate("", (-0.38, 0.0), (-0.38, radius), arrowprops={"arrowstyle": "<->"})
    ax.text(-0.4, radius / 2, f"R = {radius} m", ha="right", va="center", fontsize=9)
    ax.annotate("", (-0.2, half), (-0.2, -half), arrowprops={"arrowstyle": "<->", "color": COLORS["robot"]})
    ax.text(-0.22, 0.0, f"L = {robot.track} m", ha="right", va="center", fontsize=9, color=COLORS["robot"])
    ax.set(xlim=(-0.65, 0.7), ylim=(-1.4 * half, radius + 0.08))
    return right, left


# --- how sensors work, figures 1.4a, 1.5, 1.6a, 1.7 --------------------------------------------


def encoder_disc(ax: Axes, slots: int, angle: float = 0.0) -> list[Wedge]:
    """The slotted disc of figure 1.4a with `slots` slots, turned by `angle` [rad], and its two light barriers."""
    ax.set(xlim=(-1.3, 1.3), ylim=(-1.3, 1.3))
    ax.set_aspect("equal")
    ax.axis("off")
    pitch = 360.0 / slots
    wedges = [
        Wedge(
            (0, 0),
            1.0,
            np.rad2deg(angle) + k * pitch,
            np.rad2deg(angle) + (k + 0.5) * pitch,
            width=0.28,
            facecolor="white",
            edgecolor="black",
        )
        for k in range(slots)
    ]
    ax.add_patch(Circle((0, 0), 1.08, facecolor="#C8C8C8", edgecolor="black"))
    for wedge in wedges:
        ax.add_patch(wedge)
    for name, at, role in (("A", 0.0, "robot"), ("B", pitch / 4.0, "path")):
        a = np.deg2rad(at)
        ax.plot(0.86 * np.cos(a), 0.86 * np.sin(a), marker="o", color=COLORS[role], zorder=5)
        ax.text(1.18 * np.cos(a) + 0.02, 1.18 * np.sin(a), name, color=COLORS[role], va="center", fontweight="bold")
    ax.plot(0, 0, marker="o", color="black")
    return wedges


def encoder_signals(ax: Axes, angle: ArrayLike, slots: int) -> Array:
    """Both channels over the wheel angle [rad] and the counts `(n,)` of their edges, four to a slot."""
    turned = np.asarray(angle, dtype=float)
    phase = turned * slots / (2.0 * np.pi)
    counts = np.floor(4.0 * phase + 1e-9)
    for offset, shift, role, name in ((2.6, 0.0, "robot", "A"), (1.3, 0.25, "path", "B")):
        light = ((phase - shift) % 1.0) < 0.5
        ax.step(np.rad2deg(turned), offset + light, where="post", color=COLORS[role], linestyle="-")
        ax.text(np.rad2deg(turned[0]), offset + 1.1, f"channel {name}", fontsize=8.5, color=COLORS[role])
    ax.step(np.rad2deg(turned), counts / max(counts.max(), 1.0), where="post", color=COLORS["obstacle"], linestyle="-")
    ax.text(np.rad2deg(turned[0]), 1.08, f"count, up to {counts.max():.0f}", fontsize=8.5)
    tick = np.rad2deg(float(wheel_angle(1, 4 * slots)))
    ax.set(xlabel="wheel angle [deg]", yticks=[], title=f"{slots} slots, {4 * slots} counts a turn: {tick:.1f} deg")
    return counts


def echo_sketch(ax: Axes, distance: float) -> float:
    """Figure 1.5: a sound pulse on its way to a wall at distance [m] and back; returns the time [s] of the echo."""
    time = 2.0 * distance / SPEED_OF_SOUND
    for y in (0.35, -0.35):
        ax.add_patch(Rectangle((-0.12, y - 0.1), 0.12, 0.2, facecolor=COLORS["robot"], edgecolor="black"))
    ax.add_patch(Rectangle((distance, -0.6), 0.06, 1.2, facecolor=COLORS["obstacle"]))
    for k, share in enumerate((0.15, 0.35, 0.55, 0.75, 0.95)):
        out, back = 2.0 * share * distance, 2.0 * (2.0 - share) * distance  # the echo comes as from behind the wall
        wide, narrow = np.rad2deg(0.25 / (out / 2.0)), np.rad2deg(0.25 / (back / 2.0))
        ax.add_patch(
            Arc(
                (0, 0.35),
                out,
                out,
                theta1=-min(wide, 15),
                theta2=min(wide, 15),
                color=COLORS["robot"],
                linewidth=2.2 - 0.3 * k,
            )
        )
        ax.add_patch(
            Arc(
                (2 * distance, -0.35),
                back,
                back,
                theta1=180 - narrow,
                theta2=180 + narrow,
                color=COLORS["path"],
                linestyle="--",
                linewidth=0.7 + 0.3 * k,
            )
        )
    ax.annotate("", (0, -0.72), (distance, -0.72), arrowprops={"arrowstyle": "<->"})
    ax.text(distance / 2, -0.84, f"D = {distance:.3f} m, echo after T = {1e3 * time:.2f} ms", ha="center", fontsize=9)
    ax.text(-0.15, 0.35, "sent ", fontsize=9, color=COLORS["robot"], ha="right", va="center")
    ax.text(-0.15, -0.35, "echo ", fontsize=9, color=COLORS["path"], ha="right", va="center")
    ax.set(xlim=(-0.45, distance + 0.2), ylim=(-0.95, 0.75))
    ax.set_aspect("equal")
    ax.axis("off")
    return time


def laser_sketch(axes: Sequence[Axes], distance: float, speed: float) -> float:
    """Figure 1.6a: emitter, mirror and target, and the two pulses in time; returns the time of flight [s]."""
    flight = 2.0 * distance / speed
    space, clock = axes
    diagram(space, 10.0, 4.0)
    emitter = block(space, (1.6, 3.0), "laser diode", size=(3.2, 1.0), role="path")
    receiver = block(space, (1.6, 1.0), "photodiode, clock", size=(3.2, 1.0), role="accent", fontsize=8.0)
    target = block(space, (9.1, 2.0), "target", size=(1.5, 3.0), role="obstacle")
    arrow(space, emitter.right, target.at(-1.0, 0.35), "pulse", offset=(0.0, 0.3))
    arrow(space, target.at(-1.0, -0.35), receiver.right, "reflection", linestyle="--", offset=(0.0, -0.3))
    t = np.linspace(0.0, 1.4 * flight, 600) * 1e9
    for at, height, role, name in ((0.1 * flight, 1.0, "path", "sent"), (1.1 * flight, 0.35, "accent", "received")):
        clock.plot(
            t,
            height * np.exp(-0.5 * ((t - at * 1e9) / (0.025 * flight * 1e9)) ** 2),
            color=COLORS[role],
            linestyle="-",
            label=name,
        )
    clock.annotate("", (0.1 * flight * 1e9, 0.5), (1.1 * flight * 1e9, 0.5), arrowprops={"arrowstyle": "<->"})
    clock.text(0.6 * flight * 1e9, 0.54, f"T = {flight * 1e9:.2f} ns", ha="center", fontsize=9)
    clock.set(xlabel="time [ns]", ylabel="light", yticks=[], title=f"D = {distance} m")
    clock.legend(loc="upper center")
    return flight


def pinhole_side(ax: Axes, camera: cameras.Camera, points: ArrayLike) -> Array:
    """Figure 1.7 from the side: points `(n, 3)` [m] of the optical frame, their rays, and v [px] on the image plane."""
    p = np.asarray(points, dtype=float)
    plane = 1.0  # [m] in front of the pinhole, where the picture is drawn
    for _, y, z in p:
        ax.plot([0.0, z], [0.0, y], color=COLORS["accent"], linestyle="-", linewidth=1.0)
        ax.plot(z, y, marker="o", color=COLORS["path"])
        ax.plot(plane, y / z, marker="o", color=COLORS["robot"], markersize=4)
    top, bottom = (np.array([0, camera.height - 1]) - camera.cy) / camera.fy
    ax.plot([plane, plane], [top, bottom], color="black", linestyle="-", linewidth=2.0)
    ax.text(plane, top - 0.05, "image plane", ha="center", va="bottom", fontsize=8.5)
    ax.plot(0, 0, marker="o", color="black")
    ax.text(-0.2, -0.12, "pinhole", ha="left", va="bottom", fontsize=8.5)
    ax.axhline(0.0, color="#888888", linewidth=0.8, linestyle=":")
    ax.set(xlabel="depth Z [m]", ylabel="Y [m], down", xlim=(-0.3, None))
    ax.invert_yaxis()
    return cameras.project(p, camera)[:, 1]


def pinhole_picture(ax: Axes, camera: cameras.Camera, center: ArrayLike, side: float) -> Array:
    """The picture of a wire cube about `center` (3,) [m] of the optical frame; returns its corners `(8, 2)` [px]."""
    pixels = cameras.project(np.asarray(center, dtype=float) + side * CUBE, camera)
    for i, j in EDGES:
        ax.plot(pixels[[i, j], 0], pixels[[i, j], 1], color=COLORS["robot"], linestyle="-", linewidth=1.2)
    ax.plot(camera.cx, camera.cy, marker="+", color=COLORS["path"], markersize=10)
    ax.text(camera.cx - 10, camera.cy, "principal point", fontsize=8.5, va="center", ha="right", color=COLORS["path"])
    ax.add_patch(Polygon([[0, 0], [camera.width, 0], [camera.width, camera.height], [0, camera.height]], fill=False))
    ax.set(xlim=(-10, camera.width + 10), ylim=(camera.height + 10, -10), xlabel="u [px]", ylabel="v [px]")
    ax.set_aspect("equal")
    return pixels
