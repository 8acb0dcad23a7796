"""Orthotropic friction: an elliptic cone with maximum dissipation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from fricmb.laws._base import FrictionLaw
from fricmb.laws.vector._shaped import Shaped


@dataclass(frozen=True, kw_only=True)
class Elliptic(Shaped):
    """Friction of ``law`` along the contact's first direction, ``ratio`` times as much along the second.

    Of all forces in the ellipse ``|S^-1 F| <= mu N``, S = diag(1, ratio), slip meets the one of greatest dissipation:
    ``F = -mu N S (S v)/|S v|``.  It is not opposite to v but for slip along an axis.  In the scaled velocity S v and
    force S^-1 F the law is the isotropic one and the power the same, so that the same kernels serve: ``r = |S v|``.

    Parameters
    ----------
    law : FrictionLaw
        Set-valued and isotropic.
    ratio : float
        Coefficient along the second direction over that along the first, > 0.  Choose the principal axes by the
        contact's ``axes``.

    Raises
    ------
    LawError
        If the ratio is not positive, or the law not set-valued and isotropic.

    References
    ----------
    A. Zmitrowicz, A theoretical model of anisotropic dry friction, Wear 73 (1981) 9-39; the principle of maximum
    dissipation: S. Goyal, A. Ruina, J. Papadopoulos, Planar sliding with dry friction, Wear 143 (1991) 307-330.
    """

    dimensions: ClassVar[tuple[int, ...]] = (2,)
    isotropic: ClassVar[bool] = False
    positive: ClassVar[tuple[str, ...]] = ("ratio",)

    ratio: Any

    def axis_scale(self) -> tuple[Any, ...]:
        """(1, ratio)."""
        return (1.0, self.ratio)

    def check(self) -> None:
        """The law inside is set-valued and isotropic."""
        law = self.law
        plain = isinstance(law, FrictionLaw) and not (law.axis_scale() or law.offsets())
        if not plain or law.kind == "smooth" or law.load_dependent:
            self._refuse("law", law, "an isotropic set-valued law of the slip speed, such as fm.laws.Coulomb(mu_s=0.5)")
        super().check()

    @classmethod
    def example(cls) -> Self:
        """A ground surface: twice the friction across the grinding marks."""
        from fricmb.laws.set_valued import Coulomb

        law: FrictionLaw = Coulomb(mu_s=0.3, mu_k=0.25)
        return cls(law=law, ratio=2.0)
