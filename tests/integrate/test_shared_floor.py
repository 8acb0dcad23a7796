"""What scenes with joints and without share, kernel by kernel: arrays in, arrays out, against numpy and scipy."""

from __future__ import annotations

from types import SimpleNamespace
from typing import NamedTuple

import numpy as np
import pytest
from scipy.linalg import solve

from fricmb.integrate.compile.band import (
    NARROW,
    band_sizes,
    factor_band,
    length_of,
    place_of,
    solve_band,
    spread_of_pivots,
)
from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.compile.lapack import load_lapack
from fricmb.integrate.compile.room import room
from fricmb.integrate.formulas.backward_differences import best_order
from fricmb.integrate.formulas.step_control import ladder, step_factor
from fricmb.integrate.formulas.tableau import by_line, largest_in_step, radau
from fricmb.integrate.model.law_values import along, magnitude, point_along
from fricmb.integrate.problem import Complexes, Complexes2, Floats, Floats2, Ints, Pivots
from fricmb.integrate.run.breakpoints import next_stop, reached, set_window, set_window_around
from fricmb.integrate.run.chunks import Chunks
from fricmb.integrate.run.outcomes import DONE, FULL


class Stops(NamedTuple):
    """What the kernels read of a run."""

    span: Floats
    stops: Floats


@entry
def stop_and_window(times: Stops, window: Floats, t: float) -> float:
    """The next stop; the window of functions of time."""
    stop = set_window(times, window, t)
    return stop if stop == next_stop(times, t) and not reached(t, stop) else -1.0


@entry
def solve_real(ab: Floats, pivots: Pivots, sizes: Pivots, b: Floats) -> float:
    """Factor and solve; spread of the pivots, -1 where the matrix is singular."""
    if not factor_band(ab, pivots, sizes):
        return -1.0
    solve_band(ab, pivots, sizes, b)
    return spread_of_pivots(ab, sizes)


@entry
def put_down(matrix: Complexes2, sizes: Pivots, ab: Complexes) -> None:
    """Entries that are not 0, where they belong."""
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[0]):
            if matrix[i, j] != 0.0:
                ab[place_of(sizes, i, j)] = matrix[i, j]


@entry
def solve_complex(ab: Complexes, pivots: Pivots, sizes: Pivots, b: Complexes) -> bool:
    """Factor and solve."""
    if not factor_band(ab, pivots, sizes):
        return False
    solve_band(ab, pivots, sizes, b)
    return True


@entry
def solve_border(ab: Complexes, pivots: Pivots, sizes: Pivots, b: Complexes) -> int:
    """Solve with factors that are there, b being 0 but for the border."""
    solve_band(ab, pivots, sizes, b, True)
    return 0


@entry
def factor_of(error: float, order: float) -> float:
    """By what a step may change."""
    return step_factor(error, order, 0.9)


@entry
def rung(x: float, rungs: int) -> float:
    """A step on the ladder."""
    return ladder(x, rungs)


@entry
def order_of(k: int, lower: float, error: float, higher: float, more: int, out: Floats) -> int:
    """The order that goes fastest, and by what."""
    order, out[0] = best_order(k, lower, error, higher, more)
    return order


@entry
def window_of(stops: Floats, window: Floats, t: float) -> None:
    """Between breakpoints, of a sample."""
    set_window_around(stops, window, t)


@entry
def directions(row: Ints, x: Floats, sense: float, n: Floats, part: Floats) -> None:
    """Directions along x, or against it, and the part of x along them."""
    for k in range(part.shape[0]):
        point_along(row, k, x, sense, n)
        part[k] = along(row, k, n, x)


@entry
def in_step(line: Floats, start: float, values: Floats2, out: Floats) -> None:
    """Of every column what a line of a tableau makes, and its largest magnitude."""
    for a in range(values.shape[1]):
        out[2 * a] = by_line(line, start, values, a)
        out[2 * a + 1] = largest_in_step(start, values, a)


@entry
def lengths(row: Ints, x: Floats, out: Floats) -> int:
    """Length of the part of every contact."""
    for k in range(out.shape[0]):
        out[k] = magnitude(row, k, x)
    return 0


