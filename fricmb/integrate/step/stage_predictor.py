"""Where a one-step step's Newton iterations start: on the polynomial of the stages solved last, or at its beginning."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.law_values import magnitude
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import LAW_SMOOTH, OPEN, SLIP, Floats, Floats2
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.stages import Stages
from fricmb.integrate.step.tableau import Tableau

#: Lengths of the last step over which its polynomial is continued.
REACH = 2.6


@kernel
def contacts_from_start(packed: Packed, y: State, w: PortState, i: int) -> None:
    """Law states, and all that belongs to contacts, at stage i from the beginning of the step."""
    for a in range(y.z.shape[0]):
        w.z[i, a] = y.z[a]
    for k in range(y.mode.shape[0]):
        row0 = packed.ports.row[k]
        w.N[i, k] = y.N[k]
        w.r[i, k] = magnitude(packed.ports.row, k, y.g)
        for a in range(row0, packed.ports.row[k + 1]):
            w.F[i, a] = y.F[a] if y.mode[k] != OPEN else 0.0
            w.n[i, a] = y.n[a]
            w.g[i, a] = y.g[a]


@kernel
def start_at_rest(packed: Packed, y: State, tab: Tableau, st: Stages, w: PortState, h: float) -> None:
    """Stages from the values at the beginning of the step."""
    for i in range(tab.c.shape[0]):
        for a in range(y.q.shape[0]):
            st.V[i, a] = y.v[a] + tab.c[i] * h * y.a[a]
        contacts_from_start(packed, y, w, i)


@kernel
def start_on_last(
    packed: Packed, y: State, tab: Tableau, st: Stages, w: PortState, t: float, last_h: float, h: float
) -> bool:
    """Stages from the polynomial through those of the step ``last_h`` from ``t``; False where it says nothing here."""
    if last_h == 0.0 or packed.ports.soft > 0.0:
        # of redundant contacts the sum alone is determined: their shares would drift from step to step
        return False
    shift = (y.t - t) / last_h
    ratio = h / last_h
    if not (shift >= -1e-9 and shift + ratio <= REACH):
        return False
    weight = st.weight
    for i in range(tab.c.shape[0]):
        st.line[i] = shift + ratio * tab.c[i]
    lagrange(tab.c, st.line, weight)
    if packed.elements.address.shape[0] > 0:
        carry(st.V, weight, st.line)
    else:
        # a linear structure follows in one iteration; what is at rest stays there to the last digit
        for i in range(tab.c.shape[0]):
            for a in range(y.q.shape[0]):
                st.V[i, a] = y.v[a] + tab.c[i] * h * y.a[a]
    carry(w.z, weight, st.line)
    carry(w.N, weight, st.line)
    carry(w.r, weight, st.line)
    carry(w.g, weight, st.line)
    carry(w.n, weight, st.line)
    for k in range(y.mode.shape[0]):
        row0 = packed.ports.row[k]
        turns = y.mode[k] == SLIP and packed.ports.law[k] != LAW_SMOOTH and packed.ports.row[k + 1] - row0 > 1
        for i in range(tab.c.shape[0]):
            # constant values would bring round-off in, times the weights
            if packed.ports.var[k] < 0:
                w.N[i, k] = y.N[k]
            for a in range(row0, packed.ports.row[k + 1]):
                w.F[i, a] = y.F[a] if y.mode[k] != OPEN else 0.0
                # no equation holds a direction that does not turn: carried on, its round-off would grow without end
                if not turns:
                    w.n[i, a] = y.n[a]
        for i in range(tab.c.shape[0] if turns else 0):
            size = np.sqrt(w.n[i, row0] ** 2 + w.n[i, row0 + 1] ** 2)
            if not 0.5 < size < 2.0:
                return False
            w.n[i, row0] /= size
            w.n[i, row0 + 1] /= size
    return True


@kernel
def lagrange(nodes: Floats, x: Floats, weight: Floats2) -> None:
    """Weights (s, k) of values at the k nodes for the points x (s,)."""
    for i in range(weight.shape[0]):
        for j in range(nodes.shape[0]):
            product = 1.0
            for k in range(nodes.shape[0]):
                if k != j:
                    product *= (x[i] - nodes[k]) / (nodes[j] - nodes[k])
            weight[i, j] = product


@kernel
def carry(values: Floats2, weight: Floats2, line: Floats) -> None:
    """Values (s, .) at the nodes become those at the points that the weights are for."""
    s = values.shape[0]
    for a in range(values.shape[1]):
        for i in range(s):
            x = 0.0
            for j in range(s):
                x += weight[i, j] * values[j, a]
            line[i] = x
        for i in range(s):
            values[i, a] = line[i]
