"""Files of maps and logs under fire: no hang, little memory, one sentence with the file, nothing dubious accepted."""

import io
import os
import re
import time
import tracemalloc
import warnings
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from fuzzynav import maps
from fuzzynav.mapping import logs
from fuzzynav.maps import rosmaps
from fuzzynav.maps.gridmap import GridMap
from tests.fuzzing import damages

HEAD = "image: m.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n"
LOG = (
    "VERTEX_SE2 0 0 0 0\nROBOTLASER1 0 -1.5 3.0 1.0 50.0 0.1 0 4 1.0 2.0 51.2 3.0 0 0 0\n"
    "VERTEX_SE2 1 1 0 0\nROBOTLASER1 0 -1.5 3.0 1.0 50.0 0.1 0 4 1.0 2.0 51.2 3.0 0 0 0\n"
    "EDGE_SE2 0 1 1 0 0 4 0 0 5 0 6\nFIX 0\n"
)
MAP = "type octile\nheight 4\nwidth 5\nmap\n.....\n.@T..\n.G.S.\nOOOWW\n"
SCEN = "version 1\n0\tm.map\t5\t4\t0\t0\t3\t2\t4.5\n3\tm.map\t5\t4\t1\t1\t1\t1\t0\n"
TEXT = "resolution 0.5\norigin -1 2.5\n..#..\n?...#\n#####\n"


def zipped(text: bytes, **how: int) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", **({"compression": zipfile.ZIP_DEFLATED} | how)) as archive:
        archive.writestr("a.g2o", text)
    return content.getvalue()


def picture(kind: str) -> bytes:
    content = io.BytesIO()
    pixels = np.random.default_rng(0).choice([0, 205, 254], (12, 17)).astype(np.uint8)
    Image.fromarray(pixels).save(content, format=kind)
    return content.getvalue()


