"""Every exercise has a table of answers: right ones pass, each wrong one hears the sentence that names its mistake."""

import ast
import importlib.util
import re
import warnings
from decimal import Decimal
from fractions import Fraction
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import sympy

from fuzzynav import course, tracking
from fuzzynav.course import Wrong
from fuzzynav.course.exercise import judge
from fuzzynav.course.exercises import answers

HOME = Path(__file__).parents[2]
TABLES = sorted((Path(__file__).parent / "answers").glob("ch*.py"))
EXERCISES = course.all_exercises()
CHECKS = sorted((HOME / "fuzzynav/course/exercises").glob("ch*.py"))


def load(path):
    spec = importlib.util.spec_from_file_location(f"answers_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


MODULES = [load(path) for path in TABLES]
RIGHT = {name: rows for module in MODULES for name, rows in module.RIGHT.items()}
WRONG = {name: rows for module in MODULES for name, rows in module.WRONG.items()}


@cache
def said(name, mistake):
    """The sentence that a wrong answer gets; no warning may come with it."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return judge(EXERCISES[name], WRONG[name][mistake][0])


def test_every_exercise_has_a_table():
    assert set(RIGHT) == set(WRONG) == set(EXERCISES)
    for name in EXERCISES:
        assert len(RIGHT[name]) >= 3, f"{name}: three right answers of different form"
        assert len(WRONG[name]) >= 5, f"{name}: five plausible wrong answers"


@pytest.mark.parametrize(("name", "form"), [(name, form) for name in RIGHT for form in RIGHT[name]])
def test_a_right_answer_of_any_form_passes(name, form):
    outcome = judge(EXERCISES[name], RIGHT[name][form])
    assert outcome.points == EXERCISES[name].points, outcome.sentence
    assert outcome.sentence.startswith(f"Exercise {name}: right.")


@pytest.mark.parametrize(("name", "mistake"), [(name, mistake) for name in WRONG for mistake in WRONG[name]])
def test_a_wrong_answer_is_refused_with_its_own_sentence(name, mistake):
    outcome, words = said(name, mistake), WRONG[name][mistake][1]
    assert outcome.points == 0
    assert words in outcome.sentence, outcome.sentence
    assert "\n" not in outcome.sentence
    assert len(outcome.sentence) < 400
    assert not re.search(r"\bnumpy\.|np\.(float|int|bool|str|array)|array\(|\d\.\d{9}", outcome.sentence), (
        outcome.sentence
    )
    others = [m for m in WRONG[name] if m != mistake and words in said(name, m).sentence]
    assert not others, f"{others} hear the same words: {words}"


def templates(path):
    """The sentences with which a file of checks can refuse, as patterns, with their lines; hints are none."""
    found = []
    for top in ast.parse(path.read_text(encoding="utf-8")).body:
        for node in ast.walk(top) if isinstance(top, ast.FunctionDef) else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Wrong":
                found.append((node.lineno, pattern(node.args[0])))
            elif isinstance(node, ast.Tuple) and pattern(node.elts[-1]).endswith(r"\."):
                found.append((node.lineno, pattern(node.elts[-1])))
    return [(line, text) for line, text in found if text]


def pattern(node):
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return re.escape(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(re.escape(p.value) if isinstance(p, ast.Constant) else ".*" for p in node.values)
    return ""


@pytest.mark.parametrize("path", CHECKS, ids=lambda p: p.stem)
def test_every_sentence_of_refusal_is_heard_by_some_wrong_answer(path):
    heard = [said(name, mistake).sentence for name in WRONG for mistake in WRONG[name] if path.stem[2:4] == name[:2]]
    sentences = templates(path)
    assert len(sentences) >= 10
    unheard = [f"line {line}: {text}" for line, text in sentences if not any(re.search(text, s) for s in heard)]
    print(f"{path.name}: {len(sentences) - len(unheard)} of {len(sentences)} sentences of refusal are heard")
    assert not unheard, "\n".join(unheard)


# --- is this a number, a row of n numbers, whole, yes or no ---------------------------------------


@pytest.mark.parametrize(
    "value",
    [2, 2.0, True + 1, np.float32(2), np.int8(2), np.uint8(2), np.array(2), [2], (2,), [[2]], {2}, sympy.Integer(2),
     sympy.sqrt(4), sympy.Float("2"), sympy.Matrix([2]), sympy.FiniteSet(2), Fraction(2), Decimal(2)],
)  # fmt: skip
def test_a_number_may_come_in_any_form(value):
    assert answers.number(value, "It") == 2.0
    assert answers.integers(value, 1, "It") == [2]


@pytest.mark.parametrize(
    "value",
    [(1, 2), [1.0, 2], np.array([[1], [2]]), sympy.Matrix([1, 2]), (sympy.Integer(1), np.float64(2)), range(1, 3)],
)
def test_a_row_may_come_in_any_form(value):
    assert answers.numbers(value, 2, "They").tolist() == [1.0, 2.0]
    assert answers.integers(value, 2, "They") == answers.integers(value, -1, "They") == [1, 2]


@pytest.mark.parametrize("value", [True, np.bool_(True), 1, 1.0, [True], np.array(True), sympy.true])
def test_yes_may_come_in_any_form(value):
    assert answers.truth(value, "It") is True


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: answers.number("2", "The speed"), "The speed should be one number, not a text."),
        (lambda: answers.number(["2"], "The speed"), "The speed should be one number, not a text."),
        (lambda: answers.number(None, "The speed"), "The speed should be one number, not None."),
        (lambda: answers.number(True, "The speed"), "The speed should be one number, not True or False."),
        (lambda: answers.number(1 + 0j, "The speed"), "The speed should be one number, not a complex number."),
        (lambda: answers.number(sympy.I, "The speed"), "The speed should be one number, not a value of the kind Imag"),
        (lambda: answers.number(sympy.Symbol("v"), "The speed"), "The speed should be one number, not a value of the"),
        (lambda: answers.number({"v": 2}, "The speed"), "The speed should be one number, not a dict."),
        (lambda: answers.number(abs, "The speed"), "The speed should be one number, not a function."),
        (lambda: answers.number([], "The speed"), "The speed should be one number; yours holds no numbers."),
        (lambda: answers.number((1, 2), "The speed"), "The speed should be one number; yours holds two numbers."),
        (lambda: answers.numbers([1] * 9, 2, "Both"), "Both should be two numbers; yours holds 9 numbers."),
        (lambda: answers.numbers([1, [2]], 2, "Both"), "Both should be two numbers, not rows of different lengths."),
        (lambda: answers.numbers({1, 2}, 2, "Both"), "a set has no order"),
        (lambda: answers.number(float("nan"), "The speed"), "The speed should be finite; yours is nan, no number."),
        (lambda: answers.number(float("inf"), "The speed"), "The speed should be finite; yours is infinite."),
        (lambda: answers.integers(2.5, 1, "The index"), "The index should be whole, yours is 2.5."),
        (lambda: answers.integers([1, 2.5], -1, "The indices"), "The indices should be whole, yours holds 2.5."),
        (
            lambda: answers.array([[1, 2]], (2, 2), "F"),
            "F should be an array of shape (2, 2), yours has the shape (1, 2).",
        ),
        (lambda: answers.array([[1, np.nan]], (-1, 2), "F"), "F should be finite; yours is nan, no number."),
        (lambda: answers.array([1, 2], (3,), "F"), "F should be an array of shape (3,), yours has the shape (2,)."),
        (lambda: answers.array("F", (-1, 2), "F"), "F should be an array of shape (n, 2), not a text."),
        (lambda: answers.truth("True", "The gate"), "The gate should be True or False, not a text."),
        (lambda: answers.truth(None, "The gate"), "The gate should be True or False, not None."),
        (lambda: answers.truth(0.5, "The gate"), "The gate should be True or False, not a value of the kind float."),
    ],
)
def test_what_is_no_answer_is_told_in_one_sentence(call, sentence):
    with pytest.raises(Wrong) as found:
        call()
    assert sentence in str(found.value)


def test_silence_is_a_number_where_it_is_asked_for():
    assert np.isnan(answers.number(np.nan, "The centroid", silent=True))
    with pytest.raises(Wrong, match="finite"):
        answers.number(np.inf, "The centroid", silent=True)


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_matrix_one_percent_off_is_refused(share):
    outcome = judge(EXERCISES["04.1"], lambda theta, v: share * tracking.decoupling(theta, v))
    assert outcome.points == 0
    assert "give the acceleration" in outcome.sentence
