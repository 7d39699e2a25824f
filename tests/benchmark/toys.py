"""Planners of a reader's own, good and bad, named on a command line as `toys:straight`."""

import time

import numpy as np

from fuzzynav.control import Controller


class Straight(Controller):
    """Turns to the goal and drives there, blind; `third` is what it does in its third step."""

    def __init__(self, task, third=None):
        self.top, self.third, self.calls = 0.6 * task.robot.max_vel_x, third, 0

    def reset(self):
        self.calls = 0

    def __call__(self, observation):
        self.calls += 1
        if self.third is not None and self.calls == 3:
            return self.third()
        x, y, theta = observation.pose
        way = np.arctan2(observation.goal[1] - y, observation.goal[0] - x) - theta
        way = (way + np.pi) % (2 * np.pi) - np.pi
        return (self.top if abs(way) < 0.3 else 0.0), 2.0 * way


class Sleepy(Straight):
    def __call__(self, observation):
        time.sleep(0.02)
        return super().__call__(observation)


def straight(task):
    return Straight(task)


def raising(task):
    def third():
        raise RuntimeError("the rules are gone <b>")

    return Straight(task, third)


def nans(task):
    return Straight(task, lambda: (np.nan, 0.0))


def sleepy(task):
    return Sleepy(task)


def parked(task):
    return lambda observation: (0.0, 0.0)  # no controller: it cannot be reset


class Hoarder(Straight):
    """Keeps something from run to run, as no planner should."""

    runs = 0

    def reset(self):
        super().reset()
        Hoarder.runs += 1
        self.top = 0.3 + 0.1 * (Hoarder.runs % 3)


def hoarder(task):
    return Hoarder(task)


NUMBER = 3
