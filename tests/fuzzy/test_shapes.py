"""The tables of shapes, operators and defuzzifiers: every row round-trips, and its kernel is its NumPy function."""

import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fuzzynav import fuzzy
from fuzzynav.fuzzy import SHAPES, FuzzySystem, RuleBlock, Shape, Term, Variable, codes, triangle
from fuzzynav.fuzzy.files import fis, fis_writer, fll, fll_writer
from fuzzynav.fuzzy.kernels import conorm, hedged, inverse_member, member, norm
from fuzzynav.fuzzy.operators import CONORMS, HEDGES, NORMS
from fuzzynav.fuzzy.variable import DEFUZZIFIERS, QUADRATURES, WEIGHTED

EXAMPLE = {  # one term of every shape; a new row without one fails below
    "triangle": (0.1, 0.4, 0.8), "trapezoid": (0.1, 0.3, 0.5, 0.9), "gaussian": (0.4, 0.2),
    "two-sided gaussian": (0.3, 0.1, 0.6, 0.2), "bell": (0.5, 0.2, 3.0), "sigmoid": (0.4, 9.0),
    "sigmoid difference": (0.2, 20.0, 15.0, 0.7), "sigmoid product": (0.2, 20.0, -15.0, 0.7), "z": (0.2, 0.7),
    "s": (0.2, 0.7), "pi": (0.1, 0.3, 0.5, 0.9), "ramp": (0.8, 0.1), "rectangle": (0.25, 0.75), "singleton": (0.5,),
    "binary": (0.4, -math.inf), "constant": (0.7,), "linear": (2.0, -0.5), "discrete": (0.0, 0.1, 0.5, 1.0, 0.9, 0.3),
    "spike": (0.4, 0.6), "cosine": (0.5, 0.7), "concave": (0.3, 0.8), "arc": (0.1, 0.9), "semi-ellipse": (0.1, 0.9),
}  # fmt: skip
CONCLUSIONS = ("constant", "linear", "singleton")


def holding(term: Term) -> FuzzySystem:
    """A system with the term: as an input's set, or as the conclusion of a weighted average."""
    base, crisp = triangle("base", 0, 0.5, 1), term.shape in CONCLUSIONS
    x = Variable(name="x", low=0, high=1, terms=(base,) if crisp else (base, term))
    sort = {"defuzzifier": "weighted average"} if crisp else {}
    y = Variable(name="y", low=0, high=1, terms=(term,) if crisp else (base,), **sort)
    rule = "if x is base then y is t" if crisp else "if x is t then y is base"
    return FuzzySystem(name="one", inputs=(x,), outputs=(y,), blocks=(RuleBlock(rules=(rule,)),))


def test_every_row_is_whole_and_has_an_example() -> None:
    assert set(EXAMPLE) == set(SHAPES)
    assert sorted(shape.code for shape in SHAPES.values()) == list(range(len(SHAPES)))
    assert all(name == shape.name and shape.about for name, shape in SHAPES.items())
    words = [word for shape in SHAPES.values() for word in (shape.fll, shape.fis) if word]
    assert len(set(words)) == len(words)


def test_every_shape_has_a_constructor_in_the_face() -> None:
    made = {value.name: value for value in vars(fuzzy).values() if isinstance(value, Shape)}
    assert made == SHAPES
    for name, shape in SHAPES.items():
        term = shape("t", *EXAMPLE[name], height=0.5)
        assert term == Term(name="t", shape=name, parameters=EXAMPLE[name], height=0.5)


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_every_shape_round_trips_through_fll(name: str) -> None:
    system = holding(SHAPES[name]("t", *EXAMPLE[name]))
    text = fll_writer.dump(system)
    assert (SHAPES[name].fll or "#! singleton: t") in text
    assert fll.parse(text) == system


@pytest.mark.parametrize("name", sorted(SHAPES))
def test_every_shape_that_matlab_knows_round_trips_through_fis(name: str) -> None:
    system = holding(SHAPES[name]("t", *EXAMPLE[name]))
    if not SHAPES[name].fis:
        with pytest.raises(ValueError, match=f"MATLAB has no shape '{name}'"):
            fis_writer.dump(system)
        return
    text = fis_writer.dump(system)
    assert f"'t':'{SHAPES[name].fis}',[" in text
    assert fis.parse(text).inputs == system.inputs
    assert fis.parse(text).outputs[0].terms == system.outputs[0].terms


