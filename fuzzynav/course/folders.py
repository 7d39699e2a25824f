"""Where the course lies on this computer."""

from __future__ import annotations

from pathlib import Path

__all__ = ["course_root", "solutions_folder"]


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
