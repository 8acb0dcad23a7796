"""After the equations of an exact step are solved: its error, the state at its end, what is kept of it."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.block_motion import two_sum
from fricmb.integrate.collocation.motion_in_step import is_stiff, stiff_nodes
from fricmb.integrate.collocation.powers_in_step import node_powers, powers_on_motion
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.recorder import Rows
from fricmb.integrate.problem import LAW_SMOOTH, SLIP, STICK
from fricmb.integrate.step.event_functions import force_noise
from fricmb.integrate.step.force_jumps import jump_error
from fricmb.integrate.step.one_step import update_port_scales
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, widest
from fricmb.integrate.step.slip_growth import growth, too_long
from fricmb.integrate.step.step_control import or_reached
from fricmb.integrate.step.step_error import state_error, unseen_by_nodes
from fricmb.integrate.step.weigh_forces import weigh_forces

#: Part of its largest value that the last coefficient of r, N or |F|^2 may have: they are searched for zeros.
SMOOTH = 0.03


@kernel
def input_error(one: OneStep) -> float:
    """Largest weighed tail of the polynomials of all inputs."""
    ex = one.exact
    worst = 0.0
    for c in range(ex.b1.shape[0]):
        if ex.weight[c] == 0.0:
            continue
        last = 0.0
        before = 0.0
        largest = 0.0
        for x in range(ex.P.shape[1]):
            last += ex.tails[0, x] * ex.P[c, x]
            before += ex.tails[1, x] * ex.P[c, x]
            largest = max(largest, abs(ex.P[c, x]))
        worst = max(worst, ex.weight[c] * (max(abs(last), 0.2 * abs(before)) - 1e-15 * largest))
    return worst


@kernel
def rough(one: OneStep, first: float, least: float) -> float:
    """Tail of the polynomial through ``first`` and ``one.margin``, in units of what a search for zeros can bear."""
    tab = one.tab
    tail = tab.top[0, 0] * first
    largest = max(abs(first), least)
    for j in range(tab.c.shape[0]):
        tail += tab.top[0, j + 1] * one.margin[j]
        largest = max(largest, abs(one.margin[j]))
    return abs(tail) / (SMOOTH * largest) if largest > 0.0 else 0.0


@kernel
def search_error(packed: Packed, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Whether slip speeds, normal forces and stuck forces are smooth enough in the step to be searched for zeros."""
    w = one.w
    n_s = w.F.shape[0]
    top = widest(acc.v)
    worst = 0.0
    for k in range(y.mode.shape[0]):
        if packed.ports.var[k] >= 0:
            for j in range(n_s):
                one.margin[j] = one.N[j, k]
            worst = max(worst, rough(one, one.N[0, k], packed.ports.N0[k]))
        if packed.ports.law[k] == LAW_SMOOTH:
            continue
        if y.mode[k] == SLIP:
            for j in range(n_s):
                one.margin[j] = w.r[j, k]
            worst = max(worst, rough(one, magnitude(packed.ports.row, k, y.g), max(1e-9 * acc.r[k], 1e-11 * top)))
        elif y.mode[k] == STICK:
            for j in range(n_s):
                one.margin[j] = magnitude(packed.ports.row, k, w.F[j]) ** 2
            limit = abs(packed.ports.mu_s[k]) * y.N[k]
            noise = 100.0 * force_noise(packed, y, k, h) * max(limit, magnitude(packed.ports.row, k, y.F))
            worst = max(worst, rough(one, magnitude(packed.ports.row, k, y.F) ** 2, limit * limit + noise))
    return worst


@kernel
def visible(y: State, one: OneStep, acc: Accuracy, j: int, h: float) -> float:
    """Largest velocity per unit of block j, each by its own scale."""
    ex = one.exact
    top = widest(acc.v)
    most = 0.0
    rate = max(math.sqrt(abs(ex.w2[0, j])), abs(ex.damp[0, j]))
    for i in range(ex.moves[0, j], ex.moves[1, j]):
        size = abs(ex.v_v[i, j])
        size += abs(ex.v_u[i, j]) / max(rate, 1e-290)
        if size > 0.0:
            scale = max(acc.v[i], abs(y.v[i]), abs(y.a[i]) * h, acc.floor_v[i], 1e-10 * top, 1e-290)
            scale = or_reached(scale, y.v[i] + ex.end[1, i])
            most = max(most, size / scale)
    return most


@kernel
def stiff_error(y: State, one: OneStep, acc: Accuracy, h: float, tol: float) -> float:
    """Error of blocks that take Radau's answer; sets the longest step at which blocks that ring stay exact."""
    ex = one.exact
    ex.cap = np.inf
    if 5.0 * h * ex.fastest <= ex.stiff_at:
        return 0.0
    n_s = ex.P.shape[1]
    worst = 0.0
    gain = np.empty((2, n_s + 1))
    for j in range(ex.w2.shape[1]):
        rate = max(math.sqrt(abs(ex.w2[0, j])), abs(ex.damp[0, j]))
        if 5.0 * h * rate <= ex.stiff_at:
            continue
        seen = visible(y, one, acc, j, h)
        swing = 0.0
        for i in range(ex.moves[0, j], ex.moves[1, j]):
            swing += ex.start_1[j, i] * y.a[i]
        if abs(swing) / rate * seen > 0.1 * tol and ex.stiff_at > 0.0:
            ex.cap = min(ex.cap, ex.stiff_at / rate)
        if is_stiff(ex, j, h):
            stiff_nodes(ex, ex.P, j, h, gain)
            tail = 0.0
            for i in range(n_s + 1):
                tail += one.tab.top[0, i] * gain[1, i]
            worst = max(worst, seen * abs(tail))
    return worst


