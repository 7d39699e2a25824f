"""Speed of fuzzy inference: the 27 rules of the planner, 3 inputs, 2 outputs, at 101 and 1001 samples.

The answers are compared with ours under the peer's own quadrature; what is timed is our default, the trapezoid rule.
Peers that are slow get a smaller batch and are scaled per evaluation. Times are CPU seconds of all cores together, so
that a busy machine and a peer that uses every core are measured fairly.
"""

import importlib.util
import time
import warnings
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from skfuzzy import control

from fuzzynav.fuzzy import FuzzySystem

PLANNER = Path(__file__).resolve().parents[2] / "data" / "fuzzy" / "fuzzy_planner_table_i.fll"
BATCH = 100_000


def seconds(action, repeats):
    """Least CPU seconds of one run of `action`, after a first one that does not count."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return min(times)


def ours_at(samples, quadrature="trapezoid"):
    system = FuzzySystem.load(PLANNER)
    outputs = tuple(replace(v, resolution=samples, quadrature=quadrature) for v in system.outputs)
    return replace(system, outputs=outputs)


def skfuzzy_side(system):
    """Functions (one point, batch) of scikit-fuzzy, and the size of the batch."""
    control_system = system.to_skfuzzy()
    names = [variable.name for variable in system.inputs]
    outputs = [variable.name for variable in system.outputs]

    def run(x):
        simulation = control.ControlSystemSimulation(control_system, cache=False)
        for name, values in zip(names, x):
            simulation.input[name] = values
        with warnings.catch_warnings():  # `out` by position, which NumPy 2.4 no longer likes
            warnings.simplefilter("ignore", DeprecationWarning)
            simulation.compute()
        return tuple(simulation.output[name] for name in outputs)

    return run, run, 200


def pyfuzzylite_side(samples):
    import fuzzylite

    engine = fuzzylite.FllImporter().from_file(str(PLANNER))
    for output in engine.output_variables:
        output.defuzzifier.resolution = samples

    def run(x):
        for variable, values in zip(engine.input_variables, x):
            variable.value = values
        engine.process()
        return tuple(np.array(variable.value) for variable in engine.output_variables)

    return run, run, 2_000


def ferrifuzz_side(system, samples):
    import ferrifuzz

    peer = ferrifuzz.FuzzySystem(resolution=samples - 1)
    for variables, add in ((system.inputs, peer.add_input), (system.outputs, peer.add_output)):
        for variable in variables:
            theirs = ferrifuzz.Variable(variable.name, variable.low, variable.high)
            for term in variable.terms:
                theirs[term.name] = ferrifuzz.mf.gaussian(*term.parameters)
            add(theirs)
    peer.add_rules([str(rule) for rule in system.rules])
    names = [variable.name for variable in system.inputs]
    outputs = [variable.name for variable in system.outputs]

    def batch(x):
        found = peer.compute_batch(dict(zip(names, x)))
        return tuple(found[name] for name in outputs)

    return peer.evaluate, batch, BATCH


def peers(system, samples):
    """(name, quadrature, one, batch, size) of every peer; None in place of functions where it is not installed."""
    yield "scikit-fuzzy 0.5", "trapezoid", *skfuzzy_side(system)
    for name, quadrature, module, side in (
        ("pyfuzzylite 8", "midpoint", "fuzzylite", lambda: pyfuzzylite_side(samples)),
        ("ferrifuzz 0.2 (Rust)", "sum", "ferrifuzz", lambda: ferrifuzz_side(system, samples)),
    ):
        if importlib.util.find_spec(module) is None:
            yield f"{name}: not installed", quadrature, None, None, 0
        else:
            yield name, quadrature, *side()


def repeat(function, x, times):
    for _ in range(times):
        function(x)


def against(what, samples, ours, many, peer):
    """The two rows, one call and batch, of one peer. `ours` is (one call in us, batch rate)."""
    name, quadrature, one, whole, size = peer
    if one is None:
        lone = row(f"{what}, one call", "us", ours[0], None, name, "")
        return [lone, row(f"{what}, batch of {BATCH:,}", "1/s", ours[1], None, name, "")]
    points = many[:, : min(size, 2000)]
    apart = np.abs(np.stack(whole(points)) - ours_at(samples, quadrature)(*points)) / [[1.0], [90.0]]
    agreement = f"largest difference {apart.max():.0e} of the range, {points.shape[1]} points, {quadrature} rule"
    x = [float(v) for v in many[:, 0]]
    theirs = 1e6 * seconds(partial(repeat, one, x, 20), 3) / 20
    their_rate = size / seconds(partial(whole, many[:, :size]), 2)
    scaled = "" if size == BATCH else f" (batch of {size:,}, scaled)"
    return [
        row(f"{what}, one call", "us", ours[0], theirs, name, agreement),
        row(f"{what}, batch of {BATCH:,}", "1/s", ours[1], their_rate, name + scaled, agreement),
    ]


def rows():
    """Two rows, one call and batch, for each number of samples and peer; CPU time."""
    result = []
    many = np.random.default_rng(7).uniform(0.0, 1.0, (3, BATCH))
    for samples in (101, 1001):
        system = ours_at(samples)
        x = [float(v) for v in many[:, 0]]
        single = 1e6 * seconds(partial(repeat, lambda x, f=system: f(*x), x, 2000), 5) / 2000
        rate = BATCH / seconds(partial(system, *many), 5)
        for peer in peers(system, samples):
            result += against(f"fuzzy, 27 rules, {samples} samples", samples, (single, rate), many, peer)
    return result


def row(task, unit, ours, peer, name, agreement):
    ratio = None if peer is None else ours / peer if unit == "1/s" else peer / ours
    return {
        "task": task, "unit": unit, "ours": ours, "peer": peer, "peer_name": name, "ratio": ratio,
        "agreement": agreement,
    }  # fmt: skip
