"""The exchange with scikit-fuzzy: same memberships, same firing, same answers in the limit."""

import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import skfuzzy
from skfuzzy import control

from fuzzynav.fuzzy import FuzzySystem, Rule, RuleBlock, Term, Variable
from fuzzynav.fuzzy.defuzzify import centroid
from fuzzynav.fuzzy.files import fll
from fuzzynav.fuzzy.files.skfuzzy import answer

DATA = Path(__file__).parents[2] / "data" / "fuzzy"
FILES = sorted(DATA.glob("*.fll"))
# scikit-fuzzy knows Mamdani systems only
FILES = [path for path in FILES if "WeightedAverage" not in path.read_text(encoding="utf-8")]


def at_resolution(system: FuzzySystem, n: int) -> FuzzySystem:
    return replace(system, outputs=tuple(replace(v, resolution=n) for v in system.outputs))


def points(system: FuzzySystem, n: int, seed: int = 1) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    return [rng.uniform(v.low, v.high, n) for v in system.inputs]


def apart(a: tuple[np.ndarray, ...], b: tuple[np.ndarray, ...], system: FuzzySystem) -> float:
    """Largest difference in parts of the range, where a rule fires."""
    spans = [v.high - v.low for v in system.outputs]
    return max(float(np.nanmax(np.abs(x - y))) / w for x, y, w in zip(a, b, spans, strict=True))


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_whole_systems_agree_and_converge(path: Path) -> None:
    coarse, fine = (at_resolution(FuzzySystem.load(path), n) for n in (101, 1001))
    x = points(fine, 25)
    near = apart(fine(*x), answer(fine.to_skfuzzy(), *x), fine)
    far = apart(coarse(*x), answer(coarse.to_skfuzzy(), *x), coarse)
    assert near < 1e-4
    assert near < far / 5


@pytest.mark.parametrize("path", FILES, ids=lambda p: p.stem)
def test_there_and_back_keeps_the_meaning(path: Path) -> None:
    system = at_resolution(FuzzySystem.load(path), 501)
    back = FuzzySystem.from_skfuzzy(system.to_skfuzzy())
    assert [v.name for v in back.inputs] == [v.name for v in system.inputs]
    assert [[t.name for t in v.terms] for v in back.outputs] == [[t.name for t in v.terms] for v in system.outputs]
    assert len(back.rules) == len(system.rules)
    x = points(system, 300)
    fires = system.evaluate(*x).firing.max(-1) > 0.01
    x = [values[fires] for values in x]
    assert apart(back(*x), system(*x), system) < 1e-3
    first, second = system.evaluate(*x), back.evaluate(*x)
    for name, degrees in first.memberships.items():
        assert np.abs(second.memberships[name] - degrees).max() < 1e-5


def test_memberships_and_firing_agree_to_the_last_digits() -> None:
    system = FuzzySystem.load(DATA / "thesis_table_5_1.fll")  # straight lines: no sampling error
    sk = system.to_skfuzzy()
    simulation = control.ControlSystemSimulation(sk)
    for x in ((0.3, -0.4), (0.8, 0.9), (1.7, 3.3)):
        for variable, value in zip(system.inputs, x, strict=True):
            simulation.input[variable.name] = value
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", DeprecationWarning)
            simulation.compute()
        firing = [float(rule.aggregate_firing[simulation]) for rule in sk.rules]
        assert np.abs(np.array(firing) - system.evaluate(*x).firing).max() < 1e-12


def test_defuzzification_agrees_on_the_same_samples() -> None:
    system = FuzzySystem.load(DATA / "fuzzy_planner_table_i.fll")
    for x in np.random.default_rng(2).uniform(0, 1, (20, 3)):
        inference = system.evaluate(*x)
        for variable, value in zip(system.outputs, inference.values, strict=True):
            samples = inference.aggregated[variable.name]
            # scikit-fuzzy integrates straight lines exactly, the trapezoid rule the products: an error of order h^2
            h = samples.x[1] - samples.x[0]
            assert abs(skfuzzy.defuzz(samples.x, samples.mu, "centroid") - value) < h**2
            exact = skfuzzy.defuzz(samples.x, samples.mu, "centroid")
            assert abs(float(centroid(samples.x, samples.mu, "exact")) - exact) < 1e-9 * variable.high


