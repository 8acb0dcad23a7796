"""Motion inside a step of exact structure: Taylor series of its blocks under the polynomials of all inputs."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.block_motion import MOST, terms_under_polynomials, under_polynomials
from fricmb.integrate.collocation.blocks_in_step import A0, K0, V0
from fricmb.integrate.collocation.layout import (
    B0,
    B1,
    DAMP,
    MONOMIAL,
    NODE,
    Q_U,
    Q_V,
    RADAU,
    TABLEAU,
    V_U,
    V_V,
    VECTORS,
    W2,
    WITH_START,
)
from fricmb.integrate.collocation.moment_weights import radau_block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.step.exact_structure import INPUTS, IS_MODAL, STIFF_AT, Exact


@kernel
def is_stiff(ex: Exact, j: int, h: float) -> bool:
    """Whether block j takes Radau's own answer in a step h."""
    return bool(max(math.sqrt(abs(ex.blk[0, W2, j])), abs(ex.blk[0, DAMP, j])) * h > ex.par[STIFF_AT])


@kernel
def block_input(ex: Exact, P: Floats2, place: int, j: int, i: int) -> float:
    """Input of block j at node i, on u (B0) or v (B1)."""
    value = 0.0
    for c in range(ex.flags[INPUTS]):
        value += ex.ci[place, c, j] * P[c, i]
    return value


@kernel
def stiff_nodes(ex: Exact, P: Floats2, j: int, h: float, gain: Floats2) -> None:
    """Gains of u and v of a stiff block at the nodes, as Radau IIA finds them, into gain (2, s+1) from place 1 on."""
    bs = ex.bs
    n_s = P.shape[1]
    w2 = ex.blk[0, W2, j]
    radau_block(ex, h, w2, ex.blk[0, DAMP, j])
    for i in range(n_s):
        value = 0.0
        for x in range(n_s):
            push = bs[A0, j] + bs[K0, j] * ex.nd[VECTORS, NODE, x] * h + block_input(ex, P, B1, j, x)
            for k in range(n_s):
                push -= w2 * h * ex.nd[TABLEAU, x, k] * block_input(ex, P, B0, j, k)
            value += ex.wk[RADAU, i, x] * push
        gain[1, i + 1] = value
    for i in range(n_s):
        value = ex.nd[VECTORS, NODE, i] * h * bs[V0, j]
        for x in range(n_s):
            value += h * ex.nd[TABLEAU, i, x] * (gain[1, x + 1] + block_input(ex, P, B0, j, x))
        gain[0, i + 1] = value
    gain[0, 0] = 0.0
    gain[1, 0] = 0.0


@kernel
def input_series(ex: Exact, P: Floats2, h: float, series: Floats2, gain: Floats2) -> None:
    """Monomial coefficients (in tau/h) of block inputs on u and v (rows j, b + j); of gains where a block is stiff."""
    n_s = P.shape[1]
    b = ex.blk.shape[2]
    for j in range(b):
        if is_stiff(ex, j, h):
            stiff_nodes(ex, P, j, h, gain)
            for r in range(n_s + 1):
                for place in range(2):
                    value = 0.0
                    for x in range(1, n_s + 1):
                        value += ex.nd[WITH_START, r, x] * gain[place, x]
                    series[place * b + j, r] = value
            continue
        for place in range(2):
            if place == 0 and ex.flags[IS_MODAL] == 1:
                for r in range(n_s):
                    series[j, r] = 0.0
                continue
            for i in range(n_s):
                gain[place, i] = block_input(ex, P, place, j, i)
            # from the last value on: what is constant leaves no round-off in the other coefficients
            last = gain[place, n_s - 1]
            for r in range(n_s):
                value = last if r == 0 else 0.0
                for x in range(n_s - 1):
                    value += ex.nd[MONOMIAL, r, x] * (gain[place, x] - last)
                series[place * b + j, r] = value


@kernel
def block_gain(ex: Exact, j: int, h: float, tau: float, series: Floats2, terms: Floats2) -> tuple[float, float]:
    """Gains of u and v of block j at tau; ``terms`` for :func:`under_polynomials`."""
    b = ex.blk.shape[2]
    n_s = series.shape[1] - 1
    if is_stiff(ex, j, h):
        du, dv = 0.0, 0.0
        for r in range(n_s, -1, -1):
            du = du * (tau / h) + series[j, r]
            dv = dv * (tau / h) + series[b + j, r]
        return du, dv
    first, second = series[j, :n_s], series[b + j, :n_s]
    return under_polynomials(
        ex.blk[0, W2, j], ex.blk[0, DAMP, j], ex.bs[V0, j], ex.bs[A0, j], 0.0, h, tau, first, second, terms
    )  # fmt: skip


@kernel
def gains_at(ex: Exact, h: float, tau: float, series: Floats2, dq: Floats, dv: Floats) -> None:
    """Gains of positions and velocities at tau after the start of the step, after :func:`input_series`."""
    modal = ex.flags[IS_MODAL] == 1
    terms = np.empty((2, MOST + 1))
    for i in range(dq.shape[0]):
        dq[i] = 0.0
        dv[i] = 0.0
    for j in range(ex.blk.shape[2]):
        u, v = block_gain(ex, j, h, tau, series, terms)
        for i in range(dq.shape[0]):
            dq[i] += ex.mat[Q_U, i, j] * u
            dv[i] += ex.mat[V_V, i, j] * v
        if not modal:
            for i in range(dq.shape[0]):
                dq[i] += ex.mat[Q_V, i, j] * v
                dv[i] += ex.mat[V_U, i, j] * u


@kernel
def block_at_nodes(ex: Exact, j: int, h: float, span: float, series: Floats2, terms: Floats2, gain: Floats2) -> None:
    """Gains of u and v of block j into ``gain`` (2, s), at the nodes of a step of length ``span``."""
    n_s = gain.shape[1]
    u, v, c = gain[0], gain[1], ex.nd[VECTORS, NODE, :n_s]
    if is_stiff(ex, j, h):
        for i in range(n_s):
            u[i], v[i] = block_gain(ex, j, h, c[i] * span, series, terms)
        return
    first, second = series[j, :n_s], series[ex.blk.shape[2] + j, :n_s]
    count = terms_under_polynomials(
        ex.blk[0, W2, j], ex.blk[0, DAMP, j], ex.bs[V0, j], ex.bs[A0, j], 0.0, h, span, first, second,
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
    modal = ex.flags[IS_MODAL] == 1
    terms, gain = np.empty((2, MOST + 1)), np.empty((2, n_s))
    dq[:, :] = 0.0
    dv[:, :] = 0.0
    for j in range(ex.blk.shape[2]):
        block_at_nodes(ex, j, h, span, series, terms, gain)
        for a in range(dq.shape[1]):
            q_u, v_v = ex.mat[Q_U, a, j], ex.mat[V_V, a, j]
            if q_u == 0.0 and v_v == 0.0 and modal:
                continue
            q_v, v_u = ex.mat[Q_V, a, j], ex.mat[V_U, a, j]
            for i in range(n_s):
                dq[i, a] += q_u * gain[0, i] + q_v * gain[1, i]
                dv[i, a] += v_v * gain[1, i] + v_u * gain[0, i]
