"""Newton's method for the proximal step with few contacts on many dofs: unknowns are the impulses of contacts."""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.kernel_library import long_loops
from fricmb.integrate.compile.lapack import solve_real
from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.run.stopped import stopped
from fricmb.integrate.timestepping.descent import HALVINGS, LEAPS, NEWTON, falls, judge_step, leaps_pay
from fricmb.integrate.timestepping.friction_discs import all_flat, hold_skipped, keep_piece, project, same_piece
from fricmb.integrate.timestepping.room import Run


@kernel
def condensed_merit(run: Run, F: Floats, D: Floats2, phi: Floats, g: Floats) -> float:
    """The merit at phi; g = gf + D phi."""
    m = phi.shape[0]
    value = 0.0
    for a in range(m):
        part = 0.0
        for b in range(m):
            part += D[a, b] * phi[b]
        g[a] = run.gf[a] + part
        value += 0.5 * phi[a] * part
    return value + project(run, F, g)


@block
@long_loops
def newton_condensed(run: Run, D: Floats2, F: Floats, g: Floats) -> bool:
    """Minimise the merit over phi."""
    m = run.phi.shape[0]
    phi, step, base = run.phi, run.move, run.base
    merit = condensed_merit(run, F, D, phi, g)
    low, flat_steps, leaps = merit, 0, 0
    wary = not leaps_pay(run)
    for _ in range(NEWTON):
        if stopped():
            return False
        run.n_newton += 1
        for c in range(run.status.shape[0]):
            row0 = run.row[c]
            d = run.row[c + 1] - row0
            for a in range(row0, row0 + d):
                for b in range(m):
                    value = 1.0 if a == b else 0.0
                    for k in range(row0, row0 + d):
                        value += run.H[3 * c + (a - row0) + (k - row0)] * D[k, b]
                    run.J[a * m + b] = value
                run.rhs[a] = run.P[a] - phi[a]
        keep_piece(run)
        flat = all_flat(run)
        solve_real(run.J, run.rhs, m, run.sizes, run.pivots)
        size = 0.0
        scale = 0.0
        for a in range(m):
            step[a] = run.rhs[a]
            size = max(size, abs(step[a]))
            scale = max(scale, abs(phi[a]))
        if leaps == 0:
            low = merit
            for i in range(m):
                base[i] = phi[i]
        factor = 1.0
        for _ in range(HALVINGS):
            if stopped():
                break
            for i in range(m):
                phi[i] += factor * step[i]
            merit = condensed_merit(run, F, D, phi, g)
            if not wary or falls(merit, low) or factor * size <= 1e-9 * scale:
                break
            for i in range(m):
                phi[i] -= factor * step[i]
            factor *= 0.5
        if factor == 1.0 and flat and same_piece(run):
            return True
        done, flat_steps, leaps = judge_step(merit, low, size, scale, wary, flat_steps, leaps)
        if done:
            return True
        if leaps > LEAPS:
            # in vain: back to where they began, and no more of them
            for i in range(m):
                phi[i] = base[i]
            merit = condensed_merit(run, F, D, phi, g)
            leaps, wary = 0, True
        if not wary:
            hold_skipped(run, F, g)
    return False
