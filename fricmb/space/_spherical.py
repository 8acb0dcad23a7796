"""A ball joint, and its dry ball."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.scene._part import LETTERS
from fricmb.space._joint import SpaceJoint
from fricmb.space._turning import KINDS, kind_of, turning_forms, turning_rows
from fricmb.values import is_one_of


@dataclass(frozen=True, eq=False)
class Spherical(SpaceJoint):
    """A ball joint: two points stay together.  Reaction: force (x, y, z) on a.

    Parameters
    ----------
    name : str
    a, b : ends
        Bodies of ``fm.space`` (their centres of mass), points of them, ``fm.space.ground_point(x, y, z)``, GROUND.
    radius : float
        Of the ball, where there is friction: slip velocity = radius times the relative angular velocity, in the three
        directions of space.
    friction : FrictionLaw, optional
        A law that sticks, with a cone in three directions; normal force = magnitude of the reaction.  It exerts the
        torque ``radius * sol.force(name)`` on a.

    Examples
    --------
    >>> import fricmb as fm
    >>> bob = fm.space.RigidBody("bob", mass=2.0, inertia=(0.03, 0.05, 0.04), points={"top": (0, 0, 0.3)})
    >>> hook = fm.space.Spherical("hook", bob.point("top"), fm.space.ground_point(0, 0, 0.3))
    >>> sol = fm.simulate(fm.Scene("at rest", [bob, hook, fm.Gravity("g", acceleration={"z": -9.81})]), t_end=1.0)
    >>> sol.reaction("hook")[:, -1].round(9)
    array([ 0.  ,  0.  , 19.62])
    """

    only_relative: ClassVar[bool] = True
    takes_friction: ClassVar[bool] = True
    slip_rows: ClassVar[int] = 3
    _: KW_ONLY
    radius: Any = 0.0
    turning: str | None = None

    def _check_own(self) -> None:
        self._number("radius", self.radius, minimum=0.0)
        if self.friction is None:
            return
        self._number("radius", self.radius, above=0.0)
        kinds = (kind_of(self, "a"), kind_of(self, "b"))
        found = " ".join(kinds)
        if not is_one_of(self.turning, None, found):
            self._refuse("turning", self.turning, f"left out (it is {found!r}, from a and b)")
        self._set("turning", found)

    def labels(self) -> tuple[str, ...]:
        """Directions of space."""
        return LETTERS

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points; with friction what turns of both."""
        turns = (turning_forms(end.owner) for end in ((self.a, self.b) if self.friction is not None else ()))
        return (*self.apart(), *(form for forms in turns for form in forms))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance between the points, kept 0."""
        return x[0:3]

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Radius times what the angular velocities differ by."""
        a, b = (self.turning or "").split()
        own, other = x[3 : 3 + KINDS[a]], x[3 + KINDS[a] :]
        return tuple(
            tuple(self.radius * factor for factor in (0, 0, 0, *first, *(-f for f in second)))
            for first, second in zip(turning_rows(a, own), turning_rows(b, other), strict=True)
        )

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Magnitude of the reaction."""
        from fricmb.laws import norm

        return norm(lam)
