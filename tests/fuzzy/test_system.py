"""Rules and their text, validation of systems, the notions of set theory, and the gaps of a rule base."""

import math
import pickle
from dataclasses import FrozenInstanceError, replace
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from numpy.testing import assert_allclose, assert_array_equal

from fuzzynav.fuzzy import And, FuzzySystem, Or, Proposition, Rule, RuleBlock, Term, Variable, sets
from fuzzynav.fuzzy.engine import infer_one
from fuzzynav.fuzzy.operators import HEDGES


def tri(name, *parameters):
    return Term(name=name, shape="triangle", parameters=parameters)


def variable(name, **fields):
    terms = (tri("Low", 0, 0, 0.5), tri("Mid", 0, 0.5, 1), tri("High", 0.5, 1, 1))
    return Variable(**({"name": name, "low": 0, "high": 1, "terms": terms} | fields))


def system(*rules, outputs=None, **block):
    return FuzzySystem(
        name="small",
        inputs=(variable("a"), variable("b")),
        outputs=outputs or (variable("y"),),
        blocks=(RuleBlock(name="block", rules=rules, **block),),
    )


word = st.sampled_from(["a", "b", "c_1", "headGoal"])
proposition = st.builds(
    Proposition, variable=word, term=st.sampled_from(["Low", "Close", "far2"]),
    hedges=st.lists(st.sampled_from(sorted(HEDGES)), max_size=3).map(tuple),
)  # fmt: skip
anything = st.just(Proposition(variable="a", hedges=("any",)))
antecedent = st.recursive(
    proposition | anything,
    lambda inner: st.builds(And, parts=st.lists(inner, min_size=2,
                            max_size=3).map(tuple)) | st.builds(Or, parts=st.lists(inner, min_size=2, max_size=3)),
    max_leaves=8,
)  # fmt: skip


@settings(deadline=None, max_examples=200)
@given(antecedent, st.lists(proposition, min_size=1, max_size=3), st.sampled_from([1.0, 0.5, 0.125]))
def test_rule_text_round_trip(before, after, weight) -> None:
    rule = Rule(antecedent=before, consequents=tuple(after), weight=weight)
    assert Rule.parse(str(rule)) == rule


def test_and_binds_before_or() -> None:
    rule = Rule.parse("if a is Low or b is Mid and b is not very High then y is Low")
    low, mid = Proposition(variable="a", term="Low"), Proposition(variable="b", term="Mid")
    high = Proposition(variable="b", term="High", hedges=("not", "very"))
    assert rule.antecedent == Or(parts=(low, And(parts=(mid, high))))
    grouped = Rule.parse("if (a is Low or b is Mid) and b is not very High then y is Low")
    assert grouped.antecedent == And(parts=(Or(parts=(low, mid)), high))


def test_keywords_in_capitals_as_printed() -> None:
    printed = Rule.parse("IF a IS Low AND b IS High THEN y IS Mid")
    assert str(printed) == "if a is Low and b is High then y is Mid"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a is Low then y is Low", "expected 'if', got 'a'"),
        ("if a Low then y is Low", "expected 'is', got 'Low'"),
        ("if a is Low", "expected 'then', got the end"),
        ("if a is then y is Low", "expected a term, got 'then'"),
        ("if (a is Low then y is Low", r"expected '\)'"),
        ("if a is Low then y is Low with heavy", "weight between 0 and 1, got 'heavy'"),
        ("if a is Low then y is Low with 1.5", "weight of a rule must be from 0 to 1"),
        ("if a is Low then y is Low with nan", "from 0 to 1"),
        ("if a is rather Low then y is Low", "unknown hedge 'rather'"),
        ("if a is Low then y is any", "consequents of the form"),
        ("if a is Low then y is Low or y is Mid", "the end of the rule, got 'or'"),
        ("", "expected 'if', got the end"),
    ],
)
def test_bad_rule_text_is_quoted(text, says) -> None:
    with pytest.raises(ValueError, match=says) as error:
        Rule.parse(text)
    assert text in str(error.value)


