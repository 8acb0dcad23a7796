"""A measured friction curve."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Tabulated(FrictionLaw):
    """A monotone cubic through measured points, constant outside them.

    Its second derivative jumps at the points; steps end there where that matters.

    Parameters
    ----------
    speed : sequence of float, (n,)
        Slip speeds, >= 0 and increasing, at least two.
    mu : sequence of float, (n,)
        Coefficients, >= 0.
    mu_s : float, optional
        Break-away coefficient, at least that of the curve for r -> 0; default: that of the curve.

    Raises
    ------
    LawError
        If the table is not accepted.

    References
    ----------
    F. N. Fritsch, R. E. Carlson, Monotone piecewise cubic interpolation, SIAM J. Numerical Analysis 17 (1980) 238-246.
    """

    speed: Any
    mu: Any
    mu_s: Any = None

    def validate(self) -> None:
        """Increasing speeds, as many coefficients, none negative."""
        for name in ("speed", "mu"):
            if np.ndim(getattr(self, name)) != 1 or len(getattr(self, name)) < 2:
                self._refuse(name, getattr(self, name), "a sequence of at least two numbers")
        speed, mu = np.asarray(self.speed), np.asarray(self.mu)
        if speed[0] < 0.0 or np.any(np.diff(speed) <= 0.0):
            self._refuse("speed", self.speed, "increasing and >= 0")
        if len(mu) != len(speed) or np.any(mu < 0.0):
            self._refuse("mu", self.mu, f"as many coefficients >= 0 as speeds ({len(speed)})")

    def compiled_coefficient(self) -> Callable[..., None]:
        """Piecewise cubic by bisection."""
        from fricmb.laws._pchip import pchip_coefficient

        return pchip_coefficient

    def parameter_block(self) -> NDArray[np.float64]:
        """``[n, speed, mu, slope]``."""
        from fricmb.laws._pchip import pchip_slopes

        numbers = self.numeric_slots()
        speed, mu = numbers["speed"], numbers["mu"]
        return np.concatenate([[len(speed)], speed, mu, pchip_slopes(speed, mu)])

    def knots(self) -> tuple[float, ...]:
        """The speeds of the table."""
        return tuple(float(r) for r in self.numeric_slots()["speed"])

    def slip_limit(self, normal_force: float = 1.0) -> float:
        """The first coefficient of the table."""
        return float(self.numeric_slots()["mu"][0])

    def coefficient(self, r: Any, normal_force: Any = 1.0) -> Any:
        """The curve at slip speeds ``r``."""
        return self._curve(r, 0)

    def derivative(self, r: Any, normal_force: Any = 1.0) -> Any:
        """Slope of the curve; 0 outside the table."""
        return self._curve(r, 1)

    def _curve(self, r: Any, which: int) -> Any:
        from fricmb.laws._pchip import pchip_evaluate
        from fricmb.laws._without_sympy import speeds

        value = pchip_evaluate(self.parameter_block(), speeds(self, r))[which]
        return value if value.ndim else float(value)

    @classmethod
    def example(cls) -> Self:
        """Five points of a falling curve."""
        return cls(speed=(0.0, 0.01, 0.1, 1.0, 3.0), mu=(0.6, 0.55, 0.42, 0.38, 0.4))
