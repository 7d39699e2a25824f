"""The teacher's verbs: `python -m fuzzynav.course handout | grade FOLDER | reset CHAPTER`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from tqdm import tqdm

from fuzzynav.course.folders import course_root
from fuzzynav.course.grading import Grade, GradeFile, grade_folder, list_tasks
from fuzzynav.course.handout import reset, write_handout


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one verb; 0 on success, 2 (130 if interrupted) with one line on stderr otherwise."""
    options = _parser().parse_args(arguments)
    try:
        options.verb(options)
    except (OSError, ValueError) as error:
        print(f"fuzzynav: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("fuzzynav: interrupted; what was finished is kept", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m fuzzynav.course", description="the teacher's verbs")
    verbs = parser.add_subparsers(required=True, metavar="handout | grade | reset")
    handout = verbs.add_parser("handout", help="write the students' edition, without solutions")
    handout.add_argument("--out", type=Path, default=Path("handout"), help="folder to write (handout)")
    handout.set_defaults(verb=_handout)
    grade = verbs.add_parser("grade", help="grade FOLDER/STUDENT/NN_*.ipynb into a CSV")
    grade.add_argument("folder", type=Path)
    grade.add_argument("--notebook", default="", metavar="05", help="only the notebooks of this chapter")
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
    count = len(list_tasks(root, options.folder, options.notebook))
    file = GradeFile(options.out)
    if file.kept:
        print(f"the older {options.out.name} is kept as {file.kept.name}")
    with tqdm(total=count, desc="grading", unit="notebook", file=sys.stdout, disable=None) as bar:

        def report(grades: list[Grade]) -> None:
            file.append(grades)
            bar.update(1)

        limits = {"chapter": options.notebook, "seconds": options.seconds, "jobs": options.jobs}
        grades = grade_folder(root, options.folder, report=report, **limits)
    file.replace(grades)
    students = len({grade.student for grade in grades})
    print(f"{students} students, {len(grades)} exercises: {options.out}")


def _reset(options: argparse.Namespace) -> None:
    for path, backup in reset(course_root(), options.chapter):
        kept = f"; yours is kept as backup/{backup.name}" if backup else ""
        print(f"{path.name} is as it was handed out{kept}")


if __name__ == "__main__":
    sys.exit(main())
