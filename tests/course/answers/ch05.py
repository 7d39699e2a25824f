"""Answers to the exercises of chapter 05: right ones of every form, and wrong ones with the words they hear."""

import math
from dataclasses import replace

import numpy as np
import sympy

from fuzzynav.planning.astar import OPTIMAL

ROOT = math.sqrt(2)


# --- 05.1


def octile(root=ROOT):
    def answer(dx, dy):
        long, short = max(abs(dx), abs(dy)), min(abs(dx), abs(dy))
        return long - short + root * short

    return answer


def stepwise(dx, dy):
    """A loop that walks to the goal."""
    dx, dy, way = abs(dx), abs(dy), 0.0
    while dx or dy:
        way += ROOT if dx and dy else 1.0
        dx, dy = max(dx - 1, 0), max(dy - 1, 0)
    return way


# --- 05.2


def legal(occupied, x, y, dx, dy, *, edge=True, target=True, corner=any):
    """Whether a step is legal, perhaps with one of the rules missing."""
    rows, cols = occupied.shape
    if not (0 <= x + dx < cols and 0 <= y + dy < rows):
        return not edge
    if target and occupied[y + dy, x + dx]:
        return False
    return not (dx and dy and corner([occupied[y, x + dx], occupied[y + dy, x]]))


def ruled(**given):
    return lambda occupied, x, y, dx, dy: legal(occupied, x, y, dx, dy, **given)


def padded(occupied, x, y, dx, dy):
    room = np.pad(occupied, 1, constant_values=True)
    box = room[min(y, y + dy) + 1 : max(y, y + dy) + 2, min(x, x + dx) + 1 : max(x, x + dx) + 2]
    return np.array([not box.any()])


def silent_no(occupied, x, y, dx, dy):
    if legal(occupied, x, y, dx, dy):
        return True


def swapped(occupied, x, y, dx, dy):
    return legal(occupied.T, x, y, dx, dy)


def pruned(count, free):
    """Take out nodes that can go, the last ones first, until none is left."""
    kept = list(range(count))
    k = count - 2
    while k > 0:
        if free(kept[k - 1], kept[k + 1]):
            del kept[k]
            k = min(k + 1, len(kept) - 1)
        k -= 1
    return kept


# --- 05.3


def cost(step=math.hypot, whole=True):
    return lambda g, parent, child, start: whole * g + step(child[0] - parent[0], child[1] - parent[1])


# --- 05.5


def greedy(count, free):
    kept = [0]
    for k in range(2, count):
        if not free(kept[-1], k):
            kept.append(k - 1)
    return kept + [count - 1]


def from_the_goal(count, free):
    kept = [count - 1]
    for k in range(count - 3, -1, -1):
        if not free(k, kept[-1]):
            kept.append(k + 1)
    return [0, *kept[::-1]]


def fewest(count, free):
    """The chain of fewest free legs, by trying all pairs."""
    legs, before = [0] + [count] * (count - 1), [0] * count
    for b in range(1, count):
        for a in range(b):
            if legs[a] + 1 < legs[b] and (b == a + 1 or free(a, b)):
                legs[b], before[b] = legs[a] + 1, a
    kept = [count - 1]
    while kept[-1]:
        kept.append(before[kept[-1]])
    return tuple(kept[::-1])


def restarted(count, free):
    kept, base = {0, count - 1}, 0
    for k in range(2, count):
        if k > base + 1 and not free(base, k):
            kept |= {k - 1, k}
            base = k
    return sorted(kept)


def lazy(count, free):
    """One node more than needed: it skips only a single node at a time."""
    kept, k = [0], 0
    while k < count - 1:
        k += 2 if k + 2 < count and free(k, k + 2) else 1
        kept.append(k)
    return kept


# --- 05.6


def ends(first=lambda p: 2 * p[0] - p[1], last=lambda p: 2 * p[-1] - p[-2], inner=lambda p: p):
    return lambda p: np.vstack([first(p), inner(p), last(p)])


def by_loop(points):
    kept = [[2 * points[0][k] - points[1][k] for k in (0, 1)]]
    for p in points:
        kept.append([p[0], p[1]])
    kept.append([2 * points[-1][k] - points[-2][k] for k in (0, 1)])
    return kept


# --- 05.7


def second(along=lambda e1, e3: e3, across=lambda e1, k: e1**2 * k):
    def answer(e1, e3, theta, kappa):
        c, s, a, n = math.cos(theta), math.sin(theta), along(e1, e3), across(e1, kappa)
        return a * c - n * s, a * s + n * c

    return answer


def complex_parts(e1, e3, theta, kappa):
    z = complex(e3, e1**2 * kappa) * np.exp(1j * theta)
    return [z.real, z.imag]


