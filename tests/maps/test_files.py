"""Map files: exact round trips, the conventions of others, and one clear error for each fault."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from PIL import Image

from fuzzynav import maps as mapfiles
from fuzzynav.maps.gridmap import GridMap

relaxed = settings(deadline=None, max_examples=40)
CODES = hnp.arrays(int, hnp.array_shapes(min_dims=2, max_dims=2, min_side=1, max_side=7), elements=st.integers(0, 2))
NUMBERS = st.floats(-1e6, 1e6)
GOOD = {
    "image": "m.pgm",
    "resolution": 0.05,
    "origin": [0.0, 0.0, 0.0],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("maps")


def same(a: GridMap, b: GridMap) -> bool:
    unknown = [np.zeros(g.shape, dtype=bool) if g.unknown is None else g.unknown for g in (a, b)]
    return (
        np.array_equal(a.occupied, b.occupied)
        and np.array_equal(*unknown)
        and (a.resolution, a.origin) == (b.resolution, b.origin)
    )


@relaxed
@given(CODES, st.floats(1e-6, 1e3), NUMBERS, NUMBERS, st.sampled_from([".yaml", ".txt"]))
def test_round_trip_is_exact(folder, codes, resolution, x, y, ending):
    grid = GridMap(codes == 1, resolution, (x, y), codes == 2)
    grid.save(folder / f"a{ending}")
    assert same(GridMap.load(folder / f"a{ending}"), grid)


@relaxed
@given(CODES, st.sampled_from([".pgm", ".png"]))
def test_both_images_and_movingai_come_back(folder, codes, image):
    data = mapfiles.MapData(codes == 1, 0.05, (-1.0, 2.0), codes == 2)
    mapfiles.write_ros_map(folder / "b.yaml", data, image)
    assert same(GridMap.load(folder / "b.yaml"), GridMap(*data))
    plain = GridMap(codes == 1)
    plain.save(folder / "c.map")
    assert same(GridMap.load(folder / "c.map"), plain)
    assert same(GridMap.from_ascii(plain.to_ascii()), plain)


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_movingai_terrain_and_row_order(tmp_path, end):
    text = end.join(["type octile", "height 2", "width 7", "map", ".GS@OTW", "@......", ""])
    (tmp_path / "a.map").write_bytes(text.encode())
    grid = GridMap.load(tmp_path / "a.map")
    assert grid.occupied.tolist() == [[True] + [False] * 6, [False] * 3 + [True] * 4]


def test_scenarios_count_from_the_lower_left(tmp_path):
    lines = ["version 1", "0 m.map 4 3 0 0 3 2 4.5", "3 m.map 4 3 1 1 1 1 0", ""]
    (tmp_path / "a.scen").write_bytes("\r\n".join(lines).replace(" ", "\t").encode())
    first, second = mapfiles.read_scenarios(tmp_path / "a.scen")
    assert first == (0, "m.map", (3, 4), (0, 2), (3, 0), 4.5)
    assert second.bucket == 3
    assert second.start == second.goal == (1, 1)


def test_saver_writes_what_map_server_expects(tmp_path):
    GridMap.from_ascii("#.?\n...", 0.05).save(tmp_path / "m.yaml")
    head, pixels = (tmp_path / "m.pgm").read_bytes()[:-6], (tmp_path / "m.pgm").read_bytes()[-6:]
    assert head.split() == [b"P5", b"3", b"2", b"255"]
    assert list(pixels) == [0, 254, 205, 254, 254, 254]
    text = (tmp_path / "m.yaml").read_text()
    assert "image: m.pgm" in text
    assert "resolution: 0.05" in text
    assert "origin: [0.0, 0.0, 0.0]" in text
    assert sorted(p.name for p in tmp_path.iterdir()) == ["m.pgm", "m.yaml"]


def ros(folder, pixels, **fields):
    Image.fromarray(np.array(pixels, dtype=np.uint8)).save(folder / "m.pgm")
    lines = [f"{k}: {v}" for k, v in {**GOOD, **fields}.items()]
    (folder / "m.yaml").write_text("\n".join(lines) + "\n")
    return folder / "m.yaml"


def test_thresholds_and_negation_follow_map_server(tmp_path):
    # occ = (255 - p) / 255: 89 gives 0.651 > 0.65, 90 gives 0.647; 206 gives 0.192 < 0.196, 205 gives 0.19608
    pixels = [[89, 90, 205, 206]]
    grid = GridMap.load(ros(tmp_path, pixels))
    assert grid.occupied.tolist() == [[True, False, False, False]]
    assert grid.unknown.tolist() == [[False, True, True, False]]
    negated = GridMap.load(ros(tmp_path, [[255 - p for p in pixels[0]]], negate=1))
    assert same(grid, negated)
    shifted = GridMap.load(ros(tmp_path, pixels, occupied_thresh=0.6, free_thresh=0.5))
    assert shifted.occupied.tolist() == [[True, True, False, False]]
    assert shifted.unknown is None
    exact = GridMap.load(
        ros(tmp_path, [[101, 102, 204, 205]], occupied_thresh=0.6, free_thresh=0.2)
    )  # 102: 0.6, 204: 0.2
    assert exact.occupied.tolist() == [[True, False, False, False]]
    assert exact.unknown.tolist() == [[False, True, True, False]]


def test_first_image_row_is_the_highest_y_and_colour_is_averaged(tmp_path):
    assert GridMap.load(ros(tmp_path, [[0], [254]])).occupied.tolist() == [[False], [True]]
    Image.fromarray(np.array([[[0, 0, 0], [255, 255, 255]]], dtype=np.uint8)).save(tmp_path / "m.png")
    (tmp_path / "m.yaml").write_text("image: m.png\nresolution: 1\norigin: [0, 0, 0]\n")
    assert GridMap.load(tmp_path / "m.yaml").occupied.tolist() == [[True, False]]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r"line 1: expected 'type octile'"),
        ("type tile\nheight 1\nwidth 1\nmap\n.\n", "line 1"),
        ("type octile\nheight x\nwidth 1\nmap\n.\n", "line 2: expected 'height N'"),
        ("type octile\nheight 0\nwidth 1\nmap\n", "line 2"),
        ("type octile\nheight 1\n", "line 3: expected 'width N'"),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n", "1 map rows, but the header says height 2"),
        ("type octile\nheight 2\nwidth 2\nmap\n..\n.\n", "line 6: 1 cells, but the header says width 2"),
        ("type octile\nheight 1\nwidth 2\nmap\n.x\n", "line 5: 'x' is not a terrain"),
        ("type octile\nheight 1\nwidth 1\nmap\n.\n.\n", "2 map rows"),
    ],
)
def test_malformed_movingai_names_the_line(tmp_path, text, words):
    (tmp_path / "a.map").write_text(text)
    with pytest.raises(ValueError, match=words):
        GridMap.load(tmp_path / "a.map")


@pytest.mark.parametrize(
    ("fields", "words"),
    [
        ({"resolution": "nan"}, "resolution"),
        ({"resolution": "-1"}, "resolution"),
        ({"resolution": "[1]"}, "resolution"),
        ({"resolution": ".nan"}, "finite"),
        ({"origin": "[0, .inf, 0]"}, "origin: expected finite"),
        ({"origin": "[0, 0]"}, "origin: expected 3"),
        ({"origin": "[0, 0, 0.5]"}, "turned map"),
        ({"negate": 2}, "negate"),
        ({"occupied_thresh": 0.1}, "free_thresh"),
        ({"mode": "raw"}, "mode"),
        ({"image": "../m.pgm"}, "outside the folder"),
        ({"image": "/etc/hostname"}, "outside the folder"),
        ({"image": "7"}, "file name"),
        ({"image": "[1, 2"}, "line 2: not readable as YAML"),
    ],
)
def test_malformed_yaml_names_the_field(tmp_path, fields, words):
    with pytest.raises(ValueError, match=words):
        GridMap.load(ros(tmp_path, [[0]], **fields))


def test_a_link_out_of_the_folder_is_not_followed(tmp_path):
    (tmp_path / "in").mkdir()
    Image.fromarray(np.zeros((1, 1), dtype=np.uint8)).save(tmp_path / "secret.pgm")
    (tmp_path / "in" / "m.pgm").symlink_to(tmp_path / "secret.pgm")
    (tmp_path / "in" / "m.yaml").write_text("image: m.pgm\nresolution: 1\norigin: [0, 0, 0]\n")
    with pytest.raises(ValueError, match="outside the folder"):
        GridMap.load(tmp_path / "in" / "m.yaml")


def test_yaml_runs_nothing(tmp_path):
    (tmp_path / "m.yaml").write_text("image: !!python/object/apply:os.getcwd []\nresolution: 1\norigin: [0, 0, 0]\n")
    with pytest.raises(ValueError, match="not readable as YAML"):
        GridMap.load(tmp_path / "m.yaml")


def test_missing_and_damaged_images(tmp_path):
    path = ros(tmp_path, np.zeros((20, 20)))
    whole = (tmp_path / "m.pgm").read_bytes()
    (tmp_path / "m.pgm").write_bytes(whole[:100])
    with pytest.raises(ValueError, match=r"m\.pgm.*damaged"):
        GridMap.load(path)
    (tmp_path / "m.pgm").write_bytes(b"not an image")
    with pytest.raises(ValueError, match="damaged or not a PGM"):
        GridMap.load(path)
    (tmp_path / "m.pgm").unlink()
    with pytest.raises(FileNotFoundError, match=r"m\.pgm.*not there"):
        GridMap.load(path)
    path.write_text("image: m.pgm\n")
    with pytest.raises(ValueError, match="'resolution' is missing"):
        GridMap.load(path)


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.txt", "..\n.\n", "line 2: 1 cells"),
        ("a.txt", "..\n.x\n", "line 2: 'x'"),
        ("a.txt", "\n", "no cells"),
        ("a.txt", "origin 1\n..\n", "line 1: origin: expected 2"),
        ("a.txt", "resolution nan\n..\n", "line 1: resolution"),
        ("a.scen", "0 m 1 1 0 0 0 0 0\n", "version"),
        ("a.scen", "version 1\n0\tm\t4\t4\t0\t0\n", "line 2: expected"),
        ("a.scen", "version 1\n0\tm\t4\t4\t0\t0\t4\t0\t1\n", "line 2: start, goal"),
        ("a.pdf", "", "ends in"),
        ("a.pgm", "", "load the .yaml"),
    ],
)
def test_other_malformed_files(tmp_path, name, text, words):
    (tmp_path / name).write_text(text)
    read = mapfiles.read_scenarios if name.endswith("scen") else mapfiles.load
    with pytest.raises(ValueError, match=words):
        read(tmp_path / name)


def test_files_that_are_not_there_or_not_text(tmp_path):
    with pytest.raises(FileNotFoundError, match="no such file"):
        GridMap.load(tmp_path / "no.map")
    (tmp_path / "a.map").write_bytes(b"type octile\xff\xfe")
    with pytest.raises(ValueError, match="not a text file"):
        GridMap.load(tmp_path / "a.map")


def test_nothing_is_half_written(tmp_path, monkeypatch):
    old = GridMap.from_ascii("#.")
    old.save(tmp_path / "a.map")
    monkeypatch.setattr("os.replace", lambda *_: (_ for _ in ()).throw(OSError("disk full")))
    with pytest.raises(OSError, match="disk full"):
        GridMap.from_ascii("..\n..").save(tmp_path / "a.map")
    monkeypatch.undo()
    assert same(GridMap.load(tmp_path / "a.map"), old)
    assert len(list(tmp_path.iterdir())) == 1
    with pytest.raises(FileNotFoundError, match="folder"):
        old.save(tmp_path / "no" / "a.map")


@pytest.mark.parametrize(
    "grid", [GridMap.from_ascii(".", 0.5), GridMap.from_ascii(".", 1.0, (1.0, 0.0)), GridMap.from_ascii("?")]
)
def test_what_a_format_cannot_hold_is_refused(tmp_path, grid):
    with pytest.raises(ValueError, match=r"save a \.yaml"):
        grid.save(tmp_path / "a.map")
    assert not list(tmp_path.iterdir())
