"""A sketch in space as data for a page."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from fricmb.plot._html import rounded, short
from fricmb.plot._sketch import Floats
from fricmb.plot.space._sketch import SpaceSketch, Spot


def space_data(sketch: SpaceSketch) -> dict[str, Any]:
    """A sketch as data; of what does not change one value."""
    return {
        "box": [rounded(pair) for pair in sketch.box],
        "solids": [_solid(sketch, k) for k in range(len(sketch.solids))],
        "links": [{"kind": link.kind, "a": _spot(link.a), "b": _spot(link.b)} for link in sketch.links],
        "pins": [_spot(pin) for pin in sketch.pins],
        "rails": [[rounded(point) for point in rail] for rail in sketch.rails],
        "floors": [
            {
                "through": rounded(floor.through),
                "frame": [rounded(row) for row in floor.frame],
                "angle": short(floor.angle),
                "half": floor.half,
            }
            for floor in sketch.floors
        ],
        "touches": [
            {
                "at": [short(row) for row in touch.at],
                "force": None if touch.force is None else [short(row) for row in touch.force],
                "mode": _modes(touch.mode),
            }
            for touch in sketch.touches
        ],
    }


def _solid(sketch: SpaceSketch, k: int) -> dict[str, Any]:
    solid = sketch.solids[k]
    return {
        "name": solid.name,
        "faces": [[rounded(point, 4) for point in face] for face in solid.faces],
        "shades": solid.shades,
        "lines": [[rounded(point, 4) for point in line] for line in solid.lines],
        "outward": [rounded(normal, 4) for normal in solid.outward],
        "reach": float(np.linalg.norm(solid.corners(), axis=1).max()),
        "place": [short(row) for row in sketch.places[k]],
        "turn": [short(row) for row in quaternions(sketch.turns[k])],
        "path": sketch.path(k) is not None,
    }


def quaternions(turns: Floats) -> Floats:
    """Of rotation matrices (3, 3, n): (4, n), x, y, z, w, each on the side of the one before."""
    found = Rotation.from_matrix(turns.transpose(2, 0, 1)).as_quat()
    turned = np.sum(found[1:] * found[:-1], axis=1) < 0.0
    return np.asarray((found * np.where(np.cumsum(np.concatenate(([False], turned))) % 2, -1.0, 1.0)[:, None]).T)


def _spot(spot: Spot) -> list[Any]:
    return [spot[0], rounded(spot[1])]


def _modes(mode: Any) -> list[int]:
    return [0] if mode is None else mode[:1].tolist() if np.ptp(mode) == 0 else mode.tolist()
