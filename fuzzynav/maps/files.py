"""Map files by the ending of their name: MovingAI `.map`, ROS map_server `.yaml` with its image, drawings in `.txt`.

Every reader returns rows from the lowest y upwards, whatever the order in the file. Every writer writes a temporary
file and renames it, so that a file is whole or untouched. A map of more than 25 million cells is not read.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from fuzzynav.maps.drawings import read_ascii, write_ascii
from fuzzynav.maps.mapdata import MapData, check_cells, check_place
from fuzzynav.maps.movingai import read_movingai, write_movingai
from fuzzynav.maps.rosmaps import read_ros_map, write_ros_map

__all__ = ["load", "save"]

Handler = TypeVar("Handler", bound=Callable[..., object])


def load(path: str | Path) -> MapData:
    """Read a map by the ending of its name. Raises ValueError for an unknown ending."""
    readers = {".map": read_movingai, ".yaml": read_ros_map, ".yml": read_ros_map, ".txt": read_ascii}
    return _by_ending(path, readers)(path)


def save(path: str | Path, data: MapData) -> None:
    """Write a map in the format that the ending of its name asks for.

    Raises ValueError for an unknown ending, or for a map that would not be read again.
    """
    write = _by_ending(
        path, {".map": write_movingai, ".yaml": write_ros_map, ".yml": write_ros_map, ".txt": write_ascii}
    )
    check_cells(path, *data.occupied.shape)
    check_place(str(path), data.resolution, data.origin)
    write(path, data)


def _by_ending(path: str | Path, handlers: dict[str, Handler]) -> Handler:
    ending = Path(path).suffix.lower()
    if ending not in handlers:
        hint = "; load the .yaml that names the image" if ending in (".pgm", ".png") else ""
        raise ValueError(f"{path}: a map file ends in {', '.join(handlers)}, not in {ending!r}{hint}")
    return handlers[ending]
