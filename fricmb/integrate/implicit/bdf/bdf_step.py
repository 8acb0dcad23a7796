"""A BDF step: one stage of the one-step method's equations, from what the formula keeps of the past.

With gamma_k = 1 + 1/2 + ... + 1/k the formula reads y = psi + (h/gamma_k) y' (see ``formulas/backward_differences``).
Velocities, multipliers and friction forces are solved for on the level of velocities; positions and velocities are then
moved onto their constraints, and what has been moved enters the history (Eich 1993: BDF with projection keeps its
order).
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.backward_differences import (
    MAX_ORDER,
    best_order,
    bring_forward,
    change_order,
    rescale,
)
from fricmb.integrate.formulas.step_control import BDF_RUNGS, ladder
from fricmb.integrate.implicit.attempt_step import grow
from fricmb.integrate.implicit.bdf.bdf_history import Formula, put
from fricmb.integrate.implicit.bdf.bdf_stability import admissible
from fricmb.integrate.implicit.bdf.turns import GROWTH, Differences, allowed, count_step, predict, reject
from fricmb.integrate.implicit.between.between_stages import growth_of_slip, passes_bend, weigh_ports
from fricmb.integrate.implicit.between.element_bends import bend_within
from fricmb.integrate.implicit.between.force_jumps import jump_error
from fricmb.integrate.implicit.between.knots import IN_HISTORY
from fricmb.integrate.implicit.between.slip_growth import too_long
from fricmb.integrate.implicit.equations.singular_position import may_have_passed, near_singular, way_left
from fricmb.integrate.implicit.equations.slip_rows import keep_held
from fricmb.integrate.implicit.events.event_functions import has_come_to_rest, violated
from fricmb.integrate.implicit.events.load_kinks import find_kinks
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import Record, copy_state, record_step
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.one_step import (
    has_joints,
    last_stage,
    measure,
    measure_states,
    settle,
    state_noise,
)
from fricmb.integrate.implicit.stages.stage_newton import iterate_stages
from fricmb.integrate.implicit.stages.stages import Stages, factor_stages, linearise
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.outcomes import ACCEPTED, FAIL_SINGULAR, HANDOVER, REJECTED

#: Newton stops at this part of the error that a step may make.
NEWTON = 0.03
#: Shortest step, as a part of that of the one-step method: shorter ones fail by the round-off of positions over h.
LEAST = 1e-6
#: Loosest tolerance of a step: reactions follow from accelerations, which a rougher step gives the wrong sign.
LOOSEST = 1e-3
#: Roundings of a position that differences of a few of them, and its correction, may be off by.
ROUNDINGS = 16.0
#: Rate of convergence at which the Jacobian is made anew.
SLOW = 0.2


@kernel
def take(values: Floats, y: State, rate: Floats) -> None:
    """The reverse of ``put``."""
    i = 0
    for part in (y.q, y.v, y.z, rate, y.lam, y.F, y.N, y.g):
        for j in range(part.shape[0]):
            part[j] = values[i]
            i += 1


@kernel
def share_of(y: State, c: Control, past: Differences) -> float:
    """What of the error this step may make: in proportion to its length.

    With joints but for the few short steps of a start, and no less for errors that add up: reactions follow from
    accelerations, which are far rougher.
    """
    if not has_joints(y):
        return allowed(c.rtol, past)
    return float(max(min(c.rtol, LOOSEST) * min(1.0, max(past.h * past.unit, 0.01)), c.blur, 4e-15))


@kernel
def solve_formula(mech: Mech, k: Moving, y: State, end: State, c: Control, past: Differences, formula: Formula) -> bool:
    """Solve the step's equations from the prediction; ``end`` serves as the point of the Jacobian."""
    one, base = formula.one, formula.base
    h = past.h
    beta_h = h / past.gamma[past.order]
    n = y.q.shape[0]
    copy_state(y, base)
    for i in range(n):
        base.q[i] = past.new[i]
        base.v[i] = past.new[n + i]
        one.V[0, i] = past.guess[n + i]
    for i in range(y.z.shape[0]):
        base.z[i] = past.new[2 * n + i]
    base.t = y.t + h - beta_h
    measure(mech, c, y, h, one.scale)
    measure_states(c, y, h, one)
    accuracy = max(NEWTON * share_of(y, c, past), 1e-13)
    for _ in range(2):
        copy_state(y, end)
        take(past.guess, end, end.rate)
        fresh = formula.made != beta_h
        if fresh:
            end.t = y.t + h
            k.form[:] = 0
            linearise(mech, k, end, one)
            c.counts[3] += 1
            c.counts[4] += 1
            if not factor_stages(mech, one, beta_h):
                formula.made = 0.0
                return False
            formula.made = beta_h
        for part, target in ((end.v, one.V), (end.lam, one.lam), (end.F, one.F), (end.z, one.z)):
            for i in range(part.shape[0]):
                target[0, i] = part[i]
        keep_held(mech, y.mode, y.F, one.F[0])
        used = iterate_stages(mech, k, base, one, beta_h, beta_h, accuracy)
        c.counts[2] += max(used, 1)
        if used == 0 or one.found > SLOW:
            formula.made = 0.0
        if used > 0:
            state_noise(mech, k, y, one, c, h, NEWTON)
            return True
        if fresh:
            return False
    return False


