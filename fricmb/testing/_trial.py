"""Velocities, states and compiled forces that laws are tried with."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmb.laws import FrictionLaw
from fricmb.testing._base import Floats

#: From far below any speed that matters to far above.
SPEEDS = np.array([0.0, 1e-300, 1e-12, 1e-6, 1e-3, 0.03, 0.3, 1.0, 7.0, 1e3, 1e150, 1e300])

#: A length of a vector that is safe at 0 may leave this much.
AT_REST = 1e-60

_DIRECTIONS: dict[int, list[tuple[float, ...]]] = {
    1: [(1.0,), (-1.0,)],
    2: [(0.6, -0.8), (0.0, 1.0)],
    3: [(0.6, -0.8, 0.5), (0.0, 1.0, -2.0), (0.1, 0.0, 1.0)],
}


def velocities(d: int, least: float = 0.0, most: float = np.inf) -> Iterator[Floats]:
    """Velocities of every size in a few directions."""
    for n in _DIRECTIONS[d]:
        yield from (speed * np.array(n) for speed in SPEEDS if speed and least < speed < most)


def random_state(law: FrictionLaw, d: int) -> Floats:
    """Small states, no two alike."""
    n = law.n_states(d)
    return np.asarray(1e-6 * np.cos(1.0 + 2.0 * np.arange(n)), dtype=float)
