"""Energies of a run: powers integrated over its dense output, as finely as they ask for.

A step integrates powers at its stages, and is chosen by the motion alone: where a drive prescribes that, or loads
hardly move a heavy body, steps are long and powers in them are anything.  What a step says is taken where another rule
says the same.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricmb.integrate.problem import Floats, Ints

#: Powers (n_t, w) at times (n_t,) within steps (n_t,).
Powers = Callable[[Floats, Ints], Floats]
#: Nodes of Gauss's rule in an interval, and halvings of one at most.
NODES, HALVINGS = 4, 8
#: Part of rtol, and of the largest energy that is exchanged, to which an interval is known.
PART = 1e-2
#: Round-off of an energy, relative to the kinetic energy.
ROUND_OFF = 1e-16


def integrate_powers(
    powers: Powers, start: Floats, end: Floats, step: Ints, guess: Floats, rtol: float, scale: Floats
) -> Floats:
    """Integrals (k, w) over intervals, each within one step.

    Parameters
    ----------
    start, end : (k,)
    step : (k,) int
    guess : (k, w)
        What the steps themselves say; kept where a finer rule agrees.
    rtol : float
    scale : (w,)
        Size of each energy in the whole run.
    """
    total = guess.copy()
    # intervals that are still in doubt: which one they are a part of, their ends and their integrals
    part, low, high, value = np.arange(len(start)), start, end, guess
    allowed = PART * rtol * scale + 1e-300
    for level in range(HALVINGS):
        if not part.size:
            break
        # what a step says of itself is compared with one rule, afterwards that with its halves
        middle = 0.5 * (low + high)
        cuts = [(low, high)] if level == 0 else [(low, middle), (middle, high)]
        halves = [_gauss(powers, a, b, step[part]) for a, b in cuts]
        found = np.sum(halves, axis=0)
        sound = np.isfinite(found).all(axis=1)
        np.add.at(total, part[sound], (found - value)[sound])
        open_ = sound & (np.abs(found - value) > allowed * 2.0 ** (-0.5 * level)).any(axis=1)
        if level == 0:
            part, low, high, value = part[open_], low[open_], high[open_], found[open_]
            continue
        part = np.concatenate([part[open_], part[open_]])
        low, high = np.concatenate([low[open_], middle[open_]]), np.concatenate([middle[open_], high[open_]])
        value = np.concatenate([half[open_] for half in halves])
    return total


def scale_of(said: Floats, moved: float, rtol: float) -> Floats:
    """Size of each energy in a run (w,), from what its steps say (k, w).

    What is below the round-off of the kinetic energy, ``moved``, is none: a body that turns freely exchanges nothing
    else, and would be looked at ever more finely.
    """
    found: Floats = np.maximum(np.abs(said).sum(axis=0), ROUND_OFF * moved / (PART * rtol))
    return found


def _gauss(powers: Powers, low: Floats, high: Floats, step: Ints) -> Floats:
    """Gauss's rule on each interval (k, w)."""
    x, weight = np.polynomial.legendre.leggauss(NODES)
    half = 0.5 * (high - low)
    times = (low + half)[:, None] + half[:, None] * x
    found = powers(times.ravel(), np.repeat(step, NODES)).reshape(len(low), NODES, -1)
    integral: Floats = half[:, None] * np.einsum("j,kjw->kw", weight, found)
    return integral


def integrate_between(
    powers: Powers, t: Floats, step: Ints, said: Floats, begin: Floats, at_begin: Floats, rtol: float, scale: Floats
) -> Floats:
    """Integrals (n_t, w) from the beginning of each time's step, one after the other within a step.

    ``said`` (n_t, w): what the steps say at the times, ``at_begin`` (n_t, w) where they begin, at ``begin`` (n_t,).
    """
    order = np.lexsort((t, step))
    t, step, said = t[order], step[order], said[order]
    fresh = np.diff(step, prepend=-1) != 0
    before = np.where(fresh, begin[order], np.roll(t, 1))
    since = np.where(fresh[:, None], at_begin[order], np.roll(said, 1, axis=0))
    parts = integrate_powers(powers, before, np.maximum(t, before), step, said - since, rtol, scale)
    sums = np.cumsum(parts, axis=0)
    first = np.maximum.accumulate(np.where(fresh, np.arange(t.size), 0))
    found = np.empty_like(sums)
    found[order] = sums - (sums - parts)[first]
    return found
