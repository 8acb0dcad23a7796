"""Jumps of velocities where a prescribed speed jumps: what is said of them after a run."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.problem import NORMAL_REACTION, Floats2, Floats3, Problem

#: Part of the largest velocity that is no jump.
ROUND_OFF = 1e-9


def impulse_notes(problem: Problem, span: Floats2, values: Floats3) -> tuple[str, ...]:
    """A note where velocities jump beside joints that rub: of reactions without end, friction would have its part.

    ``span``, ``values``: of the steps of a run, as they are recorded.
    """
    if not (problem.contacts.normal == NORMAL_REACTION).any() or not problem.signals.breakpoints.size:
        return ()
    n = problem.n
    before, behind = values[:-1, -1, n : 2 * n], values[1:, 0, n : 2 * n]
    size = float(np.abs(values[:, 0, n : 2 * n]).max(initial=0.0))
    times = span[1:, 0][(np.abs(behind - before) > ROUND_OFF * size).any(axis=1)]
    if not times.size:
        return ()
    more = f" and {times.size - 1} more times" if times.size > 1 else ""
    return (
        f"velocities jump at t = {times[0]:.6g}{more}, as a prescribed speed does: in that instant joints bear an"
        " impulse, and the friction that belongs to it is left out",
    )
