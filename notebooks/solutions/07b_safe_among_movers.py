# Solutions of chapter 07b: each block replaces the cell of its exercise.

# %% 07b.1
def fastest(d, V, b, e, A):
    """Greatest safe speed [m/s] with a walker d [m] away; b, A [m/s^2], e [s], V [m/s]."""
    k = A / b + 1
    bend, rest = V / b + k * e, d - k * (A / 2 * e**2 + e * V)
    return b * (np.sqrt(bend**2 + 2 * rest / b) - bend) if rest > 0 else 0.0

# %% 07b.2
covered = 0.2 * 3.0

# %% 07b.3
promised = (True, False, True, False)

# %% 07b.4
walker = (3.6, 5.1, 2.9, 6.0, 0.4)

# %% 07b.5
def assigned(cost):
    """Columns, one for each row of cost (n, n), whose costs have the least sum."""
    return linear_sum_assignment(cost)[1]
