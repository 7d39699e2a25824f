"""What a notebook asks for: sources, hints, solutions, and the answers to the questions of the labs."""

import json
import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from fuzzynav import course, geometry, robot
from fuzzynav.course import reader
from fuzzynav.course.answers.answer import Answer
from fuzzynav.course.folders import notebooks_of

HOME = Path(__file__).parents[2]
EXERCISES = course.all_exercises()
ANSWERS = course.all_answers()
NOTEBOOKS = [p for p in notebooks_of(HOME) if not p.name.startswith("00")]
QUESTION = re.compile(r"course\.answer\(\"([^\"]+)\"\)")


def cells_of(path):
    return json.loads(path.read_text(encoding="utf-8"))["cells"]


def text(cell):
    return "".join(cell["source"])


# --- sources ------------------------------------------------------------------------------------


def test_a_source_is_titled_with_its_file_and_its_name():
    assert reader.source_of(robot.move).title == "fuzzynav/robot/kinematics.py: move"
    assert reader.source_of(robot.move, robot.body_speeds).title == "fuzzynav/robot/kinematics.py: move, body_speeds"
    assert reader.source_of(geometry).title == "fuzzynav/geometry.py"
    assert reader.source_of(course).title == "fuzzynav/course/__init__.py"
    both = reader.source_of(geometry.wrap, robot.move).title
    assert both == "fuzzynav/geometry.py: wrap; fuzzynav/robot/kinematics.py: move"
    for title in (reader.source_of(robot.move).title, both):
        for file in re.findall(r"fuzzynav/[\w/]+\.py", title):
            assert (HOME / file).is_file()


def test_the_source_is_the_installed_one():
    shown = reader.source_of(robot.move)
    assert "def move(" in repr(shown)
    assert repr(shown).startswith("# fuzzynav/robot/kinematics.py: move\n")
    assert shown._repr_markdown_().count("```python") == 1
    assert "class Robot" in repr(reader.source_of(robot.Robot))
    assert "import numpy" in repr(reader.source_of(geometry))


def test_a_compiled_function_shows_what_was_compiled():
    from fuzzynav.maps import kernels

    compiled = next(v for v in vars(kernels).values() if hasattr(v, "py_func"))
    assert f"def {compiled.__name__}(" in repr(reader.source_of(compiled))
    assert reader.source_of(compiled).title == f"fuzzynav/maps/kernels.py: {compiled.__name__}"


@pytest.mark.parametrize("thing", [3.0, robot.THESIS, len])
def test_show_says_what_has_no_source(thing):
    with pytest.raises(ValueError, match="source to show"):
        course.show(thing)


def test_show_says_what_it_needs():
    with pytest.raises(ValueError, match="say what to show"):
        course.show()


@pytest.fixture(scope="module")
def small_notebook():
    """Four cells that show, ask and answer, run in a kernel of their own."""
    sources = [
        "from fuzzynav import course, geometry, robot",
        "course.show(geometry.wrap)\nprint('between')\ncourse.show(robot.move, robot.body_speeds)\nx = 3",
        "for thing in (geometry.wrap, geometry.compose):\n    course.show(thing)",
        f'course.answer("{next(iter(ANSWERS))}")',
        'course.hint("01.1")\ncourse.hint("01.1", 9)',
    ]
    book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(s) for s in sources])
    NotebookClient(book, kernel_name="python3", timeout=120, store_widget_state=False).execute()
    return [cell.outputs for cell in book.cells]


def test_show_displays_wherever_it_stands_in_a_cell(small_notebook):
    first = small_notebook[1]
    assert [o.output_type for o in first] == ["display_data", "stream", "display_data"]
    assert "fuzzynav/geometry.py: wrap" in first[0].data["text/markdown"]
    assert "fuzzynav/robot/kinematics.py: move, body_speeds" in first[2].data["text/markdown"]
    assert ["text/markdown" in o.data for o in small_notebook[2]] == [True, True]


def test_show_as_the_last_line_shows_once(capsys):
    assert course.show(geometry.wrap) is None
    assert capsys.readouterr().out.count("def wrap(") == 1


def test_an_answer_is_displayed_folded_and_a_hint_only_when_asked(small_notebook):
    (shown,) = small_notebook[3]
    assert shown.data["text/html"].startswith("<details><summary>Answer</summary>")
    assert shown.data["text/plain"].startswith("Answer: ")
    (said,) = small_notebook[4]
    assert said.data["text/plain"].startswith("Exercise 01.1 has the hints 1 to 3, not 9")


