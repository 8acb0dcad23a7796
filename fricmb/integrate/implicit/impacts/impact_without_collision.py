"""Impacts without collision: where no forces fit a contact that slips, an impulse stops its slip at once.

A contact that slips and is held has no normal velocity, so that no impulse satisfies the law of impact as well.  Where
the reaction would grow with the friction that it causes faster than friction sheds it (Painleve), there is another
solution beside that one: the contact is pressed by its own friction until the slip is over (F. Genot and B. Brogliato,
New results on Painleve paradoxes, European Journal of Mechanics A 18 (1999) 653).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricmb.integrate.implicit.impacts.impact_law import Answer, Hit, combinations, solve_impact, tried

#: Part of the coefficient of friction by which the edge of the region may be missed: runs end there just before it.
EDGE = 1e-6
#: Impulse that is none, beside what would stop the fastest slip.
NONE = 1e-9


def solve_without_collision(hit: Hit, *, poisson: bool) -> Answer | None:
    """The impulses that are not 0; None where there are none.  By Poisson's law contacts give back a part of them."""
    still = replace(hit, e=np.zeros_like(hit.e), e_t=np.zeros_like(hit.e_t))
    found = _pressed(still) or _pressed(replace(still, mu=hit.mu * (1.0 + EDGE)))
    if found is None or not poisson:
        return found
    rate = found.rate.copy()
    rate[hit.normal] = np.maximum(rate[hit.normal], 0.0)
    given = hit.e * found.impulse[hit.normal]
    second = solve_impact(replace(still, rate=rate, given=given))
    if second is None:
        return None
    return Answer(impulse=found.impulse + second.impulse, rate=second.rate, others=found.others or second.others)


def _pressed(hit: Hit) -> Answer | None:
    """The first combination that presses."""
    size = float(np.abs(hit.rate).max(initial=0.0))
    least = NONE * size / float(np.diag(hit.D).max(initial=1e-300))
    for doing in combinations(hit):
        answer = tried(hit, doing, size)
        if answer is not None and float(answer.impulse[hit.normal].max(initial=0.0)) > least:
            return answer
    return None
