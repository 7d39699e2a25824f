# Solutions of chapter 02: each block replaces the cell of its exercise.

# %% 02.1
sideways = 10.0 * np.deg2rad(2.0)

# %% 02.2
def innovation(measured, expected):
    """Range [m] and bearing [rad] (2,): measured minus expected."""
    gap = measured - expected
    return np.array([gap[0], geometry.wrap(gap[1])])

# %% 02.3
def comb(weights, u):
    """Indices (n,) drawn by a comb of n teeth that starts at u / n; the weights have the sum 1."""
    n = len(weights)
    teeth = (np.arange(n) + u) / n
    return np.minimum(np.searchsorted(np.cumsum(weights), teeth), n - 1)

# %% 02.4
def fuse(prior, chances):
    """Chance that a cell is occupied, from its prior and the chances that independent sightings give."""
    odds = np.log(prior / (1 - prior)) + sum(np.log(p / (1 - p)) for p in chances)
    return (1 + np.tanh(odds / 2)) / 2  # 1 / (1 + exp(-odds)) without overflow

# %% 02.5
hit, miss = 0.8, 0.37
