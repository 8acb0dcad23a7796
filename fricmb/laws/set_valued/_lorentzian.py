"""Friction that falls with slip speed along a Lorentzian."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order


@dataclass(frozen=True, kw_only=True)
class Lorentzian(FrictionLaw):
    """mu(r) = mu_k + (mu_s - mu_k)/(1 + (r/v_s)^2) + viscous r.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 <= mu_k <= mu_s.
    v_s : float
        Stribeck speed, > 0: half the fall is left there.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    D. P. Hess, A. Soom, Friction at a lubricated line contact operating at oscillating sliding velocities, Journal of
    Tribology 112 (1990) 147-152.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_s",)

    mu_s: Any
    mu_k: Any
    v_s: Any
    viscous: Any = 0.0

    def define_coefficient(self, r: Any) -> Any:
        """A Lorentzian over the slip speed, and the viscous part."""
        return self.mu_k + (self.mu_s - self.mu_k) / (1 + (r / self.v_s) ** 2) + self.viscous * r

    def validate(self) -> None:
        """Ranges, and the order of the coefficients."""
        check_order(self)
        self._number("viscous", self.viscous, minimum=0.0)

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """A lubricated line contact, in metres and seconds."""
        return cls(mu_s=0.2, mu_k=0.08, v_s=0.05, viscous=0.02)
