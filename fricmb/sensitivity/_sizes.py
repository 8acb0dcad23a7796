"""Sizes of states: what errors of maps count by."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Samples

#: Speeds count from this share of what all energy of motion would bring about in a coordinate, states of a law from
#: this share of the largest of the same contact.
_SHARE = 1e-4


def sizes(samples: Samples, mass: Floats, counts: Sequence[int]) -> Floats:
    """Sizes of q, v and z (n_y,) in a run; ``mass`` (n,) of the coordinates, ``counts`` of states by contact.

    What hardly moves, or by round-off alone, has the speed that a hundred-millionth of the energy would give it, and
    the way that this is in the longest step: else its relative error would decide how fine steps are.
    """
    energy = float((mass[:, None] * samples.v**2).sum(axis=0).max(initial=0.0))
    least = _SHARE * np.sqrt(energy / mass)
    v = np.maximum(np.abs(samples.v).max(axis=1, initial=0.0), least)
    q = np.maximum(np.abs(samples.q).max(axis=1, initial=0.0), least * np.diff(samples.t).max(initial=0.0))
    z = np.abs(samples.z).max(axis=1, initial=0.0)
    for own in np.split(z, np.cumsum(counts)[:-1]):
        own[:] = np.maximum(own, _SHARE * own.max(initial=0.0))
    return np.concatenate([np.where(x > 0.0, x, x.max(initial=0.0) or 1.0) for x in (q, v, z)])