def test_unknown_names_in_a_rule_list_the_known_ones() -> None:
    with pytest.raises(ValueError, match="rule 'if a is Near then y is Low': input 'a' has no term 'Near'; known: Low"):
        system("if a is Near then y is Low")
    with pytest.raises(ValueError, match="no input is called 'c'; known: a, b"):
        system("if c is Low then y is Low")
    with pytest.raises(ValueError, match="no output is called 'a'; known: y"):
        system("if a is Low then a is Low")
    with pytest.raises(ValueError, match="output 'y' has no term 'Big'"):
        system("if a is Low then y is Big")


def test_empty_or_doubled_parts_are_refused() -> None:
    with pytest.raises(ValueError, match="no rules"):
        system()
    good = system("if a is Low then y is Low")
    with pytest.raises(ValueError, match="empty rule base"):
        replace(good, blocks=())
    with pytest.raises(ValueError, match="at least one input"):
        replace(good, inputs=())
    with pytest.raises(ValueError, match="two variables have one name"):
        replace(good, outputs=(variable("a"),))
    with pytest.raises(ValueError, match="two terms have one name"):
        variable("y", terms=(tri("Low", 0, 0, 1), tri("Low", 0, 1, 1)))


@pytest.mark.parametrize(
    ("fields", "says"),
    [
        ({"low": 1, "high": 0}, "low < high"),
        ({"resolution": 1}, "resolution"),
        ({"resolution": 10.5}, "resolution"),
        ({"aggregation": "maximum"}, "aggregation: got 'maximum'; known: max"),
        ({"defuzzifier": "cog"}, "known: centroid"),
        ({"quadrature": "simpson"}, "known: trapezoid"),
        ({"name": "two words"}, "one word"),
    ],
)
def test_bad_variables_are_refused(fields, says) -> None:
    with pytest.raises(ValueError, match=says):
        variable(**({"name": "y"} | fields))


@pytest.mark.parametrize(
    ("output", "says"),
    [
        (variable("y", terms=(tri("Low", 0.501, 0.505, 0.509),)), "between two samples.*resolution"),
        (variable("y", terms=(Term(name="Low", shape="singleton", parameters=(0.5,)),)), "no area"),
        (variable("y", defuzzifier="weighted average"), "cannot use term 'Low' \\(triangle\\)"),
        (variable("y", low=-math.inf), "finite range"),
        (variable("y", quadrature="exact", defuzzifier="bisector"), "for the centroid"),
        (variable("y", quadrature="exact", aggregation="probabilistic sum"), "max or sum"),
        (variable("y", quadrature="exact", terms=(Term(name="Low", shape="gaussian", parameters=(0, 1)),)), "straight"),
    ],
)
def test_outputs_that_cannot_be_defuzzified_are_refused(output, says) -> None:
    with pytest.raises(ValueError, match=says):
        system("if a is Low then y is Low", outputs=(output,))


def test_linear_terms_need_a_coefficient_for_each_input() -> None:
    plane = Term(name="Low", shape="linear", parameters=(1.0, 2.0))
    with pytest.raises(ValueError, match="needs 2 coefficients and a constant, got 2"):
        system("if a is Low then y is Low", outputs=(variable("y", terms=(plane,), defuzzifier="weighted average"),))


def test_unknown_operators_of_a_block_are_refused() -> None:
    for field, says in (("conjunction", "min"), ("disjunction", "max"), ("implication", "min")):
        with pytest.raises(ValueError, match=f"block.*{field}: got 'xor'; known: {says}"):
            system("if a is Low then y is Low", **{field: "xor"})
    with pytest.raises(ValueError, match="activation 'highest' is not supported"):
        system("if a is Low then y is Low", activation="highest")


def test_systems_are_values() -> None:
    one, other = system("if a is Low then y is Low"), system("if a is Low then y is Low")
    assert one == other
    assert hash(one) == hash(other)
    one(0.1, 0.2)
    assert one == other
    back = pickle.loads(pickle.dumps(one))
    assert back == one
    assert back(0.1, 0.2) == one(0.1, 0.2)
    with pytest.raises(FrozenInstanceError):
        one.name = "other"
    assert one != replace(one, name="other")


