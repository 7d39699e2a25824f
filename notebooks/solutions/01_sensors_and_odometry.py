# Solutions of chapter 01: each block replaces the cell of its exercise.

# %% 01.1
def ticks_to_pose(pose, right, left, ticks_per_turn, wheel_radius, track):
    """Pose (x, y, theta) after `right` and `left` ticks of the wheels."""
    travel_right = wheel_radius * 2 * np.pi * right / ticks_per_turn
    travel_left = wheel_radius * 2 * np.pi * left / ticks_per_turn
    advance = (travel_right + travel_left) / 2
    turn = (travel_right - travel_left) / track
    x, y, theta = pose
    return x + advance * np.cos(theta + turn / 2), y + advance * np.sin(theta + turn / 2), theta + turn

# %% 01.2
def yaw_rate(right, left, wheel_radius, track):
    """Yaw rate [rad/s] from the wheel rates [rad/s]; track is the full wheel separation."""
    return wheel_radius / track * (right - left)

# %% 01.3
def calibrate(line, distance, spin, angle, ticks_per_turn):
    """Wheel radius and track [m] from the ticks (right, left) of a straight run and of a spin in place."""
    wheel_radius = distance * ticks_per_turn / (2 * np.pi * (line[0] + line[1]) / 2)
    travel = wheel_radius * 2 * np.pi * (spin[0] - spin[1]) / 2 / ticks_per_turn
    return wheel_radius, 2 * travel / angle

# %% 01.4
ticks = int(np.ceil(2 * np.pi * robot.TURTLEBOT2.wheel_radius / (robot.TURTLEBOT2.track * np.deg2rad(0.1))))

# %% 01.5
smallest = 4.0**2 * 0.2 / (700 * 0.04)
largest = 160 * 0.6 / 700
baseline = (smallest + largest) / 2
