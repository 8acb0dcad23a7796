"""What happens on a branch of cycles."""

from __future__ import annotations

from dataclasses import dataclass

from fricmb.analysis.cycles._cycle import Cycle


@dataclass(frozen=True, kw_only=True)
class Special:
    """A point of a branch at which something changes.

    Attributes
    ----------
    value : float
        Of the parameter.
    cycle : Cycle
    residual : float
        Of the equations that define it, in units of the cycle's extent.
    """

    value: float
    cycle: Cycle
    residual: float

    def __str__(self) -> str:
        return f"{type(self).__name__} at {self.value:.12g}, period {self.cycle.period:.8g}"


class Fold(Special):
    """The branch turns round: a multiplier passes 1, or jumps past it where a stick begins or ends."""


class Flip(Special):
    """A multiplier passes -1: the period doubles."""


class NeimarkSacker(Special):
    """A pair of multipliers passes the unit circle: motion on a torus."""


class Grazing(Special):
    """A slip speed touches 0 where the contact then sticks for a finite time: the branch ends there.

    From the one side slip becomes so slow that it would stick, from the other so fast that it misses its stick.
    """


class StickAppears(Special):
    """A stick of length 0 begins to grow."""


class StickDisappears(Special):
    """A stick has the length 0."""
