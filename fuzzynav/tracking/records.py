"""The named records that the compiled laws read and write; the units stand beside the names.

Each is a numpy dtype of records, so that a kernel reads `row.theta` and `gains.k1`, compiled or not.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fuzzynav.geometry import Array
from fuzzynav.robot.kernels import LIMITS

__all__ = ["GAINS", "MEMORY", "MOST_SPEEDS", "POSE", "ROW", "SPEEDS", "Given", "Made", "Records"]

Records = NDArray[np.void]  # an array of one of the records below
MOST_SPEEDS = 33  # speeds at which a scheduled gain may be given at most
POSE, SPEEDS = ["x", "y", "theta"], ["v", "omega"]  # columns of rows, as `rows[POSE]` asks for them


def _record(*fields: str | tuple[Any, ...]) -> np.dtype[Any]:
    """Record type of these fields; a bare name is a real number."""
    return np.dtype((np.record, [(f, "f8") if isinstance(f, str) else f for f in fields]))


# One moment of a reference: position [m], its first [m/s] and second derivative [m/s^2], heading [rad], v [m/s] and
# omega [rad/s].
ROW = _record("x", "y", "dx", "dy", "ddx", "ddy", "theta", "v", "omega")

# The gains of every law, each under the law's name; a law fills its own part. Units stand in the laws' dataclasses.
GAINS = _record(
    ("dfl", _record("kp1", "kd1", "kp2", "kd2", "v_min", "rest_radius", "v0")),  # v0 nan: that of the reference
    ("kanayama", _record("k1", "k2", "k3")),
    ("pid", _record("kp_v", "ki_v", "kd_v", "kp_omega", "ki_omega", "kd_omega", "k_y", "feed_forward")),
    ("sliding", _record("k1", "phi1", "k2", "phi2", "c")),
    ("lqr", _record(("count", "i8"), "first", "step", ("table", "f8", (MOST_SPEEDS, 2, 3)))),  # speeds [m/s]
)

# What a law remembers from step to step, and what it knows of its robot.
MEMORY = _record(
    ("started", "?"),
    "sense",  # direction of travel, +1 or -1; 0 before the first step
    "speed",  # [m/s] of the dynamic compensator
    "rate_x",  # [m/s] estimated dx/dt and dy/dt; nan: the law uses its own speed
    "rate_y",
    "sum_v",  # [m s] integral of the error ahead
    "sum_omega",  # [rad s] integral of the heading error
    "error_v",  # [m] the errors of the step before
    "error_omega",  # [rad]
    "dt",  # [s] of a control step
    ("lim", LIMITS),
)


class Given(NamedTuple):
    """What a compiled run is given besides the law: draws, delay and way of integrating."""

    noise: Array  # (n, 3) of the measured pose [m, m, rad]
    slip: Array  # (n, 2) share of its speed that each wheel loses
    late: int  # steps from a command to its effect
    euler: bool  # as the thesis integrates; else along exact arcs


class Made(NamedTuple):
    """What a compiled run fills; poses[0] is the start."""

    poses: Array  # (n + 1, 3)
    commands: Array  # (n, 2)
    driven: Array  # (n, 2)
