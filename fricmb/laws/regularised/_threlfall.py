"""Threlfall's exponential rise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class Threlfall(RegularisedLaw):
    """mu(r) = mu (1 - exp(-3 r/v_reg)) up to v_reg, constant beyond (0.95 mu).

    Parameters
    ----------
    mu : float
        Coefficient that the exponential tends to, >= 0.
    v_reg : float
        Speed at which the rise ends, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    D. C. Threlfall, The inclusion of Coulomb friction in mechanisms programs with particular reference to DRAM,
    Mechanism and Machine Theory 13 (1978) 475-483.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_reg",)

    mu: Any
    v_reg: Any

    def define_coefficient(self, r: Any) -> Any:
        """Exponential up to v_reg."""
        import sympy

        return self.mu * (1 - sympy.exp(-3 * sympy.Min(1, r / self.v_reg)))

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        self._number("mu", self.mu, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu=0.4, v_reg=1e-3)