@pytest.mark.parametrize("path", notebooks_of(HOME), ids=lambda p: p.stem)
def test_every_call_of_show_left_its_source_in_the_notebook(path):
    for cell in cells_of(path):
        calls = len(re.findall(r"(?m)^ *course\.show\(", text(cell))) if cell["cell_type"] == "code" else 0
        if calls:
            shown = [o for o in cell["outputs"] if "text/markdown" in o.get("data", {})]
            assert len(shown) == calls, f"{calls} calls, {len(shown)} sources: {text(cell)[:80]}"
            for output in shown:
                assert re.match(r"`fuzzynav/[\w/]+\.py", "".join(output["data"]["text/markdown"]))


# --- hints and solutions ------------------------------------------------------------------------


@pytest.mark.parametrize("name", EXERCISES)
def test_hints_lead_on_and_the_one_that_is_not_there_is_said(name):
    hints = EXERCISES[name].hints
    for number in range(1, len(hints) + 1):
        assert repr(course.hint(name, number)).startswith(f"Hint {number} of {len(hints)}")
    for number in (0, len(hints) + 1, "2", None, 1.5):
        said = repr(course.hint(name, number))
        assert said.startswith(f"Exercise {name} has the hint")
        assert f'course.solution("{name}")' in said
        assert not any(h in said for h in hints)


def test_an_unknown_exercise_is_told_the_ones_of_its_chapter():
    for said in (repr(course.hint("01.9")), repr(course.solution("01.9"))):
        assert said == "there is no exercise '01.9'; there are: 01.1, 01.2, 01.3, 01.4, 01.5"
    with pytest.raises(ValueError, match=r"no exercise '77\.7'"):
        course.check("77.7", 1)


def test_an_edition_without_solutions_says_what_that_means(monkeypatch):
    monkeypatch.setattr(reader, "solutions_folder", lambda: None)
    said = repr(course.solution("05.1"))
    assert "students' edition" in said
    assert "Ask your teacher" in said
    assert 'course.hint("05.1")' in said


@pytest.mark.parametrize("path", notebooks_of(HOME), ids=lambda p: p.stem)
def test_no_notebook_gives_a_hint_or_a_solution_unasked(path):
    for cell in cells_of(path):
        if cell["cell_type"] == "code":
            assert not re.search(r"(?m)^[^#]*course\.(hint|solution)\(", text(cell)), text(cell)[:80]
            stored = json.dumps(cell["outputs"], ensure_ascii=False)
            assert not re.search(r"Hint \d of \d", stored)


# --- answers to the questions of the labs ---------------------------------------------------------


def questions(path):
    """The cells of a notebook that open a lab, with the cells until the next one."""
    cells = cells_of(path)
    labs = [
        k
        for k, c in enumerate(cells)
        if c["cell_type"] == "code" and re.search(r"lab\.(Panel|Player|Paint)\(", text(c))
    ]
    return [(text(cells[k]), cells[k + 1 : k + 3]) for k in labs]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_the_answer_stands_folded_below_the_question_of_every_lab(path):
    found = questions(path)
    assert found
    asked = []
    for source, below in found:
        if re.search(r"first=0|teaser|plot\.run_player", source):
            continue  # it is shown, not asked about
        names = [n for c in below if c["cell_type"] == "code" for n in QUESTION.findall(text(c))]
        assert len(names) == 1, f"no course.answer below {source[:60]}"
        asked += names
    assert len(asked) == len(set(asked))


def test_each_answer_belongs_to_one_question():
    asked = [n for path in notebooks_of(HOME) for c in cells_of(path) for n in QUESTION.findall(text(c))]
    assert sorted(asked) == sorted(ANSWERS)


@pytest.mark.parametrize("name", ANSWERS)
def test_an_answer_is_a_few_plain_sentences(name):
    words = ANSWERS[name].words()
    assert 15 <= len(words.split()) <= 120
    assert words.endswith(".")
    assert not re.search(r"\bnan\b|\d\.\d{5}|[<>]=?\s*$", words), words
    assert ANSWERS[name].words() == words
    assert repr(course.answer(name)) == f"Answer: {words}"


def test_an_unknown_answer_is_told_the_near_ones():
    assert repr(course.answer("06.lab99")).startswith("there is no answer '06.lab99'; there are: 06.lab1")
    assert "there are: 06.lab1" in repr(course.answer("06.lb1"))


@pytest.mark.parametrize("wrong", [{"id": "6.lab1"}, {"id": "06.1"}, {"text": ""}])
def test_an_answer_is_complete(wrong):
    with pytest.raises(ValueError, match="answer"):
        Answer(**{"id": "06.lab1", "text": "Yes.", **wrong})


def test_an_answer_is_escaped_and_computed():
    found = Answer("06.lab1", lambda: f"At {0.5:.1f} m\n   v < {2} & more.")
    assert found.words() == "At 0.5 m v < 2 & more."
    assert found.folded()._repr_html_().endswith("At 0.5 m v &lt; 2 &amp; more.</details>")
