"""The 4-dof brake by Gauss-Legendre collocation of order 20 in numpy's long double (64 bits of mantissa).

Shares nothing with ``brake_taylor.py`` but the equations: the stages are solved by Newton with their own Jacobians (in
double precision, refined by residuals in long double).  No node lies at the beginning of a step, so that a step can
start where slip begins, at |g| = 0.  Steps end at a transition: by bisection and secant on the length of the step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

L = np.longdouble
STAGES = 10
REST = L("1e-14")
LONGEST = L("0.08")
PORTION = L("0.25")  # of the time to the nearest zero of g, on the line it is on
RATIO = L(1000)
PI = L("3.14159265358979323846264338327950288")


def nodes(s):
    """Gauss nodes on (0, 1) and their integration matrix, in long double: (s,), (s, s) and weights (s,)."""

    def legendre(x):
        low, high = L(1) + 0 * x, x
        for k in range(2, s + 1):
            low, high = high, ((2 * k - 1) * x * high - (k - 1) * low) / k
        return high, s * (x * high - low) / (x * x - 1)

    x = np.cos(PI * (np.arange(s, 0, -1).astype(L) - L("0.25")) / (s + L("0.5")))
    for _ in range(8):
        value, slope = legendre(x)
        x = x - value / slope
    _, slope = legendre(x)
    weights = 1 / ((1 - x * x) * slope * slope)
    c = (x + 1) / 2
    A = np.zeros((s, s), dtype=L)
    for j in range(s):  # the integral of the j-th Lagrange polynomial to c_i, by the same rule on (0, c_i)
        others = np.delete(np.arange(s), j)
        for i in range(s):
            at = c[i] * c
            values = np.prod((at[:, None] - c[others]) / (c[j] - c[others]), axis=1)
            A[i, j] = c[i] * np.sum(weights * values)
    return c, A, weights


C, A, W = nodes(STAGES)


@dataclass(frozen=True, kw_only=True)
class Brake:
    """Squared frequencies of pad and rotor along y, and friction forces."""

    kinetic: L
    static: L
    v_s: L | None = None  # None: break-away at static, slip at kinetic
    pad: L = 50 * PI  # (10 sqrt(pi/2))^2
    rotor: L = 1 / L(4000)  # (sqrt(5/2)/100)^2

    def limit(self, r):
        """mu(r) N and its derivative."""
        if self.v_s is None:
            return self.kinetic + 0 * r, 0 * r
        fall = (self.static - self.kinetic) * np.exp(-((r / self.v_s) ** 2))
        return self.kinetic + fall, -2 * r / self.v_s**2 * fall

    def rate(self, y, slipping):
        """Rate (s, 8) of states (s, 8): x1, y1, x2, y2, common velocity (2), relative velocity g (2)."""
        pad = -y[:, :2] * np.array([L(1), self.pad])
        rotor = -y[:, 2:4] * np.array([L(0), self.rotor])
        common = (pad + RATIO * rotor) / (1 + RATIO)
        g = y[:, 6:]
        relative = 0 * g
        if slipping:
            r = np.sqrt(np.sum(g * g, axis=1))
            relative = pad - rotor - ((1 + 1 / RATIO) * self.limit(r)[0] / r)[:, None] * g
        return np.concatenate([velocities(y), common, relative], axis=1)

    def held(self, y):
        """The force (2,) on the pad that keeps both together in the state y (8,)."""
        pad = -y[:2] * np.array([L(1), self.pad])
        rotor = -y[2:4] * np.array([L(0), self.rotor])
        return (rotor - pad) / (1 + 1 / RATIO)

    def jacobians(self, y, slipping):
        """Derivatives of the rate, in double precision (s, 8, 8)."""
        J = np.zeros((len(y), 8, 8))
        share = float(1 / (1 + RATIO))
        stiffness = [1.0, float(self.pad), 0.0, float(self.rotor)]
        for i in (0, 1):
            J[:, [i, i + 2], 4 + i] = 1.0
            J[:, i, 6 + i], J[:, i + 2, 6 + i] = 1.0 - share, -share
            J[:, 4 + i, i], J[:, 4 + i, i + 2] = -share * stiffness[i], -(1.0 - share) * stiffness[i + 2]
            if slipping:
                J[:, 6 + i, i], J[:, 6 + i, i + 2] = -stiffness[i], stiffness[i + 2]
        if slipping:
            r = np.sqrt(np.sum(y[:, 6:] ** 2, axis=1))
            n = (y[:, 6:] / r[:, None]).astype(float)
            value, slope = self.limit(r)
            along = n[:, :, None] * n[:, None, :]
            bend = (value / r).astype(float)[:, None, None] * (np.eye(2) - along)
            J[:, 6:, 6:] -= float(1 + 1 / RATIO) * (bend + slope.astype(float)[:, None, None] * along)
        return J


def velocities(y):
    """Velocities (n, 4) of x1, y1, x2, y2 from states (n, 8)."""
    return np.concatenate([y[:, 4:6] + RATIO / (1 + RATIO) * y[:, 6:], y[:, 4:6] - y[:, 6:] / (1 + RATIO)], axis=1)


def step(brake, y, h, slipping, guess=None):
    """State after a step of Gauss-Legendre and its rates at the stages."""
    K = np.repeat(brake.rate(y[None, :], slipping), STAGES, axis=0) if guess is None else guess
    double = A.astype(float)
    for turn in range(40):
        stages = y + h * (A @ K)
        residual = brake.rate(stages, slipping) - K
        J = brake.jacobians(stages, slipping)
        system = np.eye(8 * STAGES) - float(h) * (double[:, None, :, None] * J[:, :, None, :]).reshape(8 * STAGES, -1)
        size = np.max(np.abs(residual))
        if size == 0:
            break
        change = np.linalg.solve(system, (residual / size).astype(float).ravel()).reshape(STAGES, 8).astype(L) * size
        K = K + change
        if turn > 2 and np.max(np.abs(h * change)) < L("1e-18"):
            break
    else:
        raise RuntimeError(f"stages do not converge at h = {h}")
    return y + h * (W @ K), K


def first_step(brake, y):
    """A step away from |g| = 0: its length, and rates near enough to the solution for Newton."""
    held = brake.held(y)
    size = np.sqrt(np.sum(held * held))
    n = -held / size  # the direction in which slip begins
    drop = (1 + 1 / RATIO) * (size - brake.limit(L(0))[0])
    v = velocities(y[None, :])[0]
    pull = -v[:2] * np.array([L(1), brake.pad]) + v[2:] * np.array([L(0), brake.rotor])
    grows = np.sum(pull * n)  # rate of the relative acceleration without friction, along n
    h = L("1e-3")
    t = C * h
    r = drop * t + grows * t * t / 2 if drop > L("1e-9") else grows * t * t / 2
    stages = y + t[:, None] * brake.rate(y[None, :], False)
    stages[:, 6:] = r[:, None] * n
    K = brake.rate(stages, True)
    K[:, 6:] = (drop + grows * t)[:, None] * n
    return h, K


def interpolate(y, h, K, t):
    """The collocation polynomial at the time t after the beginning of the step."""
    x = t / h
    others = [np.delete(np.arange(STAGES), j) for j in range(STAGES)]
    values = [np.prod((x * C[:, None] - C[o]) / (C[j] - C[o]), axis=1) for j, o in enumerate(others)]
    return y + h * sum(x * np.sum(W * value) * K[j] for j, value in enumerate(values))


START = np.array([0, 0, 0, 0, 0, 0, 10, L("0.01")])


def solve(brake, t_end, grid, start=START):
    """States (n_t, 8) on the grid (x1, y1, x2, y2, velocities), and transitions [(t, "stick" or "slip")]."""
    pad, rotor = start[4:6], start[6:]
    y = np.concatenate([start[:4], (pad + RATIO * rotor) / (1 + RATIO), pad - rotor])
    t, t_end = L(0), L(t_end)
    states, events = [], []
    slipping, starts = True, False
    while t < t_end:
        guess, ended = None, False
        if slipping and starts:
            h, guess = first_step(brake, y)
        elif slipping:
            g = y[6:]
            r = np.sqrt(np.sum(g * g))
            rate = brake.rate(y[None, :], True)[0]
            g_rate = rate[6:]
            if r < REST:
                h, ended = r / abs(np.sum(g * g_rate) / r), True
            else:
                h = min(LONGEST, PORTION * r / np.sqrt(np.sum(g_rate * g_rate)))
        else:
            h = LONGEST
        h = min(h, t_end - t)
        if ended:
            after, K = y + h * rate, np.repeat(rate[None, :], STAGES, axis=0)
        else:
            after, K = step(brake, y, h, slipping, guess)
        if not slipping and excess(brake, after) > 0:
            h = break_away(brake, y, h)
            after, K = step(brake, y, h, slipping)
            ended = True
        while len(states) < len(grid) and grid[len(states)] <= t + h:
            states.append(interpolate(y, h, K, grid[len(states)] - t))
        y, t, starts = after, t + h, False
        if ended:
            if slipping:
                y = np.concatenate([y[:6], [L(0), L(0)]])
            slipping, starts = not slipping, not slipping
            events.append((t, "slip" if slipping else "stick"))
    states = np.array(states)
    return np.concatenate([states[:, :4], velocities(states)], axis=1), events


def excess(brake, y):
    """|F| less its limit while stuck."""
    return np.sqrt(np.sum(brake.held(y) ** 2)) - brake.static


def break_away(brake, y, h):
    """Length of the step at whose end the limit is reached."""
    low, high = L(0), h
    f_low, f_high = excess(brake, y), excess(brake, step(brake, y, h, False)[0])
    for _ in range(8):
        middle = (low + high) / 2
        value = excess(brake, step(brake, y, middle, False)[0])
        low, f_low, high, f_high = (low, f_low, middle, value) if value > 0 else (middle, value, high, f_high)
    a, fa, b, fb = low, f_low, high, f_high
    for _ in range(6):
        if fa == fb:
            break
        a, fa, b = b, fb, b - fb * (b - a) / (fb - fa)
        fb = excess(brake, step(brake, y, b, False)[0])
    return b
