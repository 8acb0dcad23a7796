"""Arrays in one piece of memory, and rooms that take them all at once."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.exchange import put_zeros, with_arrays
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.piece import Pattern
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Floats2, Ints


class Clock(Layout):
    """A layout of its own."""

    h: float
    count: int
    stops: Floats
    table: Floats2
    marks: Ints


PATTERN = Pattern(Clock, {"stops": (3,), "table": (2, 2)}, {"marks": (4,)})


def test_arrays_of_a_piece_lie_in_its_memory():
    piece = PATTERN.zeros()
    piece.arrays["stops"][:] = 1.0
    piece.arrays["table"][:] = 2.0
    piece.arrays["marks"][:] = 3
    assert piece.memory[:7].tolist() == [1.0] * 3 + [2.0] * 4
    assert piece.memory[7:].view(np.int64).tolist() == [3] * 4
    piece.memory.fill(0.0)
    assert not any(array.any() for array in piece.arrays.values())


def test_a_room_takes_a_piece_for_another_and_its_copy_keeps_the_first():
    first, second = PATTERN.zeros(), PATTERN.zeros()
    second.arrays["table"][1, 0] = 5.0
    clock = room(Clock(h=0.5, count=2, **first.arrays))
    before = with_arrays(clock)
    PATTERN.put(clock, second)
    made = room(Clock(h=0.5, count=2, **second.arrays))
    assert clock._memory.tolist() == made._memory.tolist()
    assert clock.table is second.arrays["table"]
    assert before.table is first.arrays["table"]


def test_numbers_become_zero_by_name():
    clock = room(Clock(h=0.5, count=2, **PATTERN.zeros().arrays))
    put_zeros(clock, ("count",))
    assert (clock.h, clock.count) == (0.5, 0)