@pytest.mark.parametrize("name", sorted(set(SHAPES) - {"linear"}))
def test_kernel_and_function_of_every_shape_agree(name: str) -> None:
    term, shape = SHAPES[name]("t", *EXAMPLE[name]), SHAPES[name]
    x = np.concatenate([np.linspace(-0.5, 1.5, 401), [v for v in EXAMPLE[name] if math.isfinite(v)], [1e9, -1e9]])
    lists = np.array(EXAMPLE[name] if shape.listed else [0.0])
    p = np.array([*(() if shape.listed else EXAMPLE[name]), 0.0, 0.0, 0.0, 0.0][:4] + [1.0])
    mine = [member(shape.code, p, v, lists, 0, lists.size // 2) for v in x]
    assert_allclose(mine, term.membership(x), rtol=1e-12, atol=1e-15)
    if shape.monotone:
        for strength in (0.3, 0.6, 0.9):
            at = inverse_member(shape.code, p, strength)
            assert_allclose(term.membership(at), strength, atol=1e-9)


def test_a_whole_system_uses_the_kernel_of_its_shape() -> None:
    for name in set(SHAPES) - set(CONCLUSIONS):
        term = SHAPES[name]("t", *EXAMPLE[name])
        x = np.linspace(-0.2, 1.2, 57)
        firing = holding(term).evaluate(x).firing[:, 0]
        assert_allclose(firing, term.membership(x), rtol=1e-12, atol=1e-15, err_msg=name)


@pytest.mark.parametrize(("table", "kernel"), [(NORMS, norm), (CONORMS, conorm)])
def test_kernel_and_function_of_every_operator_agree(table: dict, kernel: object) -> None:
    assert sorted(row.code for row in table.values()) == list(range(len(table)))
    for a in np.linspace(0, 1, 9):
        for b in np.linspace(0, 1, 9):
            for name, row in table.items():
                ours = float(np.asarray(row.function(np.asarray(a), np.asarray(b))))
                assert_allclose(kernel(row.code, a, b), ours, atol=1e-15, err_msg=name)  # type: ignore[operator]


def test_kernel_and_function_of_every_hedge_agree() -> None:
    assert sorted(row.code for row in HEDGES.values()) == list(range(len(HEDGES)))
    for m in np.linspace(0, 1, 33):
        for name, row in HEDGES.items():
            ours = float(np.asarray(row.function(np.asarray(m))))
            assert_allclose(hedged(row.code, m), ours, atol=1e-15, err_msg=name)


@pytest.mark.parametrize("name", list(DEFUZZIFIERS))
def test_every_defuzzifier_operator_and_quadrature_round_trips(name: str) -> None:
    kind = "constant" if name in WEIGHTED else "triangle"
    system = holding(SHAPES[kind]("t", *EXAMPLE[kind]))
    output = replace(system.outputs[0], defuzzifier=name, aggregation="max")
    for quadrature in QUADRATURES if name == "centroid" else ("midpoint",):
        for implication, norm_row in NORMS.items():
            if quadrature == "exact" and implication not in ("min", "product"):
                continue
            changed = replace(
                system,
                outputs=(replace(output, quadrature=quadrature),),
                blocks=(replace(system.blocks[0], conjunction=implication, implication=implication),),
            )
            assert fll.parse(fll_writer.dump(changed)) == changed
            if norm_row.fis:
                back = fis.parse(fis_writer.dump(changed))
                assert (back.outputs[0].defuzzifier, back.outputs[0].quadrature) == (name, quadrature)
                assert back.blocks[0].implication == implication


def test_every_disjunction_round_trips() -> None:
    system = holding(triangle("t", 0, 0.5, 1))
    for name, row in CONORMS.items():
        changed = replace(
            system,
            outputs=(replace(system.outputs[0], aggregation=name),),
            blocks=(replace(system.blocks[0], disjunction=name),),
        )
        assert fll.parse(fll_writer.dump(changed)) == changed
        if row.fis:
            assert fis.parse(fis_writer.dump(changed)).blocks[0].disjunction == name


def test_codes_of_one_kind_are_distinct() -> None:
    assert codes.WEIGHTED_SUM == len(DEFUZZIFIERS) - 1
    assert sorted(row.code for row in DEFUZZIFIERS.values()) == list(range(len(DEFUZZIFIERS)))
    assert sorted(QUADRATURES.values()) == list(range(len(QUADRATURES)))


def test_a_robot_that_uses_fuzzy_systems_needs_no_matplotlib() -> None:
    program = (
        "import sys; from fuzzynav.fuzzy import FuzzySystem; "
        "print(sorted({'matplotlib', 'networkx', 'skfuzzy'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_the_files_are_bound_to_the_class_by_the_face() -> None:
    assert FuzzySystem.load is fuzzy.disk.load
    assert FuzzySystem.save is fuzzy.disk.save
    for name in ("load", "save", "to_skfuzzy", "from_skfuzzy"):
        assert getattr(FuzzySystem, name).__doc__