# ---------------------------------------------------------------- notions of set theory

U = np.linspace(0.0, 4.0, 401)
A = tri("A", 0.0, 1.0, 3.0).membership(U)


def test_support_core_cut_and_cardinality_by_hand() -> None:
    assert_allclose([sets.support(U, A).min(), sets.support(U, A).max()], [0.01, 2.99])
    assert_allclose(sets.core(U, A), [1.0])
    cut = sets.alpha_cut(U, A, 0.5)
    assert_allclose([cut.min(), cut.max()], [0.5, 2.0])
    assert_allclose(sets.cardinality(A) * 0.01, 1.5, atol=1e-12)  # the area of the triangle, as the step goes to 0


def test_normal_means_that_the_core_is_not_empty() -> None:
    """The remark under eq 2.30 compares the core, a set, with the number 0. A core {0} shows the difference."""
    at_zero = (U == 0.0).astype(float)
    assert sets.core(U, at_zero).tolist() == [0.0]
    assert sets.is_normal(at_zero)
    assert not sets.is_normal(0.5 * A)
    assert float(sets.height(0.5 * A)) == 0.5


@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
@settings(deadline=None)
def test_cuts_are_nested(alpha, beta) -> None:
    low, high = sorted((alpha, beta))
    assert set(sets.alpha_cut(U, A, high)) <= set(sets.alpha_cut(U, A, low))


def test_alpha_must_be_a_degree() -> None:
    with pytest.raises(ValueError, match="from 0 to 1"):
        sets.alpha_cut(U, A, 1.2)


def test_a_singleton_reading_gives_the_membership_itself() -> None:
    """Eq 2.40 with the reading of eq 2.39 is plain fuzzification."""
    for norm in ("min", "product"):
        assert_allclose(sets.match(A, sets.singleton(U, 2.0), norm), 0.5)


def test_relations_have_one_axis_for_each_universe() -> None:
    a, b, c = np.array([0.2, 1.0]), np.array([0.5, 0.6, 0.7]), np.array([0.4, 0.9])
    assert_allclose(sets.relation(a, c), np.minimum.outer(a, c))
    assert_allclose(sets.relation(a, c, "product"), np.multiply.outer(a, c))
    cube = sets.rule_relation([a, b], [c])
    assert cube.shape == (2, 3, 2)
    for i, j, k in product(range(2), range(3), range(2)):
        assert cube[i, j, k] == min(a[i], b[j], c[k])
    with pytest.raises(ValueError, match="unknown operator"):
        sets.rule_relation([a], [c], "xor")


# ---------------------------------------------------------------- gaps


def test_a_full_rule_base_has_no_gap() -> None:
    terms = ("Low", "Mid", "High")
    full = system(*(f"if a is {p} and b is {q} then y is Low" for p, q in product(terms, terms)))
    gaps = full.uncovered(n=21)
    assert len(gaps) == 0
    assert gaps.missing == ()
    assert gaps.fraction == 0.0
    assert str(gaps) == "every one of 441 points is covered"


def test_the_missing_combination_is_named_and_its_points_found() -> None:
    terms = ("Low", "Mid", "High")
    rules = [f"if a is {p} and b is {q} then y is Low" for p, q in product(terms, terms) if (p, q) != ("Low", "High")]
    gaps = system(*rules).uncovered(n=21)
    assert gaps.missing == (("Low", "High"),)
    assert gaps.inputs == ("a", "b")
    assert_allclose(gaps.points, [[0.0, 1.0]])
    assert "Low, High" in str(gaps)
    wider = system(*rules).uncovered(n=21, below=0.3)
    assert len(wider) > 1
    assert np.isnan(system(*rules)(0.0, 1.0)[0])


def test_an_output_that_no_rule_speaks_of_is_a_gap_everywhere() -> None:
    silent = system("if a is any then y is Low", outputs=(variable("y"), variable("z")))
    assert silent.uncovered(n=5).fraction == 1.0
    y, z = silent(0.3, 0.3)
    assert math.isfinite(y)
    assert math.isnan(z)


