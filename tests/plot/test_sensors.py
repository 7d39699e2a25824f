"""The pictures and labs of chapter 01: what they return, and that they follow the numbers."""

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fuzzynav import plot, sensors
from fuzzynav.course.exercise import judge
from fuzzynav.course.exercises.ch01 import EXERCISES
from fuzzynav.course.reader import solution_blocks
from fuzzynav.geometry import length
from fuzzynav.lab import Panel, Slider
from fuzzynav.robot import TURTLEBOT2
from fuzzynav.sensors import cameras
from fuzzynav.studies import sensors as study


@pytest.fixture
def ax() -> Axes:
    figure, axes = plt.subplots()
    yield axes
    plt.close(figure)


def texts(ax: Axes) -> list[str]:
    return [t.get_text() for t in ax.texts]


def test_diagrams_name_what_the_figures_name(ax: Axes) -> None:
    plot.robot_kinds(ax)
    assert {"fixed", "mobile", "hybrid", "differential drive", "car-like", "omnidirectional"} <= set(texts(ax))
    plot.navigation_architectures(ax)
    assert {"deliberative", "reactive", "hybrid", "sense", "plan", "act"} <= set(texts(ax))
    plot.fusion_pipeline(ax)
    assert {"wheel encoders", "sonar", "laser scanner", "camera"} <= set(texts(ax))


@pytest.mark.parametrize("kind", ["differential", "car", "omni"])
def test_each_base_is_drawn(ax: Axes, kind: str) -> None:
    plot.wheeled_base(ax, kind)
    assert len(ax.patches) >= 3


def test_an_unknown_base_is_refused(ax: Axes) -> None:
    with pytest.raises(ValueError, match="differential"):
        plot.wheeled_base(ax, "tracked")


def test_turning_sketch_returns_the_rims(ax: Axes) -> None:
    assert plot.turning_sketch(ax, 1.0, 0.3, TURTLEBOT2) == pytest.approx((0.415, 0.185))


def test_encoder_counts_four_edges_a_slot_and_the_channels_make_them(ax: Axes) -> None:
    assert len(plot.encoder_disc(ax, 12)) == 12
    before = len(ax.lines)
    counts = plot.encoder_signals(ax, np.linspace(0.0, np.pi / 2, 4001), 12)
    assert counts[-1] == 12
    edges = sum(np.abs(np.diff(line.get_ydata())).astype(bool).sum() for line in ax.lines[before : before + 2])
    assert edges == pytest.approx(12, abs=1)  # the last one falls on the end of the axis


def test_times_of_flight(ax: Axes) -> None:
    assert plot.echo_sketch(ax, 1.715) == pytest.approx(0.01)
    assert plot.laser_sketch([ax, ax], 10.0, sensors.SPEED_OF_LIGHT) == pytest.approx(66.71e-9, rel=1e-4)


def test_pinhole_pictures_use_the_projection(ax: Axes) -> None:
    rows = plot.pinhole_side(ax, cameras.KINECT, [[0.0, 0.5, 2.0]])
    assert rows == pytest.approx([525 * 0.25 + 239.5])
    corners = plot.pinhole_picture(ax, cameras.KINECT, [0.0, 0.0, 2.0], 1.0)
    assert corners.mean(axis=0) == pytest.approx([319.5, 239.5])
    assert np.ptp(corners[:, 0]) == pytest.approx(525 / 1.5)


def test_scan_beams_and_cone_are_where_they_belong(ax: Axes) -> None:
    scan = sensors.Scan(angles=np.array([0.0, 0.5, 1.0]), ranges=np.array([2.0, np.inf, np.nan]), range_max=5.0)
    beams = plot.draw_beams(ax, [1.0, 0.0, 0.0], scan)
    ends = np.array([s[1] for s in beams.get_segments()])
    assert ends[0] == pytest.approx([3.0, 0.0])
    assert np.hypot(*(ends[1] - [1.0, 0.0])) == pytest.approx(5.0)
    assert ends[2] == pytest.approx([1.0, 0.0])
    assert plot.draw_scan(ax, [1.0, 0.0, 0.0], scan, label="points").get_offsets().tolist() == [[3.0, 0.0]]
    cone = plot.draw_cone(ax, [0.0, 0.0, np.pi / 2], np.pi / 6, 2.0)
    assert (cone.theta1, cone.theta2, cone.r) == pytest.approx((75.0, 105.0, 2.0))


def test_the_square_closes_and_its_length_is_right() -> None:
    motions = study.square_motions(side=3.0, corner=0.5, laps=2)
    path = sensors.dead_reckon(np.zeros(3), motions)
    assert np.abs(path[-1, :2]).max() < 1e-9
    assert motions[:, 0].sum() == pytest.approx(2 * (8.0 + np.pi))
    assert length(path) == pytest.approx(motions[:, 0].sum(), rel=1e-3)
    assert motions[:, 0].max() <= 0.05 + 1e-9
    with pytest.raises(ValueError, match="corners"):
        study.square_motions(side=1.0, corner=0.6)


