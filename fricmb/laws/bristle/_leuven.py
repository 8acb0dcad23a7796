"""The Leuven model: a hysteresis with memory inside a bristle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order, chunks, norm, stribeck, yielding
from fricmb.values import is_list


@dataclass(frozen=True, kw_only=True)
class Leuven(FrictionLaw):
    """F = -N (h + sigma1 z' + sigma2 v), z' = v - |v| h |h|^(n-1)/s(|v|)^n, h = sum_i k_i y_i.

    The hysteresis force h(z) remembers every turn of the deflection z: its elements y_i follow z and yield at limits_i
    (Maxwell slip in place of the stacks of the first version).  s(r) = mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent).

    Parameters
    ----------
    stiffness : sequence of float, (n,)
        Of the elements of the hysteresis, per normal force, 1/length, > 0.
    limits : sequence of float, (n,)
        Coefficients at which they yield, > 0; their sum must be above mu_s.
    transition : float
        n, how sharply presliding goes over into sliding, >= 1.
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 < mu_k <= mu_s.
    v_s, exponent : float
        Stribeck speed and exponent, > 0.
    sigma1, sigma2 : float
        Damping of the deflection and viscous coefficient, >= 0.
    corner : float
        Relative width of the rounded corners, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. Swevers, F. Al-Bender, C. G. Ganseman, T. Prajogo, An integrated friction model structure with improved
    presliding behavior for accurate friction compensation, IEEE Transactions on Automatic Control 45 (2000) 675-686;
    V. Lampaert, J. Swevers, F. Al-Bender, Modification of the Leuven integrated friction model structure, ibid. 47
    (2002) 683-687.
    """

    states: ClassVar[tuple[str, ...]] = ("z", "y")
    positive: ClassVar[tuple[str, ...]] = ("stiffness", "limits", "mu_s", "mu_k", "v_s", "exponent", "corner",)

    stiffness: Any
    limits: Any
    mu_s: Any
    mu_k: Any
    v_s: Any
    exponent: Any = 2.0
    transition: Any = 2.0
    sigma1: Any = 0.0
    sigma2: Any = 0.0
    corner: Any = 1e-2

    def define_coefficient(self, r: Any) -> Any:
        """The Stribeck curve, and the viscous part."""
        return stribeck(self, r) + self.sigma2 * r

    def _hysteresis(self, z: tuple[Any, ...], d: int) -> tuple[Any, ...]:
        held = list(zip(self.stiffness, chunks(z, d)[1:], strict=True))
        return tuple(sum(k * vector[i] for k, vector in held) for i in range(d))

    def _deflection(self, v: tuple[Any, ...], z: tuple[Any, ...]) -> tuple[Any, ...]:
        h, r = self._hysteresis(z, len(v)), norm(v)
        s = stribeck(self, r)
        pull = r / s * (norm(h) / s) ** (self.transition - 1)
        return tuple(v_ - pull * h_ for v_, h_ in zip(v, h, strict=True))

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Hysteresis, its damping, and the viscous part."""
        held = zip(self._hysteresis(z, len(v)), self._deflection(v, z), v, strict=True)
        return tuple(-N * (h + self.sigma1 * rate + self.sigma2 * v_) for h, rate, v_ in held)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The deflection, and its elements."""
        rate = self._deflection(v, z)
        held = zip(self.stiffness, self.limits, chunks(z, len(v))[1:], strict=True)
        elements = [c for k, limit, y in held for c in yielding(y, rate, limit / k, self.corner)]
        return (*rate, *elements)

    def validate(self) -> None:
        """As many limits as springs, all > 0."""
        for name in ("stiffness", "limits"):
            if not isinstance(getattr(self, name), tuple | np.ndarray):
                self._refuse(name, getattr(self, name), "a sequence of numbers > 0")
        if len(self.limits) != len(self.stiffness):
            self._refuse("limits", self.limits, f"as many numbers as stiffness has ({len(self.stiffness)})")
        if sum(self.limits) <= self.mu_s:
            self._refuse("limits", self.limits, f"numbers with a sum above mu_s = {self.mu_s:g}")
        self._number("transition", self.transition, minimum=1.0)
        self._number("sigma1", self.sigma1, minimum=0.0)
        self._number("sigma2", self.sigma2, minimum=0.0)
        check_order(self)

    def copies(self) -> dict[str, int]:
        """One deflection an element."""
        return {"y": len(self.stiffness) if is_list(self.stiffness) else 1}

    @classmethod
    def example(cls) -> Self:
        """A guideway, in metres and seconds."""
        return cls(
            stiffness=(4e3, 3e3, 2e3), limits=(0.1, 0.15, 0.3), mu_s=0.4, mu_k=0.3, v_s=1e-2, sigma1=1.0
        )