def test_gap_search_refuses_what_it_cannot_list() -> None:
    small = system("if a is Low then y is Low")
    with pytest.raises(ValueError, match="at least 2"):
        small.uncovered(n=1)
    with pytest.raises(ValueError, match="at most 5000000"):
        small.uncovered(n=3000)
    endless = replace(small, inputs=(variable("a", high=math.inf), variable("b")))
    with pytest.raises(ValueError, match="no finite range"):
        endless.uncovered()


# ---------------------------------------------------------------- evidence


def test_explain_says_what_happened() -> None:
    small = system("if a is Low and b is Low then y is High", "if a is Mid then y is Low with 0.5")
    text = small.evaluate(0.1, 0.2).explain()
    assert "a = 0.1 is Low to 0.800, Mid to 0.200." in text
    assert "Rule 1 fires with 0.600: if a is Low and b is Low then y is High." in text
    assert "Rule 2 fires with 0.100" in text
    assert "y is Low to 0.100, High to 0.600; its centroid is" in text
    assert "One more rule fires, with 0.100." in small.evaluate(0.1, 0.2).explain(rules=1)
    silent = small.evaluate(1.0, 0.0).explain()
    assert "No rule fires." in silent
    assert "stated default" in silent
    with pytest.raises(ValueError, match="one point"):
        small.evaluate([0.1, 0.2], 0.2).explain()


def test_evidence_has_the_shape_of_the_inputs() -> None:
    small = system("if a is Low and b is Low then y is High", "if a is Mid then y is Low")
    found = small.evaluate(np.linspace(0, 1, 5)[:, None], np.linspace(0, 1, 3))
    assert found.values[0].shape == (5, 3)
    assert found.firing.shape == (5, 3, 2)
    assert found.memberships["a"].shape == (5, 3, 3)
    assert found.aggregated["y"].mu.shape == (5, 3, 101)
    assert_allclose(found.conclusions("y")["Low"], found.firing[..., 1])
    with pytest.raises(ValueError, match="no output is called 'x'"):
        found.conclusions("x")


def test_wrong_number_of_inputs_names_them() -> None:
    small = system("if a is Low then y is Low")
    for call in (small, small.evaluate):
        with pytest.raises(ValueError, match=r"takes 2 inputs \(a, b\), got 1"):
            call(0.5)
        with pytest.raises(ValueError, match="got 3"):
            call(0.5, 0.5, tri("Low", 0, 0, 1))
    with pytest.raises(ValueError, match="has no effect"):
        small(0.5, 0.5, previous=[0.5])
    with pytest.raises(ValueError, match="unknown inference"):
        small.with_inference("max-max")


# ---------------------------------------------------------------- other parameters for some terms


def test_with_terms_moves_what_it_names_and_keeps_the_rest() -> None:
    table = FuzzySystem.load("data/fuzzy/thesis_table_3_2.fll")
    moved = table.with_terms({("distObs", "Close"): (0, 0, 5), ("alpha", "Low"): (0, 0, 0.25)})
    assert moved.inputs[1].term("Close").parameters == (0.0, 0.0, 5.0)
    assert moved.outputs[0].term("Low").parameters == (0.0, 0.0, 0.25)
    assert [t for t in moved.inputs[1].terms if t.name != "Close"] == [
        t for t in table.inputs[1].terms if t.name != "Close"
    ]
    assert (moved.inputs[0], moved.inputs[2], moved.outputs[1:]) == (
        table.inputs[0],
        table.inputs[2],
        table.outputs[1:],
    )
    assert (moved.name, moved.blocks, moved.source) == (table.name, table.blocks, table.source)
    assert table.inputs[1].term("Close").parameters != (0.0, 0.0, 5.0)  # the system itself is as it was
    assert moved(20.0, 6.0, 0.4) != table(20.0, 6.0, 0.4)
    assert table.with_terms({}) == table
    back = moved.with_terms(
        {(v, t): table.inputs[1].term(t).parameters for v, t in [("distObs", "Close")]}
        | {("alpha", "Low"): table.outputs[0].term("Low").parameters}
    )
    assert back == table


