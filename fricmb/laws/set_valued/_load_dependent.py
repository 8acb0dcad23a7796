"""Friction whose coefficient depends on the normal force."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class LoadDependent(FrictionLaw):
    """mu(N) = mu_0 (1 + N/N_0)^(-exponent): an elastic contact, whose true area grows less than its load.

    Far above N_0 the friction force grows as N^(1 - exponent): 1/3 for a sphere on a plane (Hertz), where shear
    strength times contact area is friction.  Below N_0 the coefficient is mu_0.

    Parameters
    ----------
    mu_0 : float
        Coefficient of a light load, >= 0.
    N_0 : float
        Load at which the fall sets in, > 0.
    exponent : float
        0 <= exponent < 1.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. F. Archard, Elastic deformation and the laws of friction, Proceedings of the Royal Society A 243 (1957) 190-205.
    """

    positive: ClassVar[tuple[str, ...]] = ("N_0",)

    mu_0: Any
    N_0: Any
    exponent: Any = 1.0 / 3.0

    def define_coefficient(self, r: Any, N: Any) -> Any:  # type: ignore[override]
        """Falls with the load."""
        return self.mu_0 * (1 + N / self.N_0) ** (-self.exponent)

    def validate(self) -> None:
        """Ranges."""
        self._number("mu_0", self.mu_0, minimum=0.0)
        self._number("exponent", self.exponent, minimum=0.0)
        if self.exponent >= 1.0:
            self._refuse("exponent", self.exponent, "< 1")

    @classmethod
    def example(cls) -> Self:
        """Rubber on glass, in newtons."""
        return cls(mu_0=1.2, N_0=5.0)
