"""Whether islands may take the same steps: where they cost about as many, and their forces are of one size."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricmb.integrate import Problem
from fricmb.integrate.problem import NORMAL_CONSTANT

#: How many times as many steps the islands may take together as apart, by their highest frequencies.  What is done once
#: for a step of all makes up for it: where that is 1.3 runs took 1/17 to 3/4 of the time, at 5 half, at 7.6 as long.
COST = 8.0
#: How many times as large friction may be in one as in another: the contacts of a step are solved to a part of the
#: largest.
FORCE = 10.0


def alike(problems: Sequence[Problem]) -> bool:
    """Whether islands with these arrays may take the same steps."""
    fastest = np.array([float(np.max(problem.omega, initial=0.0)) for problem in problems])
    if len(problems) * fastest.max() > COST * fastest.sum():
        return False
    forces = np.array([_friction(problem) for problem in problems])
    known = forces[forces > 0.0]
    return bool(known.size == 0 or known.max() <= FORCE * known.min())


def _friction(problem: Problem) -> float:
    """Largest friction under a constant normal force; 0 where there is none."""
    contacts = problem.contacts
    constant = contacts.normal == NORMAL_CONSTANT
    return float(np.max(np.abs(contacts.mu_s * contacts.N)[constant], initial=0.0))