def test_stops_and_windows():
    times = room(Stops(np.array([0.0, 10.0]), np.array([2.0, 5.0, 20.0])))
    window = np.zeros(2)
    for t, stop, low, high in ((0, 2, 0, 2), (2, 5, 2, 5), (2 - 1e-9, 2, 0, 2), (7, 10, 5, 20)):
        assert stop_and_window(times, window, float(t)) == stop
        assert low < window[0] <= low + 1e-14
        assert high - 1e-13 <= window[1] < high


def test_windows_around_samples():
    window = np.zeros(2)
    for t, low, high in ((1.0, -np.inf, 2.0), (2.0, 2.0, 5.0), (4.0, 2.0, 5.0), (6.0, 5.0, np.inf)):
        window_of(np.array([2.0, 5.0]), window, t)
        assert low <= window[0] <= low + 1e-14
        assert high - 1e-13 <= window[1] <= high


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_directions_are_along_what_is_given(sense):
    row, x, n, part = np.array([0, 1, 3, 6, 8]), np.array([-2.0, 3, 4, 1, 2, 2, 0, 0]), np.full(8, 7.0), np.zeros(4)
    directions(row, x, sense, n, part)
    expected = sense * np.array([-1, 0.6, 0.8, 1 / 3, 2 / 3, 2 / 3])
    np.testing.assert_allclose(n, [*expected, 7, 7], rtol=1e-15)  # where there is nothing to go by they stay
    np.testing.assert_allclose(part, [2 * sense, 5 * sense, 3 * sense, 0], rtol=1e-15)


def test_lines_of_a_tableau_are_its_polynomial():
    tab, out = radau(4), np.zeros(4)
    c = np.append(0.0, tab.c)
    values = np.stack([1 + c**4, 1 - 3 * c**2], axis=1)[1:]
    for j in range(4):
        half = 0.5 * (c[j] + c[j + 1])
        in_step(tab.mid[j], 1.0, values, out)
        np.testing.assert_allclose(out, [1 + half**4, 2, 1 - 3 * half**2, 2], rtol=1e-13)
    in_step(tab.top[0], 1.0, values, out)
    np.testing.assert_allclose(out[::2], [1 / 70, 0], atol=1e-14)  # x^4 = P_4/70 + ... on [0, 1]


def band_of(matrix, half):
    """As LAPACK takes it: entry (i, j) at 2 half + i - j in column j."""
    n = len(matrix)
    ab = np.zeros((n, 3 * half + 1), matrix.dtype)
    for j in range(n):
        for i in range(max(0, j - half), min(n, j + half + 1)):
            ab[j, 2 * half + i - j] = matrix[i, j]
    return ab.ravel()


@pytest.mark.parametrize(("n", "half"), [(12, 2), (30, NARROW), (40, NARROW + 3)])
@pytest.mark.parametrize("kind", [float, complex])
def test_banded_systems_are_those_of_scipy(kind, n, half):
    rng = np.random.default_rng(3)
    matrix = rng.normal(size=(n, n)).astype(kind) + (1j * rng.normal(size=(n, n)) if kind is complex else 0.0)
    matrix[np.abs(np.subtract.outer(np.arange(n), np.arange(n))) > half] = 0.0
    b = rng.normal(size=n).astype(kind)
    x, pivots = b.copy(), np.zeros(n, np.int32)
    load_lapack()
    call = solve_real if kind is float else solve_complex
    assert call(band_of(matrix, half), pivots, band_sizes(n, half), x) > 0.0
    np.testing.assert_allclose(x, solve(matrix, b), rtol=1e-12, atol=1e-12)
    matrix[:, 4] = 0.0
    assert call(band_of(matrix, half), pivots, band_sizes(n, half), x) in (-1.0, False)


def test_steps_grow_by_the_order_of_their_error():
    assert factor_of(2.0**-4, 4.0) == pytest.approx(1.8)
    assert factor_of(81.0, 4.0) == pytest.approx(0.3)
    assert factor_of(np.inf, 3.0) == 0.0
    assert np.isfinite(factor_of(0.0, 1.0))


