"""Powers at the nodes of a step of exact structure, for the energies over it."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.block_motion import between_nodes
from fricmb.integrate.collocation.motion_in_step import gains_at_nodes, input_series
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch, belt_velocity, normal_force, powers, set_instant
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.problem import OPEN, Floats2
from fricmb.integrate.step.one_step_room import OneStep


@kernel
def powers_on_motion(
    packed: Packed, s: Scratch, y: State, one: OneStep, h: float, span: float, whole: bool, power: Floats2
) -> None:
    """Powers at the nodes of a step of length ``span`` on the motion of the step h, into ``power``.

    ``whole``: the two are one, and what acts at the nodes has been solved for.
    """
    ex, w = one.exact, one.w
    n, m, n_s = y.q.shape[0], y.g.shape[0], w.F.shape[0]
    series, gain = np.empty((2 * ex.w2.shape[1], n_s + 1)), np.empty((2, n_s + 1))
    F, N, g = np.empty(m), np.empty(y.N.shape[0]), np.empty(m)
    input_series(ex, ex.P, h, series, gain)
    gains_at_nodes(ex, h, span, series, ex.node[0], ex.node[1])
    for j in range(n_s):
        tau = ex.tab.c[j] * span
        for i in range(n):
            ex.node[0, j, i] += y.q[i]
            ex.node[1, j, i] += y.v[i]
        set_instant(packed.signals, s, y.t + tau, ex.node[0, j], ex.node[1, j])
        if whole:
            powers(packed, s, w.F[j], w.N[j], w.g[j], power[j])
            continue
        for k in range(y.mode.shape[0]):
            load = normal_force(packed.ports, packed.normals, k, s)
            N[k] = 0.0 if y.mode[k] == OPEN or load < 0.0 else load
        for a in range(m):
            g[a] = -belt_velocity(packed.ports, s, n, a)
            for i in range(n):
                g[a] += packed.ports.W[i, a] * ex.node[1, j, i]
            F[a] = between_nodes(ex.monomial, w.F[:, a], tau / h)
        powers(packed, s, F, N, g, power[j])


@kernel
def node_powers(packed: Packed, s: Scratch, y: State, one: OneStep, h: float) -> None:
    """Powers at the nodes of a step as it was solved, into ``one.power``."""
    w = one.w
    if one.exact.ledger == 1:
        powers_on_motion(packed, s, y, one, h, h, True, one.power)
    else:
        one.power[:, :] = 0.0
        for j in range(w.F.shape[0]):
            for k in range(y.mode.shape[0]):
                for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
                    one.power[j, k] -= w.F[j, a] * w.g[j, a]
