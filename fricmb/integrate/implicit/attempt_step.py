"""One step of the one-step method: tried, tested, cut at the first transition, taken."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.step_control import ONE_STEP_RUNGS, ONE_STEP_SAFETY, ladder, next_step, step_factor
from fricmb.integrate.implicit.between.between_stages import (
    growth_of_slip,
    knot_within,
    laws_between,
    off_near_ends,
    weigh_ports,
)
from fricmb.integrate.implicit.between.element_bends import bend_within, go_over_bend
from fricmb.integrate.implicit.between.force_jumps import jump_error
from fricmb.integrate.implicit.between.held_force import unseen_force
from fricmb.integrate.implicit.between.knots import NOWHERE, SLIGHT
from fricmb.integrate.implicit.between.load_defect import load_defect
from fricmb.integrate.implicit.between.slip_growth import too_long
from fricmb.integrate.implicit.equations.accelerations import weighed
from fricmb.integrate.implicit.equations.singular_position import (
    SUSPECTED,
    has_come_near,
    longest_towards,
    may_have_passed,
    near_singular,
)
from fricmb.integrate.implicit.equations.slip_rows import slip_speed
from fricmb.integrate.implicit.events.event_functions import has_come_to_rest, violated
from fricmb.integrate.implicit.events.event_location import goes_before_jump, last_unique, locate_trigger
from fricmb.integrate.implicit.events.load_kinks import find_kinks
from fricmb.integrate.implicit.events.triggers import kind_of, owner
from fricmb.integrate.implicit.modes.transition import change_modes
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import Record, copy_state, record_step
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import KINK, LOAD, Watch
from fricmb.integrate.implicit.stages.near_rest import nears_rest
from fricmb.integrate.implicit.stages.one_step import (
    end_step,
    error_of,
    has_joints,
    remember,
    step_to,
    takes_slopes,
    try_step,
)
from fricmb.integrate.implicit.stages.series_step import forget_inputs
from fricmb.integrate.implicit.stages.stages import Stages, bring_up_to_date
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_CONSTANT, SLIP, STICK, Codes
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.outcomes import (
    ACCEPTED,
    CHANGED,
    DONE,
    FAIL_CHATTER,
    FAIL_MARGIN,
    FAIL_SINGULAR,
    FAIL_STEP,
    REJECTED,
)

#: Shortest step, as a part of the span; near the start as a part of what the run has got on, and of the span at it.
SMALLEST, SETS_OUT, SHORTEST = 1e-14, 1e-6, 1e-40
#: Shortest step behind a change of modes, as a part of the time in which velocities change.
RESTART = 5e-4


@kernel
def shortest_step(c: Control, t: float) -> float:
    """A step from t that is as good as none.

    What begins far from the balance of its forces, as slip under a law that is steep at rest, may need far shorter ones
    at the start: of what is moving no run is so near that it would creep.
    """
    span = c.span[1] - c.span[0]
    return float(min(SMALLEST * span, SETS_OUT * (t - c.span[0]) + SHORTEST * span) + 8.0 * EPS * abs(t))


@kernel
def is_round_off(c: Control, h: float, t: float) -> bool:
    """Whether a step h from t is as good as none."""
    return bool(h <= shortest_step(c, t))


@kernel
def grow(mech: Mech, c: Control, out: Watch, k: Moving, y: State) -> None:
    """Running maxima, with a state that has been reached.

    Forces of modes that were tried and do not hold may be a thousand times larger: no measure of what is light.
    """
    k.borne_before = max(k.borne, k.borne_before)
    for i in range(y.v.shape[0]):
        c.q[i] = max(c.q[i], abs(y.q[i]))
        c.v[i] = max(c.v[i], abs(y.v[i]))
    for i in range(y.z.shape[0]):
        c.z[i] = max(c.z[i], abs(y.z[i]))
    for i in range(y.q.shape[0]):
        out.top_position = max(out.top_position, abs(y.q[i]))
    for i in range(y.F.shape[0]):
        out.top_slip = max(out.top_slip, abs(y.g[i]))
        out.top_force = max(out.top_force, abs(y.F[i]))
    for i in range(y.N.shape[0]):
        # a load that is given is a number of its own: dry friction without one has 1, in whatever unit
        given = mech.port.normal[i] == NORMAL_CONSTANT and mech.port.law[i] != LAW_SMOOTH
        load = stick_limit(mech.port, mech.port.laws, i, k.s, y.N[i]) if given else y.N[i]
        out.top_force = max(out.top_force, abs(load))
    for j in range(mech.joint.port.shape[0]):
        if mech.joint.one_sided[j]:
            out.top_force = max(out.top_force, abs(y.lam[mech.joint.row[j]]))


@kernel
def go_through(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes, j: int
) -> int:
    """Go through the transition of trigger j, or decide modes anew (-1): CHANGED, or why the run ends."""
    c.growth = np.inf
    if rec.used[0] > 0:
        rec.after[rec.used[0] - 1] = 1
    code = change_modes(mech, k, w, y, before, c, out, rec, part, j)
    return CHANGED if code == DONE else code


@kernel
def arrive(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes,
    stop: float,
) -> int:  # fmt: skip
    """At a breakpoint, or at the end of the span: modes are decided anew."""
    y.t = stop
    if stop >= c.span[1]:
        return DONE
    return go_through(mech, k, w, y, before, c, out, rec, part, -1)


@kernel
def set_restart(mech: Mech, c: Control, y: State, lets_go: bool) -> None:
    """First step behind a change of modes: at least RESTART of the time in which velocities change.

    Steps get as short as round-off on the way to rest, and Newton's changes at such ones are nothing else.  Where
    something ``lets_go`` it is at most the step that was right for that the last time.
    """
    rate = weighed(mech, y.a)
    if rate > 0.0:
        c.h = max(c.h, RESTART * min(weighed(mech, c.v) / rate, c.longest))
    if lets_go:
        c.h = min(c.h, c.setting_out)
    c.sets_out = 1 if lets_go else 0


#: What a step may grow by; part to which one is cut at least, whose error is too large; that of one that could not be
#: solved; least part of the step behind one that was taken.
GROWTH, CUT, UNSOLVED, SHRINK = 5.0, 0.2, 0.4, 0.3


@kernel
def try_again(c: Control, h: float) -> int:
    """Leave the state where it is: the step tried next is h, and those behind it grow slowly."""
    c.counts[1] += 1
    c.h = h
    c.growth = 1.0
    return REJECTED


#: Rate of convergence up to which the Jacobian of a step serves the next one.
KEPT = 0.001
#: The same where further iterations are of friction alone, and cost less than factors.
KEPT_PLAIN = 0.01


@kernel
def rung(y: State, h: float) -> float:
    """A step that comes again, and its factors with it; with joints they are made anew at every step."""
    return h if has_joints(y) else ladder(h, ONE_STEP_RUNGS)


@kernel
def may_keep(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> bool:
    """Whether the Jacobian of the step before, in the same modes, serves a step h from y.

    With joints it turns with the bodies; near rest it turns with the directions of slip.
    """
    if has_joints(y) or c.made == 0.0 or not st.found <= (KEPT_PLAIN if st.plain == 1 else KEPT):
        return False
    same = st.plain == 1 or st.turns.near == 0
    for p in range(y.mode.shape[0]):
        same = same and nears_rest(mech, k, y, p, h) == (k.form[p] == 1)
    return same


#: Halts in a row, and the part of the span below which that has brought the run on by nothing.
PILED_UP, NOTHING = 300, 1e-12


@kernel
def pile_up(c: Control, t: float) -> bool:
    """Count a halt at t; whether hundreds of them have brought the run on by nothing."""
    if c.halts == 0:
        c.first_halt = t
    c.halts += 1
    if c.halts <= PILED_UP:
        return False
    c.halts = 0
    return bool(t - c.first_halt < NOTHING * (c.span[1] - c.span[0]))


@kernel
def leaves_bend(mech: Mech, k: Moving, y: State) -> bool:
    """Whether y stood just before a bend of elements' forces, and has been carried over it."""
    return bool(mech.bends.address.shape[0] > 0 and go_over_bend(mech, k, y))


