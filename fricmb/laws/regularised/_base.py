"""Laws that replace the jump at zero velocity by a steep curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

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


@dataclass(frozen=True, kw_only=True)
class SaturatingLaw(RegularisedLaw):
    """Fields of the curves that rise over ``v_reg`` to ``mu`` and go on with ``viscous``."""

    positive: ClassVar[tuple[str, ...]] = ("v_reg",)

    mu: Any
    v_reg: Any
    viscous: Any = 0.0

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        self._number("mu", self.mu, minimum=0.0)
        self._number("viscous", self.viscous, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu=0.4, v_reg=1e-3)
