"""One law in three regimes: set-valued, regularised, with bristles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from fricmb._facade import facade

if TYPE_CHECKING:
    from fricmb.laws._base import FrictionLaw
    from fricmb.laws._creep import Creep


class Regimes:
    """What every friction law can be turned into."""

    def regularised(self, v_reg: Any) -> FrictionLaw:
        """A smooth law in place of this set-valued one: it creeps below the speed ``v_reg`` instead of sticking."""
        from fricmb.laws.regularised import Regularised

        return Regularised(law=self, v_reg=v_reg)

    def bristle(self, stiffness: Any, **options: Any) -> FrictionLaw:
        """A bristle of ``stiffness`` (per length and normal force) in place of this set-valued law.

        Options as the fields of :class:`fricmb.laws.Bristle`: ``damping``, ``v_s``.
        """
        from fricmb.laws.bristle import Bristle

        return Bristle(law=self, stiffness=stiffness, **options)

    @facade
    def creep(self, load: float = 0.5) -> Creep:
        """How far and how fast the law gives way under a share ``load`` of its break-away; see :class:`Creep`."""
