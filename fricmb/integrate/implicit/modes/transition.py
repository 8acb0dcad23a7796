"""Going through a transition or a breakpoint: modes and reactions decided together, events."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.forces import move
from fricmb.integrate.implicit.equations.instant_matrix import NONE, instant_matrix
from fricmb.integrate.implicit.equations.projection import project_velocities
from fricmb.integrate.implicit.equations.singular_position import start_watch
from fricmb.integrate.implicit.equations.slip_rows import lack, plane
from fricmb.integrate.implicit.events.triggers import kind_of, owner
from fricmb.integrate.implicit.modes.load_share import give_way, join_rest
from fricmb.integrate.implicit.modes.mode_decision import decide
from fricmb.integrate.implicit.modes.mode_enumeration import FOUND, SEVERAL
from fricmb.integrate.implicit.modes.mode_trial import ARRIVES, IN_LOOP, LENT, RESTED, SLIPS_ON
from fricmb.integrate.implicit.modes.uniqueness import margins
from fricmb.integrate.implicit.output.recorder import Record, copy_state
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import FRICTION, JOINT, LOAD, Watch
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes
from fricmb.integrate.run.breakpoints import set_window
from fricmb.integrate.run.mode_changes import record_changes
from fricmb.integrate.run.outcomes import (
    DONE,
    FAIL_HIT,
    FAIL_LOST,
    FAIL_MARGIN,
    FAIL_MODES,
    FAIL_PROJECT,
    FAIL_SEVERAL,
    FAIL_SINGULAR,
)


@kernel
def least_held(mech: Mech, y: State, may_open: bool) -> int:
    """The joint that would have to pull most among those that only push, or -1; ``may_open``: of those that let go."""
    joint, worst = mech.joint, -1
    for j in range(joint.port.shape[0]):
        held = joint.one_sided[j] != 0 and joint.dropped[joint.row[j]] == 0
        if not held or (may_open and joint.hands_over[j] == 0) or y.lam[joint.row[j]] >= 0.0:
            continue
        if worst < 0 or y.lam[joint.row[j]] < y.lam[joint.row[worst]]:
            worst = j
    return worst


@kernel
def open_joint(mech: Mech, k: Moving, w: Instant, y: State, out: Watch, i: int) -> int:
    """Open joint i where contact is lost, if it is declared so; an open one that has come back ends the run."""
    joint = mech.joint
    row = joint.row[i]
    if joint.hands_over[i] == 0:
        return FAIL_LOST
    if joint.dropped[row] == 2:
        return FAIL_HIT
    joint.dropped[row] = 2
    y.lam[row] = 0.0
    out.opened += 1
    for c in range(y.mode.shape[0]):
        if mech.port.joint[c] >= 0 and joint.load_of[mech.port.joint[c]] == i:
            y.mode[c] = OPEN
            for a in range(mech.port.row[c], mech.port.row[c + 1]):
                y.F[a] = 0.0
    move(mech, k, y.t, y.q, y.v)
    if not instant_matrix(mech, k, w, y, NONE):
        return FAIL_SINGULAR
    start_watch(mech, w, out, out.sigma_top)
    return DONE


@kernel
def bears(mech: Mech, k: Moving, y: State, i: int) -> bool:
    """Whether the load of port i is more than a trifle beside the largest force."""
    return bool(lack(mech, k, i, y.N[i]) == 0.0)


@kernel
def turn_with_slip(mech: Mech, k: Moving, y: State, size: float, but: int) -> None:
    """Give ports the direction of their slip: almost without load they may have turned, and a transition may load them.

    In one direction; ``size``: largest slip velocity, of which slip under a load may be round-off to 1e-11 and tells no
    direction then; ``but``: a port that is left as it is.
    """
    for i in range(y.mode.shape[0]):
        a = mech.port.row[i]
        if i != but and y.mode[i] == SLIP and not plane(mech, i) and mech.port.law[i] != LAW_SMOOTH:
            small = (1e-11 if bears(mech, k, y, i) else 1e-13) * size
            y.n[a] = -y.n[a] if y.n[a] * y.g[a] < -small else y.n[a]


@kernel
def kinetic_energy(mech: Mech, y: State) -> float:
    """Of all bodies."""
    linear, found = mech.linear, 0.0
    for e in range(linear.M.shape[0]):
        found += 0.5 * linear.M[e] * y.v[linear.Mi[e]] * y.v[linear.Mj[e]]
    return float(found)


@kernel
def meet_jump(mech: Mech, k: Moving, w: Instant, y: State, size: float) -> bool:
    """Velocities behind a breakpoint: those that driven joints ask for; what stuck slips on ground that has jumped.

    Joints without friction bring nothing in the instant, so that what kinetic energy gains is what the drives bring.
    ``size``: largest slip velocity, of which slip may be round-off to 1e-11.
    """
    had = kinetic_energy(mech, y)
    if not project_velocities(mech, k, w, y, False, False):
        return False
    y.work[-1] += kinetic_energy(mech, y) - had
    row = mech.port.row
    for i in range(y.mode.shape[0]):
        # in a plane what slips has turned with the jump
        turned = y.mode[i] == STICK or (y.mode[i] == SLIP and plane(mech, i))
        if turned and magnitude(row, i, y.g) > 1e-11 * size:
            y.mode[i] = SLIP
            point_along(row, i, y.g, 1.0, y.n)
    turn_with_slip(mech, k, y, size, -1)
    return True


@kernel
def bring_to_rest(mech: Mech, k: Moving, w: Instant, y: State, part: Codes) -> bool:
    """Take the round-off of slip away from what sticks, and from what has been at rest and sets out from there."""
    for i in range(part.shape[0]):
        if part[i] in (ARRIVES, RESTED, IN_LOOP) and y.mode[i] == SLIP and not plane(mech, i):
            y.mode[i] = STICK
            part[i] = LENT
    done = project_velocities(mech, k, w, y, False, True)
    for i in range(part.shape[0]):
        if part[i] == LENT:
            y.mode[i] = SLIP
    return bool(done)


#: Part of the run within which slip that is given comes to rest, or has just passed it: it is at rest.
AT_ONCE = 1e-11


@kernel
def take_given(mech: Mech, k: Moving, w: Instant, y: State, span: float, part: Codes) -> None:
    """Keep slip that is given, but where the run before has ended on its way into rest.

    Where a transition was located there, slip is off 0 by round-off to either side, and slows down.
    """
    known = react(mech, k, w, y, False)
    for c in range(part.shape[0]):
        if y.mode[c] != SLIP:
            continue
        a = mech.port.row[c]
        slows = known and not plane(mech, c) and mech.port.law[c] != LAW_SMOOTH and y.n[a] * y.ga[a] < 0.0
        part[c] = ARRIVES if slows and abs(y.g[a]) <= AT_ONCE * span * abs(y.ga[a]) else SLIPS_ON


@kernel
def set_out_anew(mech: Mech, k: Moving, w: Instant, y: State, c: Control, out: Watch, part: Codes) -> int:
    """Reactions and friction of modes that have been decided; the step before is no guide to the next."""
    if not bring_to_rest(mech, k, w, y, part):
        return FAIL_PROJECT
    if not react(mech, k, w, y, False):
        return FAIL_MODES
    c.last_h = 0.0
    c.made = 0.0
    return FAIL_MARGIN if margins(mech, k, w, y, out, True) <= 0.0 else DONE


@block
def change_modes(
    mech: Mech,
    k: Moving,
    w: Instant,
    y: State,
    before: State,
    c: Control,
    out: Watch,
    rec: Record,
    part: Codes,
    j: int,
) -> int:
    """Go through the transition of trigger j, or decide modes anew (-1): modes together with reactions, events."""
    n_c, row = y.mode.shape[0], mech.port.row
    kind = kind_of(mech, j)
    port = owner(mech, j) if kind in (FRICTION, LOAD) else -1
    turn_with_slip(mech, k, y, out.top_slip, port)
    copy_state(y, before)
    if kind == JOINT:
        code = open_joint(mech, k, w, y, out, owner(mech, j))
        if code != DONE:
            return code
    set_window(c, k.s.window, y.t)
    if j < 0 and not meet_jump(mech, k, w, y, out.top_slip):
        return FAIL_PROJECT
    for i in range(n_c):
        part[i] = RESTED if y.mode[i] == STICK else SLIPS_ON
        # without load the direction of slip decides nothing: found anew it would be that of round-off
        if y.mode[i] == SLIP and magnitude(row, i, y.g) <= max(1e-11 * out.top_slip, out.slow) and bears(mech, k, y, i):
            part[i] = ARRIVES
    forced = -1
    if kind == LOAD:
        y.mode[port] = SLIP if y.mode[port] == OPEN else OPEN
        if y.mode[port] == SLIP:
            point_along(row, port, y.g, 1.0, y.n)
            part[port] = ARRIVES if magnitude(row, port, y.g) <= 1e-11 * out.top_slip else SLIPS_ON
    elif kind == FRICTION and y.mode[port] == STICK:
        forced = -1 if give_way(mech, k, w, y, part, IN_LOOP) else port
    elif kind == FRICTION and (plane(mech, port) or y.n[row[port]] * y.g[row[port]] >= -1e-11 * out.top_slip):
        part[port] = ARRIVES
    elif kind == FRICTION:
        # one that had no load to speak of has gone on through rest
        part[port] = SLIPS_ON
        y.n[row[port]] = -y.n[row[port]]
    join_rest(mech, k, w, y, part, 1e-9 * out.top_slip, ARRIVES)
    code = decide(mech, k, w, y, part, forced)
    if code != FOUND:
        margins(mech, k, w, y, out, True)
        return FAIL_SEVERAL if code == SEVERAL else FAIL_MODES
    record_changes(mech.port, y.t, y, before, rec)
    return set_out_anew(mech, k, w, y, c, out, part)
