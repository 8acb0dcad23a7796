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
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, set_lanes
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
    for j in range(run.blk.shape[2]):
        if max(math.sqrt(abs(run.blk[z, W2, j])), abs(run.blk[z, DAMP, j])) * h > stiff:
            run.terms[j] = 0
            stiff_tables(run, run.blk[z, W2, j], run.blk[z, DAMP, j], j, h, slot)
            continue
        run.terms[j] = markov(run, h, run.blk[z, W2, j], run.blk[z, DAMP, j], j, run.kappa.shape[1] - 3)
        exact_tables(run, modal, j, h, slot)


@kernel
def exact_tables(run: Any, modal: bool, j: int, h: float, slot: int) -> None:
    """The tables of one block that is not stiff: sums of moments by Markov parameters."""
    mo, kappa, tb = run.mo, run.kappa[j], run.tb[slot]
    s = mo.shape[1] - 1
    end = s - 1
    for at in range(0, mo.shape[2], LANES):
        v_free, u_free, v_end, u_end = all_lanes(0.0), all_lanes(0.0), all_lanes(0.0), all_lanes(0.0)
        for m in range(run.terms[j]):
            x = h * kappa[m]
            y = h * x
            v_free = v_free + x * lanes(mo[m, s], at)
            u_free = u_free + y * lanes(mo[m + 1, s], at)
            v_end = v_end + x * lanes(mo[m, end], at)
            u_end = u_end + y * lanes(mo[m + 1, end], at)
        set_lanes(tb[S, j], at, v_free)
        set_lanes(tb[IS, j], at, u_free)
        set_lanes(tb[Q1, j], at, v_end)
        set_lanes(tb[Q2, j], at, u_end)
        if not modal:
            once, force = all_lanes(0.0), all_lanes(0.0)
            for m in range(run.terms[j]):
                y = h * h * h * kappa[m]
                once = once + y * lanes(mo[m + 2, s], at)
                force = force + y * lanes(mo[m + 2, end], at)
            set_lanes(tb[IIS, j], at, once)
            set_lanes(tb[Q3, j], at, force)
    if modal:
        tb[IIS, j, end] = 0.0
        for m in range(run.terms[j]):
            tb[IIS, j, end] += h * h * h * kappa[m] * mo[m + 2, s, end]


@kernel
def stiff_tables(run: Any, w2: float, d: float, j: int, h: float, slot: int) -> None:
    """The tables of one stiff block."""
    s = run.mo.shape[1] - 1
    end = s - 1
    radau_block(run, h, w2, d)
    for q in range(run.tb.shape[1]):
        for i in range(run.tb.shape[3]):
            run.tb[slot, q, j, i] = 0.0
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
    for m in range(most):
        weight[m] *= h
    return most


@kernel
def sum_moments(mo: Floats2, weight: Floats, most: int, out: Floats) -> None:
    """The moments (rows of ``mo``) by their weights, eight places at a time."""
    for at in range(0, out.shape[0], LANES):
        found = all_lanes(0.0)
        for m in range(most):
            found = found + weight[m] * lanes(mo[m], at)
        set_lanes(out, at, found)


@kernel
def port_weights(run: Any, z: int, modal: bool, h: float, slot: int) -> None:
    """Outputs at the nodes per node value of inputs, into ``slot`` of tk, after :func:`free_weights`."""
    size = run.tk.shape[2] * run.tk.shape[3]
    mo = run.mo.reshape(run.mo.shape[0], run.mo.shape[1] * run.mo.shape[2])
    weight = run.kappa[run.blk.shape[2]]
    for a in range(run.co.shape[1]):
        for b in range(run.ci.shape[1]):
            out = run.tk[slot, run.flags[ROWS] * a + b].reshape(size)
            if run.linked[a, b] == 0.0:
                out[:] = 0.0
                continue
            most = pair_moments(run, z, modal, h, a, b, weight)
            sum_moments(mo, weight, most, out)
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
    s = run.mo.shape[1] - 1
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
