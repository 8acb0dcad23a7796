"""An arc tangent in place of the jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb.laws.regularised._base import SaturatingLaw


@dataclass(frozen=True, kw_only=True)
class ArctanRegularised(SaturatingLaw):
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

    def define_coefficient(self, r: Any) -> Any:
        """Saturates as the inverse of the speed."""
        import sympy

        return 2 * self.mu / sympy.pi * sympy.atan(r / self.v_reg) + self.viscous * r
