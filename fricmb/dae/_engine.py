"""The stepper with its memory, and its service from Python: residual, Jacobians, factors, solution."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.dae import _layout as L
from fricmb.dae._consistent import Start
from fricmb.dae._function import Residual
from fricmb.dae._matrix import Matrix
from fricmb.dae._stepper import EARLY_GROWTH, advance
from fricmb.integrate.problem import Floats


class Record:
    """Accepted points, in arrays that grow: ``t`` (m,), ``y``, ``yp`` (m, n), ``order`` (m,) of the step that ended."""

    def __init__(self, n: int) -> None:
        self.size = 0
        self.t = np.empty(64)
        self.y = np.empty((64, n))
        self.yp = np.empty((64, n))
        self.order = np.zeros(64, dtype=np.int64)

    def reserve(self, more: int) -> None:
        """Make space for ``more`` points."""
        need = self.size + more
        if need <= len(self.t):
            return
        size = max(need, 2 * len(self.t))
        for name in ("t", "y", "yp", "order"):
            old = getattr(self, name)
            new = np.zeros((size, *old.shape[1:]), dtype=old.dtype)
            new[: self.size] = old[: self.size]
            setattr(self, name, new)

    def add(self, t: float, y: Floats, yp: Floats, order: int) -> None:
        """Append a point."""
        self.reserve(1)
        self.t[self.size], self.y[self.size], self.yp[self.size], self.order[self.size] = t, y, yp, order
        self.size += 1

    def forget(self, keep: int) -> None:
        """Drop all but the last ``keep`` points."""
        first = max(0, self.size - keep)
        for name in ("t", "y", "yp", "order"):
            values = getattr(self, name)
            values[: self.size - first] = values[first : self.size].copy()
        self.size -= first


class System:
    """The problem as the solver sees it, with its tolerances."""

    def __init__(self, residual: Residual, jacobian: Any, matrix: Matrix, rtol: Floats, atol: Floats) -> None:
        self.function, self.jacobian, self.matrix = residual, jacobian, matrix
        self.rtol, self.atol = rtol, atol
        self.direction = 1.0
        self.evaluations = 0
        self.factorisations = 0
        self.jacobians = 0

    def residual(self, t: float, y: Floats, yp: Floats, out: Floats) -> bool:
        """Evaluate F; False if it is not finite."""
        self.evaluations += 1
        return self.function(t, y, yp, out)

    def weight(self, y: Floats) -> Floats:
        """What turns a change of y into units of its tolerance."""
        return np.asarray(1.0 / (self.atol + self.rtol * np.abs(y)))


class Engine:
    """The stepper, served by Python."""

    chunk = 1

    def __init__(self, system: System, max_order: int, max_step: float, t_end: float) -> None:
        self.system = system
        self.step = L.stepper(len(system.rtol), max_order, max_step, t_end)

    def start(self, t: float, start: Start, h: float) -> None:
        """Begin at t, or begin again, with order 1 and step h."""
        s = self.step
        s.t, s.h, s.growth = t, float(np.copysign(min(abs(h), s.longest), h)), EARLY_GROWTH
        s.order = s.first = s.at_start = 1
        s.equal = s.fresh = s.error_fails = s.newton_fails = 0
        s.made = 0.0
        s.D[:] = 0.0
        s.D[0], s.D[1] = start.y, s.h * start.yp
        s.rate[:] = start.yp

    def run(self, record: Record) -> int:
        """Make a step (or some) and record it: ACCEPTED, FINISHED, or the code of the failure."""
        served = L.SERVED
        s, step = self.system, self.step
        while True:
            request = advance(step, s.rtol, s.atol, served)
            if request < 0:
                return int(request)
            if request == L.ACCEPTED:
                record.add(step.t, step.D[0], step.rate, step.order_used)
                return L.FINISHED if step.t == step.t_end else L.ACCEPTED
            served = self.serve(request)

    def serve(self, request: int) -> int:
        """Do what the stepper asked for."""
        s, step = self.system, self.step
        t, y, yp, delta = float(step.now[0]), step.y, step.yp, step.delta
        if not s.residual(t, y, yp, delta):
            return L.NONFINITE
        doubtful = step.newton_fails >= 2 and not (s.jacobian.exact or s.jacobian.central)
        s.jacobian.central |= bool(doubtful)
        if request == L.JACOBIAN or (request == L.FACTOR and doubtful):
            s.jacobians += 1
            if not s.jacobian.evaluate(t, y, yp, delta, step.c, step.h):
                return L.NONFINITE
        if request in (L.FACTOR, L.JACOBIAN):
            s.factorisations += 1
            if not s.matrix.factor(step.c):
                return L.SINGULAR
        s.matrix.solve(delta)
        return L.SERVED

    def counts(self) -> dict[str, int]:
        """Counters of the run."""
        s = self.system
        return {
            "nfev": s.evaluations + s.jacobian.calls,
            "njev": s.jacobians,
            "nlu": s.factorisations,
            "nsteps": self.step.steps,
            "nrejected": self.step.rejected,
        }


def first_step(start: Start, weight: Floats, span: float) -> float:
    """A step whose first-order error is well inside the tolerance, from the second derivatives where they are known."""

    def norm(x: Floats) -> float:
        return float(np.sqrt(np.mean((x * weight) ** 2)))

    speed = norm(start.yp)
    careful = 0.5 / speed if speed > 0.0 else np.inf
    h = min(1e-3 * span, careful)
    if start.ypp is not None:
        bend = norm(start.ypp)
        h = min(1e-2 * span, 100.0 * careful, np.sqrt(0.5 / bend) if bend > 0.0 else np.inf)
    return max(h, 1e-14 * span)
