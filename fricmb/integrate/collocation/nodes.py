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
from fricmb.integrate.formulas.tableau import Tableau, radau
from fricmb.integrate.problem import Floats, Floats2

#: Moments kept; enough for w h up to 8 (and the three extra orders of the end weights).
TERMS = 48
#: Rungs of the ladder of step sizes, each a quarter of an octave.
RUNGS = 400
#: Largest w h up to which exact weights are stable in stick, by number of nodes.
Z_EXACT = {4: 3.0, 5: 4.0, 6: 4.0, 7: 8.0, 8: 8.0, 9: 8.0}


class Nodes(NamedTuple):
    """Tables for s nodes.

    ``tab``: the formula.  Of the polynomial through the nodes alone: ``monomial`` (s, s) its coefficients (rows) by
    values at the nodes, ``tails`` (2, s) its last two Legendre coefficients.  ``mo`` (TERMS, s+1, s'): moments, and
    ``c^(m+1)/(m+1)!`` (their row sums) in the last row.  ``basis`` (s, s'): ``monomial`` node by node, with places that
    stay 0 for ``compile.lanes``.
    """

    tab: Tableau
    monomial: Floats2
    tails: Floats2
    mo: Floats
    basis: Floats2


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
    to_legendre = np.linalg.inv(legendre.legvander(2.0 * c - 1.0, s - 1))
    monomial = np.ascontiguousarray(np.linalg.inv(np.vander(c, increasing=True)))
    factorial = np.cumprod(np.arange(1.0, TERMS + 1.0))
    mo = np.zeros((TERMS, s + 1, padded(s)))
    mo[:, :s, :s] = _moments(c)
    mo[:, s, :s] = np.array([c ** (m + 1) / factorial[m] for m in range(TERMS)])
    basis = np.zeros((s, padded(s)))
    basis[:, :s] = monomial.T
    return Nodes(tableau, monomial, np.ascontiguousarray(to_legendre[[s - 1, s - 2]]), mo, basis)
