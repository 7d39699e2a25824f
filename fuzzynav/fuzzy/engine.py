"""The compiled evaluation of a fuzzy system that is given as flat tables (see `compiled`).

Points are worked through in blocks of 64, so that the loops over a block run in vector registers. Each output set is
clipped once for each term, with the strongest of the rules that conclude it: that is exact for max aggregation.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.fuzzy.kernels import conorm, gaussian_row, hedged, member, norm
from fuzzynav.fuzzy.set_kernels import aggregate, exact_centroid, max_min_centroid, of_samples, weighted
from fuzzynav.geometry import Array

Codes = NDArray[np.int64]

__all__ = ["run"]

_BLOCK = 64


@njit(cache=True)
def _fuzzify(block: Array, ranges: Array, terms: Codes, numbers: Array, table: Array, mu: Array) -> None:
    """Memberships mu (n_terms, width) of the points block (width, n_inputs)."""
    width = block.shape[0]
    column, bits = np.empty(width), np.empty(width)
    loaded = -1
    for t in range(mu.shape[0]):
        i = terms[t, 1]
        if i != loaded:
            loaded = i
            for p in range(width):
                column[p] = block[p, i]
                if ranges[i, 2] > 0.0 and not math.isnan(column[p]):
                    column[p] = min(max(column[p], ranges[i, 0]), ranges[i, 1])
        if terms[t, 0] == 2:
            gaussian_row(column, numbers[t], bits, mu[t])
        else:
            code, at, pairs, p = terms[t, 0], terms[t, 2], terms[t, 3], numbers[t]
            for k in range(width):
                mu[t, k] = member(code, p, column[k], table, at, pairs)


@njit(cache=True)
def _qualify(mu: Array, propositions: Codes, props: Array) -> None:
    """Truth props (n_propositions, width) of each `variable is [hedges] term`."""
    for k in range(propositions.shape[0]):
        t = propositions[k, 0]
        for p in range(mu.shape[1]):
            props[k, p] = mu[t, p] if t >= 0 else 1.0
        for j in range(1, propositions.shape[1]):
            code = propositions[k, j]
            for p in range(mu.shape[1] if code >= 0 else 0):
                props[k, p] = hedged(code, props[k, p])


@njit(cache=True)
def _and3(props: Array, a: int, b: int, c: int, weight: float, firing: Array, rule: int) -> None:
    for p in range(props.shape[1]):
        u = props[a, p] if props[a, p] < props[b, p] else props[b, p]
        u = u if u < props[c, p] else props[c, p]
        firing[rule, p] = weight * u


@njit(cache=True)
def _join(op: int, code: int, here: Array, other: Array) -> None:
    """Join `other` to `here` in place: by AND (odd op) or OR."""
    if op % 2 == 1 and code == 0:
        for p in range(here.size):
            here[p] = here[p] if here[p] < other[p] else other[p]
    elif op % 2 == 1 and code == 1:
        for p in range(here.size):
            here[p] = here[p] * other[p]
    elif op % 2 == 1:
        for p in range(here.size):
            here[p] = norm(code, here[p], other[p])
    else:
        for p in range(here.size):
            here[p] = conorm(code, here[p], other[p])


@njit(cache=True)
def _fire(props: Array, program: Codes, weights: Array, stack: Array, firing: Array) -> None:
    """Run the antecedent program: firing (n_rules, width) from proposition memberships (n_props, width)."""
    top = -1
    for k in range(program.shape[0]):
        op, operand, code = program[k, 0], program[k, 1], program[k, 2]
        if op == 6:
            _and3(props, operand, code, program[k, 3], weights[program[k, 4]], firing, program[k, 4])
        elif op == 0:
            top += 1
            for p in range(stack.shape[1]):
                stack[top, p] = props[operand, p]
        elif op == 5:
            for p in range(stack.shape[1]):
                firing[operand, p] = weights[operand] * stack[top, p]
            top -= 1
        elif op <= 2:
            _join(op, code, stack[top], props[operand])
        else:
            top -= 1
            _join(op, code, stack[top], stack[top + 1])


@njit(cache=True)
def _strongest(h: Array, slot: int, firing: Array, a: int, b: int, c: int) -> None:
    for p in range(h.shape[1]):
        u = h[slot, p] if h[slot, p] > firing[a, p] else firing[a, p]
        v = firing[b, p] if firing[b, p] > firing[c, p] else firing[c, p]
        h[slot, p] = u if u > v else v


@njit(cache=True)
def _conclude(firing: Array, consequents: Codes, slots: Codes, h: Array) -> None:
    """Strength h (n_slots, width) of each concluded set, merged over its rules (consequents are sorted by set)."""
    n, c, hedge_free = consequents.shape[0], 0, True
    for slot in range(h.shape[0]):
        for p in range(h.shape[1]):
            h[slot, p] = 0.0
    for c in range(n):
        for k in range(2, consequents.shape[1]):
            hedge_free = hedge_free and consequents[c, k] < 0
    c = 0
    while c < n:
        rule, slot = consequents[c, 0], consequents[c, 1]
        code = slots[slot, 3]
        if hedge_free and code == 0:
            second, third = rule, rule
            if c + 1 < n and consequents[c + 1, 1] == slot:
                second = consequents[c + 1, 0]
            if second != rule and c + 2 < n and consequents[c + 2, 1] == slot:
                third = consequents[c + 2, 0]
            c += 1 + (second != rule) + (third != rule)
            _strongest(h, slot, firing, rule, second, third)
            continue
        for p in range(firing.shape[1]):
            m = firing[rule, p]
            fires = m > 0.0
            for k in range(2, consequents.shape[1]):
                if consequents[c, k] >= 0 and fires:
                    m = hedged(consequents[c, k], m)
            h[slot, p] = conorm(code, h[slot, p], m)
        c += 1


@njit(cache=True)
def _output(o: int, h: Array, points: Array, outputs: Codes, slots: Codes, terms: Codes, numbers: Array, table: Array,
            tables: Array, knots: Array, lines: Array, answer: Array) -> None:  # fmt: skip
    """Crisp answers (width,) of output o, measured from the centre of its range; nan where nothing fires."""
    first, n, code, defuzzifier = outputs[o, 0], outputs[o, 1], outputs[o, 2], outputs[o, 3]
    quadrature, samples = outputs[o, 4], outputs[o, 5]
    width = answer.size
    own, mine = h[first : first + n], slots[first : first + n]
    strengths, implied, clipped = np.empty(n), np.empty(n, np.int64), True
    for k in range(n):
        implied[k] = mine[k, 2]
        clipped = clipped and implied[k] == 0
    if defuzzifier >= 5 or quadrature == 3:
        for p in range(width):
            for k in range(n):
                strengths[k] = own[k, p]
            if defuzzifier >= 5:
                answer[p] = weighted(defuzzifier == 5, strengths, mine, terms, numbers, table, points[p])
            else:
                answer[p] = exact_centroid(knots[o, :samples], lines[o], strengths, implied, code == 3)
        return
    sampled, rows = tables[o, :2, :samples], tables[o, 2 : 2 + n, :samples]
    if defuzzifier == 0 and code == 0 and clipped:
        area = np.empty(width)
        max_min_centroid(own, rows, sampled, area, answer)
        for p in range(width):
            answer[p] = answer[p] / area[p] if area[p] > 0.0 else math.nan
        return
    mu = np.empty((width, samples))
    aggregate(own, rows, implied, code, mu)
    for p in range(width):
        answer[p] = of_samples(defuzzifier, quadrature, sampled, mu[p])


@njit(cache=True)
def _settle(answer: float, fires: bool, previous: float, settings: Array) -> float:
    """Answer moved to its range; the previous value or the stated default where nothing fires."""
    low, high, default, centre, lock_range, lock_previous = settings
    if not fires or math.isnan(answer):
        value = previous if lock_previous > 0.0 and not math.isnan(previous) else default
    else:
        value = answer + centre
    return min(max(value, low), high) if lock_range > 0.0 and not math.isnan(value) else value


@njit(cache=True)
def run(points: Array, degrees: Array, previous: Array, ranges: Array, terms: Codes, numbers: Array, table: Array,
        propositions: Codes, program: Codes, weights: Array, consequents: Codes, slots: Codes, outputs: Codes,
        settings: Array, tables: Array, knots: Array, lines: Array, values: Array, memberships: Array, firings: Array,
        strengths: Array) -> None:  # fmt: skip
    """Evaluate all points (n, n_inputs) and write values (n, n_outputs).

    `degrees` (n, n_input_terms), when it has columns, replaces the fuzzification of the points. The last three arrays
    are the evidence; they are written when they have rows.
    """
    n, n_in = points.shape
    n_terms, wide = memberships.shape[1], max(1, min(n, _BLOCK))
    mu, props = np.empty((n_terms, wide)), np.empty((propositions.shape[0], wide))
    stack, firing = np.empty((propositions.shape[0] + 1, wide)), np.empty((weights.size, wide))
    h, answer = np.empty((slots.shape[0], wide)), np.empty(wide)
    block = np.empty((wide, n_in))
    for start in range(0, n, wide):
        width = min(wide, n - start)
        for p in range(wide):
            for i in range(n_in):
                block[p, i] = points[start + min(p, width - 1), i]
        if degrees.shape[1] > 0:
            for t in range(n_terms):
                for p in range(wide):
                    mu[t, p] = degrees[start + min(p, width - 1), t]
        else:
            _fuzzify(block, ranges, terms, numbers, table, mu)
        _qualify(mu, propositions, props)
        _fire(props, program, weights, stack, firing)
        _conclude(firing, consequents, slots, h)
        for o in range(outputs.shape[0]):
            _output(o, h, block, outputs, slots, terms, numbers, table, tables, knots, lines, answer)
            first, count = outputs[o, 0], outputs[o, 1]
            for p in range(width):
                fires = False
                for k in range(first, first + count):
                    fires = fires or h[k, p] > 0.0
                before = previous[start + p, o] if previous.shape[0] > 0 else math.nan
                values[start + p, o] = _settle(answer[p], fires, before, settings[o])
        for p in range(width):
            missing = False
            for i in range(n_in):
                missing = missing or math.isnan(block[p, i])
            for o in range(outputs.shape[0] if missing else 0):
                values[start + p, o] = math.nan
            if firings.shape[0] > 0:
                for t in range(n_terms):
                    memberships[start + p, t] = mu[t, p]
                for r in range(weights.size):
                    firings[start + p, r] = math.nan if missing else firing[r, p]
                for k in range(slots.shape[0]):
                    strengths[start + p, k] = math.nan if missing else h[k, p]


def _warm() -> None:
    from fuzzynav.fuzzy.compiled import tables
    from fuzzynav.fuzzy.membership import Term
    from fuzzynav.fuzzy.rules import Rule
    from fuzzynav.fuzzy.variable import RuleBlock, Variable

    low = Term(name="Low", shape="triangle", parameters=(0, 0, 1))
    x, y = (Variable(name=name, low=0, high=1, terms=(low,)) for name in "xy")
    prepared = tables((x,), (y,), (RuleBlock(rules=(Rule.parse("if x is Low then y is Low"),)),))
    empty = np.empty((0, 0))
    arrays: Any = (np.zeros((1, 1)), empty, empty, *prepared.arrays, np.empty((1, 1)), np.empty((0, 1)), empty, empty)
    run(*arrays)
