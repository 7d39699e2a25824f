"""Painting on a grid: draw obstacles with the mouse, a finger or the keyboard, and see the search flood the map."""

from __future__ import annotations

import html
from collections.abc import Mapping

import ipywidgets as widgets
import numpy as np
from ipycanvas import MultiCanvas, hold_canvas

from fuzzynav.lab.plain import Guard, plain_words
from fuzzynav.maps.gridmap import GridMap
from fuzzynav.planning import astar
from fuzzynav.planning.astar import Options, SearchResult
from fuzzynav.plot import COLORS, Blit, paint_picture

__all__ = ["Paint"]

Cell = tuple[int, int]
ACTIONS = ("draw walls", "erase walls", "move start", "move goal")


class Paint:
    """A map to paint on; every stroke runs the chosen search anew.

    `planners` gives the choices by name. Mouse and touch paint on the picture; the sliders for column and row with
    the button "apply" do the same from the keyboard. Start and goal cannot be painted over.
    Raises ValueError for an empty list of planners, or for a start or goal that is not a free cell.
    """

    def __init__(
        self, grid: GridMap, start: Cell, goal: Cell, planners: Mapping[str, Options], *, title: str, size: int = 480
    ) -> None:
        if not planners:
            raise ValueError("a painting lab needs one planner or more")
        self.title, self.text = title, ""
        self._planners = dict(planners)
        self._first = (grid, start, goal)
        self._grid, self._start, self._goal = grid, start, goal
        status = astar.search(grid, start, goal).status
        if status.endswith("blocked"):
            raise ValueError(f"{status.replace('_', ' ')}: put it on a free cell")
        rows, cols = grid.shape
        self._side = max(4, size // max(rows, cols))
        self._canvas = MultiCanvas(3, width=cols * self._side, height=rows * self._side)
        self._last: Cell | None = None
        self._controls()
        self._listen()
        self._view = self._arrange()
        self.result: SearchResult
        self._search()
        blit = Blit((5.0, 5.0))
        blit_update = paint_picture(blit.figure, grid=grid, found=self.result, start=start, goal=goal)
        blit_update()
        self._still = blit.png(None, level=9)

    @property
    def grid(self) -> GridMap:
        """The map as it is painted now."""
        return self._grid

    @property
    def start(self) -> Cell:
        """The start cell x, y."""
        return self._start

    @property
    def goal(self) -> Cell:
        """The goal cell x, y."""
        return self._goal

    def touch(self, cell: Cell, action: str | None = None) -> None:
        """Do what a click on this cell does: the given action, or the one that is chosen.

        Raises ValueError for a cell outside the map or an unknown action.
        """
        name = self._action.value if action is None else action
        if name not in ACTIONS:
            raise ValueError(f"action must be one of {', '.join(ACTIONS)}, got {name!r}")
        if not self._grid.contains(cell):
            raise ValueError(f"cell {cell} lies outside the map")
        if self._apply((int(cell[0]), int(cell[1])), name):
            self._search()

    def choose(self, planner: str) -> None:
        """Choose the search by name; raises ValueError for an unknown one."""
        if planner not in self._planners:
            raise ValueError(f"planner must be one of {', '.join(self._planners)}, got {planner!r}")
        self._planner.value = planner

    def reset(self) -> None:
        """Back to the first map, start and goal."""
        self._grid, self._start, self._goal = self._first
        self._search()

    def __repr__(self) -> str:
        return f"Lab: {self.title}"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, object]:
        """Text, the first picture for readers without a kernel, and the live view."""
        return {**self._view._repr_mimebundle_(), "text/plain": repr(self), "image/png": self._still}

    # -- painting

    def _apply(self, cell: Cell, action: str) -> bool:
        """Change map, start or goal; whether anything changed."""
        x, y = cell
        occupied = bool(self._grid.occupied[y, x])
        if action in ("move start", "move goal"):
            other = self._goal if action == "move start" else self._start
            if occupied or cell == other:
                return False
            changed = cell != (self._start if action == "move start" else self._goal)
            if action == "move start":
                self._start = cell
            else:
                self._goal = cell
            return changed
        wall = action == "draw walls"
        if cell in (self._start, self._goal) or occupied == wall:
            return False
        painted = self._grid.occupied.copy()
        painted[y, x] = wall
        self._grid = GridMap(painted, self._grid.resolution, self._grid.origin)
        return True

    def _line(self, cell: Cell) -> list[Cell]:
        """Cells from the last one of the stroke to this one, so that a fast stroke has no gaps."""
        last = self._last or cell
        count = max(abs(cell[0] - last[0]), abs(cell[1] - last[1]), 1)
        along = np.linspace(last, cell, count + 1).round().astype(int)
        return [(int(x), int(y)) for x, y in along]

    def _stroke(self, px: float, py: float) -> None:
        rows, cols = self._grid.shape
        cell = (int(min(max(px // self._side, 0), cols - 1)), int(min(max(rows - 1 - py // self._side, 0), rows - 1)))
        changed = [self._apply(c, self._action.value) for c in self._line(cell)]
        self._last = cell
        if any(changed):
            self._search()

    def _listen(self) -> None:
        def guarded(px: float, py: float) -> None:
            guard = Guard()
            with guard:
                self._stroke(px, py)
            if guard.error is not None:
                self._say(f"Not painted: {plain_words(guard.error)}.")

        def down(px: float, py: float) -> None:
            self._last, self._pressed = None, True
            guarded(px, py)

        def move(px: float, py: float) -> None:
            if self._pressed:
                guarded(px, py)

        def up(*_: object) -> None:
            self._pressed, self._last = False, None

        self._pressed = False
        self._canvas.on_mouse_down(down)
        self._canvas.on_mouse_move(move)
        self._canvas.on_mouse_up(up)
        self._canvas.on_mouse_out(up)
        self._canvas.on_touch_start(lambda touches: down(*touches[0]))
        self._canvas.on_touch_move(lambda touches: move(*touches[0]))
        self._canvas.on_touch_end(up)

    # -- search and picture

    def _search(self) -> None:
        self.result = astar.search(self._grid, self._start, self._goal, self._planners[self._planner.value])
        self._paint()
        found, name = self.result, self.result.status.replace("_", " ")
        words = f"length {found.length:.2f} m" if found.status == "reached" else name
        self._say(f"{found.searched} cells searched, {words}")

    def _paint(self) -> None:
        side, rows = self._side, self._grid.shape[0]
        with hold_canvas():
            back, flood, front = self._canvas[0], self._canvas[1], self._canvas[2]
            for layer in (back, flood, front):
                layer.clear()
            back.fill_style = "white"
            back.fill_rect(0, 0, self._canvas.width, self._canvas.height)
            _squares(flood, self.result.expanded, rows, side, COLORS["accent"], 0.5)
            y, x = np.nonzero(self._grid.occupied)
            _squares(back, np.stack([x, y], axis=-1), rows, side, COLORS["obstacle"], 1.0)
            middle = (self.result.cells + 0.5) * side
            if len(middle) > 1:
                front.stroke_style, front.line_width = COLORS["path"], 3.0
                front.stroke_lines(np.stack([middle[:, 0], rows * side - middle[:, 1]], axis=-1))
            for cell, colour in ((self._start, COLORS["robot"]), (self._goal, COLORS["goal"])):
                front.fill_style = colour
                front.fill_circle((cell[0] + 0.5) * side, (rows - 0.5 - cell[1]) * side, 0.36 * side)

    def _say(self, text: str) -> None:
        self.text = text
        self._words.value = html.escape(text)

    # -- widgets

    def _controls(self) -> None:
        rows, cols = self._grid.shape
        wide = widgets.Layout(width="300px")
        self._planner = widgets.Dropdown(options=list(self._planners), description="search", layout=wide)
        self._planner.observe(lambda _: self._search(), names="value")
        self._action = widgets.Dropdown(options=ACTIONS, description="mouse", layout=wide)
        self._column = widgets.IntSlider(value=cols // 2, min=0, max=cols - 1, description="column", layout=wide)
        self._row = widgets.IntSlider(value=rows // 2, min=0, max=rows - 1, description="row", layout=wide)
        self._words = widgets.HTML()

    def _arrange(self) -> widgets.Widget:
        apply, reset = widgets.Button(description="Apply"), widgets.Button(description="Reset")
        apply.tooltip, reset.tooltip = "do it at this column and row", "back to the first map"
        apply.on_click(lambda _: self.touch((self._column.value, self._row.value)))
        reset.on_click(lambda _: self.reset())
        keys = widgets.HTML("Without a mouse: choose a cell, then Apply.")
        left = widgets.VBox(
            [
                widgets.HTML(f"<b>{html.escape(self.title)}</b>"),
                self._planner,
                self._action,
                keys,
                self._column,
                self._row,
                widgets.HBox([apply, reset]),
                self._words,
            ]
        )
        return widgets.HBox([left, self._canvas], layout=widgets.Layout(flex_flow="row wrap"))


def _squares(layer: object, cells: np.ndarray, rows: int, side: int, colour: str, alpha: float) -> None:
    """Fill cells (n, 2) on a layer of the canvas, a pixel apart, so that the grid shows."""
    if len(cells) == 0:
        return
    layer.fill_style, layer.global_alpha = colour, alpha  # type: ignore[attr-defined]
    x, y = cells[:, 0] * side + 1, (rows - 1 - cells[:, 1]) * side + 1
    layer.fill_rects(x, y, side - 1, side - 1)  # type: ignore[attr-defined]
