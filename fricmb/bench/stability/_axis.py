"""Measured stability: what an integrator does to lightly damped vibration that its steps do not resolve.

A structure of modes at many frequencies of which only the slowest is driven hard; the others start at 1e-8 of it.  They
are undamped: what they have gained at the end is the integrator's doing.  Sliding, so that the step is chosen by the
slow motion; and stuck, where the exact or implicit transfer of the stuck structure is at work.
"""

from __future__ import annotations

from typing import Any

import numpy as np

import fricmb as fm
from fricmb.bench._cell import one_line
from fricmb.errors import FricmbError

#: Frequencies beside the slow one (1), and their amplitude at the start over the slow one's.
FAST = (3.0, 10.0, 30.0, 100.0, 300.0, 1000.0)
SMALL = 1e-8
#: Stiffness of the springs that tie all together: enough for one structure, too little to move a fast one by SMALL.
TIE = 1e-9
#: By default each signal is resolved however small it is; here errors below ATOL never matter.
T_END, RTOL, ATOL = 200.0, 1e-5, 1e-5


def modes(stuck: bool) -> fm.Scene:
    """Masses on springs of their own, tied to nothing; a contact acts on the slow one, or holds a further one."""
    bodies = [fm.Body("slow", mass=1.0, position={"x": 1.0})]
    bodies += [fm.Body(f"fast{i}", mass=1.0, position={"x": SMALL}) for i in range(len(FAST))]
    springs = [fm.Spring("s", bodies[0], axis="x", stiffness=1.0)]
    springs += [
        fm.Spring(f"s{i}", body, axis="x", stiffness=w * w)
        for i, (body, w) in enumerate(zip(bodies[1:], FAST, strict=True))
    ]
    rub = fm.laws.Coulomb(mu_s=1.0)
    if stuck:
        # held by friction, and tied to all: what is stuck is part of the structure
        anchor = fm.Body("anchor", mass=1.0)
        ties = [fm.Spring(f"t{i}", body, anchor, axis="x", stiffness=TIE) for i, body in enumerate(bodies)]
        parts = [*bodies, anchor, *springs, *ties, fm.Contact("sole", anchor, law=rub, normal_force=10.0)]
        return fm.Scene("stuck modes", parts)
    belt = fm.Driven("belt", velocity={"x": 10.0})
    ties = [fm.Spring(f"t{i}", body, bodies[0], axis="x", stiffness=TIE) for i, body in enumerate(bodies[1:])]
    sole = fm.Contact("sole", bodies[0], belt, law=rub, normal_force=0.1)
    return fm.Scene("sliding modes", [*bodies, belt, *springs, *ties, sole])


def measure_axis(method: str, stuck: bool) -> dict[str, Any]:
    """Energy beyond the first instant: its largest growth over the run relative to the whole, the counters."""
    state = "stuck" if stuck else "sliding"
    found: dict[str, Any] = {"method": method, "state": state}
    try:
        grid = np.linspace(0.0, T_END, 2001)
        sol = fm.simulate(modes(stuck), t_end=T_END, rtol=RTOL, atol=ATOL, method=method, t_eval=grid)
    except FricmbError as error:
        return found | {"failure": one_line(error)}
    amplitude = {w: float(np.abs(sol[f"fast{i}.x"][-200:]).max()) for i, w in enumerate(FAST)}
    residual = float(np.abs(sol.energy.residual).max())
    return found | {"used": sol.stats.method, "steps": sol.stats.n_steps, "amplitude": amplitude, "energy": residual}
