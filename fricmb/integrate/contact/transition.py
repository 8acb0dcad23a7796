"""What follows at the instant of a transition: who slips, sticks, opens or turns round, and the rows on both sides."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.contact.mode_decision import find_open, mark_rest, settle
from fricmb.integrate.contact.rest_problem import Rest
from fricmb.integrate.model.accelerations import share_load, slip_rate
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.friction_discs import NEARLY, least_slip
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.output.recorder import AFTER, BEFORE, Rows, record, record_event
from fricmb.integrate.problem import (
    EVENT_CLOSE,
    EVENT_OPEN,
    EVENT_REVERSAL,
    EVENT_SLIP,
    EVENT_STICK,
    LAW_SMOOTH,
    OPEN,
    SLIP,
    STICK,
    Codes,
    Floats,
)
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.run.room_protocols import Events, Laws, Modes


class Before(Layout):
    """Modes and directions before a transition."""

    mode: Codes
    n: Floats


@kernel
def keep_modes(y: State, old: Before) -> None:
    """Keep the modes and directions that there are before a transition."""
    for c in range(y.mode.shape[0]):
        old.mode[c] = y.mode[c]
    for a in range(y.n.shape[0]):
        old.n[a] = y.n[a]


@kernel
def turned(ports: Laws, k: int, mode: int, n: Floats, old: Floats) -> bool:
    """Whether one-dimensional slip of contact k has changed its sense."""
    row0 = ports.row[k]
    one = mode == SLIP and ports.law[k] != LAW_SMOOTH and ports.row[k + 1] - row0 == 1
    return bool(one and n[row0] * old[row0] < 0.0)


@kernel
def record_changes(ports: Laws, t: float, y: Modes, old: Modes, out: Events) -> bool:
    """Record an event at t for every contact whose mode, or sense of one-dimensional slip, is not that of ``old``.

    Returns whether there are any.
    """
    some = False
    for c in range(y.mode.shape[0]):
        kind = -1
        if y.mode[c] != old.mode[c]:
            kind = EVENT_STICK if y.mode[c] == STICK else EVENT_SLIP
            if y.mode[c] == OPEN:
                kind = EVENT_OPEN
            elif old.mode[c] == OPEN:
                kind = EVENT_CLOSE
        elif turned(ports, c, y.mode[c], y.n, old.n):
            kind = EVENT_REVERSAL
        if kind >= 0:
            record_event(out, t, c, kind)
            some = True
    return some


@kernel
def lands_now(packed: Packed, y: State, k: int, part: int) -> bool:
    """Whether a slip ends so soon that no step to its end can be told from none: 16 roundings of the time away."""
    if part != 0 or y.mode[k] != SLIP or packed.ports.law[k] == LAW_SMOOTH:
        return False
    speed = magnitude(packed.ports.row, k, y.g)
    return bool(speed <= -16.0 * EPS * abs(y.t) * slip_rate(packed, y, k))


@kernel
def holds_nothing(packed: Packed, y: State, k: int) -> bool:
    """Whether a stuck contact that has reached its cone bears nothing but round-off: it is the cone that has closed."""
    row0 = packed.ports.row[k]
    if y.mode[k] != STICK or packed.ports.var[k] < 0:
        return False
    top = 0.0
    for i in range(y.a.shape[0]):
        top = max(top, abs(y.a[i]))
    held = packed.ports.D[row0, row0] * magnitude(packed.ports.row, k, y.F)
    return bool(held <= 1e-12 * top)


@kernel
def give_way(packed: Packed, s: Scratch, y: State, r: Rest, old: Before) -> bool:
    """Release, of redundant contacts that share a load, those that slip in the motion by which they give way.

    They reach their cones as one: none can hold the load without the others.  False where there is no such motion.
    """
    row = packed.ports.row
    if share_load(packed, s, y.mode, y.N, y.F.copy(), y.way, NEARLY) <= 0.0:
        return False
    slips = least_slip(row, y.way)
    for c in range(y.mode.shape[0] if slips > 0.0 else 0):
        if old.mode[c] == STICK and r.part[c] == 1 and magnitude(row, c, y.way) > slips:
            r.part[c] = 2
            point_along(row, c, y.way, 1.0, y.n)
    return slips > 0.0


@block
def transition(
    packed: Packed, s: Scratch, y: State, contact: int, lifted: bool, r: Rest, old: Before, out: Rows
) -> int:
    """Go through the transition that ``contact`` has reached (-1: a breakpoint of prescribed motion).

    ``lifted``: it is its normal force that has come to 0.

    Records the rows on both sides and the events.  Returns the code of :func:`settle`.
    """
    ports = packed.ports
    # an open contact has no other transition (located without a step, nothing has told which it is)
    lifted = lifted or (contact >= 0 and (y.mode[contact] == OPEN or holds_nothing(packed, y, contact)))
    record(out, y, BEFORE)
    keep_modes(y, old)
    find_open(packed, s, y)
    if lifted:
        # the normal force is at its zero, up to round-off of either sign
        y.mode[contact] = SLIP if old.mode[contact] == OPEN else OPEN
    mark_rest(packed, s, y, r, contact < 0)
    for c in range(y.mode.shape[0]):
        row0 = ports.row[c]
        force = ports.D[row0, row0] * stick_limit(ports, packed.laws, c, s, y.N[c])
        if lands_now(packed, y, c, r.part[c]):
            r.part[c] = 1
        if c != contact and r.part[c] == 1 and old.mode[c] == SLIP and slip_rate(packed, y, c) >= -1e-9 * force:
            # released at this very instant: tried stuck again it would be on its cone, and so without end
            r.part[c] = 2
    if contact >= 0 and not lifted and packed.ports.law[contact] != LAW_SMOOTH:
        if old.mode[contact] == STICK and ports.soft > 0.0 and give_way(packed, s, y, r, old):
            pass
        elif old.mode[contact] == STICK:
            r.part[contact] = 2
            point_along(ports.row, contact, y.F, -1.0, y.n)
        else:
            r.part[contact] = 1
    code = settle(packed, s, y, r)
    if code != 0:
        return code
    record_changes(ports, y.t, y, old, out)
    record(out, y, AFTER)
    return 0
