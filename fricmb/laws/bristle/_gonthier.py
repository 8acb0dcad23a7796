"""Gonthier: a bristle whose break-away grows with the time at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import check_order, norm


@dataclass(frozen=True, kw_only=True)
class Gonthier(FrictionLaw):
    """F = -N (sat(sigma0 z + sigma1 z', f_max) + sigma2 v): a vector bristle with dwell time.

    z' = s v + (1 - s)(mu_k v/|v| - sigma0 z)/sigma1 with s = exp(-(|v|/v_s)^2); f_max = mu_k + (mu_s - mu_k) dwell; the
    state dwell follows s within ``tau_dwell`` while it grows and within sigma1/sigma0 while it falls.

    Parameters
    ----------
    sigma0, sigma1 : float
        Bristle stiffness (1/length) and damping (time/length) per normal force, > 0.
    sigma2 : float
        Viscous coefficient, >= 0.
    mu_s, mu_k : float
        Coefficients of break-away after a long rest and of slip, 0 <= mu_k <= mu_s.
    v_s : float
        Speed that parts sticking from sliding, > 0.
    tau_dwell : float
        Time at rest over which break-away grows, > 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    Y. Gonthier, J. McPhee, C. Lange, J.-C. Piedboeuf, A regularized contact model with asymmetric damping and dwell
    time dependent friction, Multibody System Dynamics 11 (2004) 209-233.
    """

    states: ClassVar[tuple[str, ...]] = ("z", "dwell")
    scalars: ClassVar[tuple[str, ...]] = ("dwell",)
    rests: ClassVar[bool] = False
    positive: ClassVar[tuple[str, ...]] = ("sigma0", "sigma1", "v_s", "tau_dwell",)

    sigma0: Any
    sigma1: Any
    sigma2: Any
    mu_s: Any
    mu_k: Any
    v_s: Any
    tau_dwell: Any

    def _sticking(self, v: tuple[Any, ...]) -> Any:
        import sympy

        return sympy.exp(-((norm(v) / self.v_s) ** 2))

    def _bristle(self, v: tuple[Any, ...], z: tuple[Any, ...]) -> tuple[Any, ...]:
        s, r = self._sticking(v), norm(v)
        held = zip(v, z, strict=True)
        return tuple(s * v_ + (1 - s) * (self.mu_k * v_ / r - self.sigma0 * z_) / self.sigma1 for v_, z_ in held)

    def define_coefficient(self, r: Any) -> Any:
        """Steady sliding: the bristle's force, at most what the dwell leaves, and the viscous part."""
        import sympy

        s = sympy.exp(-((r / self.v_s) ** 2))
        most = self.mu_k + (self.mu_s - self.mu_k) * s
        slow = r < self.v_s / 10**6  # there the bristle would bear any force
        x = sympy.Max(r / self.v_s, sympy.Float(1e-6))
        bristle = self.mu_k + self.sigma1 * self.v_s * s * x / (1 - sympy.exp(-(x**2)))
        return sympy.Piecewise((most, slow), (sympy.Min(bristle, most), True)) + self.sigma2 * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The bristle's force, saturated, and the viscous part."""
        import sympy

        rate = self._bristle(v, z[: len(v)])
        held = [self.sigma0 * z_ + self.sigma1 * w for z_, w in zip(z[: len(v)], rate, strict=True)]
        share = sympy.Min(1, (self.mu_k + (self.mu_s - self.mu_k) * z[-1]) / norm(held))
        return tuple(-N * (share * f + self.sigma2 * v_) for f, v_ in zip(held, v, strict=True))

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The bristle, and the dwell."""
        import sympy

        lag = self._sticking(v) - z[-1]
        dwell = sympy.Max(0, lag) / self.tau_dwell + sympy.Min(0, lag) * self.sigma0 / self.sigma1
        return (*self._bristle(v, z[: len(v)]), dwell)

    def validate(self) -> None:
        """Ranges, and the order of the coefficients."""
        check_order(self)
        self._number("sigma2", self.sigma2, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """A robot joint, in metres and seconds."""
        return cls(sigma0=1e4, sigma1=30.0, sigma2=0.05, mu_s=0.4, mu_k=0.3, v_s=1e-2, tau_dwell=2.0)
