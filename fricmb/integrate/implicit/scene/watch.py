"""What the implicit driver watches along a run: space for margins, triggers and the nearest singular position."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.implicit.scene.problem_structs import mech_of
from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.problem import Floats, Floats2, Ints, Pivots, Problem

#: Joints that slip at once and are looked at together.
MANY = 8
#: Kinds of trigger, in their order (``events/triggers`` says what they are): the first two take turns, port by port;
#: behind those of the joints there is one of each a port.
FRICTION, LOAD, JOINT, KINK = KINDS = range(4)


class Watch(Layout):
    """What is watched along a run.

    ``margin`` (n_c,): 1 + mu n dN/dF of every port that slips, which must stay above 0; ``together`` the least
    principal minor of the same for several of them (``contacts``, ``A``, ``B``, ``sizes``, ``pivots`` space for it).
    ``sigma``: least singular value of G M^-1/2 now, ``sigma_top`` the largest since the start, and
    ``sigma_before`` when its rate ``sigma_rate`` was last counted, a time ``sigma_h`` ago; ``weak`` (m,) its
    direction among the constraints, ``reactions`` (m * ldab,) their columns in the banded matrix of an instant;
    ``sigma_end``, ``weak_end``, ``reactions_end`` the same at the end of a step; whether constraints are left out as
    ``redundant``, and none of this is heeded.
    ``trigger`` (n_t,), of all KINDS: what must not fall below 0; ``inner`` (s + 1, n_t) the same at the start and the
    stages of a step, ``rough`` by the forces of the last stage, ``where`` the part of the step at which only the
    polynomial through these is below 0, else 1; ``values`` (s,) and ``series`` (s + 1,) of one of them; ``gap`` (n_j,)
    of open joints, its ``rate`` and round-off ``grain`` (``least``: at least), ``opened`` how many there are;
    ``bends`` (n_j,), ``kinked``
    (n_c,), ``kink``, ``side`` (m,): see ``load_kinks``; ``top_slip``, ``top_force``, ``top_position`` running maxima;
    ``missed`` (n_c,): see ``load_defect``; ``hair`` part of a force that is no sign between stages;
    ``slow`` slip that ends at once as no step gets any further, else 0.
    """

    margin: Floats
    together: float
    contacts: Ints
    A: Floats
    B: Floats
    sizes: Pivots
    pivots: Pivots
    sigma: float
    sigma_top: float
    redundant: int
    sigma_before: float
    sigma_h: float
    sigma_rate: float
    weak: Floats
    reactions: Floats
    sigma_end: float
    weak_end: Floats
    reactions_end: Floats
    trigger: Floats
    inner: Floats2
    rough: Floats
    where: float
    values: Floats
    series: Floats
    gap: Floats
    rate: Floats
    grain: Floats
    least: Floats
    opened: int
    bends: Ints
    kinked: Ints
    kink: Floats
    side: Floats
    top_slip: float
    top_force: float
    top_position: float
    lam: Floats
    missed: Floats
    hair: float
    slow: float


def watch_of(problem: Problem, stages: int) -> Watch:
    """Arrays for the problem and steps of so many stages; no joint is open."""
    m = mechanism_of(problem)
    count = (len(KINDS) - 1) * problem.n_c + len(m.joints.port)
    columns = m.n_rows * int(mech_of(problem).order.sizes[3])
    return Watch(
        np.ones(problem.n_c), 1.0, np.zeros(MANY, np.int64), np.zeros(MANY * MANY), np.zeros(MANY * MANY),
        np.zeros(4, np.int32), np.zeros(MANY, np.int32),
        0.0, 0.0, 0, 0.0, 0.0, 0.0, np.random.default_rng(1).standard_normal(m.n_rows), np.zeros(columns),
        0.0, np.zeros(m.n_rows), np.zeros(columns), np.ones(count),
        np.ones((stages + 1, count)), np.ones(count), 1.0, np.zeros(stages),
        np.zeros(stages + 1), np.zeros(len(m.joints.port)), np.zeros(len(m.joints.port)), np.zeros(len(m.joints.port)),
        np.zeros(len(m.joints.port)),
        0, np.zeros(len(m.joints.port), np.int64),
        np.zeros(problem.n_c, np.int64), np.zeros(m.n_rows + 1), np.zeros(m.n_rows + 1), 0.0, 0.0, 0.0,
        np.zeros(m.n_rows + 1), np.zeros(problem.n_c), 0.0, 0.0,
    )  # fmt: skip
