"""Newton's iterations in a step: all stages by one Jacobian, from the factors that are there.

Where the structure is linear and loads are given, the first change solves for all but friction.  What is left stands in
the rows of friction alone, whose slip velocities follow the changes: further iterations leave the structure out.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.newton import left_over
from fricmb.integrate.implicit.equations.forces import forces, move
from fricmb.integrate.implicit.equations.friction_rows import friction_residual
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import (
    Stages,
    accelerations_at,
    solve_system,
    stage_positions,
    stage_residual,
)
from fricmb.integrate.implicit.stages.steep_laws import (
    begin_tries,
    correct_slopes,
    is_far_off,
    missed_by_laws,
    slopes_at_stages,
    try_next,
)
from fricmb.integrate.implicit.stages.turning import correct_turns, spread_of_stages
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, NORMAL_CONSTANT, SLIP


@block
def newton_change(mech: Mech, st: Stages, alone: bool) -> None:
    """Solve for the changes of all unknowns: R is overwritten.  ``alone``: rows of motion are 0, and not read."""
    tab = st.tab
    size, s = mech.order.place.shape[0], tab.c.shape[0]
    first = st.V.shape[1] if alone else 0
    for i in range(tab.lam.shape[0]):
        w, real = st.w[i], tab.lam[i].imag == 0.0
        w[:] = 0.0
        for j in range(s):
            line, part = st.R[j], tab.Tinv[i, j]
            for a in range(first, size):
                w[a] += complex(part.real * line[a], 0.0 if real else part.imag * line[a])
        solve_system(mech, st, i, alone)
    for j in range(s):
        line = st.R[j]
        line[:] = 0.0
        for i in range(tab.lam.shape[0]):
            w, part = st.w[i], tab.T[j, i]
            for a in range(size):
                line[a] += part.real * w[a].real - part.imag * w[a].imag


@kernel
def follow_change(mech: Mech, st: Stages) -> None:
    """Let slip velocities at the stages of a plain step follow the change of velocities in R."""
    slip, n = mech.port.slip, st.V.shape[1]
    for c in range(mech.port.joint.shape[0]):
        for a in range(mech.port.row[c], mech.port.row[c + 1]):
            form = slip.x_start[c] + 2 * (a - mech.port.row[c]) + 1
            for e in range(slip.form_start[form], slip.form_start[form + 1]):
                b = slip.form_index[e] - 1 - n
                for i in range(st.g.shape[0] if 0 <= b < n else 0):
                    st.g[i, a] -= slip.form_coefficient[e] * st.R[i, b]


@block
def friction_alone(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Residuals of friction and states of laws at all stages into ``st.R``, whose last change slip has yet to follow.

    For plain steps: loads are given, and rows of motion are solved.
    """
    n, rows, nz, s = st.V.shape[1], st.F.shape[1], st.z.shape[1], st.V.shape[0]
    follow_change(mech, st)
    for i in range(s):
        r, g = st.R[i], st.g[i]
        friction_residual(mech, k, y.mode, y.n, st.F[i], st.z[i], st.N[i], g, g, st.zd[i], r, n, True)
        for a in range(nz):
            rate = 0.0
            for j in range(s):
                rate += st.Ainv[i, j] * (st.z[j, a] - y.z[a])
            r[n + rows + a] = rate / h - st.zd[i, a]


#: Newton's iterations in a step before it is given up.
ITERATIONS = 12
#: The same where laws are asked at slip velocities of their own; part of the accuracy, times their largest force, that
#: these may miss then.
STEEP_ITERATIONS, MISSED = 40, 10.0
#: Part of the accuracy that factors may leave of the motion's rows while further iterations are of friction alone.
SOLVED = 0.1
#: Part by which a change of a state counts beside one of a velocity, where an iteration is of the whole structure: most
#: iterations more are for states alone.
STATES = 0.1
#: Round-off of velocities in a Newton change, beside what the kinetic energy at the stages could bring.
NOISE = 1e-15


@kernel
def is_noise(mech: Mech, st: Stages) -> bool:
    """Whether the last changes of velocities are round-off: one that hardly moves has that of those it is tied to.

    A short step begins so near its solution that nothing converges any more.
    """
    energy = 0.0
    for i in range(st.V.shape[0]):
        for a in range(st.V.shape[1]):
            energy = max(energy, mech.mass[a] * st.V[i, a] ** 2)
    for i in range(st.V.shape[0]):
        for a in range(st.V.shape[1]):
            if not abs(st.R[i, a]) <= NOISE * np.sqrt(energy / mech.mass[a]):
                return False
    return True


#: Round-off of a solution with factors, where forces of the structure over a step are no more than inertia.
ROUND_OFF = 1e-14


@kernel
def is_linear(mech: Mech, y: State) -> bool:
    """Whether the equations of a step are linear: in stick, and in slip along a line under one force."""
    port, linear = mech.port, mech.elements.address.shape[0] == 0 and mech.joint.n_x.shape[0] == 0
    for c in range(y.mode.shape[0]):
        slips = y.mode[c] == SLIP and (port.law[c] != LAW_CONSTANT or port.row[c + 1] - port.row[c] > 1)
        linear = linear and not slips and port.normal[c] == NORMAL_CONSTANT and port.law[c] != LAW_SMOOTH
        linear = linear and port.soft[c] == 0.0
    return bool(linear and mech.place.address.shape[0] == 0)


