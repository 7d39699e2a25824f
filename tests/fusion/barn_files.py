"""Small files of the form in which the worlds of BARN and DynaBARN are read."""

import json
from pathlib import Path

import numpy as np


def write_barn(folder: Path) -> Path:
    """Three hundred worlds of two discs each, world n with one in row n % 64; sixty worlds with a mover far off."""
    cells = np.zeros((300, 64, 30), dtype=bool)
    for n in range(300):
        cells[n, n % 64, 3] = cells[n, 10, 29] = True
    lengths = 10.0 + np.arange(300) / 100.0
    np.savez(folder / "barn300.npz", occupied=np.packbits(cells), shape=[300, 64, 30], x0=-4.425, y0=0.075, cell=0.15,
             radius=0.075, optimal_length=lengths)  # fmt: skip
    worlds = [[[4.0, [[0.0, -5.0, 3.0], [1.0, -5.0, 4.0], [4.0, -5.0, 7.0]]]] for _ in range(60)]
    # world 7: a mover stands where the robot starts, from 3 s to 5 s of its loop
    worlds[7] = [[40.0, [[0.0, 5.0, 5.0], [3.0, 11.0, 0.0], [5.0, 11.0, 0.0], [8.0, 5.0, 5.0], [40.0, 5.0, 6.0]]]]
    shared = {"mover_radius": 0.5, "walls": [[-10, 0, 0.5, 20], [0, 10, 20, 0.5], [0, -10, 20, 0.5]]}
    text = json.dumps({**shared, "start": [11, 0, 3.14], "goal": [-9, 0], "worlds": worlds})
    (folder / "dynabarn60.json").write_text(text)
    return folder
