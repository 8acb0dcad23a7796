"""The public solve_dae: checks its arguments, runs the stepper, collects what was asked for."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.dae import _arguments as arguments
from fricmb.dae import _layout as L
from fricmb.dae._chattering import Chattering
from fricmb.dae._consistent import Start, consistent
from fricmb.dae._engine import Record, System, first_step
from fricmb.dae._events import Events
from fricmb.dae._function import Residual
from fricmb.dae._result import DaeResult, DaeSolution, evaluate
from fricmb.errors import IntegrationError
from fricmb.integrate.formulas.backward_differences import MAX_ORDER
from fricmb.integrate.problem import Floats

_CAUSES = {
    L.FAILED_ERROR: "the error test fails at the smallest step",
    L.FAILED_NEWTON: "Newton's method does not converge at the smallest step",
    L.FAILED_NONFINITE: "fun is not finite at the smallest step",
    L.FAILED_SINGULAR: "the matrix dF/dy + c dF/dyp is singular (index above 1, or a singular point)",
}
_FINISHED = "The solver successfully reached the end of the integration interval."
_STOPPED = "A termination event occurred."


@answers
def solve_dae(
    fun: Callable[..., Any],
    t_span: Sequence[float],
    y0: Any,
    yp0: Any = None,
    *,
    rtol: Any = 1e-3,
    atol: Any = 1e-6,
    jac: Callable[..., Any] | None = None,
    jac_sparsity: Any = None,
    bandwidth: tuple[int, int] | None = None,
    t_eval: Any = None,
    events: Any = None,
    dense_output: bool = False,
    args: tuple[Any, ...] = (),
    first_step: float | None = None,
    max_step: float = np.inf,
    max_order: int = MAX_ORDER,
) -> DaeResult:
    """Solve the implicit differential-algebraic equation ``fun(t, y, yp) = 0`` of index 1 from initial values.

    Parameters
    ----------
    fun : callable
        ``fun(t, y, yp, *args)`` returns the residual (n,), or ``fun(t, y, yp, out, *args)`` (a fourth parameter named
        ``out``) writes it.  A function compiled by ``numba.njit`` is called without Python inside a step.
    t_span : (t0, t_end)
        The run; t_end may lie before t0.
    y0 : (n,)
        Initial state.  Algebraic components may be guesses: without a consistent yp0 they are solved for, and the
        differential ones are kept.
    yp0 : (n,), optional
        Initial derivative, taken as it is if consistent with y0, else as a first guess.
    rtol, atol : float or (n,)
        The error of a step in each component is kept below ``atol + rtol |y|`` (root mean square over the components).
    jac : callable, optional
        ``jac(t, y, yp, *args)`` returns the pair (dF/dy, dF/dyp), (n, n) arrays or scipy sparse.  Default: finite
        differences.
    jac_sparsity : (n, n) array or sparse, or a pair of them, optional
        Where dF/dy and dF/dyp (together, or one and the other) may be other than 0; leads to sparse factors, and to few
        evaluations for finite differences.
    bandwidth : (lband, uband), optional
        Entries outside ``-uband <= i - j <= lband`` are 0 in both Jacobians; leads to banded factors.
    t_eval : (n_t,), optional
        Times of the output.  Default: the steps.
    events : callable or list, optional
        ``event(t, y, *args)`` or ``event(t, y, yp, *args)``, whose zeros are found; attributes ``terminal`` (bool or
        the number of occurrences to stop at) and ``direction`` as in ``scipy.integrate.solve_ivp``.
    dense_output : bool
        Return ``sol``, callable with times.
    args : tuple
        Further arguments of fun, jac and events.
    first_step, max_step : float, optional
        Positive, in the unit of t.
    max_order : int
        1 to 5.  Formulas of order 3 and above are unstable for lightly damped oscillation.

    Returns
    -------
    DaeResult
        t (n_t,); y, yp (n, n_t); sol (:class:`DaeSolution` or None); t_events, y_events, yp_events (lists, or None);
        nfev (all evaluations of fun, those for Jacobians included), njev, nlu, nsteps, nrejected, nrestarts; status
        (0 end reached, 1 terminal event, -1 failed), message, success.

    Raises
    ------
    ArgumentError
        An argument that is not accepted.
    IntegrationError
        No consistent initial values: singular, of index above 1, not finite, or without a solution nearby.

    Notes
    -----
    Backward differentiation formulas of order 1 to 5 with variable step, by backward differences at equal steps,
    which go over to another step by interpolation. A jump of an algebraic component (an input that jumps) is
    stepped over by solving for consistent values again after it. Where fun jumps and drives y towards the jump from
    both sides, no solution goes on: the run ends with a message that names the component.
    """
    t0, t_end = arguments.span(t_span)
    y_start, yp_start = arguments.state(y0, yp0)
    n = len(y_start)
    tolerances = arguments.tolerances(rtol, atol, n)
    extra = arguments.extra(args)
    times = arguments.times(t_eval, t0, t_end)
    residual = Residual(fun, extra, n)
    residual.first(t0, y_start, np.zeros(n) if yp_start is None else yp_start)
    system = arguments.system(residual, jac, jac_sparsity, bandwidth, extra, tolerances, (t0, y_start, yp_start))
    system.direction = 1.0 if t_end >= t0 else -1.0
    limits = (arguments.order(max_order), arguments.step(max_step, "max_step"))
    step = None if first_step is None else arguments.first(first_step, abs(t_end - t0))
    run = _Run(system, t0, t_end, limits, step, times, Events(events, extra), dense_output)
    with np.errstate(all="ignore"):  # what is not finite, in a trial of Newton's method as well, is looked for
        run.begin(y_start, yp_start)
        run.go()
    return run.result()


class _Run:
    """One integration: the engine, what was recorded, what comes out."""

    def __init__(
        self,
        system: System,
        t0: float,
        t_end: float,
        limits: tuple[int, float],
        step: float | None,
        times: Floats | None,
        events: Events,
        dense: bool,
    ) -> None:
        self.system, self.t0, self.t_end, self.step = system, t0, t_end, step
        self.times, self.events, self.dense = times, events, dense
        n = len(system.rtol)
        chunk = 16 if events.all else max(16, min(4096, 1_000_000 // n))
        self.engine = arguments.engine(system, limits, t_end, chunk)
        self.record = Record(n)
        self.chattering = Chattering(n, t0, t_end)
        self.samples: list[tuple[Floats, Floats]] = []
        self.sampled = 0
        self.end: float | None = None  # where a terminal event stopped the run
        self.status, self.message = 0, _FINISHED
        self.restarts, self.last_restart = 0, (0, t0)

    def begin(self, y0: Floats, yp0: Floats | None) -> None:
        """Consistent values and the first step size."""
        span = abs(self.t_end - self.t0)
        start = consistent(self.system, self.t0, y0, yp0, max(span, 1e-300))
        self.record.add(self.t0, start.y, start.yp, 0)
        self._set_off(self.t0, start, self.step)
        self.events.start(self.record)
        if self.times is not None:
            self.sampled = int(
                np.searchsorted(self.system.direction * self.times, self.system.direction * self.t0, "right")
            )
            if self.sampled:
                self.samples.append((np.tile(start.y, (self.sampled, 1)), np.tile(start.yp, (self.sampled, 1))))

    def _set_off(self, t: float, start: Start, h: float | None) -> None:
        span = abs(self.t_end - t)
        if h is None:
            h = first_step(start, self.system.weight(start.y), span)
        self.engine.start(t, start, self.system.direction * h)

    def go(self) -> None:
        """Run to the end, a terminal event or a failure."""
        while self.end is None and self.record.t[self.record.size - 1] != self.t_end:
            before = self.record.size
            code = self.engine.run(self.record)
            chatters = self.chattering.look(self.record, before, self.system.atol, self.system.rtol)
            stop = self.events.look(self.record, before) if self.events.all else None
            if stop is not None:
                self.record.size = stop[0] + 1
                self.end, self.status, self.message = stop[1], 1, _STOPPED
            elif code < 0 and not self._restart(code):
                self.status, self.message = -1, self._failure(code)
                self._sample()
                return
            elif chatters:
                self.status, self.message = -1, chatters
                self._sample()
                return
            self._sample()

    def _failure(self, code: int) -> str:
        t = self.record.t[self.record.size - 1]
        h = abs(self.engine.step.h)
        return f"The step size became too small at t = {t:.10g} (h = {h:.2g}): {_CAUSES[code]}."

    def _restart(self, code: int) -> bool:
        """Solve for consistent values just after the last point and begin again there; False if that is no way out."""
        steps, t = self.engine.step.steps, float(self.record.t[self.record.size - 1])
        attempt = abs(self.engine.step.h)
        tiny = max(64.0 * float(np.spacing(max(abs(t), attempt))), 2.0 * attempt)
        if code not in (L.FAILED_ERROR, L.FAILED_NEWTON) or abs(self.t_end - t) < 1e3 * tiny:
            return False
        if self.restarts and (steps - self.last_restart[0] < 5 or abs(t - self.last_restart[1]) < 1e4 * tiny):
            return False
        after = t + self.system.direction * tiny
        last = self.record.size - 1
        try:
            start = consistent(
                self.system, after, self.record.y[last], self.record.yp[last], abs(self.t_end - t), trust=False
            )
        except IntegrationError:
            return False
        self.restarts += 1
        self.last_restart = (steps, after)
        self.record.add(after, start.y, start.yp, 1)
        self._set_off(after, start, None)
        return True

    def _sample(self) -> None:
        """Output at the times that the recorded steps have passed; drop what nothing needs any more."""
        if self.times is None:
            return
        record, sign = self.record, self.system.direction
        last = record.t[record.size - 1] if self.end is None else self.end
        upto = int(np.searchsorted(sign * self.times, sign * last, "right"))
        if upto > self.sampled:
            part = slice(0, record.size)
            wanted = self.times[self.sampled : upto]
            self.samples.append(evaluate(record.t[part], record.y[part], record.order[part], wanted, sign > 0))
            self.sampled = upto
        if not self.dense:
            record.forget(MAX_ORDER + 1)

    def result(self) -> DaeResult:
        """What the user gets."""
        record = self.record
        t, y, yp = (x[: record.size].copy() for x in (record.t, record.y, record.yp))
        orders = record.order[: record.size].copy()
        solution = DaeSolution(t.copy(), y.copy(), orders, self.end) if self.dense else None
        if self.times is not None:
            t = self.times[: self.sampled].copy()
            y = np.concatenate([s[0] for s in self.samples] or [y[:0]])
            yp = np.concatenate([s[1] for s in self.samples] or [yp[:0]])
        elif self.end is not None:
            value, rate = evaluate(t, y, orders, np.array([self.end]), self.system.direction > 0)
            t[-1], y[-1], yp[-1] = self.end, value[0], rate[0]
        found = self.events.all
        values = {
            "t": t,
            "y": np.ascontiguousarray(y.T),
            "yp": np.ascontiguousarray(yp.T),
            "sol": solution,
            "t_events": [np.array(e.t) for e in found] if found else None,
            "y_events": [np.array(e.y) for e in found] if found else None,
            "yp_events": [np.array(e.yp) for e in found] if found else None,
            **self.engine.counts(),
            "nrestarts": self.restarts,
            "status": self.status,
            "message": self.message,
            "success": self.status >= 0,
        }
        return DaeResult(values)
