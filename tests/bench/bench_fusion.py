"""Speed of chapter 07: one decision, one step of the whole planner, one update of the tracker, one search, a scene."""

import time
from dataclasses import replace
from statistics import median

import numpy as np

from fuzzynav import fusion
from fuzzynav.control import Observation
from fuzzynav.fusion.protocol import drive
from fuzzynav.fusion.route import route
from fuzzynav.planning.astar import OPTIMAL
from fuzzynav.sensors import Laser, laser_ideal
from fuzzynav.world import World

ROBOT = fusion.ROBOTS["turtlebot2"]


def timed(action, repeats):
    """Median seconds of an action."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return median(times)


def row(task, unit, ours, peer=None, peer_name="no installed program does this", agreement=""):
    ratio = None if peer is None else peer / ours
    return {
        "task": task, "unit": unit, "ours": ours, "peer": peer, "peer_name": peer_name, "ratio": ratio,
        "agreement": agreement,
    }  # fmt: skip


def crowd():
    """What a TurtleBot2 sees in the middle of a scene: some 100 hits of 130 beams, four movers within 4 m."""
    task, pose = fusion.scene_task(1), np.array([8.6, 9.0, 0.8])
    rows = np.array([[10.6, 9.4, -0.3, 0.1, 0.3], [8.0, 12.0, 0.2, -0.2, 0.3], [6.6, 7.0, 0.0, 0.4, 0.3],
                     [11.5, 11.5, 0.1, 0.1, 0.3]])  # fmt: skip
    world = World(grid=task.world.grid, unknown_discs=rows[:, [0, 1, 4]])
    laser = Laser(beams=130, field_of_view=2.0 * np.pi, range_min=0.0, range_max=10.0, noise=0.0)
    scan = laser_ideal(world, pose, laser)
    return Observation(
        time=0.0, pose=pose, velocity=np.array([0.3, 0.1]), goal=task.goal, points=scan.world_points(pose),
        ranges=scan.ranges, angles=scan.angles, range_max=10.0, movers=rows,
    )  # fmt: skip


def guest_row(seen, ours):
    """navground's ORCA among the same movers: one command."""
    try:
        from navground import core
    except ImportError:
        return row("a command among 4 movers, against ORCA", "us", ours, peer_name="navground is not installed")
    behavior = core.Behavior.make_type("ORCA")
    behavior.kinematics = core.kinematics.TwoWheelsDifferentialDriveKinematics(ROBOT.max_vel_x, ROBOT.track, 2.0)
    behavior.radius, behavior.horizon = ROBOT.radius, 5.0
    behavior.pose = core.Pose2((8.6, 9.0), 0.8)
    behavior.environment_state.neighbors = [
        core.Neighbor(position=(float(x), float(y)), radius=float(r), velocity=(float(u), float(w)), id=k)
        for k, (x, y, u, w, r) in enumerate(seen.movers)
    ]
    behavior.environment_state.static_obstacles = [core.Disc((float(x), float(y)), 0.01) for x, y in seen.points]
    behavior.target = core.Target.Point((18.5, 18.5))
    theirs = 1e6 * timed(lambda: behavior.compute_cmd(0.1), 300)
    return row("a command among 4 movers and 100 points", "us", ours, theirs, "navground ORCA", "no guarantee there")


def rows():
    """All rows of this benchmark."""
    seen = crowd()
    around = fusion.surroundings(seen, ROBOT.radius, 0.2, chart=None, tracks=None, tell=0.15)
    params = fusion.Params()
    target = np.array([11.0, 11.0])
    decision = 1e6 * timed(lambda: fusion.decide(seen, target, around, ROBOT, params, 0.5), 300)
    navigator = fusion.Navigator(ROBOT, speed_bound=0.5, chart=fusion.scene_task(1).chart)
    clock = iter(range(10**6))
    step = 1e6 * timed(lambda: navigator(replace(seen, time=0.1 * next(clock))), 300)
    tracker, moments = fusion.Tracker(), iter(range(10**6))
    told = replace(seen, movers=None)
    update = 1e6 * timed(lambda: tracker.update(replace(told, time=0.1 * next(moments))), 300)
    task = fusion.scene_task(1)
    fine = fusion.Memory(task.chart, 0.1)
    fine.enter(seen, np.zeros(len(seen.points), dtype=bool))
    grid, rooms = fine.grid(), fusion.Planning().rooms
    search = 1e3 * timed(lambda: route(grid, task.start[:2], task.goal, ROBOT.radius, rooms, OPTIMAL), 50)
    scene = timed(lambda: drive(task, fusion.METHODS["ours"]), 3)
    return [
        row("decision among some 100 points and 4 movers", "us", decision),
        row("step of the whole planner, some 100 points, 4 movers told", "us", step),
        guest_row(seen, decision),
        row("tracker, one scan of 130 beams", "us", update),
        row("a way over 200 x 200 cells, with the search for room", "ms", search),
        row("one scene of 20 x 20 m driven to the goal", "s", scene),
    ]
