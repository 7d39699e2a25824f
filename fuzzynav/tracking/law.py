"""What a tracking law is: frozen gains that turn a pose and a row of the reference into a command."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.robot import Robot, limits_of
from fuzzynav.tracking import kernels
from fuzzynav.tracking.records import GAINS, MEMORY, Records

__all__ = ["Law", "Setting", "State"]


class Law(Protocol):
    """A tracking law. `command` is all that it needs; `start` and `horizon` may be left out.

    `start(setting)` gives the state before the first step, None where there is no such method. A law with a field
    `horizon` is handed so many rows, the first of them now, in place of one.
    """

    def command(self, state: Any, pose: Array, row: Any) -> tuple[ArrayLike, Any]:
        """Command (v [m/s], omega [rad/s]) and the next state; nothing that is handed in may change.

        row: the reference now as a record: row.x, .y, .dx, .dy, .ddx, .ddy, .theta, .v, .omega.
        """
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Setting:
    """What a law is told before the first step: the rows of the reference, the robot, and the step dt [s]."""

    rows: Records
    robot: Robot
    dt: float


@dataclass(frozen=True, slots=True, eq=False)
class State:
    """State of a compiled law: its gains and its memory, each an array of one record."""

    gains: Records
    memory: Records

    def with_rates(self, rates: ArrayLike) -> State:
        """The state with estimated dx/dt and dy/dt [m/s], which the flat laws feed back in place of their own."""
        memory = self.memory.copy()
        memory["rate_x"], memory["rate_y"] = np.asarray(rates, dtype=float)
        return replace(self, memory=memory)


def begin(setting: Setting, name: str = "", law: object = None) -> State:
    """First state of a law, whose fields are copied into the part `name` of the record GAINS."""
    gains, memory = np.zeros(1, GAINS), np.zeros(1, MEMORY)
    for field in (GAINS[name].names or ()) if name else ():
        value = getattr(law, field)
        gains[name][field] = np.nan if value is None else value
    memory["rate_x"] = memory["rate_y"] = np.nan
    memory["dt"], memory["lim"] = setting.dt, limits_of(setting.robot)
    return State(gains, memory)


def stepped(code: int, state: State, pose: ArrayLike, row: Any) -> tuple[Array, State]:
    """One step of the compiled law `code`."""
    after, out = np.empty(1, MEMORY), np.zeros(2)
    kernels.step(code, state.gains, state.memory, after, np.asarray(pose, dtype=float), np.asarray(row), out)
    return out, State(state.gains, after)
