"""Membership functions, operators and hedges: known answers, properties, and two independent programs."""

import math
from fractions import Fraction

import fuzzylite as fl
import numpy as np
import pytest
import skfuzzy
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fuzzynav.fuzzy.kernels import conorm, gaussian_row, hedged, inverse_member, member, norm
from fuzzynav.fuzzy.membership import POLYGONAL, SHAPES, Term, breakpoints, membership
from fuzzynav.fuzzy.operators import CONORMS, HEDGES, NORMS, conjunction, disjunction, hedge, negation

X = np.linspace(-3.0, 3.0, 241)
INF = math.inf

number = st.floats(-2.0, 2.0).map(lambda v: round(v, 3))
positive = st.floats(0.05, 3.0).map(lambda v: round(v, 3))
degree = st.floats(0.0, 1.0)


def ascending(n):
    return st.lists(number, min_size=n, max_size=n).map(lambda v: tuple(sorted(v)))


def apart(n):
    """Ascending numbers with gaps between them."""
    return st.tuples(number, st.lists(positive, min_size=n - 1, max_size=n - 1)).map(
        lambda t: tuple(np.round(np.cumsum([t[0], *t[1]]), 3).tolist())
    )


PARAMETERS = {
    "triangle": ascending(3), "trapezoid": ascending(4), "gaussian": st.tuples(number, positive),
    "two-sided gaussian": st.tuples(number, positive, number, positive), "bell": st.tuples(number, positive, positive),
    "sigmoid": st.tuples(number, number), "sigmoid difference": st.tuples(number, positive, positive, number),
    "sigmoid product": st.tuples(number, positive, number, number), "z": ascending(2), "s": ascending(2),
    "pi": ascending(4), "ramp": st.tuples(number, number), "rectangle": ascending(2), "singleton": st.tuples(number),
    "binary": st.tuples(number, st.sampled_from([INF, -INF])), "constant": st.tuples(number),
    "discrete": st.tuples(apart(4), st.lists(degree, min_size=4, max_size=4)).map(
        lambda t: tuple(v for pair in zip(*t, strict=True) for v in pair)),
    "spike": st.tuples(number, positive), "cosine": st.tuples(number, positive), "concave": apart(2), "arc": apart(2),
    "semi-ellipse": apart(2),
}  # fmt: skip
terms = st.sampled_from(sorted(PARAMETERS)).flatmap(
    lambda shape: st.builds(Term, name=st.just("T"), shape=st.just(shape), parameters=PARAMETERS[shape])
)


