"""Speed of local planning: one control step at the thesis parameters, a whole run, runs per minute on two cores.

Peers: the same steps in NumPy (`dwa_steps`, one call for each equation), whose choice must be the same; and
PythonRobotics, which is no package: set PYTHON_ROBOTICS to the folder of a checkout. Its costs differ, so only its
number of arcs and its horizon are made ours. Times are CPU seconds.
"""

import importlib.util
import os
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

from fuzzynav import batch, dwa, simulate
from fuzzynav.control import Observation
from fuzzynav.dwa.fast import drive
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import THESIS
from fuzzynav.studies.dwa import comparison, safety

SPEED = np.array([0.5, 0.1])
GOAL = np.array([5.0, 2.0])
PARAMS = dwa.Params(omega_resolution=0.0175)  # 5 x 11 arcs, zero and full braking


def seconds(action, repeats):
    """Median CPU seconds of a call over `repeats` batches of ten, after a first one that does not count."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(10):
            action()
        times.append((time.process_time() - start) / 10)
    return float(np.median(times))


def scene(count):
    rng = np.random.default_rng(count)
    points = rng.uniform(-5, 5, (4 * count, 2))
    points = points[np.hypot(*points.T) > 1.0][:count]
    return Observation(time=0.0, pose=np.zeros(3), velocity=SPEED, points=points, goal=GOAL)


def by_steps(seen):
    """The plan by the open functions, one for each equation."""
    samples = dwa.window(seen.velocity, THESIS, PARAMS)
    free = dwa.free_distance(seen.pose, samples, seen.points, THESIS.radius)
    ok = dwa.admissible(samples, free, THESIS, PARAMS.dt)
    raw = np.column_stack(
        [
            dwa.heading_score(seen.pose, samples, seen.goal, PARAMS.sim_time),
            dwa.distance_score(free, PARAMS.d_max),
            dwa.speed_score(samples),
        ]
    )
    totals = np.where(ok, 0.0, -np.inf)
    totals[ok] = dwa.objective(dwa.normalise(raw[ok]), PARAMS.weights)
    return samples[int(np.argmax(totals))]


def python_robotics():
    """Its module, or None."""
    folder = os.environ.get("PYTHON_ROBOTICS")
    path = Path(folder or ".") / "PathPlanning/DynamicWindowApproach/dynamic_window_approach.py"
    if not folder or not path.exists():
        return None
    spec = importlib.util.spec_from_file_location("python_robotics_dwa", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def their_step(module, seen):
    """One call of PythonRobotics with our window, horizon and number of arcs."""
    config = module.Config()
    config.max_speed, config.min_speed, config.max_accel, config.v_reso = 1.0, 0.0, 0.2, 0.01
    config.max_yawrate, config.max_dyawrate, config.yawrate_reso = 0.35, 0.87, 0.0175
    config.dt, config.predict_time, config.robot_radius = 0.1, 3.0, THESIS.radius
    state = np.array([0.0, 0.0, 0.0, *SPEED])
    return lambda: module.dwa_control(state, config, GOAL, seen.points)


def row(task, unit, ours, peer, name, agreement):
    return {
        "task": task,
        "unit": unit,
        "ours": ours,
        "peer": peer,
        "peer_name": name,
        "ratio": None if peer is None else peer / ours,
        "agreement": agreement,
    }


def steps():
    """Microseconds of one decision with all its samples kept."""
    out, module = [], python_robotics()
    for count in (20, 100, 500):
        seen = scene(count)
        mine = 1e6 * seconds(lambda seen=seen: dwa.plan(seen, THESIS, PARAMS), 150)
        open_ = 1e6 * seconds(lambda seen=seen: by_steps(seen), 15)
        made = dwa.plan(seen, THESIS, PARAMS)
        same = np.allclose(made.command, by_steps(seen), atol=1e-12)
        task = f"DWA step, {len(made.samples)} samples, {count} points"
        out.append(row(task, "us", mine, open_, "the same steps, one call each", "same command" if same else "DIFFERS"))
        theirs = None if module is None else 1e6 * seconds(their_step(module, seen), 2)
        word = "not here: set PYTHON_ROBOTICS" if module is None else "same window and horizon, other costs"
        out.append(row(task, "us", mine, theirs, "PythonRobotics", word))
    return out


def on_a_field():
    grid = GridMap(np.random.default_rng(0).random((20, 20)) < 0.1)
    field = dwa.Field.of(grid)
    free = np.argwhere(~grid.occupied)[100][::-1] + 0.5
    seen = Observation(time=0.0, pose=np.array([*free, 0.3]), velocity=SPEED, points=np.empty((0, 2)), goal=GOAL)
    mine = 1e6 * seconds(lambda: dwa.plan(seen, THESIS, PARAMS, field=field), 40)
    return [row("DWA step on a distance field", "us", mine, None, "none", "no peer plans on a field of its own")]


def runs():
    """Simulated seconds for one second of computing, open and compiled; runs per minute on two cores."""
    world, field = comparison._scene("0.05/3")
    params = dwa.TABLE_4_1

    def open_():
        controller = dwa.Controller(THESIS, params, field=field)
        return simulate.run(world, THESIS, controller, comparison.START, comparison.GOAL)

    run = open_()
    slow = seconds(open_, 1)
    made = drive(world, comparison.START, comparison.GOAL, params, field=field)
    fast = seconds(lambda: drive(world, comparison.START, comparison.GOAL, params, field=field), 3)
    return [
        row("simulate.run, scan of 360 beams and field", "s simulated per s", run.duration / slow, None, "none", "-"),
        row("compiled closed loop", "runs per minute and core", 60.0 / fast, None, "none", f"same run: {made.status}"),
    ]


def sweep():
    """Runs per minute of `batch` on two processes, wall clock, once both have started."""
    with ProcessPoolExecutor(2) as pool:
        batch.run(safety.outcome, range(30_000, 30_008), executor=pool, chunk=4, progress=False)
        start = time.perf_counter()
        batch.run(safety.outcome, range(30_008, 30_168), executor=pool, progress=False)
        minutes = (time.perf_counter() - start) / 60.0
    return [row("batch on two processes, 720 beams", "runs per minute", 160 / minutes, None, "none", "wall clock")]


def rows():
    return steps() + on_a_field() + runs() + sweep()
