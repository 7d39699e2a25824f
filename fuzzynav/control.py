"""The contract between a robot and whoever drives it: what a controller is told, and what it answers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array

__all__ = ["Controller", "Observation"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Observation:
    """What a controller is told at one moment.

    points are sensed obstacle points in the world frame as believed; the scan fields are there where a scan was made.
    """

    time: float  # [s]
    pose: Array  # (3,) x [m], y [m], theta [rad], as believed
    velocity: Array  # (2,) v [m/s], omega [rad/s], as measured
    goal: Array  # (2,) [m]
    points: Array  # (n, 2) [m]
    point_velocities: Array | None = None  # (n, 2) [m/s]
    ranges: Array | None = None  # (k,) [m]
    angles: Array | None = None  # (k,) [rad], body frame
    range_max: float = np.inf  # [m]


class Controller(Protocol):
    """What drives a robot: called once every step, reset before every run.

    `status` and `evidence` may be plain attributes. A class that has neither inherits from this one: no reason to end
    the run, nothing to record.
    """

    @property
    def status(self) -> str | None:
        """A named reason to end the run; None while there is none."""
        return None

    @property
    def evidence(self) -> Mapping[str, Any]:
        """Numbers of the last call that the run shall record."""
        return {}

    def __call__(self, observation: Observation) -> ArrayLike:
        """Command (v [m/s], omega [rad/s]) for the next step."""
        ...

    def reset(self) -> None:
        """Forget the run before."""
        ...
