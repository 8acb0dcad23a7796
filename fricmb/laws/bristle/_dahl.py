"""Dahl's bristle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm


@dataclass(frozen=True, kw_only=True)
class Dahl(FrictionLaw):
    """F = -N sigma0 z with z' = v - sigma0 |v| z/mu: a bristle that bends and is torn off at mu.

    Dahl's exponent is 1 (brittle solids have other ones); the vector form keeps |z| <= mu/sigma0.

    Parameters
    ----------
    sigma0 : float
        Bristle stiffness per normal force, 1/length, > 0.
    mu : float
        Coefficient of slip, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P. R. Dahl, Solid friction damping of mechanical vibrations, AIAA Journal 14 (1976) 1675-1682.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("sigma0", "mu",)

    sigma0: Any
    mu: Any

    def define_coefficient(self, r: Any) -> Any:
        """Constant in steady sliding."""
        return self.mu

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The bristle's spring."""
        return tuple(-N * self.sigma0 * c for c in z)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Follows the slip and saturates."""
        pull = self.sigma0 * norm(v) / self.mu
        return tuple(v_ - pull * z_ for v_, z_ in zip(v, z, strict=True))

    @classmethod
    def example(cls) -> Self:
        """A ball bearing, per metre."""
        return cls(sigma0=1e4, mu=0.3)
