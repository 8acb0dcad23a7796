"""Rules of laws with internal states."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fricmb.analysis import cycle, settling_distance
from fricmb.laws import FrictionLaw
from fricmb.testing._base import Rule
from fricmb.testing._trial import AT_REST, random_state, velocities


def _rates(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    for d in law.dimensions:
        state = random_state(law, d)
        for v in [np.zeros(d), *velocities(d)]:
            rate = np.asarray(law.rate(v, normal_force, state))
            if not np.isfinite(rate).all():
                yield f"rate at v = {v.tolist()} is {rate.tolist()}"
        rest = np.asarray(law.rate(np.zeros(d), normal_force, state))
        if law.rests and (np.abs(rest) > AT_REST).any():
            yield f"states move at rest: rate {rest.tolist()}"


#: Amplitudes of the cycles, as shares and multiples of the distance over which states settle.
_AMPLITUDES = (0.3, 3.0, 30.0)


def _cycles(law: FrictionLaw, normal_force: float) -> Iterator[str]:
    """Work over a closed cycle, when states have come to repeat: friction takes it, or at least gives none."""
    length = settling_distance(law, normal_force)
    for share in _AMPLITUDES:
        loop = cycle(law, amplitude=share * length, period=2e3 * np.pi * share * length, normal_force=normal_force)
        if not np.isfinite(loop.force).all():
            yield f"force over a cycle of amplitude {share * length:g} is not finite"
        elif loop.work > 1e-6 * loop.amplitude * np.abs(loop.force).max():
            yield f"a cycle of amplitude {share * length:g} gains the work {loop.work:g}"


STATE_RULES: tuple[Rule, ...] = (_rates, _cycles)
