"""Karnopp's stick band."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order, norm


@dataclass(frozen=True, kw_only=True)
class Karnopp(FrictionLaw):
    """Within |v| < v_band the contact holds, with at most mu_s; beyond it slips with mu_k.

    Karnopp's band takes the force that holds from the rest of the system, which a law cannot see.  Here it is found by
    integral action: inside the band a spring and a damper hold, F = -N sat(stiffness z + damping v, mu_s) with z' = v;
    outside z fades over the distance mu_s/stiffness.  One goes over into the other between v_band and 2 v_band, with
    continuous slopes, so that nothing has to be switched.

    Parameters
    ----------
    mu_s, mu_k : float
        Coefficients of break-away and of slip, 0 < mu_k <= mu_s.
    v_band : float
        Half width of the stick band, > 0.
    stiffness : float
        Of the hold, per normal force, 1/length, > 0.
    damping : float
        Of the hold, per normal force, time/length, >= 0.
    viscous : float
        Coefficient per speed, >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    D. Karnopp, Computer simulation of stick-slip friction in mechanical dynamic systems, Journal of Dynamic Systems,
    Measurement, and Control 107 (1985) 100-103; the hold by a reset integrator: D. A. Haessig, B. Friedland, On the
    modeling and simulation of friction, ibid. 113 (1991) 354-362.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("mu_s", "mu_k", "v_band", "stiffness",)

    mu_s: Any
    mu_k: Any
    v_band: Any
    stiffness: Any
    damping: Any = 0.0
    viscous: Any = 0.0

    def _inside(self, r: Any) -> Any:
        """1 in the band, 0 beyond twice the band."""
        import sympy

        x = sympy.Min(1, sympy.Max(0, r / self.v_band - 1))
        return 1 - x**2 * (3 - 2 * x)

    def define_coefficient(self, r: Any) -> Any:
        """Slip: mu_k beyond the band; inside, what the hold can bear."""
        inside = self._inside(r)
        return inside * self.mu_s + (1 - inside) * self.mu_k + self.viscous * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Hold and slip."""
        import sympy

        r = norm(v)
        inside = self._inside(r)
        hold = [self.stiffness * z_ + self.damping * v_ for z_, v_ in zip(z, v, strict=True)]
        share = inside * sympy.Min(1, self.mu_s / norm(hold))
        slip = (1 - inside) * self.mu_k / r + self.viscous
        return tuple(-N * (share * h + slip * v_) for h, v_ in zip(hold, v, strict=True))

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Winds up inside the band, fades outside."""
        r = norm(v)
        inside = self._inside(r)
        fade = (1 - inside) * r * self.stiffness / self.mu_s
        return tuple(inside * v_ - fade * z_ for v_, z_ in zip(v, z, strict=True))

    def validate(self) -> None:
        """Ranges, and the order of the coefficients."""
        check_order(self)
        self._number("damping", self.damping, minimum=0.0)
        self._number("viscous", self.viscous, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """A slide, in metres and seconds."""
        return cls(mu_s=0.6, mu_k=0.4, v_band=1.5e-3, stiffness=1e4, damping=30.0)
