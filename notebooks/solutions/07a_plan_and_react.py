# Solutions of chapter 07a: each block replaces the cell of its exercise.

# %% 07a.1
radius = 1.0 / 0.35
nearest = radius - np.hypot(2.0, 2.0 - radius)

# %% 07a.2
def speed_for_arc(d, e, omega):
    """Speed [m/s] on the arc through a target at d [m], e [rad] aside, driven with omega [rad/s]."""
    return omega * d / (2.0 * np.sin(e))

# %% 07a.3
def next_index(index, here, points, radius):
    """Index of the sub-goal to head for; points (n, 2) [m], the last is the goal; here (2,) [m], radius [m]."""
    while index < len(points) - 1 and np.hypot(*(points[index] - here)) <= radius:
        index = index + 1
    return index

# %% 07a.4
def evidence_after(evidence, ended, crossed):
    """Evidence 0 to 9 of a cell after one more scan."""
    return min(max(evidence - crossed, 0) + 3 * ended, 9)

# %% 07a.5
block = 5.1, 6.4  # x, y of its centre [m]
