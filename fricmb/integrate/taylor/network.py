"""Arrays of a run: the structure by rows and diagonals, the contacts, the step's polynomials, what is kept.

With n dofs, m rows of contacts (one each, two of a contact that slides in a plane), polynomials of degree P in
s = (t - t0)/h, 0 <= s <= 1:

    q_j(s) = sum_k Q[k, j] s^k           displacement
    R_j(s) = sum_k R[k, j] s^k           M^-1 (f - K q - C v): acceleration but for the contact's own force
    (k+1)(k+2) Q[k+2, j] = h^2 (R[k, j] + push_j F_k)

A *plain* contact is of one dof that no other contact is of, against a belt of constant velocity, under a constant
coefficient: with its row W and compliance D = W^T M^-1 W, slip has F constant and stick ``F = -W^T R/D``, which is not
kept.  All other contacts are in groups (see groups).  What is said of a contact c is said of its first row; both rows
of one in two directions have its mode, and in ``sigma`` the direction of its slip.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout, room_type
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import Codes, Codes2, Floats, Floats2, Floats3, Ints
from fricmb.integrate.taylor.groups import Groups


class Net(Layout):
    """A network of dofs and contacts, and a run of it.

    Structure: ``offset`` (d,), ``stiff``, ``visc`` (d, n): diagonals of M^-1 K and M^-1 C (none where there are many;
    ``tridiagonal``); ``start``, ``neighbour``, ``k``, ``c``: both by rows; ``load`` (n,) M^-1 f; ``in_start``,
    ``in_signal``, ``in_u``, ``in_du``: M^-1 times the forces by signals and their rates, by rows; ``in_b``: forces by
    signals that are no motions; ``mass`` (n,); ``drivers`` (3, n_u, n_u): K, C and, in the first column, f of the
    signals; ``gauss`` (2, 8) nodes and weights; ``damped``.
    Contacts: ``row_start``, ``row_dof``, ``row_coef``, ``push`` (M^-1 W); ``compliance``, ``belt``, ``stick``,
    ``slip`` (m,): D, w, mu_s N, mu_k N; ``wu_start``, ``wu_signal``, ``wu_coef``: Wu; ``owner`` (n,): plain contact of
    a dof or -1; ``plain`` (m,): whether a contact is, ``grouped`` those that are not, ``first_dof`` (m,); ``free``
    (n,): 0 for a dof that a plain contact holds, else 1.
    Signals: ``signals``, ``series``, ``rates`` (n_u, P+3) powers of s of u and u', ``large`` (2, n_u) their running
    maxima, ``window``, ``fit``.
    State: ``q``, ``v``, ``top`` (n,) running maxima of |v|; ``mode``, ``sigma``, ``loss``, ``mark`` (m,) with the
    relative displacement at which a slip of a plain contact began; ``time``; sizes of the present ``step``, the
    ``longest`` and the ``next_step``; tolerance ``tol``; totals of ``supply`` and ``damping``; ``end`` of the run;
    speeds below ``noise`` are round-off; the part of the step (s) that counts, ``until``, and that in which friction
    curves hold, ``allowed``; ``fastest`` speed, or that to which the step begins to lead, ``reached`` the same by
    accelerations alone; ``crept`` when steps that are next to nothing began; ``made`` step that polynomials were made
    for.
    Counted: ``n_steps``, ``n_shorter`` shortened ones, ``n_events``, ``n_samples`` taken, ``n_heap`` size of the heap,
    ``n_searches``; ``n_here`` events in this step and their ``limit``; ``phase`` of the step; ``n_stop`` next stop;
    ``n_touched``, ``n_groups`` contacts and groups that a correction touches; in a row: ``stalled`` steps that did not
    move the time, ``n_once`` transitions with which steps began, ``n_creep`` steps that are next to nothing.
    Step: ``Q``, ``R``, ``slack``, ``due``, ``since`` (m,), ``heap_t``, ``heap_c``, ``flat`` (3, n).
    Corrections: ``local``, ``grown``, ``kind`` (cap,), ``place`` (n,), ``dQ``, ``dR``, ``old`` (3, P+3).
    Kept: ``events`` (e, 3); ``steps`` (s, 2) start and length; ``times`` (n_t,), ``left``: whether the left-hand value
    is wanted, ``out_...``: what was found there; ``stops``: breakpoints and the end; ``edge``,
    ``within``: how long inputs let steps be; ``quiet_...``: see ``quiet``; ``leaps_to``: the end of a step at rest.
    ``groups``: what contacts need that are not plain.
    """

    offset: Ints
    tridiagonal: int
    stiff: Floats2
    visc: Floats2
    start: Ints
    neighbour: Ints
    k: Floats
    c: Floats
    load: Floats
    in_start: Ints
    in_signal: Ints
    in_u: Floats
    in_du: Floats
    in_b: Floats
    mass: Floats
    drivers: Floats3
    gauss: Floats2
    row_start: Ints
    row_dof: Ints
    row_coef: Floats
    push: Floats
    compliance: Floats
    belt: Floats
    stick: Floats
    slip: Floats
    wu_start: Ints
    wu_signal: Ints
    wu_coef: Floats
    damped: int
    owner: Ints
    plain: Codes
    grouped: Ints
    first_dof: Ints
    free: Floats
    signals: Table
    series: Floats2
    rates: Floats2
    large: Floats2
    window: Floats
    fit: Floats2
    q: Floats
    v: Floats
    top: Floats
    mode: Codes
    sigma: Floats
    loss: Floats
    mark: Floats
    time: float
    step: float
    longest: float
    tol: float
    supply: float
    damping: float
    end: float
    noise: float
    next_step: float
    until: float
    allowed: float
    fastest: float
    reached: float
    crept: float
    made: float
    leaps_to: float
    n_steps: int
    n_shorter: int
    n_events: int
    n_samples: int
    n_heap: int
    n_searches: int
    n_here: int
    limit: int
    phase: int
    n_stop: int
    n_touched: int
    n_groups: int
    stalled: int
    n_once: int
    n_creep: int
    Q: Floats2
    R: Floats2
    slack: Floats
    due: Floats
    since: Floats
    heap_t: Floats
    heap_c: Ints
    flat: Floats2
    local: Ints
    grown: Codes
    kind: Codes
    place: Ints
    dQ: Floats2
    dR: Floats2
    old: Floats2
    events: Floats2
    times: Floats
    left: Codes
    steps: Floats2
    out_q: Floats2
    out_v: Floats2
    out_F: Floats2
    out_g: Floats2
    out_loss: Floats2
    out_mode: Codes2
    out_x: Floats2
    stops: Floats
    edge: Floats
    within: Floats
    quiet_edge: Floats
    quiet_least: Floats2
    quiet_most: Floats2
    quiet_gain: Floats2
    quiet_work: Floats
    groups: Groups


#: Numbers of the structure; all others are those of a run.
OF_STRUCTURE = ("tridiagonal", "damped")
OF_RUN = tuple(name for name in room_type(Net).numbers if name not in OF_STRUCTURE)


@kernel
def has_planes(net: Net) -> bool:
    """Whether any contact has two directions."""
    return bool(net.groups.landing.shape[0] > 0)
