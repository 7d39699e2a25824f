"""Fast redrawing: only what changed is drawn, onto a kept picture of what did not."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Iterable

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from fuzzynav.plot.base import DPI, style

__all__ = ["Blit", "Lab", "Update", "captioned", "paler"]

# what a lab calls at each change: values by name in, changed artists (None: all) and a line of text out
Update = Callable[..., tuple[Iterable[Artist] | None, str]]
# a lab: drawn on the figure once what stays, from what it is given; what it hands back is called at each change
Lab = Callable[..., Update]


class Blit:
    """A figure of its own, outside pyplot, that gives PNG pictures of its changing artists.

    `size` is width and height [inch]. Artists handed to `png` are drawn over the kept background
    in the order of their zorder; an artist once handed over and now left out is not drawn.
    """

    def __init__(self, size: tuple[float, float] = (7.0, 4.0), dpi: int = DPI) -> None:
        style()
        self.figure = Figure(figsize=size, dpi=dpi, layout="constrained")
        self._canvas = FigureCanvasAgg(self.figure)
        self._background: object | None = None
        self._painted: set[int] = set()  # artists that are part of the background

    @property
    def width(self) -> int:
        """Width of the picture in pixels."""
        return int(self._canvas.get_width_height()[0])

    def forget(self) -> None:
        """Draw the background anew at the next picture."""
        self._background = None

    def png(self, artists: Iterable[Artist] | None, level: int = 1) -> bytes:
        """The picture as PNG bytes; `artists` None means that all of the figure may have changed."""
        if artists is None:
            self._background = None
            for artist in self.figure.findobj(Artist.get_animated):
                artist.set_animated(False)
            self._canvas.draw()
        else:
            self._draw(list(artists))
        return encode(np.asarray(self._canvas.buffer_rgba()), level)

    def _draw(self, artists: list[Artist]) -> None:
        artists = list(dict.fromkeys([*artists, *_frames(artists)]))
        fresh = [artist for artist in artists if not artist.get_animated()]
        for artist in fresh:
            artist.set_animated(True)
        if self._background is None or any(id(artist) in self._painted for artist in fresh):
            self._paint_background()
        self._canvas.restore_region(self._background)
        renderer = self._canvas.get_renderer()
        for artist in sorted((a for a in artists if a.figure), key=lambda a: a.get_zorder()):
            if hasattr(artist, "do_3d_projection"):
                artist.do_3d_projection()
            artist.draw(renderer)

    def _paint_background(self) -> None:
        self._canvas.draw()
        if self.figure.get_layout_engine() is not None:
            self.figure.set_layout_engine("none")
        self._background = self._canvas.copy_from_bbox(self.figure.bbox)
        self._painted = {id(artist) for artist in self.figure.findobj() if not artist.get_animated()}


def _frames(artists: Iterable[Artist]) -> list[Artist]:
    """What of their axes lies above most curves: spines and legends."""
    frames: list[Artist] = []
    for ax in dict.fromkeys(artist.axes for artist in artists if artist.axes):
        frames += ax.spines.values() if ax.axison else ()
        legend = ax.get_legend()
        frames += [] if legend is None else [legend]
    return frames


def captioned(png: bytes, text: str) -> bytes:
    """A picture with a line of text under it, for readers who have only the picture."""
    picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB"))
    strip = Figure(figsize=(picture.shape[1] / DPI, 0.4), dpi=DPI)
    canvas = FigureCanvasAgg(strip)
    lines = textwrap.fill(text, max(20, picture.shape[1] // 7))
    strip.set_figheight(0.12 + 0.19 * (lines.count("\n") + 1))
    strip.text(0.01, 0.5, lines.replace("$", r"\$"), va="center", fontsize=9)
    canvas.draw()
    under = np.asarray(canvas.buffer_rgba())[..., :3]
    wide = min(under.shape[1], picture.shape[1])
    return encode(np.concatenate([picture[:, :wide], under[:, :wide]]), 9)


def paler(png: bytes) -> bytes:
    """The picture as one that no longer counts: faded."""
    picture = np.asarray(Image.open(io.BytesIO(png)).convert("RGB")).astype(float)
    return encode((255.0 - 0.35 * (255.0 - picture)).astype(np.uint8), 1)


def encode(rgba: np.ndarray, level: int) -> bytes:
    """PNG bytes of an `(rows, cols, 4)` picture; level 1 is quick, 9 is small."""
    buffer = io.BytesIO()
    Image.fromarray(rgba[..., :3]).save(buffer, format="png", compress_level=level)
    return buffer.getvalue()
