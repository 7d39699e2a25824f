# Solutions of chapter 04, second part: each block replaces the cell of its exercise.

# %% 04.4
def error(pose, wanted):
    """Ahead [m], left [m] and heading [rad], as the robot at `pose` sees the reference at `wanted`."""
    dx, dy, c, s = wanted[0] - pose[0], wanted[1] - pose[1], np.cos(pose[2]), np.sin(pose[2])
    return c * dx + s * dy, -s * dx + c * dy, float(geometry.wrap(wanted[2] - pose[2]))

# %% 04.5
k1, k2, k3 = 1.0, 25.0, 2.0
