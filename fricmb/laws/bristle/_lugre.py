"""The LuGre model: bristles that bend before they slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class LuGre(FrictionLaw):
    """Bristles: F = -N (sigma0 z + sigma1 z' + sigma2 v) with z' = v - sigma0 |v| z/g(|v|).

    Here g(r) = mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent).
    Forces are per unit normal force.  In two directions z is a vector along the slip.  In steady sliding the
    coefficient is g(r) + sigma2 r.

    Parameters
    ----------
    sigma0 : float
        Bristle stiffness, > 0.
    sigma1, sigma2 : float
        Bristle damping and viscous coefficient, >= 0.
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 < mu_k <= mu_s.
    v_s, exponent : float
        Stribeck speed and exponent, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, A new model for control of systems with friction,
    IEEE Transactions on Automatic Control 40 (1995) 419-425.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("sigma0", "mu_s", "mu_k", "v_s", "exponent")

    sigma0: Any
    sigma1: Any
    sigma2: Any
    mu_s: Any
    mu_k: Any
    v_s: Any
    exponent: Any = 2.0

    def _steady(self, r: Any) -> Any:
        import sympy

        return self.mu_k + (self.mu_s - self.mu_k) * sympy.exp(-((r / self.v_s) ** self.exponent))

    def define_coefficient(self, r: Any) -> Any:
        """Steady sliding."""
        return self._steady(r) + self.sigma2 * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Bristle stiffness, bristle damping and viscous part."""
        rate = self.define_rate(v, N, z)
        return tuple(
            -N * (self.sigma0 * z_ + self.sigma1 * rate_ + self.sigma2 * v_)
            for v_, z_, rate_ in zip(v, z, rate, strict=True)
        )

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Bristles follow the slip and saturate."""
        from fricmb.laws._curves import norm

        r = norm(v)
        return tuple(v_ - self.sigma0 * r / self._steady(r) * z_ for v_, z_ in zip(v, z, strict=True))

    def validate(self) -> None:
        """Ranges of the fields that may be 0, and the order of the coefficients."""
        self._number("sigma1", self.sigma1, minimum=0.0)
        self._number("sigma2", self.sigma2, minimum=0.0)
        if self.mu_k > self.mu_s:
            self._refuse("mu_k", self.mu_k, f"<= mu_s = {self.mu_s:g}")

    @classmethod
    def example(cls) -> Self:
        """The values of the original paper, per unit of its normal force."""
        return cls(sigma0=1e5, sigma1=316.2, sigma2=0.4, mu_s=1.5, mu_k=1.0, v_s=1e-3)