def test_with_terms_keeps_shape_height_and_order() -> None:
    terms = (tri("A", 0, 0, 1), Term(name="B", shape="gaussian", parameters=(0.5, 0.1), height=0.5))
    fis = FuzzySystem(
        name="s", inputs=(variable("a", terms=terms),), outputs=(variable("y"),),
        blocks=(RuleBlock(rules=("if a is B then y is Low",)),),
    )  # fmt: skip
    (first, second) = fis.with_terms({("a", "B"): (0.25, 0.2)}).inputs[0].terms
    assert first == terms[0]
    assert second == Term(name="B", shape="gaussian", parameters=(0.25, 0.2), height=0.5)


@pytest.mark.parametrize(
    ("changed", "says"),
    [
        ({("distance", "Low"): (0, 0, 1)}, "'small' has no variable 'distance'; known: a, b, y"),
        ({("a", "Close"): (0, 0, 1)}, "variable 'a' has no term 'Close'; known: Low, Mid, High"),
        ({("a", "Low"): (0, 0)}, r"variable 'a': term 'Low': triangle needs 3 parameters \(a, b, c\), got 2"),
        ({("a", "Low"): (1, 0, 2)}, "variable 'a': term 'Low': triangle needs a <= b <= c"),
        ({("a", "Low"): 3.0}, "variable 'a': term 'Low': parameters must be a list of numbers, got 3.0"),
        ({"a": (0, 0, 1)}, r"named by \(variable, term\), got 'a'"),
    ],
)
def test_with_terms_names_what_does_not_fit(changed, says) -> None:
    with pytest.raises(ValueError, match=says):
        system("if a is Low then y is Low").with_terms(changed)


# ---------------------------------------------------------------- a system inside other compiled code


@pytest.mark.parametrize("name", ["thesis_table_3_2", "thesis_table_5_1", "fuzzy_planner_table_i", "ours_dwa_tuned"])
def test_infer_one_answers_as_the_system_does(name) -> None:
    fis = FuzzySystem.load(f"data/fuzzy/{name}.fll")
    rng = np.random.default_rng(3)
    out = np.empty(len(fis.outputs))
    for _ in range(60):
        point = np.array([rng.uniform(v.low - 0.1, v.high + 0.1) for v in fis.inputs])
        strongest = infer_one(fis.tables, point, out)
        assert_array_equal(out, fis(*point))
        assert strongest == fis.evaluate(*point).firing.max()
    assert math.isnan(infer_one(fis.tables, np.full(len(fis.inputs), math.nan), out))
    assert np.isnan(out).all()


def test_infer_one_is_at_home_in_a_kernel_of_another_room() -> None:
    @njit
    def sweep(tables, places):
        found, out = np.empty(places.size), np.empty(1)
        for k in range(places.size):
            infer_one(tables, np.array([places[k], 0.5]), out)
            found[k] = out[0]
        return found

    fis = system("if a is Low then y is Low", "if a is High and b is Mid then y is High")
    a = np.linspace(0, 1, 21)
    assert_allclose(sweep(fis.tables, a), fis(a, 0.5)[0], rtol=1e-12)


def test_the_tables_of_a_system_cannot_be_written_to() -> None:
    tables = system("if a is Low then y is Low").tables
    for array in tables[1:]:
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0


@pytest.mark.parametrize("n", [1, 2, 63, 64, 65, 100, 127, 128, 129])
def test_every_point_of_a_last_short_block_is_its_own(n) -> None:
    """Points beyond the last full block of 64 must not be mixed up with those before them."""
    fis = system("if a is Low and b is Mid then y is Low", "if a is High then y is High")
    a, b = np.random.default_rng(n).random((2, n))
    b[-1] = math.nan
    values, found = fis(a, b)[0], fis.evaluate(a, b)
    for k in range(n):
        assert_allclose(values[k], fis(a[k], b[k])[0], rtol=1e-12)  # blocks of 1 and of 64 add in another order
        assert_array_equal(found.firing[k], fis.evaluate(a[k], b[k]).firing)
