"""The course as a map: every chapter, the question it answers, its time and its place in the thesis."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fuzzynav.course.folders import course_root, notebooks_of

__all__ = ["CHAPTERS", "Chapter", "CourseMap", "chapters"]


@dataclass(frozen=True, slots=True)
class Chapter:
    """One planned chapter; `source` is the part of the thesis, or the paper, that it follows."""

    number: str
    title: str
    question: str
    minutes: int
    source: str


CHAPTERS: tuple[Chapter, ...] = (
    Chapter("00", "Start here", "What is in this course, and is everything installed?", 10, "-"),
    Chapter(
        "01",
        "Sensors and odometry",
        "What does a robot learn from wheel turns, echoes and pictures?",
        75,
        "1.3, 2.2, app. A",
    ),
    Chapter("02", "Localization and mapping", "Where am I, and what does the building look like?", 90, "1.4, 1.5"),
    Chapter("03", "Fuzzy sets and inference", "How do rules in words become a number?", 75, "2.4"),
    Chapter(
        "04",
        "Dynamic feedback linearization",
        "How does a robot follow a reference that moves in time?",
        90,
        "1.7, 2.2, 2.3",
    ),
    Chapter(
        "05",
        "Global planning",
        "Which way through a known map is short, and which is also smooth and safe?",
        90,
        "1.6, 3.1 to 3.3, 4.2",
    ),
    Chapter("06", "Dynamic window", "Which speed is safe now, and who sets the weights?", 90, "3.4 to 3.6"),
    Chapter(
        "07",
        "Plan and react",
        "How do a planner and a reactive controller share one robot, and stay safe among movers?",
        90,
        "1.6.5, 4.3 to 4.5",
    ),
    Chapter(
        "08",
        "Fuzzy feedback linearization",
        "How does a robot leave its path for an obstacle and return?",
        75,
        "2.5, 5.1 to 5.4",
    ),
    Chapter("09", "Potential fields", "Can forces alone lead a robot to its goal?", 75, "paper on potential fields"),
    Chapter("10", "Evolved rules", "Can evolution write the fuzzy rules?", 75, "paper on evolved fuzzy control"),
    Chapter("11", "Unknown worlds", "What can a robot do without any map?", 75, "paper on the fuzzy planner"),
    Chapter("12", "Real robots", "What changes with physics, networks and ROS?", 60, "1.8, 5.2, 5.4, app. B"),
)


class CourseMap:
    """The chapters as a table; those that are present are links."""

    def __init__(self, root: Path | None = None) -> None:
        self._root = root or course_root()
        self.present = [c for c in CHAPTERS if notebooks_of(self._root, c.number)]

    def rows(self, folder: str = "") -> list[tuple[str, str, str, str]]:
        """Chapter with links to its notebooks, question, minutes, source; `folder` stands before each link."""
        return [(self._name(c, folder), c.question, str(c.minutes), c.source) for c in CHAPTERS]

    def markdown(self, folder: str = "") -> str:
        """The table in Markdown."""
        head = "| Chapter | The question it answers | Minutes | Thesis |\n| --- | --- | --- | --- |\n"
        return head + "\n".join("| " + " | ".join(row) + " |" for row in self.rows(folder))

    def __repr__(self) -> str:
        return "Course map: " + ", ".join(f"{c.number} {c.title}" for c in self.present)

    def _repr_markdown_(self) -> str:
        return self.markdown()

    def _name(self, chapter: Chapter, folder: str) -> str:
        found = notebooks_of(self._root, chapter.number)
        if not found:
            return f"{chapter.number} {chapter.title} (to come)"
        if len(found) == 1:
            return f"[{chapter.number} {chapter.title}]({folder}{found[0].name})"
        parts = ", ".join(f"[{p.stem.split('_')[0]}]({folder}{p.name})" for p in found)
        return f"{chapter.number} {chapter.title}: {parts}"


def chapters() -> CourseMap:
    """The map of the course, as a table with links."""
    return CourseMap()
