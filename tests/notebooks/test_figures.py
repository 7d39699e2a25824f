"""Every picture of a published figure says which figure and panel it is, and how it came to be; tables print."""

import ast
import itertools
import json
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
WORDS = ("reproduced", "corrected", "ours", "redrawn")
FIGURE = re.compile(r"(\d+\.\d+)([a-z]?)")


@cache
def code_of(path: Path) -> list[dict]:
    return [c for c in json.loads(path.read_text(encoding="utf-8"))["cells"] if c["cell_type"] == "code"]


def items(cell: dict, kind: str) -> list[str]:
    """What follows `item:SOURCE:KIND-` in the tags of a cell."""
    found = (re.fullmatch(rf"item:[^:]+:{kind}-(.+)", tag) for tag in cell["metadata"].get("tags", []))
    return [one.group(1) for one in found if one]


def titles(source: str) -> list[str]:
    """All texts that a cell's code can set as a title, for each literal that its names are bound to."""
    tree = ast.parse(source)
    found: list[str] = []
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        wanted = [k.value for k in call.keywords if k.arg == "title"]
        if isinstance(call.func, ast.Attribute) and call.func.attr in ("set_title", "suptitle"):
            wanted += call.args[:1]
        for expression in wanted:
            found += texts(expression, tree)
    return found


def texts(expression: ast.expr, tree: ast.AST) -> Iterator[str]:
    """The values of an expression for every choice of the literals that its names stand for."""
    names = sorted({node.id for node in ast.walk(expression) if isinstance(node, ast.Name)})
    choices = [sorted(literals(name, tree, frozenset())) or [f"<{name}>"] for name in names]
    code = compile(ast.fix_missing_locations(ast.Expression(expression)), "title", "eval")
    for values in itertools.product(*choices):
        try:
            yield str(eval(code, {"__builtins__": {}}, dict(zip(names, values, strict=True))))
        except (AttributeError, IndexError, TypeError, ValueError):  # a name that holds no text
            yield " ".join(
                n.value for n in ast.walk(expression) if isinstance(n, ast.Constant) and str(n.value) == n.value
            )


def literals(name: str, tree: ast.AST, seen: frozenset[str]) -> set[str]:
    """Texts that a name is bound to by loops and assignments; a text that a loop runs over gives its letters."""
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.For | ast.comprehension):
            target, value = node.target, node.iter
        elif isinstance(node, ast.Assign):
            target, value = node.targets[0], node.value
        else:
            continue
        if name not in {n.id for n in ast.walk(target) if isinstance(n, ast.Name)}:
            continue
        for inner in ast.walk(value):
            if isinstance(inner, ast.Constant) and isinstance(inner.value, str):
                found |= set(inner.value) if re.fullmatch("[a-f]+", inner.value) else {inner.value}
            elif isinstance(inner, ast.Name) and inner.id not in seen | {name}:
                found |= literals(inner.id, tree, seen | {name})
    return found


def complaints(source: str, figures: list[str]) -> list[str]:
    """What the titles of a cell fail to say about the figures it is tagged with."""
    shown, faults = titles(source), []
    for figure in figures:
        number, letter = FIGURE.fullmatch(figure).groups()  # type: ignore[union-attr]
        named = [t for t in shown if re.search(rf"Figures? .*(?<![\d.]){re.escape(number)}(?!\d)", t, re.S)]
        if not named:
            faults.append(f"no title says 'Figure {figure}'")
        elif not any(word in title for title in named for word in WORDS):
            faults.append(f"the title of {figure} has none of the words {', '.join(WORDS)}")
        exact = [t for t in named if re.search(rf"(?<![\d.]){re.escape(figure)}(?![\w])", t)]
        if letter and not exact and not any(t.startswith(f"({letter})") for t in shown):
            faults.append(f"no panel carries the letter of {figure}")
        if exact and not any(word in title for title in exact for word in WORDS):
            faults.append(f"the title of {figure} has none of the words {', '.join(WORDS)}")
    return faults


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_pictures_carry_the_printed_number_and_panel(path):
    faults = [
        f"{cell['id']}: {fault}"
        for cell in code_of(path)
        for fault in complaints("".join(cell["source"]), items(cell, "fig"))
    ]
    assert not faults, "\n".join(faults)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_tables_are_printed(path):
    for cell in code_of(path):
        for table in items(cell, "tab"):
            texts_shown = [
                o for o in cell["outputs"] if o["output_type"] == "stream" or "text/html" in o.get("data", {})
            ]
            assert texts_shown, f"{cell['id']}: the cell of table {table} prints nothing"


@pytest.mark.parametrize(
    ("source", "fault"),
    [
        ("ax.set_title('Figure 3.1, reproduced')", "letter"),
        ("ax.set_title('Figure 3.1a: a path')", "words"),
        ("ax.set_title('a path, reproduced')", "no title"),
        ("ax.set_title('Figure 3.10a, reproduced')", "no title"),
        ("print('Figure 3.1a, reproduced')", "no title"),
        ("for p in 'bc':\n    ax.set_title(f'Figure 3.1{p}, ours')", "letter"),
    ],
)
def test_a_bad_title_is_found(source, fault):
    assert any(fault in one for one in complaints(source, ["3.1a"]))


@pytest.mark.parametrize(
    "source",
    [
        "ax.set_title('Figure 3.1a, ours')",
        "plot.draw(ax, title='Figures 3.2b and 3.1a, redrawn: a path')",
        "for p in 'ab':\n    ax.set_title(f'Figure 3.1{p}, ours')",
        "for name in ('a: one', 'b: two'):\n    ax.set_title(f'({name[0]})')\nfig.suptitle('Figure 3.1a to c, ours')",
        "for title in ('3.1a: one', '3.1b: two'):\n    ax.set(title=f\"Figure {title.replace(':', ', corrected:')}\")",
    ],
)
def test_a_good_title_passes(source):
    assert complaints(source, ["3.1a"]) == []
