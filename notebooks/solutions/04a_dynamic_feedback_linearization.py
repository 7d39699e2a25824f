# Solutions of chapter 04, first part: each block replaces the cell of its exercise.

# %% 04.1
def decoupling(theta, v):
    """Matrix F with (x'', y'') = F (v', omega)."""
    return np.array([[np.cos(theta), -v * np.sin(theta)], [np.sin(theta), v * np.cos(theta)]])

# %% 04.2
def gains(damping, settling):
    """kp [1/s²] and kd [1/s] for a damping ratio and a 2 % settling time [s]."""
    w = 4 / (damping * settling)
    return w**2, 2 * damping * w

# %% 04.3
def least_speed(u, theta, omega_max):
    """Speed [m/s] below which the demand u [m/s²] asks for more than omega_max [rad/s]."""
    across = u[1] * np.cos(theta) - u[0] * np.sin(theta)
    return abs(across) / omega_max
