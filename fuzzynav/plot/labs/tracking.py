"""Labs of trajectory tracking: gains with their poles and errors, and two laws under the same disturbance."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure

from fuzzynav import tracking
from fuzzynav.geometry import compose
from fuzzynav.plot.base import COLORS, draw_path, metric_axes
from fuzzynav.plot.blit import Update
from fuzzynav.plot.tracking import draw_poles, draw_reference
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.tracking.reference import FigureEight

__all__ = ["dfl_gains_lab", "rivals_lab"]

SPAN = 40.0  # [s] shown


def dfl_gains_lab(figure: Figure) -> Update:
    """Path, distance and poles of DFL for gains kp, kd, a first heading error [deg] and a first speed v0 [m/s]."""
    eight = FigureEight()
    axes = figure.subplot_mosaic([["path", "error"], ["path", "poles"]], width_ratios=[1.2, 1.0])
    draw_reference(axes["path"], eight)
    metric_axes(axes["path"], (-2.4, 2.4, -0.6, 2.4))
    driven = draw_path(axes["path"], np.zeros((0, 2)), role="path", label="driven, 40 s")
    axes["path"].legend(loc="lower left")
    (distance,) = axes["error"].plot([], [], color=COLORS["path"])
    axes["error"].set(xlim=(0, SPAN), ylim=(0, 0.4), xlabel="t [s]", ylabel="distance [m]")
    poles = draw_poles(axes["poles"], [])
    start = eight.sample(0.0).pose

    def update(kp: float, kd: float, heading: float, v0: float) -> tuple[list[Artist], str]:
        law = tracking.Dfl(kp1=kp, kp2=kp, kd1=kd, kd2=kd, v0=v0)
        run = tracking.follow(tracking.Tracker(eight, law), start + [0, 0, np.radians(heading)], duration=SPAN)
        driven.set_data(*run.poses[:, :2].T)
        distance.set_data(run.t, run.distance)
        found = tracking.poles(law)
        poles.set_data(found.real, found.imag)
        damping = kd / (2.0 * np.sqrt(kp))
        text = (
            f"damping {damping:.2f}, poles {found[0]:.2f} 1/s, largest distance {run.max_distance:.3f} m, "
            f"RMS {run.rms_distance:.3f} m, largest yaw rate {np.abs(run.commands[:, 1]).max():.2f} rad/s"
        )
        return [driven, distance, poles], text

    return update


RIVALS: dict[str, tracking.Law] = {
    "DFL": tracking.Dfl(),
    "linear flatness": tracking.Flatness(),
    "Kanayama": tracking.Kanayama(),
    "PID": tracking.Pid(),
    "LQR": tracking.Lqr(),
    "sliding mode": tracking.Sliding(),
}


def rivals_lab(figure: Figure) -> Update:
    """Distance over time of DFL and one rival, default gains, under noise [mm], delay [s], lag [s] and slip [%]."""
    eight = FigureEight(duration=SPAN)
    trackers = {name: tracking.Tracker(eight, law) for name, law in RIVALS.items()}
    ax = figure.subplots()
    (first,) = ax.plot([], [], color=COLORS["robot"], label="DFL")
    (second,) = ax.plot([], [], color=COLORS["path"], linestyle="--", label="rival")
    ax.set(xlim=(0, SPAN), ylim=(0, 0.25), xlabel="t [s]", ylabel="distance from the reference [m]")
    ax.legend(loc="upper right")
    start = compose(eight.sample(0.0).pose, [-0.1, 0.15, 0.3])

    def update(rival: str, noise: float, delay: float, lag: float, slip: float) -> tuple[list[Artist], str]:
        disturbance = tracking.Disturbance(
            position_noise=noise / 1e3, heading_noise=2e-3 * noise, delay=delay, motor_lag=lag, slip=slip / 100.0
        )
        runs = [tracking.follow(trackers[name], start, disturbance=disturbance, rng=5) for name in ("DFL", rival)]
        for line, run in zip((first, second), runs, strict=True):
            line.set_data(run.t, run.distance)
        late = [1e3 * run.after(20.0).rms_distance for run in runs]
        effort = [run.effort(TURTLEBOT2) for run in runs]
        return [first, second], (
            f"RMS from 20 s on: DFL {late[0]:.1f} mm, {rival} {late[1]:.1f} mm; "
            f"effort {effort[0]:.1f} and {effort[1]:.1f} rad/s²"
        )

    return update
