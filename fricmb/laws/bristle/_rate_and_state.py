"""Rate-and-state friction of Dieterich and Ruina."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm
from fricmb.values import value_of


@dataclass(frozen=True, kw_only=True)
class RateAndState(FrictionLaw):
    """mu = a asinh(|v|/(2 v_0) exp((mu_0 + b psi)/a)) with psi = log(v_0 theta/L), F = -N (mu v/|v| + viscous v).

    ``evolution`` "aging" (Dieterich): theta' = 1 - |v| theta/L; "slip" (Ruina):
    theta' = -(|v| theta/L) log(|v| theta/L).  For |v| > 0 mu is mu_0 + a log(|v|/v_0) + b log(v_0 theta/L), and it is
    finite at v = 0.  The state is psi, one number for the contact; 0 is the steady state at v_0.
    A contact of the aging law strengthens at rest.

    The form with asinh goes through v = 0 within the speed v_0 exp(-(mu_0 + b psi)/a), 1e-32 for rock: no difference
    of two speeds in double precision shows that.  In the force |v| is therefore sqrt(v^2 + v_rest^2): a contact that
    is loaded below its strength creeps at less than v_rest.  A contact whose drive is not far faster than that cannot
    lock, and has no stick-slip; a run that comes near it says so in ``sol.stats.notes``.

    Parameters
    ----------
    mu_0 : float
        Coefficient in steady slip at v_0, > 0.
    a, b : float
        Direct effect, > 0, and evolution effect, >= 0.
    L : float
        Slip distance over which the state evolves, > 0.
    v_0 : float
        Reference speed, > 0.
    v_rest : float or None
        Speed below which the force falls to 0 in proportion to the speed, > 0; None: 1e-8 v_0.
    evolution : str
        "aging" or "slip".
    viscous : float
        Coefficient per speed (radiation damping), >= 0.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    J. H. Dieterich, Modeling of rock friction 1, Journal of Geophysical Research 84 (1979) 2161-2168; A. Ruina, Slip
    instability and state variable friction laws, ibid. 88 (1983) 10359-10370; the regular form: J. R. Rice,
    N. Lapusta, K. Ranjith, Rate and state dependent friction and the stability of sliding between elastically
    deformable solids, Journal of the Mechanics and Physics of Solids 49 (2001) 1865-1898.
    """

    states: ClassVar[tuple[str, ...]] = ("psi",)
    scalars: ClassVar[tuple[str, ...]] = ("psi",)
    positive: ClassVar[tuple[str, ...]] = ("mu_0", "a", "L", "v_0",)

    mu_0: Any
    a: Any
    b: Any
    L: Any
    v_0: Any
    v_rest: float | None = None
    evolution: str = "aging"
    viscous: Any = 0.0

    @property
    def rests(self) -> bool:  # type: ignore[override]
        """The slip law rests, the aging law does not."""
        return self.evolution == "slip"

    def _coefficient(self, r: Any, psi: Any) -> Any:
        """asinh(exp(x)) by its logarithm where exp(x) is large."""
        import sympy

        x = sympy.log(r / (2 * self.v_0)) + (self.mu_0 + self.b * psi) / self.a
        return self.a * sympy.Piecewise((sympy.asinh(sympy.exp(x)), x < 30), (x + sympy.log(2), True))

    def _rest(self) -> Any:
        return self.v_0 * 1e-8 if self.v_rest is None else self.v_rest

    def slowest(self) -> float:
        """Speed near which, and below, the contact has no strength: v_rest."""
        return float(value_of(self._rest()))

    def _slow(self, v: Any) -> Any:
        """The slip speed, not below v_rest."""
        import sympy

        return sympy.sqrt(sum(c**2 for c in v) + self._rest() ** 2)

    def define_coefficient(self, r: Any) -> Any:
        """Steady sliding, where psi = -log(r/v_0)."""
        import sympy

        r = norm((r,))
        slow = self._slow((r,))
        return self._coefficient(slow, -sympy.log(r / self.v_0)) * r / slow + self.viscous * r

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Opposes the slip."""
        slow = self._slow(v)
        push = N * (self._coefficient(slow, z[0]) / slow + self.viscous)
        return tuple(-push * c for c in v)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Rate of psi = log(v_0 theta/L)."""
        import sympy

        r, psi = norm(v), z[0]
        if self.evolution == "aging":
            # where exp would overflow, psi is pushed up as fast as can be
            return ((self.v_0 * sympy.exp(sympy.Min(-psi, 300)) - r) / self.L,)
        return (-r / self.L * (sympy.log(r / self.v_0) + psi),)

    def validate(self) -> None:
        """Ranges."""
        self._number("b", self.b, minimum=0.0)
        self._number("viscous", self.viscous, minimum=0.0)
        if self.v_rest is not None:
            self._number("v_rest", self.v_rest, above=0.0)
        if self.evolution not in ("aging", "slip"):
            self._refuse("evolution", self.evolution, "'aging' or 'slip'")

    @classmethod
    def example(cls) -> Self:
        """A fault gouge, in metres and seconds."""
        return cls(mu_0=0.6, a=0.01, b=0.015, L=1e-5, v_0=1e-6)
