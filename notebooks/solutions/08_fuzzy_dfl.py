# Solutions of chapter 08: each block replaces the cell of its exercise.

# %% 08.1
reach = (0.5 / 3, 1 - 0.5 / 3)

# %% 08.2
def balance(pull, push):
    """F at which tracking (yaw rate pull < 0) and avoidance (push > 0) cancel [rad/s]."""
    return -pull / (push - pull)

# %% 08.3
def gate(avoiding, forecast, enter, leave):
    """Whether to avoid now, from what was done before and the forecast clearance of tracking [m]."""
    return forecast < enter or (avoiding and forecast <= leave)

# %% 08.4
def wait(k, place, curve, most):
    """Next index of the reference `(n, 2)`: the nearest to the robot at `place` among k to k + most."""
    part = curve[k : k + most + 1]
    return k + int(np.argmin(np.hypot(part[:, 0] - place[0], part[:, 1] - place[1])))

# %% 08.5
def safe_speed(free, f, cruise, creep, brake):
    """Speed [m/s] of the detour with `free` metres before the margin and weight f."""
    return min((1 - f) * cruise + f * creep, np.sqrt(2 * brake * free))
