"""What a robot senses: encoders, sonar, laser and cameras (chapter 01)."""

from fuzzynav.sensors import cameras
from fuzzynav.sensors.encoders import (
    EXACT,
    Encoders,
    Odometry,
    dead_reckon,
    encoder_counts,
    odometry,
    wheel_angle,
    wheel_travel,
)
from fuzzynav.sensors.laser import (
    SPEED_OF_LIGHT,
    SPEED_OF_LIGHT_AS_PRINTED,
    Laser,
    Scan,
    laser_faults,
    laser_ideal,
    laser_range,
    laser_scan,
    polar_to_points,
)
from fuzzynav.sensors.scene import cast_scene
from fuzzynav.sensors.sonar import SPEED_OF_SOUND, Sonar, sonar_cone, sonar_ideal, sonar_range, sonar_reading

__all__ = [
    "EXACT",
    "SPEED_OF_LIGHT",
    "SPEED_OF_LIGHT_AS_PRINTED",
    "SPEED_OF_SOUND",
    "Encoders",
    "Laser",
    "Odometry",
    "Scan",
    "Sonar",
    "cameras",
    "cast_scene",
    "dead_reckon",
    "encoder_counts",
    "laser_faults",
    "laser_ideal",
    "laser_range",
    "laser_scan",
    "odometry",
    "polar_to_points",
    "sonar_cone",
    "sonar_ideal",
    "sonar_range",
    "sonar_reading",
    "wheel_angle",
    "wheel_travel",
]
