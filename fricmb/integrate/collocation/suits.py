"""Where collocation of the port forces is the fastest way to a tolerance, and where another integrator is better."""

from __future__ import annotations

import math

import numpy as np

from fricmb.integrate.collocation.exact_room import free_blocks
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import LAW_CONSTANT, LAW_SMOOTH, NORMAL_EXPRESSION, Problem

#: Port rows up to which steps are cheaper than those of BDF and Radau: under coefficients that vary, under constant
#: friction, where all of them are friction's, and under constant friction at tight tolerances or where there are far
#: more degrees of freedom.  With 6 to 12 rows of friction (elliptic, stacked in the plane) collocation took 0.3 to 0.9
#: of the time of the others at 1e-4 and 1e-6, 0.9 to 1.3 at 1e-2; with 8 to 18 rows of which a third or a half are
#: normal forces that vary 0.5 to 0.7 at 1e-6, 0.8 to 1.2 at 1e-4, 1.7 to 2.4 at 1e-2.
VARYING_ROWS, FEW_ROWS, FRICTION_ROWS, MOST_ROWS = 2, 4, 12, 16
#: Tolerance that counts as tight.
TIGHT = 1e-5
#: Degrees of freedom per port row beyond which condensing to the ports pays at any tolerance, and largest structure.
WIDE, LARGEST = 5, 400

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


def port_rows(problem: Problem) -> int:
    """Unknown port forces of a node: friction, varying normal forces, local forces of elements."""
    return problem.m + problem.n_v + int(problem.elements.f_start[-1])


def against(problem: Problem, rtol: float) -> str | None:
    """Why another integrator is to be preferred for a problem that collocation takes, or None.

    Measured over some sixty scenes, see docs/explanation/collocation.md.
    """
    contacts = problem.contacts
    if problem.n_c == 0:
        return "no contact"
    if problem.n_z or np.any(contacts.law == LAW_SMOOTH):
        return "a regularised or bristle law, whose own fast states hold the steps"
    if problem.bends.table.address.size:
        return "a force that bends with the motion, where steps of the general method end"
    if np.any(contacts.piecewise):
        return "a friction law by table, which polynomials through a step do not follow"
    if np.any(contacts.normal == NORMAL_EXPRESSION) and np.any(contacts.law != LAW_CONSTANT):
        return "a normal force that is prescribed, under a coefficient that varies"
    rows, n = port_rows(problem), problem.n
    if n > LARGEST:
        return f"{n} degrees of freedom, more than {LARGEST}"
    limit = FRICTION_ROWS if rows == problem.m else FEW_ROWS
    if np.any(contacts.law != LAW_CONSTANT):
        limit = VARYING_ROWS
    elif rtol <= TIGHT:
        limit = MOST_ROWS
    if n >= WIDE * rows:
        limit = MOST_ROWS
    if rows > limit:
        loose = " at this tolerance" if limit in (FEW_ROWS, FRICTION_ROWS) else ""
        return f"{rows} port rows, more than {limit}{loose}"
    return None
