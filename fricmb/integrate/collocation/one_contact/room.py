"""All arrays of a run, which kernels take as one room."""

from __future__ import annotations

from typing import NamedTuple

from fricmb.integrate.problem import Complexes3, Floats, Floats2, Floats3, Floats4, Ints

Ints2 = Ints


class Run(NamedTuple):
    """Arrays of a run of one contact; the places in them have names in ``collocation/layout``.

    With n dofs, m rows, s nodes, x' for x and places beside it (see ``compile.lanes``): ``blk`` (2, 2, n), ``mat``
    (2, 8, n, n) blocks of the structure in slip (0) and stick (1); ``co``, ``ci`` (2, m, n), ``linked`` (m, m), ``row``
    (4, m, n), ``con`` (2, m, m) the contact; ``dof`` (3, n, n), ``vec`` (3, n) the structure; ``lim`` (3+m,), ``flags``
    (5,).  ``nd`` (4, s+1, s+1), ``mo`` (TERMS, s+1, s'), ``cx`` (3, l, s), ``basis`` (s, s'): tables of the nodes.
    ``tb`` (slots, 6, n, s'), ``answers`` (slots, m m, s, s'): weights by step size, slot 0 for steps off the
    ``ladder``; ``slots``: slot of a rung or -1, then how many were used.
    ``tk`` (1, m m, s, s'), ``bx`` (14, n), ``nx`` (3, m, s'), ``jacobian`` (s+2, s'), ``kappa`` (n + 1, TERMS; its last
    row is work), ``terms`` (n,), ``wk`` (3, lines, s+1): work; ``unit`` (s, s'): the unit matrix.
    ``sd`` (4, n), ``sm`` (2, m), ``sx`` (5,), ``si`` (8,): the state between phases.  ``steps``, ``kinds``,
    ``phases``, ``events``: rows of what is kept.  ``places``: table of the blocks.
    """

    blk: Floats3
    mat: Floats4
    co: Floats3
    ci: Floats3
    linked: Floats2
    row: Floats3
    dof: Floats3
    vec: Floats2
    con: Floats3
    lim: Floats
    flags: Ints
    nd: Floats3
    mo: Floats3
    cx: Complexes3
    basis: Floats2
    tb: Floats4
    answers: Floats4
    tk: Floats4
    ladder: Floats
    slots: Ints
    bx: Floats2
    nx: Floats3
    jacobian: Floats2
    unit: Floats2
    kappa: Floats2
    terms: Ints
    wk: Floats3
    sd: Floats2
    sm: Floats2
    sx: Floats
    si: Ints
    steps: Floats2
    kinds: Ints2
    phases: Floats2
    events: Floats2
    places: Ints
