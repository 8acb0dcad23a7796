"""Arrays that runs of one contact work in: taken from a store and put back, so that the next scene finds them made.

Runs with other values would else begin with short rows and empty tables each time.  Each run has arrays of its own
while it lasts, in whatever thread it is.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from fricmb.integrate.collocation.nodes import RUNGS, TERMS, nodes
from fricmb.integrate.collocation.one_contact.constants import (
    NUMBERS_OF_CONSTANTS,
    load_pattern,
    put_constants,
    structure,
    structure_pattern,
)
from fricmb.integrate.collocation.one_contact.prepare import Rows, rows, with_rows
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.run import BLOCKS
from fricmb.integrate.compile.lanes import padded
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.compile.piece import Pattern
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Ints, Problem
from fricmb.integrate.run.stop import ended

#: Tables by step size; arrays by block or dof, and numbers of a run.
TABLES = ("S", "IS", "IIS", "Q1", "Q2", "Q3")
BY_BLOCK = (
    "u", "u_low", "v", "a", "k", "load", "slope", "e0", "e1", "u_end", "low_end", "v_end", "force", "rate", "pos",
    "pos_low", "vel", "scale",
)  # fmt: skip
NUMBERS = ("time", "time_low", "loss", "next_step", "first_step", "searched", "looks", "bound", "mode")

#: Arrays kept for each size of a scene, and bytes of rows and tables above which they are not put back.
MANY, LARGE = 4, 32_000_000

#: Rows that a run begins with.
FEW = 512

#: Bytes that are copied without asking whether the run is to end.
COPIED = 1 << 26


class Lent(NamedTuple):
    """Arrays of a run, the memory of those that it works in, and the structure whose weights are in its tables."""

    run: Run
    work: Floats
    content: bytes


_store: dict[tuple[int, int, int], list[Lent]] = {}
_turn = threading.Lock()


@contextmanager
def borrowed(problem: Problem, s: int) -> Iterator[list[Run]]:
    """Arrays for a run with s nodes, in a list of one (its rows may be exchanged for more).

    Weights by step size are those of the last run on a structure of the same numbers, else none.
    """
    load_blocks(*BLOCKS)
    size = problem.n, problem.m, s
    content = structure(problem).content
    with _turn:
        free = _store.setdefault(size, [])
        place = next((i for i, other in enumerate(free) if other.content == content), None)
        taken = free.pop(place) if place is not None else free.pop(0) if len(free) >= MANY else None
    run, work, before = _made(*size) if taken is None else taken
    put_constants(run, problem)
    if before != content:
        _begin_anew(run, work)
    held = [run]
    yield held
    if goes_back(held[0]):
        with _turn:
            free.append(Lent(held[0], work, content))


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


def filled(held: Rows, used: Ints) -> float:
    """Bytes of rows that have been filled; ``used``: how many steps, phases and events."""
    steps, phases, events = used.tolist()
    counts = (steps, steps, phases, events)
    return float(sum(count * array[:1].nbytes for count, array in zip(counts, held, strict=True)))


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


@lru_cache(maxsize=64)
def _work_pattern(n: int, m: int, s: int) -> Pattern:
    """The arrays that a run works in."""
    wide = padded(s)
    floats: dict[str, tuple[int, ...]] = {
        **dict.fromkeys(BY_BLOCK, (n,)), "ladder": (RUNGS + 1,), "free": (m, wide), "direction": (m, wide),
        "relative": (m, wide), "jacobian": (s + 2, wide), "kappa": (n + 1, TERMS), "radau": (s, s), "rhs": (s,),
        "coefficients": (s + 1,), "out": (3, m), "change": (m,), "g": (m,), "n": (m,),
    }  # fmt: skip
    return Pattern(Run, floats, {"used": (3,), "counts": (5,), "terms": (n,)})


def _made(n: int, m: int, s: int) -> Lent:
    count = 1 + int(np.clip(4_000_000 // (6 * n * s + (m * s) ** 2), 12, 48))
    wide = padded(s)
    shapes: dict[str, tuple[int, ...]] = {
        **dict.fromkeys(TABLES, (count, n, wide)), "answers": (count, m * m, s, wide), "tk": (1, m * m, s, wide),
    }  # fmt: skip
    arrays: dict[str, Any] = {name: np.zeros(shape) for name, shape in shapes.items()}
    arrays |= {"slots": np.full(RUNGS + 2, -1, dtype=np.int64), "unit": np.eye(s, wide)}
    work = _work_pattern(n, m, s).zeros()
    for piece in (work, structure_pattern(n, m).zeros(), load_pattern(n, m).zeros()):
        arrays |= piece.arrays
    arrays |= dict.fromkeys((*NUMBERS, *NUMBERS_OF_CONSTANTS), 0)
    arrays |= nodes(s)._asdict() | rows(n, m, s, FEW)._asdict()
    return Lent(room(Run(**arrays)), work.memory, b"")


def _begin_anew(run: Run, work: Floats) -> None:
    """Nothing is left of a run on another structure."""
    work.fill(0.0)
    for name in NUMBERS:
        setattr(run, name, 0)
    run.slots[:-1] = -1
    run.slots[-1] = 0
