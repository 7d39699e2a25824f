"""Small wrong changes of the code, each of which some test must notice. By hand: `python tests/mutants.py`.

Each change of `MUTANTS`, below, is made in a private copy of the project, and the tests that should turn red are run
there. What stays green is a survivor: a test is missing, or the change makes no difference. A run that does not end
counts as noticed.
"""

# ruff: noqa: E501 - it quotes lines of other files
from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Collection, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

HOME = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(HOME))

from fuzzynav.stale import kernel_digest  # noqa: E402

COPIED = ("fuzzynav", "tests", "data", "notebooks", "pyproject.toml")
TIMEOUT = 150.0  # [s] for the tests of one change, compiling included
IMPORTED = re.compile(r"^\s*from (fuzzynav[\w.]*) import (\([^)]*\)|[^#\n]*)", re.MULTILINE)
TOLD: dict[str, Any] = {"stdout": subprocess.PIPE, "stderr": subprocess.STDOUT}
WORDS = {0: "survived", 1: "killed"}  # by pytest's code; any other means that the tests did not run


@dataclass(frozen=True, slots=True)
class Mutant:
    """One small wrong change of one file, and the tests that must notice it.

    equivalent: why the change makes no difference, in one sentence; such a change is not run. plain: the kernels are
    not compiled, which is quicker for a few small calls.
    """

    path: str
    old: str
    new: str
    tests: str
    why: str
    equivalent: str = ""
    plain: bool = False

    @property
    def room(self) -> str:
        """The room of the changed file: 'planning', 'published', ..."""
        return PurePosixPath(PurePosixPath(self.path).parts[1]).stem


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the chosen changes one after the other and print what became of each; 1 if one survived or did not run."""
    parser = argparse.ArgumentParser(description="small wrong changes that tests must notice")
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help="only these: planning, course, ... (default: all)")
    parser.add_argument("--jobs", type=int, default=1, help="how many at once (default: 1)")
    parser.add_argument("--list", action="store_true", help="say what there is and run nothing")
    parser.add_argument("--only", default="", metavar="TEXT", help="only changes whose reason holds this text")
    parser.add_argument("--clean", action="store_true", help="change nothing: everything must survive")
    options = parser.parse_args(arguments)
    known = dict.fromkeys(m.room for m in MUTANTS)
    if unknown := set(options.rooms) - set(known):
        parser.error(f"no changes for {', '.join(sorted(unknown))}; there are some for {', '.join(known)}")
    chosen = [m for m in MUTANTS if m.room in (options.rooms or known) and options.only in m.why]
    if options.list:
        for mutant in chosen:
            print(
                f"{mutant.room:12} {mutant.why}" + (f" (no difference: {mutant.equivalent})" * bool(mutant.equivalent))
            )
        return 0
    with ThreadPoolExecutor(options.jobs) as pool:
        told = [pool.submit(tried, m, options.clean) for m in chosen if not m.equivalent]
        found = Counter(said.result() for said in told)
    skipped = sum(bool(m.equivalent) for m in chosen)
    print("; ".join([*(f"{count} {word}" for word, count in found.items()), f"{skipped} make no difference"]))
    return int(bool(found.keys() - {"survived" if options.clean else "killed"}))


def tried(mutant: Mutant, clean: bool = False) -> str:
    """What became of one change: 'killed', 'survived' or 'not run'; prints it with its time. clean: change nothing."""
    began = time.perf_counter()
    with tempfile.TemporaryDirectory(prefix="fuzzynav-mutant-", ignore_cleanup_errors=True) as scratch:
        place = copied(Path(scratch))
        if not clean:
            applied(mutant, place)
        command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *shlex.split(mutant.tests)]
        environment = {**os.environ, "PYTHONPATH": str(place)} | ({"NUMBA_DISABLE_JIT": "1"} if mutant.plain else {})
        environment.pop("NUMBA_CACHE_DIR", None)
        done = subprocess.Popen(command, cwd=place, env=environment, text=True, start_new_session=True, **TOLD)
        try:
            output = done.communicate(timeout=TIMEOUT)[0]
            word = WORDS.get(done.returncode, "not run")
        except subprocess.TimeoutExpired:
            os.killpg(done.pid, signal.SIGKILL)  # with the workers that it started
            done.communicate()
            word, output = "killed", "ERROR it did not end"
    red = next((line.split(" - ")[0] for line in output.splitlines() if line.startswith(("FAILED", "ERROR"))), "")
    print(f"{word:8} {time.perf_counter() - began:5.0f} s  {mutant.room}: {mutant.why}   {red}", flush=True)
    if word == "not run":
        print(output[-1500:], flush=True)
    return word


def copied(scratch: Path) -> Path:
    """A copy of what the tests need, with everything that was compiled."""
    place = scratch / "project"
    for name in COPIED:
        if (HOME / name).is_dir():
            shutil.copytree(HOME / name, place / name)
        else:
            shutil.copy2(HOME / name, place / name)
    return place


def applied(mutant: Mutant, place: Path) -> None:
    """Make the change; forget the kernels of the file and of the kernels that import it, and keep the others."""
    package, path = place / "fuzzynav", place / mutant.path
    before = kernel_digest(package)
    path.write_text(changed(mutant, path.read_text(encoding="utf-8")), encoding="utf-8")
    after = kernel_digest(package)
    if before == after:
        return
    texts = {p.relative_to(place).as_posix(): p.read_text(encoding="utf-8") for p in package.rglob("*.py")}
    users = {name: imports(text, texts) for name, text in texts.items() if "njit" in text}
    touched = {mutant.path}
    while more := {name for name, used in users.items() if used & touched} - touched:
        touched |= more
    for name in touched:
        for kept in (place / name).parent.glob(f"__pycache__/{Path(name).stem}.*.nb?"):
            kept.unlink()
    stamp = package / "__pycache__" / "kernels.sha256"
    if stamp.exists():  # or the package would forget all of them
        stamp.write_text(after)


def changed(mutant: Mutant, text: str) -> str:
    """The text with the change; ValueError unless its old part stands there once."""
    count = text.count(mutant.old)
    if count != 1 or mutant.old == mutant.new:
        raise ValueError(f"{mutant.path}: {mutant.old!r} stands there {count} times, once is needed ({mutant.why})")
    return text.replace(mutant.old, mutant.new)


def imports(text: str, sources: Collection[str]) -> set[str]:
    """The files of the package that a file imports from."""
    found = set()
    for module, names in IMPORTED.findall(text):
        base = module.replace(".", "/")
        ends = (base, *(f"{base}/{name.split(' as ')[0].strip()}" for name in names.strip("()").split(",")))
        found |= {f"{end}{tail}" for end in ends for tail in (".py", "/__init__.py")} & set(sources)
    return found


# --- the changes: `old` stands exactly once in its file -------------------------------------------

ROBOT, SENSORS = "tests/robot/test_robot.py", "tests/sensors/test_sensors.py"
LOCAL, MAPPING = "tests/localization/test_localization.py", "tests/mapping/test_mapping.py"
GRID, RAYS, FILES = "tests/maps/test_gridmap.py", "tests/maps/test_rays.py", "tests/maps/test_files.py"
WORLD, MOVERS = "tests/world/test_world.py", "tests/world/test_movers.py"
ASTAR, SIGHT = "tests/planning/test_astar.py", "tests/planning/test_visibility.py"
SMOOTH, SIMULATE = "tests/smoothing/test_smoothing.py", "tests/simulate/test_simulate.py"
UNSEEN, MOVING = "tests/dwa/test_sight.py", "tests/dwa/test_moving.py"
TRACK, BLEND, DWA = "tests/tracking/test_tracking.py", "tests/blend/test_blend.py", "tests/dwa/test_dwa.py"
INFER, MEMBER = "tests/fuzzy/test_inference.py", "tests/fuzzy/test_membership.py"
SYSTEM, SHAPES = "tests/fuzzy/test_system.py", "tests/fuzzy/test_shapes.py"
SEPARATION, DECISION = "tests/fusion/test_separation.py", "tests/fusion/test_decision.py"
SCENES, FIELDS = "tests/fusion/test_scenes.py", "tests/potential/test_fields.py"
MEMORY = "tests/fusion/test_memory_and_route.py"
WALKS, HARMONIC = "tests/potential/test_walks.py", "tests/potential/test_harmonic.py"
BATCH, PUBLISHED, STUDIES = "tests/test_batch.py", "tests/test_published.py", "tests/studies/test_studies.py"
COURSE, ANSWERS = "tests/course/test_course.py", "tests/course/test_answers.py"

MUTANTS: tuple[Mutant, ...] = (
    # --- robot
    Mutant("fuzzynav/robot/kernels.py", "half = 0.5 * omega * dt\n    chord", "half = omega * dt\n    chord",
           f"{ROBOT} -k 'integral_of_the_rate or two_halves'", "the chord of an arc leans by the whole turn", plain=True),
    Mutant("fuzzynav/robot/kernels.py", "(v + loss) * ratio)\n    down", "v + loss)\n    down",
           f"{ROBOT} -k braking_uses_its_own", "after a reversal the robot speeds up as it brakes", plain=True),
    Mutant("fuzzynav/robot/kernels.py", "if -np.pi <= angle < np.pi:", "if -np.pi <= angle <= np.pi:",
           f"{ROBOT} -k 'told_in_one_way'", "the kernel's wrap keeps pi", plain=True),
    Mutant("fuzzynav/robot/kernels.py", "mean = plant.lag / dt * (1.0 - fade)", "mean = 1.0 - fade",
           f"{ROBOT} -k motors_that_lag", "motors that lag drive the last speed of a step, not the mean", plain=True),
    Mutant("fuzzynav/robot/kernels.py", "(1.0 + plant.left) * (1.0 - slip[1])", "(1.0 + plant.left) * (1.0 - slip[0])",
           f"{ROBOT} -k 'own_slip'", "the left wheel slips as the right one", plain=True),
    Mutant("fuzzynav/robot/kinematics.py", "np.where(total == 0.0, np.nan, np.inf)", "np.inf",
           f"{ROBOT} -k turning_radius", "a robot at rest turns about infinity"),
    Mutant("fuzzynav/robot/dynamics.py", "robot.track / (2.0 * robot.wheel_radius)", "robot.track / robot.wheel_radius",
           f"{ROBOT} -k torque", "torques turn with the whole track for a lever"),
    # --- maps
    Mutant("fuzzynav/maps/kernels.py", "t += skip[j, i] - 0.72", "t += skip[j, i]",
           f"{GRID} {RAYS} -k 'jumping or exact_arithmetic'", "a ray leaps as far as the field says"),
    Mutant("fuzzynav/maps/kernels.py", "else:  # through a corner: either side cell stops the ray",
           "elif True:\n            t, i, j = max(t, min(tx, ty)), i + step_x, j + step_y\n        else:",
           f"{GRID} -k corner", "a ray slips between two squares that meet in a corner", plain=True),
    Mutant("fuzzynav/maps/kernels.py", "squared = (bx - ax) ** 2 + (by - ay) ** 2", "squared = abs(bx - ax) + abs(by - ay)",
           f"{GRID} -k far_from_both_ends", "the foot on a segment is scaled by its length in steps", plain=True),
    Mutant("fuzzynav/maps/kernels.py", "while ring - 0.5 - 0.7072 <= best + away", "while ring <= inner",
           f"{GRID} -k distance_of_any_point", "only one ring of squares is asked for the distance"),
    Mutant("fuzzynav/maps/gridmap.py", "< radius / self.resolution - kernels.EDGE", "<= radius / self.resolution",
           f"{GRID} -k only_touches", "a disc that touches counts as overlapping"),
    Mutant("fuzzynav/maps/gridmap.py", "self.occupied | self.unknown, self", "self.occupied & ~self.unknown, self",
           f"{GRID} tests/maps/test_files.py tests/planning", "unknown cells are read as free"),
    Mutant("fuzzynav/maps/movingai.py", "(gx, height - 1 - gy)", "(gx, gy)",
           f"{FILES} -k scenarios", "a goal's row is counted from above"),
    Mutant("fuzzynav/maps/movingai.py", "np.uint8))[::-1].copy()", "np.uint8)).copy()",
           f"{FILES} -k movingai", "the rows of a .map are not turned over"),
    Mutant("fuzzynav/maps/rosmaps.py", "(chance > high)[grey]", "(chance >= high)[grey]",
           f"{FILES} -k thresholds", "a cell at the threshold is occupied"),
    # --- fuzzy
    Mutant("fuzzynav/fuzzy/engine.py", "fires[p] or h[k, p] > 0.0", "fires[p] or h[k, p] >= 0.0",
           f"{INFER} -k no_rule_no_number", "an output is heard although nothing fires",
           equivalent="where no set is concluded every defuzzifier gives nan, and nan is settled as silence is"),
    Mutant("fuzzynav/fuzzy/engine.py", "value = answer + centre", "value = answer",
           f"{INFER} -k 'worked_example or range'", "an answer is not moved back to its range"),
    Mutant("fuzzynav/fuzzy/engine.py", "width = min(wide, n - start)", "width = wide if n <= wide else min(wide, n - start - 1) or 1",
           f"{INFER} {SYSTEM} -k 'batch_equals or short_block'", "the last point of a short block is lost"),
    Mutant("fuzzynav/fuzzy/engine.py", "firing[operand, p] = weights[operand] * stack[top, p]", "firing[operand, p] = stack[top, p]",
           f"{INFER} tests/fuzzy/test_adversary.py -k 'compiled_equals or long_rules or plain_sum'", "long rules forget their weight"),
    Mutant("fuzzynav/fuzzy/kernels.py", "math.sqrt(m / 2.0) if m <= 0.5", "math.sqrt(m) / 2.0 if m <= 0.5",
           f"{SHAPES} -k hedge", "'seldom' takes the root before halving", plain=True),
    Mutant("fuzzynav/fuzzy/kernels.py", "return min(a, b) if a + b > 1.0 else 0.0", "return min(a, b) if a + b >= 1.0 else 0.0",
           f"{SHAPES} {MEMBER} -k operator", "the nilpotent minimum holds at a + b = 1", plain=True),
    Mutant("fuzzynav/fuzzy/defuzzify.py", "left * (2.0 * a + b) + right * (a + 2.0 * b)", "left * (a + 2.0 * b) + right * (2.0 * a + b)",
           f"{INFER} -k 'defuzzifiers'", "the exact moment weighs the far ends"),
    Mutant("fuzzynav/fuzzy/defuzzify.py", "(np.cumsum(areas) >= 0.5 * total)", "(np.cumsum(areas) >= total)",
           f"{INFER} -k 'defuzzifiers'", "the bisector asks for the whole area"),
    Mutant("fuzzynav/fuzzy/operators.py", "a * b / (2.0 - (a + b - a * b))", "a * b / (2.0 - (a + b + a * b))",
           f"{SHAPES} {MEMBER} -k operator", "Einstein's product with a plus"),
    Mutant("fuzzynav/fuzzy/set_kernels.py", "total += sampled[codes.WEIGHTS, s] * u", "total += u",
           f"{INFER} -k 'weigh_the_samples'", "single points forget the weights of the samples"),
    # --- world
    Mutant("fuzzynav/world/kernels.py", "+ min(max(across, up), 0.0))", ")",
           f"{WORLD} -k clearance", "inside a rectangle the clearance is 0", plain=True),
    Mutant("fuzzynav/world/kernels.py", "px, py = -(c * u + s * v), -(c * v - s * u)", "px, py = -(c * u - s * v), -(c * v + s * u)",
           f"{WORLD} -k 'end_on_a_surface'", "rectangles are turned the other way for rays"),
    Mutant("fuzzynav/world/kernels.py", "low, high = int(begin / step) - 1, int((begin + 2.0 * half) / step) + 1",
           "low, high = int(begin / step) + 1, int((begin + 2.0 * half) / step) - 1",
           f"{WORLD} -k 'even_beams'", "the window of beams is a beam too narrow on each side"),
    Mutant("fuzzynav/world/kernels.py", "s = 2.0 * total - s if back else s", "s = s - total if back else s",
           f"{WORLD} -k 'patrol or known_answers'", "a patrol leaps to its start instead of turning round"),
    Mutant("fuzzynav/world/kernels.py", "speed *= min(max(2.0 * gap", "speed *= max(max(2.0 * gap",
           f"{WORLD} -k 'yielding'", "movers that yield drive on"),
    Mutant("fuzzynav/world/kernels.py", "and dx * away_x + dy * away_y > 0.0:", ":",
           f"{WORLD} -k 'yielding'", "a mover yields also to a robot behind it"),
    Mutant("fuzzynav/world/kernels.py", "return bool(nearest < here and nearest < robot[2]", "return bool(nearest < robot[2]",
           f"{MOVERS} -k 'waits_only'", "a courteous mover waits for a robot that it leaves behind"),
    Mutant("fuzzynav/world/kernels.py", "new[k], walked[k], speed, step = positions[k], travelled[k], 0.0, 0.0", "new[k], speed, step = positions[k], 0.0, 0.0",
           f"{MOVERS} -k 'goes_on'", "the clock of a mover that waits runs on"),
    Mutant("fuzzynav/world/timed.py", "best = min(best, nearest_on_line(px, py, px + vx * step, py + vy * step, x, y))", "best = min(best, best)",
           f"{MOVERS} -k 'passes_through'", "what a timed mover passes within a step is not looked at"),
    # --- sensors
    Mutant("fuzzynav/sensors/laser.py", "np.where(ranges >= laser.range_max, np.inf, ranges)", "np.where(ranges > laser.range_max, np.inf, ranges)",
           f"{SENSORS} -k 'laser'", "a beam that met nothing reports range_max"),
    Mutant("fuzzynav/sensors/laser.py", "return speed * np.asarray(time, dtype=float) / 2.0", "return speed * np.asarray(time, dtype=float)",
           f"{SENSORS} fuzzynav/sensors/laser.py -k 'printed_speed or laser_range'", "light does not return"),
    Mutant("fuzzynav/sensors/sonar.py", "<= sonar.specular_angle)", "<= 2.0 * sonar.specular_angle)",
           f"{SENSORS} -k 'sonar'", "a sonar hears twice as slanted a wall"),
    Mutant("fuzzynav/sensors/encoders.py", "travel = np.stack([moved[:, 0] + half, moved[:, 0] - half], axis=-1) / (1.0 - encoders.slip)",
           "travel = np.stack([moved[:, 0] + half, moved[:, 0] - half], axis=-1) * (1.0 + encoders.slip)",
           f"{SENSORS} -k 'each_fault'", "slip adds its share instead of dividing by what is left"),
    Mutant("fuzzynav/sensors/encoders.py", "encoders.slip_noise * np.sqrt(np.abs(travel))", "encoders.slip_noise * np.abs(travel)",
           f"{SENSORS} -k 'slip_noise'", "uneven slip grows with the way"),
    Mutant("fuzzynav/sensors/cameras.py", "np.where(p[..., 2] > 0.0, p[..., 2], np.nan)", "np.where(p[..., 2] != 0.0, p[..., 2], np.nan)",
           f"{SENSORS} -k 'not_in_front'", "points behind the camera are seen"),
    # --- localization
    Mutant("fuzzynav/localization/particles.py", "match = float(swarm.weights @ np.exp(log / used))", "match = float(swarm.weights @ np.exp(log))",
           f"{LOCAL} -k 'match_of_a_scan'", "the match is no mean over beams"),
    Mutant("fuzzynav/localization/particles.py", "or v >= occupied.shape[0] or occupied[v, u]:", "or v >= occupied.shape[0]:",
           f"{LOCAL} -k 'cannot_be'", "a pose inside an obstacle is as good as any"),
    Mutant("fuzzynav/localization/particles.py", "fresh = rng.random(n) < share", "fresh = rng.random(n) > share",
           f"{LOCAL} -k 'recovery_replaces'", "recovery replaces the others"),
    Mutant("fuzzynav/localization/particles.py", "hit = np.exp(-0.5 * (distance / params.hit_sigma) ** 2)", "hit = np.exp(-((distance / params.hit_sigma) ** 2))",
           f"{LOCAL} -k 'field_and_score'", "the Gaussian of a beam lacks its half"),
    Mutant("fuzzynav/localization/kalman.py", "rows[:, 1, 0], rows[:, 1, 1], rows[:, 1, 2] = d[:, 1] / q, -d[:, 0] / q, -1.0",
           "rows[:, 1, 0], rows[:, 1, 1], rows[:, 1, 2] = d[:, 1] / r, -d[:, 0] / r, -1.0",
           f"{LOCAL} -k 'jacobians or chi_square or honest'", "the bearing's derivative is divided by the range once"),
    Mutant("fuzzynav/localization/kalman.py", "self.travel_per_metre * way[..., 0] + self.travel_per_radian * way[..., 1]",
           "self.travel_per_metre * way[..., 0] + self.turn_per_radian * way[..., 1]",
           f"{LOCAL} -k 'each_rate'", "the doubt of the advance takes the turn's rate"),
    Mutant("fuzzynav/localization/kalman.py", "-turn / 12.0 + turn**3 / 480.0", "-turn / 12.0 - turn**3 / 480.0",
           f"{LOCAL} -k 'nearly_straight'", "the second term of a series has the other sign"),
    # --- mapping
    Mutant("fuzzynav/mapping/occupancy.py", "if not (0.0 <= r <= reach):", "if not (0.0 <= r < reach):",
           f"{MAPPING} -k 'without_an_end or marks_its_end or slow_map or chances'", "a beam of exactly the reach has no end", plain=True),
    Mutant("fuzzynav/mapping/occupancy.py", "odds[j, i] = max(odds[j, i] + miss, low)", "odds[j, i] = odds[j, i] + miss",
           f"{MAPPING} -k 'within_their_limits'", "free cells grow ever surer", plain=True),
    Mutant("fuzzynav/mapping/occupancy.py", "ranges[n, k] > reach), sensor)", "False), sensor)",
           f"{MAPPING} -k 'without_an_end or slow_map'", "a beam without an end leaves its last cell untold", plain=True),
    Mutant("fuzzynav/mapping/posegraph.py", "s * motions[:, 0] + c * motions[:, 1]", "s * motions[:, 0] - c * motions[:, 1]",
           f"{MAPPING} -k 'sideways'", "odometry edges are mirrored"),
    Mutant("fuzzynav/mapping/posegraph.py", "by_first[:, 0, 2] = -s * gap[:, 0]", "by_first[:, 0, 2] = s * gap[:, 0]",
           f"{MAPPING} -k 'minimum or loops or agree_with_those'", "a derivative of the pose graph has the wrong sign"),
    # --- planning
    Mutant("fuzzynav/planning/kernels.py", "if count == order.shape[0]:\n            order = longer(order)", "if False:\n            order = longer(order)",
           f"{ASTAR} -k 'reopened_cells'", "the list of expanded cells does not grow"),
    Mutant("fuzzynav/planning/kernels.py", "scale = min(1.0, (abs(dx) + abs(dy)) / whole) if whole", "scale = (abs(dx) + abs(dy)) / whole if whole",
           f"{ASTAR} -k 'behind_its_start or behind_the_start'", "the weight by distance goes on growing behind the start"),
    Mutant("fuzzynav/planning/astar.py", "    free = grid.inflate(options.safety_radius)\n    inside", "    free = grid\n    inside",
           f"{ASTAR} -k 'nearer_to_an_obstacle'", "a valid path may come nearer than the safety radius"),
    Mutant("fuzzynav/planning/kernels.py", "ax, ay = abs(dx), abs(dy)\n    return _STRAIGHT * max(ax, ay) + (_DIAGONAL - _STRAIGHT) * min(ax, ay)",
           "ax, ay = abs(dx), abs(dy)\n    return _STRAIGHT * min(ax, ay) + (_DIAGONAL - _STRAIGHT) * max(ax, ay)",
           f"{ASTAR} -k 'compiled_heuristic or octile'", "the octile distance takes the longer side for the shorter"),
    Mutant("fuzzynav/planning/kernels.py", "return gap <= 2 or gap >= 6", "return gap <= 1 or gap >= 6",
           f"{ASTAR} -k 'table_of_directions'", "one of five directions is lost", plain=True),
    Mutant("fuzzynav/planning/visibility.py", "via = length + r * max(turn, 0.0) + tangents[f, 1]", "via = length + tangents[f, 1]",
           f"{SIGHT} -k 'by_hand or larger'", "arcs round a corner cost nothing"),
    Mutant("fuzzynav/planning/astar.py", "if legs[-1].status != \"reached\":\n            break", "if legs[-1].status != \"reached\":\n            continue",
           f"{ASTAR} -k 'legs_end'", "legs go on after one that failed"),
    # --- smoothing
    Mutant("fuzzynav/smoothing/eta.py", "np.divide(2.0 * np.sin(turn), across", "np.divide(np.sin(turn), across",
           f"{SMOOTH} -k 'circle'", "way-points bend half as much as their circle"),
    Mutant("fuzzynav/smoothing/eta.py", "- (13 * e2**2 * kb / 2 - e2**3 * rb / 2 - 3 * e2 * e4 * kb / 2) * sb", "- (13 * e2**2 * kb / 2 - e2**3 * rb / 2 - e2 * e4 * kb / 2) * sb",
           f"{SMOOTH} -k 'sixteen'", "a term of alpha_6 loses its three"),
    Mutant("fuzzynav/smoothing/eta.py", "turn, across = wrap(np.diff(angles))", "turn, across = (np.diff(angles))",
           f"{SMOOTH} -k 'there_and_back'", "turns of a chain are not wrapped"),
    Mutant("fuzzynav/smoothing/measures.py", "(cross, (d[:-1] * d[1:]).sum(axis=1))", "(cross, np.abs((d[:-1] * d[1:]).sum(axis=1)))",
           f"{SMOOTH} -k 'sharp_corner'", "no turn is over a quarter"),
    Mutant("fuzzynav/smoothing/simplify.py", "kept.append(k - 1)\n    return", "kept.append(k)\n    return",
           f"{SMOOTH} -k 'blocked_node or figure_3_5 or simplified'", "the blocked node itself is kept"),
    Mutant("fuzzynav/smoothing/splines.py", "controls = degree * np.diff(controls, axis=0) / gaps", "controls = np.diff(controls, axis=0) / gaps",
           f"{SMOOTH} -k 'derivatives'", "a spline's derivative lacks its degree"),
    # --- simulate
    Mutant("fuzzynav/simulate/kernels.py", "if least > abs(driven[0]) * dt + way + NEAR:", "if least > abs(driven[0]) * dt + NEAR:",
           f"{SIMULATE} -k 'runs_past'", "the way of the movers does not call for a closer look"),
    Mutant("fuzzynav/simulate/kernels.py", "least = min(least, _clear(scene, fleet, movers, x, y) - radius)", "least = min(least, least)",
           f"{SIMULATE} -k 'runs_past'", "a contact inside a step with movers goes unseen"),
    Mutant("fuzzynav/simulate/loop.py", "acting = self.commands[k - self.late] if k >= self.late", "acting = self.commands[k] if k >= self.late",
           f"{SIMULATE} -k 'acts_late'", "a late command acts at once"),
    Mutant("fuzzynav/simulate/loop.py", "and turned < loop.stall_angle)", "and True)",
           f"{SIMULATE} -k 'turns_on_the_spot'", "a robot that turns on the spot is stalled"),
    Mutant("fuzzynav/simulate/record.py", "(np.diff(v, 2) ** 2).sum() / self.dt**3)", "(np.diff(v, 2) ** 2).sum() / self.dt**4)",
           f"{SIMULATE} -k 'jerk_of_a_speed'", "the jerk's integral lacks its step"),
    Mutant("fuzzynav/simulate/disturbance.py", "[self.position_noise, self.position_noise, self.heading_noise]", "[self.position_noise, self.heading_noise, self.heading_noise]",
           f"{SIMULATE} {TRACK} -k 'noise_of_the_measured or disturbance'", "y is measured with the noise of the heading"),
    # --- tracking
    Mutant("fuzzynav/tracking/kernels.py", "(lim.gain, lim.loss) if speed >= 0.0 else (lim.loss, lim.gain)", "(lim.loss, lim.gain) if speed >= 0.0 else (lim.gain, lim.loss)",
           f"{TRACK} -k 'compensator'", "the compensator brakes as it speeds up"),
    Mutant("fuzzynav/tracking/kernels.py", "across / (memory.sense * gains.v_min) + (1.0 - part)", "across / gains.v_min + (1.0 - part)",
           f"{TRACK} -k 'turn_fades'", "the divisor that is held forgets the direction of travel"),
    Mutant("fuzzynav/tracking/dfl.py", "return float(min((-d + np", "return float(max((-d + np",
           f"{TRACK} -k 'largest_step'", "the largest step is that of the slower axis"),
    Mutant("fuzzynav/tracking/kernels.py", "gains.k2 * row.v * left + gains.k3 * np.sin(heading)", "gains.k2 * row.v * left + gains.k3 * heading",
           f"{TRACK} -k 'plain_formulas'", "Kanayama's law without its sine"),
    Mutant("fuzzynav/tracking/kernels.py", "or (value - base) * error < 0.0 else held", "else held",
           f"{TRACK} -k 'integral'", "an integral at its limit does not shrink again"),
    Mutant("fuzzynav/tracking/kernels.py", "omega += (sense if j == 1 else 1.0) * gain * e[j]", "omega += gain * e[j]",
           f"{TRACK} -k 'backwards'", "LQR drives backwards with the gain for forwards"),
    Mutant("fuzzynav/tracking/lqr.py", "solve_discrete_are(a, b, weights.q * dt, weights.r * dt)", "solve_discrete_are(a, b, weights.q * dt, weights.r)",
           f"{TRACK} -k 'lqr_and_mpc or lqr'", "the sampled cost of a command lacks its step"),
    Mutant("fuzzynav/tracking/kernels.py", "low[5 * n + k], high[5 * n + k] = -bounds[2, r] - change, bounds[2, r] - change",
           "low[5 * n + k], high[5 * n + k] = -bounds[2, r], bounds[2, r]",
           f"{TRACK} -k 'predictive_program'", "the predictive program lets the command change beside the reference's own change"),
    # --- blend
    Mutant("fuzzynav/blend/kernels.py", "max(v, 0.0) / lim.loss + 2.0 * memory.dt) < min(need, start - 1e-6)", "max(v, 0.0) / lim.loss + 2.0 * memory.dt) < need - 0.5",
           f"{BLEND} -k 'guard_brakes'", "the guard hardly ever brakes"),
    Mutant("fuzzynav/blend/kernels.py", "if mind.side == 0.0 or mind.time - mind.released > scheme.same_side:", "if True:",
           f"{BLEND} -k 'keeps_its_side'", "a detour that begins again forgets its side"),
    Mutant("fuzzynav/blend/kernels.py", "turn = scheme.turn if bearing <= 0.0", "turn = scheme.turn if bearing < 0.0",
           f"{BLEND} -k 'straight_ahead'", "an obstacle straight ahead is passed on the other side"),
    Mutant("fuzzynav/blend/equations.py", "(np.asarray(distance, dtype=float) < safe_distance)", "(np.asarray(distance, dtype=float) <= safe_distance)",
           f"{BLEND} -k 'blend_ends or lies_between or switch'", "the switch is on at the safe distance itself"),
    Mutant("fuzzynav/blend/equations.py", "(1.0 - f)[..., None] * first + f[..., None] * second", "f[..., None] * first + (1.0 - f)[..., None] * second",
           f"{BLEND} -k 'blend_ends'", "the blend swaps its commands"),
    Mutant("fuzzynav/blend/points.py", "stays = r > reach - BEHIND", "stays = True",
           f"{BLEND} -k 'remembered'", "a point is remembered for ever", plain=True),
    # --- dwa
    Mutant("fuzzynav/dwa/steps.py", "return stopping_distance(samples, robot, dt) <= np", "return stopping_distance(samples, robot, dt) < np",
           f"{DWA} -k exact_stop", "a sample that stops exactly in time is refused"),
    Mutant("fuzzynav/dwa/steps.py", "found: Array = np.maximum(gaps.min(axis=1, initial=np.inf) - radius, 0.0)",
           "found: Array = gaps.min(axis=1, initial=np.inf) - radius",
           f"{DWA} -k never_negative", "the clearance at the end of an arc may be negative"),
    Mutant("fuzzynav/dwa/steps.py", "not_negative(margin=self.margin, reaction=self.reaction)", "not_negative(margin=self.margin)",
           f"{DWA} {UNSEEN} -k 'parameters'", "a negative reaction time is accepted"),
    Mutant("fuzzynav/dwa/kernels.py", "slowest = min(lim.loss, lim.spin / lim.omega * fastest) if fastest > STILL else lim.loss", "slowest = lim.loss",
           f"{DWA} -k slow_turning", "the look ahead forgets that the turn must stop too"),
    Mutant("fuzzynav/dwa/kernels.py", "m = np.ceil(v / drop - 1e-12) - 1.0", "m = np.floor(v / drop - 1e-12)",
           f"{DWA} -k whole_steps", "the number of braking steps is rounded the other way",
           equivalent="both differ only where v is a whole number of drops, and the step that is then added has the speed 0"),
    Mutant("fuzzynav/dwa/kernels.py", "0.5 * drop * m * (m + 1.0)", "0.5 * drop * m * (m - 1.0)",
           f"{DWA} -k stopping_distance", "braking begins a step late", plain=True),
    Mutant("fuzzynav/dwa/kernels.py", "return slower, omega * (slower / v)", "return slower, omega",
           f"{DWA} -k 'same_arc or stays_on_the_arc'", "the emergency brake leaves its arc", plain=True),
    Mutant("fuzzynav/dwa/kernels.py", "need = way.need + abs(v) * settings.reaction + settings.margin\n    if", "need = way.need + abs(v) * settings.reaction\n    if",
           f"{DWA} -k 'parameter_has'", "the margin is not kept"),
    Mutant("fuzzynav/dwa/kernels.py", "clear = max(nearest, 0.0) if abs(v) <= STILL else free", "clear = free",
           f"{DWA} {UNSEEN} -k 'open_steps or mirrored or finite'", "a sample that stands scores endless clearance"),
    Mutant("fuzzynav/dwa/sight.py", "if k > 0 and gaps.sum() < np.pi:", "if k > 0:",
           f"{DWA} {UNSEEN} -k 'outrun or half_a_circle or shadow'", "a full circle of beams has a gap of a whole turn"),
    Mutant("fuzzynav/dwa/sight.py", "max(gaps[i] if whole else 0.0, gaps[i - 1] if before else 0.0)", "(gaps[i] if whole else 0.0)",
           f"{DWA} -k wider_of_two", "the end of a beam takes the gap to its left alone"),
    Mutant("fuzzynav/dwa/sight.py", "for beam, beside in ((i, i - 1), (j, j)):", "for beam, beside in ((i, i - 1),):",
           f"{UNSEEN} -k both_edges", "a hole in sight has a border on one side only"),
    # --- fusion
    Mutant("fuzzynav/fusion/kernels.py", "gap -= bound * t + reserve", "gap -= reserve",
           f"{SEPARATION} -k dense_sampling", "movers stand while the robot brakes"),
    Mutant("fuzzynav/fusion/kernels.py", "last = np.ceil(abs(v) / drop - 1e-12) * dt", "last = dt",
           f"{SEPARATION} -k dense_sampling", "only the first step is looked at"),
    Mutant("fuzzynav/fusion/kernels.py", "t = min(t + gap / (speed + bound), last)", "t = min(t + 2.0 * gap / (speed + bound), last)",
           f"{SEPARATION} -k brush", "time advances by twice what the gap allows"),
    Mutant("fuzzynav/fusion/kernels.py", "own.reserve if abs(v) > own.creep else 0.0", "0.0",
           f"{DECISION} -k switched_off", "nothing is kept on top of the guarantee"),
    Mutant("fuzzynav/fusion/kernels.py", "c * rows[i, 2] + s * rows[i, 3], c * rows[i, 3] - s * rows[i, 2]", "rows[i, 2], rows[i, 3]",
           f"{DECISION} -k turning_the_world", "movers walk in the world's frame where the robot's is asked for"),
    Mutant("fuzzynav/fusion/separation.py", "speed**2 / (2.0 * loss) + bound * speed / loss + during", "speed**2 / (2.0 * loss) + during",
           f"{SEPARATION} -k 'known or by_hand'", "the mover stands while the robot brakes"),
    Mutant("fuzzynav/fusion/separation.py", "(gain / loss + 1.0) * (0.5", "(gain / loss) * (0.5",
           f"{SEPARATION} -k 'known or by_hand'", "the period's own way is forgotten"),
    Mutant("fuzzynav/fusion/memory.py", "evidence[j, i] -= 1", "evidence[j, i] -= 0",
           f"{MEMORY} -k looked_through", "what was seen is never forgotten"),
    Mutant("fuzzynav/fusion/memory.py", "for _ in range(cells):", "for _ in range(0):",
           f"{MEMORY} -k growing", "what only the scanner knows gets no more room"),
    Mutant("fuzzynav/fusion/route.py", "found.length <= WORTH * best.length", "True",
           f"{MEMORY} -k 'any_detour'", "the widest room is taken, whatever the detour"),
    Mutant("fuzzynav/fusion/scenes.py", "full[row, col] = True", "full[row, col] = blocks[row, col] = True",
           f"{SCENES} -k promises", "the map shows the squares that it should lack"),
    Mutant("fuzzynav/fusion/sensed.py", "points[~known], np.zeros(int((~known).sum()))", "points[known], np.zeros(int(known.sum()))",
           f"{DECISION} -k explain", "only what the map knows may move"),
    Mutant("fuzzynav/dwa/moving.py", "return hold + late - 0.5 * loss * late * late / abs(v)", "return hold + late - loss * late * late / abs(v)",
           f"{MOVING} -k 'braking_may'", "a robot that brakes comes less far than it does"),
    Mutant("fuzzynav/dwa/moving.py", "bend = row[2], row[3], start, abs(v * omega) + loss", "bend = row[2], row[3], start, loss",
           f"{MOVING} -k 'dense_sampling'", "the bend of an arc is left out of what is surely free"),
    Mutant("fuzzynav/dwa/moving.py", "out[count, 4], out[count, 5], out[count, 6] = wide + TOUCHING, i, j", "out[count, 4], out[count, 5], out[count, 6] = rows[i, 4], i, j",
           f"{MOVING} -k 'neighbours'", "the disc around a group of points holds its middle only"),
    Mutant("fuzzynav/dwa/moving.py", "c * ux + s * uy, c * uy - s * ux, radius", "ux, uy, radius",
           f"{MOVING} -k 'straight_line'", "velocities of points stay in the world frame"),
    Mutant("fuzzynav/dwa/kernels.py", "or way.struck:", "or False:",
           f"{MOVING} -k 'head_on or can_brake'", "what meets a robot while it brakes refuses nothing"),
    Mutant("fuzzynav/dwa/contact.py", "if abs(omega) * travelled > 2.0 * np.pi * abs(v):", "if abs(omega) * travelled > np.pi * abs(v):",
           f"{DWA} -k all_the_way_round", "a march through a field ends after half a circle"),
    Mutant("fuzzynav/dwa/contact.py", "out[k, 3] = squared - own * own", "out[k, 3] = squared - own",
           f"{DWA} -k 'gap or circle_contact'", "the power of a point takes the radius for its square"),
    # --- batch
    Mutant("fuzzynav/batch/sweep.py", "            future.cancel()", "            future.done()",
           f"{BATCH} -k 'cancelled'", "what waits is not cancelled"),
    Mutant("fuzzynav/batch/sweep.py", "        for row in kept:\n            self._check(key, row)", "        self._check(key, kept[0])",
           f"{BATCH} -k 'cannot_hold or refusals'", "only the first row of a case is checked"),
    Mutant("fuzzynav/batch/statistics.py", "method=\"wilson\"", "method=\"exact\"",
           f"{BATCH} fuzzynav/batch/statistics.py", "the interval is not Wilson's"),
    Mutant("fuzzynav/batch/statistics.py", "gap = (sides[1] - sides[0])", "gap = (sides[0] - sides[1])",
           f"{BATCH} -k 'known_difference'", "a paired difference has the other sign"),
    Mutant("fuzzynav/batch/sheet.py", "value = f\"'{value}\" if value.startswith(FORMULA) else value", "value = f\"'{value}\" if value.startswith(FORMULA[:-1]) else value",
           f"{BATCH} -k 'survives'", "a text's own apostrophe is lost in the file"),
    Mutant("fuzzynav/batch/identity.py", "parameters = {**_bound(function), **parameters}", "parameters = {**parameters, **_bound(function)}",
           f"{BATCH} -k 'another_parameter'", "a default hides what a partial binds"),
    # --- studies
    Mutant("fuzzynav/studies/study.py", "<= max(relative * abs(old), absolute)", "<= max(abs(old), absolute)",
           f"{STUDIES} -k 'within_the_tolerance_only'", "a stored number may be wrong by its whole size"),
    Mutant("fuzzynav/studies/study.py", "if sheet.checksum and sheet.checksum != batch.checksum_of(sheet):\n        return", "if False:\n        return",
           f"{STUDIES} -k 'refactoring'", "a file that was changed by hand counts as current"),
    Mutant("fuzzynav/studies/study.py", "if target != path and target.exists() and batch", "if target == path and target.exists() and batch",
           f"{STUDIES} -k 'new_edition or stale or refactoring or fresh'", "an edition begun with other code is gone on with"),
    # --- potential fields
    Mutant("fuzzynav/potential/kernels.py", "else scale * a / (rho * rho)", "else scale * a / rho",
           f"{FIELDS} -k gradient", "the repulsion lacks one of its 1/rho"),
    Mutant("fuzzynav/potential/kernels.py", "more = 0.5 * a * a * slope / d", "more = -0.5 * a * a * slope / d",
           f"{FIELDS} -k 'gradient or second_term'", "the distance factor pushes away from the goal"),
    Mutant("fuzzynav/potential/kernels.py", "ax, ay = x - row[0] - u * dx, y - row[1] - u * dy", "ax, ay = x - row[0], y - row[1]",
           f"{FIELDS} -k a_wall_is", "a wall is its first end only"),
    Mutant("fuzzynav/potential/kernels.py", "side = -1.0 if own.turns and traps % 2 == 1 else 1.0", "side = 1.0",
           f"{WALKS} -k sides", "the side never changes"),
    Mutant("fuzzynav/potential/kernels.py", "if gap <= 0.0:", "if gap <= -1.0:",
           f"{WALKS} -k touches", "a contact is overlooked"),
    Mutant("fuzzynav/potential/kernels.py", "own.share * own.watch * own.step", "0.0",
           f"{WALKS} -k trap", "no trap is found"),
    Mutant("fuzzynav/potential/harmonic.py", "np.full(len(places), 4.0)", "np.full(len(places), 4.5)",
           f"{HARMONIC} -k 'by_hand or summit'", "a cell is less than the mean of its neighbours"),
    # --- published
    Mutant("fuzzynav/published.py", "<= tolerance + 1e-9)", "<= 2.0 * tolerance + 1e-9)",
           f"{PUBLISHED} -k 'within_the_tolerance or verdicts_on_numbers'", "twice the tolerance counts as reproduced"),
    Mutant("fuzzynav/published.py", "if reproduction.direction()[1] > 0.0", "if reproduction.direction()[0] > 0.0",
           f"{PUBLISHED} -k 'verdicts'", "a direction holds by its mean alone"),
    Mutant("fuzzynav/published.py", "if bound[1] == \">\" else", "if bound[1] == \"<\" else",
           f"{PUBLISHED} -k 'bounds'", "a printed bound is read the other way"),
    # --- course
    Mutant("fuzzynav/course/grading.py", "        elif not name:\n            kept.append(cell)", "        else:\n            kept.append(cell)",
           f"{COURSE} -k 'foreign_check_cell'", "a second check cell of the student's own is kept"),
    Mutant("fuzzynav/course/grading.py", "record.get(\"exercise\") == name and ", "",
           f"{COURSE} -k 'only_the_record'", "the record of another exercise counts"),
    Mutant("fuzzynav/course/grading.py", "record.get(\"points\") in range(of + 1)", "record.get(\"points\") is not None",
           f"{COURSE} -k 'only_the_record'", "more points than an exercise is worth"),
    Mutant("fuzzynav/course/handins.py", "-p.stat().st_mtime, p.name))", "p.stat().st_mtime, p.name))",
           f"{COURSE} -k 'shallowest'", "the oldest copy counts"),
    Mutant("fuzzynav/course/exercises/ch06.py", "        if values[-1] > high + 1e-9:", "        if values[-1] > high + 1.0:",
           f"{ANSWERS} -k 'own_sentence and 06 or heard'", "a sample beyond the window passes"),
    Mutant("fuzzynav/course/exercises/ch06.py", "if widest > step + 1e-9:", "if widest > 2.0 * step + 1e-9:",
           f"{ANSWERS} -k 'own_sentence and 06 or heard'", "samples may lie two steps apart"),
    Mutant("fuzzynav/course/exercises/ch01.py", "    if step > 0.1:", "    if step > 0.2:",
           f"{ANSWERS} -k 'own_sentence and 01 or heard'", "an encoder twice too coarse passes"),
    Mutant("fuzzynav/course/exercises/ch04.py", "> 1e-5:", "> 1e-1:",
           f"{ANSWERS} -k 'one_percent'", "a decoupling matrix that is a tenth off passes"),
    Mutant("fuzzynav/course/exercises/ch08.py", "forecast < low) | (was & (forecast <= high))", "forecast < low) | (was & (forecast <= low))",
           f"{ANSWERS} -k '08'", "the gate shuts between both margins"),
)  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
