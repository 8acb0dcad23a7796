"""What steps over transitions may have got wrong without their estimate knowing: notes for the user."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Problem
from fricmb.integrate.trajectory import Transitions

#: Steps below which a rest or a slip may be none: of the scenes from seeds whose transitions were wrong, four in five
#: had one as short, of the others one in ten.
SHORT = 3.0


def short_phases(problem: Problem, t: Floats, transitions: Transitions) -> tuple[str, ...]:
    """A note where a contact changes its mode again within so few steps, which end at ``t``, that it may not have."""
    t = np.unique(t)
    h = np.diff(t)
    order = np.lexsort((transitions.t, transitions.contact))
    at, contact = transitions.t[order], transitions.contact[order]
    step = np.clip(np.searchsorted(t, at) - 1, 0, max(len(h) - 1, 0))
    if len(at) < 2 or not len(h):
        return ()
    again = contact[1:] == contact[:-1]
    short = np.flatnonzero(again & (np.diff(at) < SHORT * np.maximum(h[step[1:]], h[step[:-1]])))
    if not short.size:
        return ()
    first = short[np.argmin(at[short])]
    more = f" (and {len(short) - 1} times more)" if len(short) > 1 else ""
    return (
        f"contact {problem.contact_names[contact[first]]!r} changes its mode at t = {at[first]:.6g} and again within"
        f" {SHORT:g} steps{more}: whether it does hangs on the steps (a smaller rtol or another method tells)",
    )


#: A velocity between rows that is off by more than this many times the tolerance is told.
TOLD = 100.0


def kinks(problem: Problem, chunks: list[dict[str, Any]], transitions: Transitions, rtol: float) -> tuple[str, ...]:
    """A note where velocities between rows, straight lines, miss a kink by far more than the tolerance.

    With slopes a and b before and after a transition at the share x of a step h, the line is off by |b - a| x (1 - x) h
    at most; a and b are those of the steps beside it.
    """
    if not (len(transitions.t) and rtol < np.inf):
        return ()
    rows = [chunk["row_v"] for chunk in chunks]
    largest = np.max([np.maximum(v.max(axis=0, initial=0.0), -v.min(axis=0, initial=0.0)) for v in rows], axis=0)
    worst, when, dof = 0.0, 0.0, 0
    for chunk in chunks:
        t, v = chunk["row_t"], chunk["row_v"]
        if len(t) < 4:
            continue
        at = transitions.t[(transitions.t > t[1]) & (transitions.t < t[-2])]
        i = np.searchsorted(t, at) - 1
        inside = (i > 0) & (i + 2 < len(t))
        at, i = at[inside], i[inside]
        h = np.diff(t)
        steady = (h[i - 1] > 0.0) & (h[i] > 0.0) & (h[i + 1] > 0.0)
        at, i = at[steady], i[steady]
        if not at.size:
            continue
        before, after = ((v[k + 1] - v[k]) / h[k][:, None] for k in (i - 1, i + 1))
        share = (at - t[i]) / h[i]
        off = np.abs(after - before) * (share * (1.0 - share) * h[i])[:, None]
        off = np.divide(off, largest, out=np.zeros_like(off), where=largest > 0.0)
        k, j = np.unravel_index(int(np.argmax(off)), off.shape)
        if off[k, j] > worst:
            worst, when, dof = float(off[k, j]), float(at[k]), int(j)
    if not worst > TOLD * rtol:
        return ()
    return (
        f"between rows velocities are straight lines: near the transition at t = {when:.6g} that of"
        f" {problem.dof_names[dof]} is off by up to {worst:.2g} of its largest (at rows it is not)",
    )