def test_a_perfect_robot_believes_the_truth() -> None:
    motions = study.square_motions()
    told = study.believed_run(motions, TURTLEBOT2, sensors.Encoders(ticks_per_turn=10**7))
    assert np.abs(told - sensors.dead_reckon(np.zeros(3), motions))[:, :2].max() < 1e-5


def test_the_person_stands_free_at_every_moment_and_is_seen() -> None:
    world = study.room()
    times = np.linspace(0.0, 10.0, 51)[:, None]
    way = np.add(world.movers[0].start, np.multiply(times, world.movers[0].velocity))
    assert study.room(person=False).clearance(way).min() > world.movers[0].radius
    laser = sensors.Laser(beams=361, field_of_view=2 * np.pi)
    pose = np.array([3.2, 1.6, 0.6])
    for at in way[::10]:
        points = sensors.laser_ideal(world, pose, laser, at[None]).world_points(pose)
        assert (np.abs(np.hypot(*(points - at).T) - 0.25) < 1e-9).sum() >= 5


LABS = {
    "wheel_error_lab": {"right": 0.0, "left": 0.0, "track": 0.0, "slip": 0.0, "noise": 0.0, "ticks": 2578},
    "laser_lab": {"time": 0.0, "beams_used": 91, "noise": 0.0, "dropout": 0.0, "reach": 6.0},
    "sonar_lab": {"angle": 0.0, "distance": 2.0, "cone": 30.0, "specular": 25.0},
    "stereo_lab": {"focal": 525.0, "baseline": 0.12, "sigma": 0.3, "at": 4.0},
}


@pytest.mark.parametrize(
    ("name", "change", "before", "after"),
    [
        ("wheel_error_lab", {"right": 1.0}, "0.00 m and 0.0 deg off", "m and"),
        ("laser_lab", {"dropout": 60.0}, "91 of 91", "of 91"),
        ("sonar_lab", {"angle": 60.0}, "Reading 2.00 m", "No echo: the sonar reports 5.00 m"),
        ("stereo_lab", {"baseline": 0.24}, "disparity 15.8 px, standard deviation 7.6 cm", "standard deviation 3.8 cm"),
    ],
)
def test_labs_say_what_they_show(name: str, change: dict[str, float], before: str, after: str) -> None:
    update = getattr(plot, name)(Figure())
    artists, said = update(**LABS[name])
    assert len(artists) >= 2
    assert before in said
    _, changed = update(**{**LABS[name], **change})
    assert after in changed
    assert changed != said


def test_a_lab_redraws_in_its_panel() -> None:
    sliders = {
        name: Slider(name, 0.0, 400.0 if name == "beams_used" else 60.0, value, 1.0)
        for name, value in LABS["laser_lab"].items()
        if name != "beams_used"
    }
    sliders["beams_used"] = Slider("beams", 9, 361, 91, 2)
    panel = Panel(plot.laser_lab, sliders, title="test")
    picture = panel.png
    panel.set(time=5.0)
    assert panel.png != picture
    panel.reset()
    assert panel.text.startswith("91 of 91")


NAMES = {"01.1": "ticks_to_pose", "01.2": "yaw_rate", "01.3": "calibrate", "01.4": "ticks", "01.5": "baseline"}


@pytest.mark.parametrize("exercise", EXERCISES, ids=lambda e: e.id)
def test_solutions_pass_and_anything_else_gets_a_sentence(exercise: object) -> None:
    from pathlib import Path

    from fuzzynav import robot

    blocks = solution_blocks(Path(__file__).parents[2] / "notebooks/solutions/01_sensors_and_odometry.py")
    space = {"np": np, "robot": robot}
    exec(blocks[exercise.id], space)
    assert judge(exercise, space[NAMES[exercise.id]]).points == exercise.points
    for answer in (..., None, "text", -1.0, lambda *a: ..., lambda *a: 0.1, lambda: 1, float("nan"), 10**9):
        outcome = judge(exercise, answer)
        assert outcome.points == 0
        assert outcome.sentence.startswith(f"Exercise {exercise.id}: not ")


@pytest.mark.parametrize(
    ("number", "answer", "words"),
    [
        (
            0,
            lambda p, r, le, n, R, L: (p[0] + np.pi * R * (r + le) / n, p[1], p[2] + 2 * np.pi * R * (le - r) / n / L),
            "turn the robot to the left",
        ),
        (1, lambda r, le, R, L: R / (2 * L) * (r - le), "twice as much"),
        (2, lambda line, d, spin, a, n: (d * n / (2 * np.pi * line[0]), 0.3), "fits the right counter alone"),
        (3, 547, "limit is 0.1 deg"),
        (3, 600, "one less would do"),
        (4, 0.1, "limit is 4 cm"),
        (4, 0.2, "search ends at 160 px"),
    ],
)
def test_wrong_answers_hear_what_is_wrong(number: int, answer: object, words: str) -> None:
    assert words in judge(EXERCISES[number], answer).sentence
