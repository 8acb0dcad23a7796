"""Ports beside linear contacts: nonlinear elements and varying normal forces, all condensed to the contacts.

Elements are ports of their own, f = phi(x) with arguments x affine in all inputs.  Newton's method on them is
eliminated before the contacts are solved for: with r = phi(x) - f and J = phi',

    dx = (I - T_EE J)^-1 (T_EE r + T_EC dF),   df = r + J dx,

where T are the transfers between inputs and outputs over all nodes.  The contacts then see a changed transfer.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.blocks_in_step import all_outputs
from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.lapack import solve_rows
from fricmb.integrate.compile.template import call
from fricmb.integrate.model.forces import Scratch, evaluate
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import OPEN, Floats3
from fricmb.integrate.step.contact_newton import solve_ports
from fricmb.integrate.step.one_step_room import Accuracy, OneStep


@kernel
def first_inputs(packed: Packed, s: Scratch, y: State, one: OneStep) -> None:
    """Inputs at the start of the step as guesses for all nodes (X holds the start)."""
    ex, w = one.exact, one.w
    m = y.g.shape[0]
    nv = w.Fin.shape[1] - m
    n_s = w.F.shape[0]
    for i in range(n_s):
        for a in range(m):
            ex.P[a, i] = w.F[i, a]
            w.Fin[i, a] = w.F[i, a]
        for k in range(y.mode.shape[0]):
            if packed.ports.var[k] >= 0:
                if y.mode[k] == OPEN:
                    w.N[i, k] = 0.0
                w.Fin[i, m + packed.ports.var[k]] = w.N[i, k]
                ex.P[m + packed.ports.var[k], i] = w.N[i, k] - packed.ports.N0[k]
    for k in range(packed.elements.address.shape[0]):
        evaluate(packed.elements, k, s)
        first = packed.spread.f_start[k]
        for b in range(first, packed.spread.f_start[k + 1]):
            for i in range(n_s):
                ex.P[m + nv + b, i] = s.out[b - first]


@kernel
def evaluate_elements(packed: Packed, s: Scratch, one: OneStep, m: int, nv: int) -> None:
    """Residuals ``fe`` and slopes ``J`` of elements at the present outputs."""
    ex = one.exact
    for i in range(ex.x.shape[1]):
        at = 0
        for k in range(packed.elements.address.shape[0]):
            count = packed.elements.x_start[k + 1] - packed.elements.x_start[k]
            for a in range(count):
                s.x[a] = ex.x[m + at + a, i]
            call(packed.elements.address[k], s.x, 0, packed.elements.p, packed.elements.p_start[k], s.out, 0)
            first = packed.spread.f_start[k]
            n_f = packed.spread.f_start[k + 1] - first
            for b in range(n_f):
                ex.fe[i, first + b] = s.out[b] - ex.P[m + nv + first + b, i]
                for a in range(count):
                    ex.J[i, first + b, at + a] = s.out[n_f + b * count + a]
            at += count


@kernel
def evaluate_normals(packed: Packed, s: Scratch, one: OneStep, first: int) -> None:
    """Normal forces at the present outputs into ``one.N``, their slopes into ``JN``."""
    ex = one.exact
    for i in range(ex.x.shape[1]):
        at = 0
        for k in range(packed.ports.var.shape[0]):
            if packed.ports.var[k] < 0:
                continue
            count = packed.normals.x_start[k + 1] - packed.normals.x_start[k]
            for a in range(count):
                s.x[a] = ex.x[first + at + a, i]
            call(packed.normals.address[k], s.x, 0, packed.normals.p, packed.normals.p_start[k], s.out, 0)
            one.N[i, k] = s.out[0]
            for a in range(count):
                ex.JN[i, packed.ports.var[k], at + a] = s.out[1 + a]
            at += count


@kernel
def eliminate_elements(one: OneStep, slot: int, m: int, mi: int, JR: Floats3) -> bool:
    """Answer of elements to their residuals (row 0) and to port inputs (1 + l mi + c): ``R``, and their forces J R."""
    ex = one.exact
    n_in = ex.b1.shape[0]
    n_s = ex.x.shape[1]
    nx = ex.J.shape[2]
    nf = ex.J.shape[1]
    inner = nx * n_s
    tk = ex.tk
    for i in range(n_s):
        for a in range(nx):
            row = i * nx + a
            for x in range(inner):
                ex.A[row * inner + x] = 0.0
            ex.A[row * inner + row] = 1.0
            value = 0.0
            for f in range(nf):
                pair = n_in * (m + a) + mi + f
                for l in range(n_s):
                    gain = tk[slot, pair, i, l]
                    if gain != 0.0:
                        value += gain * ex.fe[l, f]
                        for b in range(nx):
                            ex.A[row * inner + l * nx + b] -= gain * ex.J[l, f, b]
            ex.R[0, row] = value
            for l in range(n_s):
                for c in range(mi):
                    ex.R[1 + l * mi + c, row] = tk[slot, n_in * (m + a) + c, i, l]
    if not solve_rows(ex.A, ex.R, inner, one.w.sizes, ex.pivots):
        return False
    for x in range(ex.R.shape[0]):
        for l in range(n_s):
            for f in range(nf):
                value = 0.0
                for b in range(nx):
                    value += ex.J[l, f, b] * ex.R[x, l * nx + b]
                JR[x, f, l] = value
    for l in range(n_s):
        for f in range(nf):
            JR[0, f, l] += ex.fe[l, f]
    return True


@kernel
def through_elements(one: OneStep, slot: int, o: int, i: int, x: int, mi: int, JR: Floats3) -> float:
    """What reaches output o at node i through the elements' forces of column x."""
    ex = one.exact
    value = 0.0
    for f in range(JR.shape[1]):
        pair = ex.b1.shape[0] * o + mi + f
        for l in range(JR.shape[2]):
            value += ex.tk[slot, pair, i, l] * JR[x, f, l]
    return value


