"""Newton's method for the proximal step in the band: unknown is the change of v."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.kernel_library import long_loops
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.stopped import stopped
from fricmb.integrate.timestepping.band import add_contacts, assemble, factorise, solve, times_matrix
from fricmb.integrate.timestepping.descent import HALVINGS, LEAPS, NEWTON, falls, judge_step, leaps_pay
from fricmb.integrate.timestepping.friction_discs import all_flat, hold_skipped, keep_piece, project, same_piece
from fricmb.integrate.timestepping.room import Run


@kernel
def relative(run: Run, dv: Floats, g: Floats) -> None:
    """G at the end of the step (m,) from the change of v; ``gf`` holds that without change."""
    for a in range(g.shape[0]):
        value = run.gf[a]
        for e in range(run.w_start[a], run.w_start[a + 1]):
            value += run.w_coef[e] * dv[run.w_dof[e]]
        g[a] = value


@kernel
def factors_of(run: Run, h: float) -> int:
    """Slot with the factors for this h and the weights in H; made where there are none."""
    last = run.H.shape[0]
    oldest = 0
    for k in range(run.used.shape[0]):
        run.used[k] += 1
        if run.used[k] > run.used[oldest]:
            oldest = k
    for k in range(run.used.shape[0]):
        if run.of[k, last] != h:
            continue
        same = True
        for e in range(last):
            if run.of[k, e] != run.H[e]:
                same = False
                break
        if same:
            run.used[k] = 0
            return k
    run.used[oldest] = 0
    run.of[oldest, last] = h
    for e in range(last):
        run.of[oldest, e] = run.H[e]
    assemble(run, h, run.lu[oldest])
    add_contacts(run, h, run.H, run.lu[oldest])
    factorise(run, run.lu[oldest])
    return oldest


@kernel
def band_merit(run: Run, h: float, F: Floats, dv: Floats, g: Floats, r: Floats) -> float:
    """The merit at dv, and its gradient into r."""
    relative(run, dv, g)
    value = h * project(run, F, g)
    times_matrix(run, h, dv, r)
    for i in range(dv.shape[0]):
        value += dv[i] * (0.5 * r[i] - h * run.free[i])
        r[i] -= h * run.free[i]
    add_forces(run, h, run.P, r)
    return value


@kernel
def add_forces(run: Run, h: float, P: Floats, r: Floats) -> None:
    """What forces P add to the gradient of the merit."""
    for a in range(P.shape[0]):
        for e in range(run.w_start[a], run.w_start[a + 1]):
            r[run.w_dof[e]] -= h * run.w_coef[e] * P[a]


@block
@long_loops
def newton_band(run: Run, h: float, F: Floats, g: Floats) -> bool:
    """Minimise the merit over dv."""
    n = run.dv.shape[0]
    r, dv, step, base = run.turn, run.dv, run.trial, run.base
    merit = band_merit(run, h, F, dv, g, r)
    low, flat_steps, leaps = merit, 0, 0
    wary = not leaps_pay(run)
    for _ in range(NEWTON):
        if stopped():
            return False
        run.n_newton += 1
        slot = factors_of(run, h)
        keep_piece(run)
        flat = all_flat(run)
        solve(run, run.lu[slot], r, step)
        size = 0.0
        scale = 0.0
        for i in range(n):
            step[i] = -r[i]
            size = max(size, abs(step[i]))
            scale = max(scale, abs(dv[i]))
        if leaps == 0:
            low = merit
            for i in range(n):
                base[i] = dv[i]
        factor = 1.0
        for _ in range(HALVINGS):
            if stopped():
                break
            for i in range(n):
                dv[i] += factor * step[i]
            merit = band_merit(run, h, F, dv, g, r)
            if not wary or falls(merit, low) or factor * size <= 1e-9 * scale:
                break
            for i in range(n):
                dv[i] -= factor * step[i]
            factor *= 0.5
        if factor == 1.0 and flat and same_piece(run):
            return True
        done, flat_steps, leaps = judge_step(merit, low, size, scale, wary, flat_steps, leaps)
        if done:
            return True
        if leaps > LEAPS:
            # in vain: back to where they began, and no more of them
            for i in range(n):
                dv[i] = base[i]
            merit = band_merit(run, h, F, dv, g, r)
            leaps, wary = 0, True
        if not wary:
            hold_skipped(run, F, g)
            add_forces(run, h, run.move, r)
    return False
