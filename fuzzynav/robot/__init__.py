"""The robot: presets, kinematics, dynamics, limits, and the compiled steps of its motion (chapters 01 and 04)."""

from fuzzynav.robot.dynamics import (
    accelerations,
    drive,
    motor_lag,
    state_rate,
)
from fuzzynav.robot.kinematics import (
    body_from_rims,
    body_speeds,
    constraints,
    footprint,
    motion_name,
    move,
    move_midpoint,
    pose_rate,
    rims_from_turn,
    rolls,
    spin_name_as_printed,
    turning_radius,
    wheel_speeds,
    yaw_rate_as_printed,
)
from fuzzynav.robot.limits import (
    limit,
    reachable,
    respects_limits,
)
from fuzzynav.robot.model import (
    PIONEER_3DX,
    THESIS,
    TURTLEBOT2,
    TURTLEBOT3_BURGER,
    Robot,
    limits_of,
)

__all__ = [
    "PIONEER_3DX",
    "THESIS",
    "TURTLEBOT2",
    "TURTLEBOT3_BURGER",
    "Robot",
    "accelerations",
    "body_from_rims",
    "body_speeds",
    "constraints",
    "drive",
    "footprint",
    "limit",
    "limits_of",
    "motion_name",
    "motor_lag",
    "move",
    "move_midpoint",
    "pose_rate",
    "reachable",
    "respects_limits",
    "rims_from_turn",
    "rolls",
    "spin_name_as_printed",
    "state_rate",
    "turning_radius",
    "wheel_speeds",
    "yaw_rate_as_printed",
]
