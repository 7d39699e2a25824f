"""Pinhole, stereo and depth cameras: projection, depth, and the points that a depth image stands for.

The optical frame has z along the axis, x to the right and y down; pixels are (u, v) with u to the right, v down.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from fuzzynav.geometry import Array
from fuzzynav.sensors.scene import cast_scene

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap
    from fuzzynav.world import World

__all__ = [
    "KINECT",
    "Camera",
    "DepthCamera",
    "Stereo",
    "body_from_optical",
    "depth_faults",
    "depth_ideal",
    "depth_points",
    "depth_slice",
    "disparity",
    "extrinsics",
    "intrinsics",
    "noisy_pixels",
    "project",
    "project_world",
    "stereo_depth",
    "stereo_reading",
    "stereo_sigma",
]


def _positive(model: Any, names: tuple[str, ...]) -> None:
    """Refuse a named field that is not finite and positive, and any other number that is negative or not finite."""
    for field in fields(model):
        value = getattr(model, field.name)
        if not isinstance(value, (int, float, np.number)):
            continue
        if not (np.isfinite(value) and (value > 0 if field.name in names else value >= 0)):
            wish = "positive" if field.name in names else "not negative"
            raise ValueError(f"{type(model).__name__}.{field.name} must be finite and {wish}, got {value}")


@dataclass(frozen=True, slots=True, kw_only=True)
class Camera:
    """Intrinsic parameters of a pinhole camera, all in pixels; no lens distortion.

    Raises ValueError if a focal length or a size is not positive.
    """

    fx: float
    fy: float
    cx: float
    cy: float
    width: int
    height: int

    def __post_init__(self) -> None:
        _positive(self, ("fx", "fy", "width", "height"))


KINECT = Camera(fx=525.0, fy=525.0, cx=319.5, cy=239.5, width=640, height=480)  # nominal values of its ROS driver


def project(points: ArrayLike, camera: Camera) -> Array:
    """Pixels (u, v) `(..., 2)` of points `(..., 3)` [m] in the optical frame; nan for points not in front.

    Pixels outside the picture are returned as they come. Source: thesis eq 1.6.

    >>> project([0.1, -0.2, 2.0], KINECT).tolist()                 # 525 * 0.1 / 2 + 319.5, 525 * -0.2 / 2 + 239.5
    [345.75, 187.0]
    """
    p = np.asarray(points, dtype=float)
    depth = np.where(p[..., 2] > 0.0, p[..., 2], np.nan)
    u, v = camera.fx * p[..., 0] / depth + camera.cx, camera.fy * p[..., 1] / depth + camera.cy
    return np.stack([u, v], axis=-1)


def intrinsics(camera: Camera) -> Array:
    """The matrix K `(3, 3)` of a camera.

    Source: thesis eq 1.7.
    """
    return np.array([[camera.fx, 0.0, camera.cx], [0.0, camera.fy, camera.cy], [0.0, 0.0, 1.0]])


def project_world(
    points: ArrayLike, rotation: ArrayLike, translation: ArrayLike, camera: Camera
) -> tuple[Array, Array]:
    """Pixels `(n, 2)` and depths `(n,)` [m] of world points `(n, 3)`, given [R t] from the world to the camera.

    The depth is the scale s of the equation; pixels of points not in front are nan. Source: thesis eq 1.8.
    """
    p = np.asarray(points, dtype=float).reshape(-1, 3)
    extrinsic = np.column_stack([np.asarray(rotation, dtype=float), np.asarray(translation, dtype=float)])
    scaled = np.column_stack([p, np.ones(len(p))]) @ (intrinsics(camera) @ extrinsic).T
    s = scaled[:, 2]
    return scaled[:, :2] / np.where(s > 0.0, s, np.nan)[:, None], s


def extrinsics(pose: ArrayLike, height: float) -> tuple[Array, Array]:
    """R `(3, 3)` and t `(3,)` [m] from the world to a camera that looks ahead from `height` [m] above `pose`."""
    x, y, theta = np.asarray(pose, dtype=float)
    c, s = np.cos(theta), np.sin(theta)
    rotation = np.array([[s, -c, 0.0], [0.0, 0.0, -1.0], [c, s, 0.0]])
    return rotation, -rotation @ np.array([x, y, height])


def noisy_pixels(pixels: ArrayLike, camera: Camera, sigma: float, rng: Generator) -> Array:
    """Whole pixels `(..., 2)` with Gaussian noise of sigma [px]; nan where the point leaves the picture."""
    if not (np.isfinite(sigma) and sigma >= 0):
        raise ValueError(f"sigma must be finite and not negative, got {sigma}")
    p = np.asarray(pixels, dtype=float)
    seen = np.round(p + sigma * rng.standard_normal(p.shape))
    inside = np.all((seen >= 0) & (seen <= [camera.width - 1, camera.height - 1]), axis=-1)
    return np.where(inside[..., None], seen, np.nan)


# --- stereo ------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class Stereo:
    """Two equal, rectified cameras side by side; `disparity_sigma` [px] is the error of a matched disparity.

    Raises ValueError if the focal length or the baseline is not positive.
    """

    focal: float = 525.0  # [px]
    baseline: float = 0.12  # [m]
    disparity_sigma: float = 0.3  # [px]

    def __post_init__(self) -> None:
        _positive(self, ("focal", "baseline"))


def disparity(depth: ArrayLike, stereo: Stereo) -> Array:
    """Disparity [px] of a point at depth [m]; the inverse of `stereo_depth`."""
    return stereo.focal * stereo.baseline / np.asarray(depth, dtype=float)


def stereo_depth(pixels: ArrayLike, stereo: Stereo) -> Array:
    """Depth [m] of disparities [px]; nan where the disparity is not positive, for then the point has no depth.

    Source: thesis eq 1.9.

    >>> float(stereo_depth(21.0, Stereo(focal=525.0, baseline=0.12)))
    3.0
    """
    d = np.asarray(pixels, dtype=float)
    return stereo.focal * stereo.baseline / np.where(d > 0.0, d, np.nan)


def stereo_sigma(depth: ArrayLike, stereo: Stereo) -> Array:
    """Standard deviation [m] of a stereo depth to first order: depth^2 times disparity_sigma / (focal baseline).

    >>> float(stereo_sigma(3.0, Stereo()).round(4))                # 9 * 0.3 / 63
    0.0429
    """
    return np.asarray(depth, dtype=float) ** 2 * stereo.disparity_sigma / (stereo.focal * stereo.baseline)


def stereo_reading(depth: ArrayLike, stereo: Stereo, rng: Generator) -> Array:
    """Depths [m] as measured: the disparity of the true depth with its error, turned back."""
    d = disparity(depth, stereo)
    return stereo_depth(d + stereo.disparity_sigma * rng.standard_normal(d.shape), stereo)


# --- depth camera ------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthCamera:
    """A depth camera that looks ahead from a robot, in a world of vertical walls on a flat floor; lengths in metres.

    The error of a depth has the standard deviation `noise` [1/m] times the depth squared; the share `dropout`
    of the pixels has none. Raises ValueError for impossible values.
    """

    camera: Camera = Camera(fx=65.625, fy=65.625, cx=39.5, cy=29.5, width=80, height=60)  # KINECT, every eighth pixel
    mount: float = 0.4
    wall: float = 0.8  # height of every wall and obstacle
    range_min: float = 0.5
    range_max: float = 4.5
    noise: float = 0.0028
    dropout: float = 0.0

    def __post_init__(self) -> None:
        _positive(self, ("mount", "wall", "range_max"))
        if not 0 <= self.dropout <= 1 or self.range_min >= self.range_max:
            raise ValueError("DepthCamera needs dropout in [0, 1] and range_min below range_max")


def depth_ideal(scene: World | GridMap, pose: ArrayLike, depth: DepthCamera, movers: ArrayLike | None = None) -> Array:
    """Depth image `(height, width)` [m] along the optical axis of walls and floor; nan out of range or into the sky.

    One ray of the plan is cast for each column; the row says whether it meets the wall, the floor before it, or
    passes above.
    """
    cam = depth.camera
    beside = (np.arange(cam.width) - cam.cx) / cam.fx
    below = ((np.arange(cam.height) - cam.cy) / cam.fy)[:, None]
    angles, reach = np.arctan(-beside), depth.range_max * float(np.hypot(1.0, np.abs(beside).max()))
    ranges = cast_scene(scene, pose, angles, reach, movers)
    wall = np.where(ranges >= reach, 1e9, ranges) * np.cos(angles)
    floor = np.where(below > 0.0, depth.mount / np.where(below > 0.0, below, 1.0), np.inf)
    z = np.minimum(np.where(wall * below < depth.mount - depth.wall, np.inf, wall), floor)
    return np.where((z >= depth.range_min) & (z <= depth.range_max), z, np.nan)


def depth_faults(image: ArrayLike, depth: DepthCamera, rng: Generator) -> Array:
    """The depth image with noise that grows with the depth squared, and with lost pixels as nan."""
    z = np.asarray(image, dtype=float)
    noisy = z + depth.noise * z**2 * rng.standard_normal(z.shape)
    return np.where(rng.random(z.shape) < depth.dropout, np.nan, noisy)


def depth_points(image: ArrayLike, camera: Camera) -> Array:
    """Points `(rows, cols, 3)` [m] in the optical frame of a depth image `(rows, cols)` [m]; nan stays nan.

    The unnumbered back-projection of thesis section 1.5: X = (u - cx) Z / fx, Y = (v - cy) Z / fy, with Z the depth.
    Raises ValueError if the image has not the size of the camera's picture.
    """
    z = np.asarray(image, dtype=float)
    if z.shape != (camera.height, camera.width):
        raise ValueError(f"the depth image is {z.shape}, the camera's picture is {(camera.height, camera.width)}")
    z = np.where(z > 0.0, z, np.nan)
    u, v = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    return np.stack([(u - camera.cx) * z / camera.fx, (v - camera.cy) * z / camera.fy, z], axis=-1)


def body_from_optical(points: ArrayLike, mount: float) -> Array:
    """Points `(n, 3)` [m] of the optical frame in the robot's frame (x ahead, y left, z up); nan rows are left out."""
    p = np.asarray(points, dtype=float).reshape(-1, 3)
    p = p[np.isfinite(p).all(axis=1)]
    return np.stack([p[:, 2], -p[:, 0], mount - p[:, 1]], axis=-1)


def depth_slice(points_body: ArrayLike, low: float, high: float) -> Array:
    """Points `(m, 2)` [m] in plan of those points `(n, 3)` whose height lies between low and high [m].

    This turns a depth image into the obstacle points of a laser scanner without the floor.
    """
    p = np.asarray(points_body, dtype=float).reshape(-1, 3)
    return p[(p[:, 2] >= low) & (p[:, 2] <= high), :2]
