"""Combined sliding and spinning of a disc: Coulomb-Contensou friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Contensou(FrictionLaw):
    """Coulomb friction under every point of a disc of uniform pressure that slides and spins at once.

    A contact with this law has three directions, the third the speed R omega of the rim (of a dof that is R times
    the angle); its force there is the moment over R.  With v the speed of sliding, u = R abs(omega), m = (v/u)^2 < 1
    and the complete elliptic integrals K(m), E(m)

        |F| = mu N (4/(3 pi)) (u/v) ((1 + m) E - (1 - m) K),
        moment/R = mu N (4/(9 pi)) ((4 - 2 m) E - (1 - m) K),

    and the like for v > u.  A disc that comes to rest does so with v/u -> 0.653002.

    Parameters
    ----------
    mu : float
        Coefficient of friction, >= 0.
    v_reg : float
        Speed below which the law creeps, > 0 (the force is multiplied by tanh(sqrt(v^2 + u^2)/v_reg)).  The equations
        are homogeneous in the velocities, so it may be as small as 1e-12 of them.

    Raises
    ------
    LawError
        If a value is outside its range.

    References
    ----------
    P. Contensou, Couplage entre frottement de glissement et frottement de pivotement dans la theorie de la toupie,
    Kreiselprobleme (IUTAM 1963) 201-216; Z. Farkas, G. Bartels, T. Unger, D. E. Wolf, Frictional coupling between
    sliding and spinning motion, Physical Review Letters 90 (2003) 248302, equations 3 to 6.
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

    def compiled_force(self, d: int) -> Callable[..., None]:
        """Elliptic integrals by the arithmetic-geometric mean, series where these cancel."""
        from fricmb.laws.vector._disc import disc_force

        return disc_force

    def validate(self) -> None:
        """Range of mu."""
        self._number("mu", self.mu, minimum=0.0)

    @classmethod
    def example(cls) -> Self:
        """A curling stone, in metres and seconds."""
        return cls(mu=0.1, v_reg=1e-6)
