"""Where a scene without joints is stepped by banded matrices of all unknowns, not condensed to the forces at contacts.

Condensed, a step costs the cube of the rows of contacts, stages together; in a band it costs the unknowns of a stage
times the square of the band's width.
"""

from __future__ import annotations

from fricmb.integrate.constrained.problem_structs import mech_of
from fricmb.integrate.problem import Problem

#: Times the cube of the rows that a band may cost.  Measured at ``rtol`` 1e-6, band over condensed: planar contacts on
#: 40 modes 2.4, 1.5, 1.3, 1.0, 0.9, 0.6 with 4, 8, 12, 16, 24, 36 of them, where a band costs 207, 41, 18, 11, 9, 9;
#: blocks in a row 0.9 to 0.25 with 8 to 36, in the plane 0.6, 0.3, 0.15 with 4, 8, 16; nodes of a bar of finite
#: elements 1.0, 0.6, 0.35, 0.2 with 4, 8, 16, 24; under a law with a state 1.0, 0.7, 0.3 with 4, 8, 16.
DEARER = 16.0


def has_many_rows(problem: Problem) -> bool:
    """Whether a band is cheaper."""
    rows, order = problem.m + problem.n_v + problem.n_z, mech_of(problem).order
    return bool(len(order.place) * int(order.sizes[1]) ** 2 < DEARER * rows**3)
