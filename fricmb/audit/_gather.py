"""Residuals of one kind gathered into a check: the largest, where it is, whose it is."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.audit._result import Check

#: A check passes up to so many times what the tolerance allows.
LIMIT = 30.0
#: Of some kinds more: stiff law states are controlled by the force that they make, and losses by the ledger's own rule
#: (100 rtol); neither error is carried on.
LIMITS = {"states of laws": 300.0, "friction losses": 300.0, "friction losses, between steps": 300.0}


class Gathered:
    """Largest residual of each kind."""

    def __init__(self) -> None:
        self._worst: dict[str, tuple[float, float, str]] = {}
        self._count: dict[str, int] = {}

    def add(self, name: str, ratio: Any, t: Any, part: str) -> None:
        """Residuals over units (n_t,) at times t of one part; what is no number is the worst there is."""
        ratio = np.asarray(ratio, dtype=float)
        self._count[name] = self._count.get(name, 0) + ratio.size
        if not ratio.size:
            return
        size = np.where(np.isfinite(ratio), ratio, np.inf)
        i = int(np.argmax(size))
        held = self._worst.get(name)
        if held is None or size[i] > held[0]:
            self._worst[name] = (float(size[i]), float(np.broadcast_to(t, ratio.shape)[i]), part)

    def checks(self) -> tuple[Check, ...]:
        """One of each kind, the worst first."""
        found = [
            Check(name=name, size=size, limit=LIMITS.get(name, LIMIT), t=t, part=part, count=self._count[name])
            for name, (size, t, part) in self._worst.items()
        ]
        return tuple(sorted(found, key=lambda check: -check.size / check.limit))
