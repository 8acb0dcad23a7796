"""Prototype of Taylor steps for contacts in two directions, beside what ``auto`` takes.

``python tools/planar_taylor.py`` prints, for masses on a belt in the plane (those of ``choice_survey``), the time of
the steps alone, the error at 20 times, and how much faster Taylor steps reach an error no larger.  All masses take one
step, which ends at every transition.  With u the slip velocity and d = u/|u|, of series u_k and d_k,

    u_k = sum_i s_i d_(k-i),    sum_i d_i . d_(k-i) = 0 for k > 0

give s_k and d_k order by order.  Slip that begins has u = s p, and p takes the place of u: friction of order k is then
part of p_k, which stays linear in d_k.  Stick ends where |F|^2 = (mu_s N)^2, slip where u . d(0) = 0.
"""

from __future__ import annotations

import math
import time
from typing import Any

import numba
import numpy as np
from choice_survey import in_the_plane

import fricmb as fm
from fricmb.integrate import integrators
from fricmb.integrate.collocation import Collocation
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.problem import Start
from fricmb.system import build

STICK, SLIP, BEGIN = range(3)
OTHERS = {"collocation": Collocation(general=True), "radau": integrators["radau"]()}


@numba.njit(cache=True)
def direction(s, d, k, ax, ay, other):
    """Orders k > 0 of s and d, whose product is (ax, ay) less ``other`` times d_k."""
    x, y, inner = d[0, 0], d[1, 0], 0.0
    for i in range(1, k):
        inner -= 0.5 * (d[0, i] * d[0, k - i] + d[1, i] * d[1, k - i])
        ax -= s[i] * d[0, k - i]
        ay -= s[i] * d[1, k - i]
    s[k] = ax * x + ay * y - (s[0] + other) * inner
    across = (ay * x - ax * y) / (s[0] + other)
    d[0, k], d[1, k] = inner * x - across * y, inner * y + across * x


@numba.njit(cache=True)
def accelerate(K, m, x, out):
    """-M^-1 K x."""
    for j in range(x.shape[0]):
        value = 0.0
        for i in range(x.shape[0]):
            value -= K[j, i] * x[i]
        out[j] = value / m[j]


@numba.njit(cache=True)
def series(K, m, w, mu, mode, q, v, h, Q, A, D, S):
    """Powers of s of displacements Q, of the structure's accelerations A and of d and |u| (D, S), for a step h."""
    for j in range(q.shape[0]):
        Q[0, j], Q[1, j] = q[j], v[j] * h
    for k in range(Q.shape[0] - 2):
        accelerate(K, m, Q[k], A[k])
        f = h * h / ((k + 1.0) * (k + 2.0))
        for c in range(mode.shape[0]):
            x, y, g, other = 2 * c, 2 * c + 1, mu[c] / m[2 * c], 0.0
            if mode[c] == STICK:
                Q[k + 2, x] = Q[k + 2, y] = 0.0
                continue
            ax, ay = (k + 1) * Q[k + 1, x] / h, (k + 1) * Q[k + 1, y] / h
            if mode[c] == BEGIN:
                ax, ay, other = h / (k + 1) * A[k, x], h / (k + 1) * A[k, y], h * g / (k + 1)
            elif k == 0:
                ax, ay = ax - w[0], ay - w[1]
            if k == 0:
                size = math.hypot(ax, ay)
                S[c, 0] = size - other
                D[c, 0, 0], D[c, 1, 0] = ax / size, ay / size
            else:
                direction(S[c], D[c], k, ax, ay, other)
            Q[k + 2, x], Q[k + 2, y] = f * (A[k, x] - g * D[c, 0, k]), f * (A[k, y] - g * D[c, 1, k])


@numba.njit(cache=True)
def left_of_stick(A, m, c, limit, s):
    """What stick has left: limit^2 - |F(s)|^2."""
    a, b = 0.0, 0.0
    for k in range(A.shape[0] - 2, -1, -1):
        a, b = a * s + A[k, 2 * c], b * s + A[k, 2 * c + 1]
    return limit * limit - m[2 * c] ** 2 * (a * a + b * b)


