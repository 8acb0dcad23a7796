"""Joints along an axis: sleeve and guide."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.space._joint import AxisJoint
from fricmb.space._turn import dot, triad


class Guided(AxisJoint):
    """What a sleeve and a guide share: a moves along an axis that is fixed in b."""

    only_relative: ClassVar[bool] = True

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, axis of a, two directions of b across."""
        e = self.axis_unit()
        u, w = triad(e)
        return (*self.apart(), *self.carried("a", e), *self.carried("b", u), *self.carried("b", w))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance across the axis, which stays at right angles to both directions."""
        apart, e, u, w = x[0:3], x[3:6], x[6:9], x[9:12]
        return dot(apart, u), dot(apart, w), -dot(e, w), dot(e, u)


@dataclass(frozen=True, eq=False)
class Cylindrical(Guided):
    """A sleeve: a turns about, and slides along, an axis through b that is fixed in b.

    Reaction: forces on a along two directions u, w at right angles to the axis e, ``u x w = e``, then torques about
    them.

    Parameters
    ----------
    name : str
    a, b : ends
        Of bodies of ``fm.space``: b is a RigidBody, or the ground.
    axis : (float, float, float)
        In space, as the bodies are declared.

    Raises
    ------
    SceneError
        If b is a rotor, or the axis is not that of a rotor a.
    """


@dataclass(frozen=True, eq=False)
class Prismatic(Guided):
    """A guide: a slides along an axis through b that is fixed in b, and keeps its orientation relative to b.

    Reaction: forces on a along two directions u, w at right angles to the axis e, ``u x w = e``, then torques about u,
    w and e.

    Parameters
    ----------
    name : str
    a, b : ends
        Of rigid bodies of ``fm.space``, or the ground.
    axis : (float, float, float)
        In space, as the bodies are declared.
    """

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """As of a sleeve, then direction u of a."""
        return (*super().local_coordinates(), *self.carried("a", triad(self.axis_unit())[0]))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """As of a sleeve, and no turn."""
        return (*super().define_constraint(x), dot(x[12:15], x[9:12]))
