"""What a closed-loop run leaves behind: its record, its metrics, and the file that keeps it."""

from __future__ import annotations

import struct
import tokenize
import zipfile
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array, length, point_segment_distance, wrap
from fuzzynav.robot import Robot, wheel_speeds

__all__ = ["STATUSES", "Run"]

STATUSES: tuple[str, ...] = (
    "reached",  # the goal
    "done",  # the reference was followed to its end
    "collided",  # the robot drove into something
    "struck",  # a mover ran into the robot while it stood
    "stalled",  # it stood or crept too long
    "blind",  # its sensors told it too little to move
    "timeout",
    "no_path",
    "local_minimum",
    "diverged",  # the motion left every bound
)
MOST_BYTES = 1_000_000_000
# what zip, zlib and numpy raise for a file that was damaged
DAMAGED = (
    ValueError,
    OSError,
    EOFError,
    KeyError,
    TypeError,
    OverflowError,
    SyntaxError,
    RuntimeError,
    NotImplementedError,
    zipfile.BadZipFile,
    zlib.error,
    struct.error,
    tokenize.TokenError,
)
MOVING = 0.05  # [m/s] slower than this a path has no curvature worth integrating


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """A finished run of n steps; entry k + 1 of the poses is where command k led.

    `clearance[k]` is the least distance [m] from the robot's rim to anything during step k; `contacts_moving` counts
    the contacts begun while the robot drove, `contacts_standing` the movers that ran into a robot at rest, which is
    as `Loop.standing` says.
    """

    t: Array  # (n + 1,) [s]
    poses: Array  # (n + 1, 3) true poses
    commands: Array  # (n, 2) v [m/s] and omega [rad/s] sent to the wheels, after the limits
    clearance: Array  # (n,) [m]
    log: Mapping[str, Array]  # wishes, believed poses, movers, the reference and the controller's evidence
    status: str
    goal: Array = field(default_factory=lambda: np.full(2, np.nan))
    radius: float = 0.0  # [m] of the robot
    contacts_moving: int = 0
    contacts_standing: int = 0

    def __post_init__(self) -> None:
        if self.status not in STATUSES:
            raise ValueError(f"status '{self.status}' has no name here: use one of {', '.join(STATUSES)}")
        n = len(self.commands)
        shapes = {"t": (n + 1,), "poses": (n + 1, 3), "commands": (n, 2), "clearance": (n,), "goal": (2,)}
        for name, shape in shapes.items():
            array = np.asarray(getattr(self, name))
            if array.shape != shape or array.dtype.kind not in "fiu":
                raise ValueError(f"{name} must be numbers of shape {shape}, got {array.dtype} of shape {array.shape}")

    @property
    def success(self) -> bool:
        """Whether the goal was reached."""
        return self.status == "reached"

    @property
    def iterations(self) -> int:
        """Number of control steps."""
        return len(self.commands)

    @property
    def dt(self) -> float:
        """Length of one step [s]; nan for a run without steps."""
        return float(self.t[1] - self.t[0]) if len(self.t) > 1 else float("nan")

    @property
    def duration(self) -> float:
        """Time driven [s]."""
        return float(self.t[-1])

    @property
    def driven(self) -> Array:
        """Mean true speeds `(n, 2)` of each step: the commands, where nothing stood between."""
        return self.log.get("driven", self.commands)

    @property
    def length(self) -> float:
        """Length of the driven path [m]: the arcs themselves, not their chords."""
        return float(np.abs(self.driven[:, 0]).sum() * self.dt) if len(self.commands) else 0.0

    @property
    def chord_length(self) -> float:
        """Length [m] of the polyline through the recorded positions."""
        return length(self.poses)

    @property
    def min_clearance(self) -> float:
        """Least distance [m] from the robot's rim to anything; inf for a run without steps or an empty world."""
        return float(self.clearance.min()) if len(self.clearance) else float("inf")

    @property
    def smoothness(self) -> float:
        """Integral of the squared curvature [1/m] along the path; less is smoother."""
        v, omega = np.abs(self.driven[:, 0]), self.driven[:, 1]
        fast = v > MOVING
        return float((omega[fast] ** 2 / v[fast]).sum() * self.dt) if fast.any() else 0.0

    @property
    def jerk(self) -> float:
        """Integral of the squared jerk of v [m^2/s^5]; less is gentler."""
        v = self.driven[:, 0]
        return float((np.diff(v, 2) ** 2).sum() / self.dt**3) if len(v) > 2 else 0.0

    @property
    def variation(self) -> Array:
        """Total variation `(2,)` of v [m/s] and of omega [rad/s]: the sum of all their changes."""
        return np.asarray(np.abs(np.diff(self.driven, axis=0)).sum(axis=0))

    @property
    def turns(self) -> int:
        """Number of turns: stretches of one sense of rotation by more than 10 degrees together."""
        heading = np.concatenate([[0.0], np.cumsum(wrap(np.diff(self.poses[:, 2])))])
        return _reversals(heading, np.radians(10.0))

    def rms_error(self, reference: ArrayLike) -> float:
        """Root mean square distance [m] from the path to the polyline `(m, 2)`, over the recorded positions.

        Raises ValueError for fewer than two reference points.
        """
        line = np.asarray(reference, dtype=float)[:, :2]
        if len(line) < 2:
            raise ValueError("a reference needs at least two points")
        gaps = point_segment_distance(self.poses[:, None, :2], line[None, :-1], line[None, 1:]).min(axis=1)
        return float(np.sqrt(np.mean(gaps**2)))

    # --- against a reference -------------------------------------------------------------------

    @property
    def wanted(self) -> Array:
        """Poses of the reference `(n + 1, 3)`; raises ValueError for a run that followed none."""
        if "wanted" not in self.log:
            raise ValueError("this run followed no reference: its log has no 'wanted'")
        return self.log["wanted"]

    @property
    def errors(self) -> Array:
        """Reference minus pose `(n + 1, 3)`: x [m], y [m], heading [rad] wrapped."""
        gap = self.wanted - self.poses
        return np.concatenate([gap[:, :2], wrap(gap[:, 2:])], axis=1)

    @property
    def distance(self) -> Array:
        """Distance `(n + 1,)` [m] from the reference's position."""
        return np.asarray(np.hypot(*self.errors[:, :2].T))

    @property
    def rms(self) -> Array:
        """Root mean square of the errors `(3,)`: x [m], y [m], heading [rad]."""
        return np.asarray(np.sqrt((self.errors**2).mean(axis=0)))

    @property
    def rms_distance(self) -> float:
        """Root mean square distance [m] from the reference."""
        return float(np.sqrt((self.distance**2).mean()))

    @property
    def max_distance(self) -> float:
        """Largest distance [m] from the reference."""
        return float(self.distance.max())

    def effort(self, robot: Robot) -> float:
        """Root mean square acceleration [rad/s^2] asked of the wheels."""
        rates = np.diff(wheel_speeds(self.commands, robot), axis=0) / self.dt
        return float(np.sqrt((rates**2).mean()))

    def after(self, time: float) -> Run:
        """The part of the run from `time` [s] on, with its log."""
        k, n = int(np.searchsorted(self.t, time - 1e-9)), len(self.commands)
        log = {name: values[k:] if len(values) in (n, n + 1) else values for name, values in self.log.items()}
        parts = {name: getattr(self, name)[k:] for name in ("t", "poses", "commands", "clearance")}
        return replace(self, log=log, **parts)

    def metrics(self) -> dict[str, float | int | str]:
        """The run in one row: status and every measure above."""
        v, omega = self.variation if self.iterations > 1 else (0.0, 0.0)
        return {
            "status": self.status,
            "length": self.length,
            "duration": self.duration,
            "iterations": self.iterations,
            "min_clearance": self.min_clearance,
            "smoothness": self.smoothness,
            "jerk": self.jerk,
            "turns": self.turns,
            "variation_v": float(v),
            "variation_omega": float(omega),
            "contacts_moving": self.contacts_moving,
            "contacts_standing": self.contacts_standing,
        }

    def frames(self, every: int = 1) -> Iterator[tuple[int, Array, Array]]:
        """Replay: (step, pose, mover positions (m, 2)) of every n-th recorded moment, and of the last."""
        movers = self.log.get("movers", np.empty((len(self.t), 0, 2)))
        last = len(self.t) - 1
        for k in [*range(0, last, every), last]:
            yield k, self.poses[k], movers[k]

    def save(self, path: str | Path) -> None:
        """Write the run as a compressed npz of plain arrays, without pickle.

        Raises ValueError for a log that holds anything but plain arrays, OSError if the file cannot be written.
        """
        log: dict[str, Any] = {f"log_{name}": np.asarray(values) for name, values in self.log.items()}
        plain: dict[str, Any] = {name: getattr(self, name) for name in Run.__dataclass_fields__ if name != "log"}
        odd = [name for name, values in log.items() if values.dtype == object]
        if odd:
            raise ValueError(f"a run is saved as plain arrays; {', '.join(odd)} holds other things")
        with Path(path).open("wb") as file:
            np.savez_compressed(file, **plain, **log)

    @classmethod
    def load(cls, path: str | Path) -> Run:
        """Read a run that `save` wrote; the file may unpack to a gigabyte at most.

        Raises FileNotFoundError if there is no such file, ValueError if it is damaged or does not hold a run.
        """
        file = Path(path)
        try:
            with zipfile.ZipFile(file) as archive:
                if sum(part.file_size for part in archive.infolist()) > MOST_BYTES:
                    raise ValueError("it unpacks to more than a gigabyte")
            with np.load(file, allow_pickle=False) as parts:
                found = {name: parts[name] for name in parts.files}
            return _run_of(found)
        except FileNotFoundError:
            raise
        except DAMAGED as error:
            raise ValueError(f"{file.name} does not hold a run: {error}") from error


def _run_of(found: Mapping[str, Array]) -> Run:
    """The run that named arrays hold."""
    missing = {name for name in Run.__dataclass_fields__ if name != "log"} - set(found)
    if missing:
        raise ValueError(f"it lacks {', '.join(sorted(missing))}")
    return Run(
        t=found["t"],
        poses=found["poses"],
        commands=found["commands"],
        clearance=found["clearance"],
        log={name.removeprefix("log_"): values for name, values in found.items() if name.startswith("log_")},
        status=str(found["status"]),
        goal=found["goal"],
        radius=float(found["radius"]),
        contacts_moving=int(found["contacts_moving"]),
        contacts_standing=int(found["contacts_standing"]),
    )


def _reversals(heading: Array, threshold: float) -> int:
    """Number of monotone swings of at least `threshold`, smaller wiggles between them ignored."""
    count, sense = 0, 0
    low = high = float(heading[0])
    for value in heading[1:].tolist():
        if sense <= 0:
            low = min(low, value)
        if sense >= 0:
            high = max(high, value)
        if sense <= 0 and value - low >= threshold:
            sense, high, count = 1, value, count + 1
        elif sense >= 0 and high - value >= threshold:
            sense, low, count = -1, value, count + 1
    return count
