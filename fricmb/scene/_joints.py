"""Joints that hold: pin, weld, guide, rod."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import kept_distance
from fricmb.scene._plane_joint import BetweenPoints, PlaneJoint


@dataclass(frozen=True, eq=False)
class Revolute(PlaneJoint):
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

    only_relative: ClassVar[bool] = True
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
        return self.apart() + (self.angles() if self.friction is not None else ())

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance between the points, kept 0."""
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
            a, b = self.angles()
        except SceneError:
            return {}
        return {"angle": a - b}


@dataclass(frozen=True, eq=False)
class Fixed(PlaneJoint):
    """Two points stay together, and the bodies keep their relative angle.  Reaction: force (x, y) and torque on a."""

    only_relative: ClassVar[bool] = True

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and relative angle."""
        return (*self.apart(), self.kept_angle())

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance and relative angle, kept 0."""
        return x


@dataclass(frozen=True, eq=False)
class Prismatic(PlaneJoint):
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

    only_relative: ClassVar[bool] = True
    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = 0.0
    guide: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("angle")
        self._number("guide", self.guide, minimum=0.0)
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, relative angle, angle of b."""
        return (*self.apart(), self.kept_angle(), self.angles()[1])

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance across the line, kept 0."""
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
class Rod(BetweenPoints):
    """A massless rod: two points keep their distance.  Reaction: force along the rod, > 0 where it pushes.

    Parameters
    ----------
    name : str
    a, b : ends
    length : float
        > 0.
    """

    only_relative: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("length",)
    _: KW_ONLY
    length: Any

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance less its kept value, scaled to unit slope along the rod; kept 0."""
        return kept_distance(x, self.length)
