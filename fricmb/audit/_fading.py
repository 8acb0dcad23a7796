"""What an error of a law's states makes of its force: nothing, where the state fades before the force asks for it.

Out of its band a law may drop what it has wound up (Karnopp's hold in fast slip, Gonthier's bristle): force then
does not look at the state, and steps, which are controlled by the force, pass over how the state fades.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._units import Units
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Samples

#: Steps through which an error is followed, and times within each; at most so many errors.
_STEPS, _WITHIN, _ERRORS = 60, 3, 200
#: An error is gone at this share of its own size, or of its unit.
_GONE = 1e-3


class Fading:
    """Errors of states, followed through the steps after them by the law's own rate."""

    def __init__(self, statements: Statements, units: Units, rows: Samples, sample: Any) -> None:
        self.statements, self.units, self.rows, self.sample = statements, units, rows, sample

    def forces(self, k: int, ratio: Floats, off: Floats, unit: Floats, t: Floats, bar: float) -> Floats:
        """Residuals of the states (n_t,) of contact k over their units, those above ``bar`` by the force they make.

        ``off`` (nz, n_t): the states' residuals; ``unit`` (nz, n_t); ``t``: where they are made.  An error that
        does not fade within the steps that are looked at keeps the size that it has as a state.
        """
        bad = np.flatnonzero(ratio > bar)
        if not bad.size or bad.size > _ERRORS:
            return ratio
        found = ratio.copy()
        made, gone = self._followed(k, off[:, bad], unit[:, bad], t[bad])
        found[bad] = np.where(gone, np.minimum(made, ratio[bad]), ratio[bad])
        return found

    def _followed(self, k: int, off: Floats, unit: Floats, t: Floats) -> tuple[Floats, Any]:
        """Largest force over its unit (n,) that errors (nz, n) at times t make later, and whether they are gone."""
        times = np.array([self._times(start) for start in t]).T
        law, own = self.statements.contacts[k], slice(*self.statements.names.row[k : k + 2])
        least = float(self.units.F[own].max(initial=0.0)) + 1e-300
        moment = self.statements.moment(self.sample(times.ravel()))
        said = self.statements.found(moment)
        shape = times.shape
        g, N = said.g[k].reshape(-1, *shape), said.N[k].reshape(shape)
        z = self.statements.states(moment, k).reshape(-1, *shape)
        left, made, least_left = off.copy(), np.zeros(t.size), np.maximum(_GONE * np.abs(off), unit)
        for j in range(shape[0]):
            here, load, held = g[:, j], N[j], z[:, j]
            force = law.force(here, load, held) - law.force(here, load, held - left)
            made = np.maximum(made, np.abs(force).max(axis=0) / least)
            if j + 1 < shape[0] and not (np.abs(left) <= least_left).all():
                slope = law.rate(here, load, held) - law.rate(here, load, held - left)
                slope = np.divide(slope, left, out=np.zeros_like(left), where=left != 0.0)
                left = left * np.exp(np.minimum(slope * (times[j + 1] - times[j]), 1.0))
            else:
                break
        return made, (np.abs(left) <= least_left).all(axis=0)

    def _times(self, start: float) -> Floats:
        """Times from ``start`` on, some in each of the steps that follow."""
        rows = self.rows.t
        first = int(np.searchsorted(rows, start, side="right"))
        knots = np.concatenate([[start], rows[first : first + _STEPS]])
        knots = np.concatenate([knots, np.full(_STEPS + 1 - knots.size, knots[-1])])
        parts = knots[:-1, None] + np.diff(knots)[:, None] * np.arange(_WITHIN) / _WITHIN
        found: Floats = np.append(parts.ravel(), knots[-1])
        return found
