"""Pad and rotor by Taylor series of order 30 in 34-digit arithmetic; transitions located as zeros of the series.

Modal masses are 1: q'' = -omega^2 q - damping q' + sum W^T F, g = W q'.  Slip: F = -kinetic g/|g|; stick (of a single
contact): g' = 0 while |F| <= static.  Where slip begins, g = t h(t) with an analytic h, whose coefficients follow from
2 by 2 systems; where it ends, the steps halve the distance to |g| = 0.
"""

from __future__ import annotations

import mpmath as mp
from brake_taylor import ORDER, REST, TOLERANCE, convolve, horner, root


class Phase:
    """Series of one phase from a state (q, v); ``sticks``: the one contact holds; ``starts``: it begins to slide."""

    def __init__(self, system, q, v, *, sticks=False, starts=False):
        self.system, self.sticks, self.power = system, sticks, 1 if starts else 0
        self.q, self.v = [[c] for c in q], [[c] for c in v]
        self.h = [[[], []] for _ in system.W]
        self.n = [[[], []] for _ in system.W]
        self.F = [[[], []] for _ in system.W]
        self.u, self.s = [[] for _ in system.W], [[] for _ in system.W]
        for k in range(ORDER):
            rows = zip(system.omega, system.damping, self.q, self.v, strict=True)
            free = [-w * w * x[k] - d * y[k] for w, d, x, y in rows]
            self._forces(k, free)
            for j, row in enumerate(self.v):
                push = mp.fdot((W[i][j], F[i][k]) for W, F in zip(system.W, self.F, strict=True) for i in (0, 1))
                row.append((free[j] + push) / (k + 1))
                self.q[j].append(row[k] / (k + 1))

    def _forces(self, k, free):
        for c, W in enumerate(self.system.W):
            if self.sticks or self.power:
                pull = [mp.fdot(zip(row, free, strict=True)) for row in W]
                (self._hold if self.sticks else self._begin)(k, pull, self.system.delassus)
            else:
                for i in (0, 1):
                    self.h[c][i].append(mp.fdot((W[i][j], row[k]) for j, row in enumerate(self.v)))
                self._slide(c, k)

    def _hold(self, k, pull, D):
        force = mp.lu_solve(D, -mp.matrix(pull))
        for i in (0, 1):
            self.F[0][i].append(force[i])

    def _slide(self, c, k):
        """Coefficient k of |h|, n = h/|h| and F from those of h."""
        h, u, s, n, F = self.h[c], self.u[c], self.s[c], self.n[c], self.F[c]
        for row in (u, s, *n, *F):
            del row[k:]
        u.append(convolve(h[0], h[0], k) + convolve(h[1], h[1], k))
        s.append(mp.sqrt(u[0]) if k == 0 else (u[k] - convolve(s, s, k, 1, k - 1)) / (2 * s[0]))
        for i in (0, 1):
            n[i].append((h[i][k] - convolve(s, n[i], k, 1, k)) / s[0])
            F[i].append(-self.system.kinetic[c] * n[i][k])

    def _begin(self, k, pull, D):
        """Coefficient k of h where g = t h: (k+1) h_k = pull_k + D F_k."""
        if k == 0:
            self._onset(pull, D)
            return

        def residual(x):
            for i in (0, 1):
                del self.h[0][i][k:]
                self.h[0][i].append(x[i])
            self._slide(0, k)
            return self._defect(k, pull, D)

        zero = residual([mp.mpf(0), mp.mpf(0)])
        unit = max(abs(zero[0]), abs(zero[1])) or mp.mpf(1)  # coefficients grow as powers of the frequencies
        first, second = residual([unit, mp.mpf(0)]), residual([mp.mpf(0), unit])
        left = mp.matrix([[(first[i] - zero[i]) / unit, (second[i] - zero[i]) / unit] for i in (0, 1)])
        residual(list(mp.lu_solve(left, -mp.matrix(zero))))

    def _defect(self, k, pull, D):
        F = self.F[0]
        return [pull[i] + D[i, 0] * F[0][k] + D[i, 1] * F[1][k] - (k + 1) * self.h[0][i][k] for i in (0, 1)]

    def _onset(self, pull, D):
        """The direction d and the size a of the first relative acceleration: a d = pull - kinetic D d, |d| = 1."""
        held = mp.lu_solve(D, mp.matrix(pull))
        size = mp.hypot(held[0], held[1])
        kinetic = self.system.kinetic[0]

        def residual(a, x, y):
            return [
                pull[0] - kinetic * (D[0, 0] * x + D[0, 1] * y) - a * x,
                pull[1] - kinetic * (D[1, 0] * x + D[1, 1] * y) - a * y,
                x * x + y * y - 1,
            ]

        drop = (1 - kinetic / size) * mp.hypot(*pull)
        a, x, y = mp.findroot(residual, (drop, held[0] / size, held[1] / size), tol=1e-60)
        if not a > 0:
            raise ValueError("no direction in which slip can begin")
        for i, d in enumerate((x, y)):
            self.h[0][i].append(a * d)
        self._slide(0, 0)

    @property
    def step(self):
        """Time for which what is left out stays below the tolerance."""
        scale = self.system.speed
        last = max(max(abs(row[ORDER]) for row in self.v), max(abs(row[ORDER - 1]) for row in self.v)) / scale
        return (TOLERANCE / last) ** (mp.mpf(1) / ORDER) if last else self.system.longest

    def at(self, t):
        """State after the time t."""
        return [horner(row, t) for row in self.q], [horner(row, t) for row in self.v]

    def force(self, t):
        """Forces [[x, y], ...] after the time t."""
        return [[horner(row, t) for row in F] for F in self.F]

    def excess(self, t):
        """|F|^2 less its limit, over that limit."""
        limit = self.system.static[0]
        return (horner(self.F[0][0], t) ** 2 + horner(self.F[0][1], t) ** 2) / limit**2 - 1

    def slip_step(self, longest):
        """Length of a step that passes no zero of any |g|, and whether the slip of the one contact ends with it."""
        h = min(self.step, longest)
        if self.power:
            return h, False
        for c, W in enumerate(self.system.W):
            rate = [mp.fdot((W[i][j], row[1]) for j, row in enumerate(self.v)) for i in (0, 1)]
            r = self.s[c][0]
            if r < REST * self.system.speed:
                if len(self.system.W) > 1:
                    raise ValueError("one of several contacts comes to rest")
                return r * r / abs(self.h[c][0][0] * rate[0] + self.h[c][1][0] * rate[1]), True
            h = min(h, r / (2 * mp.hypot(*rate)))
        return h, False

    def stick_step(self, longest):
        """Length of a step that ends at break-away at the latest, and whether it does."""
        h = min(self.step, longest)
        for k in range(8):
            if self.excess(h * (k + 1) / 8) > 0:
                return root(lambda x: self.excess(x * h), mp.mpf(k) / 8, mp.mpf(k + 1) / 8) * h, True
        return h, False


def solve(system, q, v, grid):
    """States (q, v) and forces on the grid, transitions [(t, "stick" or "slip")]."""
    t, t_end, events, states, forces = mp.mpf(0), grid[-1], [], [], []
    sticks, starts = False, False
    while t < t_end:
        phase = Phase(system, q, v, sticks=sticks, starts=starts)
        h, ended = (phase.stick_step if sticks else phase.slip_step)(t_end - t)
        h, ended = (h, ended) if h < t_end - t else (t_end - t, False)
        while len(states) < len(grid) and grid[len(states)] <= t + h:
            forces.append(phase.force(grid[len(states)] - t))
            states.append(phase.at(grid[len(states)] - t))
        q, v = phase.at(h)
        t, starts = t + h, False
        if ended:
            if not sticks:
                v = system.rest(v)
            sticks, starts = not sticks, sticks
            events.append((t, "stick" if sticks else "slip"))
    return states, forces, events
