"""Attempts to make the fuzzy core answer wrongly: rounding, narrow sets, odd inputs, every path through the engine."""

import math
import random
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Term, Variable
from fuzzynav.fuzzy.operators import CONORMS, NORMS, conjunction, disjunction

DATA = Path(__file__).parents[2] / "data" / "fuzzy"


def set_of(name: str, *corners: float, shape: str = "triangle") -> Term:
    return Term(name=name, shape=shape, parameters=corners)


def small(**output: object) -> FuzzySystem:
    """One input on [0, 10], one output on [0, 1], two rules."""
    x = Variable(name="x", low=0, high=10, terms=(set_of("low", 0, 0, 10), set_of("high", 0, 10, 10)))
    sets = {"terms": (set_of("small", 0, 0, 0.5), set_of("big", 0.5, 1, 1)), **output}
    rules = ("if x is low then y is small", "if x is high then y is big with 0.5")
    y = Variable(name="y", low=0, high=1, **sets)  # type: ignore[arg-type]
    return FuzzySystem(name="small", inputs=(x,), outputs=(y,), blocks=(RuleBlock(rules=rules),))


def polygon(name: str, rng: random.Random) -> Term:
    a, b, c, d = sorted(rng.uniform(-0.2, 1.2) for _ in range(4))
    shape, corners = rng.choice([
        ("triangle", (a, b, c)), ("triangle", (a, a, c)), ("trapezoid", (a, b, c, d)), ("ramp", (a, d)),
        ("ramp", (d, a)), ("rectangle", (a, c)), ("discrete", (a, 0.1, b, 1.0, c, 0.3, d, 0.8)),
        ("binary", (b, rng.choice([math.inf, -math.inf]))),
    ])  # fmt: skip
    return Term(name=name, shape=shape, parameters=corners, height=rng.choice([1.0, 0.7]))


def polygonal(seed: int, **output: object) -> FuzzySystem | None:
    """A random system with an output of straight lines; None where a set misses every sample."""
    rng = random.Random(seed)
    x = Variable(name="x", low=0, high=1, terms=(set_of("a", -1, 0, 1), set_of("b", 0, 1, 2)))
    rules = ("if x is a then y is p", "if x is b then y is q with 0.7", "if x is not a then y is r with 0.9")
    block = RuleBlock(rules=rules, implication=rng.choice(["min", "product"]))
    fields = {"aggregation": rng.choice(["max", "sum"]), **output}
    try:
        y = Variable(name="y", low=0, high=1, terms=tuple(polygon(n, rng) for n in "pqr"), **fields)  # type: ignore[arg-type]
        return FuzzySystem(name="s", inputs=(x,), outputs=(y,), blocks=(block,))
    except ValueError:
        return None


@pytest.mark.parametrize("seed", range(40))
def test_the_exact_centroid_is_the_limit_of_the_sampled_one(seed: int) -> None:
    exact, dense = polygonal(seed, quadrature="exact"), polygonal(seed, quadrature="midpoint", resolution=50_001)
    if exact is None or dense is None:
        return
    x = np.random.default_rng(seed).uniform(0, 1, 5)
    assert np.allclose(exact(x)[0], dense(x)[0], atol=1e-4, equal_nan=True)


