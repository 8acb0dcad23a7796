"""Tables of a number of nodes: moments of the node polynomials, Legendre tails, interpolation.

The port forces of a step are polynomials through their values at the s Radau IIA nodes c_i; the structure's answer
to them needs the moments ``M_m[i, l] = int_0^c_i (c_i - t)^m / m! l_l(t) dt``, once for all scenes.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from fricmb.integrate.compile.lanes import padded
from fricmb.integrate.problem import Complexes, Floats
from fricmb.integrate.step.tableau import radau

#: Moments kept; enough for w h up to 8 (and the three extra orders of the end weights).
TERMS = 48
#: Rungs of the ladder of step sizes, each a quarter of an octave.
RUNGS = 400
#: Largest w h up to which exact weights are stable in stick, by number of nodes.
Z_EXACT = {4: 3.0, 5: 4.0, 6: 4.0, 7: 8.0, 8: 8.0, 9: 8.0}


class Nodes(NamedTuple):
    """Tables for s nodes, laid out for kernels (see ``collocation/layout``).

    nd (4, s+1, s+1): the nodes, their weights, the last two Legendre coefficients of the polynomial through the nodes
    and the last of that through 0 and the nodes; monomial coefficients (rows) of the polynomial through 0 and the nodes
    and of that through the nodes; the Radau IIA matrix A.  mo (TERMS, s+1, s'): moments, and ``c^(m+1)/(m+1)!`` (their
    row sums) in the last row.  cx (3, l, s): A diagonalised, one of each conjugate pair.  basis (s, s'): monomial
    coefficients of the polynomial that is 1 at a node and 0 at the others, node by node, with places that stay 0 for
    ``compile.lanes``.
    """

    nd: Floats
    mo: Floats
    cx: Complexes
    basis: Floats


def _moments(c: Floats) -> Floats:
    s = len(c)
    gauss, weight = legendre.leggauss(40)
    moments = np.empty((TERMS, s, s))
    for i in range(s):
        t = 0.5 * c[i] * (gauss + 1.0)
        scale = 0.5 * c[i] * weight
        for l in range(s):
            others = np.delete(c, l)
            basis = np.prod((t[:, None] - others) / (c[l] - others), axis=1)
            kernel = np.ones_like(t)
            for m in range(TERMS):
                moments[m, i, l] = np.sum(scale * kernel * basis)
                kernel = kernel * (c[i] - t) / (m + 1.0)
    return moments


@lru_cache(maxsize=8)
def nodes(s: int) -> Nodes:
    """The tables for s nodes (2 to 9)."""
    tableau = radau(s)
    c = tableau.c
    points = np.concatenate([[0.0], c])
    to_legendre = np.linalg.inv(legendre.legvander(2.0 * c - 1.0, s - 1))
    nd = np.zeros((4, s + 1, s + 1))
    nd[0, 0, :s], nd[0, 1, :s] = c, tableau.b
    nd[0, 2, :s], nd[0, 3, :s] = to_legendre[s - 1], to_legendre[s - 2]
    nd[0, 4] = np.linalg.inv(legendre.legvander(2.0 * points - 1.0, s))[s]
    nd[1] = np.linalg.inv(np.vander(points, increasing=True))
    nd[2, :s, :s] = np.linalg.inv(np.vander(c, increasing=True))
    nd[3, :s, :s] = tableau.A
    factorial = np.cumprod(np.arange(1.0, TERMS + 1.0))
    mo = np.zeros((TERMS, s + 1, padded(s)))
    mo[:, :s, :s] = _moments(c)
    mo[:, s, :s] = np.array([c ** (m + 1) / factorial[m] for m in range(TERMS)])
    cx = np.empty((3, len(tableau.lam), s), dtype=complex)
    cx[0], cx[1], cx[2] = tableau.lam[:, None], np.transpose(tableau.T), tableau.Tinv
    basis = np.zeros((s, padded(s)))
    basis[:, :s] = nd[2, :s, :s].T
    return Nodes(nd, mo, cx, basis)
