"""Where the course lies on this computer."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["PRISTINE", "course_root", "notebooks_of", "solutions_folder", "write_whole"]

PRISTINE = ".pristine"  # folder in notebooks/ of a students' edition, with the notebooks as handed out


def course_root(start: Path | None = None) -> Path:
    """The folder that holds `notebooks/` and `data/`: above `start` or the working directory, else beside the package.

    Raises FileNotFoundError if there is none.
    """
    here = (start or Path.cwd()).resolve()
    for folder in (here, *here.parents, Path(__file__).resolve().parents[2]):
        if (folder / "notebooks").is_dir() and (folder / "data" / "published").is_dir():
            return folder
    raise FileNotFoundError(f"no course found at {here}: a course folder holds notebooks/ and data/published/")


def solutions_folder() -> Path | None:
    """The folder of worked solutions, or None in an edition without them."""
    folder = course_root() / "notebooks" / "solutions"
    return folder if folder.is_dir() else None


def notebooks_of(root: Path, chapter: str = "") -> list[Path]:
    """The notebooks whose names begin with a chapter such as '03' ('3' will do), in reading order; all for ''."""
    number = chapter.removesuffix(".ipynb")
    number = number.zfill(2) if number.isdigit() else number
    return sorted(p for p in (root / "notebooks").glob("[0-9]*.ipynb") if p.name.startswith(number))


def write_whole(path: Path, text: str) -> None:
    """Write a text file so that a reader sees the old file or the new one, never a part."""
    fresh = path.with_name(path.name + ".new")
    fresh.write_text(text, encoding="utf-8")
    os.replace(fresh, path)
