"""Directions, cross products and rotations in numbers and in SymPy."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.errors import SceneError, shown
from fricmb.integrate.problem import Floats
from fricmb.values import as_float

Vector = tuple[Any, Any, Any]


def cross(a: Any, b: Any) -> Vector:
    """The vector product of two triples."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a: Any, b: Any) -> Any:
    """The scalar product of two triples."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def unit(label: str, argument: str, value: Any) -> Floats:
    """A direction as a unit vector (3,); SceneError for what has none."""
    try:
        given = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        given = np.zeros(0)
    length = float(np.linalg.norm(given)) if given.shape == (3,) else 0.0
    if not (math.isfinite(length) and length > 0.0):
        raise SceneError(f"{label}: {argument} must be three finite numbers, not all 0, got {shown(value)}")
    found: Floats = given / length
    return found


#: Components of a unit vector that are the same, or 0, to round-off.
ALIKE = 1e-9


def triad(e: Floats) -> tuple[Floats, Floats]:
    """Unit vectors u, w at right angles to the unit vector e, with u x w = e; along axes where e is along one.

    Round-off of e does not choose: of an axis that has been turned there and back u is what it was.
    """
    size = np.abs(e)
    i = int(np.argmax(size <= size.min() + ALIKE))
    along = int(np.argmax(size))
    start = np.eye(3)[(along + 1) % 3 if np.count_nonzero(size > ALIKE) == 1 else i]
    u = start - (start @ e) * e
    u /= np.linalg.norm(u)
    return u, np.cross(e, u)


@answers
def turned(*, axis: Any, angle: float) -> tuple[tuple[float, ...], ...]:
    """The orientation after a turn from the axes of space: a rotation matrix, by rows.

    Parameters
    ----------
    axis : (float, float, float)
        Direction to turn about.
    angle : float
        In radians, counter-clockwise seen against the axis.

    Returns
    -------
    tuple of 3 tuples
        Its columns are the axes of the body: ``x_space = R @ x_body``.

    Examples
    --------
    >>> import numpy as np
    >>> import fricmb as fm
    >>> np.round(fm.space.turned(axis=(0, 0, 1), angle=np.pi / 2), 12)[:, 0]
    array([0., 1., 0.])
    """
    e = unit("turned", "axis", axis)
    if not math.isfinite(as_float(angle)):
        raise SceneError(f"turned: angle must be a finite number, got {shown(angle)}")
    K = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
    R = np.eye(3) + math.sin(angle) * K + 2.0 * math.sin(0.5 * angle) ** 2 * K @ K
    return tuple(tuple(float(x) for x in row) for row in R)


#: Rotation matrices are orthonormal to this.
ORTHONORMAL = 1e-9


def rotation(label: str, value: Any) -> tuple[tuple[float, ...], ...]:
    """The rotation matrix nearest to what is given; SceneError for what is none."""
    try:
        R = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):
        R = np.zeros(0)
    off = np.abs(R.T @ R - np.eye(3)).max() if R.shape == (3, 3) and np.isfinite(R).all() else math.inf
    if off > ORTHONORMAL or np.linalg.det(R) < 0.0:
        accepted = "a rotation matrix (3 x 3, orthonormal, determinant 1), such as turned(axis=(0, 0, 1), angle=0.1)"
        raise SceneError(f"{label}: orientation must be {accepted}, got {shown(value)}")
    left, _, right = np.linalg.svd(R)
    return tuple(tuple(float(x) for x in row) for row in left @ right)
