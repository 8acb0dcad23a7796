"""Brown and McPhee's curve: one formula, with a peak at the transition speed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._curves import check_order
from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class BrownMcPhee(RegularisedLaw):
    """mu(r) = mu_k tanh(4 x) + (mu_s - mu_k) x/(x^2/4 + 3/4)^2 + viscous r with x = r/v_t.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients of break-away and of fast slip, 0 <= mu_k <= mu_s.
    v_t : float
        Transition speed, where friction is mu_s (but for tanh 4 = 0.9993), > 0.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P. Brown, J. McPhee, A continuous velocity-based friction model for dynamics and control with physically meaningful
    parameters, Journal of Computational and Nonlinear Dynamics 11 (2016) 054502 (its viscous part is per unit normal
    force here).
    """

    positive: ClassVar[tuple[str, ...]] = ("v_t",)
    width: ClassVar[str] = "v_t"

    mu_s: Any
    mu_k: Any
    v_t: Any
    viscous: Any = 0.0

    def define_coefficient(self, r: Any) -> Any:
        """A tangent that saturates, and a hump."""
        import sympy

        x = r / self.v_t
        hump = (self.mu_s - self.mu_k) * x / (x**2 / 4 + sympy.Rational(3, 4)) ** 2
        return self.mu_k * sympy.tanh(4 * x) + hump + self.viscous * r

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        check_order(self)
        self._number("viscous", self.viscous, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu_s=0.6, mu_k=0.4, v_t=1e-3)
