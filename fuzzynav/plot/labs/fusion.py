"""Labs of planning and reacting: the orbit, a hall to fill, weights and layers of safety, a speed bound."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.artist import Artist
from matplotlib.collections import PolyCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fuzzynav import fusion
from fuzzynav.fusion.protocol import Driven
from fuzzynav.geometry import Array, wrap
from fuzzynav.plot.base import COLORS, draw_goal, draw_grid, draw_path, draw_robot, metric_axes
from fuzzynav.plot.blit import Update
from fuzzynav.plot.navigation import circles, forbidden, map_mark, prediction_mark, reach_mark, reason_mark
from fuzzynav.robot import THESIS, Robot, move
from fuzzynav.simulate.record import Run

__all__ = ["LAYERS", "bound_lab", "hall_lab", "orbit_path", "orbit_lab", "guard_lab", "guard_run"]

LOOKS_AT = 0.5  # [m] a sub-goal is reached
LAP = 40.0  # [s] that the orbit lab drives
HERE = (0.0, 0.0, 0.0)


# --- the orbit ------------------------------------------------------------------------------------


def orbit_path(
    target: tuple[float, float], speed: float, turn: float, *, cap: bool = False, radius: float = LOOKS_AT
) -> tuple[Array, bool]:
    """Path `(n, 3)` of a robot at the origin that turns towards a target as fast as it may; whether it gets there.

    speed [m/s] is held, or with `cap` bounded by what the arc through the target allows; turn [rad/s]. 40 s at most.
    """
    pose, poses = np.zeros(3), [np.zeros(3)]
    for _ in range(int(LAP / 0.1)):
        if np.hypot(target[0] - pose[0], target[1] - pose[1]) <= radius:
            return np.array(poses), True
        error = float(wrap(np.arctan2(target[1] - pose[1], target[0] - pose[0]) - pose[2]))
        v = min(speed, fusion.arc_cap(pose, target, turn)) if cap else speed
        pose = move(pose, [v, float(np.clip(error / 0.1, -turn, turn))], 0.1)
        poses.append(pose)
    return np.array(poses), False


def orbit_lab(figure: Figure) -> Update:
    """A sub-goal to drag beside a robot that keeps its speed, and the two circles that it cannot enter."""
    ax = figure.subplots()
    metric_axes(ax, (-4.0, 8.0, -4.0, 5.0))
    draw_robot(ax, HERE, 0.3)
    zone = PolyCollection([], facecolors="#DDDDDD", edgecolors="#888888", zorder=1)
    ax.add_collection(zone)
    path, (star,) = draw_path(ax, np.empty((0, 2))), draw_goal(ax, (0.0, 0.0))

    def update(ahead: float, aside: float, speed: float, turn: float, cap: str) -> tuple[list[Artist], str]:
        poses, there = orbit_path((ahead, aside), speed, turn, cap=cap == "capped by the arc")
        round_ = speed / turn
        zone.set_verts(circles([[0.0, round_, round_], [0.0, -round_, round_]]))
        path.set_data(*poses[:, :2].T)
        star.set_data([ahead], [aside])  # type: ignore[attr-defined]
        least = float(np.hypot(*(poses[:, :2] - (ahead, aside)).T).min())
        end = f"there after {(len(poses) - 1) * 0.1:.1f} s" if there else f"orbits, never nearer than {least:.2f} m"
        return [zone, path, star], f"circle of radius {speed:.2f}/{turn:.2f} = {round_:.2f} m; {end}"

    return update


# --- a hall to fill -------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class HallRun:
    """One driven hall with the moments of its planner."""

    task: fusion.Task
    driven: Driven
    moments: list[fusion.Moment]


@lru_cache(maxsize=16)
def _hall_run(block: tuple[float, float], walker: tuple[float, float], movers: str) -> HallRun:
    """The thesis's robot in a hall with a block and two walkers; walker: x [m] of the first, speed [m/s] of both."""
    x, speed = walker
    task = fusion.hall_task(
        blocks=[block],
        walkers=[[x, 1.2, x, 6.8, speed], [9.2, 6.8, 9.2, 1.2, speed]] if speed > 0 else [],
        robot=THESIS,
        ideal=movers == "told by an ideal tracker",
    )
    driven, moments = fusion.watch(task)
    return HallRun(task, driven, moments)


