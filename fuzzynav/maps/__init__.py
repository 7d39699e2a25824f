"""Grid maps: cells, distances, rays, files and kinds of places (chapters 02 and 05)."""

from fuzzynav.maps.drawings import format_ascii, parse_ascii, read_ascii, write_ascii
from fuzzynav.maps.files import load, save
from fuzzynav.maps.gridmap import CORNER_RULES, GridMap
from fuzzynav.maps.kinds import Places, name_places, outline, places
from fuzzynav.maps.mapdata import MapData
from fuzzynav.maps.movingai import Scenario, read_movingai, read_scenarios, write_movingai
from fuzzynav.maps.rosmaps import read_ros_map, write_ros_map

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
