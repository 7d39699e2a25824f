"""The answers to the labs of chapter 08."""

from __future__ import annotations

import numpy as np

from fuzzynav import blend
from fuzzynav.course.answers.answer import Answer
from fuzzynav.tracking.reference import FigureEight

__all__ = ["ANSWERS"]


def _breakpoints() -> str:
    half = FigureEight(duration=blend.LAP / 2.0)
    place = np.array([0.0, 1.9, 0.2, 0.3, 0.0])

    def run(*points: float) -> tuple[float, float]:
        system = blend.rule_base(*points)
        made = blend.drive(blend.PrintedScheme(gate=np.pi / 2.0), place, reference=half, system=system)
        return float(made.min_clearance), float(made.distance.max())

    first, best = run(0.5, 1.0, 1.0, 0.5), run(0.75, 1.0, 0.2, 0.9)
    return f"""Yes, a little. The first values pass with {first[0]:.2f} m, {first[1]:.2f} m off the reference. The
    peak of More at 0.9 makes F large early, and Zero up to 0.2 rad keeps the robot turning away from what is nearly
    ahead: with Close up to 0.75 m it passes with {best[0]:.2f} m, at a cost of {best[1]:.2f} m. More does not come
    from breakpoints: F never exceeds its ceiling of about 5/6, so tracking always pulls back."""


def _sides(gate: float) -> dict[float, int]:
    """Contacts of the printed blend in 100 for blocks 0.2 m to the outer (-) and the inner (+) side of the loop."""
    half = FigureEight(duration=blend.LAP / 2.0)
    shares = {}
    for offset in (-0.2, 0.2):
        hits, tried = 0, 0
        for share in np.linspace(0.2, 0.8, 9):
            here = half.sample(share * half.duration)
            (x, y, heading), side = here.pose, np.sign(here.omega)
            x, y = x - side * offset * np.sin(heading), y + side * offset * np.cos(heading)
            run = blend.drive(blend.PrintedScheme(gate=np.radians(gate)), [x, y, 0.2, 0.3, 0.0], reference=half)
            hits, tried = hits + (run.status == "collided"), tried + 1
        shares[offset] = round(100 * hits / tried)
    return shares


def _block() -> str:
    narrow, wide = _sides(45.0), _sides(90.0)
    return f"""Only beside the curve: with the printed gate of 45 degrees a block within 0.2 m of the reference is
    hit on either side (in {narrow[0.2]} of 100 places on the inner side of the bend, {narrow[-0.2]} on the outer),
    from 0.4 m on most are passed, as the robot would not have touched them anyway. A gate of 90 degrees changes it
    on the inner side, where it leaves {wide[0.2]} of 100, and less on the outer, {wide[-0.2]}: there the bend
    carries the robot back into the block once the gate shuts."""


ANSWERS = (Answer("08.lab1", _breakpoints), Answer("08.lab2", _block))
