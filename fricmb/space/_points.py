"""Joints that hold points together or apart: universal joint, weld, rod."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import kept_distance
from fricmb.space._joint import PARALLEL, SpaceJoint
from fricmb.space._turn import dot


@dataclass(frozen=True, eq=False)
class Universal(SpaceJoint):
    """A universal joint: two points stay together, and an axis of a stays at right angles to an axis of b.

    Reaction: force (x, y, z) on a, then the torque about the direction at right angles to both axes.

    Parameters
    ----------
    name : str
    a, b : ends
    axis_a, axis_b : (float, float, float)
        The pin fixed in a and that fixed in b: in space, as the bodies are declared, at right angles.

    Notes
    -----
    Its pins are free of friction.  For dry ones let the cross be a body of its own, with a :class:`Revolute` to either
    side: each pin then has its own load.
    """

    only_relative: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis_a", "axis_b")
    directions: ClassVar[tuple[str, ...]] = ("axis_a", "axis_b")
    _: KW_ONLY
    axis_a: Any
    axis_b: Any

    def _check_own(self) -> None:
        super()._check_own()
        if abs(self.direction("axis_a") @ self.direction("axis_b")) > PARALLEL:
            raise SceneError(f"{self._label()}: axis_a and axis_b must be at right angles")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and both pins."""
        a, b = self.direction("axis_a"), self.direction("axis_b")
        return (*self.apart(), *self.carried("a", a), *self.carried("b", b))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance; pins at right angles."""
        return (*x[0:3], dot(x[3:6], x[6:9]))


@dataclass(frozen=True, eq=False)
class Fixed(SpaceJoint):
    """A weld: two points stay together, and the bodies keep their relative orientation.

    Reaction: force (x, y, z) and torque on a, about the axes of space as the bodies are declared.

    Parameters
    ----------
    name : str
    a, b : ends
        Of rigid bodies of ``fm.space``, or the ground.
    """

    only_relative: ClassVar[bool] = True

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points; three directions of a, three of b."""
        held = (self.carried(argument, row) for argument in ("a", "b") for row in np.eye(3))
        return (*self.apart(), *(form for forms in held for form in forms))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance, no turn about any of the directions."""
        a, b = (x[3:6], x[6:9], x[9:12]), (x[12:15], x[15:18], x[18:21])
        return (*x[0:3], dot(a[1], b[2]), dot(a[2], b[0]), dot(a[0], b[1]))


@dataclass(frozen=True, eq=False)
class Rod(SpaceJoint):
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
