"""A BDF step in backward differences, condensed to the contacts like every implicit step here.

With gamma_k = 1 + 1/2 + ... + 1/k the formula reads

    y = psi + (h/gamma_k) y',   psi = guess - sum_j gamma_j D_j / gamma_k

(Shampine and Reichelt 1997, with kappa = 0): one stage of :mod:`~fricmb.integrate.step.stages`.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.contact.event_location import copy_state, slip_rate
from fricmb.integrate.methods.attempt_step import ACCEPTED, FAIL_LAW, REJECTED
from fricmb.integrate.methods.backward_differences import History, admissible, rescale
from fricmb.integrate.methods.bdf_stability import MAX_ORDER
from fricmb.integrate.model.accelerations import State, complete, slip_speed
from fricmb.integrate.model.forces import Scratch, normal_force
from fricmb.integrate.model.law_values import break_away
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.output.recorder import STEP, Rows, record
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Floats, Ints
from fricmb.integrate.step.force_jumps import jump_error
from fricmb.integrate.step.radau_step import Accuracy, OneStep, add_to_position, newton_tolerances, state_noise, widest
from fricmb.integrate.step.slip_growth import too_long
from fricmb.integrate.step.stages import solve_stages
from fricmb.integrate.step.step_error import grain
from fricmb.integrate.step.step_matrix import forget, prepare

#: A step near which something changes its mode: the one-step method takes over.
HANDOVER = -1
#: Largest growth of a step: differences of old values are extrapolated, their round-off with them.
GROWTH = 3.0
#: Part of its limit by which the force of a stuck contact may change in a step.
LEAP = 0.4


@kernel
def predict(hist: History) -> None:
    """Prediction, and psi (into ``new``; ``lag``: psi without the prediction)."""
    k = hist.status[0]
    for i in range(hist.guess.shape[0]):
        guess = hist.D[0, i]
        psi = 0.0
        for j in range(1, k + 1):
            guess += hist.D[j, i]
            psi += hist.gamma[j] * hist.D[j, i]
        hist.guess[i] = guess
        hist.lag[i] = -psi / hist.gamma[k]
        hist.new[i] = guess + hist.lag[i]


@kernel
def solve_formula(
    packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, hist: History, address: Ints
) -> bool:
    """Solve the step's equations from the prediction."""
    n = y.q.shape[0]
    st, w = one.st, one.w
    h = hist.h[0]
    beta_h = h / hist.gamma[hist.status[0]]
    nonlinear = packed.elements.address.shape[0] > 0 or w.Fin.shape[1] > y.F.shape[0]
    again = nonlinear and one.fac.made[one.fac.slot[0]] != beta_h
    if not prepare(packed, one.tab, s, one.fac, w, one.counts, beta_h, again, True, address):
        return False
    st.t[0] = y.t[0] + h
    st.hA[0, 0] = beta_h
    for i in range(n):
        st.psi_q[i] = hist.new[i]
        st.psi_v[i] = hist.new[n + i]
        st.V[0, i] = hist.guess[n + i]
    for i in range(y.z.shape[0]):
        w.psi_z[i] = hist.new[2 * n + i]
        w.z[0, i] = hist.guess[2 * n + i]
    for k in range(y.mode.shape[0]):
        w.N[0, k] = y.N[k]
        w.r[0, k] = 0.0
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            w.F[0, a] = y.F[a]
            w.n[0, a] = y.n[a]
            w.g[0, a] = y.g[a]
            for i in range(n):
                w.g[0, a] += packed.ports.W[i, a] * (hist.guess[n + i] - y.v[i])
            w.r[0, k] += w.n[0, a] * w.g[0, a]
    part = min(1e-3, 0.02 * h * hist.unit[0])
    newton_tolerances(packed.ports, acc, h, y, one.tol, one.scale, part)
    one.counts[2] += 1
    return solve_stages(packed, one.tab, s, one.fac, st, w, y.mode, one.tol, one.scale, address) > 0


@kernel
def scaled(packed: Packed, y: State, one: OneStep, acc: Accuracy, hist: History, error: Floats, weight: float) -> float:
    """Largest of weight * error (n_y,) by signal, against rtol and the share of the error that this step may use."""
    n = y.q.shape[0]
    h = hist.h[0]
    top_q, top_v = widest(acc.q), widest(acc.v)
    worst = 0.0
    share = max(acc.rtol[0] * min(1.0, h * hist.unit[0]), 4e-15)
    for i in range(n):
        size_v = max(acc.v[i], abs(hist.new[n + i]), acc.floor_v[i], 1e-10 * top_v, 1e-290)
        size_v = max(size_v, grain(packed, y, one.w, acc, h, i) / share)
        size_q = max(acc.q[i], abs(hist.new[i]), acc.floor_q[i], 1e-10 * top_q, h * size_v)
        worst = max(worst, abs(error[i]) / size_q, abs(error[n + i]) / size_v)
    for i in range(y.z.shape[0]):
        worst = max(worst, abs(error[2 * n + i]) / max(acc.z[i], abs(hist.new[2 * n + i]), one.noise_z[i], 1e-290))
    return float(weight * worst / share)


