"""Laws that replace the jump at zero velocity by a steep curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm


@dataclass(frozen=True, kw_only=True)
class RegularisedLaw(FrictionLaw):
    """F = -N mu(r) v/r with mu(0) = 0, in any number of directions; a subclass states mu in ``define_coefficient``.

    Such a law never sticks: under any load it creeps.
    """

    #: Name of the field that says where the curve has risen.
    width: ClassVar[str] = "v_reg"

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Opposes the slip with the curve."""
        r = norm(v)
        push = N * self.define_coefficient(r) / r
        return tuple(-push * component for component in v)
