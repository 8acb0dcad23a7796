"""Arrays of contacts that touch the same bodies, of one between two bodies, on a belt that moves, under a law of speed.

Their forces are polynomials ``F_c(s) = sum_k F[k, c] s^k`` here.  In slip ``F = -sigma N mu(r)``,
``r = sigma g``; what sticks together on bodies that touch is solved together, group by group:

    G F = -(W^T A - w'),    G = W^T M^-1 W over the contacts of the group that stick,

with A the accelerations under all other forces.
"""

from __future__ import annotations

from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.model.problem_structs import Table
from fricmb.integrate.problem import Codes, Floats, Floats2, Floats3, Ints

#: In place of a number: the second row of a contact in two directions.
SECOND = -2


class Groups(Layout):
    """All contacts that are not plain, those on common dofs together; most of it is empty where all are plain.

    Groups: ``group`` (m,) or -1; ``group_start``, ``group_contact``; ``dof_start``, ``group_dof``:
    dofs of a group; ``dof_group`` (n,): or -1; ``at``: where a group's matrix begins in ``G`` and in ``L`` (its
    triangular factor over ``stuck``, the ``n_stuck`` contacts of the group that stick under the modes ``factored``);
    ``rhs`` (m,).
    Slip: ``lawful`` (m,): number of a contact whose coefficient depends on slip speed, or -1; ``laws``, ``N``;
    ``curve`` (., D+1): mu on ``middle`` +- ``half`` in Chebyshev polynomials, of which ``terms`` count; ``rough``:
    what is left beyond them, relative to what is allowed; ``nodes``, ``fit`` (D+1, D+1); ``b`` (., D+3, P+1): sums of
    Clenshaw's recursion by powers of s, in the last row the argument.
    Account: ``paid`` (m,): s up to which losses and work are counted; ``rule`` (2, P): Gauss's.
    Start: ``rests``, ``before`` (m,): whether a contact has no slip speed, its direction of slip before (0 in stick).
    Corrections: ``slot`` (m,) of a contact or -1; ``here``: contact of a slot; ``reached``: groups touched; ``touched``
    (.): whether one is; ``was``: forces before; ``dF``; ``local_b``: as b; ``first``: order from which its argument
    changes; ``along`` (2, .): points of a step, and an argument there.
    Two directions: ``planar`` (m,): number of a contact in two directions by its first row, ``SECOND`` for its second
    row, -1 for a contact in one; by that number powers of s of d = u/|u| in ``unit`` (., 2, .), of |u| in ``speed``, of
    mu N in ``rubbing``; ``begins``: slip begins with the step (1), or a short time before it (2) with ``first_speed``,
    so that ``speed`` is of (|u| - |u_0|)/s; ``turned``: how far a pass of series has changed ``unit``; ``landing``
    (., PLAN): how long it takes to come to rest (0: it does not), and what its velocity follows (see ``layout``);
    ``square``: |F|^2.
    """

    F: Floats2
    group: Ints
    group_start: Ints
    group_contact: Ints
    dof_start: Ints
    group_dof: Ints
    dof_group: Ints
    at: Ints
    G: Floats
    L: Floats
    stuck: Ints
    n_stuck: Ints
    factored: Codes
    rhs: Floats
    lawful: Ints
    laws: Table
    N: Floats
    curve: Floats2
    middle: Floats
    half: Floats
    terms: Ints
    rough: Floats
    nodes: Floats
    fit: Floats2
    values: Floats
    work: Floats
    b: Floats3
    paid: Floats
    rule: Floats2
    rests: Codes
    before: Codes
    slot: Ints
    here: Ints
    reached: Ints
    touched: Codes
    was: Floats2
    dF: Floats2
    local_b: Floats3
    first: Ints
    along: Floats2
    planar: Ints
    unit: Floats3
    speed: Floats2
    rubbing: Floats2
    begins: Codes
    first_speed: Floats
    turned: Floats2
    landing: Floats2
    square: Floats