def test_no_warning_reaches_the_reader(recwarn: pytest.WarningsRecorder) -> None:
    system = FuzzySystem.load(DATA / "thesis_table_3_2.fll")
    answer(system.to_skfuzzy(), [20.0, 90.0], 3.5, 0.4)
    FuzzySystem.from_skfuzzy(system.to_skfuzzy())
    gone = ResourceWarning  # sockets of other tests, closed by the garbage collection whenever it comes
    assert [str(w.message) for w in recwarn.list if not issubclass(w.category, gone)] == []


def test_a_silent_rule_base_gives_nan_and_no_stale_answer() -> None:
    system = FuzzySystem.load(DATA / "thesis_table_3_2.fll")
    sk = system.to_skfuzzy()
    alpha, _, _ = answer(sk, [20.0, 0.0, 20.0, 0.0], 3.5, [0.3, 1.0, 0.3, 1.0])
    assert np.isnan(alpha[[1, 3]]).all()
    assert alpha[0] == alpha[2]
    assert system(0.0, 3.5, 1.0) == (0.8, 0.1, 0.1)  # ours: the stated default


def tipper() -> control.ControlSystem:
    """The tipping problem as the scikit-fuzzy documentation builds it."""
    quality = control.Antecedent(np.arange(0, 11, 1), "quality")
    service = control.Antecedent(np.arange(0, 11, 1), "service")
    tip = control.Consequent(np.arange(0, 26, 1), "tip")
    quality.automf(3)
    service.automf(3)
    tip["low"] = skfuzzy.trimf(tip.universe, [0, 0, 13])
    tip["medium"] = skfuzzy.trimf(tip.universe, [0, 13, 25])
    tip["high"] = skfuzzy.trimf(tip.universe, [13, 25, 25])
    rules = [
        control.Rule(quality["poor"] | service["poor"], tip["low"]),
        control.Rule(service["average"] & ~quality["poor"], tip["medium"] % 0.5),
        control.Rule(service["good"] | quality["good"], tip["high"]),
    ]
    return control.ControlSystem(rules)


def test_a_system_written_with_scikit_fuzzy_comes_over() -> None:
    sk = tipper()
    system = FuzzySystem.from_skfuzzy(sk, name="tipper")
    assert system.rules[1] == Rule.parse("if service is average and quality is not poor then tip is medium with 0.5")
    by_name = {v.name: x for v, x in zip(system.inputs, points(system, 40), strict=True)}
    theirs = answer(sk, *(by_name[v.label] for v in sk.antecedents))
    ours = system(*(by_name[v.name] for v in system.inputs))
    assert apart(ours, theirs, system) < 5e-3  # 26 samples
    low = next(t for t in system.outputs[0].terms if t.name == "low")
    assert low.parameters == (0.0, 1.0, 13.0, 0.0, 25.0, 0.0)  # straight runs of samples are one line
    outside = {name: np.array([-5.0, 50.0]) for name in by_name}
    assert np.allclose(system(*outside.values())[0], answer(sk, *outside.values())[0], atol=0.2)  # both clip


def test_weights_of_single_conclusions_become_rules_of_their_own() -> None:
    x = control.Antecedent(np.linspace(0, 1, 11), "x")
    y, z = (control.Consequent(np.linspace(0, 1, 11), name) for name in "yz")
    for variable in (x, y, z):
        variable["up"] = skfuzzy.trimf(variable.universe, [0, 1, 1])
    sk = control.ControlSystem([control.Rule(x["up"], [y["up"] % 0.5, z["up"]], and_func=np.multiply)])
    system = FuzzySystem.from_skfuzzy(sk)
    assert sorted((str(rule.consequents[0]), rule.weight) for rule in system.rules) == [
        ("y is up", 0.5),
        ("z is up", 1),
    ]
    assert system.blocks[0].conjunction == "product"


