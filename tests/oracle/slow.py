"""The first moments of slip in two directions, where the direction of friction is 0/0."""

from __future__ import annotations

import numpy as np

from .motion import Field


def leap(field: Field, t: float, y: np.ndarray, i: int, F: np.ndarray, tau: float) -> np.ndarray:
    """The state a time ``tau`` after contact ``i`` began to slip under the force ``F`` (of all contacts).

    Where it starts with an acceleration (break-away above the friction in slip), that is kept.  Where it starts
    without, the load grows and turns: with j the rate of the relative acceleration under the force F, friction
    F - c x e tau (e across n0 = -F/|F|) leaves g'' = j - D c x e along n0, which gives x.
    """
    n, s = field.n, field.rows[i]
    Mi, D, _ = field.matrices(y[:n])

    def inside(at: float) -> float:
        return min(max(at, field.low), field.high)

    def accelerations(at: float, state: np.ndarray) -> np.ndarray:
        return Mi @ (field.given(inside(at), state[:n], state[n : 2 * n]) + field.W @ F)

    def moved(after: float) -> np.ndarray:
        state = y.copy()
        state[:n] += after * y[n : 2 * n] + 0.5 * after**2 * a0
        state[n : 2 * n] += after * a0
        return state

    a0, W = accelerations(t, y), field.W[:, s]
    start = W.T @ a0 - field.slide_rates(inside(t))[s]
    c, E = float(np.linalg.norm(F[s])), D[s, s]
    after = moved(tau)
    if np.linalg.norm(start) > 1e-7 * c * np.abs(E).max():
        return after
    delta = 1e-4
    jerk = (accelerations(t + delta, moved(delta)) - a0) / delta
    j = W.T @ jerk - (field.slide_rates(inside(t + delta))[s] - field.slide_rates(inside(t))[s]) / delta
    n0 = -F[s] / c
    across = np.array([-n0[1], n0[0]])
    x, _ = np.linalg.solve(np.column_stack([c * E @ across, n0]), j)
    dv = 0.5 * tau**2 * (jerk - Mi @ (W @ (c * x * across)))
    after[n : 2 * n] += dv
    after[:n] += dv * tau / 3.0
    return after