GOOD = {
    "a.map": MAP.encode(),
    "a.scen": SCEN.encode(),
    "a.txt": TEXT.encode(),
    "m.yaml": (HEAD + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\nmode: trinary\n").encode(),
    "m.pgm": picture("PPM"),
    "m.png": picture("PNG"),
    "a.g2o": LOG.encode(),
    "a.zip": zipped(LOG.encode() * 1),
}


def read(path: Path) -> object:
    """The file by the reader of its format; an image by the yaml file beside it."""
    if path.suffix in (".pgm", ".png"):
        (path.parent / "m.yaml").write_text(HEAD.replace("m.pgm", path.name))
        return maps.load(path.parent / "m.yaml")
    if path.suffix in (".g2o", ".zip"):
        return logs.read_g2o(path)
    return maps.read_scenarios(path) if path.suffix == ".scen" else maps.load(path)


def refusal(path: Path, content: bytes | str) -> str:
    """The one sentence with which a file is refused, without a warning and in a few seconds."""
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    begin = time.monotonic()
    with warnings.catch_warnings(), pytest.raises((ValueError, FileNotFoundError)) as caught:
        warnings.simplefilter("error")
        read(path)
    assert time.monotonic() - begin < 20
    assert type(caught.value) in (ValueError, FileNotFoundError)
    told = str(caught.value)
    assert str(path.parent) in told
    assert "\n" not in told
    assert len(told) < 600
    return told


@pytest.mark.parametrize("name", GOOD)
def test_seeded_damage_is_read_or_refused(tmp_path: Path, name: str) -> None:
    """300 damages of each format; FUZZ=5000 in the environment makes it 5000."""
    rng = np.random.default_rng(sum(name.encode()))
    (tmp_path / "m.pgm").write_bytes(GOOD["m.pgm"])
    path, refused, faults = tmp_path / name, 0, []
    path.write_bytes(GOOD[name])
    read(path)
    for _ in range(int(os.environ.get("FUZZ", "300"))):
        content = damages(GOOD[name], rng)
        path.write_bytes(content)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                read(path)
        except (ValueError, FileNotFoundError) as error:
            told = (type(error) in (ValueError, FileNotFoundError), str(tmp_path) in str(error), "\n" not in str(error))
            refused += 1
            faults += [] if all(told) else [(content, error)]
    assert not faults, faults[0]
    assert refused > 30


ANCHORS = "a: &a [x, x]\n" + "\n".join(f"{b}: &{b} [*{a}, *{a}, *{a}, *{a}]" for a, b in zip("abcdefghi", "bcdefghij"))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("image: " + "[" * 19000, "line 1"),
        ("image:\n" + "[\n" * 9000, "line 3"),
        (ANCHORS, "line 1"),
        ("resolution: &a 0.05\nimage: m.pgm\norigin: [0, 0, 0]\n", "line 1.*anchors"),
        ("<<: {image: m.pgm}\nresolution: 1\norigin: [0, 0, 0]\n", "line 1"),
        ("image:\n" + "".join(" " * k + "- a:\n" for k in range(1, 150)), "line 2"),
        ("- image: m.pgm\n", "expected fields"),
        ("? [a, b]\n: 1\n", "line 1"),
        (HEAD + "---\nimage: n.pgm\n", "line 4: a second document"),
        ("resolution: [" + "1, " * 5000 + "1]\n", "field 'image' is missing"),
        ("resolution: [" + "1, " * 3_000_000 + "1]\n", "bytes are more than the 20000"),
        (HEAD.replace("0.05", "9" * 5000), "line 2: resolution: expected finite"),
        (HEAD.replace("0.05", "true"), "line 2: resolution"),
        (HEAD.replace("0.05", "'0.05'"), "line 2: resolution.*without quotes"),
        (HEAD.replace("0.05", "1:30"), "line 2: resolution"),
        (HEAD.replace("0.05", "1_0"), "line 2: resolution"),
        (HEAD.replace("0.05", "0x10"), "line 2: resolution"),
        (HEAD.replace("0.05", "010"), "line 2: resolution"),
        (HEAD.replace("0.05", "2001-13-41"), "line 2: resolution"),
        (HEAD.replace("0.05", "5e-324"), "line 2: resolution must be positive, from 1e-06"),
        (HEAD.replace("0.05", "0"), "line 2: resolution must be positive"),
        (HEAD.replace("[0, 0, 0]", "[1e300, 0, 0]"), "line 3: origin must lie within"),
        (HEAD.replace("[0, 0, 0]", "0"), "line 3: origin: expected a list of 3"),
        (HEAD.replace("[0, 0, 0]", "[[0], 0, 0]"), "line 3"),
        (HEAD.replace("[0, 0, 0]", "{x: 0}"), "line 3"),
        (HEAD + "resolution: 0.1\n", "line 4: field 'resolution' stands here for the second time"),
        (HEAD + "resolutoin: 0.1\n", "line 4: 'resolutoin' is not one of"),
        (HEAD + "negate: maybe\n", "line 4: negate must be 0 or 1"),
        (HEAD.replace("m.pgm", "true"), "line 1: image must be a file name"),
        (HEAD.replace("m.pgm", "2001-13-41"), "line 1: image"),
        (HEAD.replace("m.pgm", '"m\\0.pgm"'), "line 1: image"),
        (HEAD.replace("m.pgm", '"\\ud800.pgm"'), "line 1: image"),
        (HEAD.replace("m.pgm", '"\\UFFFFFFFF"'), "YAML"),
        (HEAD.replace("m.pgm", "m" * 5000), "line 1: image"),
        (HEAD.replace("m.pgm", "loop.pgm"), "image"),
        ("%YAML 9" + "9" * 5000 + ".1\n---\n" + HEAD, "m.yaml"),
        (HEAD.encode() + b"mode: \xff\xfe", "line 4: not a text file"),
    ],
)
def test_yaml_that_is_no_map(tmp_path: Path, text: str | bytes, words: str) -> None:
    (tmp_path / "m.pgm").write_bytes(GOOD["m.pgm"])
    (tmp_path / "loop.pgm").symlink_to(tmp_path / "loop.pgm")
    told = refusal(tmp_path / "m.yaml", text)
    assert re.search(words, told), told


