"""Reactions and friction that load one another, sought from what they are without friction, by a growing share of it.

Of one port whose load N(F) is convex in its force, the solution that goes on from the one without friction is the least
one; where it ends, at a share below 1, there is none for more friction: the line N = F/(share mu) has left the curve.
"""

from __future__ import annotations

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.implicit.equations.accelerations import react
from fricmb.integrate.implicit.equations.slip_rows import SETTING_OUT
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech
from fricmb.integrate.implicit.scene.state import Instant, State

#: Shares are followed so closely to where they end, by so many tries at most.
CLOSE, TRIES = 1e-3, 60


@kernel
def react_by_shares(mech: Mech, k: Moving, w: Instant, y: State) -> float:
    """As ``react``, from no friction on; the share of friction that there is a solution for, which y is left with.

    Ports that set out have a way of their own from the forces that held them (``mode_trial.ease``): 0 for these.
    """
    for c in range(y.mode.shape[0]):
        if y.mode[c] == SETTING_OUT:
            return 0.0
    for part in (y.a, y.lam, y.F):
        part[:] = 0.0
    k.share = 0.0
    reached, step = 0.0, 0.25
    if react(mech, k, w, y, False):
        for _ in range(TRIES):
            if reached == 1.0 or step < CLOSE:
                break
            accelerations, reactions, forces = y.a.copy(), y.lam.copy(), y.F.copy()
            k.share = min(reached + step, 1.0)
            if react(mech, k, w, y, False):
                reached = k.share
                continue
            y.a[:], y.lam[:], y.F[:] = accelerations, reactions, forces
            step *= 0.5
    k.share = 1.0
    return float(reached)
