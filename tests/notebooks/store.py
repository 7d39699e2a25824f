"""Run notebooks and store their results as the course keeps them.

    python tests/notebooks/store.py notebooks/03_*.ipynb

Kept: text, tables, small pictures, counts 1..n. Left out: widget views and state, timings, colours
of tracebacks. Ids follow from the source of a cell. A cell
that fails or writes to stderr stops the storing, and the file stays as it was.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import io
import os
import sys
import time
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError, DeadKernelError
from nbformat import NotebookNode
from PIL import Image

PICTURE_LIMIT = 60_000  # bytes
WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
CELL_SECONDS = 120


class NotStored(Exception):
    """A notebook that may not be stored; the message says which cell and why."""


def main() -> int:
    parser = argparse.ArgumentParser(description="run notebooks and store their results")
    parser.add_argument("notebooks", nargs="+", type=Path)
    failed = 0
    for path in parser.parse_args().notebooks:
        begin = time.perf_counter()
        try:
            store(path)
        except NotStored as error:
            failed += 1
            print(f"{path.name}: NOT stored. {error}", file=sys.stderr)
        else:
            print(f"{path.name}: stored after {time.perf_counter() - begin:.1f} s")
    return 1 if failed else 0


def store(path: Path) -> None:
    """Execute one notebook in its folder and write it back whole, or leave it untouched."""
    notebook = nbformat.read(path, as_version=4)
    execute(notebook, path.parent)
    clean(notebook, path.stem)
    nbformat.validate(notebook)
    fresh = path.with_suffix(".ipynb.new")
    fresh.write_text(nbformat.writes(notebook) + "\n", encoding="utf-8")
    os.replace(fresh, path)


def execute(notebook: NotebookNode, folder: Path) -> None:
    """Run all cells in the folder of the notebook; raises NotStored at the first failure."""
    os.environ.pop("FUZZYNAV_GRADE", None)
    client = NotebookClient(
        notebook,
        timeout=CELL_SECONDS,
        kernel_name="python3",
        store_widget_state=False,
        resources={"metadata": {"path": str(folder)}},
    )
    try:
        client.execute()
    except CellTimeoutError as error:
        raise NotStored(f"a cell ran longer than {CELL_SECONDS} s") from error
    except CellExecutionError as error:
        raise NotStored(f"a cell failed:\n{error}") from error
    except DeadKernelError as error:
        raise NotStored("the kernel died") from error


def clean(notebook: NotebookNode, stem: str) -> None:
    """Bring a notebook that was run to the form in which the course keeps it."""
    notebook.metadata = nbformat.from_dict(
        {
            "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
            "language_info": {"name": "python"},
        }
    )
    notebook.nbformat_minor = 5
    count, used = 0, set()
    for index, cell in enumerate(notebook.cells):
        cell.id = stable_id(cell, stem)
        while cell.id in used:
            cell.id += "x"
        used.add(cell.id)
        cell.metadata = nbformat.from_dict(metadata(cell))
        if cell.cell_type == "code":
            count += 1
            if not cell.source.strip():
                raise NotStored(f"cell {index} is empty")
            if cell.execution_count != count:
                raise NotStored(f"cell {index} was not run in order")
            cell.outputs = outputs(cell.outputs, index)
            for output in cell.outputs:
                if output.output_type == "execute_result":
                    output.execution_count = count


def stable_id(cell: NotebookNode, stem: str) -> str:
    """An id that follows from the source alone; exercise and check cells are named after their exercise."""
    tags = cell.metadata.get("tags", [])
    for kind in ("exercise", "check"):
        for tag in tags:
            if tag.startswith(kind + ":"):
                return f"{kind}-{tag.split(':')[1].replace('.', '-')}"
    return hashlib.sha256(f"{stem}\n{cell.source}".encode()).hexdigest()[:12]


def metadata(cell: NotebookNode) -> dict[str, object]:
    """Tags, and what nbgrader needs on stub and check cells."""
    tags = list(cell.metadata.get("tags", []))
    kept: dict[str, object] = {"tags": tags} if tags else {}
    for tag in tags:
        kind, _, name = tag.partition(":")
        if kind in ("exercise", "check"):
            kept["nbgrader"] = nbgrader(kind, name)
    return kept


def nbgrader(kind: str, name: str) -> dict[str, object]:
    """nbgrader's cell metadata, schema 3: the stub is the solution cell, the check the graded, locked one."""
    from fuzzynav.course import all_exercises

    known = all_exercises()
    if name not in known:
        raise NotStored(f"exercise {name} is not defined in fuzzynav/course")
    base = {"grade_id": f"{kind}-{name}".replace(".", "-"), "schema_version": 3, "task": False}
    if kind == "exercise":
        return {**base, "grade": False, "locked": False, "solution": True}
    return {**base, "grade": True, "locked": True, "solution": False, "points": known[name].points}


def outputs(found: list[NotebookNode], index: int) -> list[NotebookNode]:
    """The outputs worth keeping: one stream, no widget view, small pictures."""
    kept: list[NotebookNode] = []
    for output in found:
        if output.output_type == "error":
            raise NotStored(f"cell {index} ends in {output.ename}: {output.evalue}")
        if output.output_type == "stream":
            if output.name != "stdout":
                raise NotStored(f"cell {index} writes to stderr:\n{output.text}")
            if kept and kept[-1].output_type == "stream":
                kept[-1].text += output.text
                continue
        else:
            output.metadata = nbformat.from_dict({})
            output.data.pop(WIDGET_VIEW, None)
            if "image/png" in output.data:
                output.data["image/png"] = small(output.data["image/png"], index)
            if set(output.data) == {"text/plain"} and output.data["text/plain"].startswith("<Figure size"):
                raise NotStored(f"cell {index} shows the name of a figure instead of the figure")
        kept.append(output)
    return kept


def small(picture: str, index: int) -> str:
    """A PNG (base64) packed tightly; one above the limit is reduced to 256 colours."""
    with Image.open(io.BytesIO(base64.b64decode(picture))) as opened:
        image = opened.convert("RGB")
    packed = pack(image)
    for colours in (256, 64):
        if len(packed) > PICTURE_LIMIT:
            packed = pack(image.quantize(colours, dither=Image.Dither.NONE))
    if len(packed) > PICTURE_LIMIT:
        raise NotStored(f"the picture of cell {index} takes {len(packed)} bytes, the limit is {PICTURE_LIMIT}")
    return base64.b64encode(packed).decode("ascii") + "\n"


def pack(image: Image.Image) -> bytes:
    """The bytes of an image as PNG, as small as the encoder can make it."""
    buffer = io.BytesIO()
    image.save(buffer, format="png", optimize=True)
    return buffer.getvalue()


if __name__ == "__main__":
    sys.exit(main())
