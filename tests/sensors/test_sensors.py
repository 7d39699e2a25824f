"""Encoders, sonar, laser and cameras."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fuzzynav import sensors as s
from fuzzynav.geometry import length, to_body, to_world
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.robot import TURTLEBOT2, move
from fuzzynav.sensors import cameras as cam
from fuzzynav.world import Mover, World

BOX = GridMap.from_ascii("\n".join(["#" * 42, *(["#" + "." * 40 + "#"] * 40), "#" * 42]), 0.1, (-2.1, -2.1))
TURN = np.array([0.0, 0.0, 2.0 * np.pi])


class Slanted:
    """A world with one infinite wall through (2, 0) whose normal makes `angle` with the x axis."""

    def __init__(self, angle: float) -> None:
        self.normal = np.array([np.cos(angle), np.sin(angle)])

    def cast(self, pose: np.ndarray, angles: np.ndarray, range_max: float) -> np.ndarray:
        beams = pose[2] + angles
        closing = self.normal[0] * np.cos(beams) + self.normal[1] * np.sin(beams)
        gap = self.normal @ (np.array([2.0, 0.0]) - pose[:2])
        with np.errstate(divide="ignore"):
            ranges = np.where(gap * closing > 0, gap / closing, np.inf)
        return np.minimum(ranges, range_max)


# --- encoders


def test_one_turn_of_both_wheels_is_one_circumference() -> None:
    counts = [[0, 0], [1000, 1000]]
    assert s.odometry(counts, TURTLEBOT2, 1000) == pytest.approx(np.array([[2 * np.pi * 0.035, 0.0]]))
    assert s.odometry([[0, 0], [1000, -1000]], TURTLEBOT2, 1000)[0, 1] == pytest.approx(4 * np.pi * 0.035 / 0.23)


@given(st.lists(st.tuples(st.floats(-0.1, 0.1), st.floats(-0.2, 0.2)), min_size=1, max_size=40), st.integers(16, 5000))
def test_counting_ticks_loses_less_than_one_tick_over_a_whole_run(motions: list[tuple[float, float]], n: int) -> None:
    counts = s.encoder_counts(motions, TURTLEBOT2, s.Encoders(ticks_per_turn=n))
    told = s.odometry(counts, TURTLEBOT2, n).sum(axis=0)
    tick = s.wheel_travel(1, n, TURTLEBOT2.wheel_radius)
    gap = np.abs(told - np.sum(motions, axis=0))
    assert gap[0] <= tick * (1 + 1e-6)
    assert gap[1] <= 2 * tick / TURTLEBOT2.track * (1 + 1e-6)


def test_finer_ticks_converge_to_the_truth() -> None:
    motions = np.tile([0.02, 0.03], (200, 1))
    truth = s.dead_reckon([0, 0, 0], motions)[-1]
    errors = []
    for n in (64, 1024, 16384):
        told = s.odometry(s.encoder_counts(motions, TURTLEBOT2, s.Encoders(ticks_per_turn=n)), TURTLEBOT2, n)
        errors.append(np.hypot(*(s.dead_reckon([0, 0, 0], told)[-1] - truth)[:2]))
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 1e-3


@pytest.mark.parametrize(
    ("fault", "factor"),
    [
        ({"right_radius_error": 0.02, "left_radius_error": 0.02}, (1 / 1.02, 1 / 1.02)),
        ({"track_error": 0.05}, (1.0, 1.05)),
        ({"slip": 0.1}, (1 / 0.9, 1 / 0.9)),
    ],
)
def test_each_fault_scales_what_it_should(fault: dict[str, float], factor: tuple[float, float]) -> None:
    motions = np.tile([0.02, 0.01], (500, 1))
    encoders = s.Encoders(ticks_per_turn=10**7, **fault)
    told = s.odometry(s.encoder_counts(motions, TURTLEBOT2, encoders), TURTLEBOT2, 10**7).sum(axis=0)
    assert told / motions.sum(axis=0) == pytest.approx(factor, rel=1e-4)


def test_unequal_wheels_bend_a_straight_run() -> None:
    motions = np.tile([0.02, 0.0], (500, 1))
    encoders = s.Encoders(ticks_per_turn=10**6, right_radius_error=0.01)
    told = s.odometry(s.encoder_counts(motions, TURTLEBOT2, encoders), TURTLEBOT2, 10**6).sum(axis=0)
    assert told[1] == pytest.approx(-10.0 * (1 - 1 / 1.01) / 0.23, rel=1e-3)  # the larger wheel turns less


def test_slip_noise_grows_with_the_root_of_the_way_and_is_seeded() -> None:
    encoders = s.Encoders(ticks_per_turn=10**7, slip_noise=0.02)
    for n in (100, 400):
        ends = []
        for k in range(300):
            counts = s.encoder_counts(np.tile([0.01, 0.0], (n, 1)), TURTLEBOT2, encoders, np.random.default_rng(k))
            ends.append(s.odometry(counts, TURTLEBOT2, 10**7).sum(axis=0))
        assert np.std(ends, axis=0)[0] == pytest.approx(0.02 * np.sqrt(n * 0.01 / 2), rel=0.15)
    one, two = (s.encoder_counts([[1.0, 0.5]], TURTLEBOT2, encoders, np.random.default_rng(4)) for _ in range(2))
    assert np.array_equal(one, two)
    with pytest.raises(ValueError, match="random generator"):
        s.encoder_counts([[1.0, 0.0]], TURTLEBOT2, encoders)


def test_dead_reckoning_is_a_chain_of_arcs() -> None:
    motions = np.random.default_rng(1).normal(0.0, 0.3, (50, 2))
    pose = np.array([1.0, -2.0, 0.4])
    chain = [pose]
    for motion in motions:
        chain.append(move(chain[-1], motion, 1.0))
    assert np.allclose(s.dead_reckon(pose, motions), chain, atol=1e-12)
    assert s.dead_reckon(pose, np.empty((0, 2))).tolist() == [pose.tolist()]
    assert np.allclose(s.dead_reckon(pose + TURN, motions), chain, atol=1e-9)


# --- sonar


def test_sonar_sees_a_square_wall_and_loses_a_slanted_one() -> None:
    sonar = s.Sonar(noise=0.0, rays=201)
    assert s.sonar_ideal(Slanted(0.0), np.zeros(3), sonar) == pytest.approx(2.0)
    half, limit = sonar.cone / 2, sonar.specular_angle
    heard = s.sonar_ideal(Slanted(half + limit - 0.02), np.zeros(3), sonar)
    assert heard < 2.0  # the nearest part of the wall, at the edge of the cone
    assert s.sonar_ideal(Slanted(half + limit + 0.02), np.zeros(3), sonar) == sonar.range_max


def test_sonar_hears_the_nearest_part_of_the_cone() -> None:
    sonar = s.Sonar(noise=0.0, rays=201, cone=np.deg2rad(40), specular_angle=np.deg2rad(60))
    tilt = np.deg2rad(10)  # the foot of the normal lies inside the cone
    assert s.sonar_ideal(Slanted(tilt), np.zeros(3), sonar) == pytest.approx(2.0 * np.cos(tilt), rel=1e-4)


def test_sonar_limits_noise_and_seed() -> None:
    sonar = s.Sonar()
    near = np.array([1.95, 0.0, 0.0])
    assert s.sonar_ideal(Slanted(0.0), near, sonar) == sonar.range_min
    assert s.sonar_reading(Slanted(0.0), [-9.0, 0.0, 0.0], sonar, np.random.default_rng(0)) == sonar.range_max
    readings = [s.sonar_reading(Slanted(0.0), np.zeros(3), sonar, np.random.default_rng(k)) for k in range(400)]
    assert np.mean(readings) == pytest.approx(2.0, abs=0.005)
    assert np.std(readings) == pytest.approx(0.02, rel=0.15)
    assert readings[3] == s.sonar_reading(Slanted(0.0), np.zeros(3), sonar, np.random.default_rng(3))


# --- laser


def test_laser_in_a_box_by_hand() -> None:
    laser = s.Laser(beams=5, field_of_view=np.pi, noise=0.0, range_max=2.5)
    scan = s.laser_ideal(BOX, [0.0, 0.0, 0.0], laser)
    assert scan.ranges == pytest.approx([2.0, np.inf, 2.0, np.inf, 2.0])
    assert scan.points == pytest.approx(np.array([[0, -2], [2, 0], [0, 2]]), abs=1e-9)
    assert s.laser_ideal(BOX, [1.98, 0.0, 0.0], laser).ranges[2] == -np.inf


@given(st.tuples(st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1)).map(np.array))
def test_scan_points_lie_on_the_walls_from_everywhere(pose: np.ndarray) -> None:
    laser = s.Laser(beams=40, field_of_view=2 * np.pi, range_max=9.0)
    scan = s.laser_ideal(BOX, pose, laser)
    assert np.abs(np.abs(scan.world_points(pose)).max(axis=1) - 2.0).max() < 1e-9
    turned = s.laser_ideal(BOX, pose + TURN, laser)
    assert np.allclose(turned.ranges, scan.ranges, atol=1e-6)


def test_a_full_circle_does_not_repeat_its_first_beam() -> None:
    angles = s.Laser(beams=8, field_of_view=2 * np.pi).angles
    assert np.allclose(np.diff(angles), np.pi / 4)
    assert s.Laser(beams=3).angles == pytest.approx([-np.pi / 2, 0, np.pi / 2])
    assert s.Laser(beams=1).angles.tolist() == [0.0]


def test_laser_faults_have_the_stated_size() -> None:
    laser = s.Laser(beams=20000, noise=0.03, dropout=0.2, range_max=5.0)
    ideal = s.Scan(angles=laser.angles, ranges=np.full(20000, 2.0), range_max=5.0)
    scan = s.laser_faults(ideal, laser, np.random.default_rng(0))
    assert np.isnan(scan.ranges).mean() == pytest.approx(0.2, abs=0.01)
    assert np.std(scan.ranges[scan.hits]) == pytest.approx(0.03, rel=0.03)
    assert np.mean(scan.ranges[scan.hits]) == pytest.approx(2.0, abs=1e-3)
    again = s.laser_faults(ideal, laser, np.random.default_rng(0))
    assert np.array_equal(scan.ranges, again.ranges, equal_nan=True)


def test_nothing_stays_nothing_under_noise() -> None:
    laser = s.Laser(beams=3, noise=0.5, range_max=5.0)
    scan = s.Scan(angles=laser.angles, ranges=np.array([np.inf, -np.inf, 4.99]), range_max=5.0)
    noisy = s.laser_faults(scan, laser, np.random.default_rng(0)).ranges
    assert noisy[:2].tolist() == [np.inf, -np.inf]
    assert noisy[2] <= 5.0


def test_polar_points_and_the_printed_speed_of_light() -> None:
    assert s.polar_to_points([2.0, np.nan], [np.pi / 2, 0.0])[0] == pytest.approx([0.0, 2.0])
    assert s.SPEED_OF_LIGHT_AS_PRINTED / s.SPEED_OF_LIGHT - 1 == pytest.approx(6.9e-4, rel=0.01)
    assert s.laser_range(2 * 7.0 / s.SPEED_OF_LIGHT) == pytest.approx(7.0)


@pytest.mark.parametrize(
    ("model", "bad"),
    [
        (s.Laser, {"beams": -1}),
        (s.Laser, {"beams": 2.5}),
        (s.Laser, {"noise": -0.1}),
        (s.Laser, {"dropout": 1.1}),
        (s.Laser, {"range_max": np.nan}),
        (s.Laser, {"range_min": 9.0}),
        (s.Sonar, {"rays": 0}),
        (s.Sonar, {"noise": -1.0}),
        (s.Sonar, {"cone": 0.0}),
        (s.Sonar, {"range_min": 6.0}),
        (s.Encoders, {"ticks_per_turn": 0}),
        (s.Encoders, {"slip": 1.0}),
        (s.Encoders, {"slip_noise": -0.1}),
        (s.Encoders, {"track_error": -1.0}),
        (cam.Stereo, {"baseline": 0.0}),
        (cam.Stereo, {"disparity_sigma": -1.0}),
        (cam.DepthCamera, {"dropout": 2.0}),
        (cam.DepthCamera, {"noise": -1.0}),
    ],
)
def test_impossible_sensors_are_refused(model: type, bad: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=f"{model.__name__}.*{next(iter(bad))}"):
        model(**bad)


@pytest.mark.parametrize("pose", [[np.nan, 0, 0], [0, 0], [0, np.inf, 0]])
def test_a_pose_that_is_none_is_refused(pose: list[float]) -> None:
    for call in (
        lambda: s.laser_ideal(BOX, pose, s.Laser()),
        lambda: s.sonar_ideal(BOX, pose, s.Sonar()),
        lambda: s.dead_reckon(pose, [[0.1, 0.0]]),
        lambda: cam.depth_ideal(BOX, pose, cam.DepthCamera()),
    ):
        with pytest.raises(ValueError, match="pose"):
            call()


def test_moving_obstacles_are_seen_where_they_are_and_a_map_has_none() -> None:
    world = World(grid=BOX, movers=(Mover.constant((1.0, 0.0), (0.0, 0.0), 0.25),))
    laser = s.Laser(beams=1)
    assert s.laser_ideal(world, [0, 0, 0], laser).ranges == pytest.approx([0.75])
    assert s.laser_ideal(world, [0, 0, 0], laser, [[-1.0, 0.0]]).ranges == pytest.approx([2.0])
    assert s.sonar_ideal(world, [0, 0, 0], s.Sonar(), [[1.5, 0.0]]) == pytest.approx(1.25)
    upper = cam.depth_ideal(world, [0, 0, 0], cam.DepthCamera(), [[1.5, 0.0]])[:30]
    assert np.nanmin(upper) == pytest.approx(1.25, abs=0.01)
    with pytest.raises(ValueError, match="no moving obstacles"):
        s.laser_ideal(BOX, [0, 0, 0], laser, [[1.0, 0.0]])


@pytest.mark.parametrize(("angles", "ranges"), [([0.0], [1.0, 2.0]), ([np.nan], [1.0]), ([0.0], [-1.0])])
def test_bad_scans_are_refused(angles: list[float], ranges: list[float]) -> None:
    with pytest.raises(ValueError, match="scan"):
        s.Scan(angles=np.array(angles), ranges=np.array(ranges), range_max=5.0)


# --- cameras


@given(st.tuples(st.floats(-2, 2), st.floats(-2, 2), st.floats(0.1, 9.0)), st.floats(0.1, 5.0))
def test_projection_forgets_only_the_scale(point: tuple[float, float, float], scale: float) -> None:
    one, two = cam.project(point, cam.KINECT), cam.project(np.multiply(point, scale), cam.KINECT)
    assert np.allclose(one, two)


def test_projection_of_the_world_by_hand_and_by_both_ways() -> None:
    pose = np.array([1.0, 2.0, np.pi / 2])
    rotation, translation = cam.extrinsics(pose, 0.5)
    assert np.allclose(rotation @ rotation.T, np.eye(3))
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    ahead = np.array([[1.0, 5.0, 0.5], [0.0, 5.0, 0.5], [1.0, 5.0, 1.5], [1.0, 0.0, 0.5]])
    pixels, depth = cam.project_world(ahead, rotation, translation, cam.KINECT)
    assert depth == pytest.approx([3.0, 3.0, 3.0, -2.0])
    assert pixels[0] == pytest.approx([cam.KINECT.cx, cam.KINECT.cy])
    assert pixels[1, 0] < cam.KINECT.cx  # what lies to the left is on the left of the picture
    assert pixels[2, 1] < cam.KINECT.cy  # what is higher is higher in the picture
    assert np.isnan(pixels[3]).all()
    assert np.allclose(pixels[:3], cam.project((ahead @ rotation.T + translation)[:3], cam.KINECT))
    optical = ahead[:3] @ rotation.T + translation
    assert np.allclose(pixels[:3], optical @ cam.intrinsics(cam.KINECT)[:2].T / depth[:3, None])


def test_what_is_not_in_front_of_a_camera_has_no_pixel() -> None:
    behind = [[0.1, 0.2, -1.0], [0.1, 0.2, 0.0], [0.1, 0.2, np.nan]]
    assert np.isnan(cam.project(behind, cam.KINECT)).all()
    assert np.isfinite(cam.project([0.1, 0.2, 1e-3], cam.KINECT)).all()


def test_noisy_pixels_are_whole_and_leave_the_picture_as_nan() -> None:
    rng = np.random.default_rng(0)
    seen = cam.noisy_pixels([[100.2, 50.7], [-30.0, 50.0], [np.nan, np.nan]], cam.KINECT, 0.0, rng)
    assert seen[0].tolist() == [100.0, 51.0]
    assert np.isnan(seen[1:]).all()
    with pytest.raises(ValueError, match="sigma"):
        cam.noisy_pixels([[0, 0]], cam.KINECT, -1.0, rng)


def test_stereo_error_grows_with_the_square_of_the_depth() -> None:
    stereo, rng = cam.Stereo(), np.random.default_rng(0)
    assert cam.stereo_depth(cam.disparity(4.0, stereo), stereo) == pytest.approx(4.0)
    for depth in (1.0, 2.0, 4.0):
        measured = np.std(cam.stereo_reading(np.full(20000, depth), stereo, rng))
        assert measured == pytest.approx(float(cam.stereo_sigma(depth, stereo)), rel=0.03)
    assert cam.stereo_sigma(4.0, stereo) == pytest.approx(4 * cam.stereo_sigma(2.0, stereo))
    assert np.isnan(cam.stereo_depth([0.0, -1.0], stereo)).all()


def test_depth_image_and_its_points_agree_with_the_walls() -> None:
    depth = cam.DepthCamera(range_min=0.2, range_max=4.0)
    pose = np.array([-0.3, 0.4, 0.6])
    image = cam.depth_ideal(BOX, pose, depth)
    points = cam.body_from_optical(cam.depth_points(image, depth.camera), depth.mount)
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-9)
    assert points[:, 2].max() <= depth.wall + 1e-9
    wall = cam.depth_slice(points, 0.05, depth.wall)
    assert np.abs(np.abs(to_world(pose, wall)).max(axis=1) - 2.0).max() < 1e-6
    floor = cam.depth_slice(points, -1e-6, 1e-6)
    assert len(floor) > 100
    assert np.abs(to_world(pose, floor)).max() <= 2.0 + 1e-9


def test_sky_is_nan_and_faults_have_the_stated_size() -> None:
    depth = cam.DepthCamera(wall=0.5, dropout=0.1)
    image = cam.depth_ideal(BOX, [0.0, 0.0, 0.0], depth)
    assert np.isnan(image[0]).all()
    flat = np.full((60, 80), 3.0)
    noisy = cam.depth_faults(flat, depth, np.random.default_rng(0))
    assert np.isnan(noisy).mean() == pytest.approx(0.1, abs=0.02)
    assert np.nanstd(noisy) == pytest.approx(0.0028 * 9.0, rel=0.05)
    with pytest.raises(ValueError, match="depth image"):
        cam.depth_points(np.zeros((3, 4)), depth.camera)


def outputs(model: object) -> str:
    """What a sensor of each kind reports, so that a field without effect is found."""
    rng = np.random.default_rng(0)
    if isinstance(model, s.Encoders):
        return str(s.encoder_counts([[0.9, 0.4]], TURTLEBOT2, model, rng).tolist())
    if isinstance(model, s.Laser):
        poses = ([0.0, 0.0, 0.0], [1.935, 0.0, 0.0], [0.0, 0.0, 0.4])
        return str([s.laser_scan(BOX, p, model, rng).ranges.tolist() for p in poses])
    if isinstance(model, s.Sonar):
        scenes = [(Slanted(a), [x, 0.0, 0.0]) for a in (0.0, 0.1, 0.5, 0.74) for x in (-9.0, 0.0, 1.9)]
        return str([s.sonar_reading(scene, p, model, rng) for scene, p in scenes])
    if isinstance(model, cam.Stereo):
        return str(cam.stereo_reading([1.0, 2.0], model, rng).tolist())
    images = [cam.depth_ideal(BOX, [x, 0.0, 0.3], model) for x in (-1.0, 0.5, 1.45)]
    return str([cam.depth_faults(image, model, rng).tolist() for image in images])


@pytest.mark.parametrize(
    "model",
    [
        s.Encoders(slip_noise=0.01, slip=0.1, right_radius_error=0.01, left_radius_error=0.02, track_error=0.03),
        s.Laser(beams=90, range_max=2.2, dropout=0.2, range_min=0.06),
        s.Sonar(),
        cam.Stereo(),
        cam.DepthCamera(dropout=0.2, range_max=2.5),
    ],
    ids=lambda m: type(m).__name__,
)
def test_every_field_of_a_sensor_has_an_effect(model: object) -> None:
    for field in fields(model):
        value = getattr(model, field.name)
        if isinstance(value, cam.Camera):
            changed = replace(value, fx=value.fx * 1.3)
        else:
            changed = int(value * 1.5) if isinstance(value, int) else value * 1.3
        assert outputs(replace(model, **{field.name: changed})) != outputs(model), field.name


def test_lengths_of_a_square_run_seen_by_a_longer_track() -> None:
    """A robot that overrates nothing closes a square; one whose true track is longer turns too far in its belief."""
    square = np.array([[1.0, 0.0], [0.0, np.pi / 2]] * 4)
    assert np.allclose(s.dead_reckon([0, 0, 0], square)[-1, :2], 0.0, atol=1e-12)
    encoders = s.Encoders(track_error=0.05, ticks_per_turn=10**6)
    told = s.odometry(s.encoder_counts(square, TURTLEBOT2, encoders), TURTLEBOT2, 10**6)
    path = s.dead_reckon([0, 0, 0], told)
    assert length(path) == pytest.approx(4.0, abs=1e-4)
    assert to_body([0, 0, 0], path[-1:, :2])[0] != pytest.approx([0.0, 0.0], abs=0.1)


@pytest.mark.parametrize("counts", [[[0, 0, 0], [1, 1, 1]], [0, 1], [[0.0, np.nan], [1.0, 1.0]]])
def test_counts_that_are_none_are_refused(counts: list) -> None:
    with pytest.raises(ValueError, match="counts must be finite rows"):
        s.odometry(counts, TURTLEBOT2, 100)


def test_a_counter_that_runs_over_goes_on() -> None:
    for kind in (np.uint8, np.uint16, np.uint32):
        ticks = np.array([[250, 4], [252, 2], [260, -3], [259, -1]])
        wrapped = (ticks % 2 ** (8 * np.dtype(kind).itemsize)).astype(kind)
        np.testing.assert_array_equal(s.odometry(wrapped, TURTLEBOT2, 100), s.odometry(ticks, TURTLEBOT2, 100))


def test_a_wheel_without_ticks_is_refused() -> None:
    with pytest.raises(ValueError, match="ticks_per_turn"):
        s.wheel_angle(3, 0)
