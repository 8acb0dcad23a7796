"""One step of a one-step method under given modes: its stages, and its end.  Its error is in ``step_error``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch, normal_force, powers, set_instant
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, Floats
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, is_exact, widest
from fricmb.integrate.step.stage_predictor import start_at_rest, start_on_last
from fricmb.integrate.step.stages import Stages, solve_stages
from fricmb.integrate.step.step_control import ONE_STEP_RUNGS, ladder
from fricmb.integrate.step.step_matrix import prepare

#: Part of the round-off of velocities that a step is solved to.
BARE = 0.1


@kernel
def slip_way(packed: Packed, acc: Accuracy, y: State, k: int, h: float) -> float:
    """Size of the way that contact k slips: that of the positions, or what a step h from y may add.

    In a step that is long beside it, slip that velocities do not show moves a body, and its springs, by more than the
    tolerance of positions.
    """
    way = 0.0
    for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
        here = h * abs(y.g[a])
        for i in range(y.q.shape[0]):
            here += abs(packed.ports.W[i, a]) * (acc.q[i] + h * (acc.floor_v[i] + h * abs(y.a[i])))
        way = max(way, here)
    return way


@kernel
def newton_tolerances(
    packed: Packed, acc: Accuracy, h: float, y: State, tol: Floats, scale: Floats, part: float
) -> None:
    """Accuracy to which a step is solved: of velocities (n,), of relative ones and states ``tol`` (n_c + n_z,).

    What is held at rest has no velocity but round-off of the forces on it (see ``step_error``): to ask for less than
    that is to ask for what no step can give.
    """
    top = widest(acc.v)
    relative = max(part * acc.rtol, 1e-14)
    moving = 0.0
    for i in range(scale.shape[0]):
        # what only begins to move is measured by what it may reach within the step
        here = max(acc.v[i], abs(y.v[i]) + h * abs(y.a[i]), acc.floor_v[i], 1e-10 * top, 1e-290)
        moving = max(moving, here)
        scale[i] = max(relative * here, BARE * acc.grain[i])
    n_c = acc.r.shape[0]
    for k in range(n_c):
        tol[k] = relative * max(acc.r[k], 1e-8 * moving, acc.noise, 1e-290)
        if packed.ports.law[k] == LAW_SMOOTH:
            # of what has not moved the way is 0
            tol[k] = min(tol[k], max(relative * slip_way(packed, acc, y, k, h) / h, 1e-290))
            continue
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            for i in range(scale.shape[0]):
                tol[k] = max(tol[k], BARE * abs(packed.ports.W[i, a]) * acc.grain[i])
    for a in range(y.z.shape[0]):
        tol[n_c + a] = relative * max(acc.z[a], abs(y.z[a]) + h * abs(y.zd[a]))


@kernel
def prepare_at(packed: Packed, s: Scratch, y: State, one: OneStep, h: float, keep: bool) -> bool:
    """Factors for a step h from y, with the Jacobian there where it changes; see ``prepare``."""
    again = packed.elements.address.shape[0] > 0 or one.w.Fin.shape[1] > y.F.shape[0]
    if again:
        set_instant(packed.signals, s, y.t, y.q, y.v)
    return prepare(packed, one.tab, s, one.fac, one.w, one.counts, h, again, keep)


@declared
def exact_attempt(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """:func:`attempt` on an exact structure; see ``collocation.attempt_step``."""
    raise NotImplementedError


@declared
def exact_finish(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """:func:`finish` on an exact structure; see ``collocation.finish_step``."""
    raise NotImplementedError


@kernel
def attempt(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """Solve a step h from y (values in ``one.st``, ``one.w``).  False without convergence."""
    if is_exact(one):
        return exact_attempt(packed, s, y, one, acc, h)
    return radau_attempt(packed, s, y, one, acc, h)


@kernel
def finish(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """Put the end of the step into y, with forces and accelerations."""
    if is_exact(one):
        return exact_finish(packed, s, y, one, acc, h)
    return radau_finish(packed, s, y, one, acc, h)


@block
def radau_attempt(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """:func:`attempt` by the stages of Radau IIA."""
    n = y.q.shape[0]
    st, w, tab = one.st, one.w, one.tab
    if not prepare_at(packed, s, y, one, h, h == ladder(h, ONE_STEP_RUNGS)):
        return False
    for i in range(n):
        st.psi_v[i] = y.v[i]
        st.psi_q[i] = y.q[i]
    for a in range(y.z.shape[0]):
        w.psi_z[a] = y.z[a]
    for i in range(tab.c.shape[0]):
        st.t[i] = y.t + tab.c[i] * h
        for j in range(tab.c.shape[0]):
            st.hA[i, j] = h * tab.A[i, j]
    newton_tolerances(packed, acc, h, y, one.tol, one.scale, 1e-3)
    found = start_on_last(packed, y, tab, st, w, one.last_t, one.last_h, h) and solve(packed, s, y, one)
    if not found:
        start_at_rest(packed, y, tab, st, w, h)
        found = solve(packed, s, y, one)
    one.last_t = y.t
    one.last_h = h if found else 0.0
    if found and w.Fin.shape[1] > y.F.shape[0]:
        for j in range(tab.c.shape[0]):
            from_stage(packed, s, st, j)
            for k in range(y.mode.shape[0]):
                one.N[j, k] = normal_force(packed.ports, packed.normals, k, s)
                found = found and abs(one.N[j, k]) < np.inf
    return found


@kernel
def solve(packed: Packed, s: Scratch, y: State, one: OneStep) -> bool:
    """Solve the stages from the values that stand in them."""
    one.counts[2] += one.tab.c.shape[0]
    return solve_stages(packed, one.tab, s, one.fac, one.st, one.w, y.mode, one.tol, one.scale) > 0


@kernel
def state_noise(packed: Packed, one: OneStep, acc: Accuracy, h: float) -> None:
    """Sizes of internal states that are noise: their force moves the contact by a trifle of its speed within h.

    By the largest force that a unit of the state has made so far: what makes none now may do so again (Karnopp's hold,
    out of its band).
    """
    ports, w = packed.ports, one.w
    top = widest(acc.v)
    for k in range(ports.law.shape[0]):
        row0 = ports.row[k]
        d = ports.row[k + 1] - row0
        z0 = ports.z_start[k]
        for i in range(ports.z_start[k + 1] - z0):
            moved = 1e-290
            for a in range(d):
                slope = max(abs(w.L[w.F.shape[0] - 1, k, a, d + 1 + i]), w.slope[z0 + i])
                moved = max(moved, h * ports.D[row0 + a, row0 + a] * slope)
            one.noise_z[z0 + i] = min(1e-6 * max(acc.r[k], 1e-10 * top, acc.noise) / moved, 1e290)


@block
def radau_finish(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> bool:
    """:func:`finish` by the stages of Radau IIA."""
    st, w, tab = one.st, one.w, one.tab
    n_s = tab.c.shape[0]
    y.t = y.t + h
    for i in range(y.q.shape[0]):
        way = y.low[i]
        for j in range(n_s):
            way += st.hA[n_s - 1, j] * st.V[j, i]
        add_to_position(y, i, way)
        v = st.V[n_s - 1, i]
        # what rests would creep on in denormal numbers, which cost time and say nothing
        y.v[i] = v if abs(v) > 1e-290 else 0.0
    for a in range(y.z.shape[0]):
        y.z[a] = w.z[n_s - 1, a]
    for a in range(y.n.shape[0]):
        y.n[a] = w.n[n_s - 1, a]
    return complete(packed, s, y, w.sizes, w.pivots)


@kernel
def add_to_position(y: State, i: int, way: float) -> None:
    """Move position i by ``way`` (which holds y.low); what round-off takes is kept for the next step (Kahan)."""
    new = y.q[i] + way
    y.low[i] = way - (new - y.q[i])
    y.q[i] = new


@kernel
def update_scales(packed: Packed, y: State, one: OneStep, acc: Accuracy) -> None:
    """Running maxima over the stages of an accepted step."""
    for j in range(one.tab.c.shape[0]):
        for i in range(y.q.shape[0]):
            acc.q[i] = max(acc.q[i], abs(one.st.Q[j, i]))
            acc.v[i] = max(acc.v[i], abs(one.st.V[j, i]))
    update_port_scales(packed, one, acc)


@kernel
def update_port_scales(packed: Packed, one: OneStep, acc: Accuracy) -> None:
    """Of these maxima those of contacts: states of laws, what forces follow from them, and slip speeds."""
    ports, w = packed.ports, one.w
    for j in range(one.tab.c.shape[0]):
        for a in range(acc.z.shape[0]):
            acc.z[a] = max(acc.z[a], abs(w.z[j, a]))
        for k in range(acc.r.shape[0]):
            acc.r[k] = max(acc.r[k], magnitude(ports.row, k, w.g[j]))
            d, z0 = ports.row[k + 1] - ports.row[k], ports.z_start[k]
            for i in range(ports.z_start[k + 1] - z0):
                for a in range(d):
                    w.slope[z0 + i] = max(w.slope[z0 + i], abs(w.L[j, k, a, d + 1 + i]))


@kernel
def add_work(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> None:
    """Powers at the stages of an accepted step, and the energies at its end y from them."""
    for j in range(one.tab.c.shape[0]):
        from_stage(packed, s, one.st, j)
        powers(packed, s, one.w.F[j], one.w.N[j], one.w.g[j], one.power[j])
        for k in range(y.rate.shape[0]):
            y.work[k] += h * one.tab.b[j] * one.power[j, k]


@kernel
def from_stage(packed: Packed, s: Scratch, st: Stages, j: int) -> None:
    """X at stage j."""
    set_instant(packed.signals, s, st.t[j], st.Q[j], st.V[j])
