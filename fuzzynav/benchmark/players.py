"""Runs as small players in a page: the ground as a picture, what moves as numbers, drawn by a few lines of script."""

from __future__ import annotations

import base64
import json
from html import escape

import numpy as np

from fuzzynav.plot.base import COLORS
from fuzzynav.plot.benchmark import ground_png
from fuzzynav.simulate.record import Run
from fuzzynav.world import World

__all__ = ["PLAYER_SCRIPT", "player_html"]

FRAMES = 120  # shown of a run at most
PLAYER_SCRIPT = """
for (const box of document.querySelectorAll(".player")) {
  const run = JSON.parse(box.querySelector("script").textContent), canvas = box.querySelector("canvas");
  const pen = canvas.getContext("2d"), slider = box.querySelector("input"), said = box.querySelector("output");
  const [x0, x1, y0, y1] = run.box, scale = canvas.width / (x1 - x0), ground = new Image();
  const at = (x, y) => [(x - x0) * scale, (y1 - y) * scale];
  const disc = (x, y, r, color) => {
    pen.beginPath(); pen.arc(...at(x, y), r * scale, 0, 2 * Math.PI); pen.fillStyle = color; pen.fill();
  };
  const draw = () => {
    const k = +slider.value, [x, y, theta] = run.poses[k];
    pen.drawImage(ground, 0, 0, canvas.width, canvas.height);
    (run.movers[k] || []).forEach(([mx, my], i) => disc(mx, my, run.radii[i], run.colors.mover));
    pen.beginPath(); run.poses.slice(0, k + 1).forEach(([px, py]) => pen.lineTo(...at(px, py)));
    pen.strokeStyle = run.colors.path; pen.lineWidth = 2; pen.stroke();
    disc(x, y, run.radius, run.colors.robot);
    pen.beginPath(); pen.moveTo(...at(x, y));
    pen.lineTo(...at(x + run.radius * Math.cos(theta), y + run.radius * Math.sin(theta)));
    pen.strokeStyle = "white"; pen.stroke();
    said.textContent = run.times[k].toFixed(1) + " s";
  };
  let timer = null;
  const stop = () => { clearInterval(timer); timer = null; };
  const ended = () => +slider.value >= run.poses.length - 1;
  const step = () => { if (ended()) stop(); else slider.value = +slider.value + 1; draw(); };
  box.querySelector("button").onclick = () => {
    if (timer) return stop();
    if (ended()) slider.value = 0;
    timer = setInterval(step, 60);
  };
  slider.oninput = draw; ground.onload = draw; ground.src = run.ground;
}
"""


def player_html(run: Run, world: World, title: str) -> str:
    """A run that can be played and scrubbed, as a piece of a page that holds PLAYER_SCRIPT once; opens at its end."""
    picture, box = ground_png(world, run)
    last = len(run.t) - 1
    kept = np.unique(np.linspace(0, last, min(FRAMES, last + 1)).round().astype(int))
    movers = run.log.get("movers", np.empty((last + 1, 0, 2)))[kept]
    shown = {
        "ground": "data:image/png;base64," + base64.b64encode(picture).decode(),
        "box": box,
        "radius": run.radius,
        "radii": [m.radius for m in world.movers],
        "colors": {name: COLORS[name] for name in ("mover", "path", "robot")},
        "times": run.t[kept].round(2).tolist(),
        "poses": run.poses[kept].round(3).tolist(),
        "movers": movers.round(2).tolist(),
    }
    data = json.dumps(shown, separators=(",", ":")).replace("</", "<\\/")
    width, height = 420, round(420 * (box[3] - box[2]) / (box[1] - box[0]))
    return (
        f'<figure class="player"><figcaption>{escape(title)}</figcaption>'
        f'<canvas width="{width}" height="{height}"></canvas><div><button type="button">play</button>'
        f'<input type="range" min="0" max="{len(kept) - 1}" value="{len(kept) - 1}" aria-label="time"><output></output>'
        f'</div><script type="application/json">{data}</script></figure>'
    )