@kernel
def excess(packed: Packed, s: Scratch, y: State, k: int) -> float:
    """How far the force of a stuck contact is above its limit."""
    row0 = packed.ports.row[k]
    limit = break_away(packed.ports, packed.laws, k, s, y.N[k]) * y.N[k]
    return float(slip_speed(y.F, row0, packed.ports.row[k + 1] - row0) - limit)


@kernel
def note_loads(packed: Packed, s: Scratch, start: State, y: State, hist: History) -> None:
    """Keep how fast stuck forces near their limits in the one-step step from ``start`` to y, after which BDF begins."""
    h = y.t[0] - start.t[0]
    for k in range(y.mode.shape[0]):
        hist.over[k] = 0.0
        if y.mode[k] == STICK and start.mode[k] == STICK and packed.ports.law[k] != LAW_SMOOTH:
            hist.over[k] = (excess(packed, s, y, k) - excess(packed, s, start, k)) / h
    hist.over[y.mode.shape[0]] = h


@kernel
def meets_transition(packed: Packed, s: Scratch, y: State, end: State, hist: History) -> bool:
    """Whether some contact changes its mode between y and ``end``, at its end or between (by cubic interpolation)."""
    h = end.t[0] - y.t[0]
    meets = False
    for k in range(y.mode.shape[0]):
        row0 = packed.ports.row[k]
        d = packed.ports.row[k + 1] - row0
        if packed.ports.var[k] >= 0:
            N = normal_force(packed.ports, packed.normals, k, s)
            if (N < 0.0) != (y.mode[k] == OPEN):
                meets = True
        if packed.ports.law[k] == LAW_SMOOTH:
            continue
        if y.mode[k] == SLIP:
            r0, r1 = 0.0, 0.0
            for a in range(row0, row0 + d):
                r0 += y.n[a] * y.g[a]
                r1 += end.n[a] * end.g[a]
            d0, d1 = h * slip_rate(packed, y, k), h * slip_rate(packed, end, k)
            if r1 <= 0.0 or dips(r0, r1, d0, d1) < 0.0:
                meets = True
        elif y.mode[k] == STICK:
            limit = break_away(packed.ports, packed.laws, k, s, end.N[k]) * end.N[k]
            before, over = excess(packed, s, y, k), excess(packed, s, end, k)
            slope = (over - before) / h
            bend = abs(slope - hist.over[k])
            hist.over[k] = slope
            # the one-step method takes over in time: an extremum might pass the limit between two steps
            if over > 0.0 or over + h * (1.5 * max(0.0, slope) + bend) > 0.0:
                meets = True
            # or has just done so within this one: twice what the parabola through three points rises above its ends
            if max(before, over) + 0.5 * h * h * bend / (h + hist.over[y.mode.shape[0]]) > 0.0:
                meets = True
            for a in range(row0, row0 + d):
                # a load that changes so fast where nothing moves is seen by no error test
                if abs(end.F[a] - y.F[a]) > LEAP * limit:
                    meets = True
    hist.over[y.mode.shape[0]] = h
    return meets


@kernel
def dips(r0: float, r1: float, d0: float, d1: float) -> float:
    """Smallest value of the cubic with these values and slopes at 0 and 1: inside, else at an end."""
    if d0 >= 0.0 or d1 <= 0.0:
        return min(r0, r1)
    a = d0 + d1 - 2.0 * (r1 - r0)
    b = 3.0 * (r1 - r0) - 2.0 * d0 - d1
    root = b * b - 3.0 * a * d0
    if root < 0.0:
        return min(r0, r1)
    x = -d0 / (b + np.sqrt(root)) if b > 0.0 else (np.sqrt(root) - b) / (3.0 * a)
    return float(r0 + x * (d0 + x * (b + x * a)))


@kernel
def accept(y: State, end: State, hist: History) -> None:
    """Bring the differences to the end of the step and the energies with them."""
    k = hist.status[0]
    n_y = hist.D.shape[1]
    n = y.q.shape[0]
    for i in range(n_y):
        correction = hist.d[i]
        hist.D[k + 2, i] = correction - hist.D[k + 1, i]
        hist.D[k + 1, i] = correction
        for j in range(k, 0, -1):
            hist.D[j, i] += hist.D[j + 1, i]
        if i >= n:
            hist.D[0, i] += hist.D[1, i]
        else:
            end.q[i] = hist.D[0, i]
            add_to_position(end, i, hist.D[1, i] + end.low[i])
            hist.D[0, i] = end.q[i]
    rates = n_y - y.rate.shape[0]
    for i in range(y.rate.shape[0]):
        gained = 0.0
        for j in range(k + 1):
            gained += hist.adams[j] * hist.D[j, rates + i]
        end.work[i] = y.work[i] + hist.h[0] * gained
    hist.status[1] += 1
    hist.status[3] = 0
    hist.status[6] += 1
    hist.good[0] = hist.h[0]


