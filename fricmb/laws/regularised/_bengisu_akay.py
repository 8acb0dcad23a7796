"""Bengisu and Akay's curve: a parabola up to break-away, then an exponential fall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._curves import check_order
from fricmb.laws.regularised._base import RegularisedLaw


@dataclass(frozen=True, kw_only=True)
class BengisuAkay(RegularisedLaw):
    """mu(r) = mu_s (1 - (1 - r/v_reg)^2) up to v_reg; beyond, mu_k + (mu_s - mu_k) exp(-decay (r - v_reg)).

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients of break-away and of fast slip, 0 <= mu_k <= mu_s.
    v_reg : float
        Speed of break-away, > 0.
    decay : float
        Rate of the fall per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    M. T. Bengisu, A. Akay, Stability of friction-induced vibrations in multi-degree-of-freedom systems, Journal of
    Sound and Vibration 171 (1994) 557-570.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_reg",)

    mu_s: Any
    mu_k: Any
    v_reg: Any
    decay: Any

    def define_coefficient(self, r: Any) -> Any:
        """Parabola, then exponential."""
        import sympy

        rise = self.mu_s * (1 - (1 - r / self.v_reg) ** 2)
        # no growing exponential where the other branch counts
        fall = self.mu_k + (self.mu_s - self.mu_k) * sympy.exp(-self.decay * sympy.Max(0, r - self.v_reg))
        return sympy.Piecewise((rise, r < self.v_reg), (fall, True))

    def validate(self) -> None:
        """Ranges of the fields that may be 0."""
        check_order(self)
        self._number("decay", self.decay, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """Dry steel, in metres and seconds."""
        return cls(mu_s=0.6, mu_k=0.4, v_reg=1e-3, decay=50.0)
