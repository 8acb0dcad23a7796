"""Ambrosio's dead zone and ramp."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class Ambrosio(RegularisedLaw):
    """mu(r) = mu times 0 up to v_0, a ramp from v_0 to v_1, 1 beyond.

    Parameters
    ----------
    mu : float
        Coefficient of slip, >= 0.
    v_0, v_1 : float
        Speeds between which friction rises, 0 <= v_0 < v_1.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. A. C. Ambrosio, Impact of rigid and flexible multibody systems: deformation description and contact models, in
    Virtual Nonlinear Multibody Systems (NATO Science Series 103, 2003) 57-81.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_1",)
    width: ClassVar[str] = "v_1"

    mu: Any
    v_0: Any
    v_1: Any

    def define_coefficient(self, r: Any) -> Any:
        """A ramp between two speeds."""
        import sympy

        return self.mu * sympy.Max(0, sympy.Min(1, (r - self.v_0) / (self.v_1 - self.v_0)))

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        self._number("mu", self.mu, minimum=0.0)
        self._number("v_0", self.v_0, minimum=0.0)
        if self.v_0 >= self.v_1:
            self._refuse("v_0", self.v_0, f"< v_1 = {self.v_1:g}")

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu=0.4, v_0=1e-4, v_1=1e-3)