BASE = """\
Engine: base
InputVariable: x
  range: 0 1
  term: low Ramp 1 0
  term: high Ramp 0 1
OutputVariable: y
  range: 0 1
  aggregation: Maximum
  defuzzifier: Centroid 101
  term: small Triangle 0 0 1
  term: big Triangle 0 1 1
RuleBlock: rules
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  rule: if x is low then y is small
  rule: if x is high then y is big
"""


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("implication: Minimum", "implication: AlgebraicProduct", "implication min only"),
        ("aggregation: Maximum", "aggregation: AlgebraicSum", "output 'y'.*aggregation max only"),
        ("if x is low", "if x is very low", "no hedge but 'not', got 'very'"),
        ("if x is low", "if x is any", "no 'any'"),
        ("y is small", "y is not small", "no hedge in a conclusion"),
        ("  defuzzifier", "  lock-previous: true\n  defuzzifier", "no lock-previous"),
        ("range: 0 1", "range: 0 inf", "finite range"),
    ],
)
def test_what_scikit_fuzzy_cannot_express_is_named(old: str, new: str, words: str) -> None:
    assert old in BASE
    with pytest.raises(ValueError, match=words):
        fll.parse(BASE.replace(old, new, 1)).to_skfuzzy()


def test_weighted_outputs_are_refused() -> None:
    text = BASE.replace("Centroid 101", "WeightedAverage").replace("Triangle 0 0 1", "Constant 0")
    with pytest.raises(ValueError, match="output 'y': scikit-fuzzy has no defuzzifier 'weighted average'"):
        fll.parse(text.replace("Triangle 0 1 1", "Constant 1").replace("Maximum\n  def", "none\n  def")).to_skfuzzy()


@pytest.mark.parametrize("conjunction", ["product", "einstein", "hamacher"])
def test_other_conjunctions_survive_the_way_there_and_back(conjunction: str) -> None:
    term = Term(name="up", shape="triangle", parameters=(0, 1, 1))
    rule = Rule.parse("if a is up and b is up then y is up")
    system = FuzzySystem(
        name="s", inputs=tuple(Variable(name=n, low=0, high=1, terms=(term,)) for n in "ab"),
        outputs=(Variable(name="y", low=0, high=1, terms=(term,)),),
        blocks=(RuleBlock(rules=(rule,), conjunction=conjunction),),
    )  # fmt: skip
    back = FuzzySystem.from_skfuzzy(system.to_skfuzzy())
    assert back.blocks[0].conjunction == conjunction
    assert answer(system.to_skfuzzy(), 0.6, 0.7)[0] == pytest.approx(system(0.6, 0.7)[0], abs=1e-3)


def test_narrow_sets_and_steps_do_not_vanish() -> None:
    text = BASE.replace("low Ramp 1 0", "low Triangle 0.40005 0.4001 0.40015").replace(
        "high Ramp 0 1", "high Binary 0.7 inf"
    )
    system = fll.parse(text)
    sk = system.to_skfuzzy()
    x = np.array([0.4001, 0.7 - 1e-9, 0.7, 0.71])
    ours, theirs = system(x)[0], answer(sk, x)[0]
    assert np.allclose(ours, theirs, atol=1e-3, equal_nan=True)
    assert np.isnan(theirs[1])


def test_foreign_pieces_without_a_counterpart_are_refused() -> None:
    with pytest.raises(ValueError, match=r"expected a skfuzzy\.control\.ControlSystem, got int"):
        FuzzySystem.from_skfuzzy(3)
    with pytest.raises(ValueError, match="no rules"):
        FuzzySystem.from_skfuzzy(control.ControlSystem())
    sk = tipper()
    next(iter(sk.rules)).and_func = lambda a, b: a * b
    with pytest.raises(ValueError, match="function '<lambda>' of a rule is not known"):
        FuzzySystem.from_skfuzzy(sk)
    sk = tipper()
    next(iter(sk.consequents)).accumulation_method = np.add
    with pytest.raises(ValueError, match="accumulation_max"):
        FuzzySystem.from_skfuzzy(sk)
    with pytest.raises(ValueError, match=r"has 2 inputs \(quality, service\), got 1"):
        answer(tipper(), 1.0)


def test_a_takagi_sugeno_system_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match="output 'alpha': scikit-fuzzy has no defuzzifier 'weighted average'"):
        FuzzySystem.load(DATA / "ours_dwa_tuned.fll").to_skfuzzy()
