"""Jenkins' element: a spring and a slider in series."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import yielding


@dataclass(frozen=True, kw_only=True)
class Jenkins(FrictionLaw):
    """F = -N stiffness z: a spring in series with a slider that yields at mu; in two directions on a circle.

    The switch between elastic and yielding is not an event: within the share ``corner`` below the limit the rate of z
    goes over into yielding with a continuous slope (see ``laws._curves.yielding``), which an implicit integrator steps
    through.  ``corner`` -> 0 is the sharp element.

    Parameters
    ----------
    stiffness : float
        Per normal force, 1/length, > 0.
    mu : float
        Coefficient of slip, > 0.
    corner : float
        Relative width of the rounded corner, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    G. M. Jenkins, Analysis of the stress-strain relationships in reactor grade graphite, British Journal of Applied
    Physics 13 (1962) 30-32.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("stiffness", "mu", "corner",)

    stiffness: Any
    mu: Any
    corner: Any = 1e-2

    def define_coefficient(self, r: Any) -> Any:
        """Constant in steady sliding."""
        return self.mu

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The spring."""
        return tuple(-N * self.stiffness * c for c in z)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Elastic, and yielding at the limit."""
        return yielding(z, v, self.mu / self.stiffness, self.corner)

    @classmethod
    def example(cls) -> Self:
        """An under-platform damper, per metre."""
        return cls(stiffness=1e4, mu=0.3)
