"""Forces and accelerations while no mode changes."""

from __future__ import annotations

from typing import Any

import numpy as np

from .instant import loaded
from .loads import check_single, settled
from .problem import OPEN, SLIP, STICK, OracleError, Problem, nothing


class Field:
    """The right-hand side for one set of modes; ``signs``: directions of slip in one dimension."""

    def __init__(self, problem: Problem, modes: list[int], signs: list[float], window: tuple[float, float]) -> None:
        self.problem, self.modes, self.signs = problem, list(modes), list(signs)
        self.low, self.high = window[0], np.nextafter(window[1], window[0])
        self.n = problem.q.size
        self.contacts = problem.contacts
        self.rows, self.z_rows = layout(problem)
        self.W = np.hstack([c.W for c in self.contacts]) if self.contacts else np.zeros((self.n, 0))
        self.held = np.array(
            [j for c, s, m in zip(self.contacts, self.rows, modes, strict=True) if m == STICK and c.force is None
             for j in range(s.start, s.stop)], dtype=int,
        )  # fmt: skip
        self.acting = [
            i for i, (c, m) in enumerate(zip(self.contacts, modes, strict=True)) if c.force is not None or m == SLIP
        ]
        self.driven = [i for i, c in enumerate(self.contacts) if c.slide is not nothing]
        self.reactive = any(c.reaction is not None for c in self.contacts)
        self.guess = np.zeros(self.n)
        self.load: list[float] = []
        self.active: set[int] = set()
        self.full: bool | None = None
        self.varies = problem.mass is not None or problem.slip is not None
        self.fixed = None if self.varies else self.inverse(problem.M, self.W)

    def inverse(self, M: np.ndarray, W: np.ndarray) -> tuple[np.ndarray, ...]:
        """M^-1, D, what turns accelerations of held contacts into their forces, and W."""
        Mi = np.linalg.inv(M)
        D = W.T @ Mi @ W
        h = self.held
        P = np.linalg.pinv(D[np.ix_(h, h)], rcond=1e-11, hermitian=True) if h.size else np.zeros((0, 0))
        return Mi, D, P, W

    def matrices(self, q: np.ndarray) -> tuple[np.ndarray, ...]:
        """M^-1, D, P and W at q."""
        if self.fixed is not None:
            return self.fixed
        return self.inverse(self.problem.M if self.problem.mass is None else self.problem.mass(q), self.slip_rows(q))

    def slip_rows(self, q: np.ndarray) -> np.ndarray:
        """W of all contacts at q."""
        return self.W if self.problem.slip is None else self.problem.slip(q)

    def speeds(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Relative velocities of all contacts."""
        g = self.slip_rows(q).T @ v
        for i in self.driven:
            g[self.rows[i]] -= self.contacts[i].slide(t)
        return g

    def speed_up(self, t: float, y: np.ndarray, a: np.ndarray) -> np.ndarray:
        """Relative accelerations of all contacts."""
        q, v = y[: self.n], y[self.n : 2 * self.n]
        return self.slip_rows(q).T @ a - self.wanted(t, q, v)

    def wanted(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """``W^T a`` of what keeps its relative velocity: rates of the prescribed part, less ``W'^T v``."""
        rates = np.zeros(self.W.shape[1]) if self.problem.slip_rate is None else -self.problem.slip_rate(q, v)
        for i in self.driven:
            rates[self.rows[i]] += self.contacts[i].slide_rate(t)
        return rates

    def given(self, t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        """Generalised forces other than friction."""
        p = self.problem
        f = p.load(t) - p.K @ q - p.C @ v
        return f if p.extra is None else f + p.extra(t, q, v)

    def loads(self, t: float, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> list[float]:
        """Normal forces; below 0: that far from contact."""
        return [
            float(c.N(t, q, v)) if c.reaction is None else float(c.reaction(t, q, v, a)) for c in self.contacts
        ]

    def evaluate(self, t: float, y: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Accelerations, forces, relative velocities and rates of states."""
        t = min(max(t, self.low), self.high)
        q, v = y[: self.n], y[self.n : 2 * self.n]
        known = self.known(t, y)
        if not self.reactive:
            self.load = self.loads(t, q, v, self.guess)
            return self.under(t, y, self.load, known)

        def answer(N: np.ndarray) -> np.ndarray:
            return np.array(self.loads(t, q, v, self.under(t, y, N.tolist(), known)[0]))

        self.load = settled(answer, np.array(self.loads(t, q, v, self.guess))).tolist()
        found = self.under(t, y, self.load, known)
        self.guess = found[0]
        return found

    def check_loads(self, t: float, y: np.ndarray) -> None:
        """An error where loads that depend on friction would also be others: of two solutions, secants find any."""
        if self.reactive:
            self.evaluate(t, y)
            q, v, known = y[: self.n], y[self.n : 2 * self.n], self.known(t, y)
            check_single(
                lambda N: np.array(self.loads(t, q, v, self.under(t, y, N.tolist(), known)[0])), np.array(self.load)
            )

    def known(self, t: float, y: np.ndarray) -> tuple[Any, ...]:
        """What does not depend on the loads: relative velocities, forces other than friction, matrices."""
        q, v = y[: self.n], y[self.n : 2 * self.n]
        return self.speeds(t, q, v), self.given(t, q, v), self.matrices(q)

    def under(
        self, t: float, y: np.ndarray, load: list[float], known: tuple[Any, ...] | None = None
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """The same under given loads."""
        n = self.n
        g, given, (Mi, _D, P, W) = self.known(t, y) if known is None else known
        F = np.zeros(g.size)
        rates = np.zeros(y.size - 2 * n)
        for i in self.acting:
            c, s = self.contacts[i], self.rows[i]
            if c.force is None:
                F[s] = self.slip(i, g[s], max(load[i], 0.0))
                continue
            z, N = y[2 * n :][self.z_rows[i]], max(load[i], 0.0)
            F[s] = c.force(g[s], N, z)
            if c.rate is not None:
                rates[self.z_rows[i]] = c.rate(g[s], N, z)
        a = Mi @ (given + W @ F)
        if self.held.size:
            h = self.held
            F[h] = P @ (self.wanted(t, y[:n], y[n : 2 * n])[h] - W[:, h].T @ a)
            a = a + Mi @ (W[:, h] @ F[h])
        return a, F, g, rates

    def slip(self, i: int, g: np.ndarray, N: float) -> np.ndarray:
        """Friction in slip."""
        c = self.contacts[i]
        assert c.mu is not None
        if c.d == 1:
            sign = self.signs[i]
            return -sign * c.mu(max(sign * float(g[0]), 0.0), N) * N  # type: ignore[return-value]
        r = float(np.sqrt(g @ g))
        if r == 0.0:
            raise OracleError("no direction of slip")
        return -c.mu(r, N) * N / r * g

    def __call__(self, t: float, y: np.ndarray) -> np.ndarray:
        """For scipy."""
        a, _, _, rates = self.evaluate(t, y)
        return np.concatenate([y[self.n : 2 * self.n], a, rates])

    def margins(self, t: float, y: np.ndarray) -> np.ndarray:
        """What must stay above 0 for the modes to go on, contact by contact."""
        _, F, g, _ = self.evaluate(t, y)
        out = np.full((2, len(self.contacts)), np.inf)
        for i, (c, s) in enumerate(zip(self.contacts, self.rows, strict=True)):
            if c.force is not None:
                continue
            N = self.load[i]
            if not c.constant:
                out[1, i] = -N if self.modes[i] == OPEN else N
            if self.modes[i] == STICK:
                assert c.mu_s is not None
                out[0, i] = c.mu_s(max(N, 0.0)) * max(N, 0.0) - np.sqrt(F[s] @ F[s])
            elif self.modes[i] == SLIP and c.d == 1:
                out[0, i] = self.signs[i] * g[s.start]
        if self.held.size:
            self.share(out[0], F, y[: self.n])
        return out

    def share(self, margins: np.ndarray, F: np.ndarray, q: np.ndarray) -> None:
        """Of contacts more than enough to hold what they hold: the margin of the best distribution of forces."""
        D = self.matrices(q)[1]
        held = D[np.ix_(self.held, self.held)]
        stuck = [i for i, c in enumerate(self.contacts) if self.modes[i] == STICK and c.force is None]
        if self.full is None or self.varies:
            self.full = bool(np.linalg.matrix_rank(held, tol=1e-11 * np.abs(held).max()) == held.shape[0])
        if self.full:
            return
        if any(self.contacts[i].d > 1 for i in stuck):
            if min(margins[stuck]) < 0.0:
                raise OracleError("redundant contacts in two directions")
            return
        rows = [self.rows[i].start for i in stuck]
        limits = margins[stuck] + np.abs(F[rows])
        most, forces = loaded(held, held @ F[rows], limits)
        full = np.abs(forces) > (1.0 - 1e-6) * most * limits
        self.active = {i for i, at_limit in zip(stuck, full, strict=True) if at_limit}
        margins[stuck] = (1.0 - most) * limits


def layout(problem: Problem) -> tuple[list[slice], list[slice]]:
    """Where each contact's rows and states lie."""
    rows, states, at, z = [], [], 0, 0
    for c in problem.contacts:
        rows.append(slice(at, at + c.d))
        states.append(slice(z, z + c.n_z))
        at, z = at + c.d, z + c.n_z
    return rows, states