RIGHT = {
    "05.1": {
        "two sides": octile(),
        "a loop": stepwise,
        "an array of one": lambda dx, dy: np.array([octile()(dx, dy)]),
        "sympy": lambda dx, dy: sympy.Integer(abs(abs(dx) - abs(dy))) + sympy.sqrt(2) * min(abs(dx), abs(dy)),
    },
    "05.2": {
        "tests": legal,
        "a padded box, an array": padded,
        "nothing for no": silent_no,
        "0 and 1": lambda *given: int(legal(*given)),
        "numpy": lambda *given: np.bool_(legal(*given)),
    },
    "05.3": {
        "hypot": cost(),
        "a root": cost(lambda x, y: (x * x + y * y) ** 0.5),
        "numpy": lambda g, p, c, start: np.float64(g) + np.linalg.norm(np.subtract(c, p)),
        "cases": cost(lambda x, y: ROOT if x and y else 1),
        "sympy": lambda g, p, c, start: g + sympy.sqrt((c[0] - p[0]) ** 2 + (c[1] - p[1]) ** 2),
    },
    "05.4": {
        "1.2": replace(OPTIMAL, weight=1.2),
        "1.15": replace(OPTIMAL, weight=1.15),
        "Euclid": replace(OPTIMAL, heuristic="euclidean", weight=1.25),
        "reopened": replace(OPTIMAL, weight=1.2, reopen=True),
    },
    "05.5": {
        "from the start": greedy,
        "from the goal": from_the_goal,
        "fewest, a tuple": fewest,
        "pruned": pruned,
        "an array": lambda count, free: np.array(greedy(count, free)),
        "floats": lambda count, free: [float(k) for k in greedy(count, free)],
    },
    "05.6": {
        "stacked": ends(),
        "a loop, lists": by_loop,
        "sympy": lambda p: sympy.Matrix(by_loop(p)),
        "two beyond each end": lambda p: np.vstack([3 * p[0] - 2 * p[1], ends()(p), 3 * p[-1] - 2 * p[-2]])[1:-1],
    },
    "05.7": {
        "a tuple": second(),
        "complex parts, a list": complex_parts,
        "a column": lambda *given: np.array(second()(*given))[:, None],
        "sympy": lambda *given: sympy.Matrix(second()(*given)),
    },
    "05.8": {
        "a list": [2.0, 2.0, 20.0, -20.0],
        "ints, a tuple": (2, 2, 20, -20),
        "six numbers, a column": np.array([[2], [2], [20], [-20], [0], [0]]),
        "sympy": sympy.Matrix([2, 2, 20, -20]),
    },
}

