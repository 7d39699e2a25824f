"""A real browser paints on the grid of chapter 05: with the mouse and from the keyboard, and the search answers."""

import importlib.util
import json
import re
from pathlib import Path

spec = importlib.util.spec_from_file_location("browser_tools", Path(__file__).parent / "test_browser.py")
tools = importlib.util.module_from_spec(spec)
spec.loader.exec_module(tools)
lab, browser, page = tools.lab, tools.browser, tools.page  # fixtures

NAME = "05a_grid_search"
WORDS = """() => [...document.querySelectorAll('.widget-html-content')].map(e => e.textContent)
                .filter(t => t.includes('cells searched, ')).pop() || ''"""
PIXELS = """c => { const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
                   let s = 0; for (let k = 0; k < d.length; k += 1) s = (s * 31 + d[k]) % 1000003; return s; }"""


def searched(page) -> int:
    found = re.match(r"(\d+) cells searched", page.evaluate(WORDS))
    return int(found.group(1)) if found else -1


def settled(page, canvas) -> dict[str, float]:
    """Where the canvas is once it is wholly in sight and the notebook has stopped moving."""

    def still():
        canvas.scroll_into_view_if_needed()
        first = canvas.bounding_box()
        page.wait_for_timeout(500)
        box = canvas.bounding_box()
        height = page.viewport_size["height"]
        return box if box == first and 0 < box["y"] and box["y"] + box["height"] < height else None

    return tools.wait_for("the canvas to be in sight", still)


def test_walls_painted_with_the_mouse_and_from_the_keyboard_change_the_search(lab, page):
    cells = json.loads((tools.HOME / "notebooks" / f"{NAME}.ipynb").read_text(encoding="utf-8"))["cells"]
    tools.open_notebook(page, lab, NAME)
    tools.run_all(page, sum(c["cell_type"] == "code" for c in cells))
    canvas = page.locator("canvas[width='480'][height='480']").last
    tools.wait_for("the canvas", lambda: canvas.count() or tools.scroll(page, -500))
    tools.wait_for("the first picture", lambda: searched(page) == 35)
    box, before = settled(page, canvas), canvas.evaluate(PIXELS)
    side = box["width"] / 20

    def spot(x: int, y: int) -> tuple[float, float]:
        return box["x"] + (x + 0.5) * side, box["y"] + (19.5 - y) * side

    page.mouse.move(*spot(9, 10))  # a stroke across the passage that the path takes
    page.mouse.down()
    page.mouse.move(*spot(10, 10), steps=4)
    page.mouse.move(*spot(11, 10), steps=4)
    page.mouse.up()
    tools.wait_for("the search to answer the stroke", lambda: searched(page) == 114)
    tools.wait_for("a new picture", lambda: canvas.evaluate(PIXELS) != before)

    apply = page.get_by_role("button", name="Apply").last
    apply.focus()
    page.keyboard.press("Enter")  # a wall at column 10, row 10: painted already, nothing changes
    assert searched(page) == 114
    row = page.locator(".widget-slider", has=page.locator(".widget-label", has_text=re.compile("^row$"))).last
    row.locator(".noUi-handle").focus()
    page.keyboard.press("ArrowDown")
    apply.focus()
    page.keyboard.press("Enter")
    tools.wait_for("the search to answer the keyboard", lambda: searched(page) == 113)
    assert tools.stored_faults(page, lab, NAME) == []
