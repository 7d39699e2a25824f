"""Smooth paths: shortcuts, B-splines, eta-cubed splines and their measures (chapter 05b)."""

from fuzzynav.smoothing import eta, simplify
from fuzzynav.smoothing.eta import (
    Chain,
    Eta3,
    chain,
    coefficients,
    coefficients_as_printed,
    curvature_rate,
    eta3,
)
from fuzzynav.smoothing.measures import arc_length, is_free, least_clearance, measure, total_turning
from fuzzynav.smoothing.simplify import (
    best_shortcut,
    key_nodes,
    prune,
    remove_collinear,
    shorten,
    shorten_as_printed,
)
from fuzzynav.smoothing.splines import (
    Smooth,
    Spline,
    bspline,
    cox_de_boor,
    cubic_basis,
    free_bspline,
    segment,
    segment_as_printed,
    uniform_basis,
    uniform_basis_as_printed,
)

__all__ = [
    "Chain",
    "Eta3",
    "Smooth",
    "Spline",
    "arc_length",
    "best_shortcut",
    "bspline",
    "chain",
    "coefficients",
    "coefficients_as_printed",
    "cox_de_boor",
    "cubic_basis",
    "curvature_rate",
    "eta",
    "eta3",
    "free_bspline",
    "is_free",
    "key_nodes",
    "least_clearance",
    "measure",
    "prune",
    "remove_collinear",
    "segment",
    "segment_as_printed",
    "shorten",
    "shorten_as_printed",
    "simplify",
    "total_turning",
    "uniform_basis",
    "uniform_basis_as_printed",
]
