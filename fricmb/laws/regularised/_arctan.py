"""An arc tangent in place of the jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class ArctanRegularised(RegularisedLaw):
    """mu(r) = (2/pi) mu atan(r/v_reg) + viscous r.

    Parameters
    ----------
    mu : float
        Coefficient of slip, >= 0.
    v_reg : float
        Speed at which half of mu is reached, > 0.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    E. Pennestri, V. Rossi, P. Salvini, P. P. Valentini, Review and comparison of dry friction force models, Nonlinear
    Dynamics 83 (2016) 1785-1801.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_reg",)

    mu: Any
    v_reg: Any
    viscous: Any = 0.0

    def define_coefficient(self, r: Any) -> Any:
        """Saturates as the inverse of the speed."""
        import sympy

        return 2 * self.mu / sympy.pi * sympy.atan(r / self.v_reg) + self.viscous * r

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        self._number("mu", self.mu, minimum=0.0)
        self._number("viscous", self.viscous, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu=0.4, v_reg=1e-3)
