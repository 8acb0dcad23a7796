"""Coulomb's law with a viscous part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order


@dataclass(frozen=True, kw_only=True)
class CoulombViscous(FrictionLaw):
    """mu(r) = mu_k + viscous r.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients of static and of kinetic friction, 0 <= mu_k <= mu_s.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and compensation methods
    for the control of machines with friction, Automatica 30 (1994) 1083-1138, section 2.
    """

    mu_s: Any
    mu_k: Any
    viscous: Any

    def define_coefficient(self, r: Any) -> Any:
        """Rises with slip speed."""
        return self.mu_k + self.viscous * r

    def validate(self) -> None:
        """Ranges, and the order of the coefficients."""
        check_order(self)
        self._number("viscous", self.viscous, minimum=0.0)

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_k."""
        return float(self.numeric_slots()["mu_k"])

    @classmethod
    def example(cls) -> Self:
        """A lubricated slide, in metres and seconds."""
        return cls(mu_s=0.15, mu_k=0.1, viscous=0.05)
