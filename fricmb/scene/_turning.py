"""What acts on the angle of bodies: torsional springs and dampers, torques; and gravity."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._bodies import check_keys
from fricmb.scene._element import Element
from fricmb.scene._expressions import check_expression, expression_uses
from fricmb.scene._force import Force
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, LETTERS, End, Part
from fricmb.scene._rigid import angle_of


def relative_angle(owner: Part, a: End, b: End) -> LinearForm:
    """Angle of a less that of b."""
    form = angle_of(owner, "a", a) - angle_of(owner, "b", b)
    if not form.terms:
        raise SceneError(f"{owner._label()}: one end must turn, and a and b belong to different bodies")
    return form


@dataclass(frozen=True, eq=False)
class TorsionSpring(Element):
    """Torque on a: ``-stiffness (angle of a - angle of b - angle)``.

    Parameters
    ----------
    name : str
    a, b : RigidBody, one of its points, or GROUND
        b defaults to GROUND.
    stiffness : float
        Torque per radian.
    angle : float
        Relative angle at which the torque is 0.
    """

    a: End
    b: End = GROUND
    _: KW_ONLY
    stiffness: Any
    angle: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("stiffness", "angle")
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The relative angle."""
        return (relative_angle(self, self.a, self.b),)

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Quadratic."""
        return self.stiffness * (x[0] - self.angle) ** 2 / 2


@dataclass(frozen=True, eq=False)
class TorsionDamper(Element):
    """Torque on a: ``-damping`` times its angular velocity relative to b.

    Parameters
    ----------
    name : str
    a, b : RigidBody, one of its points, or GROUND
        b defaults to GROUND.
    damping : float
        Torque per angular velocity.
    """

    a: End
    b: End = GROUND
    _: KW_ONLY
    damping: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("damping")
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The relative angle."""
        return (relative_angle(self, self.a, self.b),)

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any:
        """Quadratic in the relative angular velocity."""
        return self.damping * x_dot[0] ** 2 / 2


@dataclass(frozen=True, eq=False)
class Torque(Force):
    """A torque on a body, counter-clockwise, and its opposite on another.

    Parameters
    ----------
    name : str
    body : RigidBody or one of its points
    b : RigidBody, one of its points, or GROUND
        The body that takes the opposite torque; default GROUND.
    value : float or SymPy expression
        In ``fm.t``, ``fm.coordinate("arm.angle")``, ``fm.speed("arm.angle")`` and parameters.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "body", "b", "axis")

    b: End = GROUND
    _: KW_ONLY
    axis: Any = "angle"
    value: Any = 0.0

    def __post_init__(self) -> None:
        Element.__post_init__(self)
        if self.axis != "angle":
            self._refuse("axis", self.axis, "left out")
        self._set("value", check_expression(self, "value", self.value, motions=True))
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The relative angle, then the motions in ``value``."""
        own = relative_angle(self, self.body, self.b)
        return (own, *(LinearForm.of({name: 1.0}) for name in expression_uses(self.value).motions))


class PlaneDefault(Mapping[str, Any]):
    """What gravity is where nothing is said: downward along y, which is so in the plane alone."""

    def __getitem__(self, letter: str) -> float:
        return {"y": -9.81}[letter]

    def __iter__(self) -> Iterator[str]:
        return iter("y")

    def __len__(self) -> int:
        return 1


@dataclass(frozen=True, eq=False)
class Gravity(Part):
    """Weight of every Body and RigidBody of the scene, those of ``fm.space`` included.

    Parameters
    ----------
    name : str
    acceleration : dict of axis to float
        Default ``{"y": -9.81}``; where there are bodies in space it has to be given.
    """

    _: KW_ONLY
    acceleration: Mapping[str, Any] = field(default_factory=PlaneDefault)

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.acceleration, PlaneDefault):
            return
        given = check_keys(self, "acceleration", self.acceleration, LETTERS)
        checked = {c: self._number(f"acceleration[{c!r}]", value) for c, value in given.items()}
        self._set("acceleration", MappingProxyType(checked))
