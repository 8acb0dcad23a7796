"""How many stages the one-step formula has that gets to a tolerance fastest."""

from __future__ import annotations

from fricmb.integrate.constrained.structure import mechanism_of
from fricmb.integrate.problem import Problem


def stages_for(problem: Problem, rtol: float, wanted: int | None = None) -> int:
    """Stages of the formula for a tolerance, where none are ``wanted``.

    Their nodes carry the dense output of BDF's steps, too, of degree up to 5.  Three would be faster by a quarter at
    1e-2, as fast at 1e-4, and err by up to 30 ``rtol`` where five err by 0.1.  Without joints, where factors are kept
    from step to step, seven pay earlier.
    """
    if wanted is not None:
        return wanted
    return 5 if rtol > (1e-7 if mechanism_of(problem).n_rows else 1e-5) else 7
