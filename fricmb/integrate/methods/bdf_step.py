"""A BDF step in backward differences, condensed to the contacts like every implicit step here.

With gamma_k = 1 + 1/2 + ... + 1/k the formula reads

    y = psi + (h/gamma_k) y',   psi = guess - sum_j gamma_j D_j / gamma_k

(Shampine and Reichelt 1997, with kappa = 0): one stage of :mod:`~fricmb.integrate.step.stages`.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.methods.backward_differences import (
    ADAMS,
    GROWTH,
    SHARE,
    Differences,
    allowed,
    begin_at,
    best_order,
    bring_forward,
    change_order,
    count_step,
    predict,
    reject,
    rescale,
)
from fricmb.integrate.methods.bdf_stability import MAX_ORDER, BdfGuard, admissible
from fricmb.integrate.methods.bdf_transitions import meets_transition
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State, copy_state
from fricmb.integrate.output.recorder import STEP, Rows, record
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.outcomes import ACCEPTED, FAIL_LAW, HANDOVER, REJECTED
from fricmb.integrate.step.bends_without_joints import bends_in_step
from fricmb.integrate.step.force_jumps import jump_error
from fricmb.integrate.step.knots import bends_between
from fricmb.integrate.step.one_step import add_to_position, newton_tolerances, state_noise
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.slip_growth import growth, too_long
from fricmb.integrate.step.stages import solve_stages
from fricmb.integrate.step.step_control import BDF_RUNGS, ladder
from fricmb.integrate.step.step_error import grain
from fricmb.integrate.step.step_matrix import forget, prepare
from fricmb.integrate.step.weigh_forces import weigh_forces


@kernel
def solve_formula(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, past: Differences) -> bool:
    """Solve the step's equations from the prediction."""
    n = y.q.shape[0]
    st, w = one.st, one.w
    h = past.h
    beta_h = h / past.gamma[past.order]
    nonlinear = packed.elements.address.shape[0] > 0 or w.Fin.shape[1] > y.F.shape[0]
    again = nonlinear and one.fac.made[one.fac.slot] != beta_h
    if not prepare(packed, one.tab, s, one.fac, w, one.counts, beta_h, again, True):
        return False
    st.t[0] = y.t + h
    st.hA[0, 0] = beta_h
    for i in range(n):
        st.psi_q[i] = past.new[i]
        st.psi_v[i] = past.new[n + i]
        st.V[0, i] = past.guess[n + i]
    for i in range(y.z.shape[0]):
        w.psi_z[i] = past.new[2 * n + i]
        w.z[0, i] = past.guess[2 * n + i]
    for k in range(y.mode.shape[0]):
        w.N[0, k] = y.N[k]
        w.r[0, k] = 0.0
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            w.F[0, a] = y.F[a]
            w.n[0, a] = y.n[a]
            w.g[0, a] = y.g[a]
            for i in range(n):
                w.g[0, a] += packed.ports.W[i, a] * (past.guess[n + i] - y.v[i])
            w.r[0, k] += w.n[0, a] * w.g[0, a]
    part = min(1e-3, 0.02 * SHARE * h * past.unit)
    newton_tolerances(packed, acc, h, y, one.tol, one.scale, part)
    one.counts[2] += 1
    return solve_stages(packed, one.tab, s, one.fac, st, w, y.mode, one.tol, one.scale) > 0


@kernel
def scaled(
    packed: Packed, y: State, one: OneStep, acc: Accuracy, past: Differences, error: Floats, weight: float
) -> float:
    """Largest of weight * error (n_y,) by signal, against rtol and the share of the error that this step may use."""
    n = y.q.shape[0]
    h = past.h
    top_q, top_v = widest(acc.q), widest(acc.v)
    worst = 0.0
    share = allowed(acc.rtol, past)
    for i in range(n):
        size_v = max(acc.v[i], abs(past.new[n + i]), acc.floor_v[i], 1e-10 * top_v, 1e-290)
        size_v = max(size_v, grain(packed, y, one.w, acc, h, i) / share)
        size_q = max(acc.q[i], abs(past.new[i]), acc.floor_q[i], 1e-10 * top_q, h * size_v)
        worst = max(worst, abs(error[i]) / size_q, abs(error[n + i]) / size_v)
    for i in range(y.z.shape[0]):
        worst = max(worst, abs(error[2 * n + i]) / max(acc.z[i], abs(past.new[2 * n + i]), one.noise_z[i], 1e-290))
    return float(weight * worst / share)


@kernel
def accept(y: State, end: State, past: Differences) -> None:
    """Bring the differences to the end of the step and the energies with them."""
    k = past.order
    n_y = past.D.shape[1]
    n = y.q.shape[0]
    for i in range(n_y):
        bring_forward(past, i, 1)
        if i >= n:
            past.D[0, i] += past.D[1, i]
        else:
            end.q[i] = past.D[0, i]
            add_to_position(end, i, past.D[1, i] + end.low[i])
            past.D[0, i] = end.q[i]
    rates = n_y - y.rate.shape[0]
    for i in range(y.rate.shape[0]):
        gained = 0.0
        for j in range(k + 1):
            gained += ADAMS[j] * past.D[j, rates + i]
        end.work[i] = y.work[i] + past.h * gained
    count_step(past)


