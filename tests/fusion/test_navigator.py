"""The planner in its loop: what it may never do, whatever the scene, and what it must manage."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from fuzzynav import simulate
from fuzzynav.control import Observation
from fuzzynav.dwa.steps import brake
from fuzzynav.fusion import ROBOTS, Navigator, Params, Planning, Task, Tracker, TrackParams, scene_task, stays_clear
from fuzzynav.geometry import Array
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import move
from fuzzynav.simulate.record import Run
from fuzzynav.world import Mover, World

SCENES = tuple((seed, robot, ideal) for seed in (40000, 40001) for robot in ROBOTS for ideal in (True, False))


class Watched:
    """A controller that remembers what it was told."""

    def __init__(self, inner: Navigator) -> None:
        self.inner, self.seen, self.hazards = inner, list[Observation](), list[Array]()

    def reset(self) -> None:
        self.inner.reset()
        self.seen, self.hazards = [], []

    @property
    def status(self) -> str | None:
        return self.inner.status

    @property
    def evidence(self) -> dict[str, float]:
        return self.inner.evidence

    def __call__(self, observation: Observation) -> Array:
        command = self.inner(observation)
        self.seen.append(observation)
        assert self.inner.around is not None
        self.hazards.append(self.inner.around.hazards)
        return command


def navigator(task: Task, **given: Any) -> Navigator:
    tracker = None if task.ideal else Tracker(TrackParams(velocity_bound=task.speed_bound))
    return Navigator(task.robot, speed_bound=task.speed_bound, chart=task.chart, tracker=tracker, keep=True, **given)


def driven(task: Task, controller: Any, t_max: float = 120.0) -> Run:
    return simulate.run(
        task.world, task.robot, controller, task.start, task.goal, dt=task.dt, t_max=t_max, rng=0, laser=task.laser,
        track_movers=task.ideal, loop=task.loop,
    )  # fmt: skip


@cache
def watched(seed: int, robot: str, ideal: bool) -> tuple[Task, Watched, Run]:
    task = scene_task(seed, robot=ROBOTS[robot], ideal=ideal, courteous=False)  # movers that yield to nobody
    controller = Watched(navigator(task))
    return task, controller, driven(task, controller, 60.0)


@pytest.mark.parametrize(("seed", "robot", "ideal"), SCENES)
def test_every_command_but_the_emergency_one_is_passively_safe(seed: int, robot: str, ideal: bool) -> None:
    task, controller, _ = watched(seed, robot, ideal)
    moved = 0
    for seen, hazards, made in zip(controller.seen, controller.hazards, controller.inner.decisions, strict=True):
        if made.braking or abs(made.command[0]) < 1e-9:
            continue
        grown = hazards if not ideal else np.column_stack([seen.movers[:, :2], seen.movers[:, 4]])  # type: ignore[index]
        assert stays_clear(seen.pose, made.command, grown, task.speed_bound, task.robot, task.dt)
        moved += 1
    assert moved > 100


@pytest.mark.parametrize(("seed", "robot", "ideal"), SCENES)
def test_it_never_drives_into_anything(seed: int, robot: str, ideal: bool) -> None:
    _, _, run = watched(seed, robot, ideal)
    assert run.contacts_moving == 0
    assert run.status != "collided"


@pytest.mark.parametrize(("seed", "robot", "ideal"), SCENES)
def test_from_every_state_it_can_brake_without_touching_what_stands(seed: int, robot: str, ideal: bool) -> None:
    task, _, run = watched(seed, robot, ideal)
    ends = []
    for pose, command in zip(run.poses[1:], run.commands, strict=True):
        at, speed = pose, command
        while abs(speed[0]) > 1e-9:
            speed = brake(speed, task.robot, task.dt)
            at = move(at, speed, task.dt)
            ends.append(at[:2])
    assert task.world.clearance(ends, []).min() > task.robot.radius
    assert task.world.clearance(run.poses[:, :2], []).min() > task.robot.radius


@pytest.mark.parametrize(("seed", "robot", "ideal"), SCENES[:2])
def test_the_same_run_twice_is_the_same(seed: int, robot: str, ideal: bool) -> None:
    task, _, run = watched(seed, robot, ideal)
    again = driven(task, navigator(task), 60.0)
    np.testing.assert_array_equal(again.poses, run.poses)


def test_limits_hold() -> None:
    task, _, run = watched(*SCENES[0])
    robot, change = task.robot, np.diff(run.log["wish"], axis=0)
    assert (np.abs(run.log["wish"][:, 1]) <= robot.max_vel_theta + 1e-9).all()
    np.testing.assert_allclose(run.log["wish"], run.commands, atol=1e-12)  # it asks for nothing that it cannot do
    assert np.abs(change[:, 1]).max() <= robot.acc_lim_theta * task.dt + 1e-9


def empty(movers: tuple[Mover, ...] = (), **more: Any) -> Task:
    world = World(bounds=(0.0, 12.0, 0.0, 6.0), movers=movers, **more)
    return replace(
        scene_task(0),
        world=world,
        chart=GridMap(np.zeros((6, 12), dtype=bool)),
        start=np.array([1.5, 3.0, 0.0]),
        goal=np.array([10.5, 3.0]),
    )


def test_it_reaches_the_goal_on_empty_ground_almost_straight() -> None:
    run = driven(empty(), navigator(empty()), 30.0)
    assert run.status == "reached"
    assert run.length < 1.02 * 9.0


def test_an_unknown_wall_is_entered_and_passed() -> None:
    task = empty(unknown_rectangles=[[5.0, 2.2, 0.4, 4.4, 0.0]])  # from the lower wall to 4.4 m
    controller = navigator(task)
    run = driven(task, controller, 60.0)
    assert run.status == "reached"
    assert controller.guide.memory.grid().is_occupied([4.85, 3.0])
    assert run.poses[:, 1].max() > 4.6
    blind = driven(task, navigator(task, planning=Planning(enters=False, every=np.inf, patience=np.inf)), 30.0)
    assert blind.status != "reached", "a robot that forgets what it saw stays before the wall"


def test_a_mover_that_crosses_is_waited_for_or_passed() -> None:
    crossing = Mover.patrol([[6.0, 0.5], [6.0, 5.5]], 0.5, 0.3, courtesy=0.1)
    run = driven(empty((crossing,)), navigator(empty((crossing,))), 90.0)
    assert run.status == "reached"
    assert run.contacts_moving == 0


def test_a_mover_that_stands_in_a_gap_is_gone_round() -> None:
    standing = Mover.constant([6.0, 1.0], [0.0, 0.0], 0.4)
    wall = {"rectangles": [[6.0, 2.9, 0.4, 2.6, 0.0]]}  # leaves a gap below, where the mover stands, and one above
    task = replace(empty((standing,), **wall), start=np.array([1.5, 1.0, 0.0]), goal=np.array([10.5, 1.0]))
    run = driven(task, navigator(task), 90.0)
    assert run.status == "reached"
    assert run.poses[:, 1].max() > 4.3


def test_without_the_guard_the_reversal_of_a_patrol_hits() -> None:
    """Constant velocity is the bolder layer: alone it drives into movers that turn back."""
    hits = {True: 0, False: 0}
    for seed in range(41000, 41012):
        task = scene_task(seed, robot=ROBOTS["thesis"], courteous=False)
        for guard in hits:
            hits[guard] += driven(task, navigator(task, params=Params(guard=guard)), 60.0).status == "collided"
    assert hits[True] == 0
    assert hits[False] >= 1


def test_faulty_sensors_brake() -> None:
    task = empty()
    controller, still = navigator(task), np.zeros(2)
    told = Observation(
        time=0.0, pose=np.array([np.nan, 0.0, 0.0]), velocity=np.array([0.5, 0.1]), goal=task.goal,
        points=np.empty((0, 2)),
    )  # fmt: skip
    command = controller(told)
    assert 0.0 <= command[0] < 0.5
    assert command[1] / command[0] == pytest.approx(0.2) if command[0] > 0 else (command == still).all()


@pytest.mark.parametrize("bound", [-0.1, np.inf, np.nan])
def test_a_bound_that_is_none_is_refused(bound: float) -> None:
    with pytest.raises(ValueError, match="speed bound"):
        Navigator(ROBOTS["thesis"], speed_bound=bound)
