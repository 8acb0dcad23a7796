"""Iwan's parallel Jenkins elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import chunks, yielding
from fricmb.values import is_list


@dataclass(frozen=True, kw_only=True)
class Iwan(FrictionLaw):
    """F = -N sum_i stiffness_i z_i, each z_i a Jenkins element that yields at limits_i: memory of every turn.

    The first loading is piecewise linear; unloading and reloading follow Masing's rules (but for the rounded corners,
    see :class:`Jenkins`).

    Parameters
    ----------
    stiffness : sequence of float, (n,)
        Of the elements, per normal force, 1/length, > 0.
    limits : sequence of float, (n,)
        Coefficients at which they yield, > 0; their sum is the coefficient of slip.
    corner : float
        Relative width of the rounded corners, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    W. D. Iwan, A distributed-element model for hysteresis and its steady-state dynamic response, Journal of Applied
    Mechanics 33 (1966) 893-900.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("stiffness", "limits", "corner",)

    stiffness: Any
    limits: Any
    corner: Any = 1e-2

    def define_coefficient(self, r: Any) -> Any:
        """All elements yield in steady sliding."""
        return sum(self.limits)

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """All springs together."""
        held = zip(self.stiffness, chunks(z, len(v)), strict=True)
        parts = [tuple(k * c for c in vector) for k, vector in held]
        return tuple(-N * sum(part[i] for part in parts) for i in range(len(v)))

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Every element on its own."""
        held = zip(self.stiffness, self.limits, chunks(z, len(v)), strict=True)
        return tuple(c for k, limit, vector in held for c in yielding(vector, v, limit / k, self.corner))

    def validate(self) -> None:
        """As many limits as springs, all > 0."""
        for name in ("stiffness", "limits"):
            if not isinstance(getattr(self, name), tuple | np.ndarray):
                self._refuse(name, getattr(self, name), "a sequence of numbers > 0")
        if len(self.limits) != len(self.stiffness):
            self._refuse("limits", self.limits, f"as many numbers as stiffness has ({len(self.stiffness)})")

    def copies(self) -> dict[str, int]:
        """One deflection an element."""
        return {"z": len(self.stiffness) if is_list(self.stiffness) else 1}

    @classmethod
    def from_backbone(cls, displacement: Any, coefficient: Any, *, corner: float = 1e-2) -> Self:
        """Elements whose first loading goes from 0 through the given points (concave), and is level after the last.

        Parameters
        ----------
        displacement, coefficient : sequence of float, (n,)
            Points of the curve of first loading, increasing, with falling slopes.
        corner : float
        """
        x, mu = np.asarray(displacement, float), np.asarray(coefficient, float)
        slope = np.append(np.diff(mu, prepend=0.0) / np.diff(x, prepend=0.0), 0.0)
        stiffness = -np.diff(slope)
        return cls(stiffness=tuple(stiffness), limits=tuple(stiffness * x), corner=corner)

    @classmethod
    def example(cls) -> Self:
        """A bolted joint of four elements, per metre."""
        return cls(stiffness=(4e3, 3e3, 2e3, 1e3), limits=(0.04, 0.06, 0.08, 0.12))
