"""A ramp in place of the jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb.laws.regularised._base import SaturatingLaw


@dataclass(frozen=True, kw_only=True)
class LinearRegularised(SaturatingLaw):
    """mu(r) = mu min(r/v_reg, 1) + viscous r.

    Parameters
    ----------
    mu : float
        Coefficient of slip, >= 0.
    v_reg : float
        Speed at which the ramp ends, > 0.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    F. Marques, P. Flores, J. C. Pimenta Claro, H. M. Lankarani, A survey and comparison of several friction force
    models for dynamic analysis of multibody mechanical systems, Nonlinear Dynamics 86 (2016) 1407-1443.
    """

    def define_coefficient(self, r: Any) -> Any:
        """A ramp, then constant."""
        import sympy

        return self.mu * sympy.Min(1, r / self.v_reg) + self.viscous * r
