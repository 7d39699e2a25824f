"""What every range sensor does: look into a scene along some rays."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fuzzynav import checks
from fuzzynav.geometry import Array

if TYPE_CHECKING:
    from fuzzynav.maps.gridmap import GridMap
    from fuzzynav.world import World

__all__ = ["cast_scene", "check_model"]


def check_model(model: Any, *, positive: tuple[str, ...] = (), share: tuple[str, ...] = ()) -> None:
    """Refuse fields that are not finite, not `positive`, or no `share` in [0, 1]; all others must not be negative."""
    for field in fields(model):
        value = getattr(model, field.name)
        wish, good = "finite and not negative", np.isfinite(value) and value >= 0
        if field.name in positive:
            wish, good = "finite and positive", np.isfinite(value) and value > 0
        if field.name in share:
            wish, good = "a number in [0, 1]", 0 <= value <= 1
        if not good:
            raise ValueError(f"{type(model).__name__}.{field.name} must be {wish}, got {value}")


def cast_scene(
    scene: World | GridMap, pose: ArrayLike, angles: Array, range_max: float, movers: ArrayLike | None = None
) -> Array:
    """Ranges `(n,)` [m] of beams in a map, or in a whole world with its moving obstacles at `movers` `(m, 2)` [m].

    Without `movers` they stand where they start. Raises ValueError for a pose that is not finite, or for movers in
    a map, which has none.
    """
    if movers is None:
        return np.asarray(scene.cast(checks.pose(pose), angles, range_max), dtype=float)
    if not hasattr(scene, "movers"):
        raise ValueError("a map has no moving obstacles: give a World, or leave movers out")
    return np.asarray(scene.cast(checks.pose(pose), angles, range_max, movers), dtype=float)  # type: ignore[arg-type]
