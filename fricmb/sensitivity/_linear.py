"""Parts whose forces are linear in the degrees of freedom and constant in time: matrices, made once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._found import Found
from fricmb.sensitivity._motions import Frame, Moment


class Linear:
    """Sum of the linear ones of parts: f = f_0 + A y, and the derivatives of that by parameters.

    Parameters
    ----------
    parts : sequence
        Those with ``is_linear(moment)``; the others are left in ``rest``.
    frame : Frame
    columns : int

    Notes
    -----
    Found by asking the parts at y = 0 and at unit vectors.
    """

    def __init__(self, parts: Sequence[Any], frame: Frame, columns: int) -> None:
        n = self.n = frame.n
        start = _moment(frame, np.zeros((2 * n, 1)))
        own = [part for part in parts if part.is_linear(start)]
        self.rest = [part for part in parts if part not in own]
        found = Found(n, 0, columns, 1)
        for part in own:
            part.add(start, found)
        self.force = found.force.copy()
        self.constant = found.dense(found.slopes, n)[..., 0]
        self.matrix = self.constant[:, : 2 * n].copy()
        self.constant[:, 2 * n :] = 0.0
        self.seeded = _seeded([part for part in own if part.seeded], frame, columns)

    def add(self, moment: Moment, found: Found) -> None:
        """The forces of all of them."""
        y = np.concatenate([moment.q, moment.v])
        found.force += self.force + self.matrix @ y
        found.constant = self.constant
        for (i, j), (value, row) in self.seeded.items():
            found.add_slope(i, j, value + row @ y)


def _seeded(parts: list[Any], frame: Frame, columns: int) -> dict[tuple[int, int], tuple[float, Floats]]:
    """Slopes by parameters: degree of freedom and column to the value at y = 0 and its row."""
    if not parts:
        return {}
    size = 2 * frame.n
    found = Found(frame.n, 0, columns, 1 + size)
    units = _moment(frame, np.hstack([np.zeros((size, 1)), np.eye(size)]))
    for part in parts:
        part.add(units, found)
    slopes = {place: np.broadcast_to(s, (1 + size,)) for place, s in found.slopes.items() if place[1] >= size}
    return {place: (float(s[0]), s[1:] - s[0]) for place, s in slopes.items()}


def _moment(frame: Frame, y: Floats) -> Moment:
    count = y.shape[1]
    return Moment(frame=frame, t=np.zeros(count), q=y[: frame.n], v=y[frame.n :], z=np.zeros((0, count)))
