"""All contacts of a step together: a convex problem, solved by proximal steps with a semismooth Newton method inside.

With balls fixed, the step minimises over v (for symmetric K)

    v^T A v / 2 - b^T v + h sum_c sigma_c(-g_c(v)),   sigma_c the support function of ball c, negated argument.

The proximal (augmented Lagrangian) iteration F <- P(F - R g) of Rockafellar (1976) converges from any start; with a
large R each of its steps gains some five digits.  The problem inside each,

    v^T A v / 2 - b^T v + h sum_c theta_c(F_c - R_c g_c) / R_c,   grad theta = P, the projection on the ball,

is smooth and strictly convex; Newton's method with the generalised derivative of P (Alart and Curnier 1991, Qi and
Sun 1993), its steps halved until this merit falls, converges from any start, too.  The matrix A + h W R P' W^T keeps
the band of the structure (the contacts' own couplings are in it).  With few contacts on many dofs the unknowns are phi
(m,) in v = v_free + h A^-1 W phi, the merit phi^T D phi / 2 + sum theta / R, and the matrix 1 + R P' D.
"""

from __future__ import annotations

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.block_places import PLACES
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_real
from fricmb.integrate.problem import Floats, Floats2, Ints
from fricmb.integrate.run.stop import stopped
from fricmb.integrate.timestepping._balls import all_flat, keep_piece, project, residual, same_piece
from fricmb.integrate.timestepping._band import (
    add_contacts,
    assemble,
    factorise,
    solve,
    times_matrix,
)
from fricmb.integrate.timestepping._layout import CONDENSED, N_NEWTON, RESIDUAL
from fricmb.integrate.timestepping._run import Run

#: Most proximal steps, Newton steps and halvings.
PROXIMAL, NEWTON, HALVINGS = 40, 60, 40
#: Relative size of a Newton step after which no further one is taken.
ENOUGH = 1e-7
DGESV = PLACES.index("dgesv")


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
    for a in range(g.shape[0]):
        for e in range(run.w_start[a], run.w_start[a + 1]):
            r[run.w_dof[e]] -= h * run.w_coef[e] * run.P[a]
    return value


@block
def newton_band(run: Run, h: float, F: Floats, g: Floats, places: Ints) -> bool:
    """Minimise the merit over dv."""
    n = run.dv.shape[0]
    r = run.turn
    merit = band_merit(run, h, F, run.dv, g, r)
    flat_steps = 0
    for _ in range(NEWTON):
        if stopped():
            return False
        run.i[N_NEWTON] += 1
        slot = factors_of(run, h)
        keep_piece(run)
        flat = all_flat(run)
        solve(run, run.lu[slot], r, run.trial)
        step = run.trial
        size = 0.0
        scale = 0.0
        for i in range(n):
            step[i] = -r[i]
            size = max(size, abs(step[i]))
            scale = max(scale, abs(run.dv[i]))
        factor = 1.0
        before = merit
        for _ in range(HALVINGS):
            if stopped():
                break
            for i in range(n):
                run.dv[i] += factor * step[i]
            merit = band_merit(run, h, F, run.dv, g, r)
            if merit <= before + 1e-11 * abs(before) or factor * size <= 1e-9 * scale:
                break
            for i in range(n):
                run.dv[i] -= factor * step[i]
            factor *= 0.5
        if factor == 1.0 and flat and same_piece(run):
            return True
        # a full step of this size leaves its square; the merit cannot tell smaller ones from round-off
        flat_steps = flat_steps + 1 if merit > before - 1e-11 * abs(before) else 0
        if size <= ENOUGH * (scale + size) + 1e-300 or flat_steps == 4:
            return True
    return False


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
def newton_condensed(run: Run, D: Floats2, F: Floats, g: Floats, places: Ints) -> bool:
    """Minimise the merit over phi."""
    m = run.phi.shape[0]
    merit = condensed_merit(run, F, D, run.phi, g)
    flat_steps = 0
    for _ in range(NEWTON):
        if stopped():
            return False
        run.i[N_NEWTON] += 1
        for c in range(run.status.shape[0]):
            row0 = run.row[c]
            d = run.row[c + 1] - row0
            for a in range(row0, row0 + d):
                for b in range(m):
                    value = 1.0 if a == b else 0.0
                    for k in range(row0, row0 + d):
                        value += run.H[3 * c + (a - row0) + (k - row0)] * D[k, b]
                    run.J[a * m + b] = value
                run.rhs[a] = run.P[a] - run.phi[a]
        keep_piece(run)
        flat = all_flat(run)
        solve_real(places[DGESV], run.J, run.rhs, m, run.sizes, run.pivots)
        size = 0.0
        scale = 0.0
        for a in range(m):
            run.move[a] = run.rhs[a]
            size = max(size, abs(run.move[a]))
            scale = max(scale, abs(run.phi[a]))
        factor = 1.0
        before = merit
        for _ in range(HALVINGS):
            if stopped():
                break
            for a in range(m):
                run.phi[a] += factor * run.move[a]
            merit = condensed_merit(run, F, D, run.phi, g)
            if merit <= before + 1e-11 * abs(before) or factor * size <= 1e-9 * scale:
                break
            for a in range(m):
                run.phi[a] -= factor * run.move[a]
            factor *= 0.5
        if factor == 1.0 and flat and same_piece(run):
            return True
        # a full step of this size leaves its square; the merit cannot tell smaller ones from round-off
        flat_steps = flat_steps + 1 if merit > before - 1e-11 * abs(before) else 0
        if size <= ENOUGH * (scale + size) + 1e-300 or flat_steps == 4:
            return True
    return False


@kernel
def solve_contacts(run: Run, slot: int, h: float, F: Floats, g: Floats, places: Ints) -> bool:
    """Forces F of all contacts and g at the end of the step; F holds a first guess.

    The residual |F - P(F - g / soft)| is at most ``x[RESIDUAL]`` times the largest radius.
    """
    condensed = run.i[CONDENSED] == 1
    largest = 0.0
    for c in range(run.status.shape[0]):
        largest = max(largest, run.rho[c])
    found = False
    for a in range(F.shape[0]):
        run.phi[a] = F[a]
    for _ in range(PROXIMAL):
        if stopped():
            break
        if condensed:
            fine = newton_condensed(run, run.D[slot], F, g, places)
        else:
            fine = newton_band(run, h, F, g, places)
        for a in range(F.shape[0]):
            F[a] = run.P[a]
        if fine and residual(run, F, g) <= run.x[RESIDUAL] * largest:
            found = True
            break
    return found
