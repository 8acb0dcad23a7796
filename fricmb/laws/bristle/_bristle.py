"""Any set-valued law with bristles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.errors import LawError
from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm
from fricmb.laws._made_of import MadeOf


@dataclass(frozen=True, kw_only=True)
class Bristle(MadeOf):
    """F = -N (stiffness z + damping z'), z' = v - stiffness |v| z/g(|v|): LuGre's bristle with the curve of a law.

    ``law.bristle(stiffness)`` makes it.  g(r) is the law's coefficient; where the law breaks away above its slip limit
    mu_0, (mu_s - mu_0) exp(-(r/v_s)^2) is added, and the speed ``v_s`` must be given.  A law that is not isotropic
    stays so.

    Parameters
    ----------
    law : FrictionLaw
        A set-valued law that SymPy can state, with a coefficient > 0 at rest.
    stiffness : float
        Per normal force, 1/length, > 0.
    damping : float
        Per normal force, time/length, >= 0.
    v_s : float, optional
        Speed over which friction falls from break-away to slip, > 0.

    Raises
    ------
    LawError
        If a value is outside its range or missing, or the law is not set-valued.

    References
    ----------
    C. Canudas de Wit, H. Olsson, K. J. Astrom, P. Lischinsky, A new model for control of systems with friction,
    IEEE Transactions on Automatic Control 40 (1995) 419-425.
    """

    states: ClassVar[tuple[str, ...]] = ("z",)
    positive: ClassVar[tuple[str, ...]] = ("stiffness", "v_s")

    stiffness: Any
    damping: Any = 0.0
    v_s: Any = None

    def define_coefficient(self, r: Any, N: Any = None) -> Any:
        """The law's coefficient, and the peak of break-away (along the first direction)."""
        import sympy

        peak = 0 if self.v_s is None else self.jump(N) * sympy.exp(-((r / self.v_s) ** 2))
        return self.inner(r, N) + peak

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Bristles follow the slip and saturate."""
        scaled = self._scaled(v)
        r = norm(scaled)
        pull = self.stiffness * r / self.define_coefficient(r, N)
        return tuple(v_ - pull * z_ for v_, z_ in zip(scaled, z, strict=True))

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Bristle stiffness and damping."""
        rate = self.define_rate(v, N, z)
        return self._scaled(tuple(-N * (self.stiffness * a + self.damping * b) for a, b in zip(z, rate, strict=True)))

    def _scaled(self, v: tuple[Any, ...]) -> tuple[Any, ...]:
        return tuple(s * c for s, c in zip(self.law.axis_scale() or (1,) * len(v), v, strict=True))

    def validate(self) -> None:
        """What the law inside asks for."""
        self._number("damping", self.damping, minimum=0.0)
        limit, static = self.law.slip_limit(), self.law.break_away()
        if limit <= 0.0:
            raise LawError(f"{self._label()}: law must have a coefficient > 0 at rest, got {limit:g}")
        if self.v_s is None and static > limit * (1.0 + 1e-12):
            self._refuse("v_s", None, f"a speed: the law breaks away at {static:g} and slips at {limit:g}")

    @classmethod
    def example(cls) -> Self:
        """A brake lining on bristles."""
        from fricmb.laws.set_valued import Stribeck

        law: FrictionLaw = Stribeck.example()
        return cls(law=law, stiffness=1e4, damping=10.0)
