"""What joints in space share: points that meet, and directions that each side carries."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import GROUND, LETTERS, End
from fricmb.scene._space_body import SpaceBody, check_triple
from fricmb.space._directors import RigidBody
from fricmb.space._rotor import Rotor
from fricmb.space._turn import triad, unit
from fricmb.values import value_of

Forms = tuple[LinearForm, LinearForm, LinearForm]
#: A rotor's axis and that of its joint are the same to this.
PARALLEL = 1e-9


def constant(vector: Any) -> Forms:
    """A direction that never changes."""
    x, y, z = (LinearForm((), float(c)) for c in vector)
    return x, y, z


class SpaceJoint(Joint):
    """A joint between two ends in space."""

    #: Arguments that are directions in space.
    directions: ClassVar[tuple[str, ...]] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for argument in ("a", "b"):
            end: End = getattr(self, argument)
            if end.letters is not None and set(end.letters) != set(LETTERS):
                accepted = "a body of fm.space, one of its points, fm.space.ground_point(x, y, z) or GROUND"
                self._refuse(argument, end.end_name, accepted)
        for argument in self.directions:
            self._set(argument, check_triple(self, argument, getattr(self, argument)))
            self.direction(argument)
        self._check_own()
        self.local_coordinates()

    def _check_own(self) -> None:
        """What a type asks of its ends and numbers, before its coordinates are formed."""

    def direction(self, argument: str) -> Floats:
        """A declared direction (3,), a unit vector."""
        return unit(self._label(), argument, value_of(getattr(self, argument)))

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The vector between the points."""
        return self.apart()

    @property
    def relative(self) -> bool:
        """Whether the joint sees no more than the relative motion of two ends that turn."""
        ends = (self.a.owner, self.b.owner)
        return self.only_relative and all(isinstance(owner, SpaceBody) or owner is GROUND for owner in ends)

    def frame(self) -> Floats:
        """Directions of the fixed part of the joint, as rows (3, 3)."""
        return np.eye(3)

    def seen(self, forms: Any) -> Forms:
        """Components of a vector along the directions of :meth:`frame`."""
        x, y, z = (
            sum((form * float(c) for form, c in zip(forms, row, strict=True)), LinearForm()) for row in self.frame()
        )
        return x, y, z

    def apart(self) -> Forms:
        """The vector from b to a."""
        x, y, z = (self.a.motion(c) - self.b.motion(c) for c in LETTERS)
        return x, y, z

    def carried(self, argument: str, direction: Floats) -> Forms:
        """A direction (3,) of space at the declared start, fixed from then on in the body of an end.

        Raises
        ------
        SceneError
            If the body has no such direction: a rotor has its axis alone, a ball none.
        """
        owner = getattr(self, argument).owner
        if isinstance(owner, RigidBody):
            x, y, z = owner.direction_forms(owner.start_rotation().T @ direction)
            return x, y, z
        if isinstance(owner, Rotor):
            along = float(owner.start_axis() @ direction)
            if abs(abs(along) - 1.0) > PARALLEL:
                raise SceneError(
                    f"{self._label()}: the axis of the joint must be that of the Rotor {owner.name!r},"
                    f" {tuple(owner.start_axis().tolist())}, got {tuple(direction.tolist())}; what is fixed beside its"
                    " axis cannot be told from a rotor's coordinates: take a fm.space.RigidBody"
                )
            x, y, z = (form * float(np.sign(along)) for form in owner.axis_forms())
            return x, y, z
        if isinstance(owner, SpaceBody):
            self._refuse(argument, owner.name, f"a body that has directions; a {type(owner).__name__} has none")
        return constant(direction)


@dataclass(frozen=True, eq=False)
class AxisJoint(SpaceJoint):
    """A joint about or along an axis that both ends carry."""

    directions: ClassVar[tuple[str, ...]] = ("axis",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis")
    _: KW_ONLY
    axis: Any

    def _check_own(self) -> None:
        if isinstance(self.a.owner, Rotor) and isinstance(self.b.owner, Rotor):
            raise SceneError(
                f"{self._label()}: one of a and b must be a fm.space.RigidBody or the ground; both are rotors, which"
                " have no directions beside their axes to hold one another by"
            )

    def axis_unit(self) -> Floats:
        """The axis (3,) at the declared start."""
        return self.direction("axis")

    def turn(self) -> tuple[LinearForm, ...]:
        """What tells the rate of a about the axis relative to b, behind :meth:`hinge`: eight forms.

        Two directions across and a spin, of the end whose axis the hinge takes (one or the other is 0); and 1, or -1
        where that end is b.
        """
        e, still = self.axis_unit(), LinearForm()
        argument, sign = ("b", -1.0) if isinstance(self.b.owner, Rotor) else ("a", 1.0)
        owner = getattr(self, argument).owner
        side = LinearForm((), sign)
        if isinstance(owner, Rotor):
            spin = owner.spin_form() * (sign * float(np.sign(owner.start_axis() @ e)))
            return (*(still for _ in range(6)), spin, side)
        u, w = triad(e)
        return (*self.carried(argument, u), *self.carried(argument, w), still, side)

    def hinge(self) -> tuple[LinearForm, ...]:
        """An axis e of one end, and two directions u, w of the other, ``u x w = e`` at the start: nine forms.

        Of the end that is a rotor the axis is taken.  With the axis of b it is taken against its direction, so that
        ``-e . w`` and ``e . u`` are the turns of a about u and w all the same.
        """
        e = self.axis_unit()
        u, w = triad(e)
        if isinstance(self.b.owner, Rotor):
            pair = (*self.carried("a", u), *self.carried("a", w))
            return (*(form * -1.0 for form in self.carried("b", e)), *pair)
        return (*self.carried("a", e), *self.carried("b", u), *self.carried("b", w))
