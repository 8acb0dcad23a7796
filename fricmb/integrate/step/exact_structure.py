"""A linear structure in blocks with all that acts on it: the room of steps whose structure is exact.

Port inputs c: forces on the contacts' rows (m), varying normal forces (n_v), local forces of elements (n_f), then
prescribed signals u and u' (n_u each).  Outputs o: relative velocities (m), arguments of elements, arguments of normal
forces.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Complexes3, Floats, Floats2, Floats3, Floats4, Ints, Pivots

#: ``flags``: number of inputs, of outputs, whether blocks are modes seen by velocities alone, whether powers other than
#: friction are kept, unknown inputs, arguments of elements, arguments of normal forces, local forces of elements.
INPUTS, OUTPUTS, IS_MODAL, LEDGER, UNKNOWN, ELEMENT_X, NORMAL_X, ELEMENT_F = range(8)
#: ``par``: tolerance of a step per rtol, largest w h with exact weights, longest next step, fastest block, length
#: of the step that was solved last.
SAFETY, STIFF_AT, CAP, FASTEST_BLOCK, LENGTH = range(5)
#: Rungs of the ladder 2^(k/4) of step sizes, and the one that stands for 1.
RUNGS, UNIT_RUNG = 2000, 1000


Ints2 = Ints


class Exact(NamedTuple):
    """Blocks, inputs and outputs, tables by step size and the work of one step; empty for other methods.

    With b blocks, s nodes, s' for s and places that stay 0 (see ``compile.lanes``): ``blk`` (1, 2, b), ``co``
    (2, n_o, b), ``ci`` (2, n_in, b), ``linked`` (n_o, n_in), ``mat`` (4, n, b) dofs by blocks, ``start`` (4, b, n)
    blocks by forces and by velocities, ``MB`` (n_in, n) accelerations per input; ``nd``, ``mo``, ``cx`` tables of the
    nodes; ``tb`` (slots, 6, b, s'), ``tk`` (slots, n_o n_in, s, s') by step size, slot 0 for steps off the ``ladder``.
    ``bs`` (8, b) blocks at the start of the step; ``xf``, ``x`` (n_o, s) outputs without unknown inputs, and with;
    ``P`` (n_in, s) inputs at the nodes; ``now``
    (n_in,) signals at the start; ``weight`` (n_in,); ``low`` (2, n+1) what rounding dropped from q and t, at the start
    and the end of the step; ``end`` (2, n) gain of q, and v at the end; ``node`` (2, s, n) q and v at the nodes.
    ``held`` (places, 3, s m, s m) what is left of the contacts' equations where some stick (collocation/held_rows),
    ``held_for`` (places, 2) for which of them and which rung, ``held_next`` (1,), ``rows`` (s m,).
    ``J`` (s, n_f, n_xe), ``JN`` (s, n_v, n_xn) slopes of elements and normal forces; ``fe`` (s, n_f) residuals of
    element forces; ``A``, ``R``, ``pivots`` space for their elimination.
    """

    flags: Ints
    par: Floats
    blk: Floats3
    co: Floats3
    ci: Floats3
    linked: Floats2
    mat: Floats3
    start: Floats3
    MB: Floats2
    nd: Floats3
    mo: Floats3
    cx: Complexes3
    tb: Floats4
    tk: Floats4
    ladder: Floats
    slots: Ints
    kappa: Floats2
    terms: Ints
    wk: Floats3
    bs: Floats2
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
    held_next: Ints
    rows: Ints
    J: Floats3
    JN: Floats3
    fe: Floats2
    A: Floats
    R: Floats2
    pivots: Pivots


_KINDS = {"Floats": 1, "Floats2": 2, "Floats3": 3, "Floats4": 4}


@lru_cache(maxsize=1)
def no_exact() -> Exact:
    """An empty room, for methods without exact structure."""
    made = []
    for name, note in Exact.__annotations__.items():
        kind = getattr(note, "__forward_arg__", note)
        if kind in _KINDS:
            made.append(np.zeros((0,) * _KINDS[kind]))
        elif kind == "Ints2":
            made.append(np.zeros((0, 0), np.int64))
        elif kind == "Complexes3":
            made.append(np.zeros((0, 0, 0), complex))
        else:
            made.append(np.zeros(8 if name == "flags" else 0, np.int32 if kind == "Pivots" else np.int64))
    return room(Exact._make(made))


@kernel
def rung_below(h: float) -> int:
    """The longest rung of the ladder not above h."""
    return int(min(RUNGS - 1.0, max(0.0, UNIT_RUNG + math.floor(4.0 * math.log2(h) + 1e-9))))
