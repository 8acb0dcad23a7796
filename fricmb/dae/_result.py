"""What solve_dae returns: the result and its dense output."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.optimize import OptimizeResult

from fricmb.errors import ArgumentError
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.problem import Floats


@entry
def interpolate(ts: Any, ys: Any, orders: Any, times: Any, steps: Any, out: Any, rate: Any) -> None:
    """Value and derivative at ``times[m]`` of the polynomial through the points of step ``steps[m]`` and before.

    Step s ends in point s + 1 and was made with order ``orders[s + 1]``; its polynomial goes through that point and as
    many before it.
    """
    n = ys.shape[1]
    for m in range(len(times)):
        t = times[m]
        last = steps[m] + 1
        count = orders[last] + 1
        for i in range(n):
            out[m, i] = 0.0
            rate[m, i] = 0.0
        for a in range(count):
            ta = ts[last - a]
            weight, slope = 1.0, 0.0
            for b in range(count):
                if b != a:
                    span = ta - ts[last - b]
                    slope = (slope * (t - ts[last - b]) + weight) / span
                    weight *= (t - ts[last - b]) / span
            for i in range(n):
                out[m, i] += weight * ys[last - a, i]
                # a constant has no slope: differences to the last point keep round-off small
                rate[m, i] += slope * (ys[last - a, i] - ys[last, i])


class DaeSolution:
    """Dense output of the whole run: the polynomial of each step, of the order it was made with.

    Call it with a time or an array of times (n_t,): the state (n,) or (n, n_t).  Times outside the run are extrapolated
    from its ends, as scipy does.

    Attributes
    ----------
    ts : (n_steps + 1,)
        Ends of the steps.
    t_min, t_max : float
        The run.
    """

    def __init__(self, ts: Floats, ys: Floats, orders: Any, end: float | None = None) -> None:
        self._nodes, self._ys, self._orders = ts, ys, orders
        self.ts = ts.copy()
        if end is not None:  # the last step goes beyond the end of the run
            self.ts[-1] = end
        self.t_min, self.t_max = float(min(self.ts[0], self.ts[-1])), float(max(self.ts[0], self.ts[-1]))
        self._forward = bool(ts[-1] >= ts[0])

    def __call__(self, t: Any) -> Floats:
        """State at t."""
        return self._both(t)[0]

    def derivative(self, t: Any) -> Floats:
        """Derivative of the state at t, shaped like the state."""
        return self._both(t)[1]

    def _both(self, t: Any) -> tuple[Floats, Floats]:
        times = np.ascontiguousarray(np.atleast_1d(np.asarray(t, dtype=float)))
        if times.ndim > 1:
            raise ArgumentError("`t` must be a number or a 1-D array.")
        value, rate = evaluate(self._nodes, self._ys, self._orders, times, self._forward)
        if np.ndim(t) == 0:
            return value[0], rate[0]
        return value.T, rate.T


def evaluate(ts: Floats, ys: Floats, orders: Any, times: Floats, forward: bool) -> tuple[Floats, Floats]:
    """States and derivatives (n_t, n) at ``times``; at a jump (a time that occurs twice) the value after it."""
    out, rate = np.empty((len(times), ys.shape[1])), np.empty((len(times), ys.shape[1]))
    if len(ts) == 1:
        out[:], rate[:] = ys[0], 0.0
        return out, rate
    if forward:
        steps = np.searchsorted(ts, times, side="left") - 1
    else:
        steps = len(ts) - 1 - np.searchsorted(ts[::-1], times, side="right")
    steps = np.clip(steps, 0, len(ts) - 2)
    interpolate(ts, ys, orders, times, steps.astype(np.int64), out, rate)
    return out, rate


class DaeResult(OptimizeResult):
    """Result of solve_dae: a dict whose entries are attributes too, as of ``scipy.integrate.solve_ivp``."""

    def __init__(self, values: dict[str, Any]) -> None:
        super().__init__()
        self.update(values)
