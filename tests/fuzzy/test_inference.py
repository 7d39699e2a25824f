"""Inference: the worked example, the compiled evaluation against the readable one, other programs, and the traps."""

import math
import warnings
from dataclasses import replace

import fuzzylite as fl
import numpy as np
import pytest
import skfuzzy
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from fuzzynav import published
from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Term, Variable, defuzzify, readable, sets
from fuzzynav.fuzzy.operators import CONORMS, HEDGES, NORMS

X = np.linspace(0.0, 1.0, 101)
PLANNER = FuzzySystem.load("data/fuzzy/fuzzy_planner_table_i.fll")
TABLE = FuzzySystem.load("data/fuzzy/thesis_table_3_2.fll")


def tri(name, *parameters):
    return Term(name=name, shape="triangle", parameters=parameters)


TERMS = (tri("Low", 0, 0, 0.5), tri("Mid", 0, 0.5, 1), tri("High", 0.5, 1, 1))


def variable(name, **fields):
    return Variable(**({"name": name, "low": 0, "high": 1, "terms": TERMS} | fields))


def system(*rules, output=None, **block):
    outputs = (output or variable("y"),)
    return FuzzySystem(name="small", inputs=(variable("a"), variable("b")), outputs=outputs,
                       blocks=(RuleBlock(rules=rules, **block),))  # fmt: skip


def with_outputs(fis, **fields):
    return replace(fis, outputs=tuple(replace(v, **fields) for v in fis.outputs))


# ---------------------------------------------------------------- known answers


def test_worked_example_of_the_fuzzy_planner() -> None:
    v, omega = PLANNER(0.8, 0.3, 0.5)
    assert round(v, 3) == published.claim("fuzzy-planner:c-ex-v").value
    assert round(omega, 1) == published.claim("fuzzy-planner:c-ex-w").value


REFERENCE = [  # trapezoid rule at 4001 samples, computed apart from this package
    (0.8, 0.3, 0.5, 0.6515, 31.362), (0, 0, 0, 0.1494, 76.551), (0.5, 0.5, 0.5, 0.8506, 45.0),
    (1, 1, 1, 0.8506, 13.449), (1, 0, 0, 0.1494, 76.551), (0.5, 1, 0.5, 0.5, 13.449), (0.5, 0, 0.5, 0.5, 45.0),
    (0, 0.5, 0.5, 0.8506, 13.449), (0.5, 0.5, 0, 0.1494, 76.551), (0.5, 0.5, 1, 0.8506, 13.449),
]  # fmt: skip


def test_reference_outputs_of_the_fuzzy_planner() -> None:
    *inputs, v, omega = np.array(REFERENCE).T
    for fis, v_tolerance, omega_tolerance in ((PLANNER, 1e-3, 0.05), (with_outputs(PLANNER, resolution=4001), 5e-5,
                                                                      5e-4)):  # fmt: skip
        ours = fis(*inputs)
        assert_allclose(ours[0], v, atol=v_tolerance)
        assert_allclose(ours[1], omega, atol=omega_tolerance)


def test_matlab_plain_sum_gives_its_own_number() -> None:
    v, omega = with_outputs(PLANNER, quadrature="sum")(0.8, 0.3, 0.5)
    assert round(v, 4) == 0.6548
    assert round(omega, 2) == 31.07


def test_takagi_sugeno_by_hand() -> None:
    """Two rules, 0.75 and 0.25 strong, with y = 2a + b and y = 4: the average is 0.75 (0.75) + 0.25 (4)."""
    plane, four = Term(name="Plane", shape="linear", parameters=(2, 1, 0)), Term(
        name="Four", shape="constant", parameters=(4,))  # fmt: skip
    out = variable("y", terms=(plane, four), low=-math.inf, high=math.inf, defuzzifier="weighted average")
    fis = system("if a is Low then y is Plane", "if a is Mid then y is Four", output=out)
    assert_allclose(fis(0.125, 0.5)[0], 0.75 * 0.75 + 0.25 * 4.0, atol=1e-12)
    assert_allclose(defuzzify.weighted_average([0.75, 0.25], [defuzzify.linear_consequent([2, 1, 0], [0.125, 0.5]), 4]),
                    fis(0.125, 0.5)[0])  # fmt: skip
    total = with_outputs(fis, defuzzifier="weighted sum")
    assert_allclose(total(0.125, 0.0)[0], 0.75 * 0.25 + 0.25 * 4.0, atol=1e-12)


