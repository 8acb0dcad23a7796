"""What forces of contacts do to a step: how they move velocities, by their own scales, and the slip of their own rows.

Each driver puts this down once for a step that it has solved; what is asked between the nodes of the step reads it.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.problem import Floats, Floats2, Problem


class Felt(Layout):
    """What forces of contacts do, and space for questions between nodes; of contacts under constant friction nothing.

    ``push`` (m,): acceleration of the velocity that is moved most, by its own scale, by a unit of force in a row;
    ``free`` (m,): that of the row's own slip velocity; ``damped`` (n_c,): rate at which dampers alone would take slip
    away; ``least`` (n_c,): a smaller load counts as this one; ``size`` (n_z,): of states of laws, up to the start of
    the step.  ``line`` (s+1,), ``slip`` (3, s+1), ``values`` (s,): space.
    """

    push: Floats
    free: Floats
    damped: Floats
    least: Floats
    size: Floats
    line: Floats
    slip: Floats2
    values: Floats


def felt_of(problem: Problem, s: int) -> Felt:
    """Arrays for steps of s nodes."""
    m, nc = problem.m, problem.n_c
    return Felt(
        np.zeros(m), np.zeros(m), np.zeros(nc), np.zeros(nc), np.zeros(problem.n_z), np.zeros(s + 1),
        np.zeros((3, s + 1)), np.zeros(s),
    )  # fmt: skip
