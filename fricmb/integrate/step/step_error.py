"""The error of a one-step step: what its stages leave unresolved, against tolerance and round-off."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block, declared
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.model.forces import Scratch
from fricmb.integrate.model.problem_structs import Packed
from fricmb.integrate.model.state import State
from fricmb.integrate.model.structure import Structure
from fricmb.integrate.problem import LAW_SMOOTH, STICK
from fricmb.integrate.step.bends_without_joints import begins_at_bend
from fricmb.integrate.step.contact_unknowns import PortState
from fricmb.integrate.step.event_functions import force_noise
from fricmb.integrate.step.force_jumps import jump_error
from fricmb.integrate.step.law_defect import law_defect
from fricmb.integrate.step.one_step import state_noise
from fricmb.integrate.step.one_step_room import Accuracy, OneStep, is_exact, widest
from fricmb.integrate.step.slip_growth import growth, too_long
from fricmb.integrate.step.slow_slip import slow_slip_defect
from fricmb.integrate.step.tableau import by_line, largest_in_step
from fricmb.integrate.step.weigh_forces import weigh_forces

#: Relative round-off of a number.
ROUND_OFF = 2.3e-16
#: Part of its limit to which the force of a stuck contact has to be resolved within a step.
RESOLVED = 0.01


@kernel
def spring_size(structure: Structure, acc: Accuracy, i: int) -> float:
    """Sum of the magnitudes of the spring forces on one degree of freedom."""
    value = 0.0
    for e in range(structure.first[i], structure.first[i + 1]):
        value += abs(structure.K[e]) * acc.q[structure.column[e]]
    return float(value)


@kernel
def grain(packed: Packed, y: State, w: PortState, acc: Accuracy, h: float, i: int) -> float:
    """Round-off of velocity i: friction that holds a body against its load leaves the difference of the two over h.

    A short step still carries what a long one before it has left.  A stiff spring turns the round-off of positions into
    forces, for as long as it takes to get rid of them.
    """
    # of all contacts: stuck ones are solved for together, and a joint that carries nothing gets the others' round-off
    push = 0.0
    for a in range(y.F.shape[0]):
        push = max(push, abs(y.F[a]))
        for j in range(w.F.shape[0]):
            push = max(push, abs(w.F[j, a]))
    structure = packed.structure
    own = structure.own[i]
    stiffness = max(abs(structure.K[own]), 1e-290)
    pull = spring_size(structure, acc, i) * ROUND_OFF * min(1.0, np.sqrt(structure.M[own] / stiffness) / h)
    acc.grain[i] = max(acc.grain[i], h * structure.mobility[i] * (1e-14 * push + pull))
    return float(acc.grain[i])


@kernel
def state_error(packed: Packed, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Largest scaled tail of the laws' internal states."""
    tab = one.tab
    worst = 0.0
    if y.z.shape[0] > 0:
        state_noise(packed, one, acc, h)
    for a in range(y.z.shape[0]):
        size = max(acc.z[a], largest_in_step(y.z[a], one.w.z, a), one.noise_z[a], 1e-290)
        worst = max(worst, abs(by_line(tab.top[0], y.z[a], one.w.z, a)) / size)
    return worst


@declared
def exact_error(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """:func:`step_error` on an exact structure; see ``collocation.finish_step``."""
    raise NotImplementedError


@kernel
def step_error(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Error of the step just solved in units of the tolerance."""
    if is_exact(one):
        return exact_error(packed, s, y, one, acc, h)
    return radau_error(packed, s, y, one, acc, h)


@block
def radau_error(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """:func:`step_error` by the last Legendre coefficients of velocity, position, states over the stages."""
    st, tab = one.st, one.tab
    n_s = tab.c.shape[0]
    worst = 0.0
    top_v = widest(acc.v)
    top_q = widest(acc.q)
    for i in range(y.q.shape[0]):
        e_v, e_q = by_line(tab.top[0], y.v[i], st.V, i), by_line(tab.top[0], y.q[i], st.Q, i)
        size_v = max(acc.v[i], largest_in_step(y.v[i], st.V, i))
        size_q = max(acc.q[i], largest_in_step(y.q[i], st.Q, i))
        size_v = max(size_v, acc.floor_v[i], 1e-10 * top_v, grain(packed, y, one.w, acc, h, i) / acc.rtol, 1e-290)
        # a position that has only begun to move is measured by what its velocity brings within the step
        size_q = max(size_q, acc.floor_q[i], 1e-10 * top_q, h * size_v)
        worst = max(worst, abs(e_v) / size_v, abs(e_q) / size_q)
    worst = max(worst, state_error(packed, y, one, acc, h))
    weigh_forces(packed, y, one, acc)
    worst = max(worst, unseen_by_nodes(packed, s, y, one, acc, h))
    worst = max(worst / acc.rtol, too_long(growth(packed.ports, packed.laws, s, y, one.w, one.felt, h), n_s))
    worst = max(worst, jump_error(packed, s, y, st.t[n_s - 1], st.Q[n_s - 1], st.V[n_s - 1], acc, h))
    fresh = packed.bends.address.shape[0] > 0 and begins_at_bend(packed, s, y, one, h)
    return float(max(worst, unseen_force(packed, y, one, acc, h, fresh)))


@kernel
def unseen_by_nodes(packed: Packed, s: Scratch, y: State, one: OneStep, acc: Accuracy, h: float) -> float:
    """Largest error, by its own scale, that laws leave between the nodes; ``one.felt`` is that of the step."""
    ports, laws, tab, w, felt = packed.ports, packed.laws, one.tab, one.w, one.felt
    slow = slow_slip_defect(ports, laws, s, tab, y, w, felt, acc.rtol, h)
    return float(max(law_defect(ports, laws, s, tab, y, w, felt, h), slow))


@kernel
def unseen_force(packed: Packed, y: State, one: OneStep, acc: Accuracy, h: float, fresh: bool) -> float:
    """Error of the forces of stuck contacts, in units of what is allowed: where nothing moves, only they show a load.

    Not a matter of accuracy, but of seeing that a limit has been passed: transitions are located with steps of their
    own.  ``fresh``: the step begins where forces jump, and its first value is that before the jump.
    """
    worst = 0.0
    n_s = one.tab.c.shape[0]
    for k in range(y.mode.shape[0]):
        if y.mode[k] != STICK or packed.ports.law[k] == LAW_SMOOTH:
            continue
        N = y.N[k]
        for j in range(n_s):
            N = max(N, one.w.N[j, k])
        allowed = RESOLVED * abs(packed.ports.mu_s[k]) * N + 1e-290
        for a in range(packed.ports.row[k], packed.ports.row[k + 1]):
            error = by_line(one.tab.top[0], one.w.F[0, a] if fresh else y.F[a], one.w.F, a)
            if abs(error) > allowed:
                noise = 30.0 * force_noise(packed, y, k, h) + spring_noise(packed, acc, a)
                worst = max(worst, abs(error) / (allowed + noise))
    return float(worst)


@kernel
def spring_noise(packed: Packed, acc: Accuracy, a: int) -> float:
    """What the round-off of positions makes of the forces of springs that a stuck contact carries in row a."""
    noise = 0.0
    for i in range(acc.q.shape[0]):
        if packed.ports.W[i, a] != 0.0:
            noise += abs(packed.ports.W[i, a]) * spring_size(packed.structure, acc, i)
    return float(32.0 * ROUND_OFF * noise)
