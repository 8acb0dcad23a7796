"""Arrays that runs of one contact work in: taken from a store and put back, so that the next scene finds them made.

Runs with other values would else begin with short rows and empty tables each time.  Each run has arrays of its own
while it lasts, in whatever thread it is.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from fricmb.integrate.collocation.nodes import RUNGS, TERMS, nodes
from fricmb.integrate.collocation.one_contact.prepare import Model, Rows, model, rows, with_rows
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.run import BLOCKS
from fricmb.integrate.compile.lanes import padded
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.compile.room import room
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem
from fricmb.integrate.run.stop import ended

#: Tables by step size; arrays by block or dof, numbers of a run, and what else it works in.
TABLES = ("S", "IS", "IIS", "Q1", "Q2", "Q3")
BY_BLOCK = (
    "u", "u_low", "v", "a", "k", "load", "slope", "e0", "e1", "u_end", "low_end", "v_end", "force", "rate", "pos",
    "pos_low", "vel", "scale",
)  # fmt: skip
NUMBERS = ("time", "time_low", "loss", "next_step", "first_step", "mode")
WORK = (
    "ladder", "free", "direction", "relative", "jacobian", "kappa", "terms", "radau", "rhs", "coefficients", "out",
    "change", "g", "n", "used", "counts",
)  # fmt: skip

#: Arrays kept for each size of a scene, and bytes of rows and tables above which they are not put back.
MANY, LARGE = 4, 32_000_000

#: Rows that a run begins with.
FEW = 512

#: Bytes that are copied without asking whether the run is to end.
COPIED = 1 << 26

_store: dict[tuple[int, int, int], list[tuple[bytes, Run]]] = {}
_turn = threading.Lock()


@contextmanager
def borrowed(problem: Problem, s: int) -> Iterator[list[Run]]:
    """Arrays for a run with s nodes, in a list of one (its rows may be exchanged for more).

    Weights by step size are those of the last run on a structure of the same numbers, else none.
    """
    load_blocks(*BLOCKS)
    size = problem.n, problem.m, s
    p = model(problem)
    content = once_per(problem, "model content", lambda: b"".join([np.asarray(held).tobytes() for held in p.values()]))
    with _turn:
        free = _store.setdefault(size, [])
        place = next((i for i, (other, _) in enumerate(free) if other == content), None)
        taken = free.pop(place) if place is not None else free.pop(0) if len(free) >= MANY else None
    held = [_made(p, s) if taken is None else taken[1]]
    if taken is not None and place is None:
        _begin_anew(held[0], p)
    yield held
    if goes_back(held[0]):
        with _turn:
            free.append((content, held[0]))


def goes_back(run: Run) -> bool:
    """Whether the arrays are put back after the run; else what it has filled may stay where it is."""
    tables = len(TABLES) * run.S.nbytes + run.answers.nbytes
    return bool(tables + run.steps.nbytes + run.kinds.nbytes + run.phases.nbytes + run.events.nbytes <= LARGE)


def lengthened(held: Rows) -> Rows | None:
    """The rows with as many empty ones behind, which take memory as they are filled; None where the run is to end."""
    longer = Rows._make(np.zeros((2 * len(array), *array.shape[1:]), array.dtype) for array in held)
    for old, new in zip(held, longer, strict=True):
        lines = max(1, COPIED // (old.nbytes // len(old)))
        for i in range(0, len(old), lines):
            if ended() is not None:
                return None
            new[: len(old)][i : i + lines] = old[i : i + lines]
    return longer


def may_grow(held: Rows, memory: float | None) -> bool:
    """Whether twice as many rows are within so many bytes (None: they are)."""
    return memory is None or 2 * sum([array.nbytes for array in held]) <= memory


def within(run: Run, memory: float | None) -> Run:
    """The arrays with no more rows than a run that began with few would have come to within so many bytes.

    Where rows are full a run is cut into pieces; where that is must not depend on the runs before.
    """
    held = Rows(run.steps, run.kinds, run.phases, run.events)
    fewer = held
    while len(fewer.steps) > FEW:
        half = Rows._make([array[: len(array) // 2] for array in fewer])
        if may_grow(half, memory):
            break
        fewer = half
    return run if fewer is held else with_rows(run, fewer)


def _made(p: Model, s: int) -> Run:
    m, n = p["belt"].shape[0], p["load_0"].shape[0]
    count = 1 + int(np.clip(4_000_000 // (6 * n * s + (m * s) ** 2), 12, 48))
    slots = np.full(RUNGS + 2, -1, dtype=np.int64)
    slots[-1] = 0
    wide = padded(s)
    shapes: dict[str, tuple[int, ...]] = {
        **dict.fromkeys(TABLES, (count, n, wide)), **dict.fromkeys(BY_BLOCK, (n,)),
        "answers": (count, m * m, s, wide), "tk": (1, m * m, s, wide), "ladder": (RUNGS + 1,),
        "free": (m, wide), "direction": (m, wide), "relative": (m, wide), "jacobian": (s + 2, wide),
        "kappa": (n + 1, TERMS), "radau": (s, s), "rhs": (s,), "coefficients": (s + 1,), "out": (3, m), "change": (m,),
        "g": (m,), "n": (m,),
    }  # fmt: skip
    arrays: dict[str, Any] = {name: np.zeros(shape) for name, shape in shapes.items()}
    whole = {"used": 3, "counts": 5, "terms": n}
    arrays |= {name: np.zeros(size, np.int64) for name, size in whole.items()}
    arrays |= {name: held.copy() if isinstance(held, np.ndarray) else held for name, held in p.items()}
    arrays |= dict.fromkeys(NUMBERS, 0) | nodes(s)._asdict() | rows(n, m, s, FEW)._asdict()
    return room(Run(**arrays, slots=slots, unit=np.eye(s, wide)))


def _begin_anew(run: Run, p: Model) -> None:
    """The constants of another scene of the same size; nothing is left of the run before."""
    for name, held in p.items():
        if isinstance(held, np.ndarray):
            getattr(run, name)[...] = held
        else:
            setattr(run, name, held)
    for name in (*BY_BLOCK, *WORK):
        getattr(run, name).fill(0)
    for name in NUMBERS:
        setattr(run, name, 0)
    run.slots[:-1] = -1
    run.slots[-1] = 0
