"""A prescribed spin."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any

from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND
from fricmb.space._joint import SpaceJoint
from fricmb.space._rotor import Rotor


@dataclass(frozen=True, eq=False)
class DrivenSpin(SpaceJoint):
    """Prescribes the angular velocity of a rotor about its own axis.  Reaction: torque on it about that axis.

    The drive follows the axis as it tilts and does not hold it: only the part of the angular velocity along the axis is
    prescribed, as by a motor behind a flexible coupling.

    Parameters
    ----------
    name : str
    a : Rotor
    speed : number or SymPy expression in ``fm.t``

    Examples
    --------
    >>> import fricmb as fm
    >>> wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2)
    >>> drive = fm.space.DrivenSpin("drive", wheel, speed=3.0 * fm.t)
    >>> sol = fm.simulate(fm.Scene("spun up", [wheel, drive]), t_end=1.0)
    >>> sol.reaction("drive")[0, -1].round(9)
    0.6
    """

    _: KW_ONLY
    speed: Any

    def _check_own(self) -> None:
        if not isinstance(self.a, Rotor):
            self._refuse("a", self.a.end_name, "a Rotor: it has an axis of its own")
        if self.b is not GROUND:
            self._refuse("b", self.b.end_name, "left out: the spin of a rotor is measured against nothing beside it")
        self._set("speed", check_expression(self, "speed", self.speed, motions=False))

    def _takes_expression(self, field: str) -> bool:
        return field == "speed"

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The angle of spin."""
        rotor: Any = self.a
        return (rotor.spin_form(),)

    def drives(self) -> tuple[Any, ...]:
        """From 0 on."""
        return (("rate", self.speed, 0.0),)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Angle less its prescribed value, kept 0."""
        return (x[0] - x[1],)


