"""Does the robot ever touch anything? Thousands of seeded static worlds, weights drawn anew for each, ideal sensing.

Ideal means 360 degrees, 720 beams, a range of at least v^2/2a + radius + 0.5 m, exact odometry. Every tenth world
takes the corners of the sliders: one weight alone, or the highest and lowest limits of the robot.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from fuzzynav import simulate
from fuzzynav.dwa.controller import Controller, Stuck
from fuzzynav.dwa.fast import drive
from fuzzynav.dwa.steps import Params
from fuzzynav.geometry import Array
from fuzzynav.robot import THESIS, Robot
from fuzzynav.sensors import EXACT, Laser, Odometry
from fuzzynav.simulate.loop import IDEAL_LASER, Loop
from fuzzynav.world import World

__all__ = [
    "NOISE",
    "SEEDS",
    "case_of",
    "noisy_outcome",
    "open_run",
    "outcome",
    "setting",
    "world_of",
]

SEEDS = 10_000
NOISY_SEEDS = 60
T_MAX = 40.0  # [s]
ENDS = Loop(stall_time=5.0)
REMEDIES = ("none", "margin 0.1 m", "window on the command")
SIZE = 16.0  # [m]
CORNERS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 1.0, 1.0), (1.0, 0.0, 1.0))
UNEVEN = Odometry(noise=(0.05, 0.05))
NOISE = {
    "ideal": (IDEAL_LASER, EXACT),
    "scan 2 cm": (replace(IDEAL_LASER, noise=0.02), EXACT),
    "scan 5 cm": (replace(IDEAL_LASER, noise=0.05), EXACT),
    "odometry 5 %": (IDEAL_LASER, UNEVEN),
    "odometry bias 5 %": (IDEAL_LASER, Odometry(bias=(-0.05, 0.0))),
    "scan 2 cm, odometry 5 %": (replace(IDEAL_LASER, noise=0.02, dropout=0.02), UNEVEN),
}


def world_of(rng: np.random.Generator, robot: Robot) -> tuple[World, Array, Array]:
    """Discs of 0.1 to 0.8 m and turned rectangles in a walled square, with a start and a goal where the robot fits."""
    discs = np.column_stack([rng.uniform(0, SIZE, (40, 2)), rng.uniform(0.1, 0.8, 40)])[: rng.integers(0, 31)]
    boxes = np.column_stack([rng.uniform(0, SIZE, (20, 2)), rng.uniform(0.2, 3.0, (20, 2)), rng.uniform(0, np.pi, 20)])
    world = World(discs=discs, rectangles=boxes[: rng.integers(0, 13)], bounds=(0.0, SIZE, 0.0, SIZE))
    while True:
        points = rng.uniform(1.0, SIZE - 1.0, (400, 2))
        fits = points[world.clearance(points) > robot.radius + 0.05]
        if len(fits) < 2:
            world = World(bounds=world.bounds)
            continue
        start = fits[0]
        far = fits[np.argmax(np.hypot(*(fits - start).T))]
        return world, np.append(start, rng.uniform(-np.pi, np.pi)), far


def setting(rng: np.random.Generator, corner: bool) -> tuple[Robot, Params]:
    """A robot and weights: drawn at random, or from the corners of what sliders allow."""
    weights = CORNERS[rng.integers(len(CORNERS))] if corner else tuple(rng.dirichlet([1.0, 1.0, 1.0]))
    top, braking = (rng.choice([0.3, 1.5]), rng.choice([0.2, 1.0])) if corner else (1.0, 0.2)
    turn, low = (rng.choice([0.35, 2.0]), rng.choice([0.0, -0.3])) if corner else (0.35, 0.0)
    robot = replace(
        THESIS,
        max_vel_x=float(top),
        acc_lim_x=float(braking),
        dec_lim_x=float(braking),
        max_vel_theta=float(turn),
        acc_lim_theta=float(max(0.87, turn)),
        min_vel_x=float(low),
    )
    resolution = robot.acc_lim_x * 0.05
    omega_step = robot.acc_lim_theta * 0.02
    return robot, Params(weights=weights, v_resolution=resolution, omega_resolution=omega_step)


def case_of(seed: int) -> tuple[World, Robot, Params, Array, Array, Laser]:
    """Everything that the seed decides: world, robot, parameters, start, goal, and an ideal scan of the least range."""
    rng = np.random.default_rng([4, seed])
    robot, params = setting(rng, seed % 10 == 9)
    world, start, goal = world_of(rng, robot)
    reach = robot.max_vel_x**2 / (2.0 * robot.dec_lim_x) + robot.radius + 0.5
    return world, robot, params, start, goal, replace(IDEAL_LASER, range_max=float(np.ceil(10.0 * reach) / 10.0))


def outcome(seed: int) -> dict[str, Any]:
    """The safety run of one seed, ideal sensing, on the compiled loop."""
    world, robot, params, start, goal, laser = case_of(int(seed))
    made = drive(world, start, goal, params, robot=robot, laser=laser, t_max=T_MAX, loop=ENDS)
    w = params.weights
    return {
        "corner": int(int(seed) % 10 == 9),
        "alpha": round(w[0], 3),
        "beta": round(w[1], 3),
        "gamma": round(w[2], 3),
        "status": made.status,
        "contacts": int(made.status == "collided"),
        "clearance": round(made.min_clearance, 4),
        "iterations": made.iterations,
        "braking": int(made.log["braking"].sum()),
        "metres": round(made.length, 2),
        "top_speed": round(float(np.abs(made.commands[:, 0]).max(initial=0.0)), 3),
    }


def open_run(seed: int, noise: str = "", remedy: str = "none", tries: int = 0) -> simulate.Run:
    """The same case through `simulate.run`, where noise, a remedy and recovery are possible."""
    world, robot, params, start, goal, laser = case_of(seed)
    odometry = EXACT
    if noise:
        noisy, odometry = NOISE[noise]
        laser = replace(noisy, beams=720, range_max=laser.range_max)
    params = replace(params, margin=0.1 if "margin" in remedy else 0.0)
    controller = Controller(robot, params, stuck=Stuck(tries=tries), on_command="command" in remedy)
    return simulate.run(
        world, robot, controller, start, goal, t_max=T_MAX, laser=laser, odometry=odometry, rng=seed, loop=ENDS
    )


def noisy_outcome(seed: int) -> list[dict[str, Any]]:
    """The same world with every kind of noise and every remedy."""
    rows: list[dict[str, Any]] = []
    for name in NOISE:
        for remedy in REMEDIES:
            run = open_run(int(seed), name, remedy)
            speed = abs(float(run.commands[-1, 0])) if run.contacts_moving else 0.0
            rows.append(
                {
                    "noise": name,
                    "remedy": remedy,
                    "status": run.status,
                    "contacts": run.contacts_moving,
                    "clearance": round(run.min_clearance, 4),
                    "iterations": run.iterations,
                    "speed_at_contact": round(speed, 3),
                }
            )
    return rows
