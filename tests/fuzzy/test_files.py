"""Fuzzy system files: FuzzyLite and MATLAB formats, against pyfuzzylite, by hand, and when broken."""

import math
import os
import random
from dataclasses import replace
from pathlib import Path

import fuzzylite as fl
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzzynav.fuzzy import (
    And,
    FuzzySystem,
    Or,
    Proposition,
    Rule,
    RuleBlock,
    Term,
    Variable,
)
from fuzzynav.fuzzy.files import disk, fis, fis_writer, fll, fll_writer

DATA = Path(__file__).parents[2] / "data" / "fuzzy"
PLANNER = (DATA / "fuzzy_planner_table_i.fll").read_text(encoding="utf-8")
EXAMPLES = Path(fl.__file__).parent / "examples"

SMALL = """\
Engine: small
InputVariable: x
  enabled: true
  range: 0 10
  lock-range: false
  term: low Triangle 0 0 10
  term: high Triangle 0 10 10
OutputVariable: y
  enabled: true
  range: 0 1
  lock-range: false
  aggregation: Maximum
  defuzzifier: Centroid 101
  default: nan
  lock-previous: false
  term: small Triangle 0 0 0.5
  term: big Triangle 0.5 1 1
RuleBlock: rules
  enabled: true
  conjunction: Minimum
  disjunction: Maximum
  implication: Minimum
  activation: General
  rule: if x is low then y is small
  rule: if x is high then y is big with 0.5
"""

TIPPER = """\
[System]
Name='tipper'
Type='mamdani'
Version=2.0
NumInputs=2
NumOutputs=1
NumRules=3
AndMethod='min'
OrMethod='max'
ImpMethod='min'
AggMethod='max'
DefuzzMethod='centroid'

[Input1]
Name='service'
Range=[0 10]
NumMFs=3
MF1='poor':'gaussmf',[1.5 0]
MF2='good':'gaussmf',[1.5 5]
MF3='excellent':'gaussmf',[1.5 10]

[Input2]
Name='food'
Range=[0 10]
NumMFs=2
MF1='rancid':'trapmf',[0 0 1 3]
MF2='delicious':'trapmf',[7 9 10 10]

[Output1]
Name='tip'
Range=[0 30]
NumMFs=3
MF1='cheap':'trimf',[0 5 10]
MF2='average':'trimf',[10 15 20]
MF3='generous':'trimf',[20 25 30]

[Rules]
1 1, 1 (1) : 2
2 0, 2 (1) : 1
3 2, 3 (1) : 2
"""


def broken(text: str, old: str, new: str) -> str:
    assert old in text
    return text.replace(old, new, 1)


