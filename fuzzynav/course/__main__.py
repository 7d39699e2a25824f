"""The teacher's verbs: `python -m fuzzynav.course handout | grade FOLDER | reset CHAPTER`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

from fuzzynav.course.folders import course_root
from fuzzynav.course.grading import grade_folder, list_tasks, write_grades
from fuzzynav.course.handout import reset, write_handout


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb; 0 on success, 2 with one line on stderr otherwise."""
    options = _parser().parse_args(arguments)
    try:
        options.verb(options)
    except (OSError, ValueError) as error:
        print(f"fuzzynav: {error}", file=sys.stderr)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.course", description="the teacher's verbs")
    verbs = parser.add_subparsers(required=True, metavar="handout | grade | reset")
    handout = verbs.add_parser("handout", help="write the students' edition, without solutions")
    handout.add_argument("--out", type=Path, default=Path("handout"), help="folder to write (handout)")
    handout.set_defaults(verb=_handout)
    grade = verbs.add_parser("grade", help="grade FOLDER/STUDENT/NN_*.ipynb into a CSV")
    grade.add_argument("folder", type=Path)
    grade.add_argument("--out", type=Path, default=Path("grades.csv"), help="file to write (grades.csv)")
    grade.add_argument("--seconds", type=int, default=60, help="time limit for each cell (60)")
    grade.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="notebooks at once (one a core)")
    grade.set_defaults(verb=_grade)
    back = verbs.add_parser("reset", help="restore the notebooks of a chapter, keeping a backup")
    back.add_argument("chapter", help="for example 03")
    back.set_defaults(verb=_reset)
    return parser


def _handout(options: argparse.Namespace) -> None:
    target = write_handout(course_root(), options.out.resolve())
    count = len(list((target / "notebooks").glob("*.ipynb")))
    print(f"students' edition with {count} notebooks, without solutions: {options.out}")


def _grade(options: argparse.Namespace) -> None:
    root = course_root()
    count = len(list(list_tasks(root, options.folder)))
    with tqdm(total=count, desc="grading", unit="notebook", file=sys.stdout, disable=None) as bar:
        grades = grade_folder(root, options.folder, seconds=options.seconds, jobs=options.jobs, progress=bar.update)
    write_grades(grades, options.out)
    students = len({grade.student for grade in grades})
    print(f"{students} students, {len(grades)} exercises: {options.out}")


def _reset(options: argparse.Namespace) -> None:
    for path, backup in reset(course_root(), options.chapter):
        kept = f"; yours is kept as backup/{backup.name}" if backup else ""
        print(f"{path.name} is as it was handed out{kept}")


if __name__ == "__main__":
    sys.exit(main())
