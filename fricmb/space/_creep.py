"""Laws of rolling contact: forces from creepage, the slip velocity over the speed of rolling."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws import FrictionLaw, norm

#: What keeps quotients finite where there is no load, and a series in place of arctan(x)/x below.
LEAST, SMALL = 1e-300, 1e-3


@dataclass(frozen=True, kw_only=True)
class CreepLaw(FrictionLaw):
    """Base of laws of rolling contact; they take two directions of slip, along the rail and across.

    For small creepage all of them reduce to Kalker's linear theory, ``F_i = -f_ii u_i/speed``.
    """

    dimensions: ClassVar[tuple[int, ...]] = (2,)
    positive: ClassVar[tuple[str, ...]] = ("f11", "f22", "speed")
    isotropic: ClassVar[bool] = False

    f11: Any
    f22: Any
    speed: Any

    def validate(self) -> None:
        """One number each."""
        for name in self.positive:
            self._number(name, getattr(self, name), above=0.0)

    def linear(self, v: tuple[Any, ...]) -> tuple[Any, Any]:
        """What the force would be by the linear theory, along slip."""
        return self.f11 * v[0] / self.speed, self.f22 * v[1] / self.speed


@dataclass(frozen=True, kw_only=True)
class LinearCreep(CreepLaw):
    """Kalker's linear theory: force proportional to creepage, whatever the load.

    Parameters
    ----------
    f11, f22 : float
        Force per creepage along the rail and across, > 0 (:func:`kalker` gives them).
    speed : float
        Speed of rolling, > 0.

    References
    ----------
    J. J. Kalker, On the rolling contact of two elastic bodies in the presence of dry friction, thesis, Delft 1967.
    """

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Force proportional to slip."""
        along, across = self.linear(v)
        return -along, -across

    @classmethod
    def example(cls) -> Self:
        """A railway wheel, SI units."""
        return cls(f11=8e6, f22=7e6, speed=50.0)


@dataclass(frozen=True, kw_only=True)
class ShenHedrickElkins(CreepLaw):
    """Linear creepage that saturates: ``|F| = mu N (e - e^2/3 + e^3/27)`` up to e = 3, then mu N.

    e is the force of the linear theory over mu N; the direction is that of the linear theory.

    Parameters
    ----------
    mu : float
        Coefficient of friction, > 0.
    f11, f22, speed : float
        As of :class:`LinearCreep`.

    References
    ----------
    Z. Y. Shen, J. K. Hedrick, J. A. Elkins, A comparison of alternative creep force models for rail vehicle dynamic
    analysis, Proc. 8th IAVSD Symposium (1983) 591-605 (without spin: P. J. Vermeulen, K. L. Johnson, J. Appl. Mech. 31
    (1964) 338-340).
    """

    positive: ClassVar[tuple[str, ...]] = ("mu", "f11", "f22", "speed")

    mu: Any

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """The linear force times what saturation leaves of it."""
        import sympy

        along, across = self.linear(v)
        size, limit = norm((along, across)), self._limit(N)
        e = size / limit
        part = sympy.Piecewise((1 - e / 3 + e**2 / 27, size < 3 * limit), (limit / size, True))
        return -part * along, -part * across

    def define_switch(self, v: tuple[Any, ...], N: Any) -> Any:
        """Where it saturates: the third derivative jumps."""
        return 3 * self._limit(N) - norm(self.linear(v))

    def _limit(self, N: Any) -> Any:
        """What it saturates at, kept above 0."""
        import sympy

        return sympy.Max(self.mu * N, sympy.Float(LEAST))

    @classmethod
    def example(cls) -> Self:
        """A railway wheel, SI units."""
        return cls(mu=0.3, f11=8e6, f22=7e6, speed=50.0)


@dataclass(frozen=True, kw_only=True)
class Polach(CreepLaw):
    """Polach's law: ``|F| = 2 mu N/pi (k_A e/(1 + (k_A e)^2) + arctan(k_S e))``, against the slip velocity.

    ``e = pi/4 |(f11 u_1, f22 u_2)|/(speed mu N)``; with k_A = k_S = 1 its slope at the origin is that of the linear
    theory.  Friction may fall with the slip velocity w: ``mu = mu_0 ((1 - A) exp(-B w) + A)``.

    Parameters
    ----------
    mu : float
        Coefficient of friction at rest, > 0.
    f11, f22, speed : float
        As of :class:`LinearCreep`.
    k_A, k_S : float
        Reduction in the area of adhesion and in that of slip, > 0: wet rails have less than 1.
    A : float
        Coefficient of friction at high slip over that at rest, > 0.
    B : float
        How fast it falls, in the unit of 1/velocity, >= 0.

    References
    ----------
    O. Polach, Creep forces in simulations of traction vehicles running on adhesion limit, Wear 258 (2005) 992-1000,
    equations 3, 5 and 9 (without spin).
    """

    positive: ClassVar[tuple[str, ...]] = ("mu", "f11", "f22", "speed", "k_A", "k_S", "A")

    mu: Any
    k_A: Any = 1.0
    k_S: Any = 1.0
    A: Any = 1.0
    B: Any = 0.0

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Polach's force, against slip."""
        import sympy

        w = norm(v)
        limit = sympy.Max(self.mu * N, sympy.Float(LEAST)) * ((1 - self.A) * sympy.exp(-self.B * w) + self.A)
        per_slip = sympy.pi / 4 * norm(self.linear(v)) / w / limit  # e = per_slip w
        adhesion, slip = self.k_A * per_slip, self.k_S * per_slip
        x = slip * w
        angle = sympy.Piecewise((slip * (1 - x**2 / 3 + x**4 / 5), x < SMALL), (sympy.atan(x) / w, True))
        part = 2 * limit / sympy.pi * (adhesion / (1 + (adhesion * w) ** 2) + angle)
        return -part * v[0], -part * v[1]

    def validate(self) -> None:
        """Range of B."""
        super().validate()
        self._number("B", self.B, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """A railway wheel, SI units."""
        return cls(mu=0.4, f11=8e6, f22=7e6, speed=50.0, A=0.5, B=0.5)