@numba.njit(cache=True)
def left_of_slip(Q, D, w, c, h, s):
    """Slip velocity along the direction in which it was."""
    a, b = 0.0, 0.0
    for k in range(Q.shape[0] - 1, 0, -1):
        a, b = a * s + k * Q[k, 2 * c], b * s + k * Q[k, 2 * c + 1]
    return (a / h - w[0]) * D[c, 0, 0] + (b / h - w[1]) * D[c, 1, 0]


@numba.njit(cache=True)
def first_end(Q, A, D, m, w, stick, mode, h, end):
    """The first s up to ``end`` at which a mode ends, and of which contact (-1: none)."""
    which = -1
    for c in range(mode.shape[0]):
        a = 0.0
        for i in range(1, 9):
            b = end * i / 8.0
            sticks = mode[c] == STICK
            if mode[c] == BEGIN:
                break
            if (left_of_stick(A, m, c, stick[c], b) if sticks else left_of_slip(Q, D, w, c, h, b)) > 0.0:
                a = b
                continue
            for _ in range(52):
                s = 0.5 * (a + b)
                if (left_of_stick(A, m, c, stick[c], s) if sticks else left_of_slip(Q, D, w, c, h, s)) > 0.0:
                    a = s
                else:
                    b = s
            end, which = b, c
            break
    return end, which


@numba.njit(cache=True)
def land(K, m, w, stick, mu, mode, q, v, small):
    """Contacts that hardly slip any more, and can be held, stick; the rest of their way is gone at once."""
    for c in range(mode.shape[0]):
        j = 2 * c
        r = math.hypot(v[j] - w[0], v[j + 1] - w[1])
        if mode[c] != SLIP or r >= small:
            continue
        u, a = v[j : j + 2] - w, -(K[j : j + 2] @ q)
        falls = (mu[c] - (a @ u) / max(r, 1e-300)) / m[j]
        if math.hypot(a[0], a[1]) < stick[c] and falls > 0.0:
            q[j : j + 2] += 0.5 * u * r / falls
            v[j : j + 2] = w
            mode[c] = STICK


@numba.njit(cache=True)
def state_at(Q, h, s, q, v):
    """Displacements and velocities at s."""
    for j in range(q.shape[0]):
        q[j], v[j] = 0.0, 0.0
        for k in range(Q.shape[0] - 1, -1, -1):
            q[j] = q[j] * s + Q[k, j]
            v[j] = v[j] * s + k * Q[k, j] / h if k else v[j]


