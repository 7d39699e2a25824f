"""What does the building look like? Occupancy grids, logs and pose graphs (chapter 02)."""

from fuzzynav.mapping import logs, posegraph
from fuzzynav.mapping.occupancy import (
    InverseSensor,
    OccupancyGrid,
    Sharpness,
    build,
    empty,
    log_odds,
    probability,
    update,
    voxels,
)

__all__ = [
    "InverseSensor",
    "OccupancyGrid",
    "Sharpness",
    "build",
    "empty",
    "log_odds",
    "logs",
    "posegraph",
    "probability",
    "update",
    "voxels",
]
