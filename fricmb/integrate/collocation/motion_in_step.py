"""Motion inside a step of exact structure: Taylor series of its blocks under the polynomials of all inputs."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.block_motion import MOST, terms_under_polynomials, under_polynomials
from fricmb.integrate.collocation.moment_weights import radau_block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.step.exact_structure import Exact


@kernel
def is_stiff(ex: Exact, j: int, h: float) -> bool:
    """Whether block j takes Radau's own answer in a step h."""
    return bool(max(math.sqrt(abs(ex.w2[0, j])), abs(ex.damp[0, j])) * h > ex.stiff_at)


@kernel
def block_input(by: Floats2, P: Floats2, j: int, i: int) -> float:
    """Input of block j at node i, on u (``by``: b0) or v (b1)."""
    value = 0.0
    for c in range(by.shape[0]):
        value += by[c, j] * P[c, i]
    return value


@kernel
def stiff_nodes(ex: Exact, P: Floats2, j: int, h: float, gain: Floats2) -> None:
    """Gains of u and v of a stiff block at the nodes, as Radau IIA finds them, into gain (2, s+1) from place 1 on."""
    n_s = P.shape[1]
    w2 = ex.w2[0, j]
    radau_block(ex, h, w2, ex.damp[0, j])
    for i in range(n_s):
        value = 0.0
        for x in range(n_s):
            push = ex.a0[j] + ex.k0[j] * ex.tab.c[x] * h + block_input(ex.b1, P, j, x)
            for k in range(n_s):
                push -= w2 * h * ex.tab.A[x, k] * block_input(ex.b0, P, j, k)
            value += ex.radau[i, x] * push
        gain[1, i + 1] = value
    for i in range(n_s):
        value = ex.tab.c[i] * h * ex.v0[j]
        for x in range(n_s):
            value += h * ex.tab.A[i, x] * (gain[1, x + 1] + block_input(ex.b0, P, j, x))
        gain[0, i + 1] = value
    gain[0, 0] = 0.0
    gain[1, 0] = 0.0


@kernel
def input_series(ex: Exact, P: Floats2, h: float, series: Floats2, gain: Floats2) -> None:
    """Monomial coefficients (in tau/h) of block inputs on u and v (rows j, b + j); of gains where a block is stiff."""
    n_s = P.shape[1]
    b = ex.w2.shape[1]
    for j in range(b):
        if is_stiff(ex, j, h):
            stiff_nodes(ex, P, j, h, gain)
            for r in range(n_s + 1):
                for place in range(2):
                    value = 0.0
                    for x in range(1, n_s + 1):
                        value += ex.tab.basis[r, x] * gain[place, x]
                    series[place * b + j, r] = value
            continue
        for place in range(2):
            if place == 0 and ex.modal == 1:
                for r in range(n_s):
                    series[j, r] = 0.0
                continue
            for i in range(n_s):
                gain[place, i] = block_input(ex.b0 if place == 0 else ex.b1, P, j, i)
            # from the last value on: what is constant leaves no round-off in the other coefficients
            last = gain[place, n_s - 1]
            for r in range(n_s):
                value = last if r == 0 else 0.0
                for x in range(n_s - 1):
                    value += ex.monomial[r, x] * (gain[place, x] - last)
                series[place * b + j, r] = value


@kernel
def block_gain(ex: Exact, j: int, h: float, tau: float, series: Floats2, terms: Floats2) -> tuple[float, float]:
    """Gains of u and v of block j at tau; ``terms`` for :func:`under_polynomials`."""
    b = ex.w2.shape[1]
    n_s = series.shape[1] - 1
    if is_stiff(ex, j, h):
        du, dv = 0.0, 0.0
        for r in range(n_s, -1, -1):
            du = du * (tau / h) + series[j, r]
            dv = dv * (tau / h) + series[b + j, r]
        return du, dv
    first, second = series[j, :n_s], series[b + j, :n_s]
    return under_polynomials(ex.w2[0, j], ex.damp[0, j], ex.v0[j], ex.a0[j], 0.0, h, tau, first, second, terms)


@kernel
def gains_at(ex: Exact, h: float, tau: float, series: Floats2, dq: Floats, dv: Floats) -> None:
    """Gains of positions and velocities at tau after the start of the step, after :func:`input_series`."""
    modal = ex.modal == 1
    b = ex.w2.shape[1]
    terms, gain = np.empty((2, MOST + 1)), np.empty((2, b))
    for j in range(b):
        gain[0, j], gain[1, j] = block_gain(ex, j, h, tau, series, terms)
    for i in range(dq.shape[0]):
        dq[i], dv[i] = 0.0, 0.0
        for j in range(ex.moved_by[0, i], ex.moved_by[1, i]):
            u, v = gain[0, j], gain[1, j]
            dq[i] += ex.q_u[i, j] * u
            dv[i] += ex.v_v[i, j] * v
            if not modal:
                dq[i] += ex.q_v[i, j] * v
                dv[i] += ex.v_u[i, j] * u


@kernel
def block_at_nodes(ex: Exact, j: int, h: float, span: float, series: Floats2, terms: Floats2, gain: Floats2) -> None:
    """Gains of u and v of block j into ``gain`` (2, s), at the nodes of a step of length ``span``."""
    n_s = gain.shape[1]
    u, v, c = gain[0], gain[1], ex.tab.c[:n_s]
    if is_stiff(ex, j, h):
        for i in range(n_s):
            u[i], v[i] = block_gain(ex, j, h, c[i] * span, series, terms)
        return
    first, second = series[j, :n_s], series[ex.w2.shape[1] + j, :n_s]
    count = terms_under_polynomials(
        ex.w2[0, j], ex.damp[0, j], ex.v0[j], ex.a0[j], 0.0, h, span, first, second,
        terms[0], terms[1],
    )  # fmt: skip
    u[:] = 0.0
    v[:] = 0.0
    # a term of order q + 1 at the part c of the way is c^(q + 1) of what it is at the end
    for q in range(count - 1, -1, -1):
        x, y = terms[0, q], terms[1, q]
        for i in range(n_s):
            u[i] = (u[i] + x) * c[i]
            v[i] = (v[i] + y) * c[i]


@kernel
def gains_at_nodes(ex: Exact, h: float, span: float, series: Floats2, dq: Floats2, dv: Floats2) -> None:
    """Gains (s, n) of positions and velocities at the nodes of a step of length ``span`` on the motion of the step h.

    :func:`gains_at` at all nodes side by side.
    """
    n_s = series.shape[1] - 1
    modal = ex.modal == 1
    terms, gain = np.empty((2, MOST + 1)), np.empty((2, n_s))
    dq[:, :] = 0.0
    dv[:, :] = 0.0
    for j in range(ex.w2.shape[1]):
        block_at_nodes(ex, j, h, span, series, terms, gain)
        for a in range(ex.moves[0, j], ex.moves[1, j]):
            q_u, v_v = ex.q_u[a, j], ex.v_v[a, j]
            if q_u == 0.0 and v_v == 0.0 and modal:
                continue
            q_v, v_u = ex.q_v[a, j], ex.v_u[a, j]
            for i in range(n_s):
                dq[i, a] += q_u * gain[0, i] + q_v * gain[1, i]
                dv[i, a] += v_v * gain[1, i] + v_u * gain[0, i]
