"""Thesis 5, tracking: the printed numbers, measured. What meets an obstacle stands in `studies.blend`."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np

from fuzzynav import batch, tracking
from fuzzynav.robot import PIONEER_3DX, TURTLEBOT2, Robot
from fuzzynav.simulate.record import Run
from fuzzynav.studies.reproduction import Reproduction
from fuzzynav.studies.study import Study
from fuzzynav.studies.tracking import rivals
from fuzzynav.tracking.reference import FigureEight

__all__ = [
    "EXPERIMENT",
    "GAINS",
    "REPRODUCTIONS",
    "SIMULATION",
    "STUDIES",
    "amplitude_for_length",
    "baseline_is_beaten",
    "experiment_run",
    "simulation_run",
]

SIMULATION = FigureEight()
GAINS = tracking.Dfl()
EXPERIMENT = FigureEight(amplitude=1.25, duration=40.0 * np.pi)  # amplitude ours: it is not printed
ODOMETRY = tracking.Disturbance(position_noise=0.003, heading_noise=0.01, slip=0.02, motor_lag=0.1)  # ours


@cache
def simulation_run() -> Run:
    """The thesis' simulation: gains of table 5.2, Euler steps of 0.1 s, started on the curve at its speed."""
    return tracking.follow(tracking.Tracker(SIMULATION, GAINS, TURTLEBOT2, dt=0.1), euler=True)


@cache
def experiment_run(seed: int = 1) -> Run:
    """An imitation of the experiment: one lap of amplitude 1.25 m with noisy odometry, slip and motor lag."""
    tracker = tracking.Tracker(EXPERIMENT, GAINS, PIONEER_3DX, dt=0.1)
    return tracking.follow(tracker, disturbance=ODOMETRY, rng=seed)


def amplitude_for_length(length: float, duration: float) -> float:
    """Amplitude a [m] at which the figure eight is `length` [m] long after `duration` [s].

    >>> round(amplitude_for_length(11.77, 126.0), 4)
    1.2433
    """
    return length / FigureEight(amplitude=1.0, duration=duration).length()


def baseline_is_beaten() -> bool:
    """Whether tuned DFL has the smaller median late RMS than the linear flatness controller in every condition."""
    table = batch.read(rivals.RESULTS / "tracking_rivals.csv")
    medians = table.groupby(["condition", "method"])["late_rms"].median().unstack()
    return bool((medians["DFL"] < medians["linear flatness"]).all())


def _gain(name: str) -> float:
    return float(getattr(GAINS, name))


def _measure_of(robot: Robot, field: str) -> float:
    return float(getattr(robot, field))


def _inside_the_limits(euler: bool = True) -> bool:
    """Whether a robot ten times as fast and as quick would never be told more than the real one can."""
    fields = ("max_vel_x", "max_vel_theta", "acc_lim_x", "dec_lim_x", "acc_lim_theta")
    free = replace(TURTLEBOT2, **{name: 10.0 * getattr(TURTLEBOT2, name) for name in fields})
    run = tracking.follow(tracking.Tracker(SIMULATION, GAINS, free, dt=0.1), euler=euler)
    v, omega = np.abs(run.commands).max(axis=0)
    return bool(v <= TURTLEBOT2.max_vel_x and omega <= TURTLEBOT2.max_vel_theta)


@cache
def _readings() -> tuple[Run, ...]:
    """The simulation with Euler steps and with exact arcs: the thesis does not say which."""
    return simulation_run(), tracking.follow(tracking.Tracker(SIMULATION, GAINS, TURTLEBOT2, dt=0.1))


def _integrators() -> tuple[int, int]:
    return sum(abs(run.length - 18.94) <= 0.005 for run in _readings()), len(_readings())


def _integrators_small() -> tuple[int, int]:
    return sum(bool((run.rms < 0.02).all()) for run in _readings()), len(_readings())


def _integrators_inside() -> tuple[int, int]:
    return _inside_the_limits(True) + _inside_the_limits(False), 2


def _amplitudes() -> tuple[int, int]:
    """Amplitudes from 1 to 2 m in steps of 0.01 m whose lap is 11.77 m long within 0.05 m."""
    lengths = [FigureEight(amplitude=a / 100.0, duration=EXPERIMENT.duration).length() for a in range(100, 201)]
    return sum(abs(length - 11.77) <= 0.05 for length in lengths), len(lengths)


def _conditions_won() -> tuple[int, int]:
    table = batch.read(rivals.RESULTS / "tracking_rivals.csv")
    medians = table.groupby(["condition", "method"])["late_rms"].median().unstack()
    return int((medians["DFL"] < medians["linear flatness"]).sum()), len(medians)


_TABLE = "the simulation uses it as table 5.2 prints it"
_HARDWARE = "measured on the real robot; no log is printed"

