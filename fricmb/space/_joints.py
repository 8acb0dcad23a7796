"""Joints in space: ball joint, hinge, sleeve, guide, universal joint, weld, rod."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.scene._forms import LinearForm
from fricmb.scene._space_body import check_triple
from fricmb.space._joint import AxisJoint, SpaceJoint
from fricmb.space._turn import cross, dot, triad, unit
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class Spherical(SpaceJoint):
    """A ball joint: two points stay together.  Reaction: force (x, y, z) on a.

    Parameters
    ----------
    name : str
    a, b : ends
        Bodies of ``fm.space`` (their centres of mass), points of them, ``fm.space.ground_point(x, y, z)``, GROUND.

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

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points."""
        return self.apart()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """None."""
        return x


@dataclass(frozen=True, eq=False)
class Revolute(AxisJoint):
    """A hinge: two points stay together, and the bodies turn about one axis.

    Reaction: force (x, y, z) on a, then torques on a about two directions u, w at right angles to the axis e, ``u x w =
    e`` (along the axes of space where e is: of e = z they are x and y).

    Parameters
    ----------
    name : str
    a, b : ends
        A rotor turns about its own axis alone.
    axis : (float, float, float)
        In space, as the bodies are declared.
    radius : float
        Of the journal, where there is friction: slip velocity = radius times the relative angular velocity about the
        axis.
    length : float
        Between the two ends of the bearing, the point of the joint in the middle: the torque across the axis is borne
        by two forces that far apart, and adds to the normal force.  0: the torque brings no friction.
    thrust_radius : float
        At which the force along the axis rubs; 0: it does not.
    friction : FrictionLaw, optional
        Normal force ``|F_r/2 + M x e/length| + |F_r/2 - M x e/length| + thrust_radius/radius |F . e|``, with the force
        F (F_r across the axis) and the torque M of the reaction.

    Raises
    ------
    SceneError
        If a rotor's axis is another, or both ends are rotors.

    Examples
    --------
    A wheel on a dry journal runs out evenly:

    >>> import fricmb as fm
    >>> wheel = fm.space.Rotor("wheel", mass=2.0, inertia_across=0.1, inertia_axial=0.2, axis=(0, 1, 0), spin=50.0)
    >>> dry = {"radius": 0.02, "friction": fm.laws.Coulomb(mu_s=0.1)}
    >>> axle = fm.space.Revolute("axle", wheel, axis=(0, 1, 0), **dry)
    >>> sol = fm.simulate(fm.Scene("wheel", [wheel, axle, fm.Gravity("g", acceleration={"z": -9.81})]), t_end=300.0)
    >>> round(float(sol.events[0].t), 4)  # C spin / (mu radius m g)
    254.842
    """

    only_relative: ClassVar[bool] = True
    takes_friction: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis")
    _: KW_ONLY
    axis: Any
    radius: Any = 0.0
    length: Any = 0.0
    thrust_radius: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("axis", check_triple(self, "axis", self.axis))
        for argument in ("radius", "length", "thrust_radius"):
            self._number(argument, getattr(self, argument), minimum=0.0)
        if self.friction is not None:
            self._number("radius", self.radius, above=0.0)
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, axis, two directions across; with friction also what turns about the axis."""
        return (*self.apart(), *self.hinge(), *(self.turn() if self.friction is not None else ()))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance; the axis stays at right angles to both directions."""
        e, u, w = x[3:6], x[6:9], x[9:12]
        return (*x[0:3], -dot(e, w), dot(e, u))

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the journal's surface: ``omega . e = (u' . w - w' . u)/2`` of two directions across."""
        u, w, own_u, own_w, side = x[6:9], x[9:12], x[12:15], x[15:18], x[19]
        one = [*(c / 2 for c in own_w), *(-c / 2 for c in own_u), 1]
        other = [*(-side * c / 2 for c in w), *(side * c / 2 for c in u)]
        return tuple(self.radius * factor for factor in (*(0,) * 6, *other, *one))

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Both ends of the bearing, and the thrust."""
        import sympy

        from fricmb.laws import norm

        u, w, tiny = x[6:9], x[9:12], sympy.Float("1e-300")
        across, force = (dot(lam[0:3], u), dot(lam[0:3], w)), lam[0:3]
        # length = 0: no lever, no force from the torque
        lever = (lam[4], -lam[3])
        ends = [
            norm([
                f / 2 + sign * sympy.Piecewise((m / sympy.Max(self.length, tiny), self.length > 0), (0, True))
                for f, m in zip(across, lever, strict=True)
            ])
            for sign in (1, -1)
        ]  # fmt: skip
        return sum(ends) + self.thrust_radius / self.radius * sympy.Abs(dot(force, cross(u, w)))


@dataclass(frozen=True, eq=False)
class Cylindrical(AxisJoint):
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

    only_relative: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis")
    _: KW_ONLY
    axis: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("axis", check_triple(self, "axis", self.axis))
        self.local_coordinates()

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
class Prismatic(AxisJoint):
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

    only_relative: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis")
    _: KW_ONLY
    axis: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("axis", check_triple(self, "axis", self.axis))
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, axis and direction u of a, both directions of b across."""
        e = self.axis_unit()
        u, w = triad(e)
        return (
            *self.apart(), *self.carried("a", e), *self.carried("b", u), *self.carried("b", w), *self.carried("a", u)
        )  # fmt: skip

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """No distance across the axis, no turn."""
        apart, e, u, w, own = x[0:3], x[3:6], x[6:9], x[9:12], x[12:15]
        return dot(apart, u), dot(apart, w), -dot(e, w), dot(e, u), dot(own, w)


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
    """

    only_relative: ClassVar[bool] = True
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis_a", "axis_b")
    _: KW_ONLY
    axis_a: Any
    axis_b: Any

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("axis_a", check_triple(self, "axis_a", self.axis_a))
        self._set("axis_b", check_triple(self, "axis_b", self.axis_b))
        if abs(self._axes()[0] @ self._axes()[1]) > 1e-9:
            raise SceneError(f"{self._label()}: axis_a and axis_b must be at right angles")
        self.local_coordinates()

    def _axes(self) -> tuple[Any, Any]:
        return tuple(unit(self._label(), n, value_of(getattr(self, n))) for n in ("axis_a", "axis_b"))  # type: ignore

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and both pins."""
        a, b = self._axes()
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

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

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

    def __post_init__(self) -> None:
        super().__post_init__()
        self.local_coordinates()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The distance of the points."""
        return self.apart()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of unit slope along the rod."""
        return ((dot(x, x)) / (2 * self.length) - self.length / 2,)
