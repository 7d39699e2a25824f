"""Traditional DWA on the two maps of thesis 4, without anything unknown, for every setting that is not printed.

Not printed are the robot's radius, d_max, the heading at the start, and whether dist of eq 4.13 and 4.14 is taken
along the arc or at its end. A case is a text 'map/radius/d_max/heading/scored/bound'.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import product
from typing import Any, Literal, cast

from fuzzynav.dwa import fast
from fuzzynav.dwa.decision import Field
from fuzzynav.dwa.steps import TABLE_4_1
from fuzzynav.robot import THESIS
from fuzzynav.simulate.loop import Loop
from fuzzynav.simulate.record import Run
from fuzzynav.studies.planning.maps import SCENES_4
from fuzzynav.world import World

__all__ = ["AS_PRINTED", "CASES", "one_setting", "traditional"]

AS_PRINTED = replace(TABLE_4_1, distance="end", bound="as_printed", blind=False)
NAMES = ("M1", "M1 Manhattan", "M2", "M2 cut")
RADII, CUTS, HEADINGS = ("0.25", "0.30", "0.35", "0.40"), ("1", "2", "3"), ("0", "goal")
Way = Literal["arc", "end"]
CASES = tuple("/".join(c) for c in product(NAMES, RADII, CUTS, HEADINGS, ("arc", "end"), ("arc", "as_printed")))
TIME_LIMIT = 300.0  # [s]


@cache
def _scene(name: str) -> tuple[World, Field]:
    grid = SCENES_4[name].grid
    return World(grid=grid), Field.of(grid)


def traditional(case: str) -> Run:
    """The run of one setting, on the known map."""
    name, radius, cut, heading, scored, bound = case.split("/")
    scene = SCENES_4[name]
    start, goal = scene.grid.center_of([scene.start, scene.goal])
    world, field = _scene(name)
    params = replace(
        TABLE_4_1,
        distance=cast(Way, scored),
        bound=cast(Literal["arc", "as_printed"], bound),
        d_max=float(cut),
        blind=False,
    )
    turned = 0.0 if heading == "0" else None
    robot = replace(THESIS, radius=float(radius))
    return fast.drive(world, start, goal, params, field=field, robot=robot, t_max=TIME_LIMIT, loop=Loop(heading=turned))


def one_setting(case: str) -> dict[str, Any]:
    """The row of one setting."""
    run = traditional(case)
    v, omega = run.variation if run.iterations > 1 else (0.0, 0.0)
    return {
        "map": case.split("/")[0],
        "success": int(run.success),
        "status": run.status,
        "length": round(run.length, 3),
        "time": round(run.duration, 1),
        "clearance": round(run.min_clearance, 3),
        "variation_v": round(float(v), 3),
        "variation_omega": round(float(omega), 3),
    }
