"""Transfer weights of a step size: the structure's answer to its own motion and to polynomial port forces.

A block is left alone with S (answer of v to a unit acceleration), IS and IIS (its integrals):
``v = v0 + a0 S + k0 IS``, ``u = u0 + v0 t + a0 IS + k0 IIS`` with a0 the acceleration at the start and k0 = f' - w2 v0;
so constant and linear loads cost nothing and increments are never differences of large numbers.

``run`` is the room of a run of one contact or that of any ports (:class:`Run`, :class:`Exact`): both name these arrays
alike.
"""

from __future__ import annotations

import math
from typing import Any

from fricmb.integrate.collocation.layout import (
    B0,
    B1,
    C0,
    C1,
    DAMP,
    IIS,
    INVERSE,
    IS,
    LAM,
    NODE,
    Q1,
    Q2,
    Q3,
    RADAU,
    ROWS,
    TABLEAU,
    VECTOR,
    VECTORS,
    W2,
    S,
)  # fmt: skip
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats, Floats2


@kernel
def markov(run: Any, h: float, w2: float, d: float, j: int, most: int) -> int:
    """Markov parameters of a block in units of h, into kappa; returns how many matter."""
    z2 = w2 * h * h
    delta = d * h
    size = max(math.sqrt(abs(z2)), abs(delta))
    run.kappa[j, 0] = 1.0
    run.kappa[j, 1] = -delta
    terms = 2
    bound = size
    while terms < most and bound > 1e-17:
        run.kappa[j, terms] = -delta * run.kappa[j, terms - 1] - z2 * run.kappa[j, terms - 2]
        bound *= size / terms
        terms += 1
    return terms


@kernel
def radau_block(run: Any, h: float, w2: float, d: float) -> None:
    """Plain Radau answer of v at the nodes to a force on v (s, s), into wk[RADAU]."""
    s = run.cx.shape[2]
    for i in range(s):
        for l in range(s):
            run.wk[RADAU, i, l] = 0.0
    for e in range(run.cx.shape[1]):
        lam = run.cx[LAM, e, 0]
        x = h * lam / (1.0 + d * h * lam + w2 * h * h * lam * lam)
        for i in range(s):
            y = x * run.cx[VECTOR, e, i]
            for l in range(s):
                run.wk[RADAU, i, l] += (y * run.cx[INVERSE, e, l]).real


@kernel
def free_weights(run: Any, z: int, modal: bool, h: float, stiff: float, slot: int) -> None:
    """Tables of every block of structure z for step h, into ``slot`` of tb.

    Blocks beyond ``stiff`` (w h) take Radau's own answer throughout; terms = 0 marks them.
    """
    s = run.mo.shape[2]
    end = s - 1
    for j in range(run.blk.shape[2]):
        for q in range(6):
            for i in range(s):
                run.tb[slot, q, j, i] = 0.0
        if max(math.sqrt(abs(run.blk[z, W2, j])), abs(run.blk[z, DAMP, j])) * h > stiff:
            run.terms[j] = 0
            stiff_tables(run, run.blk[z, W2, j], run.blk[z, DAMP, j], j, h, slot)
            continue
        n = markov(run, h, run.blk[z, W2, j], run.blk[z, DAMP, j], j, run.kappa.shape[1] - 3)
        run.terms[j] = n
        for m in range(n):
            x = h * run.kappa[j, m]
            y = h * x
            for i in range(s):
                run.tb[slot, S, j, i] += x * run.mo[m, s, i]
                run.tb[slot, IS, j, i] += y * run.mo[m + 1, s, i]
                run.tb[slot, Q1, j, i] += x * run.mo[m, end, i]
                run.tb[slot, Q2, j, i] += y * run.mo[m + 1, end, i]
            run.tb[slot, IIS, j, end] += h * y * run.mo[m + 2, s, end]
            if not modal:
                for i in range(s):
                    run.tb[slot, IIS, j, i] += h * y * run.mo[m + 2, s, i]
                    run.tb[slot, Q3, j, i] += h * y * run.mo[m + 2, end, i]
                run.tb[slot, IIS, j, end] -= h * y * run.mo[m + 2, s, end]


@kernel
def stiff_tables(run: Any, w2: float, d: float, j: int, h: float, slot: int) -> None:
    """The tables of one stiff block."""
    s = run.mo.shape[2]
    end = s - 1
    radau_block(run, h, w2, d)
    for i in range(s):
        for l in range(s):
            run.tb[slot, S, j, i] += run.wk[RADAU, i, l]
            run.tb[slot, IS, j, i] += run.wk[RADAU, i, l] * run.nd[VECTORS, NODE, l] * h
            run.tb[slot, Q2, j, i] += h * run.nd[TABLEAU, end, l] * run.wk[RADAU, l, i]
        run.tb[slot, Q1, j, i] = run.wk[RADAU, end, i]
    for i in range(s):
        for l in range(s):
            run.tb[slot, IIS, j, i] += h * run.nd[TABLEAU, i, l] * run.tb[slot, IS, j, l]
            for k in range(s):
                run.tb[slot, Q3, j, i] += h * run.nd[TABLEAU, end, l] * h * run.nd[TABLEAU, l, k] * run.wk[RADAU, k, i]


