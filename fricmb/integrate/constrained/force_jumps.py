"""Forces of elements that jump within a step of the driver of scenes with joints: see ``step.force_jumps``."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.constrained.element_bends import bring_to_dofs, place_bodies
from fricmb.integrate.constrained.moving import Moving
from fricmb.integrate.constrained.problem_structs import Mech
from fricmb.integrate.constrained.radau_step import Control, asked
from fricmb.integrate.constrained.stages import Stages
from fricmb.integrate.constrained.state import State
from fricmb.integrate.problem import Floats
from fricmb.integrate.run.breakpoints import EPS
from fricmb.integrate.step.element_bends import look
from fricmb.integrate.step.force_jumps import find_jump, put_arguments
from fricmb.integrate.step.knots import NEAR
from fricmb.integrate.step.slow_slip import WITHIN

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
        look(place_bodies, mech, k, st.tab, y, st, beside if i == 0 else 1.0 - beside, h, line, state)
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
