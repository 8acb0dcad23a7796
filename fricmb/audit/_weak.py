"""The equations of motion, of states and of losses in integrated form, over parts of steps.

What a value changes by from one time to another is compared with the integral of its rate, as the scene's equations say
it.  The dense output is one order lower than the steps in many methods, its derivative two: a residual of accelerations
would judge the polynomial, not the run.  The integral asks no derivative.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fricmb.audit._fading import Fading
from fricmb.audit._gather import LIMITS
from fricmb.audit._units import Units
from fricmb.field._statements import Statements
from fricmb.integrate.problem import Floats
from fricmb.integrate.trajectory import Samples

#: Gauss and Kronrod's rule of 7 and 15 nodes on -1 to 1: nodes from 0 on, weights of both.
_HALF = np.array([
    0.0, 0.207784955007898467600689403773245, 0.405845151377397166906606412076961, 0.586087235467691130294144691693,
    0.741531185599394439863864773280788, 0.864864423359769072789712788640926, 0.949107912342758524526189684047851,
    0.991455371120812639206854697526329,
])  # fmt: skip
_HALF_15 = np.array([
    0.209482141084727828012999174891714, 0.204432940075298892414161999234649, 0.190350578064785409913256402421014,
    0.169004726639267902826583426598550, 0.140653259715525918745189590510238, 0.104790010322250183839876322541518,
    0.063092092629978553290700663189204, 0.022935322010529224963732008058970,
])  # fmt: skip
_HALF_7 = np.array([
    0.417959183673469387755102040816327, 0.0, 0.381830050505118944950369775488975, 0.0,
    0.279705391489276667901467771423780, 0.0, 0.129484966168869693270611432679082, 0.0,
])  # fmt: skip
NODES = np.concatenate([-_HALF[:0:-1], _HALF])
_WEIGHTS = np.concatenate([_HALF_15[:0:-1], _HALF_15])
_COARSE = np.concatenate([_HALF_7[:0:-1], _HALF_7])
#: Rounds of cutting stretches in two where the rule is not sure, and how many stretches are cut at most in one.
_ROUNDS, _MOST = 8, 600


@dataclass(frozen=True, kw_only=True)
class Residual:
    """Residuals over their units (n_rows, n_stretches), the time of each stretch, and what each row belongs to."""

    ratio: Floats
    t: Floats
    parts: list[str]


class Weak:
    """What the run says and what the equations say, row by row: momentum, position, states, losses."""

    def __init__(self, statements: Statements, units: Units, sample: Any) -> None:
        self.statements, self.units, self.sample = statements, units, sample
        names = statements.names
        self.contacts = list(statements.contacts)
        self.stateful = [k for k in self.contacts if statements.contacts[k].law.states]
        states = [(k, i) for k in self.stateful for i in range(int(names.z_start[k]), int(names.z_start[k + 1]))]
        self.z_rows = np.array([i for _, i in states], dtype=np.int64)
        n = len(names.dofs)
        self.groups = {
            "equations of motion": (slice(0, n), list(names.dofs)),
            "velocity and position": (slice(n, 2 * n), list(names.dofs)),
            "states of laws": (slice(2 * n, 2 * n + len(states)), [names.contacts[k] for k, _ in states]),
            "friction losses": (
                slice(2 * n + len(states), 2 * n + len(states) + len(self.contacts)),
                [names.contacts[k] for k in self.contacts],
            ),
        }
        self.unit = self._unit()

    def _unit(self) -> Floats:
        u, s = self.units, self.statements
        momentum = s.weight * u.v
        for rows, M in s.mass_matrices:
            momentum[rows] += abs(M) @ u.v[rows]
        return np.concatenate([momentum, u.q, u.z[self.z_rows], u.loss[self.contacts]])

    def values(self, samples: Samples) -> Floats:
        """What the run says (n_rows, n_t)."""
        loss = samples.friction_loss[self.contacts]
        return np.concatenate([self.statements.momentum(samples.v), samples.q, samples.z[self.z_rows], loss])

    def _rates(self, moment: Any, base: Any = None) -> tuple[Floats, Floats]:
        """Rates (n_rows, n_t), and what the laws make of the moment; ``base``: that of the moment it was moved from.

        Friction is that of the run; in a moved moment it moves by what the laws make of the difference.
        """
        s = self.statements
        found = s.found(moment)
        said = s.said(moment, found)
        if base is not None:
            moment = replace(moment, F=moment.F + np.where(np.isfinite(said - base), said - base, 0.0))
            for k, rows in found.rows.items():
                own = slice(int(s.names.row[k]), int(s.names.row[k + 1]))
                for row, extra in zip(rows, (said - base)[own], strict=True):
                    found.push(row, extra)
        shape = (1, moment.t.size)
        rates = [np.broadcast_to(found.rate[k], (len(s.states(moment, k)), shape[1])) for k in self.stateful]
        power = [-(s.whole_forces(moment, found, k) * found.g[k]).sum(axis=0, keepdims=True) for k in self.contacts]
        return np.concatenate([found.force, moment.v, *rates, *power]), said

    def _integrals(self, a: Floats, b: Floats, rng: np.random.Generator | None) -> tuple[Floats, Floats, Floats]:
        """Integrals of the rates over stretches, how sure they are, and what the tolerance makes of them."""
        half = 0.5 * (b - a)
        t = (a + half)[:, None] + half[:, None] * NODES
        moment = self.statements.moment(self.sample(t.ravel()))
        rates, said = self._rates(moment)
        shape = (len(rates), len(a), len(NODES))
        whole = half * (rates.reshape(shape) @ _WEIGHTS)
        unsure = np.abs(whole - half * (rates.reshape(shape) @ _COARSE))
        slack = np.zeros_like(whole)
        for _ in range(2 if rng is not None else 0):
            assert rng is not None
            moved = np.abs(self._rates(self.units.perturbed(moment, rng), said)[0] - rates)
            slack = np.maximum(slack, half * (moved.reshape(shape) @ _WEIGHTS))
        return whole, unsure, slack

    def residual(
        self, begin: Samples, end: Samples, rng: np.random.Generator, extra: Any = 0.0
    ) -> tuple[Floats, Floats]:
        """Residuals, and what is allowed of them, (n_rows, n_stretches) of stretches between two sets of samples.

        ``extra``: what friction brings within stretches of which the dense output does not tell when it jumps.
        """
        a, b = begin.t, end.t
        change = self.values(end) - self.values(begin)
        size = np.abs(self.values(begin)) + np.abs(self.values(end))
        if self.statements.joints:  # what returns to constraints has the round-off of all that they tie together
            n = begin.q.shape[0]
            places = slice(n, 2 * n)
            size[places] = size[places].max(axis=0, initial=0.0)
            size[:n] = size[:n].max(axis=0, initial=0.0) + (b - a) * self._reaction(begin, end)
        whole, unsure, slack = self._integrals(a, b, rng)
        allowed = 2.0 * self.unit[:, None] + slack + 1e-15 * size + extra + 1e-300
        bad = np.flatnonzero(((np.abs(change - whole) > allowed) & (unsure > 0.1 * allowed)).any(axis=0))
        if bad.size:
            worst = np.argsort(-(np.abs(change - whole) / allowed)[:, bad].max(axis=0))[:_MOST]
            bad = bad[worst]
            whole[:, bad], unsure[:, bad] = self._finer(a[bad], b[bad], allowed[:, bad])
            allowed[:, bad] += unsure[:, bad]
        return change - whole, allowed

    def _reaction(self, *samples: Samples) -> Floats:
        """Largest reaction (n_stretches,): its round-off is in all equations that joints tie together."""
        held = (rows for given in samples for rows in self.statements.moment(given).lam.values())
        found: Floats = np.max([np.abs(rows).max(axis=0, initial=0.0) for rows in held], axis=0)
        return found

    def judged(self, difference: Floats, allowed: Floats, t: Floats, fading: Fading) -> Floats:
        """Residuals over what is allowed; those of states that fade, made at times t, by the force they make."""
        ratio = np.abs(difference) / allowed
        at = self.groups["states of laws"][0].start
        for k in self.stateful:
            own = slice(at, at + len(self.statements.states_of(k)))
            worst = ratio[own].max(axis=0)
            by_force = fading.forces(k, worst, difference[own], allowed[own], t, LIMITS["states of laws"])
            ratio[own] *= np.divide(by_force, worst, out=np.ones_like(worst), where=worst > 0.0)
            at = own.stop
        return ratio

    def _finer(self, a: Floats, b: Floats, allowed: Floats) -> tuple[Floats, Floats]:
        """Integrals over stretches that are cut in two where the rule is not sure."""
        total, doubt = np.zeros_like(allowed), np.zeros_like(allowed)
        owner, low, high = np.arange(a.size), a, b
        for last in [False] * _ROUNDS + [True]:
            whole, unsure, _ = self._integrals(low, high, None)
            share = 0.02 * allowed[:, owner]
            cut: Any = np.zeros(low.size, dtype=bool) if last else (unsure > share).any(axis=0)
            if cut.sum() > _MOST:
                cut[np.flatnonzero(cut)[_MOST:]] = False
            keep = ~cut
            np.add.at(total.T, owner[keep], whole[:, keep].T)
            np.add.at(doubt.T, owner[keep], unsure[:, keep].T)
            if not cut.any():
                break
            middle = 0.5 * (low[cut] + high[cut])
            low, high, owner = (
                np.concatenate([low[cut], middle]),
                np.concatenate([middle, high[cut]]),
                np.tile(owner[cut], 2),
            )
        return total, doubt
