"""The 4-dof brake by Taylor series of order 30 in 34-digit arithmetic, its transitions located as zeros of the series.

Slip: F = -mu(r) N g/r with mu N = kinetic + (static - kinetic) exp(-(r/v_s)^2), r = |g|; stick: g' = 0 while |F| <=
static.  Where slip begins, g = t h(t) with an analytic h: its series starts there, at the singular point of the
equations (h_k from a 2 by 2 system).  Where slip ends, the steps halve the distance to r = 0 down to r = 1e-17; the
rest is a straight line, wrong by its square.
"""

from __future__ import annotations

from dataclasses import dataclass

import mpmath as mp

mp.mp.dps = 34
ORDER = 30
TOLERANCE = mp.mpf(10) ** -24
REST = mp.mpf(10) ** -17
RATIO = mp.mpf(1000)  # of the masses
D = 1 + 1 / RATIO


@dataclass(frozen=True, kw_only=True)
class Brake:
    """Squared frequencies of pad and rotor along y, and friction forces."""

    kinetic: mp.mpf
    static: mp.mpf
    v_s: mp.mpf | None = None  # None: break-away at static, slip at kinetic
    pad: mp.mpf = 50 * mp.pi  # (10 sqrt(pi/2))^2
    rotor: mp.mpf = 1 / mp.mpf(4000)  # (sqrt(5/2)/100)^2

    @property
    def onset(self):
        """Friction force just after slip has begun."""
        return self.kinetic if self.v_s is None else self.static


def convolve(a, b, k, first=0, last=None):
    """sum_{j=first..last} a_j b_{k-j}, by default j = 0..k."""
    last = k if last is None else last
    return mp.fdot((a[j], b[k - j]) for j in range(first, last + 1))


class Slip:
    """Series of one slip phase from a state: positions and velocities of x1, y1, x2, y2.

    ``power`` m: g = t^m h; 0 in the middle of a phase; where slip begins 1 if the friction force drops there, else 2.
    """

    def __init__(self, brake: Brake, q, v, *, starts: bool):
        self.brake, self.power = brake, 0
        self.q = [[c] for c in q]
        self.v = [[c] for c in v]
        self.h = [[], []]
        self.u, self.s, self.n, self.w, self.mu, self.e = [], [], [[], []], [], [], []
        if starts:
            self.power = 2 if brake.onset == brake.static else 1
        for k in range(ORDER):
            if self.power == 0:
                for i in (0, 1):
                    self.h[i].append(self.v[i][k] - self.v[i + 2][k])
                self._friction(k)
            else:
                (self._quadratic if self.power == 2 else self._linear)(k)
            self._advance(k)

    def _friction(self, k):
        """Coefficient k of |h|, n = h/|h| and mu N from those of h; returns that of the friction force on the pad."""
        h = self.h
        for row in (self.u, self.s, self.mu, self.e, self.w, *self.n):
            del row[k:]
        self.u.append(convolve(h[0], h[0], k) + convolve(h[1], h[1], k))
        if k == 0:
            self.s.append(mp.sqrt(self.u[0]))
        else:
            self.s.append((self.u[k] - convolve(self.s, self.s, k, 1, k - 1)) / (2 * self.s[0]))
        for i in (0, 1):
            self.n[i].append((h[i][k] - convolve(self.s, self.n[i], k, 1, k)) / self.s[0])
        self._limit(k)
        return [-convolve(self.mu, self.n[i], k) for i in (0, 1)]

    def _limit(self, k):
        """Coefficient k of mu N."""
        b, delay = self.brake, 2 * self.power
        if b.v_s is None:
            self.mu.append(b.kinetic if k == 0 else mp.mpf(0))
            return
        self.w.append(self.u[k - delay] / b.v_s**2 if k >= delay else mp.mpf(0))
        if k == 0:
            self.e.append(mp.exp(-self.w[0]))
        else:
            self.e.append(-mp.fdot((j * self.w[j], self.e[k - j]) for j in range(1, k + 1)) / k)
        self.mu.append((b.static - b.kinetic) * self.e[k] + (b.kinetic if k == 0 else 0))

    def _load(self, k):
        """Accelerations without friction, coefficient k: x1, y1, x2, y2."""
        q, b = self.q, self.brake
        return -q[0][k], -b.pad * q[1][k], mp.mpf(0), -b.rotor * q[3][k]

    def _pull(self, k):
        """Relative acceleration without friction, coefficient k."""
        load = self._load(k)
        return [load[i] - load[i + 2] for i in (0, 1)]

    def _linear(self, k):
        """Coefficient k of h where g = t h: (k+1) h_k = a_k + D F_k, F_k linear in h_k."""
        a = self._pull(k)
        if k == 0:
            size = mp.hypot(*a)
            for i in (0, 1):
                self.h[i].append(a[i] * (size - D * self.brake.onset) / size)
            self._friction(0)
            return

        def residual(x):
            self._set(k, x)
            force = self._friction(k)
            return [a[i] + D * force[i] - (k + 1) * self.h[i][k] for i in (0, 1)]

        self._settle(residual)

    def _quadratic(self, k):
        """Where g = t^2 h: h_(k-1) along the first direction and h_k across it, (k+1) h_(k-1) = a_k + D F_k."""
        a = self._pull(k)
        if k == 0:
            size = mp.hypot(*a)  # = D static; h_0 = |h_0| a/|a|, |h_0| = (a_1 . a)/(2 |a|)
            slope = [-self.v[0][0], -self.brake.pad * self.v[1][0] + self.brake.rotor * self.v[3][0]]
            grows = (a[0] * slope[0] + a[1] * slope[1]) / size / 2
            for i in (0, 1):
                self.h[i].append(a[i] / size * grows)
            self._friction(0)
            return
        n = (self.n[0][0], self.n[1][0])
        across = (-n[1], n[0])
        known = [self.h[i][k - 1] for i in (0, 1)]
        for i in (0, 1):
            self.h[i].append(mp.mpf(0))

        def residual(x):
            for i in (0, 1):
                self.h[i][k - 1] = known[i] + x[0] * n[i]
                self.h[i][k] = x[1] * across[i]
            self._friction(k - 1)
            force = self._friction(k)
            return [a[i] + D * force[i] - (k + 1) * self.h[i][k - 1] for i in (0, 1)]

        self._settle(residual)

    def _set(self, k, x):
        for i in (0, 1):
            del self.h[i][k:]
            self.h[i].append(x[i])

    @staticmethod
    def _settle(residual):
        """The zero of an affine function of two numbers; it is called there last."""
        zero = residual([mp.mpf(0), mp.mpf(0)])
        first, second = residual([mp.mpf(1), mp.mpf(0)]), residual([mp.mpf(0), mp.mpf(1)])
        left = mp.matrix([[first[i] - zero[i], second[i] - zero[i]] for i in (0, 1)])
        found = mp.lu_solve(left, mp.matrix([-zero[0], -zero[1]]))
        residual([found[0], found[1]])

    def _advance(self, k):
        load = self._load(k)
        for i in range(4):
            force = -convolve(self.mu, self.n[i % 2], k)
            push = force if i < 2 else -force / RATIO
            self.v[i].append((load[i] + push) / (k + 1))
            self.q[i].append(self.v[i][k] / (k + 1))

    @property
    def step(self):
        """Time for which what is left out stays below the tolerance."""
        last = max(max(abs(row[ORDER]) for row in self.v), max(abs(row[ORDER - 1]) for row in self.v))
        return (TOLERANCE / last) ** (mp.mpf(1) / ORDER) if last else mp.mpf(1)

    def at(self, t):
        """State after the time t."""
        return [horner(row, t) for row in self.q], [horner(row, t) for row in self.v]


