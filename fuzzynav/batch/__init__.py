"""Thousands of worlds: run an experiment over many cases on any executor, resume it, report it.

An experiment is a function from one case (a seed, or any value that prints the same every time) to one row, or to
several rows: dicts of plain values. It must be importable by name, so that other processes and machines can run it.
"""

from fuzzynav.batch.identity import Label, label_of, refusal
from fuzzynav.batch.sheet import Row, Sheet, checksum_of, encoded, read, sheet_of
from fuzzynav.batch.source import code_of
from fuzzynav.batch.statistics import paired, proportion, summary
from fuzzynav.batch.sweep import Experiment, run, write_whole

__all__ = [
    "Experiment",
    "Label",
    "Row",
    "Sheet",
    "checksum_of",
    "code_of",
    "encoded",
    "label_of",
    "paired",
    "proportion",
    "read",
    "refusal",
    "run",
    "sheet_of",
    "summary",
    "write_whole",
]