def test_rules_of_a_weighted_average_count_one_by_one() -> None:
    """Eq 2.46 sums over rules: two rules with one conclusion weigh twice, unless the aggregation says otherwise."""
    terms = tuple(Term(name=n, shape="constant", parameters=(v,)) for n, v in (("Zero", 0), ("One", 1)))
    rules = ("if a is Low then y is One", "if b is Low then y is One", "if a is Mid then y is Zero")
    fis = system(*rules, output=variable("y", terms=terms, defuzzifier="weighted average"))
    assert_allclose(fis(0.25, 0.0)[0], (0.5 + 1.0) / (0.5 + 1.0 + 0.5))
    assert_allclose(with_outputs(fis, aggregation="max")(0.25, 0.0)[0], 1.0 / (1.0 + 0.5))


def test_tsukamoto_by_hand() -> None:
    ramps = (Term(name="Down", shape="ramp", parameters=(1, 0)), Term(name="Up", shape="ramp", parameters=(0, 1)))
    out = variable("y", terms=ramps, defuzzifier="weighted average")
    fis = system("if a is Low then y is Down", "if a is Mid then y is Up", output=out)
    assert_allclose(fis(0.1, 0.0)[0], 0.8 * 0.2 + 0.2 * 0.2)


# ---------------------------------------------------------------- errata T45 to T51 that have code


def test_each_conclusion_is_clipped_by_its_own_rule() -> None:
    """Eq 2.44 as printed closes its bracket early: max over i of {min(...), mu_B}, so that an idle rule contributes."""
    fis = system("if a is Low then y is Low", "if a is High then y is High")
    found = fis.evaluate(0.25, 0.0)
    mu = found.aggregated["y"].mu
    assert_allclose(mu, np.minimum(0.5, TERMS[0].membership(X)), atol=1e-12)
    as_printed = np.maximum.reduce([np.full(101, 0.5), *(TERMS[k].membership(X) for k in (0, 2))])
    assert as_printed[-1] == 1.0
    assert mu[-1] == 0.0


def test_no_rule_no_number() -> None:
    """Eq 2.41 and 2.46 divide by zero where nothing fires: the answer is nan or the stated default."""
    fis = system("if a is Low then y is Low")
    assert math.isnan(fis(0.9, 0.0)[0])
    assert with_outputs(fis, default=0.3)(0.9, 0.0) == (0.3,)
    assert math.isnan(float(defuzzify.centroid(X, np.zeros(101))))
    assert math.isnan(float(defuzzify.weighted_average([0.0, 0.0], [1.0, 2.0])))
    for name in ("bisector", "mean of maximum", "smallest of maximum", "largest of maximum"):
        assert math.isnan(with_outputs(fis, defuzzifier=name)(0.9, 0.0)[0])


def test_mean_of_maximum_needs_finitely_many_points() -> None:
    """Eq 2.43 divides by a number of elements: it is the mean over the samples, and tends to the plateau's middle."""
    for n in (11, 101, 1001):
        x = np.linspace(0.0, 1.0, n)
        mu = np.minimum(0.4, tri("T", 0.0, 0.5, 1.0).membership(x))
        assert_allclose(defuzzify.mean_of_maximum(x, mu), 0.5, atol=1e-12)
        assert defuzzify.maximisers(mu).sum() == np.sum((x > 0.2 - 1e-9) & (x < 0.8 + 1e-9))


# ---------------------------------------------------------------- traps


def test_a_gap_never_answers_with_the_previous_point() -> None:
    fis = system("if a is Low then y is Low", "if a is High and b is Low then y is High")
    answers = [fis(*point)[0] for point in ((0.1, 0.0), (1.0, 1.0), (0.9, 0.0), (1.0, 1.0))]
    assert math.isnan(answers[1])
    assert math.isnan(answers[3])
    assert answers[0] < 0.3
    assert answers[2] > 0.7
    batch = fis([0.1, 1.0, 0.9, 1.0], [0.0, 1.0, 0.0, 1.0])[0]
    assert_allclose(batch, answers, rtol=1e-12)


def test_the_previous_answer_comes_only_by_the_hand_of_the_caller() -> None:
    fis = with_outputs(system("if a is Low then y is Low"), lock_previous=True, default=0.9)
    assert fis(1.0, 0.0) == (0.9,)
    assert fis(1.0, 0.0, previous=[0.4]) == (0.4,)
    assert fis(0.1, 0.0, previous=[0.4]) == fis(0.1, 0.0)
    assert_allclose(fis([0.1, 1.0], 0.0, previous=[[0.3, 0.4]])[0][1], 0.4)
    with pytest.raises(ValueError, match="one value for each of 1 outputs"):
        fis(1.0, 0.0, previous=[0.4, 0.5])