@kernel
def decide_anew(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes
) -> int:
    """Modes where no step gets any further: behind a bend, whose forces may jump by more than what rests can hold."""
    if pile_up(c, y.t):
        return FAIL_CHATTER
    c.knot = -np.inf
    return go_through(mech, k, w, y, before, c, out, rec, part, -1)


@kernel
def get_away(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes
) -> int:
    """As ``decide_anew`` where the last step was as short as round-off, which the next one need not be."""
    code = decide_anew(mech, k, w, y, before, c, out, rec, part)
    set_restart(mech, c, y, False)
    return code


#: Shortest steps within which slip ends at once where no other step can be taken; or a part of the largest slip.
SOON, NEARLY = 100.0, 1e-9


@kernel
def end_slips(
    mech: Mech, k: Moving, w: Instant, y: State, before: State, c: Control, out: Watch, rec: Record, part: Codes
) -> int:
    """Where no step can be taken: end the slips that are as good as round-off, if there are any.

    Of contacts that come to rest together, such as two points of a pad, one is left slipping a little.
    """
    shortest = shortest_step(c, y.t)
    for p in range(y.mode.shape[0]):
        if y.mode[p] == SLIP and mech.port.law[p] != LAW_SMOOTH:
            speed = magnitude(mech.port.row, p, y.g)
            slows = -slip_speed(mech.port.row, p, y.n, y.F, y.ga)
            if slows > 0.0 and speed <= max(SOON * shortest * slows, NEARLY * out.top_slip):
                out.slow = max(out.slow, speed)
    if out.slow == 0.0:
        return FAIL_STEP
    code = get_away(mech, k, w, y, before, c, out, rec, part)
    out.slow = 0.0
    return code


