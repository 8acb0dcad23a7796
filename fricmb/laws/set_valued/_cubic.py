"""Friction that falls to a minimum and rises again, as a cubic of slip speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Cubic(FrictionLaw):
    """mu(r) = mu_s - (3/2)(mu_s - mu_m)(r/v_m - (1/3)(r/v_m)^3).

    The minimum mu_m is reached at v_m; mu_s is reached again at sqrt(3) v_m, and beyond friction rises with the cube of
    the speed.

    Parameters
    ----------
    mu_s : float
        Coefficient at rest, >= mu_m.
    mu_m : float
        Least coefficient, >= 0.
    v_m : float
        Slip speed of the least coefficient, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. J. Thomsen, A. Fidlin, Analytical approximations for stick-slip vibration amplitudes, International Journal of
    Non-Linear Mechanics 38 (2003) 389-403, section 2.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_m",)

    mu_s: Any
    mu_m: Any
    v_m: Any

    def define_coefficient(self, r: Any) -> Any:
        """Cubic of the slip speed."""
        x = r / self.v_m
        return self.mu_s - (self.mu_s - self.mu_m) * (3 * x - x**3) / 2

    def validate(self) -> None:
        """0 <= mu_m <= mu_s."""
        self._number("mu_m", self.mu_m, minimum=0.0)
        if self.mu_m > self.mu_s:
            self._refuse("mu_m", self.mu_m, f"<= mu_s = {self.mu_s:g}")

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """The values of the paper's figures, dimensionless."""
        return cls(mu_s=0.4, mu_m=0.25, v_m=0.5)
