"""Pad and rotor by Gauss-Legendre collocation of order 20 in numpy's long double.

Shares nothing with ``pad_rotor_taylor.py`` but the equations (stated there).  Steps end where slip ends or begins.
"""

from __future__ import annotations

import numpy as np
from brake_gauss import STAGES, A, C, L
from brake_gauss import W as WEIGHTS

REST = L("1e-13")
PORTION = L("0.12")  # of the time to the nearest zero of g, on the line it is on


def relative(system, v):
    """Relative velocities (s, m, 2) and their sizes."""
    g = np.einsum("kin,sn->ski", system.W, v)
    return g, np.sqrt(np.sum(g * g, axis=2))


def rate(system, y, sticks):
    """Rates (s, 2 n) of states (s, 2 n), and forces (s, m, 2)."""
    q, v = np.split(y, 2, axis=1)
    a = -(system.omega**2) * q - system.damping * v
    if sticks:
        F = -np.einsum("ij,sj->si", system.compliance, np.einsum("in,sn->si", system.W[0], a))[:, None, :]
    else:
        g, r = relative(system, v)
        F = -(system.kinetic[:, None] / r[..., None]) * g
    return np.concatenate([v, a + np.einsum("kin,ski->sn", system.W, F)], axis=1), F


def jacobians(system, y, sticks):
    """Derivatives of the rate, in double precision (s, 2 n, 2 n)."""
    n = y.shape[1] // 2
    J = np.zeros((len(y), 2 * n, 2 * n))
    J[:, :n, n:] = np.eye(n)
    J[:, n:, :n] = np.diag(-(system.omega**2).astype(float))
    J[:, n:, n:] = np.diag(-system.damping.astype(float))
    W = system.W.astype(float)
    if sticks:
        held = np.eye(n) - W[0].T @ system.compliance.astype(float) @ W[0]
        J[:, n:] = held @ J[:, n:]
        return J
    g, r = relative(system, y[:, n:])
    d = (g / r[..., None]).astype(float)
    bend = (np.eye(2) - d[..., :, None] * d[..., None, :]) * (system.kinetic / r).astype(float)[..., None, None]
    J[:, n:, n:] -= np.einsum("kin,skij,kjm->snm", W, bend, W)
    return J


def step(system, y, h, sticks, guess=None):
    """State after a step, and the rates at its stages, until they change by round-off of W v alone."""
    K = np.repeat(rate(system, y[None, :], sticks)[0], STAGES, axis=0) if guess is None else guess
    size = len(y)
    double = A.astype(float)
    moved = L("inf")
    for turn in range(40):
        residual = rate(system, y + h * (A @ K), sticks)[0] - K
        J = jacobians(system, y + h * (A @ K), sticks)
        inner = (double[:, None, :, None] * J[:, :, None, :]).reshape(size * STAGES, -1)
        left = np.eye(size * STAGES) - float(h) * inner
        change = np.linalg.solve(left, residual.astype(float).ravel()).reshape(STAGES, size).astype(L)
        K = K + change
        before, moved = moved, np.max(np.abs(h * change) / system.units)
        if turn > 2 and (moved < L("3e-18") or (moved < L("1e-15") and moved > before / 4)):
            return y + h * (WEIGHTS @ K), K
    raise RuntimeError(f"stages do not converge at h = {h}")


def interpolate(y, h, K, t):
    """The collocation polynomial at the time t after the beginning of the step."""
    x = t / h
    others = [np.delete(np.arange(STAGES), j) for j in range(STAGES)]
    values = [np.prod((x * C[:, None] - C[o]) / (C[j] - C[o]), axis=1) for j, o in enumerate(others)]
    return y + h * sum(x * np.sum(WEIGHTS * value) * K[j] for j, value in enumerate(values))


def first_step(system, y):
    """A step away from g = 0: its length, and rates near enough to the solution for Newton."""
    n = len(y) // 2
    a = -(system.omega**2) * y[:n] - system.damping * y[n:]
    pull = system.W[0] @ a
    D = system.W[0] @ system.W[0].T
    low, high = L(0), np.sqrt(pull @ pull)
    for _ in range(70):  # a d = pull - kinetic D d: |d| falls as a grows, and has to be 1
        left = system.kinetic[0] * D + (low + high) / 2 * np.eye(2)
        d = np.array([left[1, 1] * pull[0] - left[0, 1] * pull[1], left[0, 0] * pull[1] - left[1, 0] * pull[0]])
        d = d / (left[0, 0] * left[1, 1] - left[0, 1] * left[1, 0])
        low, high = ((low + high) / 2, high) if d @ d > 1 else (low, (low + high) / 2)
    h = system.first
    K = np.concatenate([y[n:], a - system.kinetic[0] * (system.W[0].T @ d)])
    return h, np.repeat(K[None, :], STAGES, axis=0)


def excess(system, y):
    """|F| less its limit while stuck, over that limit."""
    F = rate(system, y[None, :], True)[1][0, 0]
    return np.sqrt(F @ F) / system.static[0] - 1


def break_away(system, y, h):
    """Length of the step at whose end the limit is reached: regula falsi in its Illinois form."""
    a, b = L(0), h
    fa, fb = excess(system, y), excess(system, step(system, y, h, True)[0])
    for _ in range(60):
        middle = b - fb * (b - a) / (fb - fa)
        value = excess(system, step(system, y, middle, True)[0])
        if abs(value) < L("1e-18") or middle in (a, b):
            return middle
        if (value > 0) == (fb > 0):
            b, fb, fa = middle, value, fa / 2
        else:
            a, fa, b, fb = b, fb, middle, value
    return b


def slip_step(system, y, longest):
    """Length of a step on which no |g| comes near 0, and whether slip ends with it."""
    n = len(y) // 2
    g, r = (x[0] for x in relative(system, y[None, n:]))
    slope = np.einsum("kin,n->ki", system.W, rate(system, y[None, :], False)[0][0, n:])
    if (r < REST * system.speed).any():
        k = int(np.argmin(r))
        return r[k] ** 2 / abs(g[k] @ slope[k]), True
    return min(longest, PORTION * np.min(r / np.sqrt(np.sum(slope * slope, axis=1)))), False


def solve(system, q, v, grid):
    """States (n_t, 2 n), transitions [(t, "stick" or "slip")]."""
    y, t, states, events = np.concatenate([q, v]), L(0), [], []
    n, sticks, starts = len(q), False, False
    while t < grid[-1]:
        guess, ended = None, False
        h = min(system.longest, grid[-1] - t)
        if starts:
            first, guess = first_step(system, y)
            h = min(h, first)
        elif not sticks:
            h, ended = slip_step(system, y, h)
        if ended:
            K = np.repeat(rate(system, y[None, :], False)[0], STAGES, axis=0)
            after = y + h * K[0]
        else:
            after, K = step(system, y, h, sticks, guess)
        if sticks and excess(system, after) > 0:
            h, ended = break_away(system, y, h), True
            after, K = step(system, y, h, True)
        while len(states) < len(grid) and grid[len(states)] <= t + h:
            states.append(interpolate(y, h, K, grid[len(states)] - t))
        y, t, starts = after, t + h, False
        if ended:
            if not sticks:
                y[n:] -= system.W[0].T @ (system.compliance @ (system.W[0] @ y[n:]))
            sticks, starts = not sticks, sticks
            events.append((t, "stick" if sticks else "slip"))
    return np.array(states), events
