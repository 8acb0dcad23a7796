"""Transitions located on the motion within a step of exact structure, without solving another step.

Between the nodes the structure moves in closed form under the polynomials of the forces, and does so beyond the last
node, too.  A root found there is the transition itself where forces are polynomials (constant friction in one
dimension) or where it is so near to the end of the step that what the polynomials miss does not matter; else it says
how long the next step should be.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.block_motion import between_nodes, two_sum
from fricmb.integrate.collocation.finish_step import input_error, stiff_error
from fricmb.integrate.collocation.motion_in_step import gains_at, input_series
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import complete, slip_rate
from fricmb.integrate.model.forces import Scratch, belt_velocity, set_time
from fricmb.integrate.model.law_values import along, point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State, copy_state
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, SLIP, Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.crossing import evaluate, polynomial
from fricmb.integrate.step.event_functions import BY_EITHER, margin
from fricmb.integrate.step.one_step import finish
from fricmb.integrate.step.one_step_room import Accuracy, OneStep
from fricmb.integrate.step.step_error import state_error

#: Growth of a polynomial's error behind the last node, by the part of the step: s (s + 1) / 2 for its last coefficient.
GROWTH = 36.0
#: Error of a velocity, by its own scale, that is round-off; part of the tolerance that a transition may take.
ROUND_OFF, PART = 1e-13, 1e-2
#: How far a polynomial through the nodes may miss the start of the step, by its last coefficients.
TAIL = 4.0
#: Round-off of a polynomial by its powers, relative to how much it changes.
GRAIN = 1e-11
#: Part of a first guess by which the second one differs, to see which way to go.
OFFSET = 1e-3


@kernel
def unit_directions(packed: Packed, end: State) -> None:
    """Make the directions of slip of length 1."""
    row = packed.ports.row
    for k in range(end.mode.shape[0]):
        if end.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH:
            point_along(row, k, end.n, 1.0, end.n)


@kernel
def move_to(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, h: float, tau: float, series: Floats2,
    gain: Floats2,
) -> bool:  # fmt: skip
    """Put the state at tau of the step h just solved into ``end``.

    ``gain`` (4, n + m): space to work in; in the last two rows the gains at h.
    """
    ex, w, ports = one.exact, one.w, packed.ports
    n, m = y.q.shape[0], y.g.shape[0]
    copy_state(y, end)
    # counted from the step's end, which is known without the round-off of powers of tau
    gains_at(ex, h, tau, series, gain[0, :n], gain[1, :n])
    for i in range(n):
        gain[0, i] = ex.end[0, i] + (gain[0, i] - gain[2, i])
        gain[1, i] = ex.end[1, i] + (gain[1, i] - gain[3, i])
        end.q[i], ex.low[1, i] = two_sum(y.q[i], ex.low[0, i], gain[0, i])
        end.v[i] += gain[1, i]
    end.t, ex.low[1, n] = two_sum(y.t, ex.low[0, n], tau)
    for a in range(y.z.shape[0]):
        for j in range(w.z.shape[0]):
            one.margin[j] = w.z[j, a]
        polynomial(one.tab, y.z[a], one.margin, one.series)
        end.z[a] = evaluate(one.series, tau / h)[0]
    for a in range(m):
        end.n[a] = between_nodes(ex.monomial, w.n[:, a], tau / h)
    unit_directions(packed, end)
    set_time(packed.signals, s, y.t, n)
    for a in range(m):
        gain[0, n + a] = belt_velocity(ports, s, n, a)
    done = complete(packed, s, end, w.sizes, w.pivots)
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
def distance(packed: Packed, s: Scratch, y: State, end: State, k: int, beyond: float, found: Floats) -> float:
    """Distance of contact k from its transition at ``end``; see :func:`margin`."""
    return float(margin(packed, s, y, end, along(packed.ports.row, k, end.n, end.g), k, beyond, found))


@kernel
def exact_as_its_tolerance(packed: Packed, y: State, k: int) -> bool:
    """Whether forces are more than constants, so that the run is no more exact than its tolerance.

    Not where slip in the plane ends: direction and speed at the end decide whether it does, or turns round.
    """
    ports = packed.ports
    if y.mode[k] == SLIP and ports.row[k + 1] - ports.row[k] == 2:
        return False
    for c in range(ports.law.shape[0]):
        if ports.law[c] != LAW_CONSTANT or ports.var[c] >= 0 or ports.row[c + 1] - ports.row[c] == 2:
            return True
    return bool(packed.elements.address.shape[0] > 0)


@kernel
def may_stay(packed: Packed, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, tau: float) -> bool:
    """Whether tau is so near to the end of the step h, or forces so smooth, that the step need not be solved anew.

    Forces at ``end``, the state there, must be those of the polynomials: slip that ends passes through what a law has
    near rest.  So must those at the start: where all nodes lie behind the end of slip, laws are constant at them.
    """
    ex, ports = one.exact, packed.ports
    beyond = abs(tau - h) / h
    error = input_error(one) + state_error(packed, y, one, acc, h)
    error += stiff_error(y, one, acc, h, ex.safety * acc.rtol)
    off = 0.0
    for a in range(y.F.shape[0]):
        off = max(off, ex.weight[a] * abs(end.F[a] - between_nodes(ex.monomial, one.w.F[:, a], tau / h)))
    missed = 0.0
    for k in range(y.mode.shape[0]):
        if y.mode[k] == SLIP and ports.law[k] != LAW_SMOOTH:
            for a in range(ports.row[k], ports.row[k + 1]):
                miss = abs(y.F[a] - between_nodes(ex.monomial, one.w.F[:, a], 0.0)) - 1e-15 * abs(y.F[a])
                missed = max(missed, ex.weight[a] * miss - TAIL * error)
    noise = 0.0
    last = ex.P.shape[1] - 1
    for c in range(ex.P.shape[0]):
        for x in range(last):
            noise = max(noise, ex.weight[c] * abs(ex.P[c, x] - ex.P[c, last]))
    allowed = ROUND_OFF + (PART * acc.rtol if exact_as_its_tolerance(packed, y, k) else 0.0)
    left = min(1.0, GROWTH * beyond) * error + beyond * (off + GRAIN * noise) + tau / h * missed
    return bool(left <= allowed)


@block
def exact_root(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, k: int, h: float, guess: float,
    found: Floats,
) -> float:  # fmt: skip
    """Secants on the motion within the step (stands in for :func:`root_along_step`)."""
    ex = one.exact
    n_s, n = one.w.F.shape[0], y.q.shape[0]
    series = np.empty((2 * ex.w2.shape[1], n_s + 1))
    gain = np.empty((4, n + y.g.shape[0]))
    input_series(ex, ex.P, h, series, np.empty((2, n_s + 1)))
    gains_at(ex, h, h, series, gain[2, :n], gain[3, :n])
    t_unit = EPS * max(abs(y.t), h)
    first = guess
    if not move_to(packed, s, y, end, one, h, first, series, gain):
        return np.nan
    f = distance(packed, s, y, end, k, BY_EITHER, found)
    beyond = found[1] if f < 0.0 else BY_EITHER
    second = first * (1.0 - OFFSET)
    aimed = rises = False
    if y.mode[k] == SLIP and found[1] == 0.0:
        rate = slip_rate(packed, end, k)
        aimed = rate < 0.0
        if aimed:
            second = max(0.0, first - f / rate)
    for _ in range(12):
        if first == 0.0 and f > 0.0:
            # what only rises from the start of the step has its root before that
            first = np.nan
            break
        if rises:
            # slip or contact that begins with the step, and that is no end of it
            first = np.nan
            break
        if f == 0.0 or (aimed and abs(second - first) <= 2.0 * t_unit):
            if may_stay(packed, y, end, one, acc, k, h, first):
                return -max(first, 1e-290)
            break
        if not second <= 1.5 * guess or not move_to(packed, s, y, end, one, h, second, series, gain):
            first = np.nan
            break
        after = distance(packed, s, y, end, k, beyond, found)
        beyond = found[1] if after < 0.0 else beyond
        rises = (after > f and second > first) or (after < f and second < first)
        new = max(0.0, second - after * (second - first) / (after - f)) if after != f else second
        first, f, second = second, after, new
        aimed = True
    copy_state(y, end)
    finish(packed, s, end, one, acc, h)
    return first
