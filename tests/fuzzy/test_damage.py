"""Damaged files, files that ask for too much, calls without meaning: one sentence with file and line, or a system."""

import math
import os
import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fuzzynav.fuzzy import (
    SHAPES,
    And,
    FuzzySystem,
    Proposition,
    Rule,
    RuleBlock,
    Term,
    Variable,
    bell,
    constant,
    discrete,
    gaussian,
    linear,
    sigmoid,
    triangle,
)
from fuzzynav.fuzzy.files import disk
from fuzzynav.fuzzy.variable import MAX_RESOLUTION, MAX_SAMPLES
from tests.fuzzing import damages

DATA = Path(__file__).parents[2] / "data" / "fuzzy"
SEEDS = 300


def small(**output: object) -> FuzzySystem:
    x = Variable(name="x", low=0, high=10, terms=(triangle("low", 0, 0, 10), triangle("high", 0, 10, 10)))
    fields = {"terms": (triangle("small", 0, 0, 0.5), triangle("big", 0.5, 1, 1)), **output}
    y = Variable(name="y", low=0, high=1, **fields)  # type: ignore[arg-type]
    rules = ("if x is low then y is small", "if x is high then y is big with 0.5")
    return FuzzySystem(name="small", inputs=(x,), outputs=(y,), blocks=(RuleBlock(name="rules", rules=rules),))


def sources(tmp_path: Path, suffix: str) -> list[bytes]:
    """Shipped rule bases in the format, and one of a Takagi-Sugeno kind."""
    systems = [FuzzySystem.load(DATA / f"{name}.fll") for name in ("fuzzy_planner_table_i", "thesis_table_5_1")]
    crisp = small(terms=(constant("small", 0.25), linear("big", 0.5, 1.0)), defuzzifier="weighted average")
    for k, system in enumerate((*systems, crisp)):
        system.save(tmp_path / f"{k}{suffix}")
    return [(tmp_path / f"{k}{suffix}").read_bytes() for k in range(3)]


@pytest.mark.parametrize("suffix", [".fll", ".fis"])
def test_a_damaged_file_gives_a_system_or_one_sentence_with_its_line(suffix: str, tmp_path: Path) -> None:
    texts, path = sources(tmp_path, suffix), tmp_path / f"damaged{suffix}"
    said, loaded = [], 0
    for seed in range(SEEDS):
        path.write_bytes(damages(texts[seed % 3], np.random.default_rng(seed)))
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                system = FuzzySystem.load(path)
            except ValueError as error:
                said.append(str(error))
            else:
                system(*[0.3] * len(system.inputs))
                loaded += 1
    assert [words for words in said if not re.match(rf"{re.escape(str(path))}, line \d+", words)] == []
    assert len(said) > 100
    assert loaded > 5


# ---------------------------------------------------------------- files that ask for too much


def fll_with(tmp_path: Path, old: str, new: str, suffix: str = ".fll") -> Path:
    path = tmp_path / f"bad{suffix}"
    small().save(path)
    text = path.read_text(encoding="utf-8")
    assert old in text
    path.write_text(text.replace(old, new, 1), encoding="utf-8")
    return path


def test_the_resolution_has_a_limit_that_the_file_is_held_to(tmp_path: Path) -> None:
    assert FuzzySystem.load(fll_with(tmp_path, "Centroid 101", f"Centroid {MAX_RESOLUTION}"))(2.0)[0] < 0.5
    for wrong in (MAX_RESOLUTION + 1, 10**9):
        path = fll_with(tmp_path, "Centroid 101", f"Centroid {wrong}")
        with pytest.raises(
            ValueError, match=rf"bad\.fll, line \d+, defuzzifier: .* to {MAX_RESOLUTION}, got '{wrong}'"
        ):
            FuzzySystem.load(path)
        path = fll_with(tmp_path, "NumMFs=2\nMF1='small'", f"%! resolution: {wrong}\nNumMFs=2\nMF1='small'", ".fis")
        with pytest.raises(ValueError, match=rf"bad\.fis, line \d+, %! resolution: .* to {MAX_RESOLUTION}"):
            FuzzySystem.load(path)


def test_all_sets_of_an_output_together_have_a_limit_too(tmp_path: Path) -> None:
    n = MAX_SAMPLES // MAX_RESOLUTION + 1
    terms = "".join(f"  term: t{k} Triangle 0 0.5 1\n" for k in range(n))
    path = fll_with(tmp_path, "  term: small", f"{terms}  term: small")
    path.write_text(path.read_text().replace("Centroid 101", f"Centroid {MAX_RESOLUTION}"))
    with pytest.raises(ValueError, match=rf"bad\.fll, line \d+, OutputVariable: .* more than {MAX_SAMPLES}; lower"):
        FuzzySystem.load(path)
    rules = ("if x is low then y is small",) * n
    wide = small(resolution=MAX_RESOLUTION)
    with pytest.raises(ValueError, match=f"conclusions of {MAX_RESOLUTION} samples.*more than {MAX_SAMPLES}"):
        replace(wide, blocks=(RuleBlock(rules=rules),))


