"""One step of given modes: predict, solve, estimate the error, return to the constraints."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.step_control import or_reached
from fricmb.integrate.formulas.tableau import by_line, largest_in_step
from fricmb.integrate.implicit.between.slow_slip import line_at
from fricmb.integrate.implicit.equations.accelerations import powers, react
from fricmb.integrate.implicit.equations.forces import forces, forces_on_signals, has_dense_rows, move
from fricmb.integrate.implicit.equations.projection import project_positions, project_velocities
from fricmb.integrate.implicit.equations.slip_rows import aim, keep_held, lightness, plane
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.stages.near_rest import choose_forms, prepare_steep, prepare_turns
from fricmb.integrate.implicit.stages.series_step import solve_by_series
from fricmb.integrate.implicit.stages.stage_newton import iterate_stages
from fricmb.integrate.implicit.stages.stages import (
    Stages,
    bring_up_to_date,
    empty_slot,
    factor_stages,
    linearise,
    slot_for,
)
from fricmb.integrate.model.law_values import smooth_force
from fricmb.integrate.problem import SLIP, STICK, Floats

#: Relative round-off of positions.
ROUND_OFF = 2.3e-16
#: Newton's iterations stop at this part of the tolerance, and at this part of what counts as 1.
KAPPA, FINEST = 1e-3, 1e-14


@kernel
def measure(mech: Mech, c: Control, y: State, h: float, scale: Floats) -> None:
    """What counts as 1 in velocities: running maxima, not less than a trifle of what kinetic energy could bring.

    That of what a body is tied to: an idle rotor makes no other body's motion a trifle.  With joints reactions follow
    from accelerations, which no smaller trifle would leave rough.
    """
    energy, group = c.inertia, mech.group
    trifle = 1e-4 if has_joints(y) else 1e-7
    energy[:] = 0.0
    for i in range(scale.shape[0]):
        here = max(c.v[i], abs(y.v[i]) + h * abs(y.a[i]))
        energy[group[i]] = max(energy[group[i]], c.mass[i] * here * here)
    for i in range(scale.shape[0]):
        here = max(c.v[i], abs(y.v[i]) + h * abs(y.a[i]), c.floor_v[i])
        scale[i] = max(here, trifle * np.sqrt(energy[group[i]] / c.mass[i]), 1e-290)
    linear = mech.linear
    for e in range(linear.K.shape[0]):
        i, j = linear.Ki[e], linear.Kj[e]
        if i < scale.shape[0] and j < scale.shape[0]:
            # a stiff spring turns the round-off of positions into velocities, which is no error of a step
            rate = np.sqrt(abs(linear.K[e]) / c.mass[i])
            noise = ROUND_OFF * rate * min(rate * h, 1.0) * c.q[j]
            scale[i] = max(scale[i], noise / max(asked(c), FINEST / KAPPA))


@kernel
def measure_states(c: Control, y: State, h: float, st: Stages) -> None:
    """What counts as 1 in states of laws, into ``st.felt.size``: Newton solves for one that moves nothing, too."""
    for a in range(y.z.shape[0]):
        st.felt.size[a] = max(c.z[a], abs(y.z[a]) + h * abs(y.zd[a]), c.noise_z[a], 1e-290)


#: Part of the scale of slip by which the force of a state that is noise moves a contact within a step.
TRIFLE = 1e-6


@kernel
def state_noise(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, part: float) -> None:
    """Sizes of internal states that are noise: ``part`` of what the slip of a step would bring them by.

    Newton leaves slip velocities unknown by so much of the tolerance.  A bristle in a direction in which nothing moves
    holds nothing else, and has no size of its own.  Nor has one that sets out (Karnopp's hold, where slip comes into
    its band): there as much is noise as moves the contact by a trifle.
    """
    port, last = mech.port, st.V.shape[0] - 1
    for i in range(y.v.shape[0] if y.z.shape[0] > 0 else 0):
        c.inertia[i] = 1.0 / st.scale[i] / st.scale[i]
    for p in range(y.mode.shape[0]):
        row0, z0 = port.row[p], port.z_start[p]
        d, nz = port.row[p + 1] - row0, port.z_start[p + 1] - z0
        for i in range(nz):
            c.noise_z[z0 + i] = 0.0
        if nz > 0:
            smooth_force(port.laws, p, k.s, st.g[last], row0, d, st.N[last, p], st.z[last], z0, nz)
            keep_pushes(c, k, d, z0, nz)
            smooth_force(port.laws, p, k.s, y.g, row0, d, y.N[p], y.z, z0, nz)
            keep_pushes(c, k, d, z0, nz)
        for a in range(d if nz > 0 else 0):
            slip = np.sqrt(lightness(mech, k, p, a, y.lam, c.inertia))
            free = lightness(mech, k, p, a, y.lam, mech.mass)
            for i in range(nz):
                brought = part * h * abs(k.s.out[d + nz + (d + i) * (d + 1 + nz) + a]) * slip
                moved = h * free * c.push_z[z0 + i]
                c.noise_z[z0 + i] += brought + (TRIFLE * slip / moved if moved > 1e-290 else 0.0)


@kernel
def keep_pushes(c: Control, k: Moving, d: int, z0: int, nz: int) -> None:
    """The largest force that a unit of each state has made, with the law of d directions just asked."""
    for i in range(nz):
        for a in range(d):
            c.push_z[z0 + i] = max(c.push_z[z0 + i], abs(k.s.out[d + nz + a * (d + 1 + nz) + d + 1 + i]))


@kernel
def predict_stages(c: Control, y: State, st: Stages, h: float) -> None:
    """Start values of the stages: the polynomial of the step before, or constant accelerations and forces."""
    before = c.last_h
    for i in range(c.ahead.shape[0]):
        c.ahead[i] = 1.0 + st.tab.c[i] * h / before
        if before > 0.0:
            line_at(st.tab, c.ahead[i], c.weight[i])
    for i in range(c.ahead.shape[0]):
        at, weight = 0, c.weight[i]
        old = before > 0.0 and c.ahead[i] <= 4.0
        for start, part in ((y.v, st.V), (y.lam, st.lam), (y.F, st.F), (y.z, st.z)):
            line = part[i]
            for a in range(line.shape[0]):
                line[a] = 0.0 if old else start[a]
            for j in range(weight.shape[0] if old else 0):
                values, share = c.old[j], weight[j]
                for a in range(line.shape[0]):
                    line[a] += share * values[at + a]
            at += start.shape[0]
        for a in range(0 if old else y.v.shape[0]):
            st.V[i, a] += st.tab.c[i] * h * y.a[a]


@kernel
def remember(c: Control, y: State, st: Stages, h: float) -> None:
    """Keep this step's values for the prediction of the next; y is still its start."""
    at = 0
    for start, part in ((y.v, st.V), (y.lam, st.lam), (y.F, st.F), (y.z, st.z)):
        for a in range(start.shape[0]):
            c.old[0, at + a] = start[a]
            for j in range(part.shape[0]):
                c.old[j + 1, at + a] = part[j, a]
        at += start.shape[0]
    c.last_h = h


