"""The variational equations over the stretches of a run: maps of steps that are fine enough."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.integrate.problem import Floats, Ints
from fricmb.sensitivity._collocation import Formula, radau, step_maps
from fricmb.sensitivity._equations import Equations
from fricmb.sensitivity._phases import Phases

#: Stages of the steps, and of the formula that tells how fine they are.
STAGES, COARSE = 5, 3
#: Rounds of dividing steps, into so many parts at most; numbers that are held at once.
_ROUNDS, _PARTS, _HELD = 60, 8, 4_000_000


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
        ends = np.nextafter(self.phases.t[phase + 1], -np.inf)
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
    edges = stepper.phases.t
    t, h, phase = edges[:-1], np.diff(edges), np.arange(edges.size - 1)
    kept: list[tuple[Floats, Floats, Ints, Floats]] = []
    for last in [False] * _ROUNDS + [True]:
        if not t.size:
            break
        maps = stepper.maps(fine, t, h, phase)
        off = _difference(stepper.maps(coarse, t, h, phase) - maps, maps, scale, stepper.equations.n_y)
        bad = (off > limit) & (h > 1e-13 * np.abs(edges[-1] - edges[0])) & (not last)
        kept.append((t[~bad], h[~bad], phase[~bad], maps[~bad]))
        parts = np.clip(np.ceil((off[bad] / limit) ** (1.0 / (coarse.order + 1)) * 1.1), 2, _PARTS).astype(np.int64)
        first = np.repeat(np.cumsum(parts) - parts, parts)
        inside = np.arange(parts.sum()) - first
        h, phase = np.repeat(h[bad] / parts, parts), np.repeat(phase[bad], parts)
        t = np.repeat(t[bad], parts) + inside * h
    t, h, phase, maps = (np.concatenate([part[i] for part in kept]) for i in range(4))
    order = np.argsort(t, kind="stable")
    return Mesh(t=t[order], h=h[order], phase=phase[order], maps=maps[order])


def _difference(off: Floats, maps: Floats, scale: Floats, n_y: int) -> Floats:
    """Differences of maps (n_t,) relative to the sizes of states, of parameters to the largest of their column."""
    state = np.abs(off[..., :n_y]) * scale / scale[:, None]
    given, own = np.abs(off[..., n_y:]) / scale[:, None], np.abs(maps[..., n_y:]) / scale[:, None]
    largest = own.max(axis=(0, 1), initial=0.0) + 1e-300
    found: Floats = np.nan_to_num(
        np.maximum(state.max(axis=(1, 2)), (given / largest).max(axis=(1, 2), initial=0.0)), nan=np.inf
    )
    return found