def horner(row, t):
    """Sum of row_k t^k."""
    value = mp.mpf(0)
    for c in reversed(row):
        value = value * t + c
    return value


def root(function, a, b):
    """Zero in (a, b), where the function passes from below to above: halving, then Newton with a difference."""
    if function(a) > 0:
        raise ValueError("the phase starts beyond its limit")
    for _ in range(20):
        middle = (a + b) / 2
        a, b = (a, middle) if function(middle) > 0 else (middle, b)
    step = mp.mpf(10) ** -12
    for _ in range(4):
        slope = (function(b + step) - function(b - step)) / (2 * step)
        b -= function(b) / slope
    return b


class Stick:
    """Series of one stick phase: pad and rotor move together."""

    def __init__(self, brake: Brake, q, v):
        self.brake = brake
        self.q = [[c] for c in q]
        self.v = [[c] for c in v]
        self.F = [[], []]
        for k in range(ORDER):
            load = (-self.q[0][k], -brake.pad * self.q[1][k], mp.mpf(0), -brake.rotor * self.q[3][k])
            for i in (0, 1):
                common = (load[i] + RATIO * load[i + 2]) / (1 + RATIO)
                self.F[i].append(common - load[i])
                for j in (i, i + 2):
                    self.v[j].append(common / (k + 1))
            for i in range(4):
                self.q[i].append(self.v[i][k] / (k + 1))

    step = Slip.step
    at = Slip.at

    def excess(self, t):
        """|F|^2 less its limit."""
        return horner(self.F[0], t) ** 2 + horner(self.F[1], t) ** 2 - self.brake.static**2


def slip_step(series, starts):
    """Length of a step that passes no zero of r, and whether slip ends with it."""
    if starts:
        return series.step, False
    g = [series.h[i][0] for i in (0, 1)]
    rate = [series.v[i][1] - series.v[i + 2][1] for i in (0, 1)]
    r = series.s[0]
    if r < REST:
        return r**2 / abs(g[0] * rate[0] + g[1] * rate[1]), True
    return min(series.step, r / (2 * mp.hypot(*rate))), False


def stick_step(series, longest):
    """Length of a step that ends at break-away at the latest, and whether it does."""
    h = min(series.step, longest)
    for k in range(8):
        if series.excess(h * (k + 1) / 8) > 0:
            return root(series.excess, h * k / 8, h * (k + 1) / 8), True
    return h, False


def solve(brake: Brake, t_end, grid):
    """States (q, v) on the grid and transitions [(t, "stick" or "slip")]."""
    q, v = [mp.mpf(0)] * 4, [mp.mpf(0), mp.mpf(0), mp.mpf(10), mp.mpf("0.01")]
    t, t_end, events, states = mp.mpf(0), mp.mpf(t_end), [], []
    slipping, starts = True, False
    while t < t_end:
        series = Slip(brake, q, v, starts=starts) if slipping else Stick(brake, q, v)
        h, ended = slip_step(series, starts) if slipping else stick_step(series, t_end - t)
        h, ended = (h, ended) if h < t_end - t else (t_end - t, False)
        while len(states) < len(grid) and grid[len(states)] <= t + h:
            states.append(series.at(grid[len(states)] - t))
        q, v = series.at(h)
        t, starts = t + h, False
        if ended:
            if slipping:
                for i in (0, 1):
                    v[i] = v[i + 2] = (v[i] + RATIO * v[i + 2]) / (1 + RATIO)
            slipping, starts = not slipping, not slipping
            events.append((t, "slip" if slipping else "stick"))
    return states, events