@kernel
def select_order(
    packed: Packed, y: State, one: OneStep, acc: Accuracy, hist: History, error: float, left: float
) -> None:
    """After k + 1 equal steps: the order and step of the three candidates that goes fastest; steps stay on a ladder."""
    k = hist.status[0]
    if hist.status[1] <= k:
        return
    best_k = k
    best = 0.9 * max(error, 1e-16) ** (-1.0 / k)
    if k > 1:
        factor = 0.9 * max(scaled(packed, y, one, acc, hist, hist.D[k], 1.0 / k), 1e-16) ** (-1.0 / (k - 1))
        if factor > best:
            best_k, best = k - 1, factor
    if k < MAX_ORDER:
        higher = scaled(packed, y, one, acc, hist, hist.D[k + 2], 1.0 / (k + 2))
        factor = 0.9 * max(higher, 1e-16) ** (-1.0 / (k + 1))
        if factor > best and admissible(hist, k + 1, hist.h[0], left):
            best_k, best = k + 1, factor
    # a hundred steps at least: where nothing moves, no error says how fast a load changes
    step = ladder(min(best, GROWTH, 1.0 / (hist.h[0] * hist.unit[0])))
    while step > 1.0 and not admissible(hist, best_k, hist.h[0] * step, left):
        step = ladder(0.99 * step)
    if not admissible(hist, best_k, hist.h[0] * step, left):
        best_k = 2
    if best_k != k or step > 1.3 or step < 1.0:
        hist.status[0] = best_k
        rescale(hist, step)


@kernel
def ladder(factor: float) -> float:
    """The factor rounded down to a power of 2^(1/4)."""
    return float(2.0 ** (0.25 * np.floor(4.0 * np.log2(factor))))


@block
def bdf_step(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, hist: History, out: Rows,
    left: float, address: Ints,
) -> int:  # fmt: skip
    """One BDF step from y: ACCEPTED (y is its end), REJECTED (the history is rescaled), or HANDOVER."""
    n, nz = y.q.shape[0], y.z.shape[0]
    k = hist.status[0]
    if hist.h[0] > left or hist.status[3] > 3:
        return HANDOVER
    predict(hist)
    copy_state(y, end)
    if not solve_formula(packed, s, y, one, acc, hist, address):
        forget(one.fac)
        hist.status[3] += 2
        one.counts[1] += 1
        rescale(hist, 0.5)
        return REJECTED
    for i in range(n):
        end.q[i] = hist.new[i] = one.st.Q[0, i]
        end.v[i] = hist.new[n + i] = one.st.V[0, i]
    for i in range(nz):
        end.z[i] = hist.new[2 * n + i] = one.w.z[0, i]
    for i in range(n):
        # without a difference of large positions, whose round-off would stay in the history
        hist.d[i] = hist.lag[i] + one.st.hA[0, 0] * one.st.V[0, i]
    for i in range(n, 2 * n + nz):
        hist.d[i] = hist.new[i] - hist.guess[i]
    state_noise(packed, one, acc, hist.h[0])
    error = scaled(packed, y, one, acc, hist, hist.d, 1.0 / (k + 1))
    error = max(error, too_long(packed, s, y, one, hist.h[0], k))
    error = max(error, jump_error(packed, s, y, y.t[0] + hist.h[0], end.q, end.v, acc, hist.h[0]))
    if not error <= 1.0:
        hist.status[3] += 1
        one.counts[1] += 1
        if not error < np.inf:
            return HANDOVER
        rescale(hist, ladder(max(0.2, 0.9 * error ** (-1.0 / k))))
        return REJECTED
    end.t[0] = y.t[0] + hist.h[0]
    for a in range(y.n.shape[0]):
        end.n[a] = one.w.n[0, a]
    if not complete(packed, s, end, one.w.sizes, one.w.pivots, address) or meets_transition(packed, s, y, end, hist):
        return HANDOVER
    if end.fault[0] > 0.0:
        return FAIL_LAW
    for i in range(y.rate.shape[0]):
        hist.d[2 * n + nz + i] = end.rate[i] - hist.guess[2 * n + nz + i]
    accept(y, end, hist)
    copy_state(end, y)
    record(out, y, STEP)
    one.counts[0] += 1
    for i in range(n):
        acc.q[i] = max(acc.q[i], abs(y.q[i]))
        acc.v[i] = max(acc.v[i], abs(y.v[i]))
    for i in range(nz):
        acc.z[i] = max(acc.z[i], abs(y.z[i]))
    select_order(packed, y, one, acc, hist, error, left)
    return ACCEPTED
