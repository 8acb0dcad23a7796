"""Instants at which formulas of parts switch, or a slip speed passes a knot of a table: slopes bend, steps end."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._found import Found
from fricmb.sensitivity._functions import Function, conditions_seen
from fricmb.sensitivity._motions import Given
from fricmb.sensitivity._phases import Phases

#: Parts of a stretch in which passages are looked for; halvings of a part that has one; the share of a stretch, and
#: of the largest value of a condition, that counts as nothing.
_PARTS, _HALVINGS, _NOTHING, _ZERO = 4, 30, 1e-6, 1e-9


def bends_of(e: Equations, phases: Phases, sample: Any) -> Floats:
    """Times within the stretches of a run at which its formulas switch."""
    knots = {k: contact.law.numeric().knots() for k, contact in e.touching.items()}
    if not any(knots.values()) and not any(function.switches() for function in _functions(e)):
        return np.zeros(0)

    def conditions(t: Floats) -> Floats:
        seen = sample(t)
        at = phases.of(t)
        found = _evaluated(e, seen, phases.mode[:, at], phases.sign[:, at])
        found += [np.linalg.norm(seen.g[e.rows(k)], axis=0) - r for k, own in knots.items() for r in own if r > 0.0]
        return np.array([np.broadcast_to(x, t.shape) for x in found]).reshape(-1, t.size)

    return _apart(_passages(conditions, phases.t), phases.t)


def _functions(e: Equations) -> Iterator[Function]:
    """What parts state that does not belong to the linear ones."""
    for part in (*e.linear.rest, *e.touching.values()):
        for held in vars(part).values():
            if isinstance(held, Function):
                yield held
            elif isinstance(held, Given) and held.number is None:
                yield held.function


def _evaluated(e: Equations, samples: Any, mode: Any, sign: Floats) -> list[Any]:
    """Values of all conditions."""
    moment, found = e.moment(samples), Found(e.n, e.n_z, e.columns, samples.t.size)
    with conditions_seen() as seen:
        for part in e.linear.rest:
            part.add(moment, found)
        for k, contact in e.touching.items():
            contact.add(moment, found, mode[k], sign[e.rows(k)])
    return seen


def _passages(conditions: Callable[[Floats], Floats], ends: Floats) -> Floats:
    """Times of changes of sign, by bisection; values that are round-off of 0 have none."""
    t = np.append(ends[:-1, None] + np.diff(ends)[:, None] * np.arange(_PARTS) / _PARTS, ends[-1])
    values = np.nan_to_num(conditions(t))
    values[np.abs(values) <= _ZERO * np.abs(values).max(axis=1, initial=0.0)[:, None]] = 0.0
    which, at = np.nonzero(values[:, 1:] * values[:, :-1] < 0.0)
    low, high, began = t[at], t[at + 1], values[which, at] > 0.0
    for _ in range(_HALVINGS if at.size else 0):
        middle = 0.5 * (low + high)
        same = (conditions(middle)[which, np.arange(at.size)] > 0.0) == began
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    return np.unique(high)


def _apart(t: Floats, ends: Floats) -> Floats:
    """Those that are not at an end of a stretch, nor one of several at one time."""
    k = np.clip(np.searchsorted(ends, t, side="right") - 1, 0, ends.size - 2)
    little = _NOTHING * (ends[k + 1] - ends[k])
    inside = (t - ends[k] > little) & (ends[k + 1] - t > little)
    return t[inside & (np.diff(t, prepend=-np.inf) > little)]
