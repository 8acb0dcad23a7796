"""States at many times within stretches of stick of a structure of many modes: products of matrices, all at once."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.collocation.one_contact.held import answers
from fricmb.integrate.collocation.one_contact.room import AT_BLOCKS, AT_LOW, AT_TIME, Run
from fricmb.integrate.problem import Floats, Ints


def held_states(run: Run, hold: Floats, load: Floats, row: Ints, tau: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Times, q, v (n, n_t) and F (m, n_t) at ``tau`` after the start of rows in which the contact sticks.

    What ``sample_rows`` finds one by one; ``hold``, ``load``: see there.
    """
    n, b = run.w2.shape[1], run.stuck_blocks
    w2, d = np.ascontiguousarray(run.w2[1, :b]), np.ascontiguousarray(run.damp[1, :b])
    steps, phase = run.steps[row], run.phases[run.kinds[row, 1]]
    times = steps[:, AT_TIME] + tau
    since = (steps[:, AT_TIME] - phase[:, 2 * n]) + (steps[:, AT_LOW] - phase[:, 2 * n + 1]) + tau
    u, v, a = (steps[:, AT_BLOCKS + i * n : AT_BLOCKS + i * n + b] for i in range(3))
    slope, e0, e1 = (phase[:, i * n + 2 : i * n + 2 + b] for i in (2, 3, 4))
    found = np.empty((len(tau), 3, b))
    answers(w2, d, np.ascontiguousarray(tau), found)
    S, IS, IIS = found[:, 0], found[:, 1], found[:, 2]
    k = slope - w2 * v
    moved = (u + v * tau[:, None] + a * IS + k * IIS).T
    speed = (v + a * S + k * IS - e0 - e1 * since[:, None]).T
    carried = run.stuck_v[:, None]
    q = run.q_u[1, :, :b] @ moved + carried * since
    speeds = run.v_v[1, :, :b] @ speed + carried
    if run.modal[1] == 0:
        q += run.q_v[1, :, :b] @ speed
        speeds += run.v_u[1, :, :b] @ moved
    q += (phase[:, :n] + phase[:, n : 2 * n]).T
    F = hold[0] @ q + hold[1] @ speeds - load[0][:, None] - load[1][:, None] * times
    return times, q, speeds, F
