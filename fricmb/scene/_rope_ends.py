"""Ends of a rope that stretch, or are pulled: light bodies where the rope runs off the drum, spans and pulls.

The capstan itself knows bodies alone at its ends.  An end without mass of its own gets a ten-billionth of the least
that the rope pulls at, or one that follows the damper of its span within a billionth of the time in which that yields.
"""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from fricmb.errors import SceneError
from fricmb.scene._axes import components, from_vector
from fricmb.scene._bodies import Body
from fricmb.scene._element import Element
from fricmb.scene._force import Force
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, LETTERS, End
from fricmb.scene._rigid import RigidBody, RigidPoint, start_place
from fricmb.values import value_of

if TYPE_CHECKING:
    from fricmb.scene._rope import Rope

#: Mass of an end without one, over the least that the rope pulls at: it is what accelerations of the end are off by.
SHARE = 1e-10
#: Time in which a damped end follows its forces, over that in which its span gives way.
FOLLOWS = 1e-9


@dataclass(frozen=True, eq=False)
class RopeEnd(Body):
    """Where a rope runs off its drum: how far it is out there, ``x``.  A scene has it beside a :class:`Rope`."""

    _fixed: ClassVar[tuple[str, ...]] = (*Body._fixed, "declared")
    _: KW_ONLY
    declared: tuple[Any, ...] = ()


@dataclass(frozen=True, eq=False)
class RopeSpan(Element):
    """A free span of a rope that stretches: a spring and a damper between an end and where the rope leaves the drum.

    It never pushes: tensions at the drum that would have to be negative make the rope slack.
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis", "declared")

    a: End
    b: RopeEnd
    _: KW_ONLY
    axis: Any
    stiffness: Any
    damping: Any = 0.0
    declared: tuple[Any, ...] = ()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """How far it is stretched."""
        return (out(self, self.a, self.axis) - self.b.motion("x"),)

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Of the spring."""
        return self.stiffness * x[0] ** 2 / 2

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any:
        """Of the damper."""
        return self.damping * x_dot[0] ** 2 / 2


@dataclass(frozen=True, eq=False)
class RopePull(Force):
    """The tension that is given at an end of a rope."""

    _fixed: ClassVar[tuple[str, ...]] = (*Force._fixed, "declared")
    _: KW_ONLY
    declared: tuple[Any, ...] = ()


class Side(NamedTuple):
    """What is declared of one side of a rope: an end, or a tension in place of one.

    ``stiffness`` None: the span does not stretch.
    """

    end: End | None
    axis: Any
    tension: Any
    stiffness: Any
    damping: Any

    @property
    def is_rigid(self) -> bool:
        """Whether the rope itself holds the end."""
        return self.end is not None and self.stiffness is None


def vector(part: Any, end: End, axis: Any) -> tuple[tuple[str, float], ...]:
    """The direction in which a rope runs towards an end, by letters."""
    if end.owner is not GROUND:
        return components(part, "axes", axis, end, GROUND)
    if isinstance(axis, str):
        return ((axis, 1.0),)
    length = math.hypot(*value_of(axis))
    return tuple((letter, float(c / length)) for letter, c in zip(LETTERS, value_of(axis), strict=False))


def start_out(part: Any, end: End, axis: Any) -> float:
    """How far from the origin an end is along its direction, as declared."""
    at = start_place(end)
    if at is None:
        raise SceneError(f"{part._label()}: length must be given where {end.end_name!r} is an end")
    return sum(c * at.get(letter, 0.0) for letter, c in vector(part, end, axis))


def out(part: Any, end: End, axis: Any) -> LinearForm:
    """The same as it moves."""
    if end.owner is GROUND:
        return LinearForm((), start_out(part, end, axis))
    return from_vector(vector(part, end, axis), end, GROUND, "t").form


