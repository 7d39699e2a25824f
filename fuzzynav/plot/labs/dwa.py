"""Labs of local planning: the scrubber through a run, weights, membership sets, an obstacle to drag, a player."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from fuzzynav import dwa
from fuzzynav.control import Observation
from fuzzynav.dwa.decision import Field, Plan
from fuzzynav.dwa.fast import drive, shipped
from fuzzynav.dwa.steps import Params
from fuzzynav.dwa.weights import retuned
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.plot.base import COLORS, draw_goal, draw_path, draw_robot, metric_axes
from fuzzynav.plot.blit import Update
from fuzzynav.plot.dwa import arc_mark, window_mark
from fuzzynav.plot.runs import draw_world, mover_marks
from fuzzynav.robot import THESIS, Robot
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

__all__ = ["dwa_scrubber", "fuzzy_sets_lab", "obstacle_lab", "weights_lab"]


def dwa_scrubber(
    figure: Figure,
    *,
    run: Run,
    plans: Sequence[Plan],
    world: World,
    robot: Robot = THESIS,
    params: Params = dwa.TABLE_3_3,
) -> Update:
    """Any moment of a run: the map with the candidate arcs, and the velocity window of that decision."""
    axes = figure.subplot_mosaic("mw\nmt", width_ratios=[1.15, 1.0], height_ratios=[1.5, 1.0])
    draw_world(axes["m"], world)
    draw_path(axes["m"], run.poses, role="unknown")
    draw_goal(axes["m"], run.goal)
    arcs, body = arc_mark(axes["m"], params.sim_time), draw_robot(axes["m"], run.poses[0], robot.radius)
    movers = mover_marks(axes["m"], world, run)
    window = window_mark(axes["w"], robot, params)
    figure.colorbar(window.scored, ax=axes["w"], label="score, low to high", ticks=[])
    for k, (role, dash, label) in enumerate((("robot", "-", "$v$ [m/s]"), ("path", "--", r"$\omega$ [rad/s]"))):
        axes["t"].plot(run.t[:-1], run.commands[:, k], color=COLORS[role], linestyle=dash, label=label)
    axes["t"].set(xlabel="t [s]", xlim=(0.0, run.duration), ylim=(-0.45, 1.45))
    axes["t"].legend(loc="upper right", ncols=2)
    now = axes["t"].axvline(0.0, color=COLORS["goal"], linestyle="-")
    speeds = np.vstack([np.zeros(2), run.commands])

    def update(frame: int) -> tuple[list[Artist], str]:
        plan, pose = plans[frame], run.poses[frame]
        arcs.place(plan, pose)
        body.place(pose)
        movers.place(frame)
        window.place(plan, speeds[frame])
        now.set_xdata([run.t[frame]] * 2)
        refused = int((~plan.admissible).sum())
        text = (
            f"{run.t[frame]:.1f} s: v = {speeds[frame, 0]:.2f} m/s, {len(plan.samples)} samples, "
            f"{refused} refused, {'braking' if plan.braking else 'free'}, nearest {plan.nearest:.2f} m"
        )
        return [*arcs.artists, *body.artists, *movers.artists, *window.artists, now], text

    return update


def weights_lab(figure: Figure, *, world: World, start: Sequence[float], goal: Sequence[float]) -> Update:
    """Paths with the weights of the sliders, and with a rule base or the printed weights beside them."""
    assert world.grid is not None
    field = Field.of(world.grid)
    ax, speed = figure.subplots(1, 2, width_ratios=[1.2, 1.0])
    draw_world(ax, world)
    draw_goal(ax, goal)
    mine = draw_path(ax, np.empty((0, 2)), role="path", label="sliders")
    other = draw_path(ax, np.empty((0, 2)), role="robot", label="rival", linestyle="--")
    ax.legend(loc="upper left")
    (fast,) = speed.plot([], [], color=COLORS["path"], linestyle="-")
    (rival_fast,) = speed.plot([], [], color=COLORS["robot"], linestyle="--")
    speed.set(xlim=(0, 60), ylim=(0, 1.05), xlabel="t [s]", ylabel="$v$ [m/s]")

    def update(alpha: float, beta: float, gamma: float, rival: str) -> tuple[list[Artist], str]:
        weights = (alpha, beta, gamma) if alpha + beta + gamma > 0 else (1.0, 1.0, 1.0)
        rules = {"fuzzy, 9 rules": "thesis_table_3_2", "fuzzy, 27 rules": "thesis_table_3_2_completed"}.get(rival)
        tables = shipped(rules) if rules else None
        made = [
            drive(world, start, goal, Params(weights=weights), field=field, t_max=60.0),
            drive(world, start, goal, field=field, rules=tables, t_max=60.0),
        ]
        for one, path, line in zip(made, (mine, other), (fast, rival_fast), strict=True):
            path.set_data(*one.poses[:, :2].T)
            line.set_data(np.arange(one.iterations) * one.dt, one.commands[:, 0])
        words = [f"{m.status}, {m.length:.1f} m, {m.iterations} steps, clearance {m.min_clearance:.2f} m" for m in made]
        return [mine, other, fast, rival_fast], f"sliders: {words[0]}. {rival}: {words[1]}"

    return update


def fuzzy_sets_lab(figure: Figure, *, system: FuzzySystem) -> Update:
    """Nine sets by sliders, and the three weight surfaces over heading and speed at one obstacle distance."""
    axes = figure.subplots(2, 3, height_ratios=[1.0, 1.3])
    lines = []
    for ax, variable in zip(axes[0], system.inputs, strict=True):
        ax.set(xlim=(variable.low, variable.high), ylim=(0.0, 1.05), xlabel=f"{variable.name} [{variable.unit}]")
        lines += [
            ax.plot([], [], color=c, linestyle=d)[0]
            for c, d in ((COLORS["robot"], "-"), (COLORS["path"], "--"), (COLORS["reference"], "-."))
        ]
    head, vel = np.linspace(0, 180, 31), np.linspace(0, 1, 31)
    images = []
    for ax, name in zip(axes[1], (r"$\alpha$", r"$\beta$", r"$\gamma$"), strict=True):
        image = ax.imshow(np.zeros((31, 31)), origin="lower", aspect="auto", extent=(0, 180, 0, 1), vmin=0, vmax=1)
        ax.set_facecolor("black")
        ax.grid(False)
        ax.set(title=name, xlabel="headGoal [deg]")
        images.append(image)
    axes[1, 0].set_ylabel("velRob [m/s]")
    figure.colorbar(images[0], ax=axes.ravel().tolist(), label="weight; black: no rule")

    def update(
        head_peak: float, dist_peak: float, vel_peak: float, reach: float, distance: float
    ) -> tuple[list[Artist], str]:
        peaks = {"headGoal": head_peak, "distObs": dist_peak, "velRob": vel_peak}
        tuned = retuned(system, peaks, dict.fromkeys(peaks, reach))
        for k, variable in enumerate(tuned.inputs):
            for j, term in enumerate(variable.terms):
                a, b, c = term.parameters
                lines[3 * k + j].set_data([a, b, c], [float(a == b), 1.0, float(b == c)])
        found = tuned.evaluate(head[None, :], distance, vel[:, None])
        bare = ~(np.asarray(found.firing).max(axis=-1) > 0)
        for image, value in zip(images, found.values, strict=True):
            image.set_data(np.ma.masked_where(bare, np.broadcast_to(value, bare.shape)))
        return [*lines, *images], f"no rule fires on {100 * bare.mean():.0f} % of this slice"

    return update


def obstacle_lab(figure: Figure, *, robot: Robot = THESIS, params: Params = dwa.TABLE_3_3) -> Update:
    """A disc to drag before a robot that drives: arcs and window of the decision."""
    ax, plane = figure.subplots(1, 2, width_ratios=[1.4, 1.0])
    metric_axes(ax, (-0.8, 5.2, -2.2, 2.2))
    draw_robot(ax, (0, 0, 0), robot.radius)
    draw_goal(ax, (5.0, 0.0))
    disc = ax.add_patch(Circle((2, 0), 0.3, facecolor=COLORS["obstacle"], zorder=2))
    arcs, window = arc_mark(ax, params.sim_time), window_mark(plane, robot, params)

    def update(x: float, y: float, v: float, omega: float) -> tuple[list[Artist], str]:
        disc.center = (x, y)
        turn = np.linspace(0, 2 * np.pi, 72, endpoint=False)
        points = np.column_stack([x + 0.3 * np.cos(turn), y + 0.3 * np.sin(turn)])
        seen = Observation(
            time=0.0, pose=np.zeros(3), velocity=np.array([v, omega]), points=points, goal=np.array([5.0, 0.0])
        )
        plan = dwa.plan(seen, robot, params)
        arcs.place(plan, (0, 0, 0))
        window.place(plan, (v, omega))
        word = "nothing admissible: full braking" if plan.braking else "drives"
        text = (
            f"{int((~plan.admissible).sum())} of {len(plan.samples)} refused, {word}, "
            f"v -> {plan.command[0]:.2f} m/s, omega -> {plan.command[1]:+.2f} rad/s"
        )
        return [disc, *arcs.artists, *window.artists], text

    return update
