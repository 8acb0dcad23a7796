"""What steps of one formula work in, and what their errors are measured by."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.problem import Floats, Floats2, Ints, Problem
from fricmb.integrate.step.contact_unknowns import PortState, port_state
from fricmb.integrate.step.exact_structure import Exact
from fricmb.integrate.step.felt import Felt, felt_of
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.step_matrix import Factor
from fricmb.integrate.step.tableau import Tableau


class Accuracy(Layout):
    """Tolerance and running scales: ``rtol``, maxima of |q|, |v| (n,), |z| (n_z,), slip speed (n_c,), floors.

    ``grain`` (n,) round-off of velocities; ``noise`` relative velocity that is nothing beside what the scene's
    forces bring in this run.
    """

    rtol: float
    q: Floats
    v: Floats
    z: Floats
    r: Floats
    floor_q: Floats
    floor_v: Floats
    grain: Floats
    noise: float


class OneStep(Layout):
    """All that a one-step method of one tableau needs.

    ``last_t``, ``last_h`` start and length of the step that the stages are of (0: of none), ``counts`` work done (see
    Counters), ``power`` (s, n_c+2) powers at the stages, ``noise_z`` (n_z,) sizes of states that do not matter, ``N``
    (s, n_c) normal forces at the stages before max(0, .), ``margin`` (s,) and ``series`` (s+1,) what is searched for
    zeros, ``exact`` the structure where it is exact, ``felt`` what forces do in the step just solved.
    """

    tab: Tableau
    fac: Factor
    st: Stages
    w: PortState
    tol: Floats
    scale: Floats
    last_t: float
    last_h: float
    counts: Ints
    power: Floats2
    noise_z: Floats
    margin: Floats
    series: Floats
    N: Floats2
    exact: Exact
    felt: Felt


def one_step_of(problem: Problem, tableau: Tableau, fac: Factor, st: Stages, exact: Exact) -> OneStep:
    """Arrays for steps of one tableau."""
    s, nc = len(tableau.c), problem.n_c
    return OneStep(
        tableau, fac, st, port_state(problem, s), np.zeros(nc + problem.n_z), np.zeros(problem.n), 0.0, 0.0,
        np.zeros(8, np.int64), np.zeros((s, nc + 2)), np.zeros(problem.n_z), np.zeros(s), np.zeros(s + 1),
        np.zeros((s, nc)), exact, felt_of(problem, s),
    )  # fmt: skip


@kernel
def widest(x: Floats) -> float:
    """Largest entry of a scale, for floors."""
    value = 0.0
    for i in range(x.shape[0]):
        value = max(value, x[i])
    return value


@kernel
def is_exact(one: OneStep) -> bool:
    """Whether the structure is exact."""
    return bool(one.exact.ladder.shape[0] > 0)
