"""Instants at which formulas of parts switch, or a slip speed passes a knot of a table: slopes bend, steps end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.sensitivity._dual import Dual
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._functions import Function, conditions_seen
from fricmb.sensitivity._motions import Given
from fricmb.sensitivity._phases import BEFORE, Phases

#: Parts of a stretch in which passages are looked for; halvings of a part that has one, down to neighbouring numbers;
#: the share of the largest value of a condition that counts as nothing, and values that do not count for it.
_PARTS, _HALVINGS, _ZERO, _ENDLESS = 4, 60, 1e-9, 1e100

#: Conditions at times (n_t,): values with slopes, always in the same order.
Conditions = Callable[[Floats], list[Dual]]


@dataclass(frozen=True, kw_only=True)
class Bends:
    """Times (n,) at which the formulas of a run switch, and by which of the conditions (n,).

    Those that lie at the end of a stretch, to round-off, stand there.
    """

    t: Floats
    which: Ints
    conditions: Conditions


def bends_of(e: Equations, phases: Phases, sample: Any) -> Bends:
    """Where the formulas of a run switch."""
    knots = {k: contact.law.numeric().knots() for k, contact in e.contacts.items()}

    def conditions(t: Floats) -> list[Dual]:
        at = phases.of(t)
        with conditions_seen() as seen:
            found = e.said(sample(t), phases.mode[:, at], phases.sign[:, at])
        return seen + [Dual(value=_length(found.g[k]) - r) for k, own in knots.items() for r in own if r > 0.0]

    nothing = Bends(t=np.zeros(0), which=np.zeros(0, dtype=np.int64), conditions=conditions)
    if not any(knots.values()) and not any(function.switches() for function in _functions(e)):
        return nothing
    t, which = _passages(conditions, phases.t)
    t = _snapped(t, phases.t)
    kept = np.flatnonzero((np.diff(t, prepend=-np.inf) > _little(t)) & (t > phases.t[0]) & (t < phases.t[-1]))
    return Bends(t=t[kept], which=which[kept], conditions=conditions)


def _length(g: list[Dual]) -> Any:
    """The slip speed."""
    return np.sqrt(sum(np.square(x.value) for x in g))


def _functions(e: Equations) -> Iterator[Function]:
    """What parts state that does not belong to the linear ones."""
    for part in (*e.linear.rest, *e.contacts.values(), *e.joining()):
        for held in vars(part).values():
            if isinstance(held, Function):
                yield held
            elif isinstance(held, Given) and held.number is None:
                yield held.function


def _passages(conditions: Conditions, ends: Floats) -> tuple[Floats, Ints]:
    """Times of changes of sign in order, by bisection, and of which condition; values that are round-off have none.

    Steps that are rejected at a switch come to end beside it, so a value of 0 is passed over to the next one.  What is
    found is the first number behind the switch: a slope from the other side at one node of a step would count.
    """

    def valued(t: Floats) -> Floats:
        return np.array([np.broadcast_to(x.value, t.shape) for x in conditions(t)]).reshape(-1, t.size)

    t = np.append(ends[:-1, None] + np.diff(ends)[:, None] * np.arange(_PARTS) / _PARTS, ends[-1])
    low, high, which = _brackets(t, np.nan_to_num(valued(t)))
    if not which.size:
        return low, which
    began = valued(low)[which, np.arange(which.size)] > 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if ((middle <= low) | (middle >= high)).all():
            break
        same = (valued(middle)[which, np.arange(which.size)] > 0.0) == began
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    order = np.argsort(high, kind="stable")
    return high[order], which[order]


def _brackets(t: Floats, values: Floats) -> tuple[Floats, Floats, Ints]:
    """Neighbouring times at which values have opposite signs, and numbers of the conditions."""
    low, high, which = [np.zeros(0)], [np.zeros(0)], [np.zeros(0, dtype=np.int64)]
    for i, own in enumerate(values):
        size = np.abs(own).max(where=np.abs(own) < _ENDLESS, initial=0.0)
        seen = np.flatnonzero(np.abs(own) > _ZERO * size)
        changes = np.flatnonzero(np.diff(own[seen] > 0.0))
        low.append(t[seen[changes]])
        high.append(t[seen[changes + 1]])
        which.append(np.full(changes.size, i))
    return np.concatenate(low), np.concatenate(high), np.concatenate(which)


def _little(t: Floats) -> Floats:
    """Times that are nothing apart: slopes are evaluated ``BEFORE`` the end of a stretch."""
    return 0.5 * BEFORE * np.maximum(1.0, np.abs(t))


def _snapped(t: Floats, ends: Floats) -> Floats:
    """Times in order, at the ends of stretches where they are that near to them."""
    k = np.clip(np.searchsorted(ends, t), 1, ends.size - 1)
    nearest = np.where(t - ends[k - 1] < ends[k] - t, ends[k - 1], ends[k])
    return np.asarray(np.where(np.abs(t - nearest) <= _little(t), nearest, t))
