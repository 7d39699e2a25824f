# Solutions of chapter 05, second part: each block replaces the cell of its exercise.

# %% 05.5
def turning_points(count, free):
    """Numbers of the nodes to keep; free(a, b) says whether the straight leg from node a to node b is free."""
    kept = [0]
    for k in range(2, count):
        if not free(kept[-1], k):
            kept.append(k - 1)
    return kept + [count - 1]

# %% 05.6
def with_ends(points):
    """Control points for a uniform cubic B-spline that starts and ends with the given points."""
    first, last = 2 * points[0] - points[1], 2 * points[-1] - points[-2]
    return np.vstack([first, points, last])

# %% 05.7
def second_derivative(eta_1, eta_3, theta, kappa):
    """p''(0) of an eta-cubed curve."""
    tangent, normal = np.array([np.cos(theta), np.sin(theta)]), np.array([-np.sin(theta), np.cos(theta)])
    return eta_3 * tangent + eta_1**2 * kappa * normal

# %% 05.8
my_eta = [2.0, 2.0, 20.0, -20.0]