@numba.njit(cache=True)
def run(K, m, w, stick, mu, q, v, end, rtol, fastest, times, out):
    """Motion at times into ``out``; returns the number of steps."""
    P, n2 = int(min(22, max(8, round(7.0 - math.log10(rtol))))), q.shape[0]
    Q, A = np.zeros((P + 1, n2)), np.zeros((P, n2))
    D, S = np.zeros((n2 // 2, 2, P)), np.zeros((n2 // 2, P))
    mode = np.full(n2 // 2, SLIP)
    top, t, h, taken, steps = max(np.abs(v).max(), math.hypot(w[0], w[1])), 0.0, 3.0 / fastest, 0, 0
    while t < end * (1.0 - 1e-13):
        land(K, m, w, stick, mu, mode, q, v, 0.01 * math.sqrt(rtol) * top)
        h = min(h, end - t)
        f = 1.0
        for _ in range(8):
            series(K, m, w, mu, mode, q, v, h, Q, A, D, S)
            error = 0.0
            for j in range(n2):
                error = max(error, P * abs(Q[P, j]) + (P - 1) * abs(Q[P - 1, j]))
            error /= 0.01 * rtol * h * top
            f = 0.95 * (error + 1e-30) ** (-1.0 / (P - 2))
            if f > 0.02:
                break
            h *= 0.1
        s, which = first_end(Q, A, D, m, w, stick, mode, h, min(f, 1.0))
        while taken < len(times) and times[taken] <= t + s * h:
            state_at(Q, h, (times[taken] - t) / h, out[taken, :n2], out[taken, n2:])
            taken += 1
        state_at(Q, h, s, q, v)
        t, steps, h = t + s * h, steps + 1, h * min(f, 2.5)
        for j in range(n2):
            top = max(top, abs(v[j]))
        for c in range(mode.shape[0]):
            mode[c] = STICK if mode[c] == STICK else SLIP
        if which >= 0 and mode[which] == STICK:
            mode[which] = BEGIN
    return steps


def least(call, count: int = 8) -> float:
    """The least time of some calls (ms)."""
    found = []
    for _ in range(count):
        begin = time.thread_time()
        call()
        found.append(time.thread_time() - begin)
    return 1e3 * min(found)


def measure(n: int, belt: float, mu_s: float, end: float) -> None:
    """Print what Taylor steps and the others take for one scene."""
    scene = in_the_plane(n, belt, mu_s)
    problem = build(scene).problem
    K = problem.linear.csr("Kx").block(slice(0, 2 * n), slice(0, 2 * n)).dense()
    m, contacts = problem.linear.csr("M").diagonal(), problem.contacts
    times = np.linspace(0.0, end, 22)[1:-1]
    true = fm.simulate(scene, t_end=end, rtol=1e-12, t_eval=np.append(0.0, times), method="radau")
    states = np.vstack([true.q, true.v])
    size = np.abs(states).max(axis=1)
    start = Start(t=0.0, q=states[: 2 * n, 0].copy(), v=states[2 * n :, 0].copy(), z=np.zeros(0))
    limits = np.abs(contacts.mu_s) * contacts.N, contacts.mu_0 * contacts.N

    def taylor(rtol: float, out: Any) -> int:
        fastest = math.sqrt(np.abs(K).sum(axis=1).max() / m.min())
        q, v = start.q.copy(), start.v.copy()
        return run(K, m, contacts.w[:2].copy(), *limits, q, v, end, rtol, fastest, times, out)

    table = []
    for rtol in 10.0 ** -np.arange(3.0, 10.6, 0.5):
        out = np.zeros((20, 4 * n))
        taylor(rtol, out)
        error = (np.abs(out.T - states[:, 1:]).max(axis=1) / size).max()
        table.append((least(lambda r=rtol: taylor(r, np.zeros((20, 4 * n))), 20), error))
    for rtol in (1e-4, 1e-6, 1e-8):
        line = [f"{n} masses, belt {belt}, {rtol:.0e}: taylor {table[int(-2 * math.log10(rtol)) - 6][0]:.2f} ms"]
        line.append(f"error {table[int(-2 * math.log10(rtol)) - 6][1]:.0e}")
        for name, method in OTHERS.items():
            sol = fm.simulate(scene, t_end=end, rtol=rtol, t_eval=times, method=method)
            error = (np.abs(np.vstack([sol.q, sol.v]) - states[:, 1:]).max(axis=1) / size).max()

            def go(t: float, method: Any = method, rtol: float = rtol) -> None:
                method.integrate(problem, start, t, tolerance=Tolerance(rtol=rtol), t_eval=np.array([t]))

            took = least(lambda go=go: go(end)) - least(lambda go=go: go(1e-6 * end))
            equal = min((ms for ms, off in table if off <= error), default=math.nan)
            line.append(f"{name} {took:.2f} ms, error {error:.0e}, {took / equal:.1f} times at equal error")
        print(*line, sep="; ", flush=True)


if __name__ == "__main__":
    for count in (1, 2, 4, 8):
        measure(count, 0.3, 0.5, 20.0)
    for count in (1, 2, 3, 4):
        measure(count, 0.05, 0.9, 60.0)
