"""All arrays of a run, which kernels take as one room."""

from __future__ import annotations

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.formulas.tableau import Tableau
from fricmb.integrate.problem import Floats, Floats2, Floats3, Floats4, Ints

Ints2 = Ints

#: Places in a row of ``steps``: time with its low part, length, friction loss before; then u, v, a of the blocks (n
#: each), in slip forces (m s) and power (s+1).  A row of ``phases``: position with its low part (n each), time with its
#: low part, then slope, e0 and e1 of the blocks (n each).
AT_TIME, AT_LOW, AT_LENGTH, AT_LOSS, AT_BLOCKS = range(5)


class Run(Layout):
    """Arrays of a run of one contact, with n dofs, m rows, s nodes, x' for x and places beside it (``compile.lanes``).

    Structure in slip (0) and stick (1), block by block: v' = -w2 u - damp v with ``w2``, ``damp`` (2, n); displacement
    and velocity of the dofs by block states, ``q_u`` to ``v_v`` (2, n, n); block inputs per force, ``force_0``,
    ``force_1``, and states per velocity, ``start_0``, ``start_1`` (2, n, n), of u (0) and v (1); ``modal`` (2,).
    Contact: ``c0``, ``c1`` (m, n) relative velocity by u and v of the blocks in slip, ``b0``, ``b1`` (m, n) inputs of u
    and v by forces, ``linked`` (m, m) whether one row's force reaches another's velocity; ``hold_u``, ``hold_v`` (m, n)
    force in stick by block states; ``wt``, ``mw`` (m, n) W and M^-1 W; ``D``, ``D_inv`` (m, m) W^T M^-1 W;
    ``mu_s_N``, ``mu_0_N``, ``fastest`` frequency, ``belt`` (m,), ``stuck_blocks`` their number, ``coupled``.
    Dofs: ``stiff``, ``visc``, ``minv`` (n, n); load ``load_0 + load_1 t`` (n,); ``stuck_v`` (n,) velocity in stick.
    Nodes: see ``collocation.nodes``.  Weights by step size (see ``moment_weights``): ``S`` to ``Q3`` (slots, n, s'),
    ``answers`` (slots, m m, s, s'), slot 0 for steps off the ``ladder``; ``slots``: slot of a rung or -1, then how many
    were used; ``tk`` (1, m m, s, s').
    Blocks in a phase (n,): ``u`` with its low part, ``v``; ``load``, ``slope`` of the load on v, ``e0 + e1 t`` on u;
    ``a``, ``k`` acceleration and its rate; ``u_end``, ``low_end``, ``v_end``; ``force``, ``rate`` are those of dofs.
    Step: ``free``, ``direction``, ``relative`` (m, s') relative velocity without friction, its direction, and with
    friction; ``jacobian`` (s+2, s'), ``unit`` (s, s') the unit matrix, ``kappa`` (n + 1, TERMS; its last row is work),
    ``terms`` (n,), ``radau`` (s, s), ``rhs`` (s,), ``coefficients`` (s+1,), ``out`` (3, m), ``change`` (m,) of signals
    per impulse on a row.
    State between phases: ``pos`` with its low part, ``vel``, ``scale`` (n,); ``g``, ``n`` (m,); ``time`` with its
    low part, friction ``loss``, ``next_step``, ``first_step`` of a slip, ``searched``, ``looks`` of a stick,
    ``bound`` of steps, ``mode``.  ``used`` (3,) rows of steps, phases and events; ``counts`` (5,) work done (see
    Counters).
    ``steps``, ``kinds``, ``phases``, ``events``: rows of what is kept.
    """

    w2: Floats2
    damp: Floats2
    q_u: Floats3
    q_v: Floats3
    v_u: Floats3
    v_v: Floats3
    force_0: Floats3
    force_1: Floats3
    start_0: Floats3
    start_1: Floats3
    modal: Ints
    c0: Floats2
    c1: Floats2
    b0: Floats2
    b1: Floats2
    linked: Floats2
    hold_u: Floats2
    hold_v: Floats2
    wt: Floats2
    mw: Floats2
    D: Floats2
    D_inv: Floats2
    mu_s_N: float
    mu_0_N: float
    fastest: float
    belt: Floats
    stuck_blocks: int
    coupled: int
    stiff: Floats2
    visc: Floats2
    minv: Floats2
    load_0: Floats
    load_1: Floats
    stuck_v: Floats
    tab: Tableau
    monomial: Floats2
    tails: Floats2
    mo: Floats3
    basis: Floats2
    S: Floats3
    IS: Floats3
    IIS: Floats3
    Q1: Floats3
    Q2: Floats3
    Q3: Floats3
    answers: Floats4
    tk: Floats4
    ladder: Floats
    slots: Ints
    u: Floats
    u_low: Floats
    v: Floats
    a: Floats
    k: Floats
    load: Floats
    slope: Floats
    e0: Floats
    e1: Floats
    u_end: Floats
    low_end: Floats
    v_end: Floats
    force: Floats
    rate: Floats
    free: Floats2
    direction: Floats2
    relative: Floats2
    jacobian: Floats2
    unit: Floats2
    kappa: Floats2
    terms: Ints
    radau: Floats2
    rhs: Floats
    coefficients: Floats
    out: Floats2
    change: Floats
    pos: Floats
    pos_low: Floats
    vel: Floats
    scale: Floats
    g: Floats
    n: Floats
    time: float
    time_low: float
    loss: float
    next_step: float
    first_step: float
    searched: float
    looks: float
    bound: float
    mode: int
    used: Ints
    counts: Ints
    steps: Floats2
    kinds: Ints2
    phases: Floats2
    events: Floats2
