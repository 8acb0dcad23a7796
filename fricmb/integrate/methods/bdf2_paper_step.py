"""Steps of the published scheme: BDF2 inside a mode, backward Euler where it changes, stick tried first.

Kinkaid, O'Reilly and Papadopoulos (2005), Eqs. (12) to (14); see :mod:`~fricmb.integrate.methods.bdf2_paper`.
"""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel, run_entry
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.contact.transition import record_changes
from fricmb.integrate.methods.attempt_step import incomplete
from fricmb.integrate.methods.time_loop import crowded
from fricmb.integrate.model.accelerations import complete
from fricmb.integrate.model.forces import Scratch, normal_force, set_instant
from fricmb.integrate.model.friction_cone import cone_margin
from fricmb.integrate.model.law_values import magnitude, point_along
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State, copy_state
from fricmb.integrate.output.recorder import AFTER, BEFORE, STEP, Rows, record
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, STICK, Codes, Floats
from fricmb.integrate.run.outcomes import DONE, FAIL_LAW, FAIL_STEP, FULL, SLICE_OVER
from fricmb.integrate.run.slices import slice_over, ticks
from fricmb.integrate.step.one_step import newton_tolerances, prepare_at
from fricmb.integrate.step.one_step_room import Accuracy, OneStep
from fricmb.integrate.step.stage_predictor import contacts_from_start
from fricmb.integrate.step.stages import solve_stages


class Last(Layout):
    """The step before: values ``y`` (n_y,), ``h`` its size (0: none), its modes and directions; trial modes."""

    y: Floats
    h: float
    mode: Codes
    n: Floats
    trial: Codes


@kernel
def formula(y: State, one: OneStep, last: Last, h: float, two: bool) -> float:
    """Put the history of the step into psi; returns b h, of BDF2 (``two``) or backward Euler."""
    n = y.q.shape[0]
    h0 = last.h
    a1, a2, b = 0.0, 1.0, 1.0
    if two:
        a1 = -h * h / (h0 * (h0 + 2.0 * h))
        a2 = (h0 + h) ** 2 / (h0 * (h0 + 2.0 * h))
        b = (h0 + h) / (h0 + 2.0 * h)
    for i in range(n):
        one.st.psi_q[i] = a1 * last.y[i] + a2 * y.q[i]
        one.st.psi_v[i] = a1 * last.y[n + i] + a2 * y.v[i]
    for i in range(y.z.shape[0]):
        one.w.psi_z[i] = a1 * last.y[2 * n + i] + a2 * y.z[i]
    return b * h


@block
def solve_with(
    packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, last: Last, mode: Codes, h: float
) -> bool:
    """Solve the step for the given modes."""
    st, w = one.st, one.w
    same = last.h > 0.0
    for k in range(mode.shape[0]):
        if mode[k] != last.mode[k]:
            same = False
    beta_h = formula(y, one, last, h, same)
    if not prepare_at(packed, s, y, one, beta_h, True):
        return False
    st.t[0] = y.t + h
    st.hA[0, 0] = beta_h
    for i in range(y.q.shape[0]):
        st.V[0, i] = y.v[i]
    contacts_from_start(packed, y, w, 0)
    newton_tolerances(packed, acc, h, y, one.tol, one.scale, 1e-3)
    one.counts[2] += 1
    return solve_stages(packed, one.tab, s, one.fac, st, w, mode, one.tol, one.scale) > 0


@kernel
def revise(packed: Packed, s: Scratch, y: State, one: OneStep, mode: Codes) -> bool:
    """Change the modes that the solution just found contradicts; True where there are any."""
    ports, w = packed.ports, one.w
    changed = False
    set_instant(packed.signals, s, one.st.t[0], one.st.Q[0], one.st.V[0])
    for k in range(mode.shape[0]):
        if ports.var[k] >= 0:
            N = normal_force(ports, packed.normals, k, s)
            if (N <= 0.0) != (mode[k] == OPEN):
                mode[k] = OPEN if N <= 0.0 else SLIP
                changed = True
                continue
        if ports.law[k] == LAW_SMOOTH or mode[k] != STICK:
            continue
        if cone_margin(ports, packed.laws, k, s, w.F[0], w.N[0, k]) < 0.0:
            mode[k] = SLIP
            changed = True
            point_along(ports.row, k, w.F[0], -1.0, y.n)
    return changed


@run_entry
def drive_paper(
    packed: Packed, s: Scratch, y: State, end: State, one: OneStep, acc: Accuracy, last: Last, out: Rows, h: float,
    t_end: float,
) -> int:  # fmt: skip
    """Step from y to ``t_end``, or until the space for rows is used up."""
    n = y.q.shape[0]
    begun = ticks()
    while True:
        if crowded(out, 2, y.mode.shape[0]):
            return FULL
        left = t_end - y.t
        if left <= 1e-12 * max(abs(t_end), abs(y.t)):
            return DONE
        step = h if left > h * (1.0 + 1e-9) else left
        for k in range(y.mode.shape[0]):
            last.trial[k] = SLIP if packed.ports.law[k] == LAW_SMOOTH else (OPEN if y.mode[k] == OPEN else STICK)
        settled = False
        for _ in range(3 * y.mode.shape[0] + 3):
            if not solve_with(packed, s, y, one, acc, last, last.trial, step):
                return FAIL_STEP
            if not revise(packed, s, y, one, last.trial):
                settled = True
                break
        if not settled:
            return FAIL_STEP
        copy_state(y, end)
        end.t = y.t + step if step < left else t_end
        for i in range(n):
            end.q[i] = one.st.Q[0, i]
            end.v[i] = one.st.V[0, i]
        for i in range(y.z.shape[0]):
            end.z[i] = one.w.z[0, i]
        for k in range(y.mode.shape[0]):
            end.mode[k] = last.trial[k]
        for a in range(y.n.shape[0]):
            end.n[a] = one.w.n[0, a]
        if not complete(packed, s, end, one.w.sizes, one.w.pivots):
            return incomplete(end)
        if end.fault > 0.0:
            return FAIL_LAW
        for i in range(y.rate.shape[0]):
            end.work[i] = y.work[i] + 0.5 * step * (y.rate[i] + end.rate[i])
        # the published scheme takes the force from the step's own equations
        for a in range(y.F.shape[0]):
            end.F[a] = one.w.F[0, a]
        if record_changes(packed.ports, end.t, end, last, out):
            for k in range(y.mode.shape[0]):
                end.mode[k] = y.mode[k]
            record(out, end, BEFORE)
            for k in range(y.mode.shape[0]):
                end.mode[k] = last.trial[k]
            record(out, end, AFTER)
        else:
            record(out, end, STEP)
        for i in range(n):
            last.y[i] = y.q[i]
            last.y[n + i] = y.v[i]
            acc.q[i] = max(acc.q[i], abs(end.q[i]))
            acc.v[i] = max(acc.v[i], abs(end.v[i]))
        for i in range(y.z.shape[0]):
            last.y[2 * n + i] = y.z[i]
        for k in range(y.mode.shape[0]):
            last.mode[k] = end.mode[k]
            acc.r[k] = max(acc.r[k], magnitude(packed.ports.row, k, end.g))
        for a in range(y.n.shape[0]):
            last.n[a] = end.n[a]
        last.h = step
        one.counts[0] += 1
        copy_state(end, y)
        if slice_over(begun):
            return SLICE_OVER
