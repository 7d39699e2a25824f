"""The package's own page lists its rooms."""

import re
from collections import Counter
from pathlib import Path

import fuzzynav


def test_every_room_is_on_the_map_once(home: Path) -> None:
    lines = re.findall(r"(?m)^- (.*)$", fuzzynav.__doc__ or "")
    listed = Counter(name for line in lines for name in re.findall(r"`(\w+)`", line))
    rooms = [p for p in (home / "fuzzynav").glob("[a-z]*") if p.suffix == ".py" or (p / "__init__.py").exists()]
    assert listed == Counter(path.stem for path in rooms)
