"""Arrays of a run: structure, contacts, states, space for a step, rows.

With n dofs, n_c contacts of m rows and a step h from (q0, v0) to (q1, v1), bars for means over the step:

    q1 = q0 + h (v0 + v1) / 2
    A (v1 - v0) = h [f - K (q0 + h v0 / 2) - C v0 - Ku ubar - Cu du/h + B ubar + W F + Wn (N - N0)]
    A = M + h C / 2 + h^2 K / 4
    F_c in the ball of centre delta_c and radius rho_c;  g1_c = W_c^T v1 - w1_c in the cone normal to it at F_c, negated
"""

from __future__ import annotations

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import Codes, Codes2, Floats, Floats2, Floats3, Ints, Pivots


class Run(Layout):
    """A structure with contacts, and a run of it; s: slots of the state (see layout).

    Structure: ``start``, ``column`` (n+1,), (nnz,) joint pattern of ``mass``, ``stiff``, ``visc``, ``skew`` (nnz or 0:
    antisymmetric part of K) by rows; ``at`` (nnz,): place of each entry in a band of half width ``band``, in which dof
    j has row ``order[j]``; ``load`` (n,). Signals act by rows: ``in_start``, ``in_signal``, ``in_u`` (B - Ku),
    ``in_b`` (B), ``in_du`` (-Cu); ``back_start``, ``back_dof``, ``back_k``, ``back_c``: rows of the drivers;
    ``drivers`` (3, n_u, n_u): K, C and, in the first column, f of the signals.
    Contacts: ``row`` (n_c+1,); ``w_start``, ``w_dof``, ``w_coef``: W by columns; ``belt`` (m,), ``wu_start``,
    ``wu_signal``, ``wu_coef``: w and Wu; ``loop`` (n_c,), ``rank``, ``held``, ``spare`` (n_loops,): see loops;
    ``law``, ``mu_s``, ``mu_0``, ``N`` (n_c,); ``var``, ``acts`` (n_c,): varying normal force, felt by the bodies along
    ``n_start``, ``n_dof``, ``n_coef`` from ``N0``.
    State: ``q``, ``v`` (s, n); ``u``, ``du`` (s, n_u); ``g``, ``w`` (s, m); ``F``, ``ends`` (s, m): mean force of the
    step before and force at its end; ``hold`` (s, m), ``grip``, ``when`` (s, n_c): last force that held the contact,
    the limit it was under and its time; ``known`` (s, n_c): whether there is one; ``mode``, ``push`` (s, n_c): modes
    and mean normal forces.
    Step: ``free``, ``dv``, ``turn``, ``trial`` (n,); ``gf``, ``y``, ``P``, ``phi``, ``move`` (m,); ``base``: unknowns
    where leaps of Newton's method began; ``H``, ``weight`` (3 n_c,) derivative of the projection; ``rho``, ``slide``,
    ``brake``, ``soft``, ``share`` (n_c,); ``delta``, ``away`` (m,); ``status``, ``tried`` (n_c,): whether it was let
    go in vain; ``jolt`` (n,), ``last`` (n_c,): the last jump of forces in the step on a dof and on a contact at rest,
    as a fraction of it (-1: none); ``loss`` (s, n_c), ``spent`` (s, 2): energies of a step; ``what``, ``moment``,
    ``strain`` (s, n_c): transitions in it, and what would hold a contact that comes to rest, over its limit;
    ``instant`` (n_c, 2): rate of the distance and dV/de of varying normal forces.
    Factors: ``lu`` (k, n (2 b + 1)), ``of`` (k, 3 n_c + 1): h and weights each was made for, ``used`` (k,); ``Y`` (k,
    m, n), ``D`` (k, m, m): responses A^-1 W and h W^T A^-1 W; ``J``, ``rhs``, ``sizes``, ``pivots``.
    Run: ``top_q``, ``top_v`` (n,) running maxima, ``floor_q``, ``floor_v``; ``part`` (n,), ``part_of`` (n_c,): which
    of the parts that touch nowhere it belongs to; ``largest`` (n_parts, 3): of each the largest position and velocity
    so far and limit of friction in this step; ``events`` (n_parts,): its transitions in a step; ``total`` (n_c,)
    losses; ``stops``; ``s``: space for calling templates; present ``time``; ``step``; ``end`` of the run; ``tol``;
    ``residual`` stated of the contacts; ``longest`` and ``shortest`` step; ``fixed_step`` or 0; ``error`` of the last
    step; ``settled`` change of the lagged terms that is none; relative velocities below ``noise`` are round-off;
    ``goes_on`` whether the run goes on from another; ``leeway`` of steps with transitions; ``fault`` whether a
    coefficient of friction is negative where a step ends, or a number is none (see layout).
    Counted: ``n_steps`` accepted, ``n_rejected``; ``n_rounds``, ``n_newton`` iterations, ``n_factor`` factorisations;
    ``n_rows`` and ``n_events`` so far; ``n_stop`` next stop; ``n_unsettled`` steps. ``condensed`` whether the contacts
    are solved so; ``varying`` whether normal forces vary.
    Rows: ``row_t``, ``row_q``, ``row_v``, ``row_F``, ``row_g``, ``row_N``, ``row_mode``, ``row_loss``, ``row_x``;
    ``event`` (e, 3).
    """

    start: Ints
    column: Ints
    mass: Floats
    stiff: Floats
    visc: Floats
    skew: Floats
    at: Ints
    order: Ints
    load: Floats
    in_start: Ints
    in_signal: Ints
    in_u: Floats
    in_b: Floats
    in_du: Floats
    back_start: Ints
    back_dof: Ints
    back_k: Floats
    back_c: Floats
    drivers: Floats3
    row: Ints
    w_start: Ints
    w_dof: Ints
    w_coef: Floats
    belt: Floats
    loop: Ints
    rank: Ints
    held: Ints
    spare: Ints
    wu_start: Ints
    wu_signal: Ints
    wu_coef: Floats
    law: Codes
    mu_s: Floats
    mu_0: Floats
    N: Floats
    var: Codes
    acts: Codes
    n_start: Ints
    n_dof: Ints
    n_coef: Floats
    N0: Floats
    signals: Table
    laws: Table
    normals: Table
    q: Floats2
    v: Floats2
    u: Floats2
    du: Floats2
    g: Floats2
    w: Floats2
    F: Floats2
    ends: Floats2
    hold: Floats2
    grip: Floats2
    when: Floats2
    known: Codes2
    jolted: Codes2
    mode: Codes2
    push: Floats2
    free: Floats
    dv: Floats
    turn: Floats
    trial: Floats
    base: Floats
    gf: Floats
    y: Floats
    P: Floats
    phi: Floats
    move: Floats
    H: Floats
    weight: Floats
    rho: Floats
    slide: Floats
    brake: Floats
    soft: Floats
    share: Floats
    delta: Floats
    away: Floats
    status: Codes
    tried: Codes
    jolt: Floats
    last: Floats
    loss: Floats2
    spent: Floats2
    what: Codes2
    moment: Floats2
    strain: Floats2
    instant: Floats2
    lu: Floats2
    of: Floats2
    used: Ints
    Y: Floats3
    D: Floats3
    J: Floats
    rhs: Floats
    sizes: Pivots
    pivots: Pivots
    top_q: Floats
    top_v: Floats
    floor_q: Floats
    floor_v: Floats
    part: Ints
    part_of: Ints
    largest: Floats2
    events: Ints
    total: Floats
    stops: Floats
    s: Scratch
    time: float
    step: float
    end: float
    tol: float
    residual: float
    longest: float
    shortest: float
    fixed_step: float
    error: float
    settled: float
    noise: float
    goes_on: int
    leeway: float
    fault: int
    n_steps: int
    n_rejected: int
    n_rounds: int
    n_newton: int
    n_factor: int
    n_rows: int
    n_events: int
    n_stop: int
    condensed: int
    band: int
    varying: int
    n_unsettled: int
    row_t: Floats
    row_q: Floats2
    row_v: Floats2
    row_F: Floats2
    row_g: Floats2
    row_N: Floats2
    row_mode: Codes2
    row_loss: Floats2
    row_x: Floats2
    event: Floats2