@kernel
def left_by_factors(mech: Mech, h: float, made: float) -> float:
    """Part of a change of motion that its solution by factors may leave in a step h.

    Stiff springs and dampers, whose forces over a step are far above those of inertia, take digits from soft motion.
    Those made for a step of another length leave what the matrices differ by: powers of h up to the second.
    """
    linear, stiff = mech.linear, 1.0
    n = mech.mass.shape[0]
    for e in range(linear.K.shape[0]):
        i = linear.Ki[e]
        stiff = max(stiff, h * h * abs(linear.K[e]) / mech.mass[i] if i < n else 0.0)
    for e in range(linear.C.shape[0]):
        i = linear.Ci[e]
        stiff = max(stiff, h * abs(linear.C[e]) / mech.mass[i] if i < n else 0.0)
    return ROUND_OFF * stiff + 4.0 * abs(1.0 - made / h)


@kernel
def apply_change(st: Stages) -> float:
    """Take the change in R from the unknowns: its largest part, of what counts as 1; no number where it has none."""
    change, sound, weight = 0.0, 0.0, 1.0 if st.plain == 1 else STATES
    for i in range(st.R.shape[0]):
        r = st.R[i]
        for a in range(r.shape[0]):
            sound += 0.0 * r[a]
        for a in range(st.scale.shape[0]):
            change = max(change, abs(r[a]) / st.scale[a])
        for a in range(st.z.shape[1]):
            off = r[r.shape[0] - st.z.shape[1] + a]
            # a state that sets out within the step has no size before
            change = max(change, weight * abs(off) / max(st.felt.size[a], abs(st.z[i, a] - off)))
        at = 0
        for part in (st.V, st.lam, st.F, st.z):
            for a in range(part.shape[1]):
                part[i, a] -= r[at + a]
            at += part.shape[1]
    return change + sound


#: Part by which a change of a force whose direction is found counts beside one of a velocity: near rest velocities are
#: known as much better.
FOUND = 1e-3


@kernel
def found_change(mech: Mech, st: Stages) -> float:
    """The largest change in R of a force that tells the direction of its slip, as a part of it.

    Across a direction in which nothing moves such a force changes no velocity at once, but the direction of all.
    """
    most, row = 0.0, mech.port.row
    for k in range(st.turns.near):
        c = st.turns.contact[k]
        place = st.V.shape[1] + st.lam.shape[1]
        for i in range(st.F.shape[0]):
            size = magnitude(row, c, st.F[i])
            for a in range(row[c], row[c + 1] if size > 0.0 else row[c]):
                most = max(most, abs(st.R[i, place + a]) / size)
    return most


@block
def iterate_stages(mech: Mech, k: Moving, y: State, st: Stages, h: float, made: float, accuracy: float) -> int:
    """Newton from the values in ``st`` until changes of velocities and states are below ``accuracy`` of their sizes.

    Returns the number of iterations, or 0 where they do not converge.  ``made``: length of the step of the factors.
    """
    tab = st.tab
    s = tab.c.shape[0]
    last, unsolved = np.inf, np.inf
    left = left_by_factors(mech, h, made)
    exact = left if is_linear(mech, y) else 1.0
    st.found, st.fresh = 1.0, 0
    steep = st.steep.on == 1
    if steep:
        follow_slip(mech, k, y, st, h)
        begin_tries(mech, st.steep, y.g, st.g)
    for iteration in range(STEEP_ITERATIONS if steep else ITERATIONS):
        alone = st.plain == 1 and not steep and unsolved <= SOLVED * accuracy
        if alone:
            friction_alone(mech, k, y, st, h)
        else:
            for i in range(s):
                stage_residual(mech, k, y, st, h, i)
        if st.turns.near > 0:
            spread_of_stages(mech, st.turns, st.F, st.g)
        far = not steep and is_far_off(mech, st.steep, st.F, st.R, y.q.shape[0] + y.lam.shape[0])
        newton_change(mech, st, alone)
        if st.turns.near > 0:
            correct_turns(mech, st.turns, tab, st.R, st.w)
        if steep:
            slopes_at_stages(mech, k, st.steep, y.mode, st.z, st.N)
            correct_slopes(mech, st.steep, tab, st.R, st.w)
        change = max(apply_change(st), FOUND * found_change(mech, st))
        if not change < 1e30:
            return 0
        if steep:
            follow_slip(mech, k, y, st, h)
            if not try_next(mech, st.steep, st.g, iteration):
                unsolved, last = np.inf, np.inf
                continue
            part = MISSED * accuracy
            if missed_by_laws(mech, k, st.steep, y.mode, st.V, st.F, st.z, st.N, st.scale, h, part) > 1.0:
                last = change
                continue
        if not alone:
            unsolved = left * change
        rate = change / last if last < np.inf else exact
        if last < np.inf or exact < 1.0:
            st.found = rate
        if not far and (change <= 1e-15 or left_over(change, rate) <= accuracy):
            end_iteration(mech, y, st, h, change <= accuracy)
            return iteration + 1
        if last < np.inf and not steep and (rate >= 2.0 or (iteration > 2 and rate >= 0.95)):
            if not is_noise(mech, st):
                return 0
            end_iteration(mech, y, st, h, False)
            return iteration + 1
        last = change
    return 0


@kernel
def follow_slip(mech: Mech, k: Moving, y: State, st: Stages, h: float) -> None:
    """Slip velocities and loads at the stages, from the velocities there."""
    for i in range(st.V.shape[0]):
        stage_positions(y, st, h, i)
        move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
        forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])


@kernel
def end_iteration(mech: Mech, y: State, st: Stages, h: float, fresh: bool) -> None:
    """Positions of the stages after the last change (``fresh``: a trifle); in plain steps slip, too, and accelerations.

    (Those of the last stage, from which the end of the step sets out.)
    """
    st.fresh = 1 if fresh else st.plain
    if not fresh and st.plain == 1:
        follow_change(mech, st)
    for i in range(st.V.shape[0]):
        stage_positions(y, st, h, i)
    if st.plain == 1:
        accelerations_at(y, st, h, st.V.shape[0] - 1)
