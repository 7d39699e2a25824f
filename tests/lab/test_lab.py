"""Labs: the picture follows the controls, faults become sentences, and nothing is lost on saving."""

import io
import json

import numpy as np
import pytest
from PIL import Image

from fuzzynav import lab, plot
from fuzzynav.lab.controls import widget_of
from fuzzynav.lab.plain import Guard, plain_words

SLIDERS = {"gain": lab.Slider("gain", 0.0, 2.0, 0.5, 0.05, "1/s"), "count": lab.Slider("count", 1, 9, 3, 1)}


def wave(figure):
    ax = figure.add_subplot()
    ax.set(xlim=(0, 1), ylim=(-2, 2))
    x = np.linspace(0, 1, 200)
    line = plot.draw_path(ax, np.column_stack([x, x]))

    def update(gain, count):
        if count == 7:
            raise ZeroDivisionError("division by zero")
        line.set_ydata(gain * np.sin(2 * np.pi * count * x))
        return [line], f"amplitude {gain:.2f} <m>"

    return update


@pytest.fixture
def panel():
    return lab.Panel(wave, SLIDERS, title="A wave (of mine)", size=(4.0, 3.0))


def test_the_first_picture_is_there(panel):
    assert panel.png.startswith(b"\x89PNG")
    assert panel.text == "amplitude 0.50 <m>"
    assert repr(panel) == "Lab: A wave (of mine)"


def test_the_picture_follows_a_dragged_slider(panel):
    first = panel.png
    panel._widgets["gain"].value = 1.5  # what the browser does
    assert panel.png != first
    assert panel.text == "amplitude 1.50 <m>"


def test_set_draws_once_and_reset_restores(panel, monkeypatch):
    first, drawn = panel.png, []
    compute = panel._compute
    monkeypatch.setattr(panel, "_compute", lambda: drawn.append(1) or compute())
    panel.set(gain=1.0, count=5)
    assert panel.values == {"gain": 1.0, "count": 5}
    assert drawn == [1]
    panel.reset()
    assert panel.values == {"gain": 0.5, "count": 3}
    shown, kept = (np.asarray(Image.open(io.BytesIO(p))) for p in (panel.png, first))
    np.testing.assert_array_equal(shown, kept)


def test_same_values_same_picture(panel):
    panel.set(gain=1.0)
    once = panel.png
    panel.set(gain=2.0)
    panel.set(gain=1.0)
    assert panel.png == once


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"gian": 1.0}, "'gian' is not a control of this lab; it has gain, count"),
        ({"gain": 3.0}, "gain must lie in 0.0 to 2.0, got 3.0"),
    ],
)
def test_wrong_names_and_values_are_refused(panel, values, words):
    with pytest.raises(ValueError, match=words):
        panel.set(**values)


def test_a_fault_becomes_a_sentence_and_the_lab_goes_on(panel):
    panel.set(count=7)
    assert panel.text == "No picture for these values: it divided by zero (ZeroDivisionError: division by zero)."
    assert "Traceback" not in panel._line.value
    panel.set(count=2)
    assert panel.text.startswith("amplitude")


def test_a_fault_in_the_first_picture_is_the_authors():
    with pytest.raises(ZeroDivisionError):
        lab.Panel(wave, {**SLIDERS, "count": lab.Slider("count", 1, 9, 7, 1)}, title="t")


def test_text_is_not_taken_for_markup(panel):
    assert panel._line.value == "amplitude 0.50 &lt;m&gt;"


def test_readers_without_a_kernel_get_the_picture(panel):
    bundle = panel._repr_mimebundle_()
    assert bundle["text/plain"] == "Lab: A wave (of mine)"
    assert bundle["image/png"].startswith(b"\x89PNG")
    assert len(bundle["image/png"]) < 60_000
    assert "application/vnd.jupyter.widget-view+json" in bundle


