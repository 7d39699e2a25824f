"""Every notebook stands as the course keeps it: executed, small, complete, and on the common plan."""

import ast
import base64
import json
import re
import sys
from functools import cache
from pathlib import Path

import pytest

from fuzzynav import course, published

HOME = Path(__file__).parents[2]
NOTEBOOKS = sorted((HOME / "notebooks").glob("*.ipynb"))
CHAPTERS = [p for p in NOTEBOOKS if not p.name.startswith("00")]  # the start page has no chapter's plan
NUMBERS = sorted({p.name[:2] for p in CHAPTERS})
SECTIONS = [
    "idea",
    "vocabulary",
    "must be true",
    "lab",
    "check yourself",
    "published against reproduced",
    "goes wrong",
    "further reading",
]
PICTURE_LIMIT = 60_000
LIBRARIES = {"filterpy.kalman", "fuzzynav", "matplotlib.pyplot", "numpy", "scipy.optimize", "skfuzzy", "sympy"}
VARIES = re.compile(r"0x[0-9a-f]{6,}|(?<![\w.])/(home|Users|root|tmp|mnt|usr)/|[A-Z]:\\\\|CPU times|Wall time|-0\.0+\b")


@cache
def cells_of(path: Path) -> list[dict]:
    return json.loads(path.read_text(encoding="utf-8"))["cells"]


def code_of(path: Path) -> list[dict]:
    return [cell for cell in cells_of(path) if cell["cell_type"] == "code"]


def text_of(path: Path) -> list[str]:
    return [source(cell) for cell in cells_of(path) if cell["cell_type"] == "markdown"]


def source(cell: dict) -> str:
    return "".join(cell["source"])


def tags(cell: dict, kind: str) -> list[str]:
    return [t.removeprefix(kind + ":") for t in cell["metadata"].get("tags", []) if t.startswith(kind + ":")]


def outputs_of(path: Path) -> list[dict]:
    return [output for cell in code_of(path) for output in cell["outputs"]]


def test_the_course_has_notebooks():
    assert NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_is_stored_executed(path):
    assert [c["execution_count"] for c in code_of(path)] == list(range(1, len(code_of(path)) + 1))
    assert outputs_of(path)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_no_output_fails_warns_or_varies(path):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    assert "widgets" not in notebook["metadata"]
    for output in outputs_of(path):
        assert output["output_type"] != "error"
        assert output.get("name") != "stderr"
        data = output.get("data", {})
        assert not [mime for mime in data if "widget" in mime]
        words = "".join("".join(data[m]) for m in data if m.startswith("text/")) + "".join(output.get("text", []))
        found = VARIES.search(words)
        assert not found, f"an output holds {found and found.group(0)!r}"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_can_be_read_in_one_sitting(path):
    assert len(cells_of(path)) <= 80
    for cell in code_of(path):
        assert source(cell).count("\n") + 1 <= 25, source(cell)[:80]
    for text in text_of(path):
        told = re.sub(r"\$\$.*?\$\$", "", text, flags=re.S)  # a displayed equation is not prose
        prose = [line for line in told.splitlines() if not line.lstrip().startswith("|")]
        words = len(" ".join(prose).split())
        assert words <= 120, f"{words} words: {text[:80]}"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_pictures_are_small(path):
    for output in outputs_of(path):
        picture = output.get("data", {}).get("image/png")
        if picture:
            assert len(base64.b64decode("".join(picture))) <= PICTURE_LIMIT


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_figures_are_shown_and_nothing_gives_a_solution_away(path):
    for cell in code_of(path):
        text = source(cell)
        if re.search(r"plt\.(subplots|figure|subplot_mosaic)\(", text):
            assert text.rstrip().endswith("plt.show()"), text[:80]
        assert not re.search(r"(?m)^[^#]*course\.solution\(", text), text[:80]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_it_imports_only_what_the_course_installs(path):
    for cell in code_of(path):
        for node in ast.walk(ast.parse(source(cell))):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) else []
            for name in names:
                known = name in LIBRARIES or name.split(".")[0] in {"fuzzynav", "skfuzzy", *sys.stdlib_module_names}
                assert known, f"imports {name}"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_links_lead_somewhere(path):
    for text in text_of(path):
        for target in re.findall(r"\]\(([^)#\s]+)[^)]*\)", text):
            if not re.match(r"https?:|mailto:|attachment:", target):
                assert (path.parent / target).exists(), f"{target} is not there"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_items_are_those_of_the_documents(path):
    for cell in cells_of(path):
        for name in tags(cell, "item"):
            assert published.item(name).reproducible != "no", f"{name} cannot be reproduced"


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_cells_have_lasting_names(path):
    names = [cell["id"] for cell in cells_of(path)]
    assert len(names) == len(set(names))


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_it_begins_with_its_promise_and_one_setup_cell(path):
    first = cells_of(path)[0]
    assert source(first).startswith("# ")
    assert re.search(r"after this .{0,20}you can", source(first), re.I)
    setup = source(code_of(path)[0])
    assert "import" in setup
    assert "plot.style()" in setup


