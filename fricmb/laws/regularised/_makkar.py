"""Makkar's smooth curve of three tangents."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class Makkar(RegularisedLaw):
    """mu(r) = g1 (tanh(g2 r) - tanh(g3 r)) + g4 tanh(g5 r) + g6 r.

    Parameters
    ----------
    g1 : float
        Height of the Stribeck part, >= 0: break-away is about g1 + g4.
    g2, g3 : float
        Per speed, 0 < g3 <= g2: rise, and end of the Stribeck part.
    g4, g5 : float
        Coulomb part, >= 0, and its rise per speed, > 0.
    g6 : float
        Viscous part per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    C. Makkar, W. E. Dixon, W. G. Sawyer, G. Hu, A new continuously differentiable friction model for control systems
    design, Proceedings IEEE/ASME International Conference on Advanced Intelligent Mechatronics (2005) 600-605,
    equation 1.
    """

    positive: ClassVar[tuple[str, ...]] = ("g2", "g3", "g5",)
    width: ClassVar[str] = "g2"

    g1: Any
    g2: Any
    g3: Any
    g4: Any
    g5: Any
    g6: Any = 0.0

    def define_coefficient(self, r: Any) -> Any:
        """Three tangents and a line."""
        import sympy

        stribeck = sympy.tanh(self.g2 * r) - sympy.tanh(self.g3 * r)
        return self.g1 * stribeck + self.g4 * sympy.tanh(self.g5 * r) + self.g6 * r

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        for name in ("g1", "g4", "g6"):
            self._number(name, getattr(self, name), minimum=0.0)
        if self.g3 > self.g2:
            self._refuse("g3", self.g3, f"<= g2 = {self.g2:g}")

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(g1=0.25, g2=100.0, g3=10.0, g4=0.4, g5=100.0, g6=0.01)
