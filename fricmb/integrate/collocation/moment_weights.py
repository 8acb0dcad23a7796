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
    """Plain Radau answer of v at the nodes to a force on v (s, s), into ``radau``."""
    s = run.tab.c.shape[0]
    for i in range(s):
        for l in range(s):
            run.radau[i, l] = 0.0
    for e in range(run.tab.lam.shape[0]):
        lam = run.tab.lam[e]
        x = h * lam / (1.0 + d * h * lam + w2 * h * h * lam * lam)
        for i in range(s):
            y = x * run.tab.T[i, e]
            for l in range(s):
                run.radau[i, l] += (y * run.tab.Tinv[e, l]).real


@kernel
def free_weights(run: Any, modal: bool, h: float, stiff: float, slot: int) -> None:
    """Tables of every block of the structure (that of slip) for step h, into ``slot``.

    Blocks beyond ``stiff`` (w h) take Radau's own answer throughout; terms = 0 marks them.
    """
    for j in range(run.w2.shape[1]):
        if max(math.sqrt(abs(run.w2[0, j])), abs(run.damp[0, j])) * h > stiff:
            run.terms[j] = 0
            stiff_tables(run, run.w2[0, j], run.damp[0, j], j, h, slot)
            continue
        run.terms[j] = markov(run, h, run.w2[0, j], run.damp[0, j], j, run.kappa.shape[1] - 3)
        exact_tables(run, modal, j, h, slot)


@kernel
def exact_tables(run: Any, modal: bool, j: int, h: float, slot: int) -> None:
    """The tables of one block that is not stiff: sums of moments by Markov parameters."""
    mo, kappa = run.mo, run.kappa[j]
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
        set_lanes(run.S[slot, j], at, v_free)
        set_lanes(run.IS[slot, j], at, u_free)
        set_lanes(run.Q1[slot, j], at, v_end)
        set_lanes(run.Q2[slot, j], at, u_end)
        if not modal:
            once, force = all_lanes(0.0), all_lanes(0.0)
            for m in range(run.terms[j]):
                y = h * h * h * kappa[m]
                once = once + y * lanes(mo[m + 2, s], at)
                force = force + y * lanes(mo[m + 2, end], at)
            set_lanes(run.IIS[slot, j], at, once)
            set_lanes(run.Q3[slot, j], at, force)
    if modal:
        run.IIS[slot, j, end] = 0.0
        for m in range(run.terms[j]):
            run.IIS[slot, j, end] += h * h * h * kappa[m] * mo[m + 2, s, end]


@kernel
def stiff_tables(run: Any, w2: float, d: float, j: int, h: float, slot: int) -> None:
    """The tables of one stiff block."""
    s = run.mo.shape[1] - 1
    end = s - 1
    radau_block(run, h, w2, d)
    for table in (run.S, run.IS, run.IIS, run.Q1, run.Q2, run.Q3):
        table[slot, j, :] = 0.0
    for i in range(s):
        for l in range(s):
            run.S[slot, j, i] += run.radau[i, l]
            run.IS[slot, j, i] += run.radau[i, l] * run.tab.c[l] * h
            run.Q2[slot, j, i] += h * run.tab.A[end, l] * run.radau[l, i]
        run.Q1[slot, j, i] = run.radau[end, i]
    for i in range(s):
        for l in range(s):
            run.IIS[slot, j, i] += h * run.tab.A[i, l] * run.IS[slot, j, l]
            for k in range(s):
                run.Q3[slot, j, i] += h * run.tab.A[end, l] * h * run.tab.A[l, k] * run.radau[k, i]


@kernel
def pair_moments(run: Any, modal: bool, h: float, a: int, b: int, weight: Floats) -> int:
    """Weights of the moments in output a per input b, into ``weight``; returns how many matter."""
    most = 0
    weight[:] = 0.0
    for j in range(run.w2.shape[1]):
        b1 = run.b1[b, j]
        if modal:
            gain = run.c1[a, j] * b1
            if gain != 0.0:
                kappa = run.kappa[j, : run.terms[j]]
                most = max(most, kappa.shape[0])
                for m in range(kappa.shape[0]):
                    weight[m] += gain * kappa[m]
            continue
        most = max(most, run.terms[j])
        b0 = run.b0[b, j]
        w2 = run.w2[0, j]
        for m in range(run.terms[j]):
            weight[m] += run.c1[a, j] * b1 * run.kappa[j, m]
            if m == 0:
                weight[m] += run.c0[a, j] * b0
            else:
                weight[m] += (run.c0[a, j] * b1 - run.c1[a, j] * b0 * w2) * (h * run.kappa[j, m - 1])
            if m > 1:
                weight[m] -= run.c0[a, j] * b0 * w2 * h * h * run.kappa[j, m - 2]
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
def port_weights(run: Any, modal: bool, h: float, slot: int) -> None:
    """Outputs at the nodes per node value of inputs, into ``slot`` of tk, after :func:`free_weights`."""
    size = run.tk.shape[2] * run.tk.shape[3]
    mo = run.mo.reshape(run.mo.shape[0], run.mo.shape[1] * run.mo.shape[2])
    weight = run.kappa[run.w2.shape[1]]
    for a in range(run.c1.shape[0]):
        for b in range(run.b1.shape[0]):
            out = run.tk[slot, run.b1.shape[0] * a + b].reshape(size)
            if run.linked[a, b] == 0.0:
                out[:] = 0.0
                continue
            most = pair_moments(run, modal, h, a, b, weight)
            sum_moments(mo, weight, most, out)
            for j in range(run.w2.shape[1]):
                if run.terms[j] == 0:
                    stiff_pair(run, j, a, b, h, slot)


@kernel
def stiff_pair(run: Any, j: int, a: int, b: int, h: float, slot: int) -> None:
    """Add one stiff block's plain Radau answer."""
    c0 = run.c0[a, j]
    c1 = run.c1[a, j]
    b0 = run.b0[b, j]
    b1 = run.b1[b, j]
    if (c0 == 0.0 and c1 == 0.0) or (b0 == 0.0 and b1 == 0.0):
        return
    w2 = run.w2[0, j]
    s = run.mo.shape[1] - 1
    radau_block(run, h, w2, run.damp[0, j])
    for i in range(s):
        for l in range(s):
            u = 0.0
            uu = 0.0
            for k in range(s):
                u += h * run.tab.A[i, k] * run.radau[k, l]
                for r in range(s):
                    uu += h * run.tab.A[i, k] * h * run.tab.A[k, r] * run.radau[r, l]
            value = c1 * (b1 * run.radau[i, l] - b0 * w2 * u) + c0 * (b1 * u + b0 * (h * run.tab.A[i, l] - w2 * uu))
            run.tk[slot, run.b1.shape[0] * a + b, i, l] += value