def test_saving_keeps_picture_and_values(panel, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    panel.set(gain=1.25)
    panel._save_clicked()
    panel._save_clicked()
    names = sorted(p.name for p in (tmp_path / "saved").iterdir())
    assert names == [f"a_wave__of_mine_{k}.{kind}" for k in (1, 2) for kind in ("json", "png")]
    record = json.loads((tmp_path / "saved" / names[0]).read_text())
    assert record["values"] == {"gain": 1.25, "count": 3}
    assert (tmp_path / "saved" / names[1]).read_bytes() == panel.png
    assert "saved/a_wave__of_mine_2.png" in panel._note.value


def test_a_folder_that_cannot_be_written_is_said(panel, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "saved").write_text("a file is in the way")
    panel._save_clicked()
    assert panel._note.value.startswith("Not saved: ")


def film(figure):
    update = wave(figure)
    return lambda frame, gain: update(gain, 1 + frame % 3)


def test_a_player_steps_within_its_frames():
    player = lab.Player(film, 10, title="Film", sliders={"gain": SLIDERS["gain"]}, first=8)
    first = player.png
    player.step()
    player.step()
    assert player.values["frame"] == 9
    assert player.png != first
    player.step(-30)
    assert player.values["frame"] == 0
    player._play.playing = True
    player.reset()
    assert player.values == {"frame": 8, "gain": 0.5}
    assert not player._play.playing


def test_a_player_needs_two_frames():
    with pytest.raises(ValueError, match="at least 2 frames"):
        lab.Player(film, 1, title="Film")


def test_a_choice_is_one_of_its_options():
    seen = []

    def setup(figure):
        line = plot.draw_path(figure.add_subplot(), [])
        return lambda norm: (seen.append(norm) or [line], norm)

    panel = lab.Panel(setup, {"norm": lab.Choice("norm", ("min", "product"), "min")}, title="t")
    panel.set(norm="product")
    assert seen == ["min", "product"]
    with pytest.raises(ValueError, match="must be one of min, product"):
        panel.set(norm="max")
    with pytest.raises(ValueError, match="is not one of"):
        lab.Choice("norm", ("min",), "max")


@pytest.mark.parametrize("values", [(1.0, 1.0, 1.0, 0.1), (0.0, 1.0, 0.5, 0.0), (0.0, 1.0, 2.0, 0.1)])
def test_a_slider_has_a_range_that_makes_sense(values):
    with pytest.raises(ValueError, match="slider 'gain'"):
        lab.Slider("gain", *values)


@pytest.mark.parametrize(
    ("step", "readout"),
    [
        (0.1, ".1f"),
        (0.05, ".2f"),
        (0.25, ".2f"),
        (0.001, ".3f"),
        (2.5, ".1f"),
        (0.5, ".1f"),
        (0.02, ".2f"),
        (10.0, ".0f"),
    ],
)
def test_a_slider_shows_the_decimals_of_its_step(step, readout):
    assert widget_of(lab.Slider("g", 0.0, 100.0, 50.0, step)).readout_format == readout


def test_guards_let_interrupts_pass():
    with pytest.raises(KeyboardInterrupt), Guard():
        raise KeyboardInterrupt
    guard = Guard()
    with guard:
        raise ValueError("the map is empty")
    assert plain_words(guard.error) == "the map is empty"


def test_a_value_reaches_the_picture_rounded_to_its_step(panel):
    panel._widgets["gain"].value = 0.15000000000000002  # what a browser sends after a few steps
    assert panel.values["gain"] == 0.15
    degrees = lab.Slider("ends", 5.0, 90.0, 90.0, 1.0)
    assert degrees.rounded(45.00000000000001) == 45.0
    assert lab.Slider("odd", 0.65, 4.0, 2.0, 0.05).rounded(0.7000001) == 0.7
    assert lab.Slider("n", 8, 2578, 8, 1).rounded(9) == 9


def test_after_a_fault_the_old_picture_fades(panel):
    good = np.asarray(Image.open(io.BytesIO(panel.png))).astype(float)
    panel.set(count=7)
    pale = np.asarray(Image.open(io.BytesIO(panel.png))).astype(float)
    assert pale.min() > good.min()
    np.testing.assert_allclose(255 - pale, 0.35 * (255 - good), atol=1.0)


def test_a_lab_is_given_its_scene():
    def scaled(figure, *, most):
        update = wave(figure)
        return lambda gain, count: update(gain * most, count)

    shown = lab.Panel(scaled, SLIDERS, title="t", given={"most": 2.0})
    assert shown.text == "amplitude 1.00 <m>"


def test_the_stored_picture_carries_its_line_of_text(panel):
    live, stored = (Image.open(io.BytesIO(p)) for p in (panel.png, panel._repr_mimebundle_()["image/png"]))
    assert stored.size[0] == live.size[0]
    assert stored.size[1] > live.size[1]
    assert np.asarray(stored)[live.size[1] :].min() < 100  # something is written there
