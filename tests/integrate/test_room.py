"""Rooms (named tuples behind one pointer) and blocks (kernels called by name)."""

from __future__ import annotations

import subprocess
import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba import njit

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.exchange import with_arrays
from fricmb.integrate.compile.layout import Layout, room_type
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Codes, Floats, Floats2, Floats3, Ints
from fricmb.integrate.run.workspace import Workspace


class Inner(NamedTuple):
    x: Floats
    k: Ints


class Outer(NamedTuple):
    A: Floats2
    inner: Inner
    mode: Codes
    T: Floats3


def outer():
    inner = Inner(np.array([1.0, 2.0, 4.0]), np.array([7, 8], np.int64))
    return Outer(np.arange(6.0).reshape(2, 3), inner, np.array([1, 0, 2], np.int8), np.arange(24.0).reshape(2, 3, 4))


@njit(error_model="numpy")
def read(o):
    total = 0.0
    for i in range(o.A.shape[0]):
        for j in range(o.A.shape[1]):
            total += o.A[i, j] * 10 ** (3 * i + j)
    return total, o.inner.x[2], o.inner.k[1], o.mode[2], o.T[1, 2, 3], o.inner.x.shape[0]


@njit(error_model="numpy")
def write(o):
    o.inner.x[1] = -5.0
    o.A[1, 0] += 0.5
    for k in range(o.mode.shape[0]):
        o.mode[k] += 1
    row = o.T[1, 0]
    row[2] = 99.0


def test_a_kernel_reads_every_array_of_a_room_and_of_the_rooms_in_it():
    assert read(room(outer())) == (543210.0, 4.0, 8, 2, 23.0, 3)


def test_a_kernel_writes_into_the_arrays_themselves():
    values = outer()
    write(room(values))
    assert values.inner.x.tolist() == [1.0, -5.0, 4.0]
    assert values.A[1, 0] == 3.5
    assert values.mode.tolist() == [2, 1, 3]
    assert values.T[1, 0].tolist() == [12.0, 13.0, 99.0, 15.0]


def test_a_room_looks_like_its_tuple_from_outside():
    values = outer()
    seen = room(values)
    assert seen.A is values.A
    assert seen.inner.x is values.inner.x
    with pytest.raises(AttributeError):
        seen.missing  # noqa: B018


def test_a_room_in_a_room_is_taken_as_it_is():
    inner = room(outer().inner)
    values = outer()._replace(inner=inner)
    write(room(values))
    assert inner.x.tolist() == [1.0, -5.0, 4.0]


def test_a_room_keeps_its_arrays_alive():
    kept = room(outer())
    for _ in range(50):
        outer()  # memory that was given back would be used again
    assert read(kept)[0] == 543210.0


def test_empty_arrays_have_room():
    values = outer()._replace(
        A=np.zeros((0, 3)), mode=np.zeros(0, np.int8), inner=Inner(np.ones(3), np.ones(2, np.int64))
    )

    @njit(error_model="numpy")
    def sizes(o):
        return o.A.shape[0], o.A.shape[1], o.mode.shape[0]

    assert sizes(room(values)) == (0, 3, 0)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("A", np.zeros(6)),
        ("A", np.zeros((2, 3), np.float32)),
        ("A", np.zeros((3, 2)).T),
        ("mode", np.zeros(3, np.int64)),
        ("T", np.zeros((2, 3, 8))[:, :, ::2]),
    ],
)
def test_an_array_of_another_kind_is_refused(name, wrong):
    with pytest.raises(TypeError, match=f"{name} is .*expected array"):
        room(outer()._replace(**{name: wrong}))


class Clock(Layout):
    h: float
    stops: Floats
    steps: int


class Run(Layout):
    clock: Clock
    t: float


class Two(NamedTuple):
    own: Run
    other: Run


@njit(error_model="numpy")
def tick(run, steps):
    for _ in range(steps):
        run.t += run.clock.h
        run.clock.steps += 1
        run.clock.h = 2 * run.clock.h
    return run.t


