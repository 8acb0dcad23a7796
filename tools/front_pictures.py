"""Make the pictures of the README and the landing page, into docs/images.

    python tools/front_pictures.py

The moving picture and the first run come from the scene of the README; who reaches which error in what time from the
committed results of the benchmark.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

import fricmb as fm
from fricmb.plot import BLUE, DARK, ORANGE

ROOT = Path(__file__).parents[1]
IMAGES = ROOT / "docs" / "images"
#: What the pictures of the front page compare, and how: fricmb's default in colour, other programs in grey.
PEERS = {
    "numbalsoda lsoda": "LSODA (numbalsoda)", "scipy LSODA": "LSODA (scipy)", "CVODE": "CVODE (SUNDIALS)",
    "Exudyn": "Exudyn", "scipy BDF": "BDF (scipy)",
}  # fmt: skip
#: Where a name stands beside the last point of its line, in points, and which way it runs.
LEFT = "left"
BESIDE = {
    "numbalsoda lsoda": (8, -5, LEFT), "scipy LSODA": (8, -13, LEFT), "CVODE": (4, 8, LEFT), "Exudyn": (-4, 9, LEFT),
    "scipy BDF": (8, -2, LEFT),
}  # fmt: skip
BELT = 0.1
#: Two periods of the motion, so that the picture runs round.
FRAMES, PER_SECOND, START, T_END = 80, 15, 13.0, 2 * 13.53638378328955


def first_scene() -> fm.Scene:
    """The scene of the README."""
    block = fm.Body("block", mass=1.0)
    belt = fm.Driven("belt", velocity={"x": BELT})
    law = fm.laws.Coulomb(mu_s=1.5, mu_k=1.0)
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.Scene("stick-slip", [block, belt, spring, fm.Contact("sole", block, belt, law=law, normal_force=1.0)])


def moving_picture(path: Path) -> None:
    """The block on its belt above its position over time, in colour where it slips."""
    times = START + T_END * np.arange(FRAMES) / FRAMES
    sol = fm.simulate(first_scene(), t_end=START + T_END, rtol=1e-8)
    fine = sol.at(np.linspace(START, START + T_END, 1500))
    x, slips = fine["block.x"], fine.mode("sole") == 1
    at = sol.at(times)
    figure = Figure(figsize=(6.4, 3.3), dpi=85, layout="constrained")
    top, below = figure.subplots(2, 1, height_ratios=(1.0, 1.25))
    top.set_xlim(-1.2, 2.4)
    top.set_ylim(-0.35, 0.75)
    top.set_axis_off()
    (spring,) = top.plot([], [], color=DARK, linewidth=1.2)
    top.add_patch(Rectangle((-1.15, -0.25), 0.06, 0.9, color="0.75"))
    (marks,) = top.plot([], [], "|", color="0.45", markersize=9)
    top.plot([-1.05, 2.4], [0.0, 0.0], color="0.45", linewidth=3)
    block = top.add_patch(Rectangle((0.0, 0.02), 0.5, 0.42, facecolor=BLUE, edgecolor=DARK))
    word = top.text(0.0, 0.52, "", ha="center", fontsize=10)
    below.plot(fine.t, np.where(slips, np.nan, x), color=BLUE, linewidth=2)
    below.plot(fine.t, np.where(slips, x, np.nan), color=ORANGE, linewidth=2)
    (dot,) = below.plot([], [], "o", color=DARK, markersize=6)
    below.set_xlabel("time")
    below.set_ylabel("position")
    below.spines[["top", "right"]].set_visible(False)

    def draw(i: int) -> tuple[Any, ...]:
        here, slipping = at["block.x"][i], at.mode("sole")[i] == 1
        block.set_x(here)
        block.set_facecolor(ORANGE if slipping else BLUE)
        word.set_position((here + 0.25, 0.52))
        word.set_text("slips" if slipping else "sticks")
        wave = np.linspace(0.0, 1.0, 200)
        ends = -1.09 + wave * (here + 1.09)
        spring.set_data(ends, 0.22 + 0.07 * np.sin(2 * np.pi * 9 * wave) * (np.abs(wave - 0.5) < 0.42))
        shift = np.arange(-1.4, 2.8, 0.2) + (BELT * times[i]) % 0.2
        marks.set_data(shift[(shift > -1.0) & (shift < 2.4)], np.full(np.sum((shift > -1.0) & (shift < 2.4)), -0.08))
        dot.set_data([times[i]], [here])
        return block, spring, marks, dot, word

    animation = FuncAnimation(figure, draw, frames=FRAMES, blit=False)
    animation.save(path, writer=PillowWriter(fps=PER_SECOND))


def first_picture(path: Path) -> None:
    """What the ten lines of the README draw."""
    fm.simulate(first_scene(), t_end=50.0, rtol=1e-8).plot.velocities().savefig(path, dpi=110)


def comparison(path: Path) -> None:
    """Error against processor time on the brake, case 2, from the committed benchmark."""
    result = json.loads((ROOT / "docs" / "benchmark" / "result.json").read_text(encoding="utf-8"))
    cells = [cell for cell in result["cells"] if cell["case"] == "brake2" and cell["metrics"] and not cell["failure"]]
    figure = Figure(figsize=(6.4, 3.8), dpi=110, layout="constrained")
    ax = figure.subplots()
    for method, title in {**PEERS, "auto": "fricmb"}.items():
        mine = [cell for cell in cells if cell["method"] == method]
        points = sorted((cell["metrics"]["state"], 1e3 * cell["seconds"]) for cell in mine)
        error, time = np.array([(e, t) for e, t in points if e < 1.0]).T
        front = time <= np.minimum.accumulate(time)  # a setting that is slower and no better is left out
        own = method == "auto"
        style = {"color": ORANGE, "linewidth": 2.5} if own else {"color": "0.5", "linewidth": 1.2}
        marker = "o" if own else "Ps^vd"[list(PEERS).index(method)]
        ax.loglog(error[front], time[front], marker=marker, markersize=5, **style)
        at = int(np.argmin(error[front]))
        right, up, side = BESIDE.get(method, (0, 9, "right"))
        ax.annotate(
            title, (error[front][at], time[front][at]), xytext=(right, up), textcoords="offset points", ha=side,
            color=style["color"], weight="bold" if own else "normal",
        )  # fmt: skip
    ax.set_xlim(2e-13, 1.5)
    ax.invert_xaxis()
    ax.set_xlabel("error of the motion (each signal over its largest value)")
    ax.set_ylabel("processor time [ms]")
    ax.grid(True, which="major", linewidth=0.3)
    ax.spines[["top", "right"]].set_visible(False)
    figure.savefig(path)


def main() -> None:
    """All pictures."""
    moving_picture(IMAGES / "stick_slip.gif")
    first_picture(IMAGES / "first_run.png")
    comparison(IMAGES / "ahead.png")


if __name__ == "__main__":
    main()
