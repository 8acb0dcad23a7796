"""Joints along an axis: sleeve and guide."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.space._bearing import end_forces, lever
from fricmb.space._joint import AxisJoint
from fricmb.space._turn import cross, dot, triad


@dataclass(frozen=True, eq=False)
class Guided(AxisJoint):
    """What a sleeve and a guide share: a moves along an axis that is fixed in b."""

    only_relative: ClassVar[bool] = True
    takes_friction: ClassVar[bool] = True
    _: KW_ONLY
    length: Any = 0.0

    def _check_own(self) -> None:
        super()._check_own()
        self._number("length", self.length, minimum=0.0)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, axis of a, two directions of b across."""
        e = self.axis_unit()
        u, w = triad(e)
        return (*self.apart(), *self.carried("a", e), *self.carried("b", u), *self.carried("b", w))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance across the axis, which stays at right angles to both directions."""
        apart, e, u, w = x[0:3], x[3:6], x[6:9], x[9:12]
        return dot(apart, u), dot(apart, w), -dot(e, w), dot(e, u)

    def slides(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Factors of the rates of x[0:3] in the velocity along the axis, which goes through both points."""
        return cross(x[6:9], x[9:12])


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
    radius : float
        Of the sleeve, where there is friction: slip has two directions, "turn", radius times the relative angular
        velocity about the axis, and "slide", the velocity along it.
    length : float
        Of the sleeve, the point of a in its middle: the torque across the axis is borne by two forces that far apart,
        and adds to the normal force.  0: the torque brings no friction.
    friction : FrictionLaw, optional
        In two directions; normal force ``|F/2 + M x e/length| + |F/2 - M x e/length|`` with force F and torque M of the
        reaction.

    Raises
    ------
    SceneError
        If b is a rotor, or the axis is not that of a rotor a.
    """

    slip_rows: ClassVar[int] = 2
    _: KW_ONLY
    radius: Any = 0.0

    def _check_own(self) -> None:
        super()._check_own()
        self._number("radius", self.radius, minimum=0.0)
        if self.friction is not None:
            self._number("radius", self.radius, above=0.0)

    def labels(self) -> tuple[str, ...]:
        """What a does in the sleeve."""
        return ("turn", "slide")

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Of what holds; with friction also what turns of a about the axis."""
        return (*super().local_coordinates(), *(self.turn()[:7] if self.friction is not None else ()))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Constraints of the axis, kept 0."""
        return super().define_constraint(x[0:12])

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the sleeve's surface: ``omega . e = (u' . w - w' . u)/2`` of two directions across, and along."""
        u, w, own_u, own_w = x[6:9], x[9:12], x[12:15], x[15:18]
        other = [*(-c / 2 for c in w), *(c / 2 for c in u)]
        own = [*(c / 2 for c in own_w), *(-c / 2 for c in own_u), 1]
        turn = tuple(self.radius * factor for factor in (*(0,) * 6, *other, *own))
        return turn, (*self.slides(x), *(0,) * 16)

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Both ends of the sleeve."""
        from fricmb.laws import norm

        return sum(norm(end) for end in end_forces((lam[0], lam[1]), (lam[2], lam[3]), self.length))


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
    length, width : float
        Of the guide: a is carried by four shoes, ``length`` apart along the axis and ``width`` apart along u, the point
        of a in the middle.  At the start u is as near as can be to the axis of space most nearly at right angles to the
        guide; of one along x, y or z it is y, z or x.  Torques are borne by forces that far apart and add to the normal
        force; 0: they bring no friction.
    friction : FrictionLaw, optional
        Normal force: the sum over the shoes of ``|(F_u/2 +- M_w/length, F_w/2 -+ M_u/length)/2 +- (0, M_e/width)/2|``.
    """

    _: KW_ONLY
    width: Any = 0.0

    def _check_own(self) -> None:
        super()._check_own()
        self._number("width", self.width, minimum=0.0)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """As of a sleeve, then direction u of a."""
        return (*super().local_coordinates(), *self.carried("a", triad(self.axis_unit())[0]))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """As of a sleeve, and no turn."""
        return (*super().define_constraint(x), dot(x[12:15], x[9:12]))

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Along the axis."""
        return self.slides(x)

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """All four shoes."""
        from fricmb.laws import norm

        twist = lever(lam[4], self.width) / 2
        ends = end_forces((lam[0], lam[1]), (lam[2], lam[3]), self.length)
        return sum(norm([u / 2, w / 2 + sign * twist]) for u, w in ends for sign in (1, -1))
