"""Panels: a picture that follows its sliders, and a player that walks through frames."""

from __future__ import annotations

import html
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import ipywidgets as widgets

from fuzzynav.lab.controls import Choice, Slider, widget_of
from fuzzynav.lab.plain import Guard, plain_words
from fuzzynav.plot.blit import Blit, Lab, captioned, paler

__all__ = ["Panel", "Player"]

Control = Slider | Choice
SIDE = "270px"  # width of the column of sliders
# each label above its slider, both as wide as the column
LOOK = """<style>
.fuzzynav-lab .widget-inline-hbox { flex-wrap: wrap; height: auto; width: 100%; margin: 0 0 4px 0; }
.fuzzynav-lab .widget-inline-hbox > .widget-label { flex: 1 0 100%; text-align: left; max-width: none; width: 100%; }
.fuzzynav-lab .widget-image { width: 100%; }
</style>"""


class Panel:
    """A picture beside its sliders; `lab(figure, **given)` draws what stays and returns `update(**values)`.

    `update` returns the artists that changed (None: all of the figure) and a line of text. Artists
    that it makes anew at each call it must remove itself. A value reaches it rounded to its slider's step. The
    picture follows while a slider is dragged; the browser sends a slider's newest value only when the last one is
    drawn, so that nothing queues. An error in `update` becomes a sentence in the panel, over a pale picture.
    """

    def __init__(
        self,
        lab: Lab,
        sliders: Mapping[str, Control],
        *,
        title: str,
        size: tuple[float, float] = (7.0, 4.0),
        given: Mapping[str, Any] | None = None,
    ) -> None:
        self.title = title
        self.text = ""
        self.saved: tuple[Path, ...] = ()
        self._controls = dict(sliders)
        self._blit = Blit(size)
        self._update = lab(self._blit.figure, **(given or {}))
        self._first = {name: control.value for name, control in self._controls.items()}
        self._widgets = {name: widget_of(control) for name, control in self._controls.items()}
        self._quiet = False
        self._line, self._note = widgets.HTML(), widgets.HTML()
        wide = widgets.Layout(width="100%", max_width=f"{round(1.3 * self._blit.width)}px")
        self._image = widgets.Image(format="png", width=self._blit.width, layout=wide)
        for widget in self._widgets.values():
            widget.observe(self._changed, names="value")
        self._view = self._arrange()
        artists, self.text = self._compute()  # a fault in the first picture is the author's: it is raised
        picture = self._blit.png(artists, level=9)
        self._still = captioned(picture, self.text)
        self._image.value = picture
        self._say(self.text)

    @property
    def values(self) -> dict[str, Any]:
        """The present value of each control by name, rounded to the control's step."""
        return {name: control.rounded(self._widgets[name].value) for name, control in self._controls.items()}

    @property
    def png(self) -> bytes:
        """The present picture as PNG bytes."""
        return bytes(self._image.value)

    def set(self, **values: Any) -> None:
        """Move controls by name, then draw once; raises ValueError for a name or value that is not offered."""
        for name, value in values.items():
            self._refuse(name, value)
        self._quiet = True
        for name, value in values.items():
            self._widgets[name].value = value
        self._quiet = False
        self._note.value = ""
        self._draw()

    def reset(self) -> None:
        """Move every control back to its first value."""
        self.set(**self._first)

    def save(self, folder: str | Path = "saved") -> tuple[Path, Path]:
        """Write the picture and the values to `folder`, made where missing; return both paths."""
        target = Path(folder)
        target.mkdir(parents=True, exist_ok=True)
        stem = "".join(c if c.isalnum() and c.isascii() else "_" for c in self.title.lower()).strip("_")[:60]
        number = 1 + sum(1 for _ in target.glob(f"{stem}_*.png"))
        picture, values = target / f"{stem}_{number}.png", target / f"{stem}_{number}.json"
        picture.write_bytes(self.png)
        record = {"title": self.title, "text": self.text, "values": self.values}
        values.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
        return picture, values

    def __repr__(self) -> str:
        return f"Lab: {self.title}"

    def _repr_mimebundle_(self, include: object = None, exclude: object = None) -> dict[str, object]:
        """Text, the first picture with its line of text for readers without a kernel, and the live view."""
        view = self._view._repr_mimebundle_()
        return {**view, "text/plain": repr(self), "image/png": self._still}

    def _refuse(self, name: str, value: Any) -> None:
        if name not in self._controls:
            raise ValueError(f"'{name}' is not a control of this lab; it has {', '.join(self._controls)}")
        control = self._controls[name]
        if isinstance(control, Choice):
            if value not in control.options:
                raise ValueError(f"{name} must be one of {', '.join(control.options)}, got '{value}'")
        elif not control.low <= value <= control.high:
            raise ValueError(f"{name} must lie in {control.low} to {control.high}, got {value}")

    def _buttons(self) -> list[widgets.Widget]:
        reset = widgets.Button(description="Reset", tooltip="back to the first values")
        save = widgets.Button(description="Save", tooltip="picture and values to the folder saved/")
        reset.on_click(lambda _: self.reset())
        save.on_click(lambda _: self._save_clicked())
        for button in (reset, save):
            button.layout = widgets.Layout(width="100px")
        return [reset, save]

    def _arrange(self) -> widgets.Widget:
        head = widgets.HTML(f"{LOOK}<b>{html.escape(self.title)}</b>")
        side = widgets.Layout(width=SIDE, flex="0 0 auto", margin="0 12px 0 0")
        left = widgets.VBox([head, *self._widgets.values(), widgets.HBox(self._buttons()), self._note], layout=side)
        right = widgets.VBox([self._image, self._line], layout=widgets.Layout(flex="1 1 0", min_width="240px"))
        view = widgets.HBox([left, right], layout=widgets.Layout(width="100%", align_items="flex-start"))
        view.add_class("fuzzynav-lab")
        return view

    def _changed(self, change: object) -> None:
        if not self._quiet:
            self._draw()

    def _draw(self) -> None:
        guard = Guard()
        with guard:
            artists, self.text = self._compute()
            self._image.value = self._blit.png(artists)
        if guard.error is not None:
            self.text = f"No picture for these values: {plain_words(guard.error)}."
            self._image.value = paler(self.png)
        self._say(self.text)

    def _compute(self) -> tuple[list[Any] | None, str]:
        artists, text = self._update(**self.values)
        return (None if artists is None else list(artists)), text

    def _save_clicked(self) -> None:
        guard = Guard()
        with guard:
            picture, values = self.save()
            self._note.value = html.escape(f"Saved beside this notebook: {picture.as_posix()}, {values.name}")
        if guard.error is not None:
            self._note.value = html.escape(f"Not saved: {plain_words(guard.error)}.")

    def _say(self, text: str) -> None:
        self._line.value = html.escape(text)