@settings(deadline=None, max_examples=30)
@given(st.randoms(use_true_random=False), st.floats(0, 1), st.floats(0, 1))
def test_order_of_rules_is_irrelevant_and_equal_conclusions_take_the_maximum(random, a, b) -> None:
    rules = [f"if a is {p} and b is {q} then y is {r}" for p, q, r in
             (("Low", "Low", "Low"), ("Low", "Mid", "High"), ("Mid", "Low", "High"), ("Mid", "Mid", "Mid"),
              ("High", "High", "Low"))]  # fmt: skip
    shuffled = random.sample(rules, len(rules))
    one, other = system(*rules), system(*shuffled)
    assert_allclose(one(a, b), other(a, b), rtol=1e-12)
    found = one.evaluate(a, b)
    assert_allclose(found.conclusions("y")["High"], max(found.firing[1], found.firing[2]))


@pytest.mark.parametrize(("quadrature", "order"), [("trapezoid", 2), ("midpoint", 2), ("sum", 1)])
def test_centroid_error_falls_with_the_resolution_as_documented(quadrature, order) -> None:
    """Against the exact centroid: second order for the trapezoid and midpoint rules, first order for the plain sum."""
    fis = system("if a is Low then y is Low", "if a is Mid then y is High")
    exact = with_outputs(fis, quadrature="exact")(0.2, 0.0)[0]
    errors = [abs(with_outputs(fis, quadrature=quadrature, resolution=n)(0.2, 0.0)[0] - exact) for n in (51, 501, 5001)]
    assert errors[2] < errors[0] / 10.0 ** (2 * order) * 3.0
    assert errors[2] < {1: 1e-4, 2: 1e-7}[order]


def test_exact_centroid_by_hand() -> None:
    """Triangle (0, 0, 1) clipped at 0.5: a square of width 0.5 and half a triangle."""
    out = variable("y", terms=(tri("T", 0, 0, 1),), quadrature="exact")
    fis = system("if a is Low then y is T", output=out)
    by_hand = (0.25 * 0.25 + 0.125 * (0.5 + 0.5 / 3.0)) / (0.25 + 0.125)
    assert_allclose(fis(0.25, 0.0)[0], by_hand, rtol=1e-14)


@pytest.mark.parametrize(("quadrature", "ends"), [("trapezoid", 0.5), ("sum", 1.0)])
def test_one_point_and_many_weigh_the_samples_alike(quadrature, ends) -> None:
    """The set is full at the lower end, whose sample counts half by the trapezoid rule."""
    fis = system(
        "if a is Low then y is T", output=variable("y", terms=(tri("T", 0, 0, 1),), quadrature=quadrature, resolution=6)
    )
    x, weights = np.linspace(0.0, 1.0, 6), np.array([ends, 1.0, 1.0, 1.0, 1.0, ends])
    mu = weights * np.minimum(0.5, 1.0 - x)
    for answer in (fis(0.25, 0.0)[0], *fis(np.full(9, 0.25), np.zeros(9))[0]):
        assert_allclose(answer, (x * mu).sum() / mu.sum(), rtol=1e-12)


polygons = st.lists(st.lists(st.floats(0, 1), min_size=4, max_size=4).map(sorted), min_size=1, max_size=4)


@settings(deadline=None, max_examples=60)
@given(polygons, st.lists(st.floats(0.05, 1.0), min_size=4, max_size=4), st.sampled_from(["min", "product"]),
       st.sampled_from(["max", "sum"]))  # fmt: skip
def test_exact_centroid_is_the_limit_of_fine_sampling(corners, strengths, implication, aggregation) -> None:
    terms = tuple(Term(name=f"T{k}", shape="trapezoid", parameters=tuple(c)) for k, c in enumerate(corners))
    rules = [Rule.parse(f"if a is any then y is T{k} with {strengths[k]}") for k in range(len(terms))]
    fine = np.linspace(0.0, 1.0, 200_001)
    if any(c[3] - c[0] < 0.05 for c in corners):
        return
    out = variable("y", terms=terms, quadrature="exact", aggregation=aggregation)
    fis = system(*rules, output=out, implication=implication)
    mu = np.zeros(fine.size)
    for term, w in zip(terms, strengths, strict=False):
        clipped = np.minimum(w, term.membership(fine)) if implication == "min" else w * term.membership(fine)
        mu = np.maximum(mu, clipped) if aggregation == "max" else mu + clipped
    assert_allclose(fis(0.0, 0.0)[0], float(defuzzify.centroid(fine, mu)), atol=2e-5)


