"""Bouc and Wen: a smooth hysteresis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import along, norm


@dataclass(frozen=True, kw_only=True)
class BoucWen(FrictionLaw):
    """F = -N mu z with z' = (stiffness/mu)(v - |z|^(n-2) z (beta abs(z.v) + (1 - beta) z.v)).

    n = ``exponent``; z saturates at |z| = 1, it says how sharply.
    In two directions the isotropic form of Park, Wen and Ang.

    Parameters
    ----------
    mu : float
        Coefficient of slip, > 0.
    stiffness : float
        Per normal force at z = 0, 1/length, > 0.
    exponent : float
        >= 1.
    beta : float
        0.5 <= beta <= 1: unloading is elastic at 0.5 (the thermodynamically admissible range).

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    Y.-K. Wen, Method for random vibration of hysteretic systems, Journal of the Engineering Mechanics Division 102
    (1976) 249-263; Y. J. Park, Y. K. Wen, A. H.-S. Ang, Random vibration of hysteretic systems under
    bi-directional ground motions, Earthquake Engineering and Structural Dynamics 14 (1986) 543-557.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("mu", "stiffness", "exponent", "beta",)

    mu: Any
    stiffness: Any
    exponent: Any = 2.0
    beta: Any = 0.5

    def define_coefficient(self, r: Any) -> Any:
        """Constant in steady sliding."""
        return self.mu

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The hysteretic force."""
        return tuple(-N * self.mu * c for c in z)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Smooth saturation."""
        import sympy

        power = along(z, v)
        pull = norm(z) ** (self.exponent - 2) * (self.beta * sympy.Abs(power) + (1 - self.beta) * power)
        return tuple(self.stiffness / self.mu * (v_ - pull * z_) for v_, z_ in zip(v, z, strict=True))

    def validate(self) -> None:
        """Ranges."""
        self._number("exponent", self.exponent, minimum=1.0)
        if not 0.5 <= self.beta <= 1.0:
            self._refuse("beta", self.beta, "between 0.5 and 1")

    @classmethod
    def example(cls) -> Self:
        """A wire-rope isolator, per metre."""
        return cls(mu=0.3, stiffness=1e3)
