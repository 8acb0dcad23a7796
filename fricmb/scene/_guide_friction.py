"""Friction of constant size along a guide in the plane."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.laws import FrictionLaw
from fricmb.scene._forms import LinearForm
from fricmb.scene._joints import Prismatic
from fricmb.scene._one_coordinate import joint_ends
from fricmb.scene._part import End
from fricmb.scene._plane_joint import PlaneJoint


@dataclass(frozen=True, eq=False)
class GuideFriction(PlaneJoint):
    """What a :class:`DryFriction` along a :class:`Prismatic` is: a force along its line, which may turn with b.

    It holds nothing but by its friction.  Reaction: none.  ``sol.force(name)`` is the force along the line.

    Parameters
    ----------
    name : str
    a, b : ends of the guide
    guide : str
        Name of the guide; where its angle is changed in a scene, that of the friction follows.
    angle : float
        Direction of the line in the axes of b.
    load : float
        Factor of the limits.
    friction : FrictionLaw
        Of one direction; its coefficients are forces.
    """

    constrains: ClassVar[bool] = False
    takes_friction: ClassVar[bool] = True
    only_relative: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("load",)
    _fixed: ClassVar[tuple[str, ...]] = (*PlaneJoint._fixed, "guide")
    _: KW_ONLY
    guide: str
    angle: Any = 0.0
    load: Any = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("angle")
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, angle of b."""
        return (*self.apart(), self.angles()[1])

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Along the line, seen from b."""
        import sympy

        turn = x[2] + self.angle
        return sympy.cos(turn), sympy.sin(turn), x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn)

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Factor of the limits."""
        return self.load


def along_guide(part: Any, a: End, b: End, guide: Prismatic, law: FrictionLaw, load: Any) -> GuideFriction:
    """The friction along a guide whose ends are a and b, or that of a."""
    mine, other = joint_ends(part, a, b, guide)
    if mine is not guide.a:
        part._refuse("a", mine.end_name, f"the end of the guide {guide.name!r} that slides, {guide.a.end_name!r}")
    return GuideFriction(part.name, mine, other, guide=guide.name, angle=guide.angle, load=load, friction=law)