def test_the_symmetric_controller_mirrors() -> None:
    fis = system("if a is Low then y is Low", "if a is Mid then y is Mid", "if a is High then y is High")
    a = np.linspace(0.0, 1.0, 33)
    assert_allclose(fis(a, 0.0)[0], 1.0 - fis(1.0 - a, 0.0)[0], atol=1e-12)


# ---------------------------------------------------------------- nan, ranges, shapes


def test_nan_in_nan_out() -> None:
    for fis in (PLANNER, with_outputs(PLANNER, default=0.5)):
        assert all(math.isnan(v) for v in fis(math.nan, 0.3, 0.5))
    values = TABLE([20.0, math.nan, 20.0], 3.5, 0.4)
    assert np.isnan(values[0][1])
    assert np.isfinite(values[0][[0, 2]]).all()
    found = TABLE.evaluate(math.nan, 3.5, 0.4)
    assert np.isnan(found.firing).all()
    assert np.isnan(found.memberships["headGoal"]).all()
    assert np.isfinite(found.memberships["distObs"]).all()


def test_out_of_range_inputs_are_clipped_only_when_asked() -> None:
    outside = system("if a is Low then y is Low", "if a is High then y is High")
    assert math.isnan(outside(1.2, 0.0)[0])
    locked = replace(outside, inputs=tuple(replace(v, lock_range=True) for v in outside.inputs))
    assert locked(1.2, 0.0) == outside(1.0, 0.0)
    assert locked(-7.0, 0.0) == outside(0.0, 0.0)
    assert math.isnan(locked(math.nan, 0.0)[0])


def test_locked_output_stays_in_its_range() -> None:
    terms = (Term(name="Big", shape="constant", parameters=(7.0,)),)
    out = variable("y", terms=terms, defuzzifier="weighted average", lock_range=True)
    assert system("if a is any then y is Big", output=out)(0.0, 0.0) == (1.0,)


def test_shapes_of_the_answers() -> None:
    v, omega = PLANNER(0.8, 0.3, 0.5)
    assert isinstance(v, float)
    assert isinstance(omega, float)
    v, _ = PLANNER(np.linspace(0, 1, 7)[:, None], np.linspace(0, 1, 5), 0.5)
    assert v.shape == (7, 5)
    assert_allclose(v[2, 3], PLANNER(np.linspace(0, 1, 7)[2], np.linspace(0, 1, 5)[3], 0.5)[0], rtol=1e-12)
    assert PLANNER(np.zeros((0, 3)), 0.5, 0.5)[0].shape == (0, 3)
    with pytest.raises(ValueError, match="broadcast"):
        PLANNER(np.zeros(3), np.zeros(4), 0.5)


@settings(deadline=None, max_examples=40)
@given(st.integers(1, 200), st.integers(0, 10))
def test_a_batch_equals_its_points(n, seed) -> None:
    points = np.random.default_rng(seed).random((n, 3))
    batch = np.stack(PLANNER(*points.T), axis=-1)
    k = seed % n
    assert_allclose(batch[k], PLANNER(*points[k]), rtol=1e-12)


# ---------------------------------------------------------------- compiled against readable

words = st.lists(st.sampled_from(sorted(HEDGES)), max_size=2).map(lambda h: " ".join(h))
claims = st.builds(
    lambda v, h, t: f"{v} is {h} {t}", st.sampled_from("ab"), words, st.sampled_from(["Low", "Mid", "High"])
)
texts = st.recursive(claims, lambda s: st.builds("({} and {})".format, s, s) | st.builds("({} or {})".format, s, s),
                     max_leaves=5)  # fmt: skip
