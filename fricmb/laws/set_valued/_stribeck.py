"""Stribeck's curve: friction that falls from mu_s to mu_k with slip speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Stribeck(FrictionLaw):
    """mu(r) = mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent) + viscous r.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 <= mu_k <= mu_s.
    v_s : float
        Stribeck speed, > 0.
    exponent : float
        > 0; 2 is the Gaussian form, 1 the exponential one.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    L. C. Bo, D. Pavelescu, The friction-speed relation and its influence on the critical velocity of stick-slip motion,
    Wear 82 (1982) 277-289 (the exponential curve with an exponent).
    """

    positive: ClassVar[tuple[str, ...]] = ("v_s", "exponent")

    mu_s: Any
    mu_k: Any
    v_s: Any
    exponent: Any = 2.0
    viscous: Any = 0.0

    def define_coefficient(self, r: Any) -> Any:
        """Falls with slip speed, then rises with the viscous part."""
        import sympy

        return self.mu_k + (self.mu_s - self.mu_k) * sympy.exp(-((r / self.v_s) ** self.exponent)) + self.viscous * r

    def validate(self) -> None:
        """Ranges of the fields that may be 0, and the order of the coefficients."""
        self._number("mu_s", self.mu_s, minimum=0.0)
        self._number("mu_k", self.mu_k, minimum=0.0)
        self._number("viscous", self.viscous, minimum=0.0)
        if self.mu_k > self.mu_s:
            self._refuse("mu_k", self.mu_k, f"<= mu_s = {self.mu_s:g}")

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """A brake lining, in metres and seconds."""
        return cls(mu_s=0.6, mu_k=0.4, v_s=0.1)
