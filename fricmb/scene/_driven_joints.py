"""Joints that prescribe a motion."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError, shown
from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._plane_joint import PlaneJoint
from fricmb.scene._rigid import angle_of, start_angle


@dataclass(frozen=True, eq=False)
class DrivenAngle(Joint):
    """Prescribes the angle of a relative to b.  Reaction: torque on a.

    Parameters
    ----------
    name : str
    a, b : ends
    angle : number or SymPy expression in ``fm.t``, optional
        The relative angle itself.
    speed : number or SymPy expression in ``fm.t``, optional
        Its rate instead; the angle starts as declared.
    """

    only_relative: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = None
    speed: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_drive(self, "angle", self.angle, "speed", self.speed)
        self.local_coordinates()

    def _takes_expression(self, field: str) -> bool:
        return field in ("angle", "speed")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The relative angle."""
        return (angle_of(self, "a", self.a) - angle_of(self, "b", self.b),)

    def drives(self) -> tuple[Any, ...]:
        """The prescribed angle."""
        if self.angle is not None:
            return (("value", self.angle, 0.0),)
        return (("rate", self.speed, start_angle(self.a) - start_angle(self.b)),)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Coordinate less its prescribed value, kept 0."""
        return (x[0] - x[1],)


@dataclass(frozen=True, eq=False)
class DrivenSlide(PlaneJoint):
    """Prescribes the distance of a from b along a direction fixed in b.  Reaction: force on a along it.

    Parameters
    ----------
    name : str
    a, b : ends
    angle : float
        The direction in the axes of b.
    distance : number or SymPy expression in ``fm.t``, optional
        The distance itself.
    speed : number or SymPy expression in ``fm.t``, optional
        Its rate instead; the distance starts at 0.
    """

    only_relative: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = 0.0
    distance: Any = None
    speed: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("angle")
        check_drive(self, "distance", self.distance, "speed", self.speed)
        self.local_coordinates()

    def _takes_expression(self, field: str) -> bool:
        return field in ("distance", "speed")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and angle of b."""
        return (*self.apart(), self.angles()[1])

    def drives(self) -> tuple[Any, ...]:
        """The prescribed distance."""
        return (("value", self.distance, 0.0),) if self.distance is not None else (("rate", self.speed, 0.0),)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Coordinate less its prescribed value, kept 0."""
        import sympy

        turn = x[2] + self.angle
        return (x[0] * sympy.cos(turn) + x[1] * sympy.sin(turn) - x[3],)


def check_drive(joint: Joint, first: str, value: Any, second: str, rate: Any) -> None:
    """Exactly one of a value and a rate, as expressions of time."""
    if (value is None) == (rate is None):
        raise SceneError(
            f"{joint._label()}: one of {first} and {second} must be given,"
            f" got {shown(value)} and {rate!r}"
        )
    argument = first if rate is None else second
    joint._set(argument, check_expression(joint, argument, value if rate is None else rate, motions=False))