WRONG = {
    "05.1": {
        "Euclid": (math.hypot, "a path on the grid turns"),
        "Manhattan": (lambda dx, dy: abs(dx) + abs(dy), "Manhattan counts 2"),
        "Chebyshev": (lambda dx, dy: max(abs(dx), abs(dy)), "yours counts both as 1"),
        "zero": (lambda dx, dy: 0, "is Dijkstra's"),
        "straight steps not taken off": (lambda dx, dy: octile(1 + ROOT)(dx, dy), "already bring you nearer"),
        "all diagonal": (lambda dx, dy: ROOT * max(abs(dx), abs(dy)), "as the shorter side"),
        "no sizes": (lambda dx, dy: max(dx, dy) - min(dx, dy) + ROOT * min(dx, dy), "may be negative"),
        "squares": (lambda dx, dy: dx * dx + dy * dy, "is no length"),
        "1.4142": (octile(1.4142), "rounded down"),
        "1.4143": (octile(1.4143), "rounded up"),
        "1.5": (octile(1.5), "it overestimates, and"),
        "Euclid, but exact beside the diagonal": (
            lambda dx, dy: octile()(dx, dy) if abs(abs(dx) - abs(dy)) == 1 else math.hypot(dx, dy),
            "no path is shorter than",
        ),
    },
    "05.2": {
        "inverted": (lambda *given: not legal(*given), "where the step is forbidden"),
        "no corners": (ruled(corner=lambda sides: False), "Yours lets the robot cut corners"),
        "and for or": (ruled(corner=all), "one is enough to touch"),
        "no edge": (ruled(edge=False), "leaves the map. Beware"),
        "the target": (ruled(target=False), "ends in an obstacle"),
        "x and y swapped": (swapped, "the array is indexed [y, x]"),
        "no diagonals": (lambda o, x, y, dx, dy: not (dx and dy) and legal(o, x, y, dx, dy), "y = 4) is legal"),
        "one corner only": (ruled(corner=lambda sides: sides[0]), "y = 4) cuts a corner"),
        "left to Python": (lambda o, x, y, dx, dy: not o[y + dy, x + dx], "it asked for an entry that is not there"),
        "a text": (lambda *given: "yes", "not a text"),
    },
    "05.3": {
        "as it was": (lambda g, p, c, start: math.hypot(c[0] - start[0], c[1] - start[1]), "(T11)"),
        "added to it": (lambda g, p, c, start: g + math.hypot(*c), "add only the step"),
        "the step": (cost(whole=False), "the step alone"),
        "the parent": (lambda g, p, c, start: g, "the step to the child is missing"),
        "one a step": (cost(lambda x, y: 1), "counts 1 in yours"),
        "Manhattan": (cost(lambda x, y: abs(x) + abs(y)), "counts 2 in yours"),
        "taken off": (cost(lambda x, y: -math.hypot(x, y)), "A step makes the way longer"),
        "Manhattan from the start": (lambda g, p, c, start: abs(c[0]) + abs(c[1]), "a detour would cost nothing"),
        "1.414": (cost(lambda x, y: 1.414 if x and y else 1), "over a long way that adds up"),
        "the parent counted twice": (lambda g, p, c, start: 2 * g + 1, "The parent (")},
    "05.4": {
        "1": (replace(OPTIMAL, weight=1.0), "let the heuristic weigh more"),
        "2": (replace(OPTIMAL, weight=2.0), "let the heuristic weigh less"),
        "permissive": (replace(OPTIMAL, weight=1.2, corners="permissive"), "Keep strict corners"),
        "four neighbours": (replace(OPTIMAL, weight=1.2, neighbours=4), "Keep eight neighbours"),
        "a safety radius": (replace(OPTIMAL, weight=1.2, safety_radius=0.6), "Keep the safety radius"),
        "five directions": (
            replace(OPTIMAL, weight=1.2, five_directions=True, fallback=False), "though there is a path"),
        "a number": (1.2, "not a float"),
    },
    "05.5": {
        "all": (lambda count, free: list(range(count)), "You kept all nodes"),
        "both ends": (lambda count, free: [0, count - 1], "the straight leg between them hits"),
        "restarted": (restarted, "(T22)"),
        "one at a time": (lazy, "can go."),
        "the start missing": (lambda count, free: greedy(count, free)[1:], "must begin with node 0"),
        "backwards": (lambda count, free: [0, *from_the_goal(count, free)[-2:0:-1], 0, count - 1], "must rise"),
        "a mask": (lambda count, free: [k in greedy(count, free) for k in range(count)], "not True or False"),
        "halves": (lambda count, free: [0, 0.5, count - 1], "yours holds 0.5"),
        "nothing": (lambda count, free: None, "not None"),
    },
    "05.6": {
        "as they are": (lambda p: p, "The curve misses the start"),
        "only the start": (lambda p: np.vstack([2 * p[0] - p[1], p]), "The curve misses the goal"),
        "the goal along another way": (
            lambda p: np.vstack([2 * p[0] - p[1], p[:-1], 6 * p[-1] - 4 * p[-2] - p[-3]]), "meets the goal, but"),
        "the start along another way": (
            lambda p: np.vstack([6 * p[0] - 4 * p[1] - p[2], p[1:], 2 * p[-1] - p[-2]]), "meets the start, but"),
        "the middle thrown away": (lambda p: ends()(p)[[0, 1, 2, -3, -2, -1]], "between them are gone"),
        "both ends three times": (lambda p: np.vstack([p[0], p[0], p, p[-1], p[-1]]), "no two that coincide"),
        "turned round": (lambda p: ends()(p)[::-1], "from the goal to the start"),
        "too many": (
            lambda p: np.vstack([ends()(p)[:3], *(p[1] + (p[2] - p[1]) * t for t in (0.1, 0.2, 0.3)), ends()(p)[3:]]),
            "points were added"),
        "two points": (lambda p: p[:2], "four control points or more"),
        "transposed": (lambda p: ends()(p).T, "The control points should be an array of shape (n, 2)"),
    },
    "05.7": {
        "no square": (second(across=lambda e1, k: e1 * k), "only proportional"),
        "to the right": (second(across=lambda e1, k: -(e1**2) * k), "points to the right"),
        "no speed": (second(across=lambda e1, k: k), "speed eta_1 is missing across"),
        "along only": (second(across=lambda e1, k: 0.0), "yours only along it"),
        "across only": (second(along=lambda e1, e3: 0.0), "The part along the heading is missing"),
        "the speed along": (second(along=lambda e1, e3: e1), "not the speed eta_1"),
        "swapped": (lambda e1, e3, theta, kappa: second()(e1, e1**2 * kappa, theta, e3 / e1**2), "are swapped"),
        "not turned": (lambda e1, e3, theta, kappa: (e3, e1**2 * kappa), "turn them by the heading"),
        "the sum": (second(along=lambda e1, e3: e3 + 1), "along the heading it is"),
        "a complex number": (lambda e1, e3, theta, kappa: complex(e3, e1**2 * kappa), "not a complex number"),
    },
    "05.8": {
        "the default": ((5, 5), "The sharpest curvature"),
        "a little too long": ((3, 3, 14, -14), "It turns gently enough"),
        "speeds of 0": ((0, 2, 20, -20), "must be positive"),
        "None": (None, "should be numbers, not None"),
        "one": (2.0, "two speeds, then"),
        "nan": ((2, 2, np.nan, 0), "yours is nan"),
        "a text": ("2, 2, 20, -20", "not a text"),
    },
}  # fmt: skip
