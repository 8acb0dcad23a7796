"""Any set-valued law, regularised."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm
from fricmb.laws._made_of import MadeOf

#: The break-away peak of a law with a jump has decayed within about this many v_reg.
_PEAK = 10


@dataclass(frozen=True, kw_only=True)
class Regularised(MadeOf):
    """F = -N tanh(r/v_reg) mu(r) v/r of a set-valued law; ``law.regularised(v_reg)`` makes it.

    Where the law breaks away above its slip limit mu_0, mu(r) is raised by (mu_s - mu_0) exp(-(r/(10 v_reg))^2): the
    peak is there, 2 % below mu_s, at 2 v_reg.  A law that is not isotropic stays so.

    Parameters
    ----------
    law : FrictionLaw
        A set-valued law that SymPy can state.
    v_reg : float
        Speed below which it creeps, > 0.

    Raises
    ------
    LawError
        If a value is outside its range, or the law is not set-valued.
    """

    positive: ClassVar[tuple[str, ...]] = ("v_reg",)

    v_reg: Any

    def define_coefficient(self, r: Any, N: Any = None) -> Any:
        """The law's coefficient, led to 0 at r = 0 (along the first direction)."""
        import sympy

        peak = self.jump(N) * sympy.exp(-((r / (_PEAK * self.v_reg)) ** 2))
        return sympy.tanh(r / self.v_reg) * (self.inner(r, N) + peak)

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Opposes the slip with the curve."""
        scale = self.law.axis_scale() or (1,) * len(v)
        scaled = tuple(s * c for s, c in zip(scale, v, strict=True))
        r = norm(scaled)
        push = N * self.define_coefficient(r, N) / r
        return tuple(-push * s * c for s, c in zip(scale, scaled, strict=True))

    @classmethod
    def example(cls) -> Self:
        """A brake lining that creeps below a millimetre per second."""
        from fricmb.laws.set_valued import Stribeck

        law: FrictionLaw = Stribeck.example()
        return cls(law=law, v_reg=1e-3)
