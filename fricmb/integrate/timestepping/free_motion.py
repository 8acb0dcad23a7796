"""What acts in a step beside friction: signals, structure, normal forces."""

from __future__ import annotations

import math

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.problem import Floats
from fricmb.integrate.timestepping.band import assemble, factorise, solve
from fricmb.integrate.timestepping.layout import NO_NUMBER
from fricmb.integrate.timestepping.room import Run


@kernel
def set_signals(run: Run, slot: int, t: float) -> None:
    """Signals, their rates and the belts' velocities of a state; on the inner side of breakpoints."""
    t = min(max(t, run.s.window[0]), run.s.window[1])
    for j in range(run.u.shape[1]):
        run.s.x[0] = t
        call(run.signals.address[j], run.s.x, 0, run.signals.p, run.signals.p_start[j], run.s.out, 0)
        run.u[slot, j] = run.s.out[0]
        run.du[slot, j] = run.s.out[1]
    for a in range(run.belt.shape[0]):
        value = run.belt[a]
        for e in range(run.wu_start[a], run.wu_start[a + 1]):
            value += run.wu_coef[e] * run.du[slot, run.wu_signal[e]]
        run.w[slot, a] = value


@kernel
def structure_forces(run: Run, one: int, two: int, h: float) -> None:
    """Mean force without contacts, were the velocity to stay: into ``free``."""
    q, v = run.q[one], run.v[one]
    half = 0.5 * h
    for i in range(q.shape[0]):
        value = run.load[i]
        for e in range(run.start[i], run.start[i + 1]):
            j = run.column[e]
            value -= run.stiff[e] * (q[j] + half * v[j]) + run.visc[e] * v[j]
        for e in range(run.in_start[i], run.in_start[i + 1]):
            k = run.in_signal[e]
            value += run.in_u[e] * 0.5 * (run.u[one, k] + run.u[two, k])
            value += run.in_du[e] * (run.u[two, k] - run.u[one, k]) / h
        run.free[i] = value


@kernel
def add_normals(run: Run, two: int, factor: float) -> None:
    """Add the normal forces that the bodies feel to ``free``, ``factor`` times."""
    for c in range(run.acts.shape[0]):
        if run.acts[c] == 1:
            force = factor * (run.push[two, c] - run.N0[c])
            for e in range(run.n_start[c], run.n_start[c + 1]):
                run.free[run.n_dof[e]] += run.n_coef[e] * force


@kernel
def find_normals(run: Run, one: int, two: int, t: float, h: float) -> float:
    """Normal forces at the middle of the step, from v one + dv; returns the largest relative change."""
    n = run.load.shape[0]
    n_u = run.u.shape[1]
    X = run.s.X
    X[0] = min(max(t + 0.5 * h, run.s.window[0]), run.s.window[1])
    for i in range(n):
        X[1 + i] = run.q[one, i] + h * (0.5 * run.v[one, i] + 0.25 * run.dv[i])
        X[1 + n + i] = run.v[one, i] + 0.5 * run.dv[i]
    for j in range(n_u):
        run.s.x[0] = X[0]
        call(run.signals.address[j], run.s.x, 0, run.signals.p, run.signals.p_start[j], run.s.out, 0)
        X[1 + 2 * n + j] = run.s.out[0]
        X[1 + 2 * n + n_u + j] = run.s.out[1]
    worst = 0.0
    for c in range(run.var.shape[0]):
        if run.var[c] == 0:
            continue
        table = run.normals
        first = table.x_start[c]
        for a in range(first, table.x_start[c + 1]):
            value = table.form_constant[a]
            for e in range(table.form_start[a], table.form_start[a + 1]):
                value += table.form_coefficient[e] * X[table.form_index[e]]
            run.s.x[a - first] = value
        call(table.address[c], run.s.x, 0, table.p, table.p_start[c], run.s.out, 0)
        if not abs(run.s.out[0]) < math.inf:
            run.fault = NO_NUMBER
        force = max(0.0, run.s.out[0])
        worst = max(worst, abs(force - run.push[two, c]) / (abs(force) + abs(run.push[two, c]) + 1e-300))
        run.push[two, c] = force
        # rate of the distance, and damping and input beside what is stored
        run.instant[c, 0] = run.s.x[1]
        run.instant[c, 1] = run.s.out[2 + table.x_start[c + 1] - first] if run.acts[c] == 1 else 0.0
    return worst


