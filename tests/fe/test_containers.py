"""MAT-files and Matrix Market as scipy writes them: numbers are those that scipy reads."""

import numpy as np
import pytest
import scipy.io
import scipy.sparse

from fricmb._files import mat_arrays, matrix_market
from fricmb.errors import FileError

RNG = np.random.default_rng(5)
DENSE = RNG.standard_normal((4, 3))
SPARSE = scipy.sparse.random_array((7, 5), density=0.3, rng=RNG, format="csc")


@pytest.mark.parametrize("packed", [False, True])
def test_numbers_of_mat_files(packed, tmp_path):
    held = {
        "dense": DENSE, "complex": DENSE + 2j * DENSE[::-1], "single": DENSE.astype(np.float32), "row": np.arange(5),
        "bytes": np.arange(6, dtype=np.uint8).reshape(2, 3), "flags": np.array([[True, False]]), "one": np.array(2.5),
        "cube": RNG.standard_normal((2, 3, 4)), "sparse": SPARSE, "complex_sparse": SPARSE * (1 - 2j),
        "empty": np.zeros((0, 3)), "text": "a rig", "cells": np.array([1, "a"], dtype=object),
    }  # fmt: skip
    path = tmp_path / "a.mat"
    scipy.io.savemat(path, held, do_compression=packed)
    found, theirs = mat_arrays(path), scipy.io.loadmat(path)
    assert set(found) == set(held) - {"text", "cells"}
    for name, value in found.items():
        dense = value.toarray() if scipy.sparse.issparse(value) else value
        other = theirs[name].toarray() if scipy.sparse.issparse(theirs[name]) else theirs[name]
        np.testing.assert_array_equal(dense, other, err_msg=name)


def test_old_mat_files_are_refused_by_name(tmp_path):
    scipy.io.savemat(tmp_path / "a.mat", {"x": DENSE}, format="4")
    with pytest.raises(FileError, match=r"a\.mat: expected a MAT-file of MATLAB, version 5 to 7"):
        mat_arrays(tmp_path / "a.mat")


SQUARE = RNG.standard_normal((5, 5))


@pytest.mark.parametrize(
    "matrix",
    [
        SPARSE, SPARSE.tocoo() * 1j, DENSE, DENSE * (1 + 1j), SQUARE + SQUARE.T, SQUARE - SQUARE.T,
        scipy.sparse.csr_array(SQUARE + SQUARE.T), scipy.sparse.csr_array(SQUARE - SQUARE.T),
        scipy.sparse.csr_array(SQUARE + SQUARE.T + 1j * (SQUARE - SQUARE.T)), SQUARE.round().astype(int),
    ],
)  # fmt: skip
def test_numbers_of_matrix_market(matrix, tmp_path):
    scipy.io.mmwrite(tmp_path / "a.mtx", matrix)
    found = matrix_market(tmp_path / "a.mtx")
    assert scipy.sparse.issparse(found) == scipy.sparse.issparse(matrix)
    dense = [x.toarray() if scipy.sparse.issparse(x) else x for x in (found, matrix)]
    np.testing.assert_allclose(*dense, rtol=1e-14)
