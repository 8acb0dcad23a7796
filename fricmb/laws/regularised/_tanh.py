"""A hyperbolic tangent in place of the jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb.laws.regularised._base import SaturatingLaw


@dataclass(frozen=True, kw_only=True)
class TanhRegularised(SaturatingLaw):
    """mu(r) = mu tanh(r/v_reg) + viscous r.

    Parameters
    ----------
    mu : float
        Coefficient of slip, >= 0.
    v_reg : float
        Speed at which 76 % of mu is reached, > 0.
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
        """Saturates exponentially."""
        import sympy

        return self.mu * sympy.tanh(r / self.v_reg) + self.viscous * r
