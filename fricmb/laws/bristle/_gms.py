"""Generalised Maxwell slip: elements that slip with a Stribeck curve and lag behind it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import along, check_order, chunks, norm, stribeck
from fricmb.values import is_list


@dataclass(frozen=True, kw_only=True)
class GeneralisedMaxwellSlip(FrictionLaw):
    """Elements of stiffness k_i: z_i' = v while they stick, k_i z_i' = C (a_i v/|v| - k_i z_i/s(|v|)) while they slip.

    F = -N (sum_i k_i z_i + sigma2 v); s(r) = mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent); element i begins to slip
    where k_i |z_i| = a_i s, and sticks again where v turns against z_i.  The change is not an event: within the share
    ``corner`` below the limit one rate goes over into the other (see :class:`Jenkins`).

    Parameters
    ----------
    stiffness : sequence of float, (n,)
        Of the elements, per normal force, 1/length, > 0.
    shares : sequence of float, (n,)
        a_i, shares of the elements in s, > 0, with the sum 1.
    attraction : float
        C, rate at which an element comes to the Stribeck curve, 1/time, > 0.
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 < mu_k <= mu_s.
    v_s, exponent : float
        Stribeck speed and exponent, > 0.
    sigma2 : float
        Viscous coefficient, >= 0.
    corner : float
        Relative width of the rounded corners, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    F. Al-Bender, V. Lampaert, J. Swevers, The generalized Maxwell-slip model: a novel model for friction simulation and
    compensation, IEEE Transactions on Automatic Control 50 (2005) 1883-1887.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = (
        "stiffness", "shares", "attraction", "mu_s", "mu_k", "v_s", "exponent", "corner",
    )  # fmt: skip

    stiffness: Any
    shares: Any
    attraction: Any
    mu_s: Any
    mu_k: Any
    v_s: Any
    exponent: Any = 2.0
    sigma2: Any = 0.0
    corner: Any = 1e-2

    def define_coefficient(self, r: Any) -> Any:
        """The Stribeck curve, and the viscous part."""
        return sum(self.shares) * stribeck(self, r) + self.sigma2 * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """All springs together, and the viscous part."""
        held = list(zip(self.stiffness, chunks(z, len(v)), strict=True))
        return tuple(-N * (sum(k * vector[i] for k, vector in held) + self.sigma2 * v[i]) for i in range(len(v)))

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Every element between stick and slip."""
        held = zip(self.stiffness, self.shares, chunks(z, len(v)), strict=True)
        return tuple(c for k, share, vector in held for c in self._element(v, vector, k, share))

    def _element(self, v: tuple[Any, ...], z: tuple[Any, ...], k: Any, share: Any) -> tuple[Any, ...]:
        import sympy

        r, length, s = norm(v), norm(z), stribeck(self, norm(v))
        held = sympy.Min(1, sympy.Max(0, 1 + (k * length / (share * s) - 1) / self.corner)) ** 2
        slips = held * sympy.Max(0, along(z, v)) / (length * r)
        pull = [self.attraction * (share * v_ / r / k - z_ / s) for v_, z_ in zip(v, z, strict=True)]
        return tuple((1 - slips) * v_ + slips * p for v_, p in zip(v, pull, strict=True))

    def validate(self) -> None:
        """As many limits as springs, all > 0."""
        for name in ("stiffness", "shares"):
            if not isinstance(getattr(self, name), tuple | np.ndarray):
                self._refuse(name, getattr(self, name), "a sequence of numbers > 0")
        if len(self.shares) != len(self.stiffness):
            self._refuse("shares", self.shares, f"as many numbers as stiffness has ({len(self.stiffness)})")
        if abs(sum(self.shares) - 1.0) > 1e-9:
            self._refuse("shares", self.shares, "numbers with the sum 1")
        self._number("sigma2", self.sigma2, minimum=0.0)
        check_order(self)

    def copies(self) -> dict[str, int]:
        """One deflection an element."""
        return {"z": len(self.stiffness) if is_list(self.stiffness) else 1}

    @classmethod
    def example(cls) -> Self:
        """A guideway, in metres and seconds."""
        return cls(
            stiffness=(4e3, 3e3, 2e3), shares=(0.2, 0.3, 0.5), attraction=50.0, mu_s=0.4, mu_k=0.3, v_s=1e-2
        )