@pytest.mark.parametrize("rungs", [4, 8])
def test_a_rung_is_the_next_one_below(rungs):
    powers = 2.0 ** (np.arange(-40, 40) / rungs)
    for x in np.random.default_rng(1).uniform(0.1, 10.0, 50):
        assert rung(x, rungs) == pytest.approx(powers[powers <= x].max(), rel=1e-12)
    assert [rung(power, rungs) for power in powers] == pytest.approx(powers, rel=1e-12)


def test_the_order_that_goes_fastest():
    rng, out = np.random.default_rng(2), np.zeros(1)
    for _ in range(200):
        k = int(rng.integers(1, 6))
        errors = 10.0 ** rng.uniform(-6, 2, 3)
        errors[0] = np.inf if k == 1 else errors[0]
        errors[2] = np.inf if rng.uniform() < 0.3 else errors[2]
        more = int(rng.integers(0, 2))
        factors = {k + i: 0.9 * errors[1 + i] ** (-1.0 / (k + i + more)) for i in (-1, 0, 1) if k + i > 0}
        order = order_of(k, *errors, more, out)
        assert factors[order] == max(factors.values())
        assert out[0] == pytest.approx(factors[order])


def test_lengths_do_not_overflow():
    row, x = np.array([0, 1, 3, 6]), np.array([-2.0, 3e200, 4e200, 2e-200, 3e-200, 6e-200])
    out = np.zeros(3)
    lengths(row, x, out)
    np.testing.assert_allclose(out, [2.0, 5e200, 7e-200], rtol=1e-15)


def test_rows_that_are_not_finite_are_left_out():
    rows = np.arange(12.0).reshape(6, 2)
    rows[4, 1] = np.nan
    arrays = {"values": np.zeros((2, 2)), "kind": np.zeros(2, np.int8), "event": np.zeros((1, 3))}
    kept = SimpleNamespace(**arrays, used=np.zeros(2, int))
    chunks, state, seen, told = Chunks(kept, "values", "kind"), SimpleNamespace(t=0.0), [], []

    def step():
        kept.values[:] = rows[len(seen) * 2 : len(seen) * 2 + 2]
        kept.event[0] = len(seen), 0, 1
        kept.used[:] = 2, 1
        seen.append(state.t)
        state.t = kept.values[1, 0]
        return DONE if len(seen) == 3 else FULL

    assert chunks.fill(step, state, None, told.append) == DONE
    assert told == [2.0, 6.0, 10.0]
    assert chunks.broken
    np.testing.assert_array_equal(np.concatenate([part[0] for part in chunks.parts]), rows[:4])
    np.testing.assert_array_equal(chunks.transitions().t, [0.0, 1.0, 2.0])
    seen.clear()
    chunks = Chunks(kept, "values", "kind")
    assert chunks.fill(step, state, 16.0, None) == FULL  # memory for one row: one chunk and no more
    assert len(seen) == 1


@pytest.mark.parametrize(("n", "half", "border"), [(30, 0, 4), (12, 2, 1), (40, NARROW + 3, 9), (25, 1, NARROW + 4)])
def test_a_band_with_a_border_is_solved_as_a_full_matrix(n, half, border):
    """Last unknowns that meet all others, with zeros on their diagonal, as those of forces are."""
    rng, size = np.random.default_rng(4), n + border
    matrix = rng.normal(size=(size, size)) + 1j * rng.normal(size=(size, size))
    inner = np.abs(np.subtract.outer(np.arange(n), np.arange(n)))
    matrix[:n, :n][inner > half] = 0.0
    matrix[np.arange(n, size), np.arange(n, size)] = 0.0
    sizes, pivots = band_sizes(n, half, border), np.zeros(size, np.int32)
    b, ab = rng.normal(size=size) + 0j, np.zeros(length_of(sizes), complex)
    x = b.copy()
    load_lapack()
    put_down(matrix, sizes, ab)
    assert solve_complex(ab, pivots, sizes, x)
    np.testing.assert_allclose(x, solve(matrix, b), rtol=1e-9, atol=1e-9)
    b[:n] = 0.0
    x = b.copy()
    solve_border(ab, pivots, sizes, x)
    np.testing.assert_allclose(x, solve(matrix, b), rtol=1e-9, atol=1e-9)
    matrix[:, -1] = 0.0
    ab[:] = 0.0
    put_down(matrix, sizes, ab)
    assert not solve_complex(ab, pivots, sizes, x)
