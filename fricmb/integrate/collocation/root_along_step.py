"""Transitions located on the motion within a step of exact structure, without solving another step.

Between the nodes the structure moves in closed form under the polynomials of the forces, and does so beyond the last
node, too.  A root found there is the transition itself where forces are polynomials (constant friction in one
dimension) or where it is so near to the end of the step that what the polynomials miss does not matter; else it says
how long the next step should be.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation._fundamental import two_sum
from fricmb.integrate.collocation._general_dense import gains_at, input_series
from fricmb.integrate.collocation._general_step import input_error, state_error, stiff_error
from fricmb.integrate.collocation._layout import MONOMIAL
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.contact.event_location import copy_state, slip_rate
from fricmb.integrate.model.accelerations import State, complete
from fricmb.integrate.model.forces import Scratch, belt_velocity, set_time
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, Floats, Floats2, Ints
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.crossing import evaluate, polynomial
from fricmb.integrate.step.event_functions import margin
from fricmb.integrate.step.exact_structure import SAFETY
from fricmb.integrate.step.radau_step import Accuracy, OneStep, finish

#: Growth of a polynomial's error behind the last node, by the part of the step: s (s + 1) / 2 for its last coefficient.
GROWTH = 36.0
#: Error of a velocity, by its own scale, that is round-off; part of the tolerance that a transition may take.
ROUND_OFF, PART = 1e-13, 1e-2


@kernel
def put_directions(y: State, end: State, one: OneStep, theta: float) -> None:
    """Directions of slip at theta, from their polynomials through the nodes."""
    w, nd = one.w, one.exact.nd
    n_s = w.n.shape[0]
    for a in range(end.n.shape[0]):
        value = 0.0
        for r in range(n_s - 1, -1, -1):
            c = 0.0
            for x in range(n_s):
                c += nd[MONOMIAL, r, x] * w.n[x, a]
            value = value * theta + c
        end.n[a] = value


@kernel
def unit_directions(packed: Packed, end: State) -> None:
    """Make the directions of slip of length 1."""
    row = packed.ports.row
    for k in range(end.mode.shape[0]):
        if end.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH:
            size = magnitude(row, k, end.n)
            for a in range(row[k], row[k + 1]):
                end.n[a] /= size


@kernel
def move_to(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, h: float, tau: float, series: Floats2,
    gain: Floats2, address: Ints,
) -> bool:  # fmt: skip
    """Put the state at tau of the step h just solved into ``end``; ``gain`` (2, n + m): room."""
    ex, w, ports = one.exact, one.w, packed.ports
    n, m = y.q.shape[0], y.g.shape[0]
    copy_state(y, end)
    gains_at(ex, h, tau, series, gain[0, :n], gain[1, :n])
    for i in range(n):
        end.q[i], ex.low[1, i] = two_sum(y.q[i], ex.low[0, i], gain[0, i])
        end.v[i] += gain[1, i]
    end.t[0], ex.low[1, n] = two_sum(y.t[0], ex.low[0, n], tau)
    for a in range(y.z.shape[0]):
        for j in range(w.z.shape[0]):
            one.margin[j] = w.z[j, a]
        polynomial(one.tab, y.z[a], one.margin, one.series)
        end.z[a] = evaluate(one.series, tau / h)[0]
    put_directions(y, end, one, tau / h)
    unit_directions(packed, end)
    set_time(packed.signals, s, y.t[0], n)
    for a in range(m):
        gain[0, n + a] = belt_velocity(ports, s, n, a)
    done = complete(packed, s, end, w.sizes, w.pivots, address)
    for k in range(y.mode.shape[0]):
        if y.mode[k] == SLIP:
            # as a gain over the step: of small slip speeds the difference of velocities knows less
            for a in range(ports.row[k], ports.row[k + 1]):
                value = y.g[a] - (belt_velocity(ports, s, n, a) - gain[0, n + a])
                for i in range(n):
                    value += ports.W[i, a] * gain[1, i]
                end.g[a] = value
    return done


@kernel
def distance(packed: Packed, s: Scratch, y: State, end: State, k: int, found: Floats) -> float:
    """Distance of contact k from its transition at ``end``."""
    speed = 0.0
    for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
        speed += end.n[a] * end.g[a]
    return float(margin(packed, s, y, end, speed, k, found))


@kernel
def bends(packed: Packed) -> bool:
    """Whether forces are more than constants: then the run is as exact as its tolerance."""
    ports = packed.ports
    for k in range(ports.law.shape[0]):
        if ports.law[k] != LAW_CONSTANT or ports.var[k] >= 0 or ports.row[k + 1] - ports.row[k] == 2:
            return True
    return packed.elements.address.shape[0] > 0


@kernel
def may_stay(packed: Packed, y: State, one: OneStep, acc: Accuracy, h: float, tau: float) -> bool:
    """Whether tau is so near to the end of the step h, or forces so smooth, that the step need not be solved anew."""
    beyond = abs(tau - h) / h
    error = input_error(one) + state_error(packed, y, one, acc, h)
    if error > 0.0 or beyond > 0.1:
        error += stiff_error(y, one, acc, h, one.exact.par[SAFETY] * acc.rtol[0])
    allowed = ROUND_OFF + (PART * acc.rtol[0] if bends(packed) else 0.0)
    return bool(min(1.0, GROWTH * beyond) * error <= allowed)


@block
def exact_root(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, guess: float,
    found: Floats, address: Ints,
) -> float:  # fmt: skip
    """Secants on the motion within the step (stands in for :func:`root_along_step`)."""
    ex = one.exact
    n_s, n = one.w.F.shape[0], y.q.shape[0]
    series = np.empty((2 * ex.blk.shape[2], n_s + 1))
    gain = np.empty((2, max(n_s + 1, n + y.g.shape[0])))
    input_series(ex, ex.P, h, series, gain[:, : n_s + 1].copy())
    t_unit = EPS * max(abs(y.t[0]), h)
    first = guess
    if not move_to(packed, s, y, end, one, h, first, series, gain, address):
        return np.nan
    f = distance(packed, s, y, end, k, found)
    second = first * (1.0 - 1e-6)
    if y.mode[k] == SLIP and found[1] == 0.0:
        rate = slip_rate(packed, end, k)
        second = first - f / rate if rate < 0.0 else np.nan
    for _ in range(12):
        if f == 0.0 or abs(second - first) <= 2.0 * t_unit:
            if may_stay(packed, y, one, acc, h, first):
                return -first
            break
        if not abs(second - guess) <= 0.5 * guess or not move_to(
            packed, s, y, end, one, h, second, series, gain, address
        ):
            first = np.nan
            break
        after = distance(packed, s, y, end, k, found)
        new = second - after * (second - first) / (after - f) if after != f else second
        first, f, second = second, after, new
    copy_state(y, end)
    finish(packed, s, end, one, acc, h, address)
    return first
