"""The equations of motion with contact modes held: y' = f(t, y), smooth where a run would change modes.

Many states at once, so that an orbit and its neighbours are integrated together.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fricmb.analysis._errors import Floats
from fricmb.analysis._forces import coefficient, normal_force, without_contacts
from fricmb.integrate import SLIP, STICK
from fricmb.integrate.model.table_values import evaluate
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Ints
from fricmb.system import System

#: Slip speed at which a law is asked for its limit at 0.
_BARELY = 1e-300


@dataclass(frozen=True, kw_only=True)
class Field:
    """The right-hand side of a system, y = (q, v, z), while the modes of its contacts are held; k states at once.

    A contact in one dimension that slips with the sign ``direction`` keeps that sign beyond the zero of its relative
    velocity: the field is smooth there, and a transition can be approached from either side.

    Attributes
    ----------
    system : System
    mode : (n_c,) int8
    direction : (m,)
        Sign of slip of the rows of contacts in one dimension; of no account for others.
    """

    system: System
    mode: Codes
    direction: Floats

    def __call__(self, t: Floats, y: Floats) -> Floats:
        """Rates (n_y, k) of states (n_y, k) at times (k,)."""
        return self.rate_and_force(t, y)[0]

    def rate_and_force(self, t: Floats, y: Floats) -> tuple[Floats, Floats]:
        """Rates of the states (n_y, k) and forces on the rows of the contacts (m, k)."""
        problem, n = self.system.problem, self.system.problem.n
        contacts = problem.contacts
        q, v, z = y[:n], y[n : 2 * n], y[2 * n :]
        u = self.system.signals(t)
        X, force, g = without_contacts(self.system, u, t, q, v)
        F, rate = np.zeros_like(g), np.zeros_like(z)
        for k in range(problem.n_c):
            N = normal_force(self.system, k, X)
            rows = slice(int(contacts.row[k]), int(contacts.row[k + 1]))
            states = slice(int(contacts.z_start[k]), int(contacts.z_start[k + 1]))
            F[rows], rate[states] = self._friction(k, g[rows], N, z[states])
            force += np.outer(contacts.Wn[:, k], N - contacts.N0[k])
        a = self._flexibility @ (force + contacts.W @ F)
        S = self._stuck
        if S.size:
            D, response = self._response
            F[S] = -D @ (contacts.W[:, S].T @ a - contacts.Wu[S] @ u[2])
            a += response @ F[S]
        return np.concatenate([v, a, rate]), F

    def slip(self, t: Floats, y: Floats) -> Floats:
        """Relative velocities (m, k)."""
        contacts, n = self.system.problem.contacts, self.system.problem.n
        u = self.system.signals(t)[1]
        return np.asarray(contacts.W.T @ y[n : 2 * n] - contacts.w[:, None] - contacts.Wu @ u)

    def turning(self, t: Floats, y: Floats) -> Floats:
        """Rates of the relative velocities (m, k)."""
        contacts, n = self.system.problem.contacts, self.system.problem.n
        rate = self(t, y)[n : 2 * n]
        return np.asarray(contacts.W.T @ rate - contacts.Wu @ self.system.signals(t)[2])

    def break_away(self, t: Floats, y: Floats, k: int) -> Floats:
        """Largest friction force (k,) that contact k holds in stick."""
        contacts, n = self.system.problem.contacts, self.system.problem.n
        u = self.system.signals(t)
        N = normal_force(self.system, k, np.concatenate([t[None], y[: 2 * n], u[0], u[1]]))
        if contacts.mu_s[k] >= 0.0:
            return np.asarray(contacts.mu_s[k] * N)
        return coefficient(self.system, k, np.full_like(N, _BARELY), N) * N

    def _friction(self, k: int, g: Floats, N: Floats, z: Floats) -> tuple[Floats, Floats]:
        """Forces (d, k) of a contact that slips, its sign held in one dimension, and rates of its law's states."""
        contacts, d = self.system.problem.contacts, len(g)
        if contacts.law[k] == LAW_SMOOTH:
            x = np.concatenate([g, N[None], z]).T
            size = d + len(z)
            out = evaluate(contacts.law_table, k, x, size + size * (size + 1))
            return out[:d], out[d:size]
        if self.mode[k] != SLIP:
            return np.zeros_like(g), z[:0]
        if d == 1:
            sign = self.direction[int(contacts.row[k])]
            r, along = np.maximum(sign * g[0], _BARELY), np.full_like(g, sign)
        else:
            r = np.maximum(np.sqrt((g * g).sum(axis=0)), _BARELY)
            along = g / r
        return -coefficient(self.system, k, r, N) * N * along, z[:0]

    @cached_property
    def _stuck(self) -> Ints:
        return stuck_rows(self.system, self.mode)

    @cached_property
    def _flexibility(self) -> Floats:
        return np.asarray(np.linalg.inv(self.system.problem.linear.M))

    @cached_property
    def _response(self) -> tuple[Floats, Floats]:
        """Inverse of D over the stuck rows, and accelerations by forces on them."""
        W = self.system.problem.contacts.W[:, self._stuck]
        response = self._flexibility @ W
        return np.asarray(np.linalg.pinv(W.T @ response)), response


def stuck_rows(system: System, mode: Codes) -> Ints:
    """Rows of contacts that stick."""
    contacts = system.problem.contacts
    rows = [
        np.arange(contacts.row[k], contacts.row[k + 1])
        for k in range(system.problem.n_c)
        if mode[k] == STICK and contacts.law[k] != LAW_SMOOTH
    ]
    return np.concatenate([np.zeros(0, np.int64), *rows])