@block
def exact_error(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Error of the step just solved in units of the tolerance (stands in for :func:`step_error`)."""
    tol = one.exact.safety * acc.rtol
    error = max(input_error(one), stiff_error(y, one, acc, h, tol)) / tol
    off = state_error(packed, y, one, acc, h)
    weigh_forces(packed, y, one, acc)
    off = max(off, unseen_by_nodes(packed, s, y, one, acc, h))
    too_far = too_long(growth(packed.ports, packed.laws, s, y, one.w, one.felt, h), one.tab.c.shape[0])
    error = max(error, off / acc.rtol, too_far)
    end = one.exact.end
    error = max(error, jump_error(packed, s, y, y.t + h, y.q + end[0], y.v + end[1], acc, h))
    return float(max(error, search_error(packed, y, one, acc, h)))


@block
def exact_finish(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """Put the end of the step into y, with forces and accelerations (stands in for :func:`finish`)."""
    ex, w = one.exact, one.w
    n = y.q.shape[0]
    last = w.F.shape[0] - 1
    for i in range(n):
        y.q[i], ex.low[1, i] = two_sum(y.q[i], ex.low[0, i], ex.end[0, i])
        y.v[i] += ex.end[1, i]
    y.t, ex.low[1, n] = two_sum(y.t, ex.low[0, n], h)
    for a in range(y.z.shape[0]):
        y.z[a] = w.z[last, a]
    for a in range(y.n.shape[0]):
        y.n[a] = w.n[last, a]
    done = complete(packed, s, y, w.sizes, w.pivots)
    for k in range(y.mode.shape[0]):
        if y.mode[k] == SLIP:
            # found as a gain over the step: of small slip speeds the difference of velocities knows less
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                y.g[a] = w.g[last, a]
    return done


@kernel
def drift(packed: Packed, one: OneStep, end: State, i: int) -> float:
    """Size of what velocity i has of the relative velocities of contacts that stick, which ought to be 0."""
    value = 0.0
    for k in range(end.mode.shape[0]):
        if end.mode[k] == STICK:
            for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                value += abs(one.exact.MB[a, i] * end.g[a]) / max(packed.ports.D[a, a], 1e-290)
    return value


@kernel
def scales_of_step(packed: Packed, y: State, end: State, one: OneStep, acc: Accuracy) -> None:
    """Running maxima over an accepted step: by what drifts in stick, between its nodes, nothing has moved."""
    for i in range(y.q.shape[0]):
        acc.q[i] = max(acc.q[i], abs(y.q[i]), abs(end.q[i]))
        acc.v[i] = max(acc.v[i], abs(y.v[i]))
        if abs(end.v[i]) > 2.0 * drift(packed, one, end, i):
            acc.v[i] = max(acc.v[i], abs(end.v[i]))
    update_port_scales(packed, one, acc)


@block
def exact_record(packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, out: Rows) -> None:
    """Keep the step's inputs beside the row of its end, which comes next (stands in for :func:`record_inside`).

    Behind the row proper: h, inputs P (n_in s), states z (s n_z), powers (s (n_c + 2)).  A transition may have been
    located elsewhere on this motion: then the step's end is not that of h, and powers are those up to its end.
    """
    ex, w = one.exact, one.w
    n_s = w.F.shape[0]
    n = y.q.shape[0]
    width = y.rate.shape[0]
    h = ex.length
    span = (end.t - y.t) + (ex.low[1, n] - ex.low[0, n])
    scales_of_step(packed, y, end, one, acc)
    row = out.values[out.used[0]]
    at = 1 + 3 * n + 2 * y.z.shape[0] + y.F.shape[0] + y.mode.shape[0] + 2 * width
    row[at] = h
    at += 1
    for c in range(ex.P.shape[0]):
        for x in range(n_s):
            row[at] = ex.P[c, x]
            at += 1
    for x in range(n_s):
        for a in range(y.z.shape[0]):
            row[at] = w.z[x, a]
            at += 1
    if abs(span - h) > 1e-12 * h:
        # located within the step or just behind it
        powers_on_motion(packed, s, y, one, h, span, False, one.power)
    else:
        node_powers(packed, s, y, one, h)
    for i in range(width):
        end.work[i] = y.work[i]
        for x in range(n_s):
            row[at + x * width + i] = one.power[x, i]
            end.work[i] += span * ex.tab.b[x] * one.power[x, i]
    for i in range(n + 1):
        ex.low[0, i] = ex.low[1, i]