def ends_of(rope: Rope, sides: tuple[Side, Side], pretension: float) -> tuple[tuple[End, End], tuple[Any, ...]]:
    """The ends that the capstan has, and the parts beside it."""
    if all(side.is_rigid for side in sides):
        first, second = sides
        return (first.end, second.end), ()  # type: ignore[return-value]
    _check_determined(rope, sides)
    speeds, mass = _start_rates(rope, sides), _light(rope, sides)
    ends: list[Any] = []
    beside: list[Any] = []
    for i, side in enumerate(sides):
        if side.is_rigid:
            ends.append(side.end)
            continue
        name = f"{rope.name}_{i + 1}"
        declared = _plain(side, pretension)
        stretched = 0.0 if side.end is None else pretension / float(value_of(side.stiffness))
        at = 0.0 if side.end is None else start_out(rope, side.end, side.axis) - stretched
        end = RopeEnd(name, mass=mass, position={"x": at}, velocity={"x": speeds[i]}, declared=declared)
        ends.append(end)
        beside.append(end)
        if side.end is None:
            beside.append(RopePull(f"{name}_pull", end, axis="x", value=side.tension, declared=declared))
            continue
        given = {"axis": side.axis, "stiffness": side.stiffness, "damping": side.damping}
        beside.append(RopeSpan(f"{name}_span", side.end, end, **given, declared=declared))
    return (ends[0], ends[1]), tuple(beside)


def _plain(side: Side, pretension: float) -> tuple[Any, ...]:
    """What an end was declared by, in plain numbers and words that can be compared."""
    if side.end is None:
        return (str(side.tension),)
    return float(value_of(side.stiffness)), float(value_of(side.damping)), pretension


def _check_determined(rope: Rope, sides: tuple[Side, Side]) -> None:
    """Refuse a rope of which nothing says where it is on its drum while it slips, or where it is slack."""
    elastic = [side for side in sides if side.end is not None and side.stiffness is not None]
    damped = all(float(value_of(side.damping)) > 0.0 for side in elastic)
    if elastic and not damped and not any(side.is_rigid for side in sides):
        rope._refuse(
            "damping", 0.0, "> 0 where no end holds the rope itself: while it slips nothing else says how fast it moves"
        )
    if elastic and not damped and rope.when_slack == "open":
        rope._refuse("damping", 0.0, "> 0 beside when_slack='open': a slack span has no mass that would swing")


def _start_rates(rope: Rope, sides: tuple[Side, Side]) -> tuple[float, float]:
    """Speeds at which the rope runs off on both sides at the start: one is the other's opposite."""
    held = [i for i, side in enumerate(sides) if side.is_rigid]
    moving = held or [i for i, side in enumerate(sides) if side.end is not None]
    rates = [_start_rate(rope, sides[i]) * (1.0 if i == 0 else -1.0) for i in moving]
    first = sum(rates) / len(rates)
    return first, -first


def _start_rate(rope: Rope, side: Side) -> float:
    """Declared velocity of an end along its direction."""
    assert side.end is not None
    owner: Any = side.end.owner
    if side.end.owner is GROUND or not hasattr(owner, "start_values"):
        return 0.0
    rate = {letter: float(value_of(v)) for letter, v in owner.start_values("velocity").items()}
    if isinstance(side.end, RigidPoint):
        place = start_place(side.end) or {}
        turn = rate["angle"]
        for letter, other, sign in (("x", "y", -1.0), ("y", "x", 1.0)):
            arm = place[other] - float(value_of(owner.position[other]))
            rate[letter] += sign * turn * arm
    return sum(c * rate.get(letter, 0.0) for letter, c in vector(rope, side.end, side.axis))


def _light(rope: Rope, sides: tuple[Side, Side]) -> float:
    """Mass of ends that have none."""
    masses = [_mass(side.end) for side in sides if side.end is not None]
    drum = rope.drum.owner
    if isinstance(drum, RigidBody):
        masses.append(float(value_of(drum.inertia)) / float(value_of(rope.radius)) ** 2)
    mass = SHARE * min((m for m in masses if m > 0.0), default=1.0)
    for side in sides:
        if side.end is not None and side.stiffness is not None and not any(other.is_rigid for other in sides):
            mass = min(mass, FOLLOWS * float(value_of(side.damping)) ** 2 / float(value_of(side.stiffness)))
    return mass


def _mass(end: End) -> float:
    """Least mass behind an end; 0 where none is known."""
    owner: Any = end.owner
    mass = getattr(owner, "mass", None)
    if mass is not None:
        return float(value_of(mass))
    masses = getattr(owner, "masses", None)
    return float(min(value_of(masses))) if isinstance(masses, tuple) and masses else 0.0