@kernel
def condense(packed: Packed, y: State, one: OneStep, slot: int, JR: Floats3) -> None:
    """Outputs and transfer of the contacts, with the elements and slopes of normal forces in them."""
    ex, w = one.exact, one.w
    m = y.g.shape[0]
    mi = w.Fin.shape[1]
    n_s = w.F.shape[0]
    nx = ex.J.shape[2]
    for i in range(n_s):
        for a in range(m):
            w.gb[i, a] = ex.x[a, i] + through_elements(one, slot, a, i, 0, mi, JR)
            for l in range(n_s):
                for c in range(mi):
                    value = ex.tk[slot, ex.b1.shape[0] * a + c, i, l]
                    if nx > 0:
                        value += through_elements(one, slot, a, i, 1 + l * mi + c, mi, JR)
                    w.G[i * mi + a, l * mi + c] = value
        for k in range(y.mode.shape[0]):
            v = packed.ports.var[k]
            if v < 0:
                continue
            w.gb[i, m + v] = one.N[i, k]
            for x in range(n_s * mi):
                w.G[i * mi + m + v, x] = 0.0
            for b in range(ex.JN.shape[2]):
                slope = ex.JN[i, v, b]
                if slope == 0.0:
                    continue
                o = m + nx + b
                w.gb[i, m + v] += slope * through_elements(one, slot, o, i, 0, mi, JR)
                for l in range(n_s):
                    for c in range(mi):
                        value = ex.tk[slot, ex.b1.shape[0] * o + c, i, l]
                        if nx > 0:
                            value += through_elements(one, slot, o, i, 1 + l * mi + c, mi, JR)
                        w.G[i * mi + m + v, l * mi + c] += slope * value


@kernel
def take_inputs(packed: Packed, y: State, one: OneStep, JR: Floats3) -> float:
    """Bring all inputs to what has been solved for; returns the largest change by its weight."""
    ex, w = one.exact, one.w
    m = y.g.shape[0]
    mi = w.Fin.shape[1]
    n_s = w.F.shape[0]
    change = 0.0
    for f in range(JR.shape[1]):
        for l in range(n_s):
            gain = JR[0, f, l]
            for j in range(n_s):
                for c in range(mi):
                    gain += JR[1 + j * mi + c, f, l] * (w.Fin[j, c] - w.Fo[j, c])
            ex.P[mi + f, l] += gain
            change = max(change, abs(gain) * ex.weight[mi + f])
    for i in range(n_s):
        for c in range(mi):
            change = max(change, abs(w.Fin[i, c] - w.Fo[i, c]) * ex.weight[c])
        for a in range(m):
            ex.P[a, i] = w.F[i, a]
        for k in range(y.mode.shape[0]):
            if packed.ports.var[k] >= 0:
                ex.P[m + packed.ports.var[k], i] = w.N[i, k] - packed.ports.N0[k]
    return change


@block
def exact_ports(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, slot: int) -> bool:
    """Solve for contacts, elements and varying normal forces together; inputs into P.  False without convergence."""
    ex, w = one.exact, one.w
    m = y.g.shape[0]
    mi = w.Fin.shape[1]
    n_s = w.F.shape[0]
    first_normal = m + ex.J.shape[2]
    enough = 0.01 * ex.safety * acc.rtol
    JR = np.zeros((1 + n_s * mi, ex.J.shape[1], n_s))
    first_inputs(packed, s, y, one)
    last = np.inf
    for iteration in range(15):
        all_outputs(ex, slot)
        evaluate_elements(packed, s, one, m, mi - m)
        evaluate_normals(packed, s, one, first_normal)
        if ex.J.shape[2] > 0 and not eliminate_elements(one, slot, m, mi, JR):
            return False
        condense(packed, y, one, slot, JR)
        for i in range(n_s):
            for c in range(mi):
                w.Fo[i, c] = w.Fin[i, c]
        if solve_ports(packed.ports, packed.laws, s, w, one.st.hA, y.mode, one.tol) < 0:
            return False
        change = take_inputs(packed, y, one, JR)
        if not change < np.inf:
            return False
        rate = change / last
        if change < 1e-3 * enough or (iteration > 0 and rate < 0.5 and change * rate < enough):
            all_outputs(ex, slot)
            evaluate_normals(packed, s, one, first_normal)
            return True
        if iteration > 4 and rate > 2.0:
            return False
        last = change
    return False