def hamacher_sum(_: fl.HamacherSum, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Their norm in a form that keeps its digits: (a + b - 2 a b) / (1 - a b) gives 2 for a, b next to 1."""
    gap = 1.0 - np.multiply(a, b)
    return np.where(gap == 0.0, 1.0, 1.0 - (1.0 - np.asarray(a)) * (1.0 - b) / np.where(gap == 0.0, 1.0, gap))


@pytest.fixture(autouse=True)
def _steady_hamacher_sum(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fl.HamacherSum, "compute", hamacher_sum)


def pyfuzzylite_answers(engine: fl.Engine, points: np.ndarray) -> np.ndarray:
    """Outputs (n_outputs, n) of pyfuzzylite, one point at a time, without memory."""
    columns = []
    for point in points.T:
        engine.restart()
        for variable, value in zip(engine.input_variables, point):
            variable.value = float(value)
        with np.errstate(all="ignore"):
            engine.process()
        columns.append([of_maximum(v) for v in engine.output_variables])
    return np.array(columns).T


def of_maximum(output: fl.OutputVariable) -> float:
    """Their answer; for a maximum taken anew, so that samples equal up to the last digit count as equal."""
    ends = {fl.MeanOfMaximum: np.mean, fl.SmallestOfMaximum: np.min, fl.LargestOfMaximum: np.max}
    if type(output.defuzzifier) not in ends:
        return float(np.squeeze(output.value))
    x = fl.Op.midpoints(output.minimum, output.maximum, output.defuzzifier.resolution)
    with np.errstate(all="ignore"):
        mu = np.broadcast_to(output.fuzzy.membership(x), x.shape)
    top = mu.max()
    if not top > 0.0:
        return output.default_value
    return float(ends[type(output.defuzzifier)](x[mu >= top * (1.0 - 1e-12)]))


def inside(variables: list[fl.InputVariable], n: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return np.array([rng.uniform(v.minimum, v.maximum, n) for v in variables])


def agree(ours: np.ndarray, theirs: np.ndarray, tolerance: float = 1e-9) -> None:
    assert (np.isnan(ours) == np.isnan(theirs)).all(), (ours, theirs)
    scale = 1.0 + np.nan_to_num(np.abs(theirs)).max(initial=0.0)
    assert np.nanmax(np.abs(ours - theirs), initial=0.0) <= tolerance * scale


# FuzzyLite: against pyfuzzylite

REFUSED = {"laundry": "condition", "simple_dimmer_chained": "condition", "simple_dimmer_inverse": "condition",
           "approximation": "Function", "function": "Function", "juggler": "one name"}  # fmt: skip
TWO_HEDGES = {"CheapTip", "AverageTip", "GenerousTip"}


@pytest.mark.parametrize("path", sorted(EXAMPLES.rglob("*.fll")), ids=lambda p: p.relative_to(EXAMPLES).as_posix())
def test_the_examples_of_pyfuzzylite_give_its_numbers(path: Path, tmp_path: Path) -> None:
    if path.stem in REFUSED and not (path.stem == "function" and path.parent.name != "terms"):
        with pytest.raises(ValueError, match=f"line [0-9]+, .*{REFUSED[path.stem]}"):
            FuzzySystem.load(path)
        return
    system = FuzzySystem.load(path)
    engine = fl.FllImporter().from_file(path)
    points = inside(engine.input_variables, 15, seed=3)
    ours = np.array(system(*points))
    theirs = pyfuzzylite_answers(engine, points)
    keep = [v.name not in TWO_HEDGES for v in engine.output_variables]
    agree(ours[keep], theirs[keep])
    system.save(tmp_path / "again.fll")
    assert FuzzySystem.load(tmp_path / "again.fll") == system


NORMS = [cls.__name__ for cls in (fl.Minimum, fl.AlgebraicProduct, fl.BoundedDifference, fl.DrasticProduct,
                                  fl.EinsteinProduct, fl.HamacherProduct, fl.NilpotentMinimum)]  # fmt: skip
CONORMS = [cls.__name__ for cls in (fl.Maximum, fl.AlgebraicSum, fl.BoundedSum, fl.DrasticSum, fl.EinsteinSum,
                                    fl.HamacherSum, fl.NilpotentMaximum, fl.NormalizedSum,
                                    fl.UnboundedSum)]  # fmt: skip
TERMS = (
    "Triangle {0} {1} {2}", "Trapezoid {0} {1} {2} {3}", "Gaussian {1} 0.21", "GaussianProduct {1} 0.2 {2} 0.1",
    "Bell {1} 0.25 3", "Sigmoid {1} 12", "Sigmoid {1} -9", "SigmoidDifference {0} 20 15 {3}",
    "SigmoidProduct {0} 20 -15 {3}", "ZShape {0} {2}", "SShape {1} {3}", "PiShape {0} {1} {2} {3}", "Ramp {0} {3}",
    "Ramp {3} {0}", "Rectangle {0} {2}", "Binary {1} inf", "Binary {1} -inf", "Discrete {0} 0.1 {1} 0.9 {2} 0.4 {3} 0",
    "Spike {1} 0.7", "Cosine {2} 0.6", "Concave {1} {2}", "Concave {2} {1}", "Arc {0} {2}", "Arc {3} {1}",
    "SemiEllipse {0} {3}",
)  # fmt: skip
DEFUZZIFIERS = ("Centroid", "Bisector", "MeanOfMaximum", "SmallestOfMaximum", "LargestOfMaximum")
HEDGES = ("", "not ", "very ", "somewhat ", "extremely ", "seldom ", "not very ")


def random_fll(seed: int) -> str:
    """A random Mamdani system over all shapes, norms, hedges and defuzzifiers."""
    rng = random.Random(seed)

    def terms(prefix: str, n: int) -> str:
        lines = []
        for k in range(n):
            points = [f"{v:.4f}" for v in sorted(rng.uniform(0.02, 0.98) for _ in range(4))]
            height = rng.choice(["", "", " 0.8"])
            lines.append(f"  term: {prefix}{k} {rng.choice(TERMS).format(*points)}{height}\n")
        return "".join(lines)

    def proposition() -> str:
        name = rng.choice("ab")
        return rng.choice([f"{name} is {rng.choice(HEDGES)}{name}{rng.randrange(3)}"] * 9 + [f"{name} is any"])

    text = "Engine: random\n"
    for name in "ab":
        text += f"InputVariable: {name}\n  range: 0.000 1.000\n  lock-range: {rng.choice(['true', 'false'])}\n"
        text += terms(name, 3)
    for name in "pq":
        text += f"OutputVariable: {name}\n  range: 0.000 1.000\n  aggregation: {rng.choice(CONORMS)}\n"
        text += f"  defuzzifier: {rng.choice(DEFUZZIFIERS)} {rng.choice([37, 100])}\n"
        text += f"  default: {rng.choice(['nan', '0.250'])}\n" + terms(name, 3)
    for block in ("one", "two"):
        text += f"RuleBlock: {block}\n  conjunction: {rng.choice(NORMS)}\n  disjunction: {rng.choice(CONORMS[:7])}\n"
        text += f"  implication: {rng.choice(NORMS)}\n  activation: General\n"
        for _ in range(3):
            condition = proposition()
            for _ in range(rng.randrange(3)):
                condition = rng.choice(["{} and {}", "{} or {}", "({} or {})"]).format(condition, proposition())
            text += f"  rule: if {condition} then p is p{rng.randrange(3)} and q is q{rng.randrange(3)}"
            text += rng.choice(["", " with 0.600"]) + "\n"
    return text


@pytest.mark.parametrize("seed", range(60))
def test_random_systems_agree_with_pyfuzzylite(seed: int) -> None:
    text = random_fll(seed)
    engine = fl.FllImporter().from_string(text)
    with fl.settings.context(decimals=17):
        system = fll.parse(fl.FllExporter().to_string(engine))
    points = np.random.default_rng(seed).uniform(-0.1, 1.1, (2, 12))
    agree(np.array(system(*points)), pyfuzzylite_answers(engine, points))


@pytest.mark.parametrize("kind", ["WeightedAverage", "WeightedSum"])
@pytest.mark.parametrize("terms", [["Constant 2.5", "Linear 1 -2 0.5"], ["Ramp 0 3", "Sigmoid 0.5 9"],
                                   ["SShape 0 1", "ZShape 1 4"], ["Concave 0.2 0.9", "Arc 0 2"]])  # fmt: skip
def test_weighted_systems_agree_with_pyfuzzylite(kind: str, terms: list[str]) -> None:
    text = SMALL.replace("Centroid 101", kind).replace("aggregation: Maximum", "aggregation: none")
    text = text.replace("InputVariable: x", "InputVariable: w\n  range: 0 1\n  term: t Ramp 0 1\nInputVariable: x")
    for name, term in zip(("small Triangle 0 0 0.5", "big Triangle 0.5 1 1"), terms):
        text = broken(text, name, f"{name.split()[0]} {term}")
    engine = fl.FllImporter().from_string(text)
    points = inside(engine.input_variables, 10, seed=1)
    agree(np.array(fll.parse(text)(*points)), pyfuzzylite_answers(engine, points))


def test_a_file_without_a_quadrature_line_means_midpoints() -> None:
    assert fll.parse(SMALL).outputs[0].quadrature == "midpoint"
    ours = fll.parse(broken(SMALL, "  aggregation", "  #! quadrature: trapezoid\n  aggregation"))
    assert ours.outputs[0].quadrature == "trapezoid"
    engine = fl.FllImporter().from_string(PLANNER)  # other readers take our lines for comments
    assert len(engine.rule_blocks[0].rules) == 27


def test_a_centroid_without_a_number_has_a_thousand_samples() -> None:
    assert fll.parse(broken(SMALL, "Centroid 101", "Centroid")).outputs[0].resolution == 1000


def test_disabled_parts_are_taken_out_as_pyfuzzylite_does() -> None:
    extra = "InputVariable: z\n  enabled: false\n  range: 0 1\n  term: t Ramp 0 1\nInputVariable: x"
    text = broken(SMALL, "InputVariable: x", extra)
    text += "  rule: if x is low or z is not t then y is big\n  rule: if z is t then y is small\n"
    text += "  rule: if x is high and z is any then y is small\n"
    text += "RuleBlock: off\n  enabled: false\n  implication: Minimum\n  rule: if x is any then y is big\n"
    engine, system = fl.FllImporter().from_string(text), fll.parse(text)
    assert len(system.blocks) == 1
    assert len(system.rules) == 3
    points = inside(engine.input_variables, 10, seed=2)
    agree(np.array(system(*points)), pyfuzzylite_answers(engine, points))
    off = fll.parse(broken(text, "OutputVariable: y\n  enabled: true", "OutputVariable: u\n  range: 0 1\n"
                           "  aggregation: Maximum\n  defuzzifier: Centroid 101\n  enabled: false\n  default: 3\n"
                           "  term: v Ramp 0 1\nOutputVariable: y\n  enabled: true"))  # fmt: skip
    assert math.isnan(off(0.5, 5.0)[0])
    assert off(0.5, 5.0)[1] == system(0.5, 5.0)[0]


def test_a_hedge_in_a_conclusion_stays_with_its_conclusion() -> None:
    text = SMALL.replace("then y is small", "then y is very small and y is big")
    (rule, _) = fll.parse(text).rules
    assert [c.hedges for c in rule.consequents] == [("very",), ()]
    plain = fll.parse(SMALL.replace("then y is small", "then y is big and y is very small"))
    assert fll.parse(text)(3.0) == pytest.approx(plain(3.0), rel=1e-12)


# round trips

names = st.text("abcXYZ_", min_size=1, max_size=6).filter(lambda n: n not in {"if", "is", "and", "or", "any"})
finite = st.floats(-1e6, 1e6)
lines = st.text(max_size=30)


@st.composite
def terms_of(draw: st.DrawFn) -> Term:
    shape = draw(st.sampled_from(["triangle", "trapezoid", "gaussian", "ramp", "discrete", "singleton", "sigmoid"]))
    count = {"triangle": 3, "trapezoid": 4, "singleton": 1, "discrete": 6}.get(shape, 2)
    p = sorted(draw(st.lists(finite, min_size=count, max_size=count, unique=True)))
    if shape == "gaussian":
        p[1] = abs(p[1]) + 0.1
    if shape == "discrete":
        p = [v for x in p[:3] for v in (x, draw(st.floats(0, 1)))]
    return Term(name=draw(names), shape=shape, parameters=tuple(p), height=draw(st.sampled_from([1.0, 0.7, 1.0 / 3.0])))


@st.composite
def systems(draw: st.DrawFn) -> FuzzySystem:
    labels = draw(st.lists(names, min_size=4, max_size=4, unique=True))
    inputs = []
    for name in labels[:2]:
        terms = draw(st.lists(terms_of(), min_size=1, max_size=3, unique_by=lambda t: t.name))
        low = draw(finite)
        inputs.append(Variable(name=name, low=low, high=low + 1.0 + abs(draw(finite)), terms=tuple(terms),
                               unit=draw(lines), lock_range=draw(st.booleans())))  # fmt: skip
    outputs = []
    for name in labels[2:]:
        weighted = draw(st.booleans())
        shapes = [("constant", (draw(finite),)), ("linear", (1.0, 2.0, draw(finite)))] if weighted else []
        shapes = shapes or [("triangle", (0.0, 0.5, 1.0)), ("trapezoid", (0.0, 0.1, 0.3, 1.0))]
        terms = [Term(name=f"t{k}", shape=s, parameters=p) for k, (s, p) in enumerate(shapes)]
        outputs.append(Variable(
            name=name, low=0.0, high=1.0, terms=tuple(terms), unit=draw(lines),
            defuzzifier="weighted sum" if weighted else draw(st.sampled_from(["centroid", "bisector"])),
            aggregation=draw(st.sampled_from(["sum", "max", "einstein sum"])), resolution=draw(st.integers(20, 999)),
            quadrature=draw(st.sampled_from(["trapezoid", "midpoint", "sum"])),
            default=draw(st.sampled_from([math.nan, 0.1, 1e-300])), lock_previous=draw(st.booleans()),
        ))  # fmt: skip

    def proposition() -> Proposition:
        variable = draw(st.sampled_from(inputs))
        hedges = draw(st.sampled_from([(), ("not",), ("very", "somewhat"), ("any",)]))
        term = "" if hedges == ("any",) else draw(st.sampled_from(variable.terms)).name
        return Proposition(variable=variable.name, term=term, hedges=hedges)

    def antecedent(depth: int) -> Proposition | And | Or:
        kind = draw(st.sampled_from([None, And, Or])) if depth else None
        return proposition() if kind is None else kind(parts=(antecedent(depth - 1), antecedent(depth - 1)))

    rules = []
    for output in outputs:
        conclusion = Proposition(variable=output.name, term=output.terms[-1].name)
        rules.append(Rule(antecedent=antecedent(2), consequents=(conclusion,), weight=draw(st.floats(0, 1))))
    blocks = [RuleBlock(rules=tuple(rules), name=draw(names), conjunction="einstein", implication="product"),
              RuleBlock(rules=tuple(rules[:1]), disjunction="hamacher sum")]  # fmt: skip
    return FuzzySystem(name=draw(names), inputs=tuple(inputs), outputs=tuple(outputs), blocks=tuple(blocks),
                       source=draw(lines), description=draw(lines))  # fmt: skip


@settings(max_examples=100, deadline=None)
@given(systems())
def test_fll_round_trip_is_exact(system: FuzzySystem) -> None:
    text = fll_writer.dump(system)
    assert fll.parse(text) == system
    assert fll_writer.dump(fll.parse(text)) == text


def test_fll_written_by_us_is_read_by_pyfuzzylite_as_the_same_system(tmp_path: Path) -> None:
    for seed in range(5):
        system = fll.parse(random_fll(seed))
        system.save(tmp_path / "x.fll")
        engine = fl.FllImporter().from_file(tmp_path / "x.fll")
        points = inside(engine.input_variables, 5, seed)
        centroids = [k for k, v in enumerate(system.outputs) if v.defuzzifier == "centroid"]
        agree(np.array(system(*points))[centroids], pyfuzzylite_answers(engine, points)[centroids])


@pytest.mark.parametrize("name", ["D-G", "9lives", "a.b"])
def test_names_that_fuzzylite_would_change_are_not_written(name: str, tmp_path: Path) -> None:
    system = fll.parse(SMALL)
    other = replace(system.inputs[0], name=name)
    rule = Rule(antecedent=Proposition(variable=name, term="low"), consequents=system.rules[0].consequents)
    system = replace(system, inputs=(other,), blocks=(RuleBlock(rules=(rule,)),))
    with pytest.raises(ValueError, match="letters, digits and _"):
        system.save(tmp_path / "x.fll")
    assert list(tmp_path.iterdir()) == []


# MATLAB


def evalfis_tip(service: float, food: float) -> float:
    """evalfis of the tipper, written out: minimum, maximum, plain sum of 101 points."""
    gauss = [math.exp(-((service - c) ** 2) / (2 * 1.5**2)) for c in (0, 5, 10)]
    rancid = min(1.0, max(0.0, (3 - food) / 2))
    delicious = min(1.0, max(0.0, (food - 7) / 2))
    strength = [max(gauss[0], rancid), gauss[1], max(gauss[2], delicious)]
    y = [30 * k / 100 for k in range(101)]
    total = moment = 0.0
    for point in y:
        mu = max(min(s, max(0.0, 1 - abs(point - c) / 5)) for s, c in zip(strength, (5, 15, 25)))
        total, moment = total + mu, moment + mu * point
    return moment / total


@pytest.mark.parametrize(("service", "food"), [(3.0, 8.0), (0.0, 0.0), (9.5, 2.0), (5.0, 5.0)])
def test_fis_computes_as_evalfis_by_hand(service: float, food: float) -> None:
    assert fis.parse(TIPPER)(service, food)[0] == pytest.approx(evalfis_tip(service, food), rel=1e-12)


def test_fis_of_the_planner_gives_matlabs_number(tmp_path: Path) -> None:
    planner = FuzzySystem.load(DATA / "fuzzy_planner_table_i.fll")
    plain = replace(planner, outputs=tuple(replace(v, quadrature="sum") for v in planner.outputs))
    plain.save(tmp_path / "planner.fis")
    v, omega = FuzzySystem.load(tmp_path / "planner.fis")(0.8, 0.3, 0.5)
    assert (round(v, 4), round(omega, 2)) == (0.6548, 31.07)  # by an independent plain sum of 101 points
    v, omega = planner(0.8, 0.3, 0.5)
    assert (round(v, 3), round(omega, 1)) == (0.652, 31.4)


def test_fis_answers_the_middle_where_no_rule_fires() -> None:
    silent = TIPPER.replace(" (1) : ", " (0) : ")
    assert fis.parse(silent)(5.0, 5.0) == (15.0,)


def test_negative_and_zero_term_numbers_are_not_and_any() -> None:
    system = fis.parse(broken(TIPPER, "2 0, 2 (1) : 1\n", "1 -1, 2 (1) : 1\n"))
    assert system.rules[1].antecedent.parts[1].hedges == ("not",)
    assert fis.parse(TIPPER).rules[1].antecedent == Proposition(variable="service", term="good")
    never = fis.parse(broken(TIPPER, "2 0, 2 (1) : 1\n", "0 0, 2 (0.25) : 1\n"))
    assert str(never.rules[1]) == "if service is any then tip is average with 0.25"


SUGENO = """\
[System]
Name='two lines'
Type='sugeno'
NumInputs=1
NumOutputs=1
NumRules=2
AndMethod='prod'
OrMethod='probor'
ImpMethod='prod'
AggMethod='sum'
DefuzzMethod='wtaver'
[Input1]
Name='x'
Range=[0 1]
NumMFs=2
MF1='low':'trimf',[0 0 1]
MF2='high':'trimf',[0 1 1]
[Output1]
Name='y'
Range=[-1 1]
NumMFs=2
MF1='flat':'constant',[2]
MF2='line':'linear',[4 -1]
[Rules]
1, 1 (1) : 1
2, 2 (0.5) : 1
"""


def test_sugeno_by_hand() -> None:
    x = 0.25
    expected = (0.75 * 2 + 0.5 * 0.25 * (4 * x - 1)) / (0.75 + 0.5 * 0.25)
    assert fis.parse(SUGENO)(x)[0] == pytest.approx(expected, rel=1e-12)


def test_som_and_lom_take_the_absolute_value_as_matlab_does() -> None:
    below = TIPPER.replace("centroid", "som").replace("Range=[0 30]", "Range=[-30 0]")
    for a, b in (("[0 5 10]", "[-30 -25 -20]"), ("[10 15 20]", "[-20 -15 -10]"), ("[20 25 30]", "[-10 -5 0]")):
        below = broken(below, a, b)
    assert fis.parse(below).outputs[0].defuzzifier == "largest of maximum"
    assert "DefuzzMethod='som'" in fis_writer.dump(fis.parse(below))
    with pytest.raises(ValueError, match=r"line \d+.*absolute value"):
        fis.parse(TIPPER.replace("centroid", "lom").replace("Range=[0 30]", "Range=[-30 30]"))


@pytest.mark.parametrize("text", [TIPPER, SUGENO])
def test_fis_round_trip(text: str, tmp_path: Path) -> None:
    system = fis.parse(text)
    system.save(tmp_path / "x.fis")
    assert FuzzySystem.load(tmp_path / "x.fis") == system
    again = replace(system, source='a "quoted"\nsource', description="d", outputs=tuple(
        replace(v, default=math.nan, resolution=201, quadrature="trapezoid", unit="%") for v in system.outputs
    ))  # fmt: skip
    again.save(tmp_path / "x.fis")
    assert FuzzySystem.load(tmp_path / "x.fis") == again


def test_all_matlab_shapes_survive() -> None:
    shapes = ("trimf',[0 1 2]", "trapmf',[0 1 2 3]", "gaussmf',[1 2]", "gauss2mf',[1 2 3 4]", "gbellmf',[1 2 5]",
              "sigmf',[3 5]", "dsigmf',[5 2 4 7]", "psigmf',[5 2 -4 7]", "zmf',[1 4]", "smf',[1 4]",
              "pimf',[1 2 3 4]")  # fmt: skip
    mfs = "".join(f"MF{k}='m{k}':'{shape}\n" for k, shape in enumerate(shapes, start=1))
    head, tail = TIPPER.split("NumMFs=3\n", 1)
    text = head + f"NumMFs={len(shapes)}\n" + mfs + tail.split("MF3='excellent':'gaussmf',[1.5 10]\n", 1)[1]
    text = text.replace("NumRules=3", f"NumRules={len(shapes)}").split("[Rules]")[0] + "[Rules]\n"
    text += "".join(f"{k} 0, {k % 3 + 1} (1) : 1\n" for k in range(1, len(shapes) + 1))
    system = fis.parse(text)
    assert fis.parse(fis_writer.dump(system)) == system
    sigma_c = dict((t.name, t) for t in system.inputs[0].terms)["m3"]
    assert sigma_c.parameters == (2.0, 1.0)
    bell = dict((t.name, t) for t in system.inputs[0].terms)["m5"]
    assert float(bell.membership(6.0)) == 0.5  # one width from the centre 5


def test_what_a_fis_cannot_say_is_named(tmp_path: Path) -> None:
    small = fll.parse(SMALL)
    for change, words in (
        (dict(blocks=(*small.blocks, replace(small.blocks[0], conjunction="product"))), "in their conjunction: min, p"),
        (dict(blocks=(replace(small.blocks[0], conjunction="einstein"),)), "einstein"),
        (dict(blocks=(RuleBlock(rules=("if x is very low then y is big",)),)), "hedge"),
        (dict(blocks=(RuleBlock(rules=("if x is low and (x is high or x is low) then y is big",)),)), "alone"),
        (dict(blocks=(RuleBlock(rules=("if x is low and x is not high then y is big",)),)), "only once"),
    ):
        with pytest.raises(ValueError, match=words):
            replace(small, **change).save(tmp_path / "x.fis")
    assert list(tmp_path.iterdir()) == []


# broken files


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("Engine: small", "engine small", 1, "expected 'key: value'"),
        ("Engine: small\n", "", 1, "must begin with Engine"),
        ("range: 0 10", "range: 0 10 20", 4, "range: expected two numbers"),
        ("range: 0 10", "range: 10 0", 2, "low < high"),
        ("range: 0 10", "range: 0 ten", 4, "range: expected a number, got 'ten'"),
        ("range: 0 10", "ranges: 0 10", 4, "ranges: unknown under InputVariable"),
        ("lock-range: false", "lock-range: no", 5, "true or false"),
        ("lock-range: false", "range: 0 1", 5, "stands twice"),
        ("low Triangle 0 0 10", "low Triangle 0 0", 6, "3 parameters"),
        ("low Triangle 0 0 10", "low Triangle 10 0 0", 6, "a <= b <= c"),
        ("low Triangle 0 0 10", "low Tringle 0 0 10", 6, "unknown shape 'Tringle'"),
        ("low Triangle 0 0 10", "low Function x/10", 6, "Function"),
        ("low Triangle 0 0 10", "low", 6, "name Shape numbers"),
        ("aggregation: Maximum", "aggregation: Max", 12, "unknown aggregation 'Max'"),
        ("aggregation: Maximum", "aggregation: none", 12, "Maximum"),
        ("Centroid 101", "Centroid 1e9", 13, "whole number"),
        ("Centroid 101", "Centroid 999999999", 13, "from 2 to"),
        ("Centroid 101", "Middle", 13, "unknown defuzzifier 'Middle'"),
        ("Centroid 101", "none", 13, "needs one"),
        ("default: nan", "default: nan nan", 14, "one number"),
        ("default: nan", "#! quadratur: sum", 14, "quadratur: unknown"),
        ("default: nan", "#! quadrature: simpson", 14, "simpson"),
        ("conjunction: Minimum", "conjunction: Median", 20, "unknown conjunction 'Median'"),
        ("implication: Minimum", "implication: none", 22, "needs? one"),
        ("activation: General", "activation: Highest 1", 23, "Highest 1.*General"),
        ("if x is low then", "if x is tall then", 24, "no term 'tall'"),
        ("if x is low then", "if z is low then", 24, "'z'"),
        ("if x is low then", "if y is small then", 24, "output 'y' as a condition"),
        ("if x is low then", "if x low then", 24, "expected 'is'"),
        ("y is big with 0.5", "y is big with two", 25, "weight"),
        ("y is big with 0.5", "y is big with 2", 25, "weight"),
        ("  rule: if x is low then y is small\n  rule: if x is high then y is big with 0.5\n", "", 24, "cut off"),
    ],
)
def test_a_fault_in_an_fll_is_named_with_its_line(old: str, new: str, line: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.fll"
    path.write_text(broken(SMALL, old, new))
    with pytest.raises(ValueError, match=f"bad.fll, line {line}\\b.*{words}"):
        FuzzySystem.load(path)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("[System]", "", 2, "expected \\[System\\]"),
        ("Type='mamdani'", "Type='type2'", 3, "mamdani"),
        ("NumRules=3", "NumRules=4", 7, "numrules: says 4, but the file has 3"),
        ("NumInputs=2", "NumInputs=two", 5, "whole number"),
        ("NumMFs=3", "NumMFs=2", 17, "nummfs: says 2"),
        ("AndMethod='min'", "AndMethod=min", 8, "in quotes"),
        ("AndMethod='min'", "AndMethod='mine'", 8, "'mine' is not supported"),
        ("DefuzzMethod='centroid'", "DefuzzMethod='wtaver'", 12, "does not fit a mamdani"),
        ("Range=[0 10]", "Range=0 10", 16, "in \\[ \\]"),
        ("'gaussmf',[1.5 0]", "'gaussmf',[1.5]", 18, "gaussmf needs 2 numbers"),
        ("'gaussmf',[1.5 0]", "'mymf',[1.5 0]", 18, "unknown membership function 'mymf'"),
        ("'gaussmf',[1.5 0]", "'gaussmf',[0 0]", 18, "sigma > 0"),
        ("MF1='poor':'gaussmf',[1.5 0]", "MF1=poor", 18, "'name':'type'"),
        ("MF1='poor'", "MF2='poor'", 19, "stands twice"),
        ("1 1, 1 (1) : 2", "1 1, 1 (1)", 38, "rule: expected '1 2, 1"),
        ("1 1, 1 (1) : 2", "1, 1 (1) : 2", 38, "2 input"),
        ("1 1, 1 (1) : 2", "1 3, 1 (1) : 2", 38, "food has 2 terms"),
        ("1 1, 1 (1) : 2", "1.2 1, 1 (1) : 2", 38, "hedge codes"),
        ("1 1, 1 (1) : 2", "1 1, -1 (1) : 2", 38, "negative output"),
        ("1 1, 1 (1) : 2", "0 0, 1 (1) : 2", 38, "never fires"),
        ("1 1, 1 (1) : 2", "1 1, 0 (1) : 2", 38, "no conclusion"),
    ],
)
def test_a_fault_in_a_fis_is_named_with_its_line(old: str, new: str, line: int, words: str, tmp_path: Path) -> None:
    path = tmp_path / "bad.fis"
    path.write_text(broken(TIPPER, old, new))
    with pytest.raises(ValueError, match=f"bad.fis, line {line}\\b.*{words}"):
        FuzzySystem.load(path)


def mutated(text: str, seed: int) -> str:
    rng = random.Random(seed)
    kind = rng.randrange(6)
    lines = text.split("\n")
    at = rng.randrange(len(text))
    if kind == 0:
        return text[:at]
    if kind == 1:
        return text[:at] + rng.choice("0-.#:\x00(é]'%\n 9") + text[at + 1 :]
    if kind == 2:
        return text[:at] + rng.choice(["nan", "inf", "-1", "1e400", "((((", " and ", "\u2028", "if"]) + text[at:]
    k = rng.randrange(len(lines))
    if kind == 3:
        return "\n".join(lines[:k] + lines[k + 1 :])
    if kind == 4:
        return "\n".join(lines[:k] + [lines[k], lines[k]] + lines[k + 1 :])
    words = lines[k].split(" ")
    rng.shuffle(words)
    return "\n".join(lines[:k] + [" ".join(words)] + lines[k + 1 :])


@pytest.mark.parametrize(("suffix", "texts"), [(".fll", (SMALL, random_fll(1), PLANNER)), (".fis", (TIPPER, SUGENO))])
def test_a_mutated_file_loads_or_raises_one_valueerror_with_its_name(suffix: str, texts: tuple, tmp_path: Path) -> None:
    path = tmp_path / f"mutant{suffix}"
    outcomes, loaded = {True: 0, False: 0}, 0
    for seed in range(600):
        path.write_text(mutated(texts[seed % len(texts)], seed), encoding="utf-8")
        try:
            system = FuzzySystem.load(path)
        except ValueError as error:
            outcomes[path.name in str(error)] += 1
        else:
            loaded += len(system.rules) > 0
    assert outcomes[False] == 0
    assert outcomes[True] > 50
    assert loaded > 50


@settings(max_examples=150, deadline=None)
@given(st.binary(max_size=300), st.sampled_from([".fll", ".fis"]))
def test_noise_is_one_valueerror(tmp_path_factory: pytest.TempPathFactory, raw: bytes, suffix: str) -> None:
    path = tmp_path_factory.getbasetemp() / f"noise{suffix}"
    path.write_bytes(raw)
    with pytest.raises(ValueError, match="noise"):
        FuzzySystem.load(path)


@pytest.mark.parametrize(("text", "suffix"), [(SMALL, ".fll"), (TIPPER, ".fis")])
def test_windows_line_ends_and_byte_order_marks_are_read(text: str, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"x{suffix}"
    path.write_text(text)
    plain = FuzzySystem.load(path)
    path.write_bytes(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode())
    assert FuzzySystem.load(path) == plain
    path.write_bytes(text.encode("utf-16"))
    with pytest.raises(ValueError, match=f"x{suffix}, line 1: not UTF-8"):
        FuzzySystem.load(path)


def test_missing_large_and_foreign_files_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(FileNotFoundError, match=r"nowhere\.fll: no such file"):
        FuzzySystem.load(tmp_path / "nowhere.fll")
    with pytest.raises(ValueError, match=r"\.fll \(FuzzyLite\) or \.fis \(MATLAB\)"):
        FuzzySystem.load(tmp_path / "x.txt")
    (tmp_path / "folder.fll").mkdir()
    with pytest.raises(FileNotFoundError):
        FuzzySystem.load(tmp_path / "folder.fll")
    monkeypatch.setattr(disk, "MAX_BYTES", 100)
    (tmp_path / "x.fll").write_text(SMALL)
    with pytest.raises(ValueError, match="larger than 100 bytes"):
        FuzzySystem.load(tmp_path / "x.fll")


def test_a_save_that_fails_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "x.fll"
    system = fll.parse(SMALL)
    system.save(path)
    before = path.read_bytes()

    def fail(*_: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="disk full"):
        replace(system, name="other").save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["x.fll"]
