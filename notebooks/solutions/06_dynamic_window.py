# Solutions of chapter 06: each block replaces the cell of its exercise.

# %% 06.1
def way_to_stop(v, a, dt):
    """Way [m] until the robot stands: v for one step, then a dt less in every further step."""
    way = 0.0
    while v > 1e-12:
        way += v * dt
        v -= a * dt
    return way

# %% 06.2
def window_speeds(low, high, step):
    """Speeds from low to high, both ends and zero among them, at most `step` apart."""
    count = max(int(np.ceil((high - low) / step)), 1)
    speeds = np.linspace(low, high, count + 1)
    return np.union1d(speeds, 0.0) if low < 0 < high else speeds

# %% 06.3
cruise_rules = [
    "if headGoal is Little and distObs is Close and velRob is Fast then alpha is Low and beta is High and gamma is Low",
    "if headGoal is Little and distObs is Medium and velRob is Fast then alpha is Medium and beta is Low and gamma is High",
    "if headGoal is Little and distObs is Far and velRob is Fast then alpha is High and beta is Low and gamma is High",
]

# %% 06.4
weights = (0.2, 0.4, 0.4)

# %% 06.5
fastest = (-0.05 + np.sqrt(0.05**2 + 4 * 2.5 * 0.8)) / (2 * 2.5)