rules = st.builds(
    "if {} then y is {} {} with {}".format, texts, words, st.sampled_from(["Low", "Mid", "High"]),
    st.sampled_from([1.0, 0.5, 0.25]),
)  # fmt: skip
# drastic and nilpotent operators jump: there two right programs may differ by the rounding of a degree near 1
CONTINUOUS = [
    [name for name in sorted(table) if not name.startswith(("drastic", "nilpotent"))] for table in (NORMS, CONORMS)
]
systems = st.builds(
    lambda r, c, d, i, agg, out, q, n: system(
        *r, conjunction=c, disjunction=d, implication=i,
        output=variable("y", aggregation=agg, defuzzifier=out, quadrature=q, resolution=n)),
    st.lists(rules, min_size=1, max_size=6), st.sampled_from(CONTINUOUS[0]),
    # a plain sum as OR leaves [0, 1], where the norms are not defined
    st.sampled_from([name for name in CONTINUOUS[1] if name != "sum"]),
    st.sampled_from(CONTINUOUS[0]), st.sampled_from(CONTINUOUS[1]),
    st.sampled_from(["centroid", "bisector", "smallest of maximum", "largest of maximum"]),
    st.sampled_from(["trapezoid", "midpoint", "sum"]), st.sampled_from([23, 50, 101]),
)  # fmt: skip


@settings(deadline=None, max_examples=250)
@given(systems, st.integers(0, 1000))
def test_compiled_equals_readable(fis, seed) -> None:
    points = np.random.default_rng(seed).random((5, 2))
    found = fis.evaluate(*points.T)
    degrees = readable.fuzzify(fis.inputs, *points.T)
    with np.errstate(all="ignore"):
        firing = readable.fire(fis.blocks, degrees)
        mu, value = readable.output_set(fis.outputs[0], fis.blocks, np.broadcast_to(firing, (5, firing.shape[-1])))
    assert_allclose(found.firing, np.broadcast_to(firing, found.firing.shape), atol=1e-12)
    assert_allclose(found.aggregated["y"].mu, mu, atol=1e-9)
    output = fis.outputs[0]
    if output.defuzzifier == "centroid":
        assert_allclose(found.values[0], value, atol=1e-9)
    elif output.defuzzifier == "bisector" and output.quadrature == "trapezoid":
        assert_allclose(found.values[0], value, atol=1e-6)


def test_many_terms_and_partly_filled_blocks() -> None:
    """More than three overlapping sets at a sample, and numbers of points around the block of 64."""
    terms = tuple(Term(name=f"T{k}", shape="gaussian", parameters=(k / 6, 0.2)) for k in range(7))
    fis = system(*(f"if a is {t} then y is T{k}" for k, t in enumerate(["Low", "Mid", "High", "any", "any"])),
                 output=variable("y", terms=terms))  # fmt: skip
    for n in (1, 3, 4, 5, 63, 64, 65, 130):
        a = np.linspace(0, 1, n)
        firing = readable.fire(fis.blocks, readable.fuzzify(fis.inputs, a, a))
        assert_allclose(fis(a, a)[0], readable.output_set(fis.outputs[0], fis.blocks, firing)[1], atol=1e-12)


def test_the_fuzzy_planner_equals_its_readable_version() -> None:
    points = np.random.default_rng(0).random((500, 3)).T
    firing = readable.fire(PLANNER.blocks, readable.fuzzify(PLANNER.inputs, *points))
    for k, output in enumerate(PLANNER.outputs):
        assert_allclose(PLANNER(*points)[k], readable.output_set(output, PLANNER.blocks, firing)[1], atol=1e-12)


# ---------------------------------------------------------------- independent programs


@settings(deadline=None, max_examples=40)
@given(st.lists(st.integers(0, 100), min_size=21, max_size=21).filter(any))
def test_defuzzifiers_equal_scikit_fuzzy_on_the_same_samples(samples) -> None:
    mu, X = np.array(samples) / 100.0, np.linspace(0.0, 1.0, 21)
    assert_allclose(defuzzify.centroid(X, mu, "exact"), skfuzzy.defuzz(X, mu, "centroid"), atol=1e-9)
    assert_allclose(defuzzify.bisector(X, mu), skfuzzy.defuzz(X, mu, "bisector"), atol=1e-9)
    assert_allclose(defuzzify.mean_of_maximum(X, mu), skfuzzy.defuzz(X, mu, "mom"), atol=1e-9)
    assert_allclose(defuzzify.smallest_of_maximum(X, mu), skfuzzy.defuzz(X, mu, "som"), atol=1e-9)
    assert_allclose(defuzzify.largest_of_maximum(X, mu), skfuzzy.defuzz(X, mu, "lom"), atol=1e-9)


