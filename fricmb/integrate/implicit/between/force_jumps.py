"""Forces of elements that jump within a step: where the two ends of a spring pass through each other.

The direction of such a force turns over within no length.  Stages on both sides of it may hide it from an error
estimate, which sees polynomials.
"""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.compile.template import call
from fricmb.integrate.implicit.between.element_bends import bring_to_dofs, look
from fricmb.integrate.implicit.between.knots import NEAR
from fricmb.integrate.implicit.between.slow_slip import WITHIN
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.forces import Scratch, gather
from fricmb.integrate.model.problem_structs import Spread, Table
from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS

#: Halvings of the way from the start to the end of a step, each time towards the larger change of the force.
HALVINGS = 10


@kernel
def put_arguments(elements: Table, s: Scratch, x: Floats) -> None:
    """Arguments of all elements at X, one element's after the other's."""
    start = elements.x_start
    for k in range(start.shape[0] - 1):
        gather(elements, k, s.X, x[start[k] :])


@kernel
def put_force(elements: Table, s: Scratch, k: int, x: Floats, out: Floats) -> None:
    """Force of element k and its slopes, for its arguments."""
    for a in range(x.shape[0]):
        s.x[a] = x[a]
    call(elements.address[k], s.x, 0, elements.p, elements.p_start[k], s.out, 0)
    for a in range(out.shape[0]):
        out[a] = s.out[a]


@kernel
def change(a: Floats, b: Floats, n_f: int) -> float:
    """Size of the difference of two forces."""
    value = 0.0
    for i in range(n_f):
        value = max(value, abs(a[i] - b[i]))
    return value


@kernel
def close_in(elements: Table, s: Scratch, k: int, x: Floats2, f: Floats2, n_f: int) -> None:
    """Halve the way between the arguments ``x[0]`` and ``x[1]`` to where the force (rows of ``f``) changes most."""
    for _ in range(HALVINGS):
        for a in range(x.shape[1]):
            x[2, a] = 0.5 * (x[0, a] + x[1, a])
        put_force(elements, s, k, x[2], f[2])
        half = 0 if change(f[1], f[2], n_f) > change(f[0], f[2], n_f) else 1
        x[half] = x[2]
        f[half] = f[2]


@kernel
def turns_over(elements: Table, s: Scratch, k: int, first: Floats, last: Floats, f: Floats2, n_f: int) -> bool:
    """Whether the force of element k changes with those of its arguments that change their signs.

    Others may have made it jump (where forces bend, steps end), beside a speed that is but round-off of rest.
    """
    x = first.copy()
    for a in range(x.shape[0]):
        if first[a] * last[a] < 0.0:
            x[a] = last[a]
    put_force(elements, s, k, first, f[0])
    put_force(elements, s, k, x, f[1])
    return change(f[0], f[1], n_f) > 0.0


@kernel
def find_jump(elements: Table, spread: Spread, s: Scratch, k: int, ends: Floats2, jump: Floats) -> bool:
    """Jumps of the forces of element k between its arguments at two ends (``put_arguments``); False without any.

    A jump is what the slopes at both ends of a short piece of the way do not explain.
    """
    first_x = elements.x_start[k]
    n_x = elements.x_start[k + 1] - first_x
    crosses = False
    for a in range(first_x, first_x + n_x):
        crosses = crosses or ends[0, a] * ends[1, a] < 0.0
    if not crosses:
        return False
    x = np.zeros((3, n_x))
    for a in range(n_x):
        x[0, a], x[1, a] = ends[0, first_x + a], ends[1, first_x + a]
    n_f = spread.f_start[k + 1] - spread.f_start[k]
    f = np.zeros((3, n_f * (1 + n_x)))
    if not turns_over(elements, s, k, x[0], x[1], f, n_f):
        return False
    put_force(elements, s, k, x[0], f[0])
    put_force(elements, s, k, x[1], f[1])
    close_in(elements, s, k, x, f, n_f)
    for b in range(n_f):
        jump[b] = f[1, b] - f[0, b]
        for a in range(n_x):
            at = n_f + b * n_x + a
            jump[b] -= 0.5 * (f[0, at] + f[1, at]) * (x[1, a] - x[0, a])
    return True


#: Part of the tolerance, as a part of a step at either end, within which a jump moves nothing: steps end where forces
#: bend, a rounding before it or behind it, and with the accuracy to which that is located.
BESIDE, LOCATED = 0.1, 4.0 * WITHIN


@block
def jump_error(mech: Mech, k: Moving, y: State, st: Stages, c: Control, scale: Floats, h: float) -> float:
    """What jumps of elements' forces within the step h just solved leave of velocities, over tolerance.

    ``scale`` (n,): what counts as 1 in these.  A force counts by what it does without joints, which is an upper bound.
    """
    elements, spread, n = mech.elements, mech.spread, y.q.shape[0]
    n_e = elements.address.shape[0]
    ends, jump = np.zeros((2, elements.x_start[n_e])), np.zeros(spread.start.shape[0])
    line, state, f = np.empty(st.tab.c.shape[0] + 1), np.empty((2, n)), np.empty(n)
    beside, worst = max(BESIDE * asked(c), LOCATED, NEAR * EPS * abs(y.t) / h), 0.0
    for i in range(2):
        look(mech, k, y, st, beside if i == 0 else 1.0 - beside, h, line, state)
        put_arguments(elements, k.s, ends[i])
    for e in range(n_e):
        if not find_jump(elements, spread, k.s, e, ends, jump):
            continue
        k.fy[:] = 0.0
        for b in range(spread.f_start[e], spread.f_start[e + 1]):
            for j in range(spread.start[b], spread.start[b + 1]):
                k.fy[spread.dof[j]] += spread.coefficient[j] * jump[b - spread.f_start[e]]
        bring_to_dofs(mech, k, n, f)
        for i in range(n):
            worst = max(worst, h * abs(f[i]) / (c.mass[i] * scale[i]))
    return float(worst / asked(c))