def test_numbers_stand_in_a_room_and_are_read_and_written_by_name_in_kernels_and_outside():
    run = room(Run(Clock(0.5, np.zeros(2), 3), 1))
    assert (run.t, run.clock.h, run.clock.steps) == (1.0, 0.5, 3)
    assert isinstance(run.t, float)
    assert isinstance(run.clock.steps, int)
    run.clock.h = 0.25
    assert tick(run, 3) == 1.0 + 0.25 + 0.5 + 1.0
    assert (run.t, run.clock.h, run.clock.steps) == (2.75, 2.0, 6)


def test_a_room_with_another_number_or_array_leaves_the_old_one_as_it_is():
    clock = room(Clock(0.5, np.zeros(2), 3))
    clock.steps = 4
    other = with_arrays(clock, h=0.1, stops=np.ones(5))
    assert (other.h, other.steps, other.stops.tolist()) == (0.1, 4, [1.0] * 5)
    tick(room(Run(other, 0.0)), 1)
    assert (clock.h, clock.steps, clock.stops.shape) == (0.5, 4, (2,))
    assert (other.h, other.steps) == (0.2, 5)


def test_a_workspace_makes_its_numbers_what_they_were_but_not_those_of_rooms_from_elsewhere():
    elsewhere = room(Clock(0.5, np.zeros(2), 3))
    work = Workspace(Two(Run(Clock(0.1, np.ones(1), 0), 2.0), Run(elsewhere, 7.0)))
    for run in work.rooms:
        tick(run, 2)
    work.rooms.own.clock.stops[0] = 5.0
    work.clear()
    own, other = work.rooms
    assert (own.t, own.clock.h, own.clock.steps, own.clock.stops[0]) == (2.0, 0.1, 0, 1.0)
    assert (other.t, other.clock.h, other.clock.steps) == (7.0, 2.0, 5)


def test_a_kernel_does_not_write_to_an_array_itself():
    @njit(error_model="numpy")
    def replace(clock):
        clock.stops = np.zeros(3)

    with pytest.raises(TypeError, match=r"stops of a room Clock .* is no number"):
        replace(room(Clock(0.5, np.zeros(2), 3)))


def test_the_type_of_a_room_is_that_of_its_tuple_and_made_once():
    assert room_type(Outer) is room_type(Outer)
    assert room_type(Outer) != room_type(Inner)
    assert room(outer()).room_type is room_type(Outer)
    # eight bytes to an address and to each length
    assert room_type(Outer).at == {"A": 0, "inner": 24, "mode": 32, "T": 48}


@block
def doubled_sum(o: Inner, factor: float) -> float:
    o.x[0] = factor
    return float(o.x[0] + o.x[1] + o.x[2])


@declared
def defined_above(o: Inner) -> int:
    """What a floor above defines."""
    raise NotImplementedError


@njit(error_model="numpy")
def call_both(o):
    return doubled_sum(o, 10.0), defined_above(o)


def test_blocks_are_called_by_name_also_those_that_are_defined_later():
    @block
    def defined_above(o: Inner) -> int:
        return int(o.k[0] + 1)

    load_blocks("doubled_sum", "defined_above")
    inner = outer().inner
    assert call_both(room(inner)) == (16.0, 8)
    assert inner.x[0] == 10.0


def test_a_name_is_that_of_one_block():
    def react(x: Floats) -> None:
        """A block of the package has this name."""

    import fricmb.integrate.implicit.equations.accelerations  # noqa: F401  (where it is)

    with pytest.raises(NameError, match=r"'react' is defined in .*accelerations and in"):
        block(react)


def test_a_block_that_is_not_loaded_says_so_and_does_nothing_else():
    asked = subprocess.run([sys.executable, "-c", UNLOADED], capture_output=True, text=True, cwd="/")
    assert asked.returncode != 0
    assert "the kernel 'later' is called before it is loaded" in asked.stderr


UNLOADED = """from __future__ import annotations
from typing import NamedTuple
import numpy as np
from numba import njit
from fricmb.integrate.compile.block import block
from fricmb.integrate.problem import Floats

@block
def later(x: Floats) -> float:
    return x[0]

@njit
def caller(x):
    return later(x)

caller(np.ones(1))
"""
