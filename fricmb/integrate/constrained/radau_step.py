"""One step of given modes: predict, solve, estimate the error, return to the constraints."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.constrained.accelerations import Instant, State, powers, react
from fricmb.integrate.constrained.forces import forces, move
from fricmb.integrate.constrained.near_rest import choose_forms, prepare_turns
from fricmb.integrate.constrained.problem_structs import Mech, Moving
from fricmb.integrate.constrained.projection import project_positions, project_velocities
from fricmb.integrate.constrained.slip_rows import aim, keep_held
from fricmb.integrate.constrained.stages import Stages, factor_stages, iterate_stages, linearise
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem


class Control(NamedTuple):
    """Step control.

    ``rtol`` (1,); running maxima ``q``, ``v``, ``z`` with floors ``floor_v``; ``h`` (3,) next step, the step before,
    that step's end time; ``old`` (s+1, n + m + n_c + nz) its values at 0, c for prediction; ``counts`` work done;
    ``span`` (2,) and ``stops`` times to step to; ``mass`` (n,) diagonal of M; ``made`` (2,): step of the factors and
    time of the Jacobian; ``power`` (s, n_c+2) powers at the stages.
    """

    rtol: Floats
    v: Floats
    z: Floats
    floor_v: Floats
    h: Floats
    old: Floats2
    counts: Ints
    span: Floats
    stops: Floats
    mass: Floats
    made: Floats
    power: Floats2
    weight: Floats


def control_of(problem: Problem, st: Stages, rtol: float, v: Floats, z: Floats, floor: Floats, span: Floats,
               h: float, mass: Floats) -> Control:  # fmt: skip
    """Step control at the start of a run."""
    s, size = len(st.tab.c), len(st.x)
    return room(Control(
        np.array([rtol]), v, z, floor, np.array([h, 0.0, 0.0]), np.zeros((s + 1, size)), np.zeros(8, np.int64), span,
        np.sort(np.asarray(problem.signals.breakpoints, float)), mass, np.zeros(2), np.zeros((s, problem.n_c + 2)),
        np.zeros(s + 1),
    ))  # fmt: skip


@kernel
def measure(c: Control, y: State, h: float, scale: Floats) -> None:
    """What counts as 1 in velocities: running maxima, not less than a trifle of what the kinetic energy could bring."""
    energy = 0.0
    for i in range(scale.shape[0]):
        here = max(c.v[i], abs(y.v[i]) + h * abs(y.a[i]))
        energy = max(energy, c.mass[i] * here * here)
    for i in range(scale.shape[0]):
        here = max(c.v[i], abs(y.v[i]) + h * abs(y.a[i]), c.floor_v[i])
        scale[i] = max(here, 1e-4 * np.sqrt(energy / c.mass[i]), 1e-290)


@kernel
def predict_stages(c: Control, y: State, st: Stages, h: float) -> None:
    """Start values of the stages: the polynomial of the step before, or constant accelerations and forces."""
    n, m, n_c, nz = y.q.shape[0], y.lam.shape[0], y.F.shape[0], y.z.shape[0]
    tab = st.tab
    s = tab.c.shape[0]
    before = c.h[1]
    for i in range(s):
        x = 1.0 + tab.c[i] * h / before if before > 0.0 else 0.0
        if before <= 0.0 or x > 4.0:
            for a in range(n):
                st.V[i, a] = y.v[a] + tab.c[i] * h * y.a[a]
            for a in range(m):
                st.lam[i, a] = y.lam[a]
            for a in range(n_c):
                st.F[i, a] = y.F[a]
            for a in range(nz):
                st.Z[i, a] = y.z[a]
            continue
        for j in range(s + 1):
            node = 0.0 if j == 0 else tab.c[j - 1]
            value = 1.0
            for l in range(s + 1):
                if l != j:
                    other = 0.0 if l == 0 else tab.c[l - 1]
                    value *= (x - other) / (node - other)
            c.weight[j] = value
        for a in range(n):
            value = 0.0
            for j in range(s + 1):
                value += c.weight[j] * c.old[j, a]
            st.V[i, a] = value
        for a in range(m):
            value = 0.0
            for j in range(s + 1):
                value += c.weight[j] * c.old[j, n + a]
            st.lam[i, a] = value
        for a in range(n_c):
            value = 0.0
            for j in range(s + 1):
                value += c.weight[j] * c.old[j, n + m + a]
            st.F[i, a] = value
        for a in range(nz):
            value = 0.0
            for j in range(s + 1):
                value += c.weight[j] * c.old[j, n + m + n_c + a]
            st.Z[i, a] = value


@kernel
def remember(c: Control, y: State, st: Stages, h: float) -> None:
    """Keep this step's values for the prediction of the next; y is still its start."""
    n, m, n_c, nz = y.q.shape[0], y.lam.shape[0], y.F.shape[0], y.z.shape[0]
    for j in range(st.tab.c.shape[0] + 1):
        for a in range(n):
            c.old[j, a] = y.v[a] if j == 0 else st.V[j - 1, a]
        for a in range(m):
            c.old[j, n + a] = y.lam[a] if j == 0 else st.lam[j - 1, a]
        for a in range(n_c):
            c.old[j, n + m + a] = y.F[a] if j == 0 else st.F[j - 1, a]
        for a in range(nz):
            c.old[j, n + m + n_c + a] = y.z[a] if j == 0 else st.Z[j - 1, a]
    c.h[1] = h


