"""Eight numbers side by side, and Newton's method for directions of slip that is made of them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pytest

from fricmb.integrate.collocation.one_contact.slip_directions import eliminate, slip_directions
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.compile.lanes import LANES, all_lanes, lanes, padded, roots, set_lanes
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Floats, Floats2, Floats4


class Contact(NamedTuple):
    """What the kernels take of a run of one contact."""

    basis: Floats2
    answers: Floats4
    free: Floats2
    direction: Floats2
    relative: Floats2
    jacobian: Floats2
    unit: Floats2
    mu_0_N: float
    coupled: int


def contact(s, coupled=1):
    wide = padded(s)
    free, direction, relative = (np.zeros((2, wide)) for _ in range(3))
    return Contact(
        np.zeros((s, wide)), np.zeros((1, 4, s, wide)), free, direction, relative, np.zeros((s + 2, wide)),
        np.eye(s, wide), 0.7, coupled,
    )  # fmt: skip


@entry
def combine(a: Floats, b: Floats, out: Floats) -> None:
    for at in range(0, a.shape[0], LANES):
        x, y = lanes(a, at), lanes(b, at)
        set_lanes(out, at, (2.0 * x + y * 3.0 - x * y) / (1.0 + roots(x * x)) + all_lanes(a[0]) - 1.0)


@entry
def solve(run: Contact, s: int) -> bool:
    return eliminate(run, s)


@entry
def directions(run: Contact, tol: float) -> int:
    return slip_directions(run, 0, tol)


def test_lanes_do_what_loops_do():
    a, b = np.random.default_rng(1).normal(size=(2, 3 * LANES))
    out = np.full(3 * LANES, np.nan)
    combine(a, b, out)
    expected = (2.0 * a + 3.0 * b - a * b) / (1.0 + np.sqrt(a * a)) + a[0] - 1.0
    np.testing.assert_allclose(out, expected, rtol=1e-14, atol=1e-14)


def test_padded_is_the_next_multiple():
    assert [padded(n) for n in (1, 7, 8, 9, 16, 17)] == [8, 8, 8, 16, 16, 24]


@pytest.mark.parametrize("s", range(4, 10))
@pytest.mark.parametrize("small", [False, True])
def test_elimination_solves(s, small):
    """Small pivots first of all, so that rows have to be exchanged; what stands beside the system stays 0."""
    rng = np.random.default_rng(s)
    A, b = rng.normal(size=(s, s)), rng.normal(size=s)
    if small:
        A[0, 0] = 0.0
        A[1, 1] = A[1, 0] * A[0, 1] * 1e-9
    run = contact(s)
    run.jacobian[:s, :s], run.jacobian[s, :s] = A.T, b
    assert solve(room(run), s)
    np.testing.assert_allclose(run.jacobian[s, :s], np.linalg.solve(A, b), rtol=1e-9)
    assert not run.jacobian[:, s:].any()


def test_singular_systems_are_refused():
    run = contact(5)
    assert not solve(room(run), 5)


@pytest.mark.parametrize("s", [4, 7, 8, 9])
@pytest.mark.parametrize("coupled", [0, 1])
def test_directions_are_along_slip(s, coupled):
    """Slip that friction slows and turns: g = free - mu N T n is along n at every node."""
    rng = np.random.default_rng(10 * s + coupled)
    T = 0.3 * rng.uniform(size=(2, 2, s, s))
    if not coupled:
        T[0, 1] = T[1, 0] = 0.0
    run = contact(s, coupled)
    for a in range(2):
        for b in range(2):
            run.answers[0, 2 * a + b, :, :s] = T[a, b].T
    angle = np.linspace(0.3, 1.2, s)
    run.free[:, :s] = 5.0 * np.array([np.cos(angle), np.sin(angle)]) + 0.1 * rng.normal(size=(2, s))
    run.direction[0, :s] = 1.0
    assert directions(room(run), 1e-24) > 0
    n, g = run.direction[:, :s], run.relative[:, :s]
    np.testing.assert_allclose(np.hypot(*n), 1.0, rtol=1e-14)
    np.testing.assert_allclose(g, run.free[:, :s] - 0.7 * np.einsum("abil,bl->ai", T, n), atol=1e-13)
    np.testing.assert_allclose(n[0] * g[1] - n[1] * g[0], 0.0, atol=1e-11)
    assert (n * g).sum(axis=0).min() > 0.0
    assert not any(x[:, s:].any() for x in (run.free, run.direction, run.relative))
