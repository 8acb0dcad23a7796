"""Where collocation of one contact's force is the fastest way to a tolerance, and where it does not get there."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.free_blocks import free_blocks
from fricmb.integrate.collocation.one_contact.prepare import is_single
from fricmb.integrate.model.structure import half_bandwidth
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem

#: Degrees of freedom up to which one contact under constant friction has kernels of its own, which keep some twenty
#: matrices of that size, and up to which if the structure is a narrow band.  In all, with what is made ready before: a
#: bar of 200, 400 and 1000 modes 0.1, 0.5 and 4 s, by Taylor steps 0.9, 3 s and over a minute; a dense structure of
#: 200 degrees of freedom 0.2 s and 8 s; 200 masses in a row 0.06 and 0.04 s.
FULL_MATRICES, BAND = 1600, 100

#: Ratio of squared frequencies above which an eigenproblem leaves too few digits of the slow ones, and from which what
#: is left of them is round-off of zero.
APART, NOTHING = 1e11, 5e13
#: Round-off of the sum of a row of K, relative to its diagonal.
ROW_GRAIN = 1e-15


def too_far_apart(problem: Problem) -> str | None:
    """Why exact modes are not exact enough: their frequencies differ by too much; or None.

    Eigenvalues are right to round-off of the largest: a tie 1e12 times as stiff as the spring to ground left an error
    of 1e-3 after eight periods (docs/decisions/0023-stiffness-and-round-off.md).
    """
    return once_per(problem.linear, "too far apart", lambda: _too_far_apart(problem))


def _too_far_apart(problem: Problem) -> str | None:
    w2 = np.abs(free_blocks(problem).w2)
    most = w2.max(initial=0.0)
    least = w2[w2 > most / NOTHING].min(initial=most)
    if bool((w2 <= most / NOTHING).any()) and hides_springs(problem):
        return f"frequencies of {np.sqrt(most):.3g} beside some that an eigenproblem cannot tell from 0"
    if most <= APART * least:
        return None
    slow, fast = np.sqrt(least), np.sqrt(most)
    return f"frequencies from {slow:.3g} to {fast:.3g}: an eigenproblem leaves the slow ones too few digits"


def hides_springs(problem: Problem) -> bool:
    """Whether some row of K has a sum that is more than round-off of the row, and too little for an eigenproblem.

    That is a spring to ground beside stiff ones: what looks like a free motion is none.
    """
    n, found = problem.n, False
    for i, row in enumerate(problem.linear.Kx[:n, :n].tolist()):
        total, own = abs(math.fsum(row)), abs(row[i])
        found = found or ROW_GRAIN * own < total < 10.0 / NOTHING * own
    return found


def takes_one_contact(problem: Problem) -> bool:
    """Whether the kernels for one contact under constant friction are the fastest there are."""
    if not is_single(problem):
        return False
    return problem.n <= (FULL_MATRICES if half_bandwidth(problem) <= 0 else BAND)


def against(problem: Problem, rtol: float) -> str | None:
    """Why exact structure does not give the digits that are asked for, or None."""
    return too_far_apart(problem) or once_per(problem.linear, ("calm and fast", rtol), lambda: _calm(problem, rtol))


#: Damping ratio of a mode that is calm before a slower one has moved, and how many times as fast it is if it matters.
CALM, OFTEN = 0.1, 100.0
#: Beside such modes, the tolerance down to which exact structure is right, and the damping ratio from which on they
#: creep back to rest.
BEARS_CALM_MODES, CREEPS = 1e-6, 0.99


def _calm(problem: Problem, rtol: float) -> str | None:
    """What stands against exact structure beside modes that come to rest at once, or None.

    Measured on pairs and rows of masses, some of them tied by 1e4 to 1e6 rad/s: what friction leaves in such modes at
    each turn is beyond the polynomials of a step, 1 rtol at 1e-6, 100 at 1e-8, 10 000 at 1e-10; and where they creep
    back without swinging, steps follow them, thousands where implicit ones took 150.
    """
    modes = free_blocks(problem)
    omega = np.sqrt(np.abs(modes.w2))
    if not (omega.size and modes.d.any()):
        return None
    zeta = 0.5 * modes.d / np.maximum(omega, 1e-300)
    limit = OFTEN * float(omega[zeta < CALM].max(initial=omega.min(initial=math.inf)))
    if not np.maximum(omega, np.abs(modes.d)).max() > limit > 0.0:
        return None
    if rtol >= BEARS_CALM_MODES and zeta[omega > limit].max(initial=0.0) < CREEPS:
        return None
    return f"modes that come to rest at once, more than {OFTEN:.0f} times as fast as all that vibrate"
