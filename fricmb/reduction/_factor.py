"""Factors of large sparse matrices whose pattern is symmetric."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import scipy.sparse
from scipy.sparse.linalg import splu

Solve = Callable[[Any], Any]

#: Real symmetric matrices with more rows than this go to PARDISO where it is installed (extra ``fast``).
MANY = 20_000


def factor(A: Any) -> Solve:
    """Solves with a regular sparse matrix, real or complex, with a symmetric pattern: a function of right-hand sides.

    Raises
    ------
    RuntimeError
        If the matrix is singular.
    """
    if A.shape[0] > MANY and not np.iscomplexobj(A):
        solve = _pardiso(A)
        if solve is not None:
            return solve
    # minimum degree on A + A^T and pivots on the diagonal where they will do: half the fill of an ordering by columns
    options = {"SymmetricMode": True}
    found: Any = splu(A.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01, options=options)
    return lambda b: found.solve(np.asarray(b, dtype=A.dtype) if not np.iscomplexobj(b) else b)


def _pardiso(A: Any) -> Solve | None:
    """PARDISO's factors of a real symmetric matrix that may be indefinite; None where it is not installed."""
    try:
        from pypardiso import PyPardisoSolver
    except ImportError:
        return None
    upper = scipy.sparse.triu(A, format="csr").astype(float)
    upper.sort_indices()
    # PARDISO asks for every entry of the diagonal, those that are 0 as well
    upper = (upper + scipy.sparse.diags_array(np.zeros(A.shape[0]), format="csr")).tocsr()
    solver = PyPardisoSolver(mtype=-2)
    solver.factorize(upper)
    return lambda b: solver.solve(upper, np.asarray(b, dtype=float))
