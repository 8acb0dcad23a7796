"""Bliman and Sorine: two bristles in series with the distance slipped."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import chunks, norm


@dataclass(frozen=True, kw_only=True)
class BlimanSorine(FrictionLaw):
    """F = -N (x + y) with x' = |v| (f1 v/|v| - x)/(eta distance), y' = -|v| (f2 v/|v| + y)/distance.

    Rate-independent: the states are filters of the direction of slip over the distance.  f1 rises fast, f2 takes a part
    back: a peak of break-away, then f1 - f2 in slip.

    Parameters
    ----------
    f1, f2 : float
        Coefficients, 0 <= f2 < f1; f1 - f2 is the coefficient of slip.
    distance : float
        Distance over which friction settles, > 0.
    eta : float
        The fast part's distance is eta times that, 0 < eta < 1.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P.-A. Bliman, M. Sorine, Easy-to-use realistic dry friction models for automatic control, Proceedings 3rd European
    Control Conference (1995) 3788-3794.
    """

    states: ClassVar[tuple[str, ...]] = ("x", "y")
    positive: ClassVar[tuple[str, ...]] = ("f1", "distance", "eta",)

    f1: Any
    f2: Any
    distance: Any
    eta: Any

    def define_coefficient(self, r: Any) -> Any:
        """Constant in steady sliding."""
        return self.f1 - self.f2

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Sum of the fast and the slow part."""
        x, y = chunks(z, len(v))
        return tuple(-N * (a + b) for a, b in zip(x, y, strict=True))

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Filters over the distance slipped."""
        x, y = chunks(z, len(v))
        r = norm(v)
        fast = [(self.f1 * v_ - r * x_) / (self.eta * self.distance) for v_, x_ in zip(v, x, strict=True)]
        slow = [-(self.f2 * v_ + r * y_) / self.distance for v_, y_ in zip(v, y, strict=True)]
        return (*fast, *slow)

    def validate(self) -> None:
        """0 <= f2 < f1 and eta < 1."""
        self._number("f2", self.f2, minimum=0.0)
        if self.f2 >= self.f1:
            self._refuse("f2", self.f2, f"< f1 = {self.f1:g}")
        if self.eta >= 1.0:
            self._refuse("eta", self.eta, "< 1")

    @classmethod
    def example(cls) -> Self:
        """A brake, per metre."""
        return cls(f1=0.7, f2=0.3, distance=1e-4, eta=0.2)
