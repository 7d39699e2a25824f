"""Speed of trajectory tracking: one control step of each law, MPC included, and whole runs of the figure eight."""

import time
from statistics import median

import numpy as np

from fuzzynav import tracking
from fuzzynav.tracking.records import POSE, SPEEDS
from fuzzynav.tracking.reference import FigureEight

EIGHT = FigureEight()
LAWS = {
    "DFL": tracking.Dfl(),
    "linear flatness": tracking.Flatness(),
    "Kanayama": tracking.Kanayama(),
    "PID": tracking.Pid(),
    "LQR": tracking.Lqr(),
    "sliding mode": tracking.Sliding(),
    "MPC, horizon 15": tracking.Mpc(),
}


def step_time(law):
    """Median microseconds of controller(observation), 1 cm off the reference."""
    poses, speeds = (np.stack([law.rows[name] for name in names], axis=-1) for names in (POSE, SPEEDS))
    times = []
    for k in range(1000):
        seen = tracking.seen(0.1 * k, poses[k] + 0.01, speeds[k])
        begin = time.perf_counter()
        law(seen)
        times.append(time.perf_counter() - begin)
    return 1e6 * median(times)


def run_time(law, repeats, **options):
    """Median milliseconds of one closed-loop run of 126 s, and that run."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        trace = tracking.follow(law, **options)
        times.append(time.perf_counter() - begin)
    return 1e3 * median(times), trace


def row(task, unit, ours, peer, peer_name, agreement):
    return {
        "task": task,
        "unit": unit,
        "ours": ours,
        "peer": peer,
        "peer_name": peer_name,
        "ratio": None if peer is None else peer / ours,
        "agreement": agreement,
    }


def gain_rows():
    """LQR gain against python-control, which solves the same Riccati equation."""
    weights = tracking.Weights()
    a, b = tracking.error_model(0.2, 0.3)

    def timed(action):
        times = []
        for _ in range(200):
            begin = time.perf_counter()
            gain = action()
            times.append(time.perf_counter() - begin)
        return 1e6 * median(times), gain

    ours, gain = timed(lambda: tracking.lqr_gain(0.2, 0.3, weights))
    try:
        import control
    except ImportError:
        return [row("LQR gain", "us", ours, None, "python-control is not installed", "")]
    theirs, other = timed(lambda: control.lqr(a, b, weights.q, weights.r)[0])
    return [
        row(
            "LQR gain",
            "us",
            ours,
            theirs,
            f"python-control {control.__version__}",
            f"gains agree within {np.abs(gain - other).max():.0e}",
        )
    ]


def rows():
    table = [
        row(f"control step, {name}", "us", step_time(tracking.Tracker(EIGHT, law)), None, "no installed peer", "")
        for name, law in LAWS.items()
    ]
    for name, law in LAWS.items():
        tracker = tracking.Tracker(EIGHT, law)
        compiled = "MPC" not in name
        ours, trace = run_time(tracker, 20 if compiled else 1)
        rate = EIGHT.duration / (1e-3 * ours)
        table.append(row(f"simulated seconds a second, {name}", "s/s", rate, None, "no installed peer", ""))
        if compiled and name in ("DFL", "Kanayama"):
            theirs, slow = run_time(tracker, 3, compiled=False)
            same = np.array_equal(trace.poses, slow.poses)
            table.append(
                row(
                    f"figure eight of 126 s, {name}",
                    "ms",
                    ours,
                    theirs,
                    "the same loop in Python",
                    f"the runs are {'equal to the bit' if same else 'DIFFERENT'}",
                )
            )
    return table + gain_rows()
