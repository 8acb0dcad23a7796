"""Slip speeds at which a coefficient of friction bends or goes over to another formula: steps end there."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from fricmb.equations import Template
from fricmb.system._breakpoints import Switch, switches_of

#: Speeds among which switches are looked for that cannot be computed, in powers of ten, and how many to a power.
_POWERS, _EACH = (-9, 7), 16
#: A law with more of them than this (one that counts in steps) is no curve with bends.
_MOST = 10_000


def knots_of(law: Any, template: Template, p: Sequence[float]) -> tuple[float, ...]:
    """Those that the law states (``knots``) and those at which its formula switches, rising, above 0."""
    stated = law.numeric().knots()
    if not (stated or template.instants):
        return ()
    known, searched = switches_of([(template, tuple(p))])
    found = {*map(float, stated), *known.tolist(), *(r for s in searched for r in _roots(s))}
    above = sorted(r for r in found if 0.0 < r < np.inf)
    return tuple(above) if len(above) <= _MOST else ()


def _roots(switch: Switch) -> list[float]:
    """Where a function of slip speed changes its sign."""
    grid = np.logspace(*_POWERS, (_POWERS[1] - _POWERS[0]) * _EACH + 1)
    return [switch.root(low, high) for low, high in switch.brackets(grid)]
