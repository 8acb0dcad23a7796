"""A linear structure in blocks with all that acts on it: the room of steps whose structure is exact.

Port inputs c: forces on the contacts' rows (m), varying normal forces (n_v), local forces of elements (n_f), then
prescribed signals u and u' (n_u each).  Outputs o: relative velocities (m), arguments of elements, arguments of normal
forces.
"""

from __future__ import annotations

import math
from functools import lru_cache

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Floats2, Floats3, Floats4, Ints, Pivots
from fricmb.integrate.run.workspace import empty_arrays
from fricmb.integrate.step.tableau import Tableau, one_stage

#: Rungs of the ladder 2^(k/4) of step sizes, and the one that stands for 1.
RUNGS, UNIT_RUNG = 2000, 1000


Ints2 = Ints


class Exact(Layout):
    """Blocks, inputs and outputs, tables by step size and the work of one step; empty for other methods.

    With b blocks, s nodes, s' for s and places that stay 0 (see ``compile.lanes``).  Blocks: v' = -w2 u - damp v with
    ``w2``, ``damp`` (1, b); ``c0``, ``c1`` (n_o, b) outputs by u and v; ``b0``, ``b1`` (n_in, b) inputs on them;
    ``linked`` (n_o, n_in); ``q_u`` to ``v_v`` (n, b) dofs by blocks; ``force_0``, ``force_1``, ``start_0``, ``start_1``
    (b, n) u and v by forces and by velocities; ``moves`` (2, b) the first degree of freedom that a block moves and the
    one behind the last, ``moved_by`` (2, n) the same of the blocks that move one of them (of a body given by modes each
    moves its own alone); ``MB`` (n_in, n) accelerations per input.  Numbers: ``modal`` whether
    blocks are modes seen by velocities alone, ``ledger`` whether powers other than friction are kept, ``unknown``
    inputs, ``safety`` tolerance of a step per rtol, ``stiff_at`` largest w h with exact weights, ``cap`` longest next
    step, ``fastest`` block, ``length`` of the step that was solved last.
    ``tab`` to ``mo``: tables of the nodes (``collocation.nodes``); by step size ``S`` to ``Q3`` (slots, b, s') and
    ``tk`` (slots, n_o n_in, s, s'), slot 0 for steps off the ``ladder``; ``radau`` (s, s) space.
    At the start of a step ``v0`` (b,) is v + e0, ``a0`` its rate, ``k0`` the rate of that; ``du``, ``dv`` (b,) gains.
    ``xf``, ``x`` (n_o, s) outputs without unknown inputs, and with; ``P`` (n_in, s) inputs at the nodes; ``now``
    (n_in,) signals at the start; ``weight`` (n_in,); ``low`` (2, n+1) what rounding dropped from q and t, at the start
    and the end of the step; ``end`` (2, n) gain of q, and v at the end; ``node`` (2, s, n) q and v at the nodes.
    ``held`` (places, 3, s m, s m) what is left of the contacts' equations where some stick (collocation/held_rows),
    ``held_for`` (places, 2) for which of them and which rung, ``held_next``, ``rows`` (s m,).
    ``J`` (s, n_f, n_xe), ``JN`` (s, n_v, n_xn) slopes of elements and normal forces; ``fe`` (s, n_f) residuals of
    element forces; ``A``, ``R``, ``pivots`` space for their elimination.
    """

    w2: Floats2
    damp: Floats2
    c0: Floats2
    c1: Floats2
    b0: Floats2
    b1: Floats2
    linked: Floats2
    q_u: Floats2
    q_v: Floats2
    v_u: Floats2
    v_v: Floats2
    force_0: Floats2
    force_1: Floats2
    start_0: Floats2
    start_1: Floats2
    moves: Ints2
    moved_by: Ints2
    MB: Floats2
    modal: int
    ledger: int
    unknown: int
    safety: float
    stiff_at: float
    cap: float
    fastest: float
    length: float
    tab: Tableau
    monomial: Floats2
    tails: Floats2
    mo: Floats3
    S: Floats3
    IS: Floats3
    IIS: Floats3
    Q1: Floats3
    Q2: Floats3
    Q3: Floats3
    tk: Floats4
    ladder: Floats
    slots: Ints
    kappa: Floats2
    terms: Ints
    radau: Floats2
    v0: Floats
    a0: Floats
    k0: Floats
    du: Floats
    dv: Floats
    xf: Floats2
    x: Floats2
    P: Floats2
    now: Floats
    weight: Floats
    low: Floats2
    end: Floats2
    node: Floats3
    f: Floats
    held: Floats4
    held_for: Ints2
    held_next: int
    rows: Ints
    J: Floats3
    JN: Floats3
    fe: Floats2
    A: Floats
    R: Floats2
    pivots: Pivots


@lru_cache(maxsize=1)
def no_exact() -> Exact:
    """An empty room, for methods without exact structure."""
    return room(Exact(**empty_arrays(Exact), tab=one_stage()))


@kernel
def rung_below(h: float) -> int:
    """The longest rung of the ladder not above h."""
    return int(min(RUNGS - 1.0, max(0.0, UNIT_RUNG + math.floor(4.0 * math.log2(h) + 1e-9))))
