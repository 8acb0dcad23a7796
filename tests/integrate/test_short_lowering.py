"""Items, rows and copies of arrays in kernels: what numba's own lowering of the same function gives."""

from __future__ import annotations

import sys
from typing import NamedTuple

import numpy as np
import pytest
from numba import njit

from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Codes, Floats, Floats2, Floats3, Ints


class Box(NamedTuple):
    """Arrays of one, two and three axes, and of other types."""

    x: Floats
    A: Floats2
    T: Floats3
    k: Ints
    c: Codes


def walk(box, a, B):
    """Reads and writes in every form that kernels use."""
    total = box.x[0] + box.x[-1] + box.A[1, 2] + box.A[-1, -2] + box.T[1, 0, -1] + box.T[1][0, 1]
    for i in range(box.A.shape[0]):
        row = box.A[i]
        for j in range(-1, row.shape[0] - 1):
            row[j] += 0.5 * total
            B[i, j] = row[j - 1] + row.size + box.A.shape[1]
    box.A[0] = box.A[1]
    box.T[1, 0] = B[1]
    box.T[0] = box.T[1]
    a[:] = box.x
    box.x[1:] = a[:-1]
    box.k[box.c[1]] = len(a) + box.k[-2]
    box.c[-1] = box.k[0]
    layer = box.T[0]
    if total > 0.0:
        layer = box.T[1]
    made = np.zeros((2, 3))
    made[1] = layer[0]
    kept = made[1]
    pair = (1, 2)
    return kept[0] + made[pair] + layer[pair[0], -1] + np.sum(box.A[:, 1]) + a[np.uint64(1)]


def arguments():
    x = np.random.default_rng(1)
    boxed = (
        Box(x.random(4), x.random((3, 3)), x.random((2, 2, 3)), np.arange(5), np.arange(3, dtype=np.int8)),
        x.random(4),
        x.random((3, 3)),
    )
    return boxed


def test_a_kernel_does_what_numba_alone_does():
    ours, plain = arguments(), arguments()
    result = entry(walk)(room(ours[0]), *ours[1:])
    assert result == njit(error_model="numpy")(walk)(*plain)
    for got, wanted in zip((*ours[0], *ours[1:]), (*plain[0], *plain[1:]), strict=True):
        np.testing.assert_array_equal(got, wanted)


@kernel
def first_row(A):
    return A[0]


@entry
def of_a_returned_view(A):
    row = first_row(A)
    return row[1]


@entry
def copy_row(A, b):
    A[1] = b


def test_references_are_given_back():
    A, before = np.arange(6.0).reshape(2, 3), 0
    for _ in range(2):
        assert of_a_returned_view(A) == 1.0
        copy_row(A, np.ones(3))
        before, now = sys.getrefcount(A), before
    assert before == now
    np.testing.assert_array_equal(A[1], 1.0)


def test_rows_of_another_length_are_refused():
    # numba's own passes say "cannot assign slice", and from the cache that they cannot say what they wanted to
    said = r"another shape|cannot assign slice of shape|runtime exception arguments"
    with pytest.raises((ValueError, RuntimeError), match=said):
        copy_row(np.zeros((2, 3)), np.zeros(2))
