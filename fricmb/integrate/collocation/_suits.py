"""Where collocation of the port forces is the fastest way to a tolerance, and where another integrator is better."""

from __future__ import annotations

import numpy as np

from fricmb.integrate._problem import LAW_CONSTANT, LAW_SMOOTH, NORMAL_EXPRESSION, Problem

#: Port rows up to which steps are cheaper than those of BDF and Radau: under coefficients that vary, under constant
#: friction, and under constant friction at tight tolerances or where there are far more degrees of freedom.
VARYING_ROWS, FEW_ROWS, MOST_ROWS = 2, 4, 12
#: Tolerance that counts as tight.
TIGHT = 1e-7
#: Degrees of freedom per port row beyond which condensing to the ports pays at any tolerance, and largest structure.
WIDE, LARGEST = 5, 400


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
    if np.any(contacts.piecewise):
        return "a friction law by table, which polynomials through a step do not follow"
    if np.any(contacts.normal == NORMAL_EXPRESSION) and np.any(contacts.law != LAW_CONSTANT):
        return "a normal force that is prescribed, under a coefficient that varies"
    rows, n = port_rows(problem), problem.n
    if n > LARGEST:
        return f"{n} degrees of freedom, more than {LARGEST}"
    limit = FEW_ROWS
    if np.any(contacts.law != LAW_CONSTANT):
        limit = VARYING_ROWS
    elif rtol <= TIGHT:
        limit = MOST_ROWS
    if n >= WIDE * rows:
        limit = MOST_ROWS
    if rows > limit:
        return f"{rows} port rows, more than {limit}" + (" at this tolerance" if limit == FEW_ROWS else "")
    return None