#: Part of a step that is nothing beside it.
IN_VAIN = 1e-6


@block
def attempt_step(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, before: State, st: Stages, c: Control, out: Watch,
    rec: Record, part: Codes, stop: float,
) -> int:  # fmt: skip
    """A step of the one-step formula from y, not beyond ``stop``: ACCEPTED, REJECTED, CHANGED, or why the run ends."""
    stages = st.tab.c.shape[0]  # the estimated error goes with this power of the step
    t = y.t
    before_knot = t < c.knot < stop
    goal = c.knot if before_knot else stop
    left = goal - t
    h = min(c.h, c.longest, longest_towards(out))
    if h >= left:
        h = left
    else:
        h = rung(y, min(h, 0.5 * left) if h > 0.5 * left else h)
    if is_round_off(c, h, t):
        if leaves_bend(mech, k, y):
            return get_away(mech, k, w, y, before, c, out, rec, part)
        code = end_slips(mech, k, w, y, before, c, out, rec, part)
        if code != FAIL_STEP:
            return code
        margins(mech, k, w, y, out, False)
        return FAIL_SINGULAR if has_come_near(out, SUSPECTED) else FAIL_STEP
    kept = may_keep(mech, k, y, st, c, h)
    if not kept:
        c.made = 0.0
    forget_inputs(st)
    solved = try_step(mech, k, y, st, c, h)
    if kept and not solved:
        c.made = 0.0
        solved = try_step(mech, k, y, st, c, h)
    if not solved:
        # forces of a step that is short beside round-off are no start for a shorter one: what is known at y is
        c.last_h = 0.0
        c.counts[5] += 1
        return try_again(c, h if takes_slopes(c, st) else UNSOLVED * h)
    bring_up_to_date(mech, k, y, st, h)
    find_kinks(mech, k, y, st, out)
    weigh_ports(mech, k, y, st, c, h)
    between = max(laws_between(mech, k, y, st, c, h), load_defect(mech, k, w, y, st, c, out, h))
    knot = NOWHERE
    if mech.port.knots.shape[0] > 0:
        between = max(between, off_near_ends(mech, k, y, st, c, h))
        knot = knot_within(mech, k, y, st, c, h)
    if mech.bends.address.shape[0] > 0:
        knot = min(knot, bend_within(mech, k, y, st, c, h, SLIGHT))
    error = max(error_of(c, y, st, h), between / asked(c))
    error = max(error, too_long(growth_of_slip(mech, k, y, st, h), stages), unseen_force(mech, k, y, st, c, h))
    if mech.elements.address.shape[0] > 0:
        error = max(error, jump_error(mech, k, y, st, c, st.scale, h))
    if not error < 1e300:
        return try_again(c, UNSOLVED * h)
    factor = step_factor(error, stages, ONE_STEP_SAFETY)
    if knot < 1.0 and (error <= 1.0 or knot < factor):
        c.knot = t + knot * h
        if not c.knot > t:
            # a bend so near that no step ends before it: asked for again it would be as near
            c.knot = -np.inf
            return decide_anew(mech, k, w, y, before, c, out, rec, part) if leaves_bend(mech, k, y) else FAIL_STEP
        return try_again(c, h)
    if error > 1.0:
        return try_again(c, h * max(CUT, factor))
    if not end_step(mech, k, w, y, end, st, c, h):
        return try_again(c, UNSOLVED * h)
    if may_have_passed(mech, k, w, end, out, h):
        return try_again(c, 0.5 * h)
    if margins(mech, k, w, end, out, False) <= 0.0:
        h = last_unique(mech, k, w, y, end, st, c, out, h)
        if h > 0.0:
            record_step(mech, rec, y, end, st, c, h)
            copy_state(end, y)
        return FAIL_MARGIN
    trigger = violated(mech, k, w, out, y, end, st)
    whole = h
    if trigger >= 0:
        h, trigger = locate_trigger(mech, k, w, y, end, st, c, out, h, trigger)
        if h == 0.0:
            return try_again(c, 0.3 * c.h)
        may_have_passed(mech, k, w, end, out, h)
    else:
        trigger = has_come_to_rest(mech, k, out, y, end)
    before_jump = goes_before_jump(mech, k, w, y, end, st, c, out, h, trigger)
    record_step(mech, rec, y, end, st, c, h)
    if before_jump and not step_to(mech, k, w, y, end, st, c, h):
        return FAIL_STEP
    if h == left:
        end.t = goal
    remember(c, y, st, h)
    c.counts[0] += 1
    copy_state(end, y)
    grow(mech, c, out, k, y)
    c.wanted = max(h, c.h)
    if trigger < 0 and (h < left or factor < 1.0):
        c.wanted = h * min(GROWTH, max(SHRINK, factor))
        taken = h
        if h < IN_VAIN * whole:
            # cut where a polynomial had something vanish at once that does not: the next one need not be as short
            taken = c.wanted = 0.3 * whole
        c.h = next_step(c, taken, c.wanted)
    if c.sets_out == 1:
        c.setting_out = c.wanted
        c.sets_out = 0
    if near_singular(c, out, h):
        return FAIL_SINGULAR
    if kind_of(mech, trigger) == KINK:
        # a load that has a kink: nothing changes but the polynomials
        c.last_h = 0.0
        c.made = 0.0
        return ACCEPTED
    if trigger < 0 and before_knot and h == left:
        c.knot = -np.inf
        c.last_h = 0.0
        c.growth = np.inf
        if leaves_bend(mech, k, y):
            return decide_anew(mech, k, w, y, before, c, out, rec, part)
        return CHANGED
    if trigger >= 0 and is_round_off(c, h, t) and leaves_bend(mech, k, y):
        # what comes to its limit at once does so behind the bend that y has stood before
        return get_away(mech, k, w, y, before, c, out, rec, part)
    if trigger >= 0:
        c.knot = -np.inf
        lets_go = kind_of(mech, trigger) <= LOAD and y.mode[owner(mech, trigger)] == STICK
        code = go_through(mech, k, w, y, before, c, out, rec, part, trigger)
        set_restart(mech, c, y, lets_go)
        return code
    return ACCEPTED
