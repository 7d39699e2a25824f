# Solutions of chapter 07b: each block replaces the cell of its exercise.

# %% 07b.1
def separation(v, V, b, e, A):
    """Distance [m] from which a robot of speed v [m/s] is passively safe; b, A [m/s^2], e [s], V [m/s]."""
    return v**2 / (2 * b) + V * v / b + (A / b + 1) * (A / 2 * e**2 + e * (v + V))

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
