"""Drawings of a scene and of a law."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from fricmb.plot._animation import canvas, link
from fricmb.plot._layout import HEIGHT, ROW, WIDTH, layout
from fricmb.plot._style import DARK, ORANGE


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


