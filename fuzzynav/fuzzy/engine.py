"""The compiled evaluation of a fuzzy system that is given as flat tables (see `compiled`).

Points are worked through in blocks of 64, so that the loops over a block run in vector registers. Each output set is
clipped once for each term, with the strongest of the rules that conclude it: that is exact for max aggregation.
Steps that take all tables by name are inlined, since every array that is handed on is counted on the way.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from fuzzynav.fuzzy import codes
from fuzzynav.fuzzy.compiled import Codes, Parts, Tables, compile_system
from fuzzynav.fuzzy.kernels import conorm, gaussian_row, hedged, member, norm
from fuzzynav.fuzzy.membership import Term
from fuzzynav.fuzzy.rules import Rule
from fuzzynav.fuzzy.set_kernels import aggregate, exact_centroid, max_min_centroid, of_samples, weighted
from fuzzynav.fuzzy.variable import RuleBlock, Variable
from fuzzynav.geometry import Array

__all__ = ["infer_one", "run"]

Mask = NDArray[np.bool_]
_BLOCK = 64


class Work(NamedTuple):
    """What is known of a block of `width` points, step by step; a last, short block leaves the columns beyond it."""

    points: Array  # (width, n_inputs)
    mu: Array  # (n_input_terms, width) memberships
    truth: Array  # (n_propositions, width)
    stack: Array  # (n_propositions + 1, width)
    firing: Array  # (n_rules, width)
    h: Array  # (n_sets, width) strengths of the concluded sets
    answer: Array  # (width,)
    fires: Mask  # (width,) whether the output at hand hears a rule
    missing: Mask  # (width,) whether an input is nan


@njit(cache=True, inline="always")
def _room(t: Parts, width: int) -> Work:
    n = t.propositions.shape[0]
    return Work(
        np.empty((width, t.ranges.shape[0])), np.empty((t.n_input_terms, width)), np.empty((n, width)),
        np.empty((n + 1, width)), np.empty((t.weights.size, width)), np.empty((t.slots.shape[0], width)),
        np.empty(width), np.empty(width, np.bool_), np.empty(width, np.bool_),
    )  # fmt: skip


@njit(cache=True, inline="always")
def _fuzzify(t: Parts, points: Array, mu: Array) -> None:
    """Memberships mu (n_terms, width) of the points (width, n_inputs)."""
    terms, ranges, parameters, lists = t.terms, t.ranges, t.numbers, t.lists
    width = points.shape[0]
    column, bits = np.empty(width), np.empty(width)
    loaded = -1
    for term in range(mu.shape[0]):
        i, code = terms[term, codes.OWNER], terms[term, codes.SHAPE]
        if i != loaded:
            loaded = i
            for p in range(width):
                column[p] = points[p, i]
                if ranges[i, codes.LOCKED] > 0.0 and not math.isnan(column[p]):
                    column[p] = min(max(column[p], ranges[i, codes.LOW]), ranges[i, codes.HIGH])
        if code == codes.GAUSSIAN:
            gaussian_row(column, parameters[term], bits, mu[term])
        else:
            first, pairs, numbers = terms[term, codes.FIRST], terms[term, codes.PAIRS], parameters[term]
            for p in range(width):
                mu[term, p] = member(code, numbers, column[p], lists, first, pairs)


@njit(cache=True)
def _qualify(mu: Array, propositions: Codes, props: Array) -> None:
    """Truth props (n_propositions, width) of each `variable is [hedges] term`."""
    for k in range(propositions.shape[0]):
        term = propositions[k, codes.TERM]
        for p in range(mu.shape[1]):
            props[k, p] = mu[term, p] if term >= 0 else 1.0
        for j in range(codes.FIRST_HEDGE, propositions.shape[1]):
            code = propositions[k, j]
            for p in range(mu.shape[1] if code != codes.NO_HEDGE else 0):
                props[k, p] = hedged(code, props[k, p])


@njit(cache=True)
def _and3(props: Array, a: int, b: int, c: int, weight: float, firing: Array, rule: int) -> None:
    for p in range(props.shape[1]):
        u = props[a, p] if props[a, p] < props[b, p] else props[b, p]
        u = u if u < props[c, p] else props[c, p]
        firing[rule, p] = weight * u


@njit(cache=True)
def _join(both: bool, code: int, here: Array, other: Array) -> None:
    """Join `other` to `here` in place: by AND if `both`, else by OR."""
    if both and code == codes.MIN:
        for p in range(here.size):
            here[p] = here[p] if here[p] < other[p] else other[p]
    elif both and code == codes.PRODUCT:
        for p in range(here.size):
            here[p] = here[p] * other[p]
    elif both:
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
        if op == codes.AND_OF_THREE:
            _and3(props, operand, code, program[k, 3], weights[program[k, 4]], firing, program[k, 4])
        elif op == codes.LOAD:
            top += 1
            for p in range(stack.shape[1]):
                stack[top, p] = props[operand, p]
        elif op == codes.STORE:
            for p in range(stack.shape[1]):
                firing[operand, p] = weights[operand] * stack[top, p]
            top -= 1
        elif op == codes.AND_NEXT or op == codes.OR_NEXT:
            _join(op == codes.AND_NEXT, code, stack[top], props[operand])
        else:
            top -= 1
            _join(op == codes.AND_TOP, code, stack[top], stack[top + 1])


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
        for k in range(codes.FIRST_CONCLUSION_HEDGE, consequents.shape[1]):
            hedge_free = hedge_free and consequents[c, k] == codes.NO_HEDGE
    c = 0
    while c < n:
        rule, slot = consequents[c, codes.RULE], consequents[c, codes.SET]
        code = slots[slot, codes.MERGE]
        if hedge_free and code == codes.MAX:
            second, third = rule, rule
            if c + 1 < n and consequents[c + 1, codes.SET] == slot:
                second = consequents[c + 1, codes.RULE]
            if second != rule and c + 2 < n and consequents[c + 2, codes.SET] == slot:
                third = consequents[c + 2, codes.RULE]
            c += 1 + (second != rule) + (third != rule)
            _strongest(h, slot, firing, rule, second, third)
            continue
        for p in range(firing.shape[1]):
            m = firing[rule, p]
            fires = m > 0.0
            for k in range(codes.FIRST_CONCLUSION_HEDGE, consequents.shape[1]):
                if fires and consequents[c, k] != codes.NO_HEDGE:
                    m = hedged(consequents[c, k], m)
            h[slot, p] = conorm(code, h[slot, p], m)
        c += 1


@njit(cache=True, inline="always")
def _output(o: int, t: Parts, h: Array, points: Array, answer: Array) -> None:
    """Crisp answers (width,) of output o, measured from the centre of its range; nan where nothing fires."""
    output = t.outputs[o]
    first, n, samples = output[codes.FIRST_SET], output[codes.SETS], output[codes.SAMPLES]
    defuzzifier, quadrature = output[codes.DEFUZZIFIER], output[codes.QUADRATURE]
    aggregation = output[codes.AGGREGATION]
    width = answer.size
    own, mine = h[first : first + n], t.slots[first : first + n]
    implied, clipped = np.empty(n, np.int64), True
    for k in range(n):
        implied[k] = mine[k, codes.IMPLICATION]
        clipped = clipped and implied[k] == codes.MIN
    average, total = defuzzifier == codes.WEIGHTED_AVERAGE, defuzzifier == codes.WEIGHTED_SUM
    if average or total or quadrature == codes.EXACT:
        strengths, summed = np.empty(n), aggregation == codes.SUM
        for p in range(width):
            for k in range(n):
                strengths[k] = own[k, p]
            if average or total:
                answer[p] = weighted(average, strengths, mine, t, points[p])
            else:
                answer[p] = exact_centroid(t.knots[o, :samples], t.lines[o], strengths, implied, summed)
        return
    sampled, rows = t.sampled[o, :2, :samples], t.sampled[o, codes.FIRST_ROW : codes.FIRST_ROW + n, :samples]
    if defuzzifier == codes.CENTROID and aggregation == codes.MAX and clipped:
        area = np.empty(width)
        max_min_centroid(own, rows, sampled, area, answer)
        for p in range(width):
            answer[p] = answer[p] / area[p] if area[p] > 0.0 else math.nan
        return
    mu = np.empty((width, samples))
    aggregate(own, rows, implied, aggregation, mu)
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


@njit(cache=True, inline="always")
def _reason(t: Parts, work: Work, fuzzify: bool) -> None:
    """From the points, or from memberships that are given, to the strengths of the concluded sets."""
    if fuzzify:
        _fuzzify(t, work.points, work.mu)
    _qualify(work.mu, t.propositions, work.truth)
    _fire(work.truth, t.program, t.weights, work.stack, work.firing)
    _conclude(work.firing, t.consequents, t.slots, work.h)


@njit(cache=True)
def _mark(output: Codes, h: Array, fires: Mask) -> None:
    """Where in the block any set of an output (its row of `outputs`) is concluded."""
    first = output[codes.FIRST_SET]
    for p in range(fires.size):
        fires[p] = False
    for k in range(first, first + output[codes.SETS]):
        for p in range(fires.size):
            fires[p] = fires[p] or h[k, p] > 0.0


@njit(cache=True)
def _mark_missing(points: Array, missing: Mask) -> None:
    """Where in the block an input is nan."""
    for p in range(missing.size):
        missing[p] = False
        for i in range(points.shape[1]):
            missing[p] = missing[p] or math.isnan(points[p, i])


@njit(cache=True)
def _witness(work: Work, p: int, row: Array) -> None:
    """The evidence at point p of the block: memberships, firing and strengths, end to end."""
    n_terms, n_rules, missing = work.mu.shape[0], work.firing.shape[0], work.missing[p]
    for k in range(n_terms):
        row[k] = work.mu[k, p]
    for k in range(n_rules):
        row[n_terms + k] = math.nan if missing else work.firing[k, p]
    for k in range(work.h.shape[0]):
        row[n_terms + n_rules + k] = math.nan if missing else work.h[k, p]


@njit(cache=True)
def run(points: Array, degrees: Array, previous: Array, tables: Tables, values: Array, evidence: Array) -> None:
    """Evaluate all points (n, n_inputs) with the tables of a system and write values (n, n_outputs).

    `degrees` (n, n_input_terms), when it has columns, replaces the fuzzification of the points; `previous`
    (n, n_outputs), when it has rows, holds earlier answers; `evidence` (n, n_input_terms + n_rules + n_sets) is written
    when it has rows.
    """
    t = Parts(*tables)
    n, n_in = points.shape
    n_out, wide, fuzzify = t.outputs.shape[0], max(1, min(n, _BLOCK)), degrees.shape[1] == 0
    work = _room(t, wide)
    block, mu, answer, fires, missing = work.points, work.mu, work.answer, work.fires, work.missing
    for start in range(0, n, wide):
        width = min(wide, n - start)
        for p in range(width):
            for i in range(n_in):
                block[p, i] = points[start + p, i]
            for k in range(degrees.shape[1]):
                mu[k, p] = degrees[start + p, k]
        _reason(t, work, fuzzify)
        _mark_missing(block, missing)
        for o in range(n_out):
            _output(o, t, work.h, block, answer)
            _mark(t.outputs[o], work.h, fires)
            settings = t.settings[o]
            for p in range(width):
                before = previous[start + p, o] if previous.shape[0] > 0 else math.nan
                found = _settle(answer[p], fires[p], before, settings)
                values[start + p, o] = math.nan if missing[p] else found
        for p in range(width if evidence.shape[0] > 0 else 0):
            _witness(work, p, evidence[start + p])


@njit(cache=True)
def infer_one(tables: Tables, inputs: Array, out: Array) -> float:
    """Answers at one point (n_inputs,), written to out (n_outputs,), for loops that are compiled themselves.

    `tables` is `FuzzySystem.tables`. Gives the strength of the strongest rule: 0 where the answers are the stated
    defaults because no rule fires, nan where an input is nan.
    """
    t = Parts(*tables)
    work = _room(t, 1)
    for i in range(inputs.size):
        work.points[0, i] = inputs[i]
    _reason(t, work, True)
    _mark_missing(work.points, work.missing)
    for o in range(t.outputs.shape[0]):
        _output(o, t, work.h, work.points, work.answer)
        _mark(t.outputs[o], work.h, work.fires)
        found = _settle(work.answer[0], work.fires[0], math.nan, t.settings[o])
        out[o] = math.nan if work.missing[0] else found
    return math.nan if work.missing[0] else work.firing.max()


def _warm() -> None:
    term = Term(name="Low", shape="triangle", parameters=(0, 0, 1))
    x, y = (Variable(name=name, low=0, high=1, terms=(term,)) for name in "xy")
    tables = compile_system((x,), (y,), (RuleBlock(rules=(Rule.parse("if x is Low then y is Low"),)),)).tables
    point, empty = np.zeros((1, 1)), np.empty((0, 0))
    run(point, empty, empty, tables, np.empty((1, 1)), empty)
    infer_one(tables, point[0], np.empty(1))
