"""Friction that falls with the logarithm of slip speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Logarithmic(FrictionLaw):
    """mu(r) = mu_s/(1 + slope log(1 + r/v_0)).

    For small slope mu(r) = mu_s (1 - slope log(1 + r/v_0)), the steady state of a rate-weakening contact; the quotient
    stays positive at any speed.

    Parameters
    ----------
    mu_s : float
        Coefficient at rest, >= 0.
    slope : float
        Relative fall per e-fold of speed, >= 0.
    v_0 : float
        Slip speed at which the fall sets in, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. H. Dieterich, Modeling of rock friction 1, Journal of Geophysical Research 84 (1979) 2161-2168, equation 9:
    a coefficient that is a quotient of logarithms.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_0",)

    mu_s: Any
    slope: Any
    v_0: Any

    def define_coefficient(self, r: Any) -> Any:
        """Falls with the logarithm of the slip speed."""
        import sympy

        return self.mu_s / (1 + self.slope * sympy.log(1 + r / self.v_0))

    def validate(self) -> None:
        """Ranges."""
        self._number("mu_s", self.mu_s, minimum=0.0)
        self._number("slope", self.slope, minimum=0.0)

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """mu_s: there is no jump at r = 0."""
        return float(self.numeric_slots()["mu_s"])

    @classmethod
    def example(cls) -> Self:
        """Rock, in metres and seconds."""
        return cls(mu_s=0.6, slope=0.02, v_0=1e-6)
