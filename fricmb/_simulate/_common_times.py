"""Times at which the rows of several runs stand as those of one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.integrate.problem import Floats

#: Most numbers that the rows of a joined run may hold: accepted steps of many islands are thinned beyond.
MOST = 20_000_000


def common_times(times: Sequence[Floats], t_end: float, width: int) -> tuple[Floats, bool]:
    """Times of all runs, rising, one that is several times in a run (a transition) as often; whether thinned.

    Thinned are the times that occur once, so that rows of ``width`` numbers stay within MOST.
    """
    every: Floats = np.unique(np.concatenate([*times, [t_end]]))
    often = np.ones(every.size, dtype=np.int64)
    for t in times:
        here, count = np.unique(t, return_counts=True)
        place = np.searchsorted(every, here)
        often[place] = np.maximum(often[place], count)
    inside = every <= t_end
    every, often = every[inside], often[inside]
    most = MOST // width
    thinned = bool(often.sum() > most)
    if thinned:
        keep = often > 1
        keep[[0, -1]] = True
        once = np.flatnonzero(~keep)
        left = max(most - int(often[keep].sum()), 100)
        keep[once[np.unique(np.linspace(0, once.size - 1, min(left, once.size)).astype(np.int64))]] = True
        every, often = every[keep], often[keep]
    return np.repeat(every, often), thinned
