"""The students' edition: the whole course without solutions, and the way back to an untouched notebook."""

from __future__ import annotations

import json
import re
import shutil
import subprocess
import tempfile
from datetime import datetime
from pathlib import Path
from typing import Any

from fuzzynav.course.folders import PRISTINE, notebooks_of, write_whole

__all__ = ["pristine", "reset", "student_notebook", "student_readme", "write_handout"]

FOLDERS = ("fuzzynav", "data", "tools", "docs")
FILES = ("Makefile", "README.md", "LICENSE", "CITATION.cff", "pyproject.toml", "constraints.txt", "environment.yml")
LEFT_OUT = shutil.ignore_patterns("__pycache__", "*.egg-info", ".ipynb_checkpoints", "*.pyc", "*.nbi", "*.nbc")


def write_handout(root: Path, target: Path) -> Path:
    """Write the students' edition of the course at `root` to `target`, replacing an older one whole."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix=".handout-", dir=target.parent) as scratch:
        fresh = Path(scratch) / "fresh"
        _fill(root, fresh)
        if target.exists():
            target.rename(Path(scratch) / "old")
        fresh.rename(target)
    return target


def student_notebook(path: Path) -> dict[str, Any]:
    """A notebook as students get it: exercise and check cells without outputs, no word of who answered what."""
    notebook: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code" and exercise_tag(cell, "exercise", "check"):
            cell["outputs"], cell["execution_count"] = [], None
    return notebook


def student_readme(text: str) -> str:
    """README without what a students' edition does not have: tests, solutions, the teacher's verbs."""
    text = re.sub(r"<!-- not for students -->\n.*?<!-- /not for students -->\n+", "", text, flags=re.S)
    return re.sub(r"(?m)^make test .*\n", "", text).replace("## Two commands", "## One command")


def exercise_tag(cell: dict[str, Any], *kinds: str) -> str:
    """The exercise that a cell belongs to by a tag such as `check:03.1`, or ''."""
    for tag in cell.get("metadata", {}).get("tags", []):
        kind, _, name = tag.partition(":")
        if kind in kinds:
            return str(name)
    return ""


def pristine(root: Path, name: str) -> str:
    """The text of a notebook as it was published: from the edition's own copy, else from git.

    Raises FileNotFoundError if neither has it.
    """
    copy = root / "notebooks" / PRISTINE / name
    if copy.is_file():
        return copy.read_text(encoding="utf-8")
    found = _git(root, "show", f"HEAD:./notebooks/{name}")
    if found is None:
        raise FileNotFoundError(
            f"no untouched copy of {name} was found: this folder is neither a students' edition nor a git checkout"
        )
    return found


def reset(root: Path, chapter: str) -> list[tuple[Path, Path | None]]:
    """Restore the notebooks of a chapter; each is returned with its backup (None if it was missing or untouched).

    Raises ValueError if the chapter does not exist.
    """
    names = sorted({p.name for p in notebooks_of(root, chapter)} | _published_names(root, chapter))
    if not names:
        raise ValueError(f"there is no notebook that begins with '{chapter}'; say for example NB=03")
    done = []
    for name in names:
        text, path = pristine(root, name), root / "notebooks" / name
        backup = _back_up(path) if path.exists() and path.read_bytes() != text.encode() else None
        write_whole(path, text)
        done.append((path, backup))
    return done


def _fill(root: Path, fresh: Path) -> None:
    for folder in (name for name in FOLDERS if (root / name).is_dir()):
        shutil.copytree(root / folder, fresh / folder, ignore=LEFT_OUT)
    for name in FILES:
        if (root / name).is_file():
            shutil.copy2(root / name, fresh / name)
    if (fresh / "README.md").exists():
        write_whole(fresh / "README.md", student_readme((fresh / "README.md").read_text(encoding="utf-8")))
    copies = fresh / "notebooks" / PRISTINE
    copies.mkdir(parents=True)
    for path in notebooks_of(root):
        text = json.dumps(student_notebook(path), indent=1, ensure_ascii=False) + "\n"
        write_whole(copies / path.name, text)
        write_whole(fresh / "notebooks" / path.name, text)
    for path in sorted((root / "notebooks").iterdir()):
        if path.is_dir() and path.name not in ("solutions", "backup", "saved", PRISTINE) and path.name[0] != ".":
            shutil.copytree(path, fresh / "notebooks" / path.name, ignore=LEFT_OUT)


def _back_up(path: Path) -> Path:
    folder = path.parent / "backup"
    folder.mkdir(exist_ok=True)
    moment = datetime.now().strftime("%Y-%m-%d_%H%M%S_%f")
    return Path(shutil.copy2(path, folder / f"{path.stem}.{moment}.ipynb"))


def _published_names(root: Path, chapter: str) -> set[str]:
    number = chapter.removesuffix(".ipynb")
    number = number.zfill(2) if number.isdigit() else number
    copies = [p.name for p in (root / "notebooks" / PRISTINE).glob("*.ipynb")]
    listed = copies or (_git(root, "ls-tree", "--name-only", "HEAD:./notebooks") or "").split()
    return {name for name in listed if name.startswith(number) and name.endswith(".ipynb")}


def _git(root: Path, *arguments: str) -> str | None:
    program = shutil.which("git")
    if program is None:
        return None
    done = subprocess.run([program, *arguments], cwd=root, capture_output=True, encoding="utf-8", check=False)
    return done.stdout if done.returncode == 0 else None