@pytest.mark.parametrize("number", NUMBERS)
def test_a_chapter_has_every_section(number):
    heads = []
    for path in CHAPTERS:
        if path.name.startswith(number):
            heads += [h.lower() for text in text_of(path) for h in re.findall(r"(?m)^#+ +(.*)$", text)]
    missing = [name for name in SECTIONS if not any(name in head for head in heads)]
    assert not missing, f"sections missing: {missing}"


@pytest.mark.parametrize("number", NUMBERS)
def test_a_chapter_has_labs_and_its_table(number):
    sources = [source(c) for p in CHAPTERS if p.name.startswith(number) for c in code_of(p)]
    assert any(re.search(r"lab\.(Panel|Player|Paint)\(", s) for s in sources)
    assert any("published.table(" in s for s in sources)
    assert any("course.show(" in s for s in sources)


@pytest.mark.parametrize("number", NUMBERS)
def test_exercises_are_complete(number):
    cells = [c for p in CHAPTERS if p.name.startswith(number) for c in cells_of(p)]
    stubs = [name for cell in cells for name in tags(cell, "exercise")]
    checks = [name for cell in cells for name in tags(cell, "check")]
    defined = [name for name in course.all_exercises() if name.startswith(number)]
    assert stubs == checks == defined
    assert len(defined) >= 3
    everything = "\n".join(source(cell) for cell in cells)
    for name in defined:
        assert f'course.hint("{name}"' in everything
    assert "course.solution(" in everything


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_check_cells_suit_a_grading_program(path):
    for cell in cells_of(path):
        for name in tags(cell, "check"):
            assert re.fullmatch(rf'course\.check\("{re.escape(name)}", .+\)', source(cell).strip(), re.S)
            assert cell["metadata"]["nbgrader"] == {
                "grade": True,
                "grade_id": "check-" + name.replace(".", "-"),
                "locked": True,
                "schema_version": 3,
                "solution": False,
                "task": False,
                "points": course.all_exercises()[name].points,
            }
            said = "".join(cell["outputs"][-1]["data"]["text/plain"])
            assert said == f"Exercise {name}: not answered yet."
        for name in tags(cell, "exercise"):
            assert cell["metadata"]["nbgrader"]["grade_id"] == "exercise-" + name.replace(".", "-")
            assert cell["metadata"]["nbgrader"]["solution"]
            assert "..." in source(cell)


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda p: p.stem)
def test_the_names_of_graded_cells_obey_the_schema_of_nbgrader_3(path):
    names = [cell["metadata"]["nbgrader"]["grade_id"] for cell in cells_of(path) if "nbgrader" in cell["metadata"]]
    assert names
    assert len(names) == len(set(names))
    for name in names:
        assert re.fullmatch(r"[a-zA-Z0-9_\-]+", name), name
