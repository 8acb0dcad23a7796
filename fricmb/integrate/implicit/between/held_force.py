"""Forces of ports that stick, within a step: where nothing moves, only they show a load."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.compile.block import block
from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.formulas.tableau import by_line
from fricmb.integrate.implicit.equations.slip_rows import lightness
from fricmb.integrate.implicit.scene.control import Control, asked
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import State
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.model.friction_cone import stick_limit
from fricmb.integrate.problem import LAW_SMOOTH, STICK

#: Part of its limit to which the force of a port that sticks has to be resolved within a step.
RESOLVED = 0.01
#: Round-off of positions, times stiffness, in forces.
OF_POSITIONS = 7e-15


@block
def unseen_force(mech: Mech, k: Moving, y: State, st: Stages, c: Control, h: float) -> float:
    """Error of the forces of ports that stick, in units of what is allowed.

    Not a matter of accuracy, but of seeing that a limit has been passed: transitions are located with steps of their
    own.  Where a step has no history, forces may jump at its start, and its first stage stands for that.
    """
    worst = 0.0
    for p in range(y.mode.shape[0]):
        if y.mode[p] != STICK or mech.port.law[p] == LAW_SMOOTH:
            continue
        load = y.N[p]
        for i in range(st.N.shape[0]):
            load = max(load, st.N[i, p])
        allowed = RESOLVED * stick_limit(mech.port, mech.port.laws, p, k.s, max(load, 0.0)) + 1e-290
        for a in range(mech.port.row[p], mech.port.row[p + 1]):
            start = y.F[a] if c.last_h > 0.0 else st.F[0, a]
            error = abs(by_line(st.tab.top[0], start, st.F, a))
            if error > allowed:
                unknown = asked(c) * force_that_tells(mech, k, y, st, c, p, a, h) + round_off(mech, c)
                worst = max(worst, error / (allowed + unknown))
    return float(worst)


@kernel
def force_that_tells(mech: Mech, k: Moving, y: State, st: Stages, c: Control, p: int, a: int, h: float) -> float:
    """Force of port p in row a that would bring what counts as 1 within a step h, were there no joints."""
    for i in range(c.q.shape[0]):
        c.inertia[i] = (c.mass[i] * st.scale[i]) ** 2
    push = np.sqrt(lightness(mech, k, p, a - mech.port.row[p], y.lam, c.inertia))
    return float(1.0 / max(h * push, 1e-290))


@kernel
def round_off(mech: Mech, c: Control) -> float:
    """What forces are not known to, by the round-off of positions."""
    linear, n, pull = mech.linear, c.q.shape[0], 0.0
    for e in range(linear.K.shape[0]):
        if linear.Ki[e] < n and linear.Kj[e] < n:
            pull = max(pull, abs(linear.K[e]) * c.q[linear.Kj[e]])
    return float(OF_POSITIONS * pull)
