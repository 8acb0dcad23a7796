"""Rigid bodies that move and turn in the plane, points fixed in them, and points of the ground."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

from fricmb._calls import answers
from fricmb.errors import SceneError, shown, unknown_name
from fricmb.scene._bodies import Body, check_keys
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, LETTERS, End, Part, PartEnd, PointEnd
from fricmb.values import as_float, is_list, value_of
from fricmb.values._same import is_same

PLANE = ("x", "y")


def check_pair(owner: Part, argument: str, value: Any) -> tuple[Any, Any]:
    """Two numbers: x and y."""
    if isinstance(value, Mapping):
        given = check_keys(owner, argument, value, PLANE)
        return tuple(owner._number(f"{argument}[{c!r}]", given.get(c, 0.0)) for c in PLANE)
    if is_list(value) and len(value) == 2:
        return owner._number(f"{argument}[0]", value[0]), owner._number(f"{argument}[1]", value[1])
    owner._refuse(argument, value, "two numbers, (x, y)")


@dataclass(frozen=True, eq=False)
class RigidBody(PartEnd):
    """A rigid body in the plane: its centre of mass moves along x and y, and it turns.

    Degrees of freedom ``"name.x"``, ``"name.y"`` (centre of mass) and ``"name.angle"`` (rad, counter-clockwise).

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    mass, inertia : float
        > 0; the inertia about the centre of mass.
    position : (float, float)
        Centre of mass at the start; default (0, 0).  A body that does not fit its joints is moved onto them: see
        ``sol.stats.notes``.
    angle, angular_velocity : float
        At the start.
    velocity : (float, float)
        Of the centre of mass at the start.
    points : dict of str to (float, float)
        Points fixed in the body, in its own axes from the centre of mass on.

    Raises
    ------
    SceneError
        If a value is not accepted.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name",)

    _: KW_ONLY
    mass: Any
    inertia: Any
    position: Any = (0.0, 0.0)
    angle: Any = 0.0
    velocity: Any = (0.0, 0.0)
    angular_velocity: Any = 0.0
    points: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        for argument in ("mass", "inertia"):
            self._set(argument, self._number(argument, getattr(self, argument), above=0.0))
        for argument in ("position", "velocity"):
            pair = check_pair(self, argument, getattr(self, argument))
            self._set(argument, MappingProxyType(dict(zip(PLANE, pair, strict=True))))
        for argument in ("angle", "angular_velocity"):
            self._set(argument, self._number(argument, getattr(self, argument)))
        if not isinstance(self.points, Mapping):
            self._refuse("points", self.points, "a dict of point name to (x, y)")
        for name in self.points:
            if not isinstance(name, str) or not name.isidentifier() or name in (*PLANE, "angle"):
                self._refuse("points", name, "keyed by names that are identifiers, other than 'x', 'y' and 'angle'")
        checked = {name: check_pair(self, f"points[{name!r}]", value) for name, value in self.points.items()}
        self._set("points", MappingProxyType(checked))

    @property
    def dof_names(self) -> tuple[str, ...]:
        """``"name.x"``, ``"name.y"``, ``"name.angle"``."""
        return tuple(f"{self.name}.{c}" for c in (*PLANE, "angle"))

    def masses(self) -> tuple[float, float, float]:
        """Mass, mass and inertia: the diagonal of the mass matrix."""
        mass = float(value_of(self.mass))
        return mass, mass, float(value_of(self.inertia))

    def start_values(self, argument: str) -> dict[str, Any]:
        """Declared start of the degrees of freedom; ``argument``: "position" or "velocity"."""
        turn = self.angle if argument == "position" else self.angular_velocity
        return {**getattr(self, argument), "angle": turn}

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of the plane."""
        return PLANE

    @property
    def movable(self) -> bool:
        """True: forces move it."""
        return True

    def moves_like(self, other: object) -> bool:
        """With the same points and the same angle at the start, which joints read, whatever its other numbers."""
        fields = ("name", "angle", "points")
        return type(other) is type(self) is RigidBody and all(
            is_same(getattr(self, name), getattr(other, name)) for name in fields
        )

    def motion(self, letter: str) -> LinearForm:
        """The centre of mass along an axis."""
        return LinearForm.of({f"{self.name}.{letter}": 1.0})

    def point(self, name: str, offset: Any = None) -> RigidPoint:
        """A point fixed in the body: an end for elements, contacts and joints.

        Parameters
        ----------
        name : str
        offset : (float, float), optional
            In the body's axes from its centre of mass on; left out for a name in ``points``.

        Raises
        ------
        UnknownNameError
            If there is no such point and no offset is given.
        """
        if offset is None:
            if not isinstance(name, str) or name not in self.points:
                raise unknown_name(f"point of {self._label()}", name, self.points)
            return RigidPoint(self, name)
        if not isinstance(name, str) or not name.isidentifier() or name in (*PLANE, "angle"):
            self._refuse("point", name, "named by an identifier other than 'x', 'y' and 'angle'")
        if name in self.points:
            raise SceneError(f"{self._label()}: point {name!r} is among its points; leave the offset out")
        return RigidPoint(self, name, check_pair(self, f"point {name!r}", offset))

    @staticmethod
    def define_point(q: tuple[Any, ...], offset: tuple[Any, ...]) -> tuple[Any, ...]:
        """Position of a point for the coordinates (x, y, angle), in SymPy."""
        import sympy

        c, s = sympy.cos(q[2]), sympy.sin(q[2])
        return q[0] + c * offset[0] - s * offset[1], q[1] + s * offset[0] + c * offset[1]


@dataclass(frozen=True)
class RigidPoint(PointEnd):
    """A point fixed in a rigid body; made by :meth:`RigidBody.point`.

    ``own``: its offset, where the body's ``points`` do not list it.
    """

    body: RigidBody
    point: str
    own: tuple[Any, Any] | None = None

    @property
    def offset(self) -> tuple[float, float]:
        """In the body's axes from its centre of mass on."""
        u, v = (float(x) for x in value_of(self.own if self.own is not None else self.body.points[self.point]))
        return u, v

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of the plane."""
        return PLANE

    def moves_like(self, other: object) -> bool:
        """At the same place of a body that moves like this one's."""
        return (
            isinstance(other, RigidPoint)
            and self.point == other.point
            and is_same(self.own, other.own)
            and self.body.moves_like(other.body)
        )

    def moved_to(self, part: Part) -> End:
        """The point of the same name."""
        return self if part is self.body or not isinstance(part, RigidBody) else RigidPoint(part, self.point, self.own)


