"""Slip speeds at which a coefficient of friction bends or goes over to another formula: steps end there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb.equations import Template
from fricmb.system._breakpoints import Switch, places_of

#: Speeds among which switches are looked for that cannot be computed, in powers of ten, and how many to a power.
_POWERS, _EACH = (-9, 7), 16
#: A law with more of them than this (one that counts in steps) is no curve with bends.
_MOST = 10_000


def knots_of(law: Any, template: Template, p: Sequence[float], N: float | None) -> tuple[float, ...]:
    """Those that the law states (``knots``) and those at which its formula switches, rising, above 0.

    ``N``: the normal force, on which they may depend; None where it varies, and these are left out.
    """
    stated, by_load = law.numeric().knots(), [] if N is None else template.instants_by_load
    if not (stated or template.instants or by_load):
        return ()
    own = tuple(p)
    known, searched = places_of([(template.instants, own), (by_load, (*own, N or 0.0))])
    found = {*map(float, stated), *known.tolist(), *(r for s in searched for r in _roots(s))}
    above = sorted(r for r in found if 0.0 < r < np.inf)
    return tuple(above) if len(above) <= _MOST else ()


def _roots(switch: Switch) -> list[float]:
    """Where a function of slip speed changes its sign."""
    grid = np.logspace(*_POWERS, (_POWERS[1] - _POWERS[0]) * _EACH + 1)
    return [switch.root(low, high) for low, high in switch.brackets(grid)]
