# Solutions of chapter 03. Each block replaces the cell of its exercise.

# %% 03.1
# Near(0.5) = 1.5 / 2, Medium(0.5) = 0.5 / 2, Far(0.5) = 0, Small(60) = 30 / 90, Large(60) = 60 / 90
strengths = (0.75, min(0.25, 1 / 3), min(0.0, 1 / 3), 2 / 3)


# %% 03.2
def my_centroid(x, mu):
    area = np.trapezoid(mu, x)
    return np.trapezoid(x * mu, x) / area if area > 0 else np.nan


# %% 03.3
def merged(firing, conclusions):
    found = {}
    for strength, name in zip(firing, conclusions):
        found[name] = max(found.get(name, 0.0), strength)
    return found


# %% 03.4
safe_sets = replace(study.SpeedSets(), near_end=2.5, medium_left=0.8)

# %% 03.5
weights = {
    "Close": "alpha is Low and beta is High and gamma is Low",
    "Medium": "alpha is Medium and beta is Low and gamma is Medium",
    "Far": "alpha is High and beta is Low and gamma is High",
}
printed = [("Little", "Slow"), ("More", "Normal"), ("Lots", "Fast")]
more_rules = [
    f"if headGoal is {heading} and distObs is {distance} and velRob is {speed} then {then}"
    for distance, then in weights.items()
    for heading in ("Little", "More", "Lots")
    for speed in ("Slow", "Normal", "Fast")
    if (heading, speed) not in printed
]
