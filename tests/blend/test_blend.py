"""Tracking blended with avoidance: the printed equations, the compiled steps, and what the safe blend must keep."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav import blend, simulate, tracking
from fuzzynav.blend import controllers, kernels, points, rules
from fuzzynav.control import Observation
from fuzzynav.fuzzy import FuzzySystem
from fuzzynav.robot import TURTLEBOT2, respects_limits
from fuzzynav.simulate import Run
from fuzzynav.studies.blend.blocks import block_of
from fuzzynav.tracking.reference import FigureEight
from fuzzynav.tracking.tracker import seen
from fuzzynav.world import World

EIGHT = FigureEight(duration=blend.LAP)
HALF = FigureEight(duration=blend.LAP / 2.0)
TOP = np.array([0.0, 1.9, 0.2, 0.3, 0.0])
finite = st.floats(-3.0, 3.0)


# --- the printed equations


@given(st.floats(-np.pi, np.pi))
def test_the_turn_leads_away_from_the_block(bearing: float) -> None:
    turn = float(blend.avoidance_yaw_rate(bearing))
    assert turn == (1.0 if bearing <= 0 else -1.0)


@given(finite, finite, finite, finite, st.floats(0.0, 1.0))
def test_the_blend_lies_between_its_commands(a: float, b: float, c: float, d: float, f: float) -> None:
    mixed = blend.mixed([a, b], [c, d], f)
    assert (mixed >= np.minimum([a, b], [c, d]) - 1e-12).all()
    assert (mixed <= np.maximum([a, b], [c, d]) + 1e-12).all()


def test_blend_ends_and_arrays() -> None:
    track, avoid = np.array([0.2, -0.3]), np.array([0.0, 1.0])
    mixed = blend.mixed(track, avoid, [0.0, 1.0])
    np.testing.assert_allclose(mixed, [track, avoid])
    np.testing.assert_allclose(blend.hybrid(track, avoid, blend.safety_switch([0.6, 0.7], 0.7)), [avoid, track])
    assert blend.mixed([0.2, 0.0], [0.0, 1.0], 0.5)[0] == pytest.approx(0.1), "T59: v_a = 0 halves the speed"


@pytest.mark.parametrize("weight", [-0.1, 1.1, np.nan])
def test_a_weight_outside_0_to_1_is_refused(weight: float) -> None:
    with pytest.raises(ValueError, match="0 to 1"):
        blend.mixed([0, 0], [0, 0], weight)
    with pytest.raises(ValueError, match="0 or 1"):
        blend.hybrid([0, 0], [0, 0], 0.5)


# --- the rule base


def test_f_has_a_floor_and_a_ceiling() -> None:
    low, high = blend.reach_of(blend.table_5_1())
    assert low == pytest.approx(1 / 6, abs=1e-3)
    assert high == pytest.approx(5 / 6, abs=1e-3)


def test_f_is_symmetric_and_falls_with_distance() -> None:
    d, b = np.meshgrid(np.linspace(0, 2, 21), np.linspace(0, 3, 13), indexing="ij")
    system = blend.table_5_1()
    left, right = system(d, b)[0], system(d, -b)[0]
    np.testing.assert_allclose(left, right, atol=1e-9)
    assert (np.diff(system(np.linspace(0, 2, 81), 0.0)[0]) <= 1e-9).all()


def test_the_default_breakpoints_are_those_of_the_file() -> None:
    d, b = np.random.default_rng(0).uniform([0, -4], [2, 4], (200, 2)).T
    np.testing.assert_array_equal(blend.rule_base()(d, b)[0], blend.table_5_1()(d, b)[0])
    assert blend.reach_of(blend.rule_base(peak=0.8))[0] > blend.reach_of(blend.rule_base(peak=0.2))[0]


def test_the_compiled_weight_is_that_of_the_rule_base() -> None:
    system = blend.rule_base(0.4, 1.2, 0.8, 0.4)
    points = np.random.default_rng(1).uniform([0, -3.5], [2.5, 3.5], (100, 2))
    tables = controllers.weight_tables(system)
    ours = [kernels.weight(tables, d, b) for d, b in points]
    np.testing.assert_allclose(ours, system(*points.T)[0], atol=1e-12)


# --- the points


def test_nearest_point_of_a_block_is_the_worlds_clearance() -> None:
    rng = np.random.default_rng(2)
    for _ in range(20):
        block = np.array([*rng.uniform(-1, 1, 2), 0.2, 0.3, rng.uniform(0, 3)])
        world, out = World(rectangles=[block]), np.empty(4)
        for point in rng.uniform(-2, 2, (20, 2)):
            gap = points.nearest_on(block, *point, out)
            assert gap == pytest.approx(float(world.clearance(point)), abs=1e-12)
            if gap > 0:
                assert np.hypot(*(out[:2] - point)) == pytest.approx(gap, abs=1e-12)


def test_points_are_remembered_until_a_beam_passes_through() -> None:
    memory, pose = np.empty((points.MEMORY, 4)), np.zeros(3)
    scan = points.sight(np.array([1.0, 0.0, 0.2, 0.3, 0.0]), pose, blend.BEAMS, 2.0)
    n = points.remember(memory, 0, scan, pose, 2.0, False)
    assert n > 5
    assert points.remember(memory, n, scan, pose, 2.0, False) == n, "seen twice is known once"
    away = np.array([3.5, 0.0, 0.0])
    assert points.remember(memory, n, scan[:0], away, 2.0, False) == n, "out of range nothing is disproved"
    assert points.remember(memory, n, scan[:0], pose, 2.0, False) == 0


# --- the printed scheme


def test_the_printed_length_with_the_fitted_block() -> None:
    run = blend.drive(blend.PrintedScheme(gate=np.pi / 2), TOP, reference=FigureEight(), limited=False, euler=True)
    assert run.status == "done"
    assert run.length == pytest.approx(19.25, abs=0.005)
    assert run.min_clearance > 0.1


def test_the_printed_gate_hits_the_block() -> None:
    ends = [blend.drive(blend.PrintedScheme(), block_of(seed)).status for seed in range(300_000, 300_010)]
    assert ends == ["collided"] * 10


def test_the_printed_controller_runs_in_the_loop_of_the_course() -> None:
    scheme = blend.PrintedScheme(gate=np.pi / 2)
    direct = blend.drive(scheme, TOP, reference=HALF)
    start = direct.poses[0]
    law = blend.PrintedBlend(HALF, scheme)
    looped = simulate.run(World(rectangles=[TOP]), TURTLEBOT2, law, start, [50, 50], t_max=40.0)
    np.testing.assert_allclose(looped.poses[:250], direct.poses[:250], atol=1e-3)
    assert np.hypot(*(looped.poses - direct.poses[:401])[:, :2].T).max() < 0.05, "360 beams for the exact nearest point"


# --- the safe blend


@pytest.fixture(scope="module")
def safe_runs() -> list[Run]:
    return [blend.drive(blend.SafeScheme(), block_of(seed), laps=2.0) for seed in range(300_000, 300_012)]


def test_the_safe_blend_touches_nothing_and_comes_back(safe_runs: list[Run]) -> None:
    for run in safe_runs:
        assert run.status == "done"
        assert run.min_clearance > 0.05
        late = run.distance[run.t >= blend.last_avoidance(run) + 10.0]
        assert np.sqrt((late**2).mean()) < 0.05


def test_the_safe_blend_keeps_limits_and_the_order_of_time(safe_runs: list[Run]) -> None:
    for run in safe_runs:
        assert respects_limits(run.commands, 0.1, TURTLEBOT2)
        assert (run.commands[:, 0] >= 0).all()
        steps, weight = np.diff(run.log["index"]), run.log["weight"]
        assert steps.min() >= 0
        assert steps.max() <= blend.SafeScheme().rate + 1, "the step of the hand-back adds its own"
        assert ((weight >= 0) & (weight <= 1)).all()


def test_the_same_run_twice_bit_for_bit() -> None:
    first, second = (blend.drive(blend.SafeScheme(), TOP, reference=HALF) for _ in range(2))
    np.testing.assert_array_equal(first.poses, second.poses)


def test_without_a_block_the_safe_blend_is_feedback_linearization() -> None:
    alone = blend.drive(blend.SafeScheme(), [40.0, 0.0, 0.2, 0.3, 0.0], reference=HALF)
    dfl = tracking.follow(tracking.Tracker(HALF, tracking.Dfl()))
    np.testing.assert_allclose(alone.poses, dfl.poses[: len(alone.poses)], atol=1e-9)
    assert blend.last_avoidance(alone) == 0.0


def test_a_moved_scene_gives_the_moved_run() -> None:
    pose = np.array([1.3, -0.7, 0.9])
    c, s = np.cos(pose[2]), np.sin(pose[2])
    moved = [pose[0] + c * TOP[0] - s * TOP[1], pose[1] + s * TOP[0] + c * TOP[1], *TOP[2:4], TOP[4] + pose[2]]
    here = blend.drive(blend.SafeScheme(), TOP, reference=HALF)
    there = blend.drive(blend.SafeScheme(), moved, reference=HALF.moved(pose))
    assert there.min_clearance == pytest.approx(here.min_clearance, abs=1e-3)
    assert blend.delay(there) == pytest.approx(blend.delay(here), abs=0.2)


def test_the_safe_controller_drives_the_same_path_in_the_loop_of_the_course() -> None:
    for block in (TOP, block_of(300_001)):
        direct = blend.drive(blend.SafeScheme(), block, reference=HALF)
        steps = len(direct.commands)
        looped = simulate.run(
            World(rectangles=[block]),
            TURTLEBOT2,
            blend.SafeBlend(HALF),
            direct.poses[0],
            [50, 50],
            t_max=0.1 * steps,
            laser=replace(simulate.IDEAL_LASER, range_max=2.0),
        )
        n = min(len(looped.poses), steps)
        np.testing.assert_allclose(looped.poses[:n], direct.poses[:n], atol=1e-6)


RARE = ("same_side", "guard_turn")  # they act in a few scenes alone, and have tests of their own


@pytest.mark.parametrize("name", [f.name for f in fields(blend.SafeScheme) if f.name not in RARE])
def test_every_choice_changes_something(name: str) -> None:
    blocks = [TOP, block_of(300_000), block_of(300_003), block_of(300_008)]
    scheme = blend.SafeScheme(moving=name.startswith("evade"))
    base, value = [blend.drive(scheme, b).poses for b in blocks], getattr(scheme, name)
    for new in [True] if name == "moving" else [1.6 * value, 0.4 * value, 8 * value, 0.05 * value]:
        try:
            other = replace(scheme, **{name: type(value)(new)})
        except ValueError:
            continue
        runs = [blend.drive(other, b).poses for b in blocks]
        moved = any(len(a) != len(b) or np.abs(a - b).max() > 1e-9 for a, b in zip(base, runs, strict=True))
        if moved:
            break
    assert moved, f"{name} has no effect"


# --- one step


def ahead_of(pose: list[float], distance: float, speed: float = 0.0) -> np.ndarray:
    """A few points across the way of a robot that looks along x, coming nearer at `speed`."""
    return np.array([[pose[0] + distance, pose[1] + y, -speed, 0.0] for y in (-0.02, 0.0, 0.02)])


def guarded(scheme: blend.SafeScheme, points: np.ndarray, v: float, away: float = 0.5) -> tuple[float, float, bool]:
    memory = tracking.Tracker(HALF, tracking.Dfl()).start().memory
    record = scheme.record(blend.table_5_1(), TURTLEBOT2.radius)
    return kernels.guard(record[0], memory[0], points, np.zeros(3), v, 0.0, away)


def test_the_guard_brakes_before_the_margin_and_turns_to_free_ground() -> None:
    scheme = blend.SafeScheme()
    need = TURTLEBOT2.radius + scheme.guard
    reach = 0.6**2 / TURTLEBOT2.dec_lim_x + 2.0 * 0.1 * 0.6  # what the held command drives while it looks
    assert guarded(scheme, ahead_of([0, 0], need + reach - 0.01), 0.6) == (0.0, pytest.approx(2.0 * 0.5), True)
    assert guarded(scheme, ahead_of([0, 0], need + reach + 0.01), 0.6) == (0.6, 0.0, False)
    assert guarded(scheme, ahead_of([0, 0], need - 0.1), -0.2)[2] is False, "away from what is near already"
    assert guarded(replace(scheme, guard_turn=1.0), ahead_of([0, 0], need), 0.6)[1] == pytest.approx(0.5)


def test_the_guard_evades_what_moves_and_leaves_what_it_clears() -> None:
    scheme = blend.SafeScheme(moving=True)
    v, _, changed = guarded(scheme, ahead_of([0, 0], 0.8, speed=0.3), 0.2)
    assert changed
    assert v < 0
    assert guarded(scheme, ahead_of([0, 0], 3.0, speed=0.3), 0.2) == (0.2, 0.0, False)


def test_a_block_straight_ahead_turns_the_printed_robot_to_the_left() -> None:
    law = blend.PrintedBlend(HALF)
    pose = HALF.sample(0.0).pose
    for bearing, sign in ((0.0, 1.0), (-0.2, 1.0), (0.2, -1.0)):
        at = pose[:2] + 0.3 * np.array([np.cos(pose[2] + bearing), np.sin(pose[2] + bearing)])
        law.reset()
        base = law(seen(0.0, pose, np.zeros(2)))
        law.reset()
        given = Observation(time=0.0, pose=pose, velocity=np.zeros(2), goal=np.zeros(2), points=at[None])
        command = law(given)
        f = law.evidence["F"]
        assert command[1] == pytest.approx((1.0 - f) * base[1] + f * sign, abs=1e-12), bearing
        assert f > 0.5


@pytest.mark.parametrize("same_side", [3.0, 6.0])
def test_a_detour_that_begins_soon_after_the_last_keeps_its_side(same_side: float) -> None:
    pose = HALF.sample(0.0).pose
    across = np.array([-np.sin(pose[2]), np.cos(pose[2])])
    at = pose[:2] + 0.5 * np.array([np.cos(pose[2]), np.sin(pose[2])]) - 0.1 * across  # on the right: pass it left
    sides = []
    for released in (-1.0, -same_side + 0.1, -same_side - 0.1):
        law = blend.SafeBlend(HALF, blend.SafeScheme(same_side=same_side))
        law.mind.side, law.mind.released = -1.0, released
        law(Observation(time=0.0, pose=pose, velocity=np.zeros(2), goal=np.zeros(2), points=at[None]))
        assert law.mind.latched
        sides.append(float(law.mind.side))
    assert sides == [-1.0, -1.0, 1.0]


# --- moving points


def test_a_point_that_comes_nearer_drives_the_robot_away() -> None:
    law = blend.SafeBlend(HALF, blend.SafeScheme(moving=True))
    pose = HALF.sample(0.0).pose
    ahead = pose[:2] + 0.5 * np.array([np.cos(pose[2]), np.sin(pose[2])])
    towards = -0.3 * np.array([[np.cos(pose[2]), np.sin(pose[2])]])
    for k in range(8):
        observation = Observation(
            time=0.1 * k,
            pose=pose,
            velocity=np.zeros(2),
            goal=np.zeros(2),
            points=ahead[None],
            point_velocities=towards,
        )
        command = law(observation)
    assert command[0] < 0, "it backs away from what comes at it head-on"


# --- bad input


@pytest.mark.parametrize(
    ("kind", "values"),
    [
        (blend.PrintedScheme, {"gate": 4.0}),
        (blend.PrintedScheme, {"d0": -0.1}),
        (blend.PrintedScheme, {"turn": 0.0}),
        (blend.PrintedScheme, {"keep_speed": 1.5}),
        (blend.SafeScheme, {"leave": 0.05}),
        (blend.SafeScheme, {"cruise": 0.0}),
        (blend.SafeScheme, {"follow": np.nan}),
    ],
)
def test_bad_choices_are_refused(kind: type, values: dict[str, float]) -> None:
    with pytest.raises(ValueError):
        kind(**values)


def test_bad_scenes_are_refused() -> None:
    with pytest.raises(ValueError, match="touches the robot at its start"):
        blend.drive(blend.SafeScheme(), [0.1, 0.0, 0.2, 0.3, 0.0])
    with pytest.raises(ValueError, match="positive sizes"):
        blend.drive(blend.SafeScheme(), [1.0, 0.0, 0.0, 0.3, 0.0])
    with pytest.raises(ValueError, match="two inputs"):
        blend.drive(blend.SafeScheme(), TOP, system=FuzzySystem.load(rules.TABLE.with_name("thesis_table_3_2.fll")))
    with pytest.raises(ValueError, match="close < far"):
        blend.rule_base(close=1.0, far=0.5)
    with pytest.raises(ValueError, match="dt must be positive"):
        blend.drive(blend.SafeScheme(), TOP, dt=-0.1)


@pytest.mark.parametrize("law", [blend.SafeBlend, blend.PrintedBlend])
def test_a_pose_that_is_not_finite_is_refused(law: type) -> None:
    with pytest.raises(ValueError, match="not finite"):
        law(HALF)(seen(0.0, np.array([np.nan, 0.0, 0.0]), np.zeros(2)))


@settings(max_examples=15, deadline=None)
@given(st.integers(310_000, 399_999))
def test_any_seed_is_passed_without_contact(seed: int) -> None:
    run = blend.drive(blend.SafeScheme(), block_of(seed))
    assert run.status == "done"
    assert run.min_clearance > 0.05