#: Newton's iterations stop at this part of the tolerance.
KAPPA = 1e-3


@block
def try_step(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, address: Ints) -> bool:
    """Solve the stages of a step h from y."""
    if c.made[0] == 0.0:
        choose_forms(mech, k, y, st, h)
        linearise(mech, k, y, st, mech.address)
        c.counts[3] += 1
    if c.made[0] != h:
        c.counts[4] += 1
        if not factor_stages(mech, st, h, mech.address):
            c.made[0] = 0.0
            return False
        c.made[0] = h
        prepare_turns(mech, st)
    measure(c, y, h, st.scale)
    predict_stages(c, y, st, h)
    for i in range(st.tab.c.shape[0]):
        keep_held(mech, y.mode, y.F, st.F[i])
    used = iterate_stages(mech, k, y, st, h, max(KAPPA * c.rtol[0], 1e-14), y.mode, mech.address)
    c.counts[2] += max(used, 1) * st.tab.c.shape[0]
    return used > 0


@kernel
def error_of(c: Control, y: State, st: Stages) -> float:
    """Estimated error of the velocities within the step over the tolerance: the Legendre series, one term further."""
    tab = st.tab
    s = tab.c.shape[0]
    last = before = 0.0
    for a in range(y.q.shape[0]):
        high = tab.top[0, 0] * y.v[a]
        low = tab.top[1, 0] * y.v[a]
        for j in range(s):
            high += tab.top[0, j + 1] * st.V[j, a]
            low += tab.top[1, j + 1] * st.V[j, a]
        last = max(last, abs(high) / st.scale[a])
        before = max(before, abs(low) / st.scale[a])
    for a in range(y.z.shape[0]):
        scale = max(c.z[a], abs(y.z[a]), abs(st.Z[s - 1, a]), 1e-290)
        high = tab.top[0, 0] * y.z[a]
        low = tab.top[1, 0] * y.z[a]
        for j in range(s):
            high += tab.top[0, j + 1] * st.Z[j, a]
            low += tab.top[1, j + 1] * st.Z[j, a]
        last = max(last, abs(high) / scale)
        before = max(before, abs(low) / scale)
    ratio = min(1.0, last / before) if before > 0.0 else 1.0
    return float(last * ratio / c.rtol[0])


@kernel
def settle(mech: Mech, k: Moving, w: Instant, end: State) -> bool:
    """Move the end of a step onto the constraints; accelerations, reactions and friction forces that hold there."""
    return bool(
        project_positions(mech, k, w, end, mech.address)
        and project_velocities(mech, k, w, end, True, False, mech.address)
        and react(mech, k, w, end, True, mech.address)
    )


@block
def end_step(
    mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, h: float, address: Ints
) -> bool:
    """The end of the step: values of the last stage on the constraints, and all that follows there."""
    s = st.tab.c.shape[0]
    n_c = y.mode.shape[0]
    end.t[0] = y.t[0] + h
    for a in range(y.q.shape[0]):
        end.q[a] = st.Q[s - 1, a]
        end.v[a] = st.V[s - 1, a]
        end.a[a] = st.acc[a]
    for a in range(y.z.shape[0]):
        end.z[a] = st.Z[s - 1, a]
    for a in range(y.lam.shape[0]):
        end.lam[a] = st.lam[s - 1, a]
    for a in range(y.F.shape[0]):
        end.F[a] = st.F[s - 1, a]
        end.n[a] = y.n[a]
    for a in range(n_c):
        end.mode[a] = y.mode[a]
    aim(mech, end.mode, end.F, end.n)
    if not settle(mech, k, w, end):
        return False
    # energies: the stages' powers, integrated by the formula itself
    for i in range(s):
        stage_powers(mech, k, y, st, c, h, i)
    for a in range(n_c + 2):
        end.work[a] = y.work[a]
        for i in range(s):
            end.work[a] += h * st.tab.b[i] * c.power[i, a]
    return True


@kernel
def stage_powers(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float, i: int) -> None:
    """Powers at stage i into ``c.power[i]``."""
    move(mech, k, y.t[0] + st.tab.c[i] * h, st.Q[i], st.V[i], mech.address)
    forces(mech, k, st.lam[i], st.F[i], 0, 0, st.N[i], st.g[i], mech.address)
    powers(mech, k, st.F[i], st.g[i], st.N[i], c.power[i], mech.address)
