"""Functions that fall below 0 where a mode ends or a load has a kink, and which of them does so in a step."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import first_below
from fricmb.integrate.implicit.equations.forces import call_joint, is_open, move
from fricmb.integrate.implicit.equations.jacobian_layers import place_slope
from fricmb.integrate.implicit.equations.slip_rows import lack, may_open, plane, slip_speed, spare
from fricmb.integrate.implicit.events.load_kinks import BEFORE, BEHIND, law_side
from fricmb.integrate.implicit.events.trigger_places import first_joint, first_kink, is_gap, is_of_port
from fricmb.integrate.implicit.modes.load_share import share_stages
from fricmb.integrate.implicit.modes.loop_mobility import may_share
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import Watch
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats
from fricmb.integrate.run.breakpoints import EPS

#: Between the stages a force below 0 by less than this part of its size counts as 0: ROUGH times the tolerance, of
#: which Newton leaves a fiftieth, but at least FINEST, and at most ROUGHEST, lest excursions be lost.
ROUGH, ROUGHEST, FINEST = 0.05, 5e-7, 1e-10


@kernel
def gaps(mech: Mech, k: Moving, t: float, q: Floats, v: Floats, lam: Floats, out: Watch) -> None:
    """Distances of open joints at a state, their rates, and what is round-off of them."""
    joint = mech.joint
    move(mech, k, t, q, v)
    for j in range(joint.port.shape[0]):
        if is_open(mech, j):
            n_x = call_joint(mech, k, j, lam)
            rate = 0.0
            for a in range(n_x):
                rate += k.out[1 + a] * k.x[n_x + a]
            out.gap[j], out.rate[j] = k.out[0], rate
            out.grain[j] = max(out.grain[j], gap_noise(mech, k, j, n_x) + 0.5 * EPS * abs(t * rate))


@kernel
def gap_noise(mech: Mech, k: Moving, j: int, n_x: int) -> float:
    """Round-off of the distance that joint j has just been evaluated to: of the coordinates it is made of."""
    table, place, value = mech.joint.table, mech.place, 0.0
    for a in range(n_x):
        first = table.x_start[j] + a
        size = abs(table.form_constant[first])
        for i in range(table.form_start[first], table.form_start[first + 1]):
            e, c = table.form_index[i] - 1, abs(table.form_coefficient[i])
            size += c * abs(k.s.X[e + 1])
            if 0 <= e < k.ddy.shape[0]:
                for b in range(place.y_start[e], place.y_start[e + 1]):
                    size += c * abs(place_slope(place, k, b) * k.s.X[1 + place.y_dof[b]])
        value += abs(k.out[1 + a]) * size
    return 4.0 * EPS * value


@kernel
def gaps_within(mech: Mech, k: Moving, y: State, end: State, st: Stages, out: Watch) -> None:
    """Distances of open joints at the start and the stages of the step from y to end, into ``out.inner``."""
    first = first_joint(mech)
    for j in range(out.gap.shape[0]):
        out.grain[j] = out.least[j]
    gaps(mech, k, y.t, y.q, y.v, y.lam, out)
    for j in range(out.gap.shape[0]):
        if is_open(mech, j):
            out.inner[0, first + j] = out.gap[j]
    for i in range(st.tab.c.shape[0]):
        gaps(mech, k, y.t + st.tab.c[i] * (end.t - y.t), st.Q[i], st.V[i], y.lam, out)
        for j in range(out.gap.shape[0]):
            if is_open(mech, j):
                out.inner[i + 1, first + j] = out.gap[j]


@kernel
def port_trigger(
    mech: Mech, k: Moving, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, j: int
) -> float:
    """Trigger j of a port: what it could still bear, or its slip; behind each its load, if it may open."""
    port, c = mech.port, j // 2
    if j % 2 == 1:
        load = -N[c] if mode[c] == OPEN else N[c]
        return float(load) if may_open(mech, c) else 1.0
    if port.law[c] == LAW_SMOOTH or mode[c] == OPEN:
        return 1.0
    if mode[c] == STICK:
        return spare(mech, k, c, F, N)
    # away from rest slip has a direction of its own, and a force that passes through 0 none but round-off's
    away = plane(mech, c) and k.form[c] == 0
    speed = magnitude(port.row, c, g) if away else slip_speed(port.row, c, direction, F, g)
    return float(speed + out.top_slip * lack(mech, k, c, N[c]))


@kernel
def triggers(
    mech: Mech, k: Moving, out: Watch, mode: Codes, direction: Floats, F: Floats, N: Floats, g: Floats, lam: Floats,
    at_end: bool,
) -> None:  # fmt: skip
    """Two functions a port and one a joint, which fall below 0 where a mode ends, and one a port that does at a kink.

    That of an open joint is its distance, at the end of a step.  Slip almost without load may turn as it likes.
    """
    joint, joints, kinks = mech.joint, first_joint(mech), first_kink(mech)
    for j in range(joints):
        out.trigger[j] = port_trigger(mech, k, out, mode, direction, F, N, g, j)
    for j in range(joint.port.shape[0]):
        out.trigger[joints + j] = lam[joint.row[j]] if joint.one_sided[j] else 1.0
        if is_open(mech, j):
            out.trigger[joints + j] = out.gap[j] if at_end else 1.0
    for c in range(mode.shape[0]):
        out.trigger[kinks + c] = 1.0
        if out.kinked[c] == BEFORE or out.kinked[c] == BEHIND:
            side = law_side(mech, k, c, g, N)
            out.trigger[kinks + c] = side if out.kinked[c] == BEFORE else -side
        elif out.kinked[c] != 0:
            j, value = mech.port.joint[c], 0.0
            for r in range(joint.row[j], joint.row[j + 1]):
                value += out.kink[r] * lam[r]
            out.trigger[kinks + c] = value


@kernel
def is_slip(mech: Mech, j: int, y: State) -> bool:
    """Whether trigger j is a slip velocity (else a force)."""
    return is_of_port(mech, j) and j % 2 == 0 and y.mode[j // 2] == SLIP


@kernel
def grain(mech: Mech, out: Watch, j: int, y: State) -> float:
    """Below this trigger j counts as 0, and its location ends: round-off of a distance, of a slip or of a force.

    Of the last two it is that of the largest of the run so far.
    """
    if is_slip(mech, j, y):
        return float(1e-13 * out.top_slip)
    if is_gap(mech, j):
        return float(max(out.grain[j - first_joint(mech)], 1e-290))
    return float(1e-13 * out.top_force)


@block
def violated(mech: Mech, k: Moving, w: Instant, out: Watch, y: State, end: State, st: Stages) -> int:
    """The trigger that falls furthest below 0 in the step from y to end, or -1; values at the end stay in ``trigger``.

    ``out.where`` is less than 1 where neither the end nor a stage shows it, but the polynomial through them does there.
    """
    s = st.tab.c.shape[0]
    worst, least = -1, 0.0
    out.where = 1.0
    shared = share_stages(mech, k, w, y, end, st)
    triggers(mech, k, out, end.mode, end.n, y.F, y.N, y.g, y.lam, False)
    out.inner[0] = out.trigger
    for i in range(s):
        triggers(mech, k, out, end.mode, end.n, st.F[i], st.N[i], st.g[i], st.lam[i], False)
        out.inner[i + 1] = out.trigger
    out.rough[:] = out.trigger
    if out.opened > 0:
        gaps_within(mech, k, y, end, st, out)
        gaps(mech, k, end.t, end.q, end.v, end.lam, out)
    triggers(mech, k, out, end.mode, end.n, end.F, end.N, end.g, end.lam, True)
    out.inner[s] = out.trigger
    for j in range(out.trigger.shape[0]):
        # forces of stages are of lower order, and in a short step the round-off of velocities over the step: at its end
        # those that follow from accelerations show by how much
        rough = 0.0 if is_gap(mech, j) else 2.0 * abs(out.trigger[j] - out.rough[j])
        limit = 10.0 * grain(mech, out, j, end)
        for i in range(s):
            value = out.inner[i + 1, j] + (rough if i < s - 1 else 0.0)
            if value < -limit and value / max(limit, 1e-290) < least:
                worst, least = j, value / max(limit, 1e-290)
    return worst if worst >= 0 else first_between(mech, k, out, y, st, shared)


@kernel
def has_come_to_rest(mech: Mech, k: Moving, out: Watch, y: State, end: State) -> int:
    """The trigger of slip in several directions that a step from y has brought to rest by its end, or -1.

    Of such slip round-off is left, and no direction from which a further step could go through rest.
    """
    row = mech.port.row
    for c in range(end.mode.shape[0]):
        if end.mode[c] != SLIP or not plane(mech, c) or lack(mech, k, c, end.N[c]) > 0.0:
            continue
        speed = magnitude(row, c, end.g)
        slows = speed < magnitude(row, c, y.g) and slip_speed(row, c, end.n, end.F, end.ga) < 0.0
        if slows and speed <= 10.0 * grain(mech, out, 2 * c, end):
            return 2 * c
    return -1


@kernel
def is_smooth(mech: Mech, k: Moving, j: int, y: State, st: Stages) -> bool:
    """Whether trigger j is what its values say between the stages: slip almost without load may turn as it likes."""
    if not is_of_port(mech, j):
        return True
    if j % 2 == 1 or y.mode[j // 2] == OPEN or mech.port.law[j // 2] == LAW_SMOOTH:
        return may_open(mech, j // 2)
    loaded = lack(mech, k, j // 2, y.N[j // 2]) == 0.0
    for i in range(st.tab.c.shape[0]):
        loaded = loaded and lack(mech, k, j // 2, st.N[i, j // 2]) == 0.0
    return bool(loaded)


@kernel
def size_of_force(mech: Mech, k: Moving, out: Watch, j: int, y: State) -> float:
    """What the force of trigger j is measured by: what friction of its port can hold, else the largest of the run."""
    c = j // 2
    if is_of_port(mech, j) and j % 2 == 0:
        return stick_limit(mech.port, mech.port.laws, c, k.s, max(y.N[c], 0.0))
    return float(out.top_force)


@kernel
def first_between(mech: Mech, k: Moving, out: Watch, y: State, st: Stages, shared: bool) -> int:
    """The trigger that first falls below 0 between the stages of a step from y alone, or -1; ``out.where`` then.

    ``shared``: contacts in loops share their load anew, by forces that jump between two stages.
    """
    found = -1
    for j in range(first_kink(mech)):
        jumps = shared and is_of_port(mech, j) and y.mode[j // 2] == STICK and may_share(mech, j // 2)
        if jumps or not is_smooth(mech, k, j, y, st):
            continue
        fine = is_slip(mech, j, y) or is_gap(mech, j)
        hair = 10.0 * grain(mech, out, j, y) if fine else out.hair * size_of_force(mech, k, out, j, y)
        if not fine:
            # in a short step forces of stages are round-off of velocities over the step
            hair += 2.0 * abs(out.trigger[j] - out.rough[j])
        for i in range(st.tab.c.shape[0]):
            out.values[i] = out.inner[i + 1, j] + hair
        # what begins at 0 rises from there, whatever the polynomial makes of its first moment
        first = out.inner[0, j] + hair if out.inner[0, j] > hair else 0.0
        _, below = first_below(st.tab, first, out.values, out.series)
        if below < out.where:
            found = j
            out.where = below
    return found
