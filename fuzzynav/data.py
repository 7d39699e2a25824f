"""Where the course's data lie: beside the package in a checkout, inside it once it is installed."""

from __future__ import annotations

from pathlib import Path

__all__ = ["folder"]

PACKAGE = Path(__file__).resolve().parent


def folder(name: str) -> Path:
    """The folder of one kind of data: maps, fuzzy, published, results, logs or benchmarks.

    Raises FileNotFoundError if there is no such folder.

    >>> (folder("fuzzy") / "thesis_table_3_2.fll").is_file()
    True
    """
    for root in (PACKAGE.parent / "data", PACKAGE / "_data"):
        if (root / "published" / "claims.csv").is_file():
            if not (root / name).is_dir():
                known = ", ".join(sorted(p.name for p in root.iterdir() if p.is_dir()))
                raise FileNotFoundError(f"there is no data folder {name}; there are: {known}")
            return root / name
    raise FileNotFoundError("the course's data are missing: install the package anew, or use a whole checkout")
