"""Why a run from scans ended in a contact: what the scans had told of the mover when the last braking began."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from fuzzynav.fusion.moments import watch
from fuzzynav.studies.fusion.scenes import task_of
from fuzzynav.studies.fusion.tables import stored

__all__ = ["CAUSES", "cause", "contacts"]

CAUSES = ("occlusion", "reversal", "late track")
RIM = 0.05  # [m] a hit this near to a mover's rim is its own


def contacts() -> pd.DataFrame:
    """One row for each run of ours, from scans, that ended as hit; no rows where there is none."""
    table = stored("fusion_scenes")
    chosen = table[(table["ending"] == "hit") & (table["planner"] == "ours") & table["movers"].str.contains("scans")]
    return pd.DataFrame([cause(case) for case in chosen["case"]])


def cause(case: str) -> dict[str, Any]:
    """Drive a case anew and say why it ended in a contact.

    Looked at is the step before the robot braked for the last time. "occlusion": no beam had met the mover there;
    "reversal": it was seen, and walked otherwise than from then on; else "late track". `warning` [s] and `gap` [m] are
    what was left when the braking began, `stop` [m] is what the robot needed. Raises ValueError for a run without a
    contact.
    """
    task = task_of(case)
    made, steps = watch(task)
    if made.run is None or made.row["ending"] != "hit":
        raise ValueError(f"{case} ends as {made.row['ending']}: there is no contact to explain")
    places, last = made.run.log["movers"], made.run.poses[-1, :2]
    who = int(np.argmin(np.hypot(*(places[-1] - last).T)))
    first = next(k for k in range(len(steps)) if all(s.decision.braking for s in steps[k:]))
    before, seen = steps[max(first - 1, 0)], steps[first]
    radius = task.world.movers[who].radius
    hits = np.hypot(*(before.observation.points - places[max(first - 1, 0), who]).T) - radius
    steady = (places[-1, who] - places[first, who]) @ (places[first, who] - places[max(first - 1, 0), who]) > 0.0
    speed = float(seen.observation.velocity[0])
    return {
        "case": case,
        "cause": CAUSES[0] if not (np.abs(hits) < RIM).any() else CAUSES[2] if steady else CAUSES[1],
        "warning": (len(steps) - first) * task.dt,
        "gap": float(np.hypot(*(places[first, who] - seen.observation.pose[:2]))) - radius - task.robot.radius,
        "speed": speed,
        "stop": speed**2 / (2.0 * task.robot.dec_lim_x),
    }