@kernel
def compliances(run: Run, h: float, slot: int) -> None:
    """Local compliance h W^T A^-1 W of each contact into ``soft`` (from the diagonal of A where D is not formed)."""
    half, quarter = 0.5 * h, 0.25 * h * h
    if run.condensed == 0:
        for i in range(run.load.shape[0]):
            for e in range(run.start[i], run.start[i + 1]):
                if run.column[e] == i:
                    run.trial[i] = run.mass[e] + half * run.visc[e] + quarter * run.stiff[e]
    for c in range(run.soft.shape[0]):
        value = 0.0
        for a in range(run.row[c], run.row[c + 1]):
            if run.condensed == 1:
                value += run.D[slot, a, a]
            else:
                for e in range(run.w_start[a], run.w_start[a + 1]):
                    value += h * run.w_coef[e] ** 2 / run.trial[run.w_dof[e]]
        run.soft[c] = value / (run.row[c + 1] - run.row[c])


@kernel
def responses(run: Run, h: float) -> int:
    """Slot with factors of A, Y = A^-1 W and D = h W^T Y for this h; made where there is none."""
    last = run.of.shape[1] - 1
    oldest = 0
    for k in range(run.used.shape[0]):
        run.used[k] += 1
        if run.of[k, last] == h:
            oldest = k
            break
        if run.used[k] > run.used[oldest]:
            oldest = k
    run.used[oldest] = 0
    if run.of[oldest, last] == h:
        return oldest
    run.of[oldest, last] = h
    assemble(run, h, run.lu[oldest])
    factorise(run, run.lu[oldest])
    m = run.belt.shape[0]
    for a in range(m):
        y = run.Y[oldest, a]
        for i in range(y.shape[0]):
            y[i] = 0.0
        for e in range(run.w_start[a], run.w_start[a + 1]):
            y[run.w_dof[e]] = run.w_coef[e]
        solve(run, run.lu[oldest], y, run.trial)
        for b in range(m):
            value = 0.0
            for e in range(run.w_start[b], run.w_start[b + 1]):
                value += run.w_coef[e] * y[run.w_dof[e]]
            run.D[oldest, b, a] = h * value
    return oldest


@kernel
def free_motion(run: Run, one: int, two: int, h: float, slot: int) -> None:
    """Relative velocities at the end without friction (condensed), or with v as it is, into ``gf``."""
    if run.condensed == 1:
        for i in range(run.dv.shape[0]):
            run.turn[i] = h * run.free[i]
        solve(run, run.lu[slot], run.turn, run.trial)
    for a in range(run.gf.shape[0]):
        value = -run.w[two, a]
        for e in range(run.w_start[a], run.w_start[a + 1]):
            j = run.w_dof[e]
            value += run.w_coef[e] * (run.v[one, j] + (run.turn[j] if run.condensed == 1 else 0.0))
        run.gf[a] = value


@kernel
def add_responses(run: Run, h: float, slot: int, F: Floats) -> None:
    """The change of v under the forces found (condensed)."""
    for i in range(run.dv.shape[0]):
        run.dv[i] = run.turn[i]
    for a in range(F.shape[0]):
        y = run.Y[slot, a]
        factor = h * F[a]
        if factor != 0.0:
            for i in range(y.shape[0]):
                run.dv[i] += factor * y[i]


@kernel
def set_window(run: Run, stop: int) -> None:
    """Functions of time are evaluated between the stops around the present time."""
    low = run.stops[stop - 1] if stop > 0 else run.time
    high = run.stops[stop]
    run.s.window[0] = low + 4e-16 * abs(low) + 1e-300
    run.s.window[1] = high - 4e-16 * abs(high) - 1e-300