class HallPicture:
    """The artists of the hall's lab, placed for any moment of any run."""

    def __init__(self, figure: Figure) -> None:
        axes = figure.subplot_mosaic("mw", width_ratios=[1.7, 1.0])
        ax = axes["m"]
        draw_grid(ax, fusion.HALL)
        self.block = Rectangle((0, 0), 0.8, 0.8, facecolor=COLORS["unknown"], hatch="///", zorder=2)
        self.people = PolyCollection([], facecolors=COLORS["mover"], edgecolors="black", zorder=4)
        ax.add_patch(self.block)
        ax.add_collection(self.people)
        self.driven, self.whole = draw_path(ax, np.empty((0, 2))), draw_path(ax, np.empty((0, 2)), role="unknown")
        self.map, self.ahead, self.reach = map_mark(ax, fusion.HALL.extent), prediction_mark(ax), reach_mark(ax)
        draw_goal(ax, (11.0, 4.0))
        self.body = draw_robot(ax, HERE, 0.3)
        self.window = reason_mark(axes["w"], THESIS)
        axes["w"].set_title("squares by score, circle chosen", fontsize=9)
        figure.legend(handles=list(self.window.refused), loc="outside lower center", ncols=4, fontsize=8.5)

    @property
    def artists(self) -> list[Artist]:
        """All that moves."""
        marks = [a for mark in (self.map, self.ahead, self.reach, self.window) for a in mark.artists]
        return [self.block, self.people, self.driven, self.whole, *self.body.artists, *marks]

    def place(self, made: HallRun, run: Run, k: int, block: tuple[float, float]) -> None:
        """Show step k of a run past a block with this centre."""
        seen = made.moments[k]
        pose, command = seen.observation.pose, seen.decision.command
        self.block.set_xy((block[0] - 0.4, block[1] - 0.4))
        spots = run.log["movers"][k] if made.task.world.movers else np.empty((0, 2))
        self.people.set_verts(circles(np.column_stack([spots, np.full(len(spots), 0.3)])))
        self.driven.set_data(*run.poses[: k + 1, :2].T)
        self.whole.set_data(*run.poses[:, :2].T)
        self.body.place(pose)
        self.map.place(seen)
        self.ahead.place(seen.around.movers, 3.0, fusion.Params().growth)
        self.reach.place(pose, command, seen.around.hazards, made.task.speed_bound, THESIS, made.task.dt)
        self.window.place(seen.decision, seen.observation.velocity)


def hall_lab(figure: Figure) -> Update:
    """A hall with a block and walkers to place; any moment of the run that follows, with all that the planner knew."""
    picture = HallPicture(figure)

    def update(
        time: float, block_x: float, block_y: float, walker_x: float, speed: float, movers: str
    ) -> tuple[list[Artist], str]:
        made = _hall_run((block_x, block_y), (walker_x, speed), movers)
        run, row = made.driven.run, made.driven.row
        if run is None or not made.moments:
            return [], f"no run: {row['reason'] or row['status']}"
        k = min(round(time / 0.1), len(made.moments) - 1)
        picture.place(made, run, k, (block_x, block_y))
        seen = made.moments[k]
        text = (
            f"{run.t[k]:.1f} of {run.duration:.1f} s: v = {seen.observation.velocity[0]:.2f} m/s, search "
            f"{seen.searches}, {int(seen.entered.sum())} cells entered, {_counted(seen.decision)}; in the end: "
            f"{row['ending']}"
        )
        return picture.artists, text

    return update


def _counted(made: fusion.Decision) -> str:
    """How much of the window is refused, and by what."""
    guarded, refused = int((made.reasons == 3).sum()), int((made.reasons != 0).sum())
    return f"{refused} of {len(made.samples)} samples refused, {guarded} of them by the guard"


# --- weights and safety ---------------------------------------------------------------------------

LAYERS = ("guard and prediction", "guard alone", "prediction alone", "neither")
WALKERS = ((3.4, 6.4, 3.4, 1.4, 0.45), (9.0, 1.2, 9.0, 6.6, 0.35), (7.6, 6.6, 11.0, 2.4, 0.3))


def guard_run(
    weights: tuple[float, float, float, float], reserve: float, layers: str, robot: str
) -> tuple[fusion.Task, Driven]:
    """The hall with a block and three walkers who do not yield, driven with these weights and layers of safety."""
    task = fusion.hall_task(blocks=[(8.0, 2.0)], walkers=WALKERS, robot=fusion.ROBOTS[robot], courtesy=0.0)
    params = fusion.Params(
        weights=weights if sum(weights) > 0 else (1.0, 0.0, 0.0, 0.0),
        reserve=reserve,
        guard="guard" in layers,
        sim_time=3.0 if "prediction" in layers else 0.0,
    )
    driven, _ = fusion.watch(task, params)
    return task, driven


