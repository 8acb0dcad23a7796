"""Which trigger falls below 0 in a step: at its end, at a stage, or between two of them."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.crossing import first_below
from fricmb.integrate.implicit.equations.forces import call_joint, is_open, move
from fricmb.integrate.implicit.equations.jacobian_layers import place_slope
from fricmb.integrate.implicit.equations.slip_rows import lack, may_open, plane, slip_speed
from fricmb.integrate.implicit.events.triggers import (
    first_behind_joints,
    first_joint,
    grain,
    is_gap,
    is_slip,
    kind_of,
    owner,
    triggers,
)
from fricmb.integrate.implicit.modes.load_share import share_stages
from fricmb.integrate.implicit.modes.loop_mobility import may_share
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.scene.watch import FRICTION, LOAD, Watch
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Floats
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
    for i in range(st.tab.c.shape[0] + 1):
        if i == 0:
            gaps(mech, k, y.t, y.q, y.v, y.lam, out)
        else:
            gaps(mech, k, y.t + st.tab.c[i - 1] * (end.t - y.t), st.Q[i - 1], st.V[i - 1], y.lam, out)
        for j in range(out.gap.shape[0]):
            if is_open(mech, j):
                out.inner[i, first + j] = out.gap[j]


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
        exact = is_gap(mech, j) or is_shared(mech, y, end, j)
        rough = 0.0 if exact else 2.0 * abs(out.trigger[j] - out.rough[j])
        limit = 10.0 * grain(mech, out, j, end)
        for i in range(s):
            value = out.inner[i + 1, j] + (rough if i < s - 1 else 0.0)
            if value < -limit and value / max(limit, 1e-290) < least:
                worst, least = j, value / max(limit, 1e-290)
    return worst if worst >= 0 else first_between(mech, k, out, y, end, st, shared)


#: Steps shorter than this part of the time have forces at stages that are round-off of velocities.
SHORT = 1e-6


@kernel
def is_shared(mech: Mech, y: State, end: State, j: int) -> bool:
    """Whether trigger j is of what sticks in a loop: at the end of a step its share is another, not a better one.

    What stages differ from the end by says nothing of their round-off then, which in all but short steps is none.
    """
    if kind_of(mech, j) != FRICTION or end.mode[owner(mech, j)] != STICK or not may_share(mech, owner(mech, j)):
        return False
    return bool(end.t - y.t > SHORT * abs(end.t))


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
    if kind_of(mech, j) > LOAD:
        return True
    c = owner(mech, j)
    if kind_of(mech, j) == LOAD or y.mode[c] == OPEN or mech.port.law[c] == LAW_SMOOTH:
        return may_open(mech, c)
    loaded = lack(mech, k, c, y.N[c]) == 0.0
    for i in range(st.tab.c.shape[0]):
        loaded = loaded and lack(mech, k, c, st.N[i, c]) == 0.0
    return bool(loaded)


@kernel
def limit_of(mech: Mech, k: Moving, c: int, N: Floats) -> float:
    """What friction of port c can hold."""
    return stick_limit(mech.port, mech.port.laws, c, k.s, max(N[c], 0.0))


@kernel
def squared(left: float, limit: float) -> float:
    """``limit^2 - F^2`` of a force F that has ``left`` to its limit.

    Limit and force are magnitudes, with a kink where a reaction passes through 0, and in the plane as good as one where
    it passes near it.  Polynomials would lead past the break-away there; squares have none, and the same sign.
    """
    return float(left * (2.0 * limit - left))


@kernel
def first_between(
    mech: Mech, k: Moving, out: Watch, y: State, end: State, st: Stages, shared: bool
) -> int:  # fmt: skip
    """The trigger that first falls below 0 between the stages of a step from y alone, or -1; ``out.where`` then.

    ``shared``: contacts in loops share their load anew, by forces that jump between two stages.
    """
    found = -1
    for j in range(first_behind_joints(mech)):
        c = owner(mech, j)
        jumps = shared and kind_of(mech, j) <= LOAD and y.mode[c] == STICK and may_share(mech, c)
        if jumps or not is_smooth(mech, k, j, y, st):
            continue
        held = False
        if is_slip(mech, j, y) or is_gap(mech, j):
            hair = 10.0 * grain(mech, out, j, y)
        else:
            # of what friction can hold; in a short step forces of stages are round-off of velocities over the step
            held = kind_of(mech, j) == FRICTION and y.mode[c] == STICK and mech.port.law[c] != LAW_SMOOTH
            size = limit_of(mech, k, c, y.N) if held else out.top_force
            hair = out.hair * size
            hair += 0.0 if is_shared(mech, y, end, j) else 2.0 * abs(out.trigger[j] - out.rough[j])
        for i in range(st.tab.c.shape[0]):
            value = out.inner[i + 1, j] + hair
            out.values[i] = squared(value, limit_of(mech, k, c, st.N[i]) + hair) if held else value
        # what begins at 0 rises from there, whatever the polynomial makes of its first moment
        first = out.inner[0, j] + hair if out.inner[0, j] > hair else 0.0
        first = squared(first, size + hair) if held else first
        _, below = first_below(st.tab, first, out.values, out.series)
        if below < out.where:
            found = j
            out.where = below
    return found
