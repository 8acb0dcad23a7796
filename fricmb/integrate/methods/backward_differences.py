"""The history of a BDF run: backward differences of positions, velocities, states and powers at equal steps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.csr import Csr
from fricmb.integrate.methods.bdf_stability import COLUMNS, MAX_ORDER, SPACING, growth_table
from fricmb.integrate.model.accelerations import State
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem
from fricmb.integrate.step.radau_step import OneStep


class History(NamedTuple):
    """Backward differences ``D`` (8, n_y) of y = [q, v, z, powers] at step ``h`` (1,).

    ``status`` (8,): order, steps since the last change, whether BDF is on, rejections in a row, one-step steps to wait
    for before it is tried again, the last wait, steps since its start, the last wait because it was the slower.
    ``good`` (1,) last accepted step.  ``new``, ``guess``, ``lag``, ``d`` (n_y,) values, prediction, psi without it,
    and correction of a step.  ``gamma`` (7,) sums 1 + 1/2 + ...;
    ``adams`` (7,) weights of an integral over the last step by backward differences (Adams-Moulton).  ``unit`` (1,)
    allowed local error per unit of time, relative to rtol; ``cost`` (1,) of a one-step step in BDF steps.
    ``growth`` table of :mod:`~fricmb.integrate.methods.bdf_stability`, ``omega`` and ``decay`` spectrum of the scene.
    ``over`` (n_c+1,) how fast stuck forces came nearer to their limits in the last step, and its length; ``U``, ``E``,
    ``column`` room for rescaling.
    """

    D: Floats2
    h: Floats
    status: Ints
    good: Floats
    new: Floats
    guess: Floats
    lag: Floats
    d: Floats
    gamma: Floats
    adams: Floats
    unit: Floats
    cost: Floats
    growth: Floats2
    omega: Floats
    decay: Floats
    over: Floats
    U: Floats2
    E: Floats2
    column: Floats


def history(problem: Problem, span: float, spectrum: tuple[Floats, Floats], cost: float) -> History:
    """Room for the history of a run over ``span``; spectrum: frequencies and decay rates of the structure.

    ``cost``: of a one-step step, in steps of BDF.
    """
    n_y = 2 * problem.n + problem.n_z + problem.n_c + 2
    gamma = np.concatenate([[0.0], np.cumsum(1.0 / np.arange(1, 7))])
    adams = np.array([1.0, -1 / 2, -1 / 12, -1 / 24, -19 / 720, -3 / 160, -863 / 60480])
    # a hundredth of the error is spent on a hundredth of the run, and the sum stays some 100 rtol
    unit = np.array([100.0 / max(span, 1e-300)])
    return room(
        History(
            D=np.zeros((8, n_y)),
            h=np.zeros(1),
            status=np.zeros(8, np.int64),
            good=np.zeros(1),
            new=np.zeros(n_y),
            guess=np.zeros(n_y),
            lag=np.zeros(n_y),
            d=np.zeros(n_y),
            gamma=gamma,
            adams=adams,
            unit=unit,
            cost=np.array([cost]),
            growth=growth_table(),
            omega=np.ascontiguousarray(spectrum[0], dtype=float),
            decay=np.ascontiguousarray(spectrum[1], dtype=float),
            over=np.zeros(problem.n_c + 1),
            U=np.zeros((MAX_ORDER + 1, MAX_ORDER + 1)),
            E=np.zeros((MAX_ORDER + 1, MAX_ORDER + 1)),
            column=np.zeros(8),
        )
    )


#: Structures of more degrees of freedom are not diagonalised for this.
WHOLE = 256


def spectrum(problem: Problem, structure: Structure, K: Floats, C: Floats) -> tuple[Floats, Floats]:
    """Frequencies and decay rates of M x'' + C x' + K x = 0, without friction; K and C on the structure's pattern."""
    n = problem.n
    if n > WHOLE:
        if len(problem.omega) == n:
            return problem.omega, problem.omega * problem.zeta
        # a bound: any frequency up to it may be there
        top = np.sqrt(structure.mobility.max() * np.bincount(structure.column, np.abs(K), n).max())
        return np.concatenate([[0.0], top * np.geomspace(1e-4, 1.0, 256)]), np.zeros(257)
    inverse = Csr((n, n), structure.Minv_start, structure.Minv_index, structure.Minv).dense()
    whole_K, whole_C = (Csr((n, n), structure.first, structure.column, part).dense() for part in (K, C))
    values, shapes = np.linalg.eig(inverse @ whole_K)
    try:
        damping = np.real(np.diag(np.linalg.solve(shapes, inverse @ whole_C @ shapes)))
    except np.linalg.LinAlgError:
        damping = np.zeros(len(values))
    return np.sqrt(np.maximum(values.real, 0.0)), 0.5 * np.maximum(damping, 0.0)


@kernel
def admissible(hist: History, k: int, h: float, left: float) -> bool:
    """Whether round-off in every oscillation stays small under order k at step h for the rest of the run."""
    if k < 3:
        return True
    for j in range(hist.omega.shape[0]):
        x = hist.omega[j] * h / SPACING
        i = int(min(x, COLUMNS - 1.0))
        growth = hist.growth[k, i]
        if i + 1 < COLUMNS:
            growth += (x - i) * (hist.growth[k, i + 1] - growth)
        if (growth / h - hist.decay[j]) * left > 2.0:
            return False
    return True


@kernel
def rescale(hist: History, factor: float) -> None:
    """Differences for the step ``factor`` h (Byrne and Hindmarsh 1975; as in scipy's BDF, with its R(factor) R(1))."""
    k = hist.status[0]
    for pass_ in range(2):
        target = hist.U if pass_ == 0 else hist.E
        c = factor if pass_ == 0 else 1.0
        for j in range(k + 1):
            target[0, j] = 1.0
        for i in range(1, k + 1):
            target[i, 0] = 0.0
            for j in range(1, k + 1):
                target[i, j] = target[i - 1, j] * (i - 1 - c * j) / i
    width = hist.D.shape[1]
    for y in range(width):
        for i in range(k + 1):
            value = 0.0
            for j in range(k + 1):
                value += hist.U[j, i] * hist.D[j, y]
            hist.column[i] = value
        for i in range(k + 1):
            value = 0.0
            for j in range(k + 1):
                value += hist.E[j, i] * hist.column[j]
            hist.D[i, y] = value
    hist.h[0] *= factor
    hist.status[1] = 0


@block
def start_history(
    packed: Packed, s: Scratch, before: State, y: State, one: OneStep, hist: History, h: float, address: Ints
) -> None:
    """Differences of order up to 4 from the polynomial of the one-step step just done, from ``before`` to y."""
    tab, st, w = one.tab, one.st, one.w
    n_s = tab.c.shape[0]
    n, nz, nr = y.q.shape[0], y.z.shape[0], y.rate.shape[0]
    H = y.t[0] - before.t[0]
    k = min(4, n_s)
    step = min(h, H / k)
    for j in range(k + 1):
        x = 1.0 - j * step / H
        for i in range(hist.D.shape[1]):
            hist.D[j, i] = 0.0
        for c in range(n_s + 1):
            weight = 0.0
            for p in range(n_s, -1, -1):
                weight = weight * x + tab.basis[p, c]
            for i in range(n):
                # ways from the end of the step, free of the round-off of large positions
                for i_s in range(n_s):
                    part = st.hA[c - 1, i_s] if c > 0 else 0.0
                    hist.D[j, i] += weight * (part - st.hA[n_s - 1, i_s]) * st.V[i_s, i]
                hist.D[j, n + i] += weight * (before.v[i] if c == 0 else st.V[c - 1, i])
            for i in range(nz):
                hist.D[j, 2 * n + i] += weight * (before.z[i] if c == 0 else w.z[c - 1, i])
            for i in range(nr):
                hist.D[j, 2 * n + nz + i] += weight * (before.rate[i] if c == 0 else one.power[c - 1, i])
    for i in range(n):
        hist.D[0, i] = 0.0
        hist.D[0, n + i] = y.v[i]
    for i in range(1, k + 1):
        for j in range(k, i - 1, -1):
            for x in range(hist.D.shape[1]):
                hist.D[j, x] = hist.D[j - 1, x] - hist.D[j, x]
    for j in range(k + 1, 8):
        for i in range(hist.D.shape[1]):
            hist.D[j, i] = 0.0
    for i in range(n):
        hist.D[0, i] = y.q[i]
    hist.h[0] = step
    hist.status[0] = k
    hist.status[1] = 0
    hist.status[2] = 1
    hist.status[3] = 0
    hist.status[6] = 0