#: With factors of a step of another length they stop at this part of that: their own would gain as much in one more.
STRICTER = 1e-3
#: Without joints factors serve steps that differ in length by this part: while a transition is located most do, and
#: factors are what steps cost where many contacts rub on many modes.  With joints, slopes change within a step, and
#: steps that ended at a kink of a normal force came out 30 tolerances off.
ALIKE = 1e-3


@kernel
def solve_stages(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> bool:
    """Solve the stages of a step h from y, by the factors that are there where they are of a step almost as long."""
    if c.made == 0.0:
        choose_forms(mech, k, y, st, h)
        linearise(mech, k, y, st)
        st.lengths[:] = 0.0
        c.counts[3] += 1
    apart = 0.0 if has_joints(y) else ALIKE * h
    if not abs(c.made - h) <= apart:
        if not slot_for(st, h, apart):
            c.counts[4] += 1
            empty_slot(st)
            if not factor_stages(mech, st, h):
                c.made = 0.0
                return False
        c.made = st.lengths[st.slot]
        prepare_turns(mech, st)
        prepare_steep(mech, st)
    measure(mech, c, y, h, st.scale)
    measure_states(c, y, h, st)
    predict_stages(c, y, st, h)
    for i in range(st.tab.c.shape[0]):
        keep_held(mech, y.mode, y.F, st.F[i])
    accuracy = KAPPA * asked(c) * (1.0 if c.made == h and st.turns.near == 0 else STRICTER)
    used = iterate_stages(mech, k, y, st, h, c.made, max(accuracy, FINEST))
    c.counts[2] += max(used, 1) * st.tab.c.shape[0]
    state_noise(mech, k, y, st, c, h, KAPPA)
    return used > 0


@kernel
def sign_slip(mech: Mech, k: Moving, y: State, c: Control) -> None:
    """Let slip in several directions beyond its end have a negative speed, as that of a series has; see ``k.form``."""
    for p in range(y.mode.shape[0]):
        if y.mode[p] == SLIP and plane(mech, p) and k.form[p] == 0:
            k.form[p] = 1
            c.made = 0.0


@block
def try_step(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> bool:
    """As ``solve_stages``; where factors of another step do not get there, by its own.  By a series where that does."""
    if has_dense_rows(mech):
        measure(mech, c, y, h, st.scale)
        if solve_by_series(mech, k, y, st, h, KAPPA * asked(c)):
            c.counts[2] += st.tab.c.shape[0]
            sign_slip(mech, k, y, c)
            return True
    if solve_stages(mech, k, y, st, c, h):
        return True
    if c.made == 0.0 or c.made == h:
        return False
    c.made = 0.0
    return bool(solve_stages(mech, k, y, st, c, h))


#: Steps that have not been solved, and their part of those accepted, from which on slopes of laws are those of stages.
VAIN, VAIN_PART = 4, 0.02


@kernel
def takes_slopes(c: Control, st: Stages) -> bool:
    """Whether steps have so often not been solved that slopes of smooth laws are to be those of every stage."""
    steep = st.steep
    few = c.counts[5] < VAIN or c.counts[5] < VAIN_PART * c.counts[0]
    if few or steep.on == 1 or steep.row.shape[0] == 0:
        return False
    steep.on = 1
    c.made = 0.0
    return True


@kernel
def has_joints(y: State) -> bool:
    """Whether there are constraints."""
    return bool(y.lam.shape[0] > 0)


@kernel
def error_of(c: Control, y: State, st: Stages, h: float) -> float:
    """Estimated error of velocities, positions and states within the step, over the tolerance.

    The last term of their Legendre series.  That of a velocity that swings passes through 0 twice a period, where that
    of its position is largest.
    """
    last, tab = 0.0, st.tab
    for i in range(y.v.shape[0]):
        # where a load has just passed the cone the acceleration was still 0
        size = or_reached(st.scale[i], largest_in_step(y.v[i], st.V, i))
        high = abs(by_line(tab.top[0], y.v[i], st.V, i)) / size
        # a position that has only begun to move is measured by what its velocity brings within the step
        size = max(c.q[i], largest_in_step(y.q[i], st.Q, i), h * size)
        last = max(last, high, abs(by_line(tab.top[0], y.q[i], st.Q, i)) / size)
    for a in range(y.z.shape[0]):
        size = max(c.z[a], largest_in_step(y.z[a], st.z, a), c.noise_z[a], 1e-290)
        last = max(last, abs(by_line(tab.top[0], y.z[a], st.z, a)) / size)
    return float(last / asked(c))


@kernel
def settle(mech: Mech, k: Moving, w: Instant, end: State) -> bool:
    """Move the end of a step onto the constraints; accelerations, reactions and friction forces that hold there.

    Where positions have moved, what sticks would slip, and each next step begin with a jump to where it does not.
    """
    held, joints = False, has_joints(end)
    for c in range(end.mode.shape[0]):
        held = held or end.mode[c] == STICK
    if joints and not project_positions(mech, k, w, end):
        return False
    if (joints or held) and not project_velocities(mech, k, w, end, joints, held):
        return False
    return bool(react(mech, k, w, end, joints))


@kernel
def last_stage(mech: Mech, y: State, end: State, st: Stages) -> None:
    """Put the last stage of a step from y into ``end``; modes are those of y."""
    s = st.tab.c.shape[0]
    for part, target in ((st.Q, end.q), (st.V, end.v), (st.z, end.z), (st.lam, end.lam), (st.F, end.F)):
        for a in range(target.shape[0]):
            target[a] = part[s - 1, a]
    for part, target in ((st.acc, end.a), (y.n, end.n)):
        for a in range(target.shape[0]):
            target[a] = part[a]
    for a in range(y.mode.shape[0]):
        end.mode[a] = y.mode[a]
    aim(mech, end.mode, end.F, end.n)


@block
def end_step(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, h: float) -> bool:
    """The end of the step: values of the last stage on the constraints, and all that follows there."""
    s = st.tab.c.shape[0]
    n_c = y.mode.shape[0]
    end.t = y.t + h
    last_stage(mech, y, end, st)
    if not settle(mech, k, w, end):
        return False
    # energies: the stages' powers, integrated by the formula itself
    bring_up_to_date(mech, k, y, st, h)
    for i in range(s):
        stage_powers(mech, k, y, st, c, h, i)
    for a in range(n_c + 2):
        end.work[a] = y.work[a]
        for i in range(s):
            end.work[a] += h * st.tab.b[i] * c.power[i, a]
    return True


@kernel
def stage_powers(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, i: int) -> None:
    """Powers at stage i, whose slip and loads are up to date, into ``c.power[i]``."""
    move(mech, k, y.t + st.tab.c[i] * h, st.Q[i], st.V[i])
    if k.s.ddu.shape[0] > 0:  # forces on signals
        if st.plain == 1:
            forces_on_signals(mech, k, st.F[i])
        else:
            forces(mech, k, st.lam[i], st.F[i], st.N[i], st.g[i])
    powers(mech, k, st.F[i], st.g[i], st.N[i], c.power[i])


@kernel
def step_to(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, h: float) -> bool:
    """Solve a step h from y and put its end into ``end``; False where it could not be made."""
    solved = try_step(mech, k, y, st, c, h)
    return bool(solved and end_step(mech, k, w, y, end, st, c, h))
