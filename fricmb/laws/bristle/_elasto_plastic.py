"""The elasto-plastic bristle: elastic up to break-away, without drift."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import along, check_order, norm, stribeck


@dataclass(frozen=True, kw_only=True)
class ElastoPlastic(FrictionLaw):
    """LuGre's bristle that is purely elastic below a deflection: F = -N (sigma0 z + sigma1 z' + sigma2 v).

    z' = v - alpha(|z|) max(0, z.v) z/(|z| z_ss), z_ss = g(|v|)/sigma0 and
    g(r) = mu_k + (mu_s - mu_k) exp(-(r/v_s)^exponent).
    alpha rises as a sine from 0 at z_ba = elastic mu_k/sigma0 to 1 at z_ss.  In one dimension this is the published
    law, with alpha = 0 where z and v have opposite signs; max(0, z.v) makes that a continuous rate in two.

    Parameters
    ----------
    sigma0 : float
        Bristle stiffness per normal force, 1/length, > 0.
    sigma1, sigma2 : float
        Bristle damping and viscous coefficient, >= 0.
    mu_s, mu_k : float
        Coefficients at rest and in fast slip, 0 < mu_k <= mu_s.
    v_s, exponent : float
        Stribeck speed and exponent, > 0.
    elastic : float
        Share of mu_k below which the bristle is elastic, 0 < elastic < 1.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, Single state elastoplastic friction models, IEEE Transactions on
    Automatic Control 47 (2002) 787-792.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("sigma0", "mu_s", "mu_k", "v_s", "exponent", "elastic",)

    sigma0: Any
    sigma1: Any
    sigma2: Any
    mu_s: Any
    mu_k: Any
    v_s: Any
    exponent: Any = 2.0
    elastic: Any = 0.7

    def define_coefficient(self, r: Any) -> Any:
        """Steady sliding."""
        return stribeck(self, r) + self.sigma2 * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Bristle stiffness, bristle damping and viscous part."""
        rate = self.define_rate(v, N, z)
        held = zip(z, rate, v, strict=True)
        return tuple(-N * (self.sigma0 * z_ + self.sigma1 * rate_ + self.sigma2 * v_) for z_, rate_, v_ in held)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Elastic, plastic beyond break-away."""
        import sympy

        length, steady = norm(z), stribeck(self, norm(v)) / self.sigma0
        least = self.elastic * self.mu_k / self.sigma0
        x = sympy.Min(1, sympy.Max(0, (length - least) / (steady - least)))
        alpha = (1 - sympy.cos(sympy.pi * x)) / 2
        pull = alpha * sympy.Max(0, along(z, v)) / (length * steady)
        return tuple(v_ - pull * z_ for v_, z_ in zip(v, z, strict=True))

    def validate(self) -> None:
        """Ranges, and the order of the coefficients."""
        check_order(self)
        self._number("sigma1", self.sigma1, minimum=0.0)
        self._number("sigma2", self.sigma2, minimum=0.0)
        if self.elastic >= 1.0:
            self._refuse("elastic", self.elastic, "< 1")

    @classmethod
    def example(cls) -> Self:
        """A servo axis, in metres and seconds."""
        return cls(sigma0=1e4, sigma1=10.0, sigma2=0.1, mu_s=0.4, mu_k=0.3, v_s=1e-2)