@pytest.mark.parametrize("n", [1, 2, 3, 63, 64, 65, 130])
@pytest.mark.parametrize("defuzzifier", ["centroid", "bisector", "mean of maximum"])
def test_one_by_one_in_blocks_and_with_evidence_is_the_same(n: int, defuzzifier: str) -> None:
    for seed in range(6):
        system = polygonal(seed, defuzzifier=defuzzifier)
        if system is None:
            continue
        x = np.random.default_rng(seed).uniform(0, 1, n)
        block = system(x)[0]
        assert np.array_equal(block, system.evaluate(x).values[0], equal_nan=True)
        assert np.allclose(block, [system(float(v))[0] for v in x], rtol=0, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("norm", sorted(CONORMS))
def test_disjunctions_stay_sound_in_the_last_digits(norm: str) -> None:
    top = math.inf if norm == "sum" else 1.0
    for a in (1.0, 1.0 - 1e-16, 1.0 - 2.2e-16, 1.0 - 1e-9, 0.5, 1e-300, 0.0):
        for b in (1.0, 1.0 - 1.1e-16, 1.0 - 3e-13, 1e-16, 0.0):
            value = float(disjunction(a, b, norm))
            assert max(a, b) - 1e-15 <= value <= top + 1e-15, (norm, a, b, value)
            assert abs(value - float(disjunction(b, a, norm))) < 1e-15


@pytest.mark.parametrize("norm", sorted(NORMS))
def test_conjunctions_stay_sound_in_the_last_digits(norm: str) -> None:
    for a in (1.0, 1.0 - 1e-16, 0.5, 1e-160, 1e-300, 0.0):
        for b in (1.0, 1.0 - 1.1e-16, 1e-200, 0.0):
            value = float(conjunction(a, b, norm))
            assert -1e-15 <= value <= min(a, b) + 1e-15, (norm, a, b, value)


@pytest.mark.parametrize("norm", sorted(CONORMS))
def test_the_compiled_disjunctions_are_the_readable_ones(norm: str) -> None:
    system = small(aggregation=norm, terms=(set_of("small", 0, 0, 0.9), set_of("big", 0.1, 1, 1)))
    x = np.linspace(0, 10, 101)
    inference = system.evaluate(x)
    joined = inference.aggregated["y"]
    weights = np.ones(joined.x.size)
    weights[[0, -1]] = 0.5
    area = (joined.mu * weights).sum(-1)
    assert np.allclose((joined.mu * weights * joined.x).sum(-1) / area, inference.values[0], rtol=0, atol=1e-12)


def test_a_narrow_reading_tends_to_the_crisp_one() -> None:
    system = small()
    crisp = system(3.33333)[0]
    for width in (1e-2, 1e-4, 1e-6, 1e-9):
        for shape in ("triangle", "gaussian"):
            p = (3.33333 - width, 3.33333, 3.33333 + width) if shape == "triangle" else (3.33333, width)
            found = float(system.evaluate(set_of("reading", *p, shape=shape)).values[0])
            assert abs(found - crisp) < 2 * width + 1e-9
    assert float(system.evaluate(set_of("reading", 3.33333, shape="singleton")).values[0]) == crisp


def test_a_reading_needs_an_input_with_an_end() -> None:
    system = small()
    endless = replace(system, inputs=(replace(system.inputs[0], high=math.inf),))
    assert endless(4.0) == system(4.0)
    with pytest.raises(ValueError, match="finite range"):
        endless.evaluate(set_of("reading", 1, 2, 3))


def test_a_rule_that_does_not_fire_concludes_nothing() -> None:
    system = small()
    rules = ("if x is low then y is not small", "if x is high then y is big")
    both, second = (replace(system, blocks=(RuleBlock(rules=r),)) for r in (rules, rules[1:]))
    assert both(10.0) == second(10.0)  # 'low' is 0 there
    assert both(9.0) != second(9.0)


@pytest.mark.parametrize(
    ("value", "words"),
    [
        (1j, "input 'x' must be a number"),
        ("far", "input 'x' must be a number or an array of numbers, got 'far'"),
        ([[1, 2], [3]], "input 'x' must be a number"),
        ([object()], "input 'x' must be a number"),
    ],
)
def test_a_wrong_input_is_named(value: object, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        small()(value)  # type: ignore[arg-type]


def test_inputs_that_do_not_fit_together_are_named() -> None:
    system = FuzzySystem.load(DATA / "thesis_table_5_1.fll")
    with pytest.raises(ValueError, match=r"do not broadcast to one shape: distObs \(2,\), thetaObs \(3,\)"):
        system([1.0, 2.0], [1.0, 2.0, 3.0])


def test_infinite_inputs_are_far_and_nan_inputs_are_nan() -> None:
    far = FuzzySystem.load(DATA / "thesis_table_5_1.fll")
    assert far(math.inf, 0.0) == far(2.0, 0.0)  # locked to its range
    assert math.isnan(far(math.nan, 0.0)[0])
    values = far(np.array([0.3, np.nan, 0.3]), 0.0)[0]
    assert np.isnan(values).tolist() == [False, True, False]
    assert values[0] == values[2]


def test_one_previous_value_needs_no_list() -> None:
    gap = small(lock_previous=True)
    gap = replace(gap, inputs=(replace(gap.inputs[0], terms=(set_of("low", 0, 1, 2), set_of("high", 8, 9, 10))),))
    assert gap(5.0, previous=0.3) == gap(5.0, previous=(0.3,)) == (0.3,)
    assert math.isnan(gap(5.0)[0])
    with pytest.raises(ValueError, match="one value for each of 1 outputs, got 2"):
        gap(5.0, previous=(0.3, 0.4))


@pytest.mark.parametrize("field", ["low", "high", "default"])
@pytest.mark.parametrize("value", [None, "wide", [1.0]])
def test_a_field_that_is_no_number_is_named(field: str, value: object) -> None:
    fields = {"name": "y", "low": 0.0, "high": 1.0, "terms": (), field: value}
    with pytest.raises(ValueError, match=f"variable 'y': {field} must be a number"):
        Variable(**fields)


@pytest.mark.parametrize("value", [1, 0, -5, 2.5, True, "101", 10**12])
def test_a_resolution_out_of_bounds_is_refused(value: object) -> None:
    with pytest.raises(ValueError, match="whole number from 2 to"):
        small(resolution=value)


def test_brackets_without_end_are_one_clear_error() -> None:
    with pytest.raises(ValueError, match="more than 50 brackets"):
        Rule.parse("if " + "(" * 5000 + "x is low" + ")" * 5000 + " then y is big")
    inner = "if " + "(" * 40 + "x is low" + ")" * 40 + " then y is big"
    assert Rule.parse(inner) == Rule.parse("if x is low then y is big")


def test_long_rules_are_evaluated_whole() -> None:
    system = small()
    for joiner in (" and ", " or "):
        long = "if " + joiner.join(["(x is low or x is high)"] * 300) + " then y is big"
        plain = "if x is low or x is high then y is big"
        answers = [replace(system, blocks=(RuleBlock(rules=(r,)),))(3.0) for r in (long, plain)]
        assert answers[0] == answers[1]


def test_threads_do_not_disturb_each_other() -> None:
    system = FuzzySystem.load(DATA / "fuzzy_planner_table_i.fll")
    points = np.random.default_rng(3).uniform(0, 1, (8, 3, 500))
    expected = [system(*x) for x in points]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda x: system(*x), points))
    assert np.array_equal(np.array(found), np.array(expected))


def test_arguments_are_not_changed_and_layout_does_not_matter() -> None:
    system = small()
    x = np.arange(12.0).reshape(3, 4) % 10
    before = x.copy()
    straight, turned = system(x)[0], system(np.asfortranarray(x).T)[0]
    assert np.array_equal(straight, turned.T)
    assert np.array_equal(x, before)
    assert np.array_equal(system(x[::2, ::-1])[0], straight[::2, ::-1])
    assert system(np.empty((0, 3)))[0].shape == (0, 3)
