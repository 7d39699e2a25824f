"""The report of a comparison: one page that needs nothing else, and a table for other programs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np
import pandas as pd

from fuzzynav import __version__
from fuzzynav.benchmark.cases import Case, planner_code, run_again
from fuzzynav.benchmark.players import PLAYER_SCRIPT, player_html
from fuzzynav.benchmark.tasks import TaskSet
from fuzzynav.fusion import barn
from fuzzynav.fusion.protocol import PROTOCOL, TIMED, fingerprint, summary
from fuzzynav.plot.benchmark import comparison_svg

__all__ = ["Comparison", "page", "summary_table", "worst_cases"]

RATED = ("reached", "hit", "struck", "late", "failed")
BADNESS = {"hit": 0, "struck": 1, "late": 2, "reached": 3}
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 62em; margin: 2em auto; padding: 0 1em; color: #222; }
table { border-collapse: collapse; margin: 1em 0; } th, td { border-bottom: 1px solid #ddd; padding: .25em .7em; }
th { text-align: left; } td { text-align: right; } td:first-child, .about td { text-align: left; }
td small { color: #666; white-space: nowrap; } .about th { white-space: nowrap; }
.scroll { overflow-x: auto; } svg { max-width: 100%; height: auto; } code { overflow-wrap: anywhere; }
.players { display: flex; flex-wrap: wrap; gap: 1.5em; } figure { margin: 0; } canvas { border: 1px solid #ccc; }
.player div { display: flex; gap: .6em; align-items: center; } input { flex: 1; }
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """What was asked, and the rows that came."""

    tasks: TaskSet
    methods: tuple[str, ...]
    table: pd.DataFrame
    command: str
    step_limit: float


def summary_table(found: Comparison) -> pd.DataFrame:
    """One row a planner: counts, rates with intervals, medians, the score where the set has one, and what was run."""
    table = summary(found.table)
    if found.tasks.kind == "barn":
        won = found.table["ending"] == "reached"
        scored = found.table.assign(score=barn.score(won, found.table["time"], found.table["optimum"]))
        table.insert(3, "score", table["method"].map(scored.groupby("method")["score"].mean()))
    parts = {"planner_code": [planner_code(m) for m in table["method"]], "tasks_code": found.tasks.code()}
    about = {"protocol": PROTOCOL, "version": __version__, "fingerprint": fingerprint(found.table), **parts}
    return table.assign(**about)


def worst_cases(table: pd.DataFrame, each: int) -> pd.DataFrame:
    """For each planner the `each` worst rows that there is a run of: contacts, then what came late, then long ways."""
    driven = table[table["ending"].isin(BADNESS)]
    ranked = driven.assign(badness=driven["ending"].map(BADNESS), ratio=driven["ratio"].fillna(0.0)).sort_values(
        ["badness", "ratio", "case"], ascending=[True, False, True], kind="stable"
    )
    return pd.concat([ranked[ranked["method"] == name].head(each) for name in table["method"].drop_duplicates()])


def page(found: Comparison, players: int = 2) -> str:
    """The report as HTML; `players` worst cases of each planner are driven once more and can be played."""
    total = summary(found.table)
    parts = [
        f"<h1>Benchmark: {escape(found.tasks.kind)}</h1>",
        _about(found),
        "<h2>How the runs ended</h2>",
        f'<div class="scroll">{_table(_readable(summary_table(found)))}</div>',
        "<p>Below each share its 95 % Wilson interval, of the tasks that can be solved. Medians are of the runs that "
        "reached the goal. Compute times depend on the machine and its load; all other numbers repeat exactly.</p>",
        comparison_svg(total, found.table),
        _by_class(found),
        _pairs(found),
        _reasons(found.table),
        _players(found, players),
    ]
    head = '<!doctype html><html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
    title = f"<title>Benchmark: {escape(found.tasks.kind)}</title><style>{STYLE}</style>"
    return f"{head}{title}<body>{''.join(parts)}<script>{PLAYER_SCRIPT}</script></body></html>\n"


# --- parts of the page --------------------------------------------------------------------------


def _about(found: Comparison) -> str:
    """What was run, so that another person can run the same."""
    items = found.table["item"].drop_duplicates().tolist()
    facts = {
        "protocol": PROTOCOL,
        "package": f"fuzzynav {__version__}",
        "command": found.command,
        **{name: value for name, value in found.tasks.parameters().items() if name != "kind"},
        "tasks": f"{len(items)}: {', '.join(items[:8])}{' ...' if len(items) > 8 else ''} to {items[-1]}",
        "code of tasks and protocol": found.tasks.code(),
        **{f"planner {method}": planner_code(method) for method in found.methods},
        "fingerprint of the rows": fingerprint(found.table),
    }
    rows = "".join(f"<tr><th>{escape(k)}</th><td><code>{escape(str(v))}</code></td></tr>" for k, v in facts.items())
    same = (
        "Two reports may be compared where protocol, code of tasks, set and options agree. The same fingerprint means "
        "the same runs."
    )
    return f'<div class="scroll"><table class="about">{rows}</table></div><p>{same}{_differences(found.tasks.kind)}</p>'


def _differences(kind: str) -> str:
    if kind == "scenes":
        return ""
    return (
        " Worlds, start, goal, time limit and score are the benchmark's own. Its runs are made in Gazebo, these by a "
        "kinematic robot without slip and lag that is a disc round the whole vehicle: the same worlds, a cleaner robot."
    )


def _readable(table: pd.DataFrame) -> pd.DataFrame:
    """The table for people: rates with their intervals in one cell, digits that mean something."""
    shown = pd.DataFrame({"planner": table["method"], "tasks": table["runs"], "unsolvable": table["unsolvable"]})
    for name in RATED:
        rates = zip(table[name], table[f"{name} rate"], table[f"{name} low"], table[f"{name} high"])
        shown[name] = [
            f"{count}<br>{_share(r)} %<br><small>{_share(a)}-{_share(b)}</small>" for count, r, a, b in rates
        ]
    if "score" in table:
        shown["score"] = [f"{x:.3f}" for x in table["score"]]
    units = {"time": "time [s]", "length": "length [m]", "ratio": "length / optimum", "clearance": "clearance [m]"}
    for name, title in units.items():
        shown[title] = [_digits(x) for x in table[f"median {name}"]]
    for name, title in zip(TIMED, ("step [ms], median", "step [ms], p99")):
        shown[title] = [_digits(x) for x in table[f"median {name}"]]
    return shown


def _share(value: float) -> str:
    return "-" if np.isnan(value) else f"{100.0 * value:.1f}"


def _digits(value: float) -> str:
    return "-" if np.isnan(value) else f"{value:.2f}"


def _table(table: pd.DataFrame, safe: Sequence[str] = RATED) -> str:
    """A table as HTML; texts are escaped but in the columns made here."""
    head = "".join(f"<th>{escape(str(c))}</th>" for c in table)
    rows = []
    for values in table.itertuples(index=False):
        cells = [str(v) if c in safe else escape(str(v)) for c, v in zip(table, values)]
        rows.append("<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>")
    return f"<table><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody></table>"


def _by_class(found: Comparison) -> str:
    """The same by class of the tasks, where there are several."""
    if found.table["group"].nunique() < 2:
        return ""
    named = found.table.assign(method=found.table["method"] + ", " + found.table["group"])
    return f'<h2>By class</h2><div class="scroll">{_table(_readable(summary(named)))}</div>'


def _pairs(found: Comparison) -> str:
    """The first planner against each other one, task by task."""
    if len(found.methods) < 2:
        return ""
    by_task = {m: found.table[found.table["method"] == m].set_index("item") for m in found.methods}
    first, rows = found.methods[0], []
    for other in found.methods[1:]:
        won = [(by_task[m]["ending"] == "reached") for m in (first, other)]
        both = won[0] & won[1]
        gap = (by_task[other]["time"] - by_task[first]["time"])[both].median()
        counts = (int(both.sum()), int((won[0] & ~won[1]).sum()), int((won[1] & ~won[0]).sum()))
        rows.append((other, *counts, "-" if np.isnan(gap) else f"{gap:+.2f}"))
    titles = ("planner", "both reached", f"only {first}", "only this one", f"time more than {first} [s], median")
    return f"<h2>Task by task, against {escape(first)}</h2>{_table(pd.DataFrame(rows, columns=list(titles)))}"


def _reasons(table: pd.DataFrame) -> str:
    """What failed, and the statuses of what came late."""
    told = table[table["ending"].isin(["failed", "late"])]
    if told.empty:
        return ""
    reasons = told.assign(said=told["reason"].where(told["reason"] != "", told["status"]))
    counts = reasons.groupby(["method", "ending", "said"], sort=False).size().reset_index(name="runs")
    return f"<h2>Failed and late, by reason</h2>{_table(counts)}"


def _players(found: Comparison, each: int) -> str:
    """The worst cases, driven once more; a run that does not repeat is called so."""
    shown = []
    for row in worst_cases(found.table, each).to_dict("records"):
        case = Case(method=str(row["method"]), item=str(row["item"]))
        again = run_again(case, found.tasks, found.step_limit)
        if again.run is None:
            continue
        title = f"{row['method']}, {row['task']}: {row['ending']} after {row['time']:.1f} s"
        title += "" if _same(row, again.row) else " (DID NOT REPEAT: this planner keeps something from run to run)"
        shown.append(player_html(again.run, found.tasks.task(case.item).world, title))
    return f'<h2>Worst cases</h2><div class="players">{"".join(shown)}</div>' if shown else ""


def _same(row: Mapping[Any, Any], again: Mapping[str, Any]) -> bool:
    """Whether a run repeated what its row says."""
    return all(row[k] == again[k] for k in ("ending", "status", "steps", "time", "length", "clearance"))