def guard_lab(figure: Figure) -> Update:
    """One hall, three walkers who do not yield: path and clearance for weights and layers of safety by hand."""
    ax, gap = figure.subplots(1, 2, width_ratios=[1.5, 1.0])
    draw_grid(ax, fusion.HALL)
    ax.add_patch(Rectangle((7.6, 1.6), 0.8, 0.8, facecolor=COLORS["unknown"], hatch="///", zorder=2))
    for x1, y1, x2, y2, _ in WALKERS:
        ax.plot([x1, x2], [y1, y2], color=COLORS["mover"], linestyle=":", zorder=2)
    people = PolyCollection([], facecolors=COLORS["mover"], edgecolors="black", zorder=4)
    ax.add_collection(people)
    draw_goal(ax, (11.0, 4.0))
    path, body = draw_path(ax, np.empty((0, 2))), draw_robot(ax, HERE, 0.3)
    (room,) = gap.plot([], [], color=COLORS["path"], linestyle="-", label="clearance [m]")
    (speed,) = gap.plot([], [], color=COLORS["robot"], linestyle="--", label="$v$ [m/s]")
    gap.set(xlim=(0, 60), ylim=(0, 1.6), xlabel="t [s]")
    gap.legend(loc="upper right")

    def update(
        alpha: float, beta: float, gamma: float, delta: float, reserve: float, layers: str, robot: str
    ) -> tuple[list[Artist], str]:
        _, made = guard_run((alpha, beta, gamma, delta), reserve, layers, robot)
        run, row = made.run, made.row
        if run is None:
            return [], f"no run: {row['reason']}"
        path.set_data(*run.poses[:, :2].T)
        body.place(run.poses[-1])
        people.set_verts(circles(np.column_stack([run.log["movers"][-1], np.full(len(WALKERS), 0.3)])))
        room.set_data(run.t[:-1], run.clearance)
        speed.set_data(run.t[:-1], run.commands[:, 0])
        text = f"{row['ending']} after {run.duration:.1f} s, {run.length:.1f} m; before the end never nearer than "
        return [path, *body.artists, people, room, speed], text + f"{max(row['clearance'], 0.0):.2f} m"

    return update


# --- what the speed bound forbids -----------------------------------------------------------------


def bound_lab(figure: Figure) -> Update:
    """A walker to place and a speed bound V: what the guard forbids in the plane of speeds, and one braking arc."""
    ax, plane = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    metric_axes(ax, (-1.5, 5.5, -3.0, 3.0))
    draw_robot(ax, HERE, 0.3)
    reach, disc = reach_mark(ax), PolyCollection([], facecolors=COLORS["mover"], edgecolors="black", zorder=4)
    ax.add_collection(disc)
    image = plane.imshow(
        np.zeros((2, 2)), origin="lower", aspect="auto", cmap=ListedColormap(["white", COLORS["mover"]]), vmin=0, vmax=1
    )
    (at,) = plane.plot([], [], "o", color=COLORS["robot"], markersize=9, markeredgecolor="black", zorder=4)
    plane.set(xlabel=r"$\omega$ [rad/s], left turn to the left", ylabel="$v$ [m/s]")
    plane.set_title("orange: refused by the guard", fontsize=9)
    plane.grid(False)
    names: dict[str, Robot] = {"TurtleBot2, brakes 2.5 m/s²": fusion.ROBOTS["turtlebot2"], "thesis, 0.2 m/s²": THESIS}

    def update(bound: float, away: float, bearing: float, v: float, omega: float, robot: str) -> tuple[None, str]:
        body, turn = names[robot], np.radians(bearing)
        sample = [min(v, body.max_vel_x), float(np.clip(omega, -body.max_vel_theta, body.max_vel_theta))]
        walker = [[(away + 0.6) * np.cos(turn), (away + 0.6) * np.sin(turn), 0.3]]
        refused, vs, omegas = forbidden(body, walker, bound)
        image.set_data(refused)
        image.set_extent((omegas[0], omegas[-1], vs[0], vs[-1]))
        plane.set(xlim=(omegas[-1], omegas[0]), ylim=(vs[0], vs[-1]))
        disc.set_verts(circles(walker))
        reach.place(HERE, sample, walker, bound, body, 0.1)
        at.set_data([sample[1]], [sample[0]])
        ok = fusion.stays_clear(HERE, sample, walker, bound, body, 0.1)
        asked = float(fusion.passive_separation(sample[0], bound, body, 0.1))
        text = (
            f"{100 * refused.mean():.0f} % of the plane refused; this sample: {'allowed' if ok else 'refused'}, the "
            f"theorem asks for {asked:.2f} m, there are {away:.2f} m"
        )
        return None, text

    return update