def test_yaml_as_ros_2_writes_it(tmp_path: Path) -> None:
    (tmp_path / "m.pgm").write_bytes(GOOD["m.pgm"])
    (tmp_path / "m.yaml").write_text(
        "image: 'm.pgm'  # beside\nmode: trinary\nresolution: 5e-2\norigin:\n- -1.5\n- 2\n- 0\nnegate: false\n"
    )
    data = maps.load(tmp_path / "m.yaml")
    assert data.resolution == 0.05
    assert data.origin == (-1.5, 2.0)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.map", MAP.replace("4", "9" * 5000), "line 2: expected 'height N'"),
        ("a.map", MAP.replace("4", "\u0664"), "line 2"),
        ("a.map", MAP.replace("height 4", "height 100000").replace("width 5", "width 100000"), "line 3: 100000 x"),
        ("a.map", MAP.encode().replace(b".G", b"\xff."), "line 7: not a text file"),
        ("a.scen", SCEN.replace("version 1", "version 9"), "line 1: expected 'version 1'"),
        ("a.scen", SCEN.replace("4.5", "-4.5"), "line 2: length"),
        ("a.scen", SCEN.replace("4.5", "1e999"), "line 2: length"),
        ("a.scen", SCEN.replace("4.5", "4_5"), "line 2: expected"),
        ("a.scen", SCEN.replace("4.5", "4.5\t7"), "line 2: expected.*nothing else"),
        ("a.scen", SCEN.replace("3\tm", "-3\tm"), "line 3: expected"),
        ("a.scen", SCEN.replace("\t5", "\t1_5"), "line 2: expected"),
        ("a.scen", SCEN.replace("\t5", "\t" + "9" * 5000), "line 2: expected"),
        ("a.txt", TEXT.replace("origin -1 2.5", "resolution 0.5"), "line 2: resolution stands here for the second"),
        ("a.txt", TEXT.replace("0.5", "0"), "a.txt, line 1: resolution must be positive"),
        ("a.txt", TEXT.replace("0.5", "-1"), "a.txt, line 1: resolution must be positive"),
        ("a.txt", TEXT.replace("0.5", "5e-324"), "a.txt, line 1: resolution must be positive"),
        ("a.txt", TEXT.replace("0.5", "1_0"), "a.txt, line 1: resolution: expected 1"),
        ("a.txt", TEXT.encode() + b"\xff", "line 6: not a text file"),
        ("a.g2o", LOG.replace("SE2 1 1", "SE2 1.5 1"), "line 3: the numbers of vertices must be whole"),
        ("a.g2o", LOG.replace("EDGE_SE2 0 1", "EDGE_SE2 0 0.9"), "line 5: the vertices of an edge must be whole"),
        ("a.g2o", LOG.replace("EDGE_SE2 0 1", "EDGE_SE2 -1 1"), "line 5: the vertices of an edge must be whole"),
        ("a.g2o", LOG.replace(" 4 1.0", " 3.5 1.0"), "line 2: the number of beams must be whole"),
        ("a.g2o", LOG.replace(" 4 1.0", " 99999999 1.0"), "line 2: ROBOTLASER1 promises 99999999"),
        ("a.g2o", LOG.replace("50.0", "-50.0"), "line 2: .*largest range positive"),
        ("a.g2o", LOG.replace("3.0 1.0", "3.0 0"), "line 2: the step between beams"),
        (
            "a.g2o",
            LOG.replace("4 0 0 5 0 6", "-4 0 0 5 0 6"),
            "line 5: the information of an edge must not be neg",
        ),
        ("a.g2o", LOG.replace("4 0 0 5 0 6", "4 9 0 5 0 6"), "line 5: the information of an edge must not be neg"),
        ("a.g2o", LOG.replace("2.0 51.2", "-2.0 51.2"), "line 2: a range is negative"),
        ("a.g2o", LOG.replace("2.0 51.2", "2_0 51.2"), "line 2: .*underscores"),
        ("a.g2o", LOG.replace("2.0 51.2", "\u0662 51.2"), "line 2: .*plain digits"),
        ("a.g2o", LOG.replace("2.0 51.2", "1e999 51.2"), "line 2: a range: a number is not finite"),
        ("a.g2o", LOG.encode() + b"\n#\xff", "line 8: not a text file"),
        ("a.g2o", LOG + "# " + "9" * 1_100_000, "line 7: over 1000000 characters"),
    ],
)
def test_other_files_that_say_what_cannot_be(tmp_path: Path, name: str, text: str | bytes, words: str) -> None:
    told = refusal(tmp_path / name, text)
    assert re.search(words, told), told


@pytest.mark.parametrize("name", ["a.map", "a.scen", "a.txt", "a.g2o", "m.yaml"])
def test_a_byte_order_mark_is_passed_over_everywhere(tmp_path: Path, name: str) -> None:
    (tmp_path / "m.pgm").write_bytes(GOOD["m.pgm"])
    found = []
    for mark in (b"", b"\xef\xbb\xbf"):
        (tmp_path / name).write_bytes(mark + GOOD[name])
        found.append(read(tmp_path / name))
    if name == "a.scen":
        assert found[0] == found[1]
    elif name == "a.g2o":
        assert np.array_equal(found[0].ranges, found[1].ranges, equal_nan=True)
    else:
        assert np.array_equal(found[0].occupied, found[1].occupied)


@pytest.mark.parametrize("mode", ["L", "1", "RGB", "P"])
def test_an_image_of_too_many_cells_is_refused_before_it_is_unpacked(tmp_path: Path, mode: str) -> None:
    size = (6000, 6000)
    Image.new(mode, size).save(tmp_path / "m.png")
    content = (tmp_path / "m.png").read_bytes()
    tracemalloc.start()
    assert "6000 x 6000 cells, at most 25000000" in refusal(tmp_path / "m.png", content)
    assert tracemalloc.get_traced_memory()[1] < 5e6
    tracemalloc.stop()


