"""The first moments of slip in several directions, where the direction of friction is 0/0."""

from __future__ import annotations

import numpy as np

from .motion import Field


def leap(field: Field, t: float, y: np.ndarray, i: int, F: np.ndarray, tau: float) -> np.ndarray:
    """The state a time ``tau`` after contact ``i`` began to slip under the force ``F`` (of all contacts).

    Where it starts with an acceleration (break-away above the friction in slip), that is kept.  Where it starts
    without, the load grows and turns: with j the rate of the relative acceleration under the force F, friction
    F - c e tau (e across n0 = -F/|F|) leaves g'' = j - D c e along n0, which gives e.
    """
    n, s = field.n, field.rows[i]
    Mi, D, _, W = field.matrices(y[:n])
    W = W[:, s]

    def inside(at: float) -> float:
        return min(max(at, field.low), field.high)

    def accelerations(at: float, state: np.ndarray) -> np.ndarray:
        inverse, _, _, rows = field.matrices(state[:n])
        return inverse @ (field.given(inside(at), state[:n], state[n : 2 * n]) + rows @ F)

    def moved(after: float) -> np.ndarray:
        state = y.copy()
        state[:n] += after * y[n : 2 * n] + 0.5 * after**2 * a0
        state[n : 2 * n] += after * a0
        return state

    a0 = accelerations(t, y)
    start = field.speed_up(inside(t), y, a0)[s]
    c, E = float(np.linalg.norm(F[s])), D[s, s]
    after = moved(tau)
    if np.linalg.norm(start) > 1e-7 * c * np.abs(E).max():
        return after
    delta = 1e-4
    later = moved(delta)
    a1 = accelerations(t + delta, later)
    jerk = (a1 - a0) / delta
    j = (field.speed_up(inside(t + delta), later, a1)[s] - start) / delta
    n0 = -F[s] / c
    across = np.linalg.svd(n0[None, :])[2][1:].T
    e = across @ np.linalg.solve(np.column_stack([c * E @ across, n0]), j)[:-1]
    dv = 0.5 * tau**2 * (jerk - Mi @ (W @ (c * e)))
    after[n : 2 * n] += dv
    after[:n] += dv * tau / 3.0
    return after
