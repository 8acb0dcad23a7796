"""Prescribed signals that are linear in time: folded into the loads, so that nothing of them is left in a step."""

from __future__ import annotations

import ctypes

import numpy as np

from fricmb.integrate.problem import Floats, Problem

_Doubles = ctypes.POINTER(ctypes.c_double)
_Function = ctypes.CFUNCTYPE(None, _Doubles, _Doubles, _Doubles)


def values(problem: Problem, j: int, times: Floats) -> Floats:
    """u, u', u'' of signal j at some times: (n_t, 3)."""
    table = problem.signals.table
    function = _Function(int(table.address[j]))
    p = np.append(np.asarray(table.p[table.p_start[j] : table.p_start[j + 1]], float), 0.0)
    x, out = np.zeros(1), np.zeros(8)
    pointers = [a.ctypes.data_as(_Doubles) for a in (x, p, out)]
    result = np.empty((len(times), 3))
    for i, t in enumerate(times):
        x[0] = t
        function(*pointers)
        result[i] = out[:3]
    return result


def linear_signals(problem: Problem) -> tuple[Floats, Floats] | None:
    """(u at t = 0, u') where every signal is known to be linear in time, or None."""
    if problem.n_u == 0:
        return np.zeros(0), np.zeros(0)
    if len(problem.signals.breakpoints) or not (problem.signals.uniform.size and problem.signals.uniform.all()):
        return None
    times = np.array([0.0, 1.0, np.sqrt(2.0)])
    start, rate = np.zeros(problem.n_u), np.zeros(problem.n_u)
    for j in range(problem.n_u):
        u = values(problem, j, times)
        if u[:, 2].any() or np.ptp(u[:, 1]) != 0.0:
            return None
        start[j], rate[j] = u[0, 0], u[0, 1]
    return start, rate