class Player(Panel):
    """A panel that plays `frames` pictures: play, pause, scrub and step; `update(frame=i, **values)`.

    `sliders` adds controls as in a panel; `first` is the frame shown before anything is moved.
    """

    def __init__(
        self,
        lab: Lab,
        frames: int,
        *,
        title: str,
        interval_ms: int = 50,
        size: tuple[float, float] = (7.0, 4.0),
        sliders: Mapping[str, Control] | None = None,
        first: int = 0,
        given: Mapping[str, Any] | None = None,
    ) -> None:
        if frames < 2:
            raise ValueError(f"a player needs at least 2 frames, got {frames}")
        self._interval = interval_ms
        controls: dict[str, Control] = {"frame": Slider("frame", 0, frames - 1, first, 1)}
        super().__init__(lab, {**controls, **(sliders or {})}, title=title, size=size, given=given)

    def step(self, count: int = 1) -> None:
        """Move on by `count` frames, staying within the first and the last."""
        frame = self._widgets["frame"]
        frame.value = min(max(frame.value + count, frame.min), frame.max)

    def reset(self) -> None:
        """Stop playing and move every control back to its first value."""
        self._play.playing = False
        super().reset()

    def _buttons(self) -> list[widgets.Widget]:
        frame = self._widgets["frame"]
        play = widgets.Play(min=frame.min, max=frame.max, value=frame.value, interval=self._interval, show_repeat=False)
        self._play, self._link = play, widgets.jslink((play, "value"), (frame, "value"))
        back, on = widgets.Button(icon="step-backward"), widgets.Button(icon="step-forward")
        back.on_click(lambda _: self.step(-1))
        on.on_click(lambda _: self.step(1))
        for button, tip in ((back, "one frame back"), (on, "one frame on")):
            button.tooltip, button.layout = tip, widgets.Layout(width="40px")
        return [play, back, on, *super()._buttons()]