def test_a_pixel_bomb_gives_a_sentence_and_no_warning(tmp_path: Path) -> None:
    header = b"\x89PNG\r\n\x1a\n" + b"\x00\x00\x00\rIHDR" + (13300).to_bytes(4) * 2 + b"\x08\x00\x00\x00\x00"
    for factor in (1, 2):
        content = header.replace((13300).to_bytes(4), (13300 * factor).to_bytes(4))
        crc = zlib.crc32(content[12:]).to_bytes(4)
        assert "m.png" in refusal(tmp_path / "m.png", content + crc)


def test_the_memory_of_an_image_is_a_few_bytes_a_cell(tmp_path: Path) -> None:
    Image.new("RGBA", (1500, 1500)).save(tmp_path / "m.png")
    tracemalloc.start()
    read(tmp_path / "m.png")
    assert tracemalloc.get_traced_memory()[1] < 12 * 1500 * 1500 + 1e6
    tracemalloc.stop()


@pytest.mark.parametrize("filler", [b"\n", b"# \n", b"VERTEX_SE2 0 0 0 0\n", b"0 "])
def test_an_archive_unpacks_to_little(tmp_path: Path, filler: bytes) -> None:
    content = zipped(filler * (100_000_000 // len(filler)))
    tracemalloc.start()
    assert "unpacks to over" in refusal(tmp_path / "a.zip", content)
    assert tracemalloc.get_traced_memory()[1] < 2.5 * max(20 * len(content), 1e6)
    tracemalloc.stop()


def test_the_memory_of_a_log_is_a_small_multiple_of_its_text(tmp_path: Path) -> None:
    lines = [f"VERTEX2 {k} 0 0 0" for k in range(20000)] + ["EDGE2 0 1 0 0 0 1 0 0 1 1 0"] * 20000
    (tmp_path / "a.g2o").write_text("\n".join(lines))
    size = (tmp_path / "a.g2o").stat().st_size
    tracemalloc.start()
    assert logs.read_g2o(tmp_path / "a.g2o").edges.shape == (20000, 2)
    assert tracemalloc.get_traced_memory()[1] < 15 * size
    tracemalloc.stop()


def test_archives_of_other_kinds_are_refused(tmp_path: Path) -> None:
    for method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        assert "stored or deflated" in refusal(tmp_path / "a.zip", zipped(LOG.encode(), compression=method))
    secret = bytearray(GOOD["a.zip"])
    secret[6] |= 1  # the flags in the local header and in the directory
    secret[secret.index(b"PK\x01\x02") + 8] |= 1
    assert "encrypted" in refusal(tmp_path / "a.zip", bytes(secret))
    broken = bytearray(zipped(LOG.encode() * 50))
    broken[60:90] = bytes(30)
    assert "damaged" in refusal(tmp_path / "a.zip", bytes(broken))


def test_what_cannot_be_saved_is_said_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    grid = GridMap.from_ascii("#.")
    with pytest.raises(FileNotFoundError, match=r"the folder .* does not exist"):
        grid.save(tmp_path / "no" / "a.map")
    (tmp_path / "b.map").mkdir()
    with pytest.raises(IsADirectoryError, match=r"b\.map: could not be written: Is a directory"):
        grid.save(tmp_path / "b.map")
    with pytest.raises(OSError, match="could not be written: File name too long"):
        grid.save(tmp_path / ("a" * 300 + ".txt"))

    def denied(**_: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("tempfile.mkstemp", denied)
    with pytest.raises(PermissionError, match=r"a\.map: could not be written: Permission denied"):
        grid.save(tmp_path / "a.map")
    with pytest.raises(ValueError, match="resolution must be positive, from"):
        GridMap.from_ascii("#.", 1e-9).save(tmp_path / "a.txt")


def test_what_cannot_be_read_is_said_in_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a.map").write_text(MAP)

    def denied(_: Path) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "read_bytes", denied)
    with pytest.raises(PermissionError, match=r"a\.map: cannot be read: Permission denied"):
        maps.load(tmp_path / "a.map")


def test_grey_values_of_colour_are_averaged_as_before(tmp_path: Path) -> None:
    """Every sum of channels has the verdict of the mean: the table against plain arithmetic."""
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 256, (40, 50, 3), dtype=np.uint8)
    Image.fromarray(pixels).save(tmp_path / "m.png")
    data = read(tmp_path / "m.png")
    chance = (255.0 - pixels.astype(float).mean(axis=-1)) / 255.0
    assert np.array_equal(data.occupied, (chance > rosmaps.OCCUPIED_THRESH)[::-1])
    assert np.array_equal(data.unknown, ((chance <= rosmaps.OCCUPIED_THRESH) & (chance >= rosmaps.FREE_THRESH))[::-1])