@kernel
def pair_moments(run: Any, z: int, modal: bool, h: float, a: int, b: int, weight: Floats) -> int:
    """Weights of the moments in output a per input b, into ``weight``; returns how many matter."""
    co, ci = run.co, run.ci
    most = 0
    weight[:] = 0.0
    for j in range(run.blk.shape[2]):
        b1 = ci[B1, b, j]
        if modal:
            gain = co[C1, a, j] * b1
            if gain != 0.0:
                kappa = run.kappa[j, : run.terms[j]]
                most = max(most, kappa.shape[0])
                for m in range(kappa.shape[0]):
                    weight[m] += gain * kappa[m]
            continue
        most = max(most, run.terms[j])
        b0 = ci[B0, b, j]
        w2 = run.blk[z, W2, j]
        for m in range(run.terms[j]):
            weight[m] += co[C1, a, j] * b1 * run.kappa[j, m]
            if m == 0:
                weight[m] += co[C0, a, j] * b0
            else:
                weight[m] += (co[C0, a, j] * b1 - co[C1, a, j] * b0 * w2) * (h * run.kappa[j, m - 1])
            if m > 1:
                weight[m] -= co[C0, a, j] * b0 * w2 * h * h * run.kappa[j, m - 2]
    return most


@kernel
def sum_moments(mo: Floats2, weight: Floats, most: int, h: float, out: Floats) -> None:
    """Add the moments (rows of ``mo``) by their weights, four at a time: what is summed is loaded and kept less often.

    The order of the sum is that of the moments.
    """
    n = out.shape[0]
    m = 0
    while m + 4 <= most:
        y0, y1, y2, y3 = h * weight[m], h * weight[m + 1], h * weight[m + 2], h * weight[m + 3]
        m0, m1, m2, m3 = mo[m, :n], mo[m + 1, :n], mo[m + 2, :n], mo[m + 3, :n]
        for x in range(n):
            out[x] = (((out[x] + y0 * m0[x]) + y1 * m1[x]) + y2 * m2[x]) + y3 * m3[x]
        m += 4
    while m < most:
        y = h * weight[m]
        line = mo[m, :n]
        for x in range(n):
            out[x] += y * line[x]
        m += 1


@kernel
def port_weights(run: Any, z: int, modal: bool, h: float, slot: int) -> None:
    """Outputs at the nodes per node value of inputs, into ``slot`` of tk, after :func:`free_weights`."""
    s = run.mo.shape[2]
    mo = run.mo.reshape(run.mo.shape[0], (s + 1) * s)
    weight = run.kappa[run.blk.shape[2]]
    for a in range(run.co.shape[1]):
        for b in range(run.ci.shape[1]):
            out = run.tk[slot, run.flags[ROWS] * a + b].reshape(s * s)
            out[:] = 0.0
            if run.linked[a, b] == 0.0:
                continue
            most = pair_moments(run, z, modal, h, a, b, weight)
            sum_moments(mo, weight, most, h, out)
            for j in range(run.blk.shape[2]):
                if run.terms[j] == 0:
                    stiff_pair(run, z, j, a, b, h, slot)


@kernel
def stiff_pair(run: Any, z: int, j: int, a: int, b: int, h: float, slot: int) -> None:
    """Add one stiff block's plain Radau answer."""
    nd = run.nd
    wk = run.wk
    c0 = run.co[C0, a, j]
    c1 = run.co[C1, a, j]
    b0 = run.ci[B0, b, j]
    b1 = run.ci[B1, b, j]
    if (c0 == 0.0 and c1 == 0.0) or (b0 == 0.0 and b1 == 0.0):
        return
    w2 = run.blk[z, W2, j]
    s = run.mo.shape[2]
    radau_block(run, h, w2, run.blk[z, DAMP, j])
    for i in range(s):
        for l in range(s):
            u = 0.0
            uu = 0.0
            for k in range(s):
                u += h * nd[TABLEAU, i, k] * wk[RADAU, k, l]
                for r in range(s):
                    uu += h * nd[TABLEAU, i, k] * h * nd[TABLEAU, k, r] * wk[RADAU, r, l]
            value = c1 * (b1 * wk[RADAU, i, l] - b0 * w2 * u) + c0 * (b1 * u + b0 * (h * nd[TABLEAU, i, l] - w2 * uu))
            run.tk[slot, run.flags[ROWS] * a + b, i, l] += value