@dataclass(frozen=True)
class GroundPoint(End):
    """A fixed point; made by :func:`ground_point`."""

    x: float
    y: float

    @property
    def end_name(self) -> str:
        """Such as ``"ground(1, 0)"``."""
        return f"ground({self.x:g}, {self.y:g})"

    @property
    def owner(self) -> Part:
        """The ground."""
        return GROUND

    @property
    def letters(self) -> tuple[str, ...]:
        """Letters of the plane."""
        return PLANE

    @property
    def movable(self) -> bool:
        """False: the ground rests."""
        return False

    def motion(self, letter: str) -> LinearForm:
        """Where it is."""
        return LinearForm((), self.x if letter == "x" else self.y)

    def moved_to(self, part: Part) -> End:
        """There is one ground."""
        return self


@answers
def ground_point(x: float, y: float) -> GroundPoint:
    """A fixed point of the plane, an end for joints and elements."""
    for argument, value in (("x", x), ("y", y)):
        if not math.isfinite(as_float(value)):
            raise SceneError(f"ground_point: {argument} must be a finite number, got {shown(value)}")
    return GroundPoint(float(x), float(y))


def angle_of(owner: Part, argument: str, end: Any) -> LinearForm:
    """The angle of the body that an end belongs to; 0 for the ground and for bodies that do not turn."""
    if isinstance(end, RigidPoint):
        end = end.body
    if isinstance(end, RigidBody):
        return LinearForm.of({f"{end.name}.angle": 1.0})
    if isinstance(end, End) and end.owner is GROUND:
        return LinearForm()
    given = end.end_name if isinstance(end, End) else end
    accepted = "a RigidBody of the plane, one of its points, or GROUND"
    raise SceneError(f"{owner._label()}: {argument} must turn ({accepted}), got {shown(given)}")


def start_angle(end: End) -> float:
    """Declared angle of the body that an end belongs to; 0 for the ground."""
    owner = end.owner
    return float(value_of(owner.angle)) if isinstance(owner, RigidBody) else 0.0


def start_place(end: End) -> dict[str, float] | None:
    """Where an end is as declared, by letter; None for one that is a point of something else than a rigid body."""
    if end.owner is GROUND:
        return {"x": end.x, "y": end.y} if isinstance(end, GroundPoint) else {}
    if not isinstance(end, Body | RigidBody | RigidPoint):
        return None
    owner: Any = end.owner
    at = {letter: float(value_of(v)) for letter, v in owner.start_values("position").items()}
    if isinstance(end, RigidPoint):
        (u, v), c, s = end.offset, math.cos(at["angle"]), math.sin(at["angle"])
        at = {"x": at["x"] + c * u - s * v, "y": at["y"] + s * u + c * v}
    return at


def plane_motion(owner: Part, argument: str, end: Any) -> tuple[LinearForm, LinearForm]:
    """X and y of an end."""
    if not isinstance(end, End):
        owner._refuse(argument, end, "a RigidBody, a point, a Body, a Driven or GROUND")
    if getattr(end.owner, "turning", None) is not None or (end.owner is GROUND and end.letters == LETTERS):
        owner._refuse(argument, end.end_name, "an end in the plane; for bodies in space take the joints of fm.space")
    if isinstance(end, Body) and set(end.axes) != set(PLANE):
        owner._refuse(argument, end.end_name, f"an end with the axes 'xy' (it has {end.axes!r})")
    return end.motion("x"), end.motion("y")