def test_a_file_that_is_too_long_is_refused_with_its_line(tmp_path: Path) -> None:
    path = tmp_path / "long.fll"
    path.write_bytes(b"# x\n" * (disk.MAX_BYTES // 4 + 1))
    with pytest.raises(ValueError, match=r"long\.fll, line \d+: larger than 1000000 bytes"):
        FuzzySystem.load(path)


@pytest.mark.parametrize("suffix", [".fll", ".fis"])
def test_a_byte_order_mark_is_no_part_of_the_text(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"x{suffix}"
    small().save(path)
    plain = FuzzySystem.load(path)
    path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes())
    assert FuzzySystem.load(path) == plain
    path.write_bytes(b"\xff\xfe" + "Engine: x".encode("utf-16-le"))
    with pytest.raises(ValueError, match=rf"x{suffix}, line 1: not UTF-8 text"):
        FuzzySystem.load(path)


@pytest.mark.parametrize("digits", ["٣", "1_0", "0x1"])
def test_numbers_are_written_in_ascii(digits: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"bad\.fll, line \d+, range: expected a number"):
        FuzzySystem.load(fll_with(tmp_path, "range: 0 10", f"range: 0 {digits}"))


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("low Triangle 0 0 10", "low Triangle 0 0 10 5", "height must be above 0 and at most 1, got 5"),
        ("low Triangle 0 0 10", "low Discrete 0 1 5 1.5", "memberships from 0 to 1, got 1.5"),
        ("low Triangle 0 0 10", "low Gaussian 0 1e-200", "sigma > 0, and at least 1e-150"),
        ("low Triangle 0 0 10", "low Gaussian 1e200 1", "numbers from -1e"),
        ("low Triangle 0 0 10", "low Constant 0.5", "has no membership"),
        ("small Triangle 0 0 0.5", "small Constant 0.5", "has no area"),
        ("  term: small Triangle 0 0 0.5\n  term: big Triangle 0.5 1 1\n", "", "has no terms"),
        ("range: 0 10", "range: -1e200 10", "must stay within"),
        ("OutputVariable: y", "OutputVariable: x", "used twice"),
        ("Engine: small\n", "Engine: small\n  #! source: \"x\n", "JSON string"),
    ],
)  # fmt: skip
def test_what_has_no_meaning_is_refused_with_its_line(old: str, new: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=rf"bad\.fll, line \d+, .*{words}"):
        FuzzySystem.load(fll_with(tmp_path, old, new))


# ---------------------------------------------------------------- saving


