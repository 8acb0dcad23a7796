"""A root in place of the jump."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb.laws.regularised._base import SaturatingLaw


@dataclass(frozen=True, kw_only=True)
class SquareRootRegularised(SaturatingLaw):
    """mu(r) = mu r/sqrt(r^2 + v_reg^2) + viscous r.

    Parameters
    ----------
    mu : float
        Coefficient of slip, >= 0.
    v_reg : float
        Speed at which 71 % of mu is reached, > 0.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P. Vigue, C. Vergez, S. Karkar, B. Cochelin, Regularized friction and continuation: comparison with Coulomb's law,
    Journal of Sound and Vibration 389 (2017) 350-363.
    """

    def define_coefficient(self, r: Any) -> Any:
        """Smooth, also in two directions: the length of (v, v_reg) in place of that of v."""
        import sympy

        return self.mu * r / sympy.sqrt(r**2 + self.v_reg**2) + self.viscous * r
