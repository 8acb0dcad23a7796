"""Times at which the rows of several runs stand as those of one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Stretches
from fricmb.solution import Flags

#: Most numbers that the rows of a joined run may hold: accepted steps of many islands are thinned beyond.
MOST = 20_000_000


def common_times(
    times: Sequence[Floats], t_end: float, width: int, hidden: Sequence[Stretches] = ()
) -> tuple[Floats, bool]:
    """Times of all runs, rising, one that is several times in a run (a transition) as often; whether thinned.

    Thinned are the times that occur once, so that rows of ``width`` numbers stay within MOST.  None is within one of
    the ``hidden`` stretches, but for the ends of the run.
    """
    every: Floats = np.unique(np.concatenate([*times, [t_end]]))
    often = np.ones(every.size, dtype=np.int64)
    for t in times:
        here, count = np.unique(t, return_counts=True)
        place = np.searchsorted(every, here)
        often[place] = np.maximum(often[place], count)
    inside = (every <= t_end) & ~_within(every, hidden)
    inside[0] = True
    inside |= every == t_end
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


def _within(t: Floats, stretches: Sequence[Stretches]) -> Flags:
    """Which of the times are inside of a stretch; those of one run do not overlap."""
    found = np.zeros(t.size, dtype=np.bool_)
    for begin, end in stretches:
        if begin.size:
            k = np.searchsorted(begin, t, side="left") - 1  # the last that begins before it
            found |= (k >= 0) & (t < end[k])
    return found