def test_a_missing_folder_and_a_closed_one_are_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(FileNotFoundError, match=r"x\.fll: the folder .*nowhere does not exist"):
        small().save(tmp_path / "nowhere" / "x.fll")
    (tmp_path / "x.fis").mkdir()
    with pytest.raises(IsADirectoryError, match=r"x\.fis: there is a folder of that name"):
        small().save(tmp_path / "x.fis")
    small().save(tmp_path / "y.fll")

    def closed(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("builtins.open", closed)
    with pytest.raises(PermissionError, match=r"x\.fll: the folder .* may not be written to"):
        small().save(tmp_path / "x.fll")
    with pytest.raises(PermissionError, match=r"y\.fll: the file may not be read"):
        FuzzySystem.load(tmp_path / "y.fll")
    monkeypatch.undo()
    assert sorted(os.listdir(tmp_path)) == ["x.fis", "y.fll"]


def test_rule_blocks_with_equal_operators_become_one_in_a_fis(tmp_path: Path) -> None:
    one = small()
    extra = RuleBlock(name="more", rules=("if x is high then y is small with 0.25",))
    two = replace(one, blocks=(*one.blocks, extra))
    two.save(tmp_path / "x.fis")
    back = FuzzySystem.load(tmp_path / "x.fis")
    assert back.rules == two.rules
    assert [block.name for block in back.blocks] == ["rules and more"]
    x = np.linspace(0, 10, 41)
    np.testing.assert_array_equal(back(x)[0], two(x)[0])
    for what in ({"conjunction": "product"}, {"disjunction": "sum"}, {"implication": "product"}):
        other = replace(one, blocks=(*one.blocks, replace(extra, **what)))  # type: ignore[arg-type]
        with pytest.raises(ValueError, match=f"differ in their {next(iter(what))}"):
            other.save(tmp_path / "y.fis")


# ---------------------------------------------------------------- calls without meaning


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: Rule(None), "must be a Proposition, And or Or, got None; Rule.parse"),
        (lambda: Rule("if x is low then y is big"), "Rule.parse reads a rule in words"),
        (lambda: Rule(Proposition(variable="x", term="a")), "consequents of the form"),
        (lambda: Rule(Proposition(variable="x", term="a"), consequents=None), "consequents of the form"),
        (lambda: replace(small().rules[0], weight=None), "from 0 to 1, got None"),
        (lambda: replace(small().rules[0], weight=math.nan), "from 0 to 1"),
        (lambda: Rule.parse(None), "a rule must be text"),
        (lambda: And(parts=None), "joins two or more"),
        (lambda: Proposition(variable=None, term="a"), "variable name None must be one word"),
        (lambda: Proposition(variable="x", term="a", hedges="not"), "tuple of words"),
        (lambda: RuleBlock(rules=None), "expected a tuple of Rule"),
        (lambda: RuleBlock(rules="if x is low then y is big"), "expected a tuple of Rule"),
        (lambda: Variable(name="x", low=0, high=1, terms=None), "terms: expected a tuple of Term, got None"),
        (lambda: Variable(name="x", low=0, high=1, terms=("low",)), "terms: expected a tuple of Term, got one with"),
        (lambda: replace(small(), inputs=None), "inputs: expected a tuple of Variable"),
        (lambda: replace(small(), blocks=small().rules), "blocks: expected a tuple of RuleBlock"),
        (lambda: replace(small(), name=7), "name of a fuzzy system must be text"),
        (lambda: small(terms=()), "output 'y' has no terms"),
        (lambda: small(terms=(constant("small", 0.5), constant("big", 0.5))), "has no area"),
        (lambda: small(defuzzifier=None), "defuzzifier: got None; known: centroid"),
        (lambda: triangle("T", 0, 1, 2, height=5), "at most 1, got 5"),
        (lambda: triangle("T", 0, 1, 2, height=None), "height must be numbers"),
        (lambda: discrete("T", 0, 0, 1, 1.5), "memberships from 0 to 1, got 1.5"),
        (lambda: discrete("T", 0, -0.1, 1, 1), "memberships from 0 to 1, got -0.1"),
        (lambda: gaussian("T", 0, 1e-200), "at least 1e-150, got 1e-200"),
        (lambda: gaussian("T", 0, 1e200), "numbers from -1e.150 to 1e.150"),
        (lambda: bell("T", 0, 1e-300, 2), "width other than 0"),
        (lambda: SHAPES["semi-ellipse"]("T", 0, 5e-324), "width other than 0"),
        (lambda: Term(name="T", shape="triangle", parameters=(0, 1, 10**400)), "must be numbers"),
        (
            lambda: small(terms=(sigmoid("small", 0, 0), sigmoid("big", 0, 1)), defuzzifier="weighted average"),
            "slope 0 neither rises nor falls",
        ),
        (
            lambda: replace(small(quadrature="exact"), blocks=(replace(small().blocks[0], implication="einstein"),)),
            "'exact' is for implication min or product",
        ),
    ],
)
def test_a_call_without_meaning_is_one_sentence(call, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        call()


def test_an_input_that_only_a_linear_conclusion_uses_needs_no_terms() -> None:
    terms = (linear("plane", 2.0, -1.0, 0.5),)
    y = Variable(name="y", low=-9, high=9, terms=terms, defuzzifier="weighted average")
    bare = Variable(name="z", low=0, high=1, terms=())
    system = replace(small(), inputs=(small().inputs[0], bare), outputs=(y,), blocks=(
        RuleBlock(rules=("if x is low then y is plane",)),))  # fmt: skip
    assert system(3.0, 0.25) == (2.0 * 3.0 - 0.25 + 0.5,)
    assert system.evaluate([1.0, 2.0], 0.5).memberships["z"].shape == (2, 0)
    assert system.uncovered(5).missing == (("high",),)
    with pytest.raises(ValueError, match="variable 'z' has no term 'a'; known: none"):
        system.with_terms({("z", "a"): (1.0,)})


@pytest.mark.parametrize("name", sorted(set(SHAPES) - {"linear"}))
def test_no_shape_warns_far_out_or_at_its_narrowest(name: str) -> None:
    narrow = {
        "triangle": (0, 0, 5e-324), "trapezoid": (0, 5e-324, 5e-324, 1e-323), "gaussian": (0, 1e-150),
        "two-sided gaussian": (0, 1e-150, 0, 1e-150), "bell": (0, 1e-150, -9), "sigmoid": (0, 1e150),
        "sigmoid difference": (0, 1e150, 1e150, 0), "sigmoid product": (0, 1e150, -1e150, 0), "z": (0, 5e-324),
        "s": (0, 5e-324), "pi": (0, 5e-324, 5e-324, 1e-323), "ramp": (0, 5e-324), "rectangle": (0, 0),
        "singleton": (0,), "binary": (0, math.inf), "constant": (0.5,), "discrete": (0, 0, 5e-324, 1),
        "spike": (0, 1e-150), "cosine": (0, 1e-150), "concave": (0, 1e-150), "arc": (0, 5e-324),
        "semi-ellipse": (0, 1e-150),
    }[name]  # fmt: skip
    x = np.array([-math.inf, -1e308, -1.0, 0.0, 5e-324, 1.0, 1e308, math.inf])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        mu = SHAPES[name]("T", *narrow).membership(x)
    assert ((mu >= 0.0) & (mu <= 1.0)).all(), mu
