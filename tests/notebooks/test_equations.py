"""Every equation that a notebook claims to treat stands in it, displayed, with the number it has in its source.

An equation is claimed by the tag `item:thesis:eq-2.11` of a code cell. It is shown by a display `$$ ... \\tag{2.11} $$`
of the same or an earlier text cell. One `\\tag` may hold a list ('2.1, 2.2'), a range ('2.1 to 2.6'), the section of an
equation without a number ('section 1.3.2'), a word on it ('1.24, repaired'), or 'ours' where the thesis prints none.
"""

import json
import re
from pathlib import Path

import pytest

from fuzzynav import published

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
CLAIM = re.compile(r"item:thesis:eq-(.+)")
DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.S)
TAG = re.compile(r"\\tag\{([^{}]*)\}")
NUMBER = re.compile(r"(\d|[A-Z])\.(\d+|[a-z]+)")
RANGE = re.compile(r"(\d|[A-Z])\.(\d+) to (\d|[A-Z])\.(\d+)")
SECTION = re.compile(r"section \d(\.\d+)+")


def numbers(tag: str) -> set[str]:
    """The equations that a tag names, each by its number; a section is named as it stands."""
    found = set()
    for part in (p.strip() for p in tag.split(",")):
        if ends := RANGE.fullmatch(part):
            chapter, first, same, last = ends.groups()
            assert chapter == same and int(first) < int(last), f"a range that cannot be: {part}"
            found |= {f"{chapter}.{n}" for n in range(int(first), int(last) + 1)}
        elif NUMBER.fullmatch(part) or SECTION.fullmatch(part):
            found.add(part)
        else:
            assert not re.search(r"\d", part), f"neither an equation nor a section: {part}"
    return found


def cells(path: Path) -> list[dict]:
    return json.loads(path.read_text(encoding="utf-8"))["cells"]


def text(cell: dict) -> str:
    """The source of a text cell, code in it left out."""
    return re.sub(r"```.*?```|`[^`\n]*`", "", "".join(cell["source"]), flags=re.S)


def missing(notebook: list[dict]) -> list[str]:
    """Names of the claimed equations of which no display stands at or before the cell that claims them."""
    shown: set[str] = set()
    lost = []
    for cell in notebook:
        if cell["cell_type"] == "markdown":
            for display in DISPLAY.findall(text(cell)):
                shown = shown.union(*(numbers(tag) for tag in TAG.findall(display)))
        for name in (m[1] for tag in cell["metadata"].get("tags", []) if (m := CLAIM.fullmatch(tag))):
            if NUMBER.fullmatch(name):
                found = name in shown
            else:  # an equation without a number: the section where it is printed stands in its place
                chapter = published.item(f"thesis:eq-{name}").chapter
                found = any(place.startswith(f"section {chapter}.") for place in shown)
            if not found:
                lost.append(name)
    return lost


def faults(source: str) -> list[str]:
    """What is wrong with the displays of a text cell: no number, or a form that does not render everywhere."""
    wrong = ["an odd number of $$"] if source.count("$$") % 2 else []
    for display in DISPLAY.findall(source):
        begun, ended = (sorted(re.findall(rf"\\{word}\{{(\w+\*?)\}}", display)) for word in ("begin", "end"))
        inner = re.sub(r"\\begin\{(\w+\*?)\}.*\\end\{\1\}", "", display, flags=re.S)
        tags = TAG.findall(display)
        sentence = {
            "no \\tag, in a cell that does not say 'ours'": not tags and not re.search(r"\bours\b", source),
            "more than one \\tag": len(tags) > 1,
            "a \\tag inside an environment": len(tags) != len(TAG.findall(inner)),
            "an empty line": "\n\n" in display,
            "an environment not closed": begun != ended,
            "an environment that numbers itself": bool({"align", "equation", "gather"} & set(begun)),
            "braces that do not match": display.replace(r"\{", "").count("{") != display.replace(r"\}", "").count("}"),
        }
        wrong += [f"{what}: {display.strip()[:60]}" for what, is_so in sentence.items() if is_so]
    return wrong


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_claimed_equation_is_displayed_before_its_code(path):
    assert not missing(cells(path))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda p: p.stem)
def test_a_display_has_its_number_and_renders(path):
    assert not [fault for cell in cells(path) if cell["cell_type"] == "markdown" for fault in faults(text(cell))]


@pytest.mark.parametrize(
    ("tag", "expected"),
    [
        ("2.11", {"2.11"}),
        ("2.7, 3.13, 5.8", {"2.7", "3.13", "5.8"}),
        ("2.9 to 2.11", {"2.9", "2.10", "2.11"}),
        ("A.5 to A.7", {"A.5", "A.6", "A.7"}),
        ("C.alpha, C.beta", {"C.alpha", "C.beta"}),
        ("2.27, section 2.4.1", {"2.27", "section 2.4.1"}),
        ("1.24, repaired", {"1.24"}),
        ("ours", set()),
    ],
)
def test_a_tag_names_its_equations(tag, expected):
    assert numbers(tag) == expected


def test_a_missing_a_late_and_a_wrong_number_are_found():
    def notebook(*sources: str, name: str = "2.1") -> list[dict]:
        code = {"cell_type": "code", "metadata": {"tags": [f"item:thesis:eq-{name}"]}, "source": []}
        told = [{"cell_type": "markdown", "metadata": {}, "source": [s]} for s in sources]
        return [told[0], code, *told[1:]]

    assert missing(notebook(r"$$x \tag{2.1}$$")) == []
    assert missing(notebook(r"$x$ (2.1)")) == ["2.1"]
    assert missing(notebook(r"$$x \tag{2.10}$$")) == ["2.1"]
    assert missing(notebook(r"$$x \tag{section 2.1}$$")) == ["2.1"]
    assert missing(notebook("later", r"$$x \tag{2.1}$$")) == ["2.1"]
    assert missing(notebook(r"$$x \tag{section 2.4.1}$$", name="mf-map")) == []
    assert missing(notebook(r"$$x \tag{section 3.3.4}$$", name="mf-map")) == ["mf-map"]


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("$$x = 1$$", "no \\tag"),
        ("$$x = 1", "odd number"),
        (r"$$x \tag{2.1} \tag{2.2}$$", "more than one"),
        (r"$$\begin{aligned}x \tag{2.1}\end{aligned}$$", "inside an environment"),
        ("$$x\n\n= 1 \\tag{2.1}$$", "empty line"),
        (r"$$\begin{aligned}x \tag{2.1}$$", "not closed"),
        (r"$$\begin{align}x\end{align} \tag{2.1}$$", "numbers itself"),
        (r"$$\frac{1}{2 \tag{2.1}$$", "braces"),
    ],
)
def test_a_display_that_would_not_render_is_found(source, words):
    assert any(words in fault for fault in faults(source))


def test_displays_that_render_are_let_pass():
    assert faults("This one is ours: $$x = 1$$") == []
    assert faults(r"$$\{x \mid x > 0\} \tag{2.26}$$") == []
    assert faults(r"$$\begin{aligned} x &= \begin{cases} 1 \\ 0 \end{cases} \end{aligned} \tag{2.1, 2.2}$$") == []
