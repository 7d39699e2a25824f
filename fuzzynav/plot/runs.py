"""Any run in its world: drawn, played, and saved as a film."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, Rectangle
from PIL import Image

from fuzzynav.geometry import Array
from fuzzynav.plot.base import COLORS, draw_discs, draw_goal, draw_grid, draw_path, draw_robot, metric_axes
from fuzzynav.plot.blit import Blit, Update
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

__all__ = [
    "MoverMarks",
    "draw_run",
    "draw_run_speeds",
    "draw_world",
    "mover_marks",
    "run_player",
    "save_gif",
]


def draw_world(ax: Axes, world: World) -> list[Artist]:
    """Everything that stands in a world, to scale; what no map shows is hatched."""
    made: list[Artist] = []
    if world.grid is not None:
        made.append(draw_grid(ax, world.grid))
    if len(world.discs):
        made.append(draw_discs(ax, world.discs))
    if len(world.unknown_discs):
        hidden = draw_discs(ax, world.unknown_discs, role="unknown")
        hidden.set_hatch("///")
        made.append(hidden)
    for rows, role in ((world.rectangles, "obstacle"), (world.unknown_rectangles, "unknown")):
        for x, y, width, height, theta in rows:
            patch = Rectangle(
                (x - width / 2, y - height / 2),
                width,
                height,
                angle=np.degrees(theta),
                rotation_point="center",
                facecolor=COLORS[role],
                edgecolor="black",
                linewidth=0.6,
                hatch="///" if role == "unknown" else None,
                zorder=2,
            )
            made.append(ax.add_patch(patch))
    metric_axes(ax, world.bounds)
    return made


@dataclass(frozen=True, slots=True)
class MoverMarks:
    """The movers of a run as discs; `place` shows another moment."""

    artists: list[Artist]
    positions: Array  # (n + 1, m, 2)

    def place(self, step: int) -> None:
        """Show where the movers were at this step."""
        for disc, center in zip(self.artists, self.positions[step], strict=True):
            disc.set_center(tuple(center))  # type: ignore[attr-defined]


def mover_marks(ax: Axes, world: World, run: Run) -> MoverMarks:
    """The movers of a world as they stood at the start of a run."""
    discs = [Circle(m.start, m.radius, facecolor=COLORS["mover"], zorder=4) for m in world.movers]
    for disc in discs:
        ax.add_patch(disc)
    starts = np.array([m.start for m in world.movers]).reshape(-1, 2)
    return MoverMarks(list(discs), run.log.get("movers", np.tile(starts, (len(run.t), 1, 1))))


def draw_run(ax: Axes, world: World, run: Run, *, role: str = "path", label: str = "", title: str = "") -> Line2D:
    """A driven path in its world with start, end and goal."""
    draw_world(ax, world)
    line = draw_path(ax, run.poses, role=role, label=label)
    draw_robot(ax, run.poses[-1], run.radius)
    ax.plot(*run.poses[0, :2], "s", color=COLORS["robot"], zorder=5)
    draw_goal(ax, run.goal)
    if title:
        ax.set_title(title)
    return line


def draw_run_speeds(axes: Sequence[Axes], run: Run, *, title: str = "") -> list[Line2D]:
    """v and omega over time, on two axes."""
    lines = []
    names = ((0, "$v$ [m/s]", "robot"), (1, r"$\omega$ [rad/s]", "path"))
    for ax, (k, label, role) in zip(axes, names, strict=True):
        (line,) = ax.plot(run.t[:-1], run.commands[:, k], color=COLORS[role], linestyle="-", linewidth=1.2)
        ax.set(ylabel=label, xlim=(0.0, max(run.duration, 1e-9)))
        lines.append(line)
    axes[-1].set_xlabel("t [s]")
    if title:
        axes[0].set_title(title)
    return lines


def run_player(figure: Figure, *, run: Run, world: World) -> Update:
    """A run played in its world: robot, path so far and movers at `frame`."""
    ax = figure.subplots()
    draw_world(ax, world)
    draw_goal(ax, run.goal)
    if world.bounds is None:
        low, high = run.poses[:, :2].min(axis=0) - 1.0, run.poses[:, :2].max(axis=0) + 1.0
        metric_axes(ax, (low[0], high[0], low[1], high[1]))
    path, robot = draw_path(ax, np.empty((0, 2))), draw_robot(ax, run.poses[0], max(run.radius, 0.05))
    movers = mover_marks(ax, world, run)

    def update(frame: int) -> tuple[list[Artist], str]:
        path.set_data(*run.poses[: frame + 1, :2].T)
        robot.place(run.poses[frame])
        movers.place(frame)
        return [path, *robot.artists, *movers.artists], f"{run.t[frame]:.1f} s"

    return update


def save_gif(run: Run, world: World, path: str | Path, *, every: int = 5, dpi: int = 60) -> Path:
    """Write a run as an animated GIF, one picture for every n-th step; the moving parts are drawn anew each time."""
    if every < 1:
        raise ValueError(f"every must be at least 1, got {every}")
    blit = Blit((5.0, 5.0), dpi=dpi)
    update = run_player(blit.figure, run=run, world=world)
    frames = []
    for k, _, _ in run.frames(every):
        artists, _ = update(frame=k)
        frames.append(Image.open(io.BytesIO(blit.png(artists))).convert("P"))
    target = Path(path)
    pause = max(int(1000 * run.dt * every), 20)
    frames[0].save(target, save_all=True, append_images=frames[1:], duration=pause, loop=0)
    return target