REPRODUCTIONS: tuple[Reproduction, ...] = (
    Reproduction(
        claim="thesis:c-5.3-tracking-len",
        measure=lambda: simulation_run().length,
        because="rounding of two decimals",
        free="start on the curve, integrator started at the curve's speed; Euler steps or exact arcs",
        holds_for=_integrators,
    ),
    Reproduction(
        claim="thesis:c-5.3-tracking-time",
        verdict="contradicts itself",
        because="table 5.2 ends the reference at 126 s; the length printed beside it, 18.94 m, is that of the curve at "
        "126.03 s; after 129 s the curve would be 19.59 m long, so 129 s is not the time of the motion (T63)",
    ),
    Reproduction(
        claim="thesis:c-5.5-tracking-len",
        measure=lambda: experiment_run().length,
        tolerance=0.05,
        shows="fitted",
        because="0.005 m of amplitude move the length of a lap by 0.047 m: two decimals of it miss the print's second",
        free="amplitude 1.25 m, chosen from this number, over one lap of 125.66 s: the table's 2 m would give 18.86 m; "
        "odometry noise",
        holds_for=_amplitudes,
    ),
    Reproduction(
        claim="thesis:c-5.5-tracking-time",
        verdict="not testable",
        because=_HARDWARE + "; the duration of the experiment's reference is not printed, and 126 s would exceed it",
    ),
    Reproduction(
        claim="thesis:c-5.8-small",
        measure=lambda: bool((simulation_run().rms < 0.02).all()),
        because="root mean squares of x, y, theta below 0.02 m and 0.02 rad",
        free="what 'very small' means; Euler steps or exact arcs",
        holds_for=_integrators_small,
    ),
    Reproduction(
        claim="thesis:c-5-baseline",
        measure=baseline_is_beaten,
        because="median error after 20 s in each of seven conditions, 200 seeds, equal tuning budget",
        free="the baseline: the same gains about the reference's motion; tuning, conditions and seeds",
        holds_for=_conditions_won,
    ),
    Reproduction(
        claim="thesis:c-5.11-area",
        verdict="not testable",
        because=_HARDWARE + "; amplitude 2 m would touch all four borders of the 4 m square, 1.25 m fits",
    ),
    Reproduction(
        claim="thesis:c-formula-7",
        tolerance=0.0,
        because="an integer",
        measure=lambda: int(np.linalg.matrix_rank(tracking.controllability())),
    ),
    Reproduction(
        claim="thesis:c-5.2-dt",
        measure=lambda: float(np.diff(simulation_run().t)[0]),
        tolerance=1e-9,
        shows="input",
        because=_TABLE,
    ),
    Reproduction(
        claim="thesis:c-5.2-T", measure=lambda: SIMULATION.duration, tolerance=1e-9, shows="input", because=_TABLE
    ),
    Reproduction(
        claim="thesis:c-5.2-a", measure=lambda: SIMULATION.amplitude, tolerance=1e-9, shows="input", because=_TABLE
    ),
    Reproduction(
        claim="thesis:c-5.2-vt",
        verdict="contradicts itself",
        because="eq 5.2 makes the speed vary: the curve needs 0.070 to 0.224 m/s, 0.150 m/s in the mean; 0.11 m/s is "
        "the first speed of the curve with amplitude 1 m (T62)",
    ),
    *(
        Reproduction(
            claim=f"thesis:c-5.2-{name}", measure=partial(_gain, name), tolerance=1e-9, shows="input", because=_TABLE
        )
        for name in ("kp1", "kp2", "kd1", "kd2")
    ),
    Reproduction(claim="thesis:c-5.2-kth", verdict="not testable", because="no printed formula holds k_th (T62)"),
    *(
        Reproduction(
            claim=f"thesis:c-5.4-{robot}-{name}",
            because="the model of the robot, as table 5.4 prints it",
            tolerance=1e-9,
            measure=partial(_measure_of, model, field),
            shows="input",
        )
        for robot, model in (("TurtleBot2", TURTLEBOT2), ("Pioneer", PIONEER_3DX))
        for name, field in (("weight", "mass"), ("max_speed", "max_vel_x"), ("rotation_speed", "max_vel_theta"))
    ),
    *(
        Reproduction(
            claim=f"thesis:c-5.4-{robot}-payload",
            verdict="not testable",
            because="a property of the machine that enters no model",
        )
        for robot in ("TurtleBot2", "Pioneer")
    ),
    Reproduction(
        claim="thesis:c-extra-9",
        measure=_inside_the_limits,
        because="largest |v| and |omega| asked of a robot with ten times the limits, against 0.65 m/s and 3.14 rad/s",
        free="start on the curve; Euler steps or exact arcs",
        holds_for=_integrators_inside,
    ),
)

_GAINS = ("results/tracking_gains.csv",)
_MPC = {"MPC": (2e-2, 1e-6)}  # its solver stops at a residual

STUDIES: tuple[Study, ...] = (
    Study(
        name="tracking_gains", experiment=rivals.tune, cases=tuple(rivals.CONTESTANTS), row=rivals.score_again,
        tolerance={"": (1e-3, 1e-6), **_MPC}, parameters={"trials": rivals.POPULATION * rivals.GENERATIONS},
    ),
    Study(
        name="tracking_rivals", experiment=rivals.compare, cases=rivals.RIVAL_CASES, inputs=_GAINS,
        tolerance={"": (1e-3, 1e-6), **_MPC}, parameters={"seeds": f"0 to {rivals.SEEDS - 1}", "seconds": rivals.HALF},
    ),
    Study(
        name="tracking_time", experiment=rivals.wall_time, cases=tuple(rivals.CONTESTANTS), inputs=_GAINS,
        timed=("microseconds", "rate"), parameters={"runs": 5},
    ),
    Study(
        name="tracking_observers", experiment=rivals.observe, cases=rivals.OBSERVER_CASES,
        tolerance={"": (1e-2, 1e-6)}, parameters={"noises": list(rivals.NOISES), "seeds": "0 to 19"},
    ),
)  # fmt: skip
