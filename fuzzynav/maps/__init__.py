"""Grid maps: cells, distances, rays, files and kinds of places (chapters 02 and 05)."""

from fuzzynav.maps.files import (
    MapData,
    Scenario,
    format_ascii,
    load,
    parse_ascii,
    read_ascii,
    read_movingai,
    read_ros_map,
    read_scenarios,
    save,
    write_ascii,
    write_movingai,
    write_ros_map,
)
from fuzzynav.maps.gridmap import (
    CORNER_RULES,
    GridMap,
)
from fuzzynav.maps.kinds import (
    Places,
    name_places,
    outline,
    places,
)

__all__ = [
    "CORNER_RULES",
    "GridMap",
    "MapData",
    "Places",
    "Scenario",
    "format_ascii",
    "load",
    "name_places",
    "outline",
    "parse_ascii",
    "places",
    "read_ascii",
    "read_movingai",
    "read_ros_map",
    "read_scenarios",
    "save",
    "write_ascii",
    "write_movingai",
    "write_ros_map",
]