def compiled(term, x):
    table = np.array(term.parameters if term.shape == "discrete" else [0.0])
    p = np.array([*(() if term.shape == "discrete" else term.parameters), 0.0, 0.0, 0.0, 0.0][:4] + [term.height])
    code = SHAPES[term.shape].code
    return np.array([member(code, p, v, table, 0, len(table) // 2) for v in x])


def test_every_shape_has_a_strategy() -> None:
    assert set(PARAMETERS) == set(SHAPES) - {"linear"}


@settings(deadline=None, max_examples=400)
@given(terms, st.floats(0.1, 1.0))
def test_compiled_equals_readable(term, height) -> None:
    term = Term(name="T", shape=term.shape, parameters=term.parameters, height=height)
    x = np.concatenate([X, [v for v in term.parameters if math.isfinite(v)]])
    assert_allclose(compiled(term, x), term.membership(x), rtol=1e-12, atol=1e-12)


@settings(deadline=None, max_examples=200)
@given(terms)
def test_membership_lies_between_0_and_1_and_keeps_nan(term) -> None:
    mu = term.membership(np.append(X, np.nan))
    assert np.isnan(mu[-1])
    if term.shape != "constant":
        assert (mu[:-1] >= 0.0).all()
        assert (mu[:-1] <= 1.0).all()


def test_nan_is_nan_in_the_compiled_twin() -> None:
    for shape, parameters in (("triangle", (0.0, 1.0, 2.0)), ("gaussian", (0.0, 1.0))):
        assert np.isnan(compiled(Term(name="T", shape=shape, parameters=parameters), [np.nan])).all()


@settings(deadline=None)
@given(number, positive, st.floats(-60.0, 60.0))
def test_fast_exponential_equals_the_slow_one(mean, sigma, x) -> None:
    out, bits = np.empty(3), np.empty(3)
    gaussian_row(np.array([x, mean, np.nan]), np.array([mean, sigma, 0.0, 0.0, 0.7]), bits, out)
    expected = 0.7 * np.exp(-((x - mean) ** 2) / (2.0 * sigma**2))
    assert_allclose(out, [expected, 0.7, np.nan], rtol=1e-12, atol=1e-300)


SKFUZZY = {
    "triangle": lambda x, p: skfuzzy.trimf(x, p), "trapezoid": lambda x, p: skfuzzy.trapmf(x, p),
    "gaussian": lambda x, p: skfuzzy.gaussmf(x, p[0], p[1]),
    "bell": lambda x, p: skfuzzy.gbellmf(x, p[1], p[2], p[0]), "sigmoid": lambda x, p: skfuzzy.sigmf(x, p[0], p[1]),
    "sigmoid product": lambda x, p: skfuzzy.psigmf(x, p[0], p[1], p[3], p[2]),
    "s": lambda x, p: skfuzzy.smf(x, *p), "z": lambda x, p: skfuzzy.zmf(x, *p),
    "pi": lambda x, p: skfuzzy.pimf(x, *p),
}  # fmt: skip


@pytest.mark.parametrize("shape", sorted(SKFUZZY))
def test_equals_scikit_fuzzy(shape) -> None:
    @settings(deadline=None, max_examples=60)
    @given(
        apart(len(SHAPES[shape].parameters))
        if shape in ("triangle", "trapezoid", "s", "z", "pi")
        else PARAMETERS[shape]
    )
    def agrees(parameters) -> None:
        with np.errstate(over="ignore"):
            theirs = SKFUZZY[shape](X, parameters)
        assert_allclose(membership(shape, X, *parameters), theirs, rtol=1e-12, atol=1e-12)

    agrees()


def test_scikit_fuzzy_has_no_answer_where_ours_has_a_step() -> None:
    """A shoulder of s at start == end: theirs is nan, ours jumps from 0 to 1."""
    with np.errstate(all="ignore"):
        assert np.isnan(skfuzzy.smf(np.array([0.5]), 0.5, 0.5)).any() or skfuzzy.smf(np.array([0.5]), 0.5, 0.5)[0] == 1
    assert membership("s", [0.4, 0.5, 0.6], 0.5, 0.5).tolist() == [0.0, 1.0, 1.0]


FUZZYLITE = {
    "triangle": fl.Triangle, "trapezoid": fl.Trapezoid, "gaussian": fl.Gaussian,
    "two-sided gaussian": fl.GaussianProduct, "bell": fl.Bell, "sigmoid": fl.Sigmoid,
    "sigmoid difference": fl.SigmoidDifference, "sigmoid product": fl.SigmoidProduct, "z": fl.ZShape, "s": fl.SShape,
    "pi": fl.PiShape, "ramp": fl.Ramp, "rectangle": fl.Rectangle, "binary": fl.Binary, "spike": fl.Spike,
    "cosine": fl.Cosine, "concave": fl.Concave, "arc": fl.Arc, "semi-ellipse": fl.SemiEllipse,
}  # fmt: skip


@pytest.mark.parametrize("shape", sorted(FUZZYLITE))
def test_equals_fuzzylite(shape) -> None:
    """Breakpoints kept apart, and x off them: there the programs differ by convention only."""
    ordered = ("triangle", "trapezoid", "z", "s", "pi", "ramp", "rectangle")
    x = X + 0.00021

    @settings(deadline=None, max_examples=60)
    @given(apart(len(SHAPES[shape].parameters)) if shape in ordered else PARAMETERS[shape], st.floats(0.2, 1.0))
    def agrees(parameters, height) -> None:
        with np.errstate(all="ignore"):
            theirs = FUZZYLITE[shape]("T", *parameters, height).membership(x)
        ours = Term(name="T", shape=shape, parameters=parameters, height=height).membership(x)
        assert_allclose(ours, theirs, rtol=1e-12, atol=1e-12)

    agrees()


def test_falling_shapes_equal_fuzzylite() -> None:
    for shape, parameters in (("ramp", (1.0, -1.0)), ("concave", (1.0, -1.0)), ("arc", (1.0, -1.0))):
        theirs = FUZZYLITE[shape]("T", *parameters).membership(X)
        assert_allclose(membership(shape, X, *parameters), theirs, atol=1e-12)
    theirs = fl.Discrete("T", [-1, 0, 0, 1, 2, 0.5]).membership(X)
    assert_allclose(membership("discrete", X, -1, 0, 0, 1, 2, 0.5), theirs, atol=1e-12)


def test_shoulders_are_full_at_their_edge() -> None:
    """Eq 2.32 and 2.33 as printed exclude a == b: the first set of a partition would have no membership there."""
    assert membership("triangle", [0.0, 0.5, 1.0, 1.5], 0.0, 0.0, 1.0).tolist() == [1.0, 0.5, 0.0, 0.0]
    assert membership("triangle", [0.0, 0.5, 1.0], 0.0, 1.0, 1.0).tolist() == [0.0, 0.5, 1.0]
    assert membership("trapezoid", [0.0, 1.0, 1.5, 2.0], 0.0, 0.0, 1.0, 2.0).tolist() == [1.0, 1.0, 0.5, 0.0]
    assert membership("trapezoid", [-9.0, 1.5], -INF, 0.0, 1.0, 2.0).tolist() == [1.0, 0.5]


def test_singleton_is_1_not_its_place() -> None:
    """Eq 2.35 prints the height m; the text under it, and eq 2.39, say 1."""
    assert membership("singleton", [2.9, 3.0, 3.1], 3.0).tolist() == [0.0, 1.0, 0.0]


def test_membership_is_a_map_to_the_unit_interval_outside_its_support_too() -> None:
    """Eq 2.27 as printed asks first whether x is in A; the map itself answers, with 0 where it is not."""
    assert membership("triangle", [-5.0, 5.0], 0.0, 1.0, 2.0).tolist() == [0.0, 0.0]


@pytest.mark.parametrize(
    ("shape", "parameters", "says"),
    [
        ("triangle", (1.0, 0.0, 2.0), "a <= b <= c"),
        ("trapezoid", (0.0, 2.0, 1.0, 3.0), "a <= b <= c <= d"),
        ("triangle", (1.0, 2.0), "3 parameters"),
        ("gaussian", (0.0, 0.0), "sigma > 0"),
        ("gaussian", (0.0, math.nan), "sigma > 0"),
        ("triangle", (0.0, math.nan, 1.0), "finite|<="),
        ("s", (0.0, INF), "finite"),
        ("discrete", (0.0, 1.0, 2.0), "pairs"),
        ("discrete", (1.0, 1.0, 0.0, 1.0), "ascending"),
        ("hill", (0.0,), "unknown shape 'hill'"),
        ("bell", (0.0, 0.0, 1.0), "width"),
        ("linear", (), "constant"),
    ],
)
def test_bad_parameters_are_refused(shape, parameters, says) -> None:
    with pytest.raises(ValueError, match=says) as error:
        Term(name="Near", shape=shape, parameters=parameters)
    assert "Near" in str(error.value)


def test_other_bad_terms_are_refused() -> None:
    with pytest.raises(ValueError, match="one word"):
        Term(name="very low", shape="triangle", parameters=(0, 1, 2))
    with pytest.raises(ValueError, match="height"):
        Term(name="T", shape="triangle", parameters=(0, 1, 2), height=0.0)
    with pytest.raises(ValueError, match="numbers"):
        Term(name="T", shape="triangle", parameters=("a", "b", "c"))
    with pytest.raises(ValueError, match="no membership of its own"):
        Term(name="T", shape="linear", parameters=(1.0, 0.0)).membership(0.0)
    with pytest.raises(ValueError, match="unknown shape"):
        membership("hill", 0.0)


def test_breakpoints_of_polygons() -> None:
    assert breakpoints(Term(name="T", shape="trapezoid", parameters=(-INF, 0, 1, 2))) == (0.0, 1.0, 2.0)
    assert breakpoints(Term(name="T", shape="discrete", parameters=(0, 0, 2, 1))) == (0.0, 2.0)
    assert "gaussian" not in POLYGONAL
    with pytest.raises(ValueError, match="straight lines"):
        breakpoints(Term(name="T", shape="gaussian", parameters=(0, 1)))


@settings(deadline=None)
@given(st.sampled_from(["ramp", "sigmoid", "s", "z", "concave", "arc"]), st.floats(0.02, 0.98))
def test_inverse_of_a_monotone_shape(shape, strength) -> None:
    parameters = {"sigmoid": (0.3, 2.0)}.get(shape, (-1.0, 1.5))
    term = Term(name="T", shape=shape, parameters=parameters)
    x = inverse_member(SHAPES[shape].code, np.array([*parameters, 0.0, 0.0, 1.0]), strength)
    if shape != "concave" or strength > term.membership(-60.0):
        assert_allclose(term.membership(x), strength, atol=1e-9)


THEIR_NORMS = dict(zip(NORMS, (fl.Minimum, fl.AlgebraicProduct, fl.BoundedDifference, fl.DrasticProduct,
                               fl.EinsteinProduct, fl.HamacherProduct, fl.NilpotentMinimum), strict=True))  # fmt: skip
THEIR_CONORMS = dict(
    zip(
        CONORMS,
        (
            fl.Maximum,
            fl.AlgebraicSum,
            fl.BoundedSum,
            fl.UnboundedSum,
            fl.NormalizedSum,
            fl.DrasticSum,
            fl.EinsteinSum,
            fl.HamacherSum,
            fl.NilpotentMaximum,
        ),
        strict=True,
    )
)
THEIR_HEDGES = dict(zip(HEDGES, (fl.Not, fl.Very, fl.Somewhat, fl.Extremely, fl.Seldom, fl.Any), strict=True))


@settings(deadline=None, max_examples=300)
@given(degree, degree)
@example(1.0, 0.9999999999999999)
def test_operators_equal_fuzzylite_and_their_compiled_twins(a, b) -> None:
    with np.errstate(all="ignore"):
        for name, other in THEIR_NORMS.items():
            ours = float(conjunction(a, b, name))
            assert_allclose(norm(NORMS[name].code, a, b), ours, atol=1e-12)
            if not (name == "hamacher" and a == b == 0.0):
                assert_allclose(ours, other().compute(a, b), atol=1e-12)
        for name, other in THEIR_CONORMS.items():
            ours = float(disjunction(a, b, name))
            assert_allclose(conorm(CONORMS[name].code, a, b), ours, atol=1e-12)
            if name == "hamacher sum" and a * b < 1.0:  # theirs loses every digit where a and b are near 1
                p, q = Fraction(a), Fraction(b)
                assert_allclose(ours, float((p + q - 2 * p * q) / (1 - p * q)), atol=1e-12)
            elif name not in ("hamacher sum", "nilpotent maximum"):
                assert_allclose(ours, other().compute(a, b), atol=1e-12)
        for name, other in THEIR_HEDGES.items():
            assert_allclose(hedged(HEDGES[name].code, a), float(hedge(name, a)), atol=1e-12)
            assert_allclose(float(hedge(name, a)), other().hedge(a), atol=1e-12)


@settings(deadline=None)
@given(st.sampled_from(sorted(NORMS)), degree, degree, degree)
def test_norms_are_norms(name, a, b, c) -> None:
    low, high = sorted((b, c))
    assert_allclose(conjunction(a, b, name), conjunction(b, a, name), atol=1e-12)
    assert_allclose(conjunction(a, 1.0, name), a, atol=1e-12)
    assert conjunction(a, low, name) <= conjunction(a, high, name) + 1e-12


@given(degree, degree)
def test_and_or_not_are_dual(a, b) -> None:
    """De Morgan, for the triple of eq 2.36."""
    assert_allclose(negation(conjunction(a, b)), disjunction(negation(a), negation(b)), atol=1e-12)


def test_unknown_operators_are_refused() -> None:
    for function in (conjunction, disjunction):
        with pytest.raises(ValueError, match="known: "):
            function(0.5, 0.5, "minn")
    with pytest.raises(ValueError, match="known: not, very"):
        hedge("rather", 0.5)
