"""How bodies in space stand in each picture: rotation matrices from their coordinates."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from fricmb.plot._sketch import Floats, Motion
from fricmb.scene import RigidBody


def turns_of(body: Any, position: Motion, n: int) -> Floats:
    """Axes (3, 3, n) of a body, as columns."""
    import fricmb.space as space

    def rows(letters: tuple[str, ...]) -> Floats:
        return np.array([position(f"{body.name}.{letter}") for letter in letters])

    if isinstance(body, space.RigidBody):
        return rows(body.turning).reshape(3, 3, n).transpose(1, 0, 2)
    if isinstance(body, space.Rotor):
        return _carried(rows(body.turning))
    if isinstance(body, space.Ball):
        return _added(rows(body.turning))
    if isinstance(body, RigidBody):
        angle = position(f"{body.name}.angle")
        return Rotation.from_rotvec(np.outer(angle, [0.0, 0.0, 1.0])).as_matrix().transpose(1, 2, 0)
    return np.repeat(np.eye(3)[:, :, None], n, axis=2)


def _carried(rows: Floats) -> Floats:
    """Of a rotor: directions that the axis (3, n) carries along on the shortest way, turned by the spin (n,).

    ``omega = n x n' + s' n``: the first part is what the shortest way from one picture to the next does.
    """
    axes, spin = (rows[:3] / np.linalg.norm(rows[:3], axis=0)).T, rows[3]
    frame = _to(np.array([0.0, 0.0, 1.0]), axes[0])
    found = []
    for k, axis in enumerate(axes):
        if k:
            frame = _to(axes[k - 1], axis) * frame
        found.append((frame * Rotation.from_rotvec([0.0, 0.0, spin[k]])).as_matrix())
    return np.array(found).transpose(1, 2, 0)


def _to(start: Floats, end: Floats) -> Rotation:
    """The shortest turn of one unit vector into another."""
    axis = np.cross(start, end)
    sine, cosine = float(np.linalg.norm(axis)), float(start @ end)
    if sine == 0.0 and cosine < 0.0:  # half a turn, about anything across
        axis = np.cross(start, np.eye(3)[int(np.argmin(np.abs(start)))])
        return Rotation.from_rotvec(np.pi * axis / np.linalg.norm(axis))
    return Rotation.from_rotvec(axis * (np.arctan2(sine, cosine) / sine if sine > 0.0 else 0.0))


def _added(turned: Floats) -> Floats:
    """Of a ball: the turns (3, n) about the axes of space between pictures, one after the other.

    Between two pictures they are taken as one turn, which is right where the axis keeps still: enough for a picture.
    """
    found = [Rotation.identity()]
    for step in np.diff(turned, axis=1).T:
        found.append(Rotation.from_rotvec(step) * found[-1])
    return np.array([turn.as_matrix() for turn in found]).transpose(1, 2, 0)
