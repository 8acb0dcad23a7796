"""What joints in the plane share."""

from __future__ import annotations

from fricmb.scene._bodies import Driven
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._rigid import angle_of, plane_motion, start_angle


class PlaneJoint(Joint):
    """A joint between two points in the plane."""

    def __post_init__(self) -> None:
        super().__post_init__()
        for argument, end in (("a", self.a), ("b", self.b)):
            if self.friction is not None and isinstance(end, Driven) and not end.rests_along("z"):
                self._refuse(
                    argument,
                    end.end_name,
                    "an end that stays in the plane where there is friction (it moves along 'z': slip across would be"
                    " part of the cone; of a RollerOnLine it is the second value of slide)",
                )

    def apart(self) -> tuple[LinearForm, LinearForm]:
        """Components of the vector from b to a."""
        (ax, ay), (bx, by) = plane_motion(self, "a", self.a), plane_motion(self, "b", self.b)
        return ax - bx, ay - by

    def angles(self) -> tuple[LinearForm, LinearForm]:
        """Angles of both ends."""
        return angle_of(self, "a", self.a), angle_of(self, "b", self.b)

    def kept_angle(self) -> LinearForm:
        """Relative angle less its declared start."""
        a, b = self.angles()
        return a - b - LinearForm((), start_angle(self.a) - start_angle(self.b))


class BetweenPoints(PlaneJoint):
    """A joint that sees the vector between its two points alone."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The vector between the points."""
        return self.apart()
