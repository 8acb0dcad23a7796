"""How many stages the one-step formula has that gets to a tolerance fastest."""

from __future__ import annotations

import numpy as np

from fricmb.integrate.implicit.scene.structure import mechanism_of
from fricmb.integrate.problem import Input, Problem
from fricmb.integrate.suits_taylor import against_taylor, fastest

#: Stages where series make steps short, and values of series from which on that pays.
ON_SERIES, MANY_KINKS = 3, 100


def stages_for(problem: Problem, rtol: float, wanted: int | None = None) -> int:
    """Stages of the formula for a tolerance, where none are ``wanted``.

    Their nodes carry the dense output of BDF's steps, too, of degree up to 5.  Three would be faster by a quarter at
    1e-2, as fast at 1e-4, and err by up to 30 ``rtol`` where five err by 0.1.  Without joints, where factors are kept
    from step to step, seven pay earlier.
    """
    if wanted is not None:
        return wanted
    if follows_series(problem, rtol):
        return ON_SERIES
    return 5 if rtol > (1e-7 if mechanism_of(problem).n_rows else 1e-5) else 7


def follows_series(problem: Problem, rtol: float) -> bool:
    """Whether series of lines make steps so short that few stages reach a tolerance of the structure's motion.

    Between its nodes a step of h of ON_SERIES = s stages errs by some (w h)^(s + 1) of a motion of frequency w, and by
    nothing of loads that are lines.  More stages cost and bring nothing then.
    """
    kinks, inputs = problem.signals.kinks, problem.signals.inputs
    if kinks.size < MANY_KINKS or not all(_is_lines(given) for given in inputs):
        return False
    if len(problem.elements.table.address) or against_taylor(problem) is not None:
        return False
    return bool(fastest(problem) * np.median(np.diff(kinks)) < 0.5 * rtol ** (1.0 / (ON_SERIES + 1)))


def _is_lines(given: Input) -> bool:
    """Whether an input is a series, and nothing else, that is linear between its values."""
    alone = given.tape is not None and [operation[0] for operation in given.tape] == ["t", "series"]
    return alone and all(table.degree <= 1 for table in given.tables)
