"""The Pade form of combined sliding and spinning."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws._curves import norm


@dataclass(frozen=True, kw_only=True)
class ContensouPade(FrictionLaw):
    """Sliding and spinning of a disc by fractions: |F| = mu N v/(v + u), rim force (2/3) mu N u/(u + (8/3) v).

    v the speed of sliding, u = R abs(omega) that of the rim.  The fractions have the values and slopes of the exact law
    (:class:`Contensou`) for v -> 0 and u -> 0; between, near v = u, they fall short by up to 0.36 mu N.

    Parameters
    ----------
    mu : float
        Coefficient of friction, >= 0.
    v_reg : float
        Speed below which the law creeps, > 0 (the force is multiplied by tanh(sqrt(v^2 + u^2)/v_reg)).

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    V. F. Zhuravlev, The model of dry friction in the problem of the rolling of rigid bodies, Journal of Applied
    Mathematics and Mechanics 62 (1998) 705-710 (there for the pressure of Hertz's contact).
    """

    dimensions: ClassVar[tuple[int, ...]] = (3,)
    positive: ClassVar[tuple[str, ...]] = ("v_reg",)
    width: ClassVar[str] = "v_reg"

    mu: Any
    v_reg: Any

    def define_coefficient(self, r: Any) -> Any:
        """Sliding without spin."""
        import sympy

        return self.mu * sympy.tanh(r / self.v_reg)

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Two components of sliding friction and the moment over the radius."""
        import sympy

        slide, spin, both = norm(v[:2]), norm(v[2:]), norm(v)
        load = self.mu * N * sympy.tanh(both / self.v_reg)
        push, turn = load / (slide + spin), load * 2 / (3 * spin + 8 * slide)
        return (-push * v[0], -push * v[1], -turn * v[2])

    def validate(self) -> None:
        """Range of mu."""
        self._number("mu", self.mu, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """A curling stone, in metres and seconds."""
        return cls(mu=0.1, v_reg=1e-6)
