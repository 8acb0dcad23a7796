"""Formulas as arrays: collocation, Radau IIA above all, and the one-stage form that every BDF step has.

An implicit formula is seen by the stage solver as  V_i = psi_i + h sum_j A_ij V'_j.  A is diagonalised once,
A = T diag(lam) T^-1, so that a stage system of s n unknowns falls into complex systems of n (Butcher 1976;
Hairer and Wanner, Solving ODEs II, IV.8).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.layout import Layout
from fricmb.integrate.compile.room import room
from fricmb.integrate.problem import Complexes, Complexes2, Floats, Floats2


class Tableau(Layout):
    """c, b (s,), A (s, s); lam (l,), T (s, l), Tinv (l, s) over one of each conjugate pair (T doubled for a pair).

    ``top`` (2, s+1): the last and the last but one Legendre coefficient of the polynomial through the values at 0, c.
    ``mid`` (s, s+1): its values half-way between neighbours of 0, c.  ``rate`` (s, s+1): its derivatives at c.
    ``basis`` (s+1, s+1): monomial coefficients of the same polynomial, row k for x^k.
    """

    c: Floats
    A: Floats2
    b: Floats
    lam: Complexes
    T: Complexes2
    Tinv: Complexes2
    top: Floats2
    mid: Floats2
    rate: Floats2
    basis: Floats2


@kernel
def by_line(line: Floats, start: float, values: Floats2, column: int) -> float:
    """What a line of ``top`` or ``mid`` makes of the value at the start of a step and a column of stage values."""
    value = line[0] * start
    for i in range(values.shape[0]):
        value += line[i + 1] * values[i, column]
    return float(value)


@kernel
def largest_in_step(start: float, values: Floats2, column: int) -> float:
    """The largest magnitude of a quantity at the start of a step and at its stages."""
    size = abs(start)
    for i in range(values.shape[0]):
        size = max(size, abs(values[i, column]))
    return float(size)


def _radau_nodes(s: int) -> Floats:
    # right Radau points: zeros of P_s - P_{s-1} on [-1, 1], mapped to [0, 1]
    coefficients = np.zeros(s + 1)
    coefficients[s], coefficients[s - 1] = 1.0, -1.0
    c = np.sort(legendre.legroots(coefficients).real)
    for _ in range(3):
        c -= legendre.legval(c, coefficients) / legendre.legval(c, legendre.legder(coefficients))
    c = 0.5 * (c + 1.0)
    c[-1] = 1.0
    return np.asarray(c)


def _diagonalised(A: Floats) -> tuple[Complexes, Complexes, Complexes]:
    lam, T = np.linalg.eig(A)
    Tinv = np.linalg.inv(T)
    keep = [i for i in range(len(lam)) if lam[i].imag >= -1e-14]
    weight = np.array([1.0 if abs(lam[i].imag) < 1e-14 else 2.0 for i in keep])
    lam_kept = np.where(weight == 1.0, lam[keep].real, lam[keep]).astype(complex)
    return lam_kept, np.ascontiguousarray(T[:, keep] * weight, dtype=complex), np.ascontiguousarray(Tinv[keep], complex)


@lru_cache(maxsize=16)
def radau(s: int) -> Tableau:
    """Radau IIA with s stages, order 2s - 1 (Ehle 1969; Axelsson 1969)."""
    return collocated(tuple(_radau_nodes(s).tolist()))


@lru_cache(maxsize=16)
def collocated(nodes: tuple[float, ...]) -> Tableau:
    """Collocation at nodes in (0, 1], the last of them 1: order s at least (Guillou and Soulé 1969; Wright 1970).

    Raises
    ------
    ValueError
        If the nodes are none, do not rise, or do not end at 1.
    """
    c, s = np.array(nodes, dtype=float), len(nodes)
    if s < 1 or not np.isfinite(c).all() or c[0] <= 0.0 or c[-1] != 1.0 or (np.diff(c) <= 0.0).any():
        raise ValueError(f"nodes must rise within (0, 1] and end at 1, got {nodes!r}")
    gauss, weight = legendre.leggauss(s + 2)
    A = np.empty((s, s))
    for j in range(s):
        others = np.delete(c, j)
        for i in range(s):
            x = 0.5 * c[i] * (gauss + 1.0)
            A[i, j] = 0.5 * c[i] * np.sum(weight * np.prod((x[:, None] - others) / (c[j] - others), axis=1))
    lam, T, Tinv = _diagonalised(A)
    points = np.concatenate([[0.0], c])
    to_legendre = np.linalg.inv(legendre.legvander(2.0 * points - 1.0, s))
    middle = 0.5 * (points[1:] + points[:-1])
    mid = legendre.legvander(2.0 * middle - 1.0, s) @ to_legendre
    basis = np.linalg.inv(np.vander(points, increasing=True))
    powers = np.arange(1, s + 1)
    rate = (powers * c[:, None] ** (powers - 1)) @ basis[1:]
    top = np.ascontiguousarray(to_legendre[[s, s - 1]])
    return room(
        Tableau(c, A, A[-1].copy(), lam, T, Tinv, top, np.ascontiguousarray(mid), np.ascontiguousarray(rate), basis)
    )


@lru_cache(maxsize=1)
def one_stage() -> Tableau:
    """The form of a BDF step: one stage, h standing for the formula's beta h."""
    one, unit = np.ones(1), np.ones((1, 1))
    line = np.array([[-0.5, 0.5], [0.5, 0.5]])
    return room(Tableau(
        one, unit, one, one.astype(complex), unit.astype(complex), unit.astype(complex),
        line, np.full((1, 2), 0.5), np.array([[-1.0, 1.0]]), np.array([[1.0, 0.0], [-1.0, 1.0]]),
    ))  # fmt: skip
