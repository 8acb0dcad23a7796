"""Resistance against rolling: a torque that the reaction of a wheel's own joint sets."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from fricmb.errors import SceneError
from fricmb.laws import Coulomb, FrictionLaw
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._rigid import angle_of

if TYPE_CHECKING:
    from fricmb.scene._part import Part


def resistance_law(part: Part, argument: str, value: Any) -> FrictionLaw:
    """The law of a resistance that is given as one, or by its arm."""
    if isinstance(value, FrictionLaw):
        return value
    return Coulomb(mu_s=part._number(argument, value, minimum=0.0))


@dataclass(frozen=True, eq=False)
class Resistance(Joint):
    """Holds nothing, and rubs as another joint is pressed: the base of what stands beside that joint.

    ``of``: that joint's name; ``declared``: what was given there that it was made of, the resistance first.
    """

    constrains: ClassVar[bool] = False
    takes_friction: ClassVar[bool] = True
    only_relative: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "of", "declared")

    _: KW_ONLY
    of: str
    declared: tuple[Any, ...] = (None,)

    @property
    def loaded_by(self) -> str:
        """The joint it stands beside."""
        return self.of

    @property
    def load_rows(self) -> int:
        """The force across."""
        return 1

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        import sympy

        return sympy.Abs(lam[0])


@dataclass(frozen=True, eq=False)
class RollingResistance(Resistance):
    """Of a wheel in the plane: a torque against the rate of its angle, less that of the line's body.

    A :class:`Wheel` with ``rolling_resistance`` has it beside it in a scene, under its name and ``_rolling``.
    """

    def labels(self) -> tuple[str, ...]:
        """Slip is a turn."""
        return ("angle",)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Angle of the wheel relative to the line."""
        try:
            line = angle_of(self, "b", self.b)
        except SceneError:
            line = LinearForm()
        return (angle_of(self, "a", self.a) - line,)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Its rate."""
        return (1,)