@kernel
def select_order(
    packed: Packed, y: State, one: OneStep, acc: Accuracy, past: Differences, guard: BdfGuard, error: float, left: float
) -> None:
    """After k + 1 equal steps: the order and step of the three candidates that goes fastest; steps stay on a ladder."""
    k = past.order
    if past.equal <= k:
        return
    lower = higher = np.inf
    if k > 1:
        lower = scaled(packed, y, one, acc, past, past.D[k], 1.0 / k)
    if k < MAX_ORDER and admissible(guard, k + 1, past.h, left):
        higher = scaled(packed, y, one, acc, past, past.D[k + 2], 1.0 / (k + 2))
    best_k, best = best_order(k, lower, error, higher)
    # a hundred steps at least: where nothing moves, no error says how fast a load changes
    step = ladder(min(best, GROWTH, 1.0 / (past.h * past.unit)), BDF_RUNGS)
    while step > 1.0 and not admissible(guard, best_k, past.h * step, left):
        step = ladder(0.99 * step, BDF_RUNGS)
    if not admissible(guard, best_k, past.h * step, left):
        best_k = 2
    change_order(past, best_k, step)


@kernel
def passes_knot(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy) -> bool:
    """Whether slip passes a knot of a law between y and ``end`` where the law bends enough to matter."""
    return bool(bends_between(packed.ports, packed.laws, s, y, end, one.felt, acc.rtol))


@block
def bdf_step(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, past: Differences, guard: BdfGuard,
    out: Rows, left: float,
) -> int:  # fmt: skip
    """One BDF step from y: ACCEPTED (y is its end), REJECTED (the history is rescaled), or HANDOVER."""
    n, nz = y.q.shape[0], y.z.shape[0]
    k = past.order
    if past.h > left or past.rejections > 3:
        return HANDOVER
    predict(past)
    copy_state(y, end)
    if not solve_formula(packed, s, y, one, acc, past):
        forget(one.fac)
        past.rejections += 2
        one.counts[1] += 1
        rescale(past, 0.5)
        return REJECTED
    for i in range(n):
        end.q[i] = past.new[i] = one.st.Q[0, i]
        end.v[i] = past.new[n + i] = one.st.V[0, i]
    for i in range(nz):
        end.z[i] = past.new[2 * n + i] = one.w.z[0, i]
    for i in range(n):
        # without a difference of large positions, whose round-off would stay in the history
        past.d[i] = past.lag[i] + one.st.hA[0, 0] * one.st.V[0, i]
    for i in range(n, 2 * n + nz):
        past.d[i] = past.new[i] - past.guess[i]
    state_noise(packed, one, acc, past.h)
    error = scaled(packed, y, one, acc, past, past.d, 1.0 / (k + 1))
    weigh_forces(packed, y, one, acc)
    error = max(error, too_long(growth(packed.ports, packed.laws, s, y, one.w, one.felt, past.h), k))
    error = max(error, jump_error(packed, s, y, y.t + past.h, end.q, end.v, acc, past.h))
    if not error <= 1.0:
        return reject(past, one.counts, error, 0.2)
    end.t = y.t + past.h
    for a in range(y.n.shape[0]):
        end.n[a] = one.w.n[0, a]
    if not complete(packed, s, end, one.w.sizes, one.w.pivots) or meets_transition(packed, s, y, end, guard):
        return HANDOVER
    if packed.ports.knots.shape[0] > 0 and passes_knot(packed, s, y, end, one, acc):
        return HANDOVER
    if packed.bends.address.shape[0] > 0 and bends_in_step(packed, s, y, end, one, acc):
        return HANDOVER
    if end.fault > 0.0:
        return FAIL_LAW
    for i in range(y.rate.shape[0]):
        past.d[2 * n + nz + i] = end.rate[i] - past.guess[2 * n + nz + i]
    accept(y, end, past)
    copy_state(end, y)
    record(out, y, STEP)
    one.counts[0] += 1
    for i in range(n):
        acc.q[i] = max(acc.q[i], abs(y.q[i]))
        acc.v[i] = max(acc.v[i], abs(y.v[i]))
    for i in range(nz):
        acc.z[i] = max(acc.z[i], abs(y.z[i]))
    select_order(packed, y, one, acc, past, guard, error, left)
    return ACCEPTED


@block
def start_history(
    packed: Packed, s: Scratch, before: State, y: State, one: OneStep, past: Differences, h: float
) -> None:
    """Differences of order up to 4 from the polynomial of the one-step step just done, from ``before`` to y."""
    tab, st, w = one.tab, one.st, one.w
    n_s = tab.c.shape[0]
    n, nz, nr = y.q.shape[0], y.z.shape[0], y.rate.shape[0]
    H = y.t - before.t
    k = min(4, n_s)
    step = min(h, H / k)
    for j in range(k + 1):
        x = 1.0 - j * step / H
        for i in range(past.D.shape[1]):
            past.D[j, i] = 0.0
        for c in range(n_s + 1):
            weight = 0.0
            for p in range(n_s, -1, -1):
                weight = weight * x + tab.basis[p, c]
            for i in range(n):
                # ways from the end of the step, free of the round-off of large positions
                for i_s in range(n_s):
                    part = st.hA[c - 1, i_s] if c > 0 else 0.0
                    past.D[j, i] += weight * (part - st.hA[n_s - 1, i_s]) * st.V[i_s, i]
                past.D[j, n + i] += weight * (before.v[i] if c == 0 else st.V[c - 1, i])
            for i in range(nz):
                past.D[j, 2 * n + i] += weight * (before.z[i] if c == 0 else w.z[c - 1, i])
            for i in range(nr):
                past.D[j, 2 * n + nz + i] += weight * (before.rate[i] if c == 0 else one.power[c - 1, i])
    for i in range(n):
        past.D[0, i] = 0.0
        past.D[0, n + i] = y.v[i]
    for i in range(1, k + 1):
        for j in range(k, i - 1, -1):
            for x in range(past.D.shape[1]):
                past.D[j, x] = past.D[j - 1, x] - past.D[j, x]
    for j in range(k + 1, 8):
        for i in range(past.D.shape[1]):
            past.D[j, i] = 0.0
    for i in range(n):
        past.D[0, i] = y.q[i]
    begin_at(past, k, step)
