"""The variational equations over the stretches of a run: maps of steps that are fine enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import SLIP, Floats, Ints
from fricmb.sensitivity._collocation import Formula, radau, step_maps
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._phases import BESIDE, Phases

#: Stages of the steps, and of the formula that tells how fine they are.
STAGES, COARSE = 5, 3
#: Rounds of dividing steps, into so many parts at most; numbers that are held at once.
_ROUNDS, _PARTS, _HELD = 16, 8, 4_000_000
#: A step is divided on while its error falls by this factor each time.
_FALLS = 0.5
#: Slip begins or ends where its speed is below this share of that in the middle of a step; of the time that it lasts,
#: the first step after its begin and what is left out before its end.
_TINY, _FIRST, _LAST = 1e-4, 1e-5, 1e-6


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """Steps in time order: begins, lengths, stretches they lie in, and maps (n_t, n_y, n_y + n_p)."""

    t: Floats
    h: Floats
    phase: Ints
    maps: Floats


class Stepper:
    """Maps of steps of the variational equations.

    Parameters
    ----------
    equations : Equations
    phases : Phases
    sample : callable
        Dense output of the run.
    """

    def __init__(self, equations: Equations, phases: Phases, sample: Any) -> None:
        self.equations, self.phases, self.sample = equations, phases, sample

    def maps(self, formula: Formula, t: Floats, h: Floats, phase: Ints) -> Floats:
        """Maps of steps from t (n_t,) on, each within one stretch."""
        e, s = self.equations, formula.c.size
        room = max(1, _HELD // (s * e.n_y * (e.columns + s * e.n_y)))
        parts = [slice(i, i + room) for i in range(0, t.size, room)]
        found = [self._some(formula, t[own], h[own], phase[own]) for own in parts]
        return np.concatenate(found) if found else np.zeros((0, e.n_y, e.columns - 1))

    def _some(self, formula: Formula, t: Floats, h: Floats, phase: Ints) -> Floats:
        e, s = self.equations, formula.c.size
        # where a function of time jumps, the end of a stretch has not seen it yet
        ends = self.phases.t[phase + 1]
        ends = ends - BESIDE * np.maximum(1.0, np.abs(ends))
        times = np.minimum(t[:, None] + h[:, None] * formula.c, np.maximum(ends, t)[:, None]).ravel()
        at = np.repeat(phase, s)
        field = e.field(self.sample(times), self.phases.mode[:, at], self.phases.sign[:, at])
        slopes = field.a_slopes[..., :-1].reshape(t.size, s, e.n, e.columns - 1)
        rates = field.rate_slopes[..., :-1].reshape(t.size, s, e.n_z, e.columns - 1)
        return step_maps(formula, h, slopes, rates, e.n, e.n_y)


def mesh_of(stepper: Stepper, scale: Floats, rtol: float) -> Mesh:
    """Steps over all stretches, divided until an estimate of their error is within the tolerance.

    The error of the formula of 3 stages tells the size of h over the time scale; that of 5 stages follows from it.
    """
    fine, coarse = radau(STAGES), radau(COARSE)
    limit = coarse.error * (0.1 * max(rtol, 1e-13) / fine.error) ** ((coarse.order + 1) / (fine.order + 1))
    t, h, phase = graded(stepper)
    kept: list[tuple[Floats, Floats, Ints, Floats]] = []
    before = np.full(t.size, np.inf)
    for last in [False] * _ROUNDS + [True]:
        if not t.size:
            break
        maps = stepper.maps(fine, t, h, phase)
        off = _difference(stepper.maps(coarse, t, h, phase) - maps, maps, scale, stepper.equations.n_y)
        # what does not fall when steps are divided is round-off of the dense output, which no mesh removes
        bad = (off > limit) & (off < _FALLS * before) & (not last)
        kept.append((t[~bad], h[~bad], phase[~bad], maps[~bad]))
        parts = np.clip(np.ceil((off[bad] / limit) ** (1.0 / (coarse.order + 1)) * 1.1), 2, _PARTS).astype(np.int64)
        first = np.repeat(np.cumsum(parts) - parts, parts)
        inside = np.arange(parts.sum()) - first
        before = np.repeat(np.where(np.isfinite(before[bad]) | (off[bad] < 1.0), off[bad], np.inf), parts)
        h, phase = np.repeat(h[bad] / parts, parts), np.repeat(phase[bad], parts)
        t = np.repeat(t[bad], parts) + inside * h
    t, h, phase, maps = (np.concatenate([part[i] for part in kept]) for i in range(4))
    order = np.argsort(t, kind="stable")
    return Mesh(t=t[order], h=h[order], phase=phase[order], maps=maps[order])


def graded(stepper: Stepper) -> tuple[Floats, Floats, Ints]:
    """Begins, lengths and stretches of the first steps.

    Where slip in two directions begins or ends its direction turns ever faster towards r = 0: steps there grow, or
    fall, by halves; the last before a landing is left out, what sticks being projected (:mod:`._transitions`).
    """
    edges = stepper.phases.t
    begins, ends = _halvings(stepper)
    t, h, phase = [], [], []
    for k in range(edges.size - 1):
        knots = edges[k : k + 2]
        if begins[k]:
            knots = np.concatenate([knots[:1], knots[0] + np.diff(knots) * 0.5 ** np.arange(begins[k], -1, -1)])
        if ends[k]:
            rest = knots[-2:]
            knots = np.concatenate([knots[:-2], rest[1] - np.diff(rest) * 0.5 ** np.arange(ends[k] + 1)])
        t.append(knots[:-1])
        h.append(np.diff(knots))
        phase.append(np.full(knots.size - 1, k))
    return np.concatenate(t), np.concatenate(h), np.concatenate(phase).astype(np.int64)


def _halvings(stepper: Stepper) -> tuple[Ints, Ints]:
    """Halvings at the begin and at the end of each stretch where slip in two directions begins or ends."""
    phases, e = stepper.phases, stepper.equations
    h = np.diff(phases.t)
    begins, ends = np.zeros(h.size, dtype=np.int64), np.zeros(h.size, dtype=np.int64)
    wide = [k for k, contact in e.contacts.items() if contact.d > 1 and not contact.smooth]
    if not wide:
        return begins, ends
    g = stepper.sample(np.concatenate([phases.t[:-1] + c * h for c in (0.0, 0.5, 1.0)])).g
    for k in wide:
        r = np.linalg.norm(g[e.rows(k)], axis=0).reshape(3, -1)
        slips = phases.mode[k] == SLIP
        lasts = _lasting(phases.t, phases.mode[k])
        count = [np.ceil(np.log2(np.maximum(h / (share * lasts), 2.0))).astype(np.int64) for share in (_FIRST, _LAST)]
        begins = np.where(slips & (r[0] <= _TINY * r[1]), np.maximum(begins, count[0]), begins)
        ends = np.where(slips & (r[2] <= _TINY * r[1]), np.maximum(ends, count[1]), ends)
    return begins, ends


def _lasting(t: Floats, mode: Any) -> Floats:
    """Of each stretch the time that the mode in it lasts."""
    first = np.flatnonzero(np.concatenate([[True], mode[1:] != mode[:-1]]))
    lengths = np.diff(np.append(t[first], t[-1]))
    found: Floats = np.repeat(lengths, np.diff(np.append(first, mode.size)))
    return found


def _difference(off: Floats, maps: Floats, scale: Floats, n_y: int) -> Floats:
    """Differences of maps (n_t,) relative to the sizes of states, of parameters to the largest of their column."""
    state = np.abs(off[..., :n_y]) * scale / scale[:, None]
    given, own = np.abs(off[..., n_y:]) / scale[:, None], np.abs(maps[..., n_y:]) / scale[:, None]
    largest = own.max(axis=(0, 1), initial=0.0) + 1e-300
    found: Floats = np.nan_to_num(
        np.maximum(state.max(axis=(1, 2)), (given / largest).max(axis=(1, 2), initial=0.0)), nan=np.inf
    )
    return found
