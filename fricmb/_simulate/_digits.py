"""Whether the digits of positions resolve the forces of stiff springs: what no step can mend."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from fricmb._simulate._closes import FIXED
from fricmb._simulate._joined import runs_of
from fricmb.integrate import Trajectory
from fricmb.integrate.event_kinds import EVENT_SLIP, IS_TRANSITION
from fricmb.integrate.problem import Floats, Problem

#: Relative round-off of a number.
EPS = float(np.finfo(float).eps)


def digit_notes(trajectory: Trajectory, rtol: float | None) -> tuple[str, ...]:
    """Sentences for ``stats.notes`` where round-off of positions is a force that matters to contacts that let go.

    A spring K between positions q gives forces in steps of K times the last digit of q.  A contact lets go when the
    force that it holds reaches its limit, so the time of that is no better known than that force.
    """
    least = FIXED if rtol is None else rtol
    asked = "" if rtol is None else f" (rtol = {rtol:g} is not reached)"
    return tuple(
        f"round-off of positions times the stiffest springs is {part:.1e} of the friction limit of contact {name!r}:"
        f" the time at which it lets go, and all that follows, is no more exact{asked}"
        for run in runs_of(trajectory)
        for name, part in _unresolved(run, least)
    )


def _unresolved(run: Trajectory, least: float) -> Iterator[tuple[str, float]]:
    """Contacts whose forces are resolved to a part of their limit above ``least``, and that part."""
    problem = run.problem
    if problem.mechanism is not None or problem.n_c == 0:
        return
    seen = run.row_motion()
    noise = force_grain(problem, np.abs(seen.q).max(axis=1, initial=0.0))
    contacts = problem.contacts
    for k in _held_before(run):
        rows = slice(contacts.row[k], contacts.row[k + 1])
        # what it held when it let go, whatever its law says of that
        limit = float(np.linalg.norm(seen.F[rows], axis=0).max(initial=0.0))
        grain = float(noise[rows].max())
        if grain > least * limit > 0.0:
            yield problem.contact_names[k], grain / limit


def _held_before(run: Trajectory) -> set[int]:
    """Contacts that let go after they have been held for a time."""
    events, least = run.transitions, 1e-6 * float(np.ptp(run.ends))
    since, found = np.full(run.problem.n_c, run.ends[0]), set()
    for t, k, kind in zip(events.t, events.contact, events.kind, strict=True):
        if kind == EVENT_SLIP and t - since[k] > least:
            found.add(int(k))
        if IS_TRANSITION[kind]:
            since[k] = t
    return found


def force_grain(problem: Problem, q: Floats) -> Floats:
    """Round-off on the rows of contacts (m,) of the forces of springs, at positions as large as q (n,)."""
    n = problem.n
    K = problem.linear.csr("Kx").block(slice(0, n), slice(0, n))
    on_dofs = EPS * (replace(K, value=np.abs(K.value)) @ q)
    W = problem.contacts.csr("W")
    return np.bincount(W.index, np.abs(W.value) * on_dofs[W.rows], problem.m).astype(float)
