"""Implicit steps of a structure that is narrow in some order: banded factors in place of inverses.

Cost and memory grow with the number of degrees of freedom, not with its square.
"""

from __future__ import annotations

from fricmb.integrate.compile.band import factor_band, solve_band
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.problem import Complexes
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.step_matrix import Factor, port_inputs, port_outputs
from fricmb.integrate.step.tableau import Tableau


@block
def factorise_band(packed: Packed, tab: Tableau, h: float, fac: Factor, w: PortState) -> bool:
    """Fill the present slot for h from the Jacobian.  False where a matrix is singular."""
    structure = packed.structure
    start, index, place, M, K, C = (
        structure.first, structure.column, structure.place, structure.M, fac.K, fac.C,
    )  # fmt: skip
    n = place.shape[0]
    half = structure.half
    levels = tab.lam.shape[0]
    for x in range(levels):
        sigma = h * tab.lam[x]
        which = fac.slot * levels + x
        ab = fac.Sinv[which]
        ab[:, :] = 0.0
        for i in range(n):
            for e in range(start[i], start[i + 1]):
                j = place[index[e]]
                ab[j, 2 * half + place[i] - j] = M[e] + sigma * (C[e] + sigma * K[e])
        pivots = fac.pivots[which * n : (which + 1) * n]
        factors = ab.reshape(ab.size)
        if not factor_band(factors, pivots, fac.sizes):
            return False
        for c in range(fac.X.shape[1]):
            load_column(packed, c, sigma, fac.line)
            solve_band(factors, pivots, fac.sizes, fac.line)
            for i in range(n):
                fac.X[x, c, i] = fac.line[place[i]]
    port_inputs(tab, fac)
    port_outputs(packed.ports.W, tab.A, h, fac)
    return True


@kernel
def load_column(packed: Packed, c: int, weight: complex, line: Complexes) -> None:
    """Weight times what a unit input of port c does to the degrees of freedom, in the order of the band."""
    W, Wn, var, place = packed.ports.W, packed.ports.Wn, packed.ports.var, packed.structure.place
    m = W.shape[1]
    if c < m:
        for i in range(W.shape[0]):
            line[place[i]] = weight * W[i, c]
        return
    for k in range(var.shape[0]):
        if var[k] == c - m:
            for i in range(W.shape[0]):
                line[place[i]] = weight * Wn[i, k]


@block
def correct_band(packed: Packed, tab: Tableau, fac: Factor, st: Stages) -> None:
    """DV = -S^-1 res over all stages."""
    T, Tinv, res, dV, line = tab.T, tab.Tinv, st.res, st.dV, fac.line
    place = packed.structure.place
    n = place.shape[0]
    s = st.V.shape[0]
    levels = tab.lam.shape[0]
    dV[:, :] = 0.0
    for x in range(levels):
        which = fac.slot * levels + x
        for a in range(n):
            value = 0.0 + 0.0j
            for j in range(s):
                value += Tinv[x, j] * res[j, a]
            line[place[a]] = value
        ab = fac.Sinv[which]
        solve_band(ab.reshape(ab.size), fac.pivots[which * n : (which + 1) * n], fac.sizes, line)
        for a in range(n):
            for i in range(s):
                dV[i, a] -= (T[i, x] * line[place[a]]).real
