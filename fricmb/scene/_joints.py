"""The catalogue of joints."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._rigid import angle_of, plane_motion, start_angle


class _PlaneJoint(Joint):
    def _apart(self) -> tuple[LinearForm, LinearForm]:
        """Components of the vector from b to a."""
        (ax, ay), (bx, by) = plane_motion(self, "a", self.a), plane_motion(self, "b", self.b)
        return ax - bx, ay - by

    def _angles(self) -> tuple[LinearForm, LinearForm]:
        return angle_of(self, "a", self.a), angle_of(self, "b", self.b)

    def _kept_angle(self) -> LinearForm:
        """Relative angle less its declared start."""
        a, b = self._angles()
        return a - b - LinearForm((), start_angle(self.a) - start_angle(self.b))


@dataclass(frozen=True, eq=False)
class Revolute(_PlaneJoint):
    """A pin: two points stay together.  Reaction: force (x, y) on a.

    Parameters
    ----------
    name : str
    a, b : ends
    radius : float
        Of the pin, where there is friction: slip velocity = radius times the relative angular velocity, normal force =
        magnitude of the reaction.
    friction : FrictionLaw, optional
    """

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    radius: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._number("radius", self.radius, minimum=0.0)
        if self.friction is not None:
            self._number("radius", self.radius, above=0.0)
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points; with friction also the angles."""
        return self._apart() + (self._angles() if self.friction is not None else ())

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance."""
        return x[0], x[1]

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the pin's surface."""
        return 0, 0, self.radius, -self.radius

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        from fricmb.laws import norm

        return norm(lam)

    def observed(self) -> dict[str, LinearForm]:
        """The relative angle, where both ends turn."""
        try:
            a, b = self._angles()
        except SceneError:
            return {}
        return {"angle": a - b}


@dataclass(frozen=True, eq=False)
class Fixed(_PlaneJoint):
    """Two points stay together, and the bodies keep their relative angle.  Reaction: force (x, y) and torque on a."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and relative angle."""
        return (*self._apart(), self._kept_angle())

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """All 0."""
        return x


@dataclass(frozen=True, eq=False)
class Prismatic(_PlaneJoint):
    """a slides along a line fixed in b and keeps its angle relative to b.  Reaction: force across, torque on a.

    Parameters
    ----------
    name : str
    a, b : ends
        The line goes through b.
    angle : float
        Direction of the line in the axes of b.
    guide : float
        Length of the guide: the torque is borne by two forces that far apart, and adds to the normal force.  0: the
        torque brings no friction.
    friction : FrictionLaw, optional
        Normal force ``|N1| + |N2|`` with ``N1, N2 = force/2 +- torque/guide``.
    """

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = 0.0
    guide: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._number("guide", self.guide, minimum=0.0)
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, relative angle, angle of b."""
        return (*self._apart(), self._kept_angle(), self._angles()[1])

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance across the line."""
        import sympy

        turn = x[3] + self.angle
        return x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn), x[2]

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Along the line, seen from b."""
        import sympy

        turn = x[3] + self.angle
        across = x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn)
        return sympy.cos(turn), sympy.sin(turn), 0, across

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Both ends of the guide."""
        import sympy

        # guide = 0: no lever, no force from the torque
        lever = sympy.Piecewise((lam[1] / sympy.Max(self.guide, sympy.Float("1e-300")), self.guide > 0), (0, True))
        return sympy.Abs(lam[0] / 2 + lever) + sympy.Abs(lam[0] / 2 - lever)


@dataclass(frozen=True, eq=False)
class Rod(_PlaneJoint):
    """A massless rod: two points keep their distance.  Reaction: force along the rod, > 0 where it pushes.

    Parameters
    ----------
    name : str
    a, b : ends
    length : float
        > 0.
    """

    positive: ClassVar[tuple[str, ...]] = ("length",)
    _: KW_ONLY
    length: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points."""
        return self._apart()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of unit slope along the rod."""
        return ((x[0] ** 2 + x[1] ** 2) / (2 * self.length) - self.length / 2,)