@kernel
def scaled(y: State, c: Control, past: Differences, formula: Formula, error: Floats, weight: float) -> float:
    """Largest of weight * error by signal against rtol and the share of it that this step may use.

    Positions count against the way that the run has gone: they may lie anywhere, but for their round-off.
    """
    n = y.q.shape[0]
    worst = 0.0
    share = share_of(y, c, past)
    for i in range(n):
        size = max(formula.reach[i], abs(past.new[i] - formula.origin[i]), past.h * formula.one.scale[i], 1e-290)
        if not has_joints(y):
            size = max(size, ROUNDINGS * EPS * c.q[i] / share)
        worst = max(worst, abs(error[n + i]) / formula.one.scale[i], abs(error[i]) / size)
    for i in range(y.z.shape[0]):
        worst = max(worst, abs(error[2 * n + i]) / max(c.z[i], abs(past.new[2 * n + i]), c.noise_z[i], 1e-290))
    return float(weight * worst / share)


@kernel
def update(past: Differences, formula: Formula) -> None:
    """Bring the differences to the end of the step, whose correction is ``d``; it may still be handed over."""
    for i in range(past.D.shape[1]):
        bring_forward(past, i)
    count_step(past)
    for i in range(formula.reach.shape[0]):
        formula.reach[i] = max(formula.reach[i], abs(past.D[0, i] - formula.origin[i]))


@kernel
def select_order(y: State, c: Control, past: Differences, formula: Formula, error: float) -> None:
    """After k + 1 equal steps: the order and step of the three candidates that goes fastest; steps stay on a ladder.

    A shorter step, or order 2, where an oscillation would grow until the end of the run.
    """
    k, left, guard = past.order, c.span[1] - y.t, formula.guard
    if past.equal <= k:
        return
    lower = higher = np.inf
    if k > 1:
        lower = scaled(y, c, past, formula, past.D[k], 1.0 / k)
    if k < MAX_ORDER and admissible(guard, k + 1, past.h, left):
        higher = scaled(y, c, past, formula, past.D[k + 2], 1.0 / (k + 2))
    best_k, best = best_order(k, lower, error, higher, 0)
    step = ladder(min(best, GROWTH, c.longest / past.h), BDF_RUNGS)
    while step > 1.0 and not admissible(guard, best_k, past.h * step, left):
        step = ladder(0.99 * step, BDF_RUNGS)
    if not admissible(guard, best_k, past.h * step, left):
        best_k = 2
    change_order(past, best_k, step)


@kernel
def inside(st: Stages, c: Control, past: Differences) -> None:
    """Values of the formula's polynomial over the step at the nodes of the one-step method, as if it had stepped.

    With s = x - 1 in steps back from the end:  y(x) = sum_j D_j s (s+1) ... (s+j-1) / j!.
    """
    k = past.order
    st.fresh = 0
    for l in range(st.tab.c.shape[0]):
        s = st.tab.c[l] - 1.0
        i = 0
        for part in (st.Q[l], st.V[l], st.z[l], c.power[l], st.lam[l], st.F[l], st.N[l], st.g[l]):
            for a in range(part.shape[0]):
                value = past.D[0, i]
                factor = 1.0
                for j in range(1, k + 1):
                    factor *= (s + j - 1.0) / j
                    value += factor * past.D[j, i]
                part[a] = value
                i += 1


@block
def attempt_bdf_step(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, out: Watch, rec: Record,
    past: Differences, formula: Formula, left: float,
) -> int:  # fmt: skip
    """One BDF step from y: ACCEPTED (y is its end), REJECTED (the history is rescaled), HANDOVER, or FAIL_SINGULAR.

    A step at whose end, or inside which, a mode changes, friction is no longer unique or constraints depend on one
    another is left to the one-step method.
    """
    h, order = past.h, past.order
    in_vain = past.rejections > (3 if past.since > 0 else 8)
    if in_vain or not LEAST * formula.usual <= h <= left or way_left(out) <= 4.0 * h:
        return HANDOVER
    predict(past)
    if not solve_formula(mech, k, y, end, c, past, formula):
        past.rejections += 2
        c.counts[1] += 1
        rescale(past, 0.5)
        formula.made = 0.0
        return REJECTED
    one = formula.one
    copy_state(y, end)
    end.t = y.t + h
    last_stage(mech, y, end, one)
    if not settle(mech, k, w, end):
        return HANDOVER
    put(end, end.rate, past.new)
    for i in range(past.d.shape[0]):
        past.d[i] = past.new[i] - past.guess[i]
    error = scaled(y, c, past, formula, past.d, 1.0 / (order + 1))
    weigh_ports(mech, k, y, one, c, h)
    error = max(error, too_long(growth_of_slip(mech, k, y, one, h), order))
    if not error <= 1.0:
        # at the start nothing is known of the step but that of the other method
        return reject(past, c.counts, error, 0.2 if past.since > 0 else 1e-4)
    update(past, formula)
    inside(st, c, past)
    find_kinks(mech, k, y, st, out)
    passed = may_have_passed(mech, k, w, end, out, h)
    unique = margins(mech, k, w, end, out, False) > 0.0
    changes = violated(mech, k, w, out, y, end, st) >= 0 or has_come_to_rest(mech, k, out, y, end) >= 0
    if mech.port.knots.shape[0] > 0:
        changes = changes or passes_bend(mech, k, y, end, one, c)
    if mech.bends.address.shape[0] > 0:
        changes = changes or bend_within(mech, k, y, st, c, h, IN_HISTORY) < 1.0
    if mech.elements.address.shape[0] > 0:
        changes = changes or jump_error(mech, k, y, st, c, one.scale, h) > 1.0
    if passed or not unique or changes:
        return HANDOVER
    for i in range(y.work.shape[0]):
        for l in range(st.tab.c.shape[0]):
            end.work[i] += h * st.tab.b[l] * c.power[l, i]
    record_step(mech, rec, y, end, st, c, h)
    copy_state(end, y)
    c.counts[0] += 1
    c.last_h = 0.0
    grow(mech, c, out, k, y)
    if near_singular(c, out, h):
        return FAIL_SINGULAR
    select_order(y, c, past, formula, error)
    return ACCEPTED
