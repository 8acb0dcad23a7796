"""Sparse matrices: what is kept of the places of entries serves other values in these places."""

import numpy as np
import pytest

from fricmb.integrate.csr import Csr, on_one_pattern

RNG = np.random.default_rng(3)
PLACES = RNG.random((6, 5)) < 0.4


@pytest.mark.parametrize("turn", range(3))
def test_other_values_in_the_same_places(turn):
    """Three times, so that all but the first find what is kept."""
    dense = np.where(PLACES, RNG.normal(size=PLACES.shape), 0.0)
    matrix = Csr.of_dense(dense)
    np.testing.assert_array_equal(matrix.dense(), dense)
    np.testing.assert_array_equal(matrix.transposed().dense(), dense.T)
    np.testing.assert_array_equal(matrix.block(slice(1, 4), slice(0, 3)).dense(), dense[1:4, :3])
    np.testing.assert_allclose(matrix @ np.arange(5.0), dense @ np.arange(5.0), rtol=1e-13)


@pytest.mark.parametrize("value", [1.0, -2.5])
def test_entries_of_one_place_add_up(value):
    matrix = Csr.of_entries([2, 0, 2], [1, 1, 1], [value, 3.0, 4.0], (3, 2))
    np.testing.assert_array_equal(matrix.dense(), [[0.0, 3.0], [0.0, 0.0], [0.0, value + 4.0]])


def test_places_of_other_shapes_are_other_places():
    assert Csr.of_entries([0], [0], [1.0], (1, 1)).dense().shape == (1, 1)
    assert Csr.of_entries([0], [0], [1.0], (2, 3)).dense().shape == (2, 3)


@pytest.mark.parametrize("factor", [1.0, 3.0])
def test_a_joint_pattern_of_two_matrices_tells_which_entry_is_whose(factor):
    """Places of both together are the same where an entry moves from one to the other."""
    left, right = factor * np.diag([1.0, 2.0, 0.0]), factor * np.diag([0.0, 0.0, 4.0])
    for one, other in ((left, right), (left + right, 0.0 * right)):
        start, index, values = on_one_pattern([Csr.of_dense(one), Csr.of_dense(other)])
        found = [Csr((3, 3), start, index, value).dense() for value in values]
        np.testing.assert_array_equal(found[0], one)
        np.testing.assert_array_equal(found[1], other)