def test_firing_equals_scikit_fuzzy_memberships_and_minimum() -> None:
    found = TABLE.evaluate(50.0, 6.0, 0.3)
    degrees = {}
    for v, value in zip(TABLE.inputs, (50.0, 6.0, 0.3), strict=True):
        for t in v.terms:
            degrees[v.name, t.name] = skfuzzy.trimf(np.array([value]), t.parameters)[0]
    by_hand = [min(degrees[p.variable, p.term] for p in rule.antecedent.parts) for rule in TABLE.rules]
    assert_allclose(found.firing, by_hand, atol=1e-12)


def test_the_planner_equals_scikit_fuzzy_and_the_difference_falls() -> None:
    control = pytest.importorskip("skfuzzy.control")
    differences = []
    for n in (51, 801):
        fis = with_outputs(PLANNER, resolution=n)
        simulation = control.ControlSystemSimulation(fis.to_skfuzzy(), cache=False)
        for v, x in zip(fis.inputs, (0.8, 0.3, 0.45), strict=True):
            simulation.input[v.name] = x
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            simulation.compute()
        theirs = [float(simulation.output[v.name]) for v in fis.outputs]
        differences.append(np.abs(np.subtract(fis(0.8, 0.3, 0.45), theirs) / [1.0, 90.0]).max())
    assert differences[0] < 1e-3
    assert differences[1] < differences[0] / 3.0


def test_the_planner_equals_fuzzylite_with_its_quadrature() -> None:
    engine = fl.FllImporter().from_file("data/fuzzy/fuzzy_planner_table_i.fll")
    fis = with_outputs(PLANNER, quadrature="midpoint", resolution=100)
    for output in engine.output_variables:
        output.defuzzifier.resolution = 100
    points = np.random.default_rng(1).random((50, 3))
    for v, x in zip(engine.input_variables, points.T, strict=True):
        v.value = x
    engine.process()
    for k, output in enumerate(engine.output_variables):
        assert_allclose(fis(*points.T)[k], output.value, atol=1e-12)


# ---------------------------------------------------------------- inference methods, uncertain readings


def test_the_three_inference_methods_by_hand() -> None:
    """Rules 0.5 * 0.8 and 0.5 * 0.2 strong on one point; sets at y = 0.25 and 0.75 are half full."""
    fis = system("if a is Low and b is Low then y is Low", "if a is Mid and b is Mid then y is Mid")
    y = int(np.argmin(np.abs(X - 0.25)))  # Low and Mid are 0.5 here
    expected = {"max-min": max(0.5, 0.2), "max-product": max(0.5 * 0.4, 0.5 * 0.1), "sum-product": 0.5 * (0.4 + 0.1)}
    for method, mu in expected.items():
        found = fis.with_inference(method).evaluate(0.25, 0.1)
        assert_allclose(found.aggregated["y"].mu[y], mu, atol=1e-12)


def test_a_narrow_reading_is_a_crisp_one_and_a_wide_one_fires_more() -> None:
    fis = system("if a is Low then y is Low", "if a is High then y is High")
    narrow, wide = (Term(name="about", shape="gaussian", parameters=(0.3, s)) for s in (1e-4, 0.2))
    assert_allclose(fis(narrow, 0.0)[0], fis(0.3, 0.0)[0], atol=2e-3)
    crisp, found = fis.evaluate(0.3, 0.0), fis.evaluate(wide, 0.0)
    assert (found.firing >= crisp.firing).all()
    assert found.firing[1] > 0.1
    assert crisp.firing[1] == 0.0
    assert "a = the set about is" in found.explain()


def test_sup_min_and_sup_product_by_hand() -> None:
    """Reading: triangle 0.2, 0.4, 0.6. Term Low: 1 - 2x. Sup-min where 1 - 2x = 5x - 1."""
    fis = system("if a is Low then y is Low")
    reading = tri("about", 0.2, 0.4, 0.6)
    assert_allclose(fis.evaluate(reading, 0.0).firing[0], 1.0 - 2.0 * 2.0 / 7.0, atol=2e-3)
    x = 0.35
    product = (1.0 - 2.0 * x) * (5.0 * x - 1.0)
    assert_allclose(fis.evaluate(reading, 0.0, match_norm="product").firing[0], product, atol=2e-3)
    fine = np.linspace(0, 1, 100_001)
    low, about = TERMS[0].membership(fine), reading.membership(fine)
    assert_allclose(sets.match(low, about), 3.0 / 7.0, atol=1e-4)
