"""All contacts of a step together: a convex problem, solved by proximal steps with a semismooth Newton method inside.

With balls fixed, the step minimises over v (for symmetric K)

    v^T A v / 2 - b^T v + h sum_c sigma_c(-g_c(v)),   sigma_c the support function of ball c, negated argument.

The proximal (augmented Lagrangian) iteration F <- P(F - R g) of Rockafellar (1976) converges from any start; with a
large R each of its steps gains some five digits.  The problem inside each,

    v^T A v / 2 - b^T v + h sum_c theta_c(F_c - R_c g_c) / R_c,   grad theta = P, the projection on the ball,

is smooth and strictly convex; Newton's method with the generalised derivative of P (Alart and Curnier 1991, Qi and
Sun 1993), its steps halved until this merit falls, converges from any start, too.  Halving is the last resort: with a
large R the merit rises where a single contact leaves its piece, so a few full steps may go on before it has to have
fallen (the watchdog of Chamberlain, Powell, Lemarechal and Pedersen 1982); if it has not, they are taken back.

The matrix A + h W R P' W^T keeps the band of the structure (the contacts' own couplings are in it).  With few contacts
on many dofs the unknowns are phi (m,) in v = v_free + h A^-1 W phi, the merit phi^T D phi / 2 + sum theta / R, and the
matrix 1 + R P' D.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.stopped import stopped
from fricmb.integrate.timestepping.friction_discs import residual
from fricmb.integrate.timestepping.newton_band import newton_band
from fricmb.integrate.timestepping.newton_condensed import newton_condensed
from fricmb.integrate.timestepping.room import Run

#: Most proximal steps.
PROXIMAL = 40


@kernel
def solve_contacts(run: Run, slot: int, h: float, F: Floats, g: Floats) -> bool:
    """Forces F of all contacts and g at the end of the step; F holds a first guess.

    The residual |F - P(F - g / soft)| is at most ``run.residual`` times the largest radius.
    """
    condensed = run.condensed == 1
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
            fine = newton_condensed(run, run.D[slot], F, g)
        else:
            fine = newton_band(run, h, F, g)
        for a in range(F.shape[0]):
            F[a] = run.P[a]
        if fine and residual(run, F, g) <= run.residual * largest:
            found = True
            break
    return found
