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
    n_c, n_j, rows = problem.n_c, len(m.joints.port), m.n_rows
    count = (len(KINDS) - 1) * n_c + n_j
    columns = rows * int(mech_of(problem).order.sizes[3])
    return Watch(
        margin=np.ones(n_c), together=1.0, contacts=np.zeros(MANY, np.int64), A=np.zeros(MANY * MANY),
        B=np.zeros(MANY * MANY), sizes=np.zeros(4, np.int32), pivots=np.zeros(MANY, np.int32),
        sigma=0.0, sigma_top=0.0, redundant=0, sigma_before=0.0, sigma_h=0.0, sigma_rate=0.0,
        weak=np.random.default_rng(1).standard_normal(rows), reactions=np.zeros(columns),
        sigma_end=0.0, weak_end=np.zeros(rows), reactions_end=np.zeros(columns),
        trigger=np.ones(count), inner=np.ones((stages + 1, count)), rough=np.ones(count), where=1.0,
        values=np.zeros(stages), series=np.zeros(stages + 1),
        gap=np.zeros(n_j), rate=np.zeros(n_j), grain=np.zeros(n_j), least=np.zeros(n_j), opened=0,
        bends=np.zeros(n_j, np.int64), kinked=np.zeros(n_c, np.int64), kink=np.zeros(rows + 1), side=np.zeros(rows + 1),
        top_slip=0.0, top_force=0.0, top_position=0.0, lam=np.zeros(rows + 1), missed=np.zeros(n_c), hair=0.0, slow=0.0,
    )  # fmt: skip