@dataclass(frozen=True, eq=False)
class RollerOnLine(_PlaneJoint):
    """A point of a stays on a line through b, fixed in b.  Reaction: force on a along the line's left-hand normal.

    Parameters
    ----------
    name : str
    a, b : ends
    angle : float
        Direction of the line in the axes of b; the normal is 90 degrees further.
    push_only : bool
        The line can push but not pull; where it would have to pull, contact is lost and the run ends.
    slide : number or SymPy expression in ``fm.t``
        Velocity of the line's surface along the line.
    friction : FrictionLaw, optional
        Normal force: magnitude of the reaction.
    """

    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = 0.0
    push_only: bool = False
    slide: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.push_only, bool):
            self._refuse("push_only", self.push_only, "True or False")
        self._set("slide", check_expression(self, "slide", self.slide, motions=False))
        self.local_coordinates()

    def _takes_expression(self, field: str) -> bool:
        return field == "slide"

    @property
    def one_sided(self) -> bool:
        """As ``push_only``."""
        return self.push_only

    def drives(self) -> tuple[Any, ...]:
        """The surface's own motion."""
        return (("rate", self.slide, 0.0),) if self.friction is not None else ()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and angle of b."""
        b = angle_of(self, "b", self.b) if self._turns() else LinearForm()
        return (*self._apart(), b)

    def _turns(self) -> bool:
        try:
            angle_of(self, "b", self.b)
        except SceneError:
            return False
        return True

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance across the line."""
        import sympy

        turn = x[2] + self.angle
        return (x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn),)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Along the line, seen from b, less the motion of its surface."""
        import sympy

        turn = x[2] + self.angle
        across = x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn)
        return sympy.cos(turn), sympy.sin(turn), across, -1

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        import sympy

        return lam[0] if self.push_only else sympy.Abs(lam[0])


@dataclass(frozen=True, eq=False)
class RollerOnCircle(_PlaneJoint):
    """A point of a stays on a circle about b.  Reaction: force on a, outward.

    Parameters
    ----------
    name : str
    a, b : ends
    radius : float
        > 0.
    friction : FrictionLaw, optional
        Normal force: magnitude of the reaction; slip relative to a circle that does not turn.
    """

    takes_friction: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("radius",)
    _: KW_ONLY
    radius: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points."""
        return self._apart()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of unit slope outward."""
        return ((x[0] ** 2 + x[1] ** 2) / (2 * self.radius) - self.radius / 2,)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Counter-clockwise along the circle."""
        return -x[1] / self.radius, x[0] / self.radius

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        import sympy

        return sympy.Abs(lam[0])


@dataclass(frozen=True, eq=False)
class Gear(Joint):
    """Angles in a fixed ratio: ``angle of a - start = -ratio (angle of b - start)``.  Reaction: torque on a.

    Parameters
    ----------
    name : str
    a, b : RigidBody or one of its points
    ratio : float
        Radius of b over that of a; < 0 for an internal gear or a belt.
    """

    _: KW_ONLY
    ratio: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Both angles from their declared start on."""
        held = (("a", self.a), ("b", self.b))
        return tuple(angle_of(self, argument, end) - LinearForm((), start_angle(end)) for argument, end in held)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The teeth."""
        return (x[0] + self.ratio * x[1],)


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
        Instead: its rate, from the declared relative angle on.
    """

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
        """As prescribed."""
        return (x[0] - x[1],)


@dataclass(frozen=True, eq=False)
class DrivenSlide(_PlaneJoint):
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
        Instead: its rate, from 0 on.
    """

    _: KW_ONLY
    angle: Any = 0.0
    distance: Any = None
    speed: Any = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_drive(self, "distance", self.distance, "speed", self.speed)
        self.local_coordinates()

    def _takes_expression(self, field: str) -> bool:
        return field in ("distance", "speed")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and angle of b."""
        return (*self._apart(), self._angles()[1])

    def drives(self) -> tuple[Any, ...]:
        """The prescribed distance."""
        return (("value", self.distance, 0.0),) if self.distance is not None else (("rate", self.speed, 0.0),)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """As prescribed."""
        import sympy

        turn = x[2] + self.angle
        return (x[0] * sympy.cos(turn) + x[1] * sympy.sin(turn) - x[3],)


def check_drive(joint: Joint, first: str, value: Any, second: str, rate: Any) -> None:
    """Exactly one of a value and a rate, as expressions of time."""
    if (value is None) == (rate is None):
        raise SceneError(f"{joint._label()}: one of {first} and {second} must be given, got {value!r} and {rate!r}")
    argument = first if rate is None else second
    joint._set(argument, check_expression(joint, argument, value if rate is None else rate, motions=False))
