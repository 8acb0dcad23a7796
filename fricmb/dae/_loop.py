"""Steps without Python: the stepper served by compiled functions, with dense or banded LAPACK factors."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fricmb.dae import _differences as D
from fricmb.dae import _layout as L
from fricmb.dae._differences import differences, residual
from fricmb.dae._engine import Engine, Record, System
from fricmb.dae._foreign import Compiled, call, lapack
from fricmb.dae._layout import Stepper
from fricmb.dae._matrix import Banded, Dense
from fricmb.dae._stepper import advance
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.slices import slice_over, slicing, ticks

_ELSEWHERE, _DENSE, _BANDED = 0, 1, 2
_N, _LOWER, _UPPER, _HEIGHT, _ONE, _TRANS, _INFO = range(7)  # entries of the 32-bit integers that LAPACK reads


@kernel
def _factor(kind: int, routines: Any, c: float, dy: Any, dyp: Any, store: Any, pivots: Any, small: Any) -> bool:
    for i in range(len(store)):
        store[i] = dy[i] + c * dyp[i]
        if not math.isfinite(store[i]):
            return False
    n, info = small[_N : _N + 1], small[_INFO : _INFO + 1]
    if kind == _DENSE:
        call(routines[0], (n, n, store, n, pivots, info))
    else:
        lower, upper, height = small[_LOWER : _LOWER + 1], small[_UPPER : _UPPER + 1], small[_HEIGHT : _HEIGHT + 1]
        call(routines[2], (n, n, lower, upper, store, height, pivots, info))
    return bool(info[0] == 0)


@kernel
def _solve(kind: int, routines: Any, store: Any, pivots: Any, small: Any, right: Any) -> None:
    n, info, one = small[_N : _N + 1], small[_INFO : _INFO + 1], small[_ONE : _ONE + 1]
    trans = small[_TRANS : _TRANS + 1]
    if kind == _DENSE:
        call(routines[1], (trans, n, one, store, n, pivots, right, n, info))
    else:
        lower, upper, height = small[_LOWER : _LOWER + 1], small[_UPPER : _UPPER + 1], small[_HEIGHT : _HEIGHT + 1]
        call(routines[3], (trans, n, lower, upper, one, store, height, pivots, right, n, info))


@entry
def run(
    s: Stepper, rtol: Any, atol: Any, served: int, addresses: Any, p: Any, p_jac: Any,
    dy: Any, dyp: Any, store: Any, pivots: Any, small: Any, pattern: Any, members: Any, ends: Any,
    floor: Any, direction: Any, work: Any, flags: Any, n: Any,
    times: Any, ys: Any, yps: Any, orders: Any, size: Any,
) -> int:  # fmt: skip
    """Make and record steps until the record is full, a slice or the run is over, a step fails, or Python has to serve.

    ``addresses``: kind of matrix, fun, jac (0: finite differences, -1: elsewhere), four LAPACK routines.
    ``size``: points recorded, points at which to return.
    """
    kind, fun, jac, routines = addresses[0], addresses[1], addresses[2], addresses[3:]
    t, y, yp, delta = s.now, s.y, s.yp, s.delta
    begun = ticks()
    while True:
        request = advance(s, rtol, atol, served)
        if request < 0:
            return request
        if request == L.ACCEPTED:
            m = size[0]
            times[m] = s.t
            orders[m] = s.order_used
            for i in range(len(y)):
                ys[m, i] = s.D[0, i]
                yps[m, i] = s.rate[i]
            size[0] = m + 1
            served = L.SERVED
            if s.t == s.t_end:
                return L.FINISHED
            if m + 1 >= size[1] or slice_over(begun):
                return L.FULL
            continue
        doubtful = jac == 0 and s.newton_fails >= 2 and flags[D.CENTRAL] == 0
        if kind == _ELSEWHERE or (jac < 0 and request == L.JACOBIAN):
            return request
        s.residuals += 1
        served = L.SERVED
        if not residual(fun, t, y, yp, delta, p, n):
            served = L.NONFINITE
            continue
        if request == L.JACOBIAN or (request == L.FACTOR and doubtful):
            s.jacobians += 1
            if jac == 0:
                flags[D.CENTRAL] |= doubtful
                if not differences(
                    fun, t, y, yp, delta, p, n, s.c, s.h, rtol, atol,
                    dy, dyp, pattern, members, ends, floor, direction, work, flags,
                ):  # fmt: skip
                    served = L.NONFINITE
                    continue
            else:
                call(jac, (t, y, yp, dy, dyp, p_jac, n))
        if request != L.RESIDUAL:
            s.factors += 1
            if not _factor(kind, routines, s.c, dy, dyp, store, pivots, small):
                served = L.SINGULAR
                continue
        _solve(kind, routines, store, pivots, small, delta)


class CompiledEngine(Engine):
    """The stepper, served by compiled functions as far as they go."""

    def __init__(self, system: System, max_order: int, max_step: float, t_end: float, jac: Any, chunk: int) -> None:
        super().__init__(system, max_order, max_step, t_end)
        n = len(system.rtol)
        self.chunk = chunk
        matrix = system.matrix
        function = system.function
        self.code = Compiled(function.fun, function.args, in_place=function.in_place)
        kind = _DENSE if isinstance(matrix, Dense) else _BANDED if isinstance(matrix, Banded) else _ELSEWHERE
        self.jac = Compiled(jac, function.args, jacobian=True) if jac is not None and kind == _DENSE else None
        where = 0 if not system.jacobian.exact else self.jac.address if self.jac is not None else -1
        self.matrix: Any = matrix
        self.addresses = np.concatenate(([kind, self.code.address, where], lapack())).astype(np.int64)
        lower, upper = (matrix.lower, matrix.upper) if isinstance(matrix, Banded) else (0, 0)
        height = 2 * lower + upper + 1
        self.small = np.array([n, lower, upper, height, 1, ord("N"), 0], dtype=np.int32)
        self.pivots = np.zeros(n, dtype=np.int32)
        groups = matrix.pattern.groups
        self.members = np.concatenate(groups).astype(np.int64)
        self.ends = np.concatenate(([0], np.cumsum([len(g) for g in groups]))).astype(np.int64)
        self.work = np.zeros((D.WORK_ROWS, n))
        self.flags = np.zeros(3, dtype=np.int64)
        self.n = np.array([n], dtype=np.int64)
        self.floor = np.zeros(n)
        self.direction: Floats = getattr(system.jacobian, "direction", self.floor)
        self.served = L.SERVED

    def run(self, record: Record) -> int:
        """Make up to ``chunk`` steps."""
        record.reserve(self.chunk)
        size = np.array([record.size, record.size + self.chunk], dtype=np.int64)
        s, m = self.system, self.system.matrix
        pattern = (m.pattern.start, m.pattern.rows, m.pattern.place)
        served = L.SERVED
        while True:
            with slicing():
                request = run(
                    self.step, s.rtol, s.atol, served, self.addresses, self.code.parameters,
                    self.code.parameters if self.jac is None else self.jac.parameters,
                    m.dy, m.dyp, m.store, self.pivots, self.small, pattern, self.members, self.ends,
                    self.floor, self.direction, self.work, self.flags, self.n,
                    record.t, record.y, record.yp, record.order, size,
                )  # fmt: skip
            record.size = int(size[0])
            if request < 0 or request in (L.FULL, L.FINISHED):
                return int(request)
            served = self.serve(int(request))
            if request == L.JACOBIAN and self.addresses[0] != _ELSEWHERE:
                self.pivots = (self.matrix.pivots + 1).astype(
                    np.int32
                )  # the factors are scipy's now, who counts from 0

    def counts(self) -> dict[str, int]:
        """Counters of the run."""
        found = super().counts()
        found["nfev"] += self.step.residuals + int(self.flags[D.CALLS])
        found["njev"] += self.step.jacobians
        found["nlu"] += self.step.factors
        return found
