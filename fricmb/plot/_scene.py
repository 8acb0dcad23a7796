"""Drawings of a scene and of a law."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fricmb.plot._animation import canvas, link
from fricmb.plot._layout import HEIGHT, ROW, WIDTH, layout
from fricmb.plot._style import BLUE, DARK, ORANGE, THIN, finish


def draw_scene(scene: Any) -> Figure:
    """Bodies with their names, springs and dampers, contacts."""
    found = layout(scene)
    figure, ax = canvas(found, str(scene.name), legend=False)
    for kind, _, a, b in found.links:
        if a not in found.places:
            continue
        here = np.array(found.places[a])
        there = np.array(found.places[b]) if b in found.places else here - [WIDTH / 2 + 0.8, 0.0]
        ax.plot(*link(kind, here, there, b in found.places), color=DARK, linewidth=0.9)
    for name, (x, y) in found.places.items():
        face = "0.93" if found.moving[name] else "0.8"
        corner, width = (x - found.widths[name] / 2, y - HEIGHT / 2), found.widths[name]
        ax.add_patch(Rectangle(corner, width, HEIGHT, facecolor=face, edgecolor=DARK, linewidth=1.0))
        ax.text(x, y, name, ha="center", va="center", fontsize=8)
    for name, a, _ in found.contacts:
        x, y = found.places[a]
        ax.plot(x, y - 0.5 * ROW, "o", color=ORANGE, markeredgecolor=DARK, markersize=7)
        ax.annotate(name, (x, y - 0.5 * ROW), xytext=(7, -3), textcoords="offset points", fontsize=7)
    return figure


def draw_law(law: Any) -> Figure:
    """Coefficient over the slip speed, to beyond where it has changed most."""
    figure = Figure(figsize=(4.2, 2.6), layout="constrained")
    ax = figure.subplots()
    speeds = np.concatenate([[0.0], np.geomspace(1e-6, 1e3, 2000)])
    mu = np.asarray(law.coefficient(speeds))
    far = np.abs(mu - mu[1]) < 0.95 * np.ptp(mu[1:])
    top = 3 * float(speeds[far].max()) if np.ptp(mu[1:]) > 1e-12 and far.any() else 1.0
    if top > 100.0:  # viscous friction has no speed of its own
        top = 10 * float(law.numeric_slots().get("v_s", 0.1))
    r = np.linspace(0.0, top, 800)[1:]
    ax.plot(r, law.coefficient(r), color=BLUE, linewidth=1.2, label="slip")
    if law.kind != "smooth":
        ax.plot(0.0, law.break_away(), "o", color=ORANGE, markersize=5, label="break-away", clip_on=False)
    ax.axhline(0.0, color=DARK, linewidth=THIN)
    finish(ax, x="slip speed", y="coefficient", legend=True)
    return figure
