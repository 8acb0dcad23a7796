"""A hinge in space, and its dry journal."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.space._bearing import end_forces
from fricmb.space._joint import AxisJoint
from fricmb.space._turn import cross, dot


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
    _: KW_ONLY
    radius: Any = 0.0
    length: Any = 0.0
    thrust_radius: Any = 0.0

    def _check_own(self) -> None:
        super()._check_own()
        for argument in ("radius", "length", "thrust_radius"):
            self._number(argument, getattr(self, argument), minimum=0.0)
        if self.friction is not None:
            self._number("radius", self.radius, above=0.0)

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

        u, w, force = x[6:9], x[9:12], lam[0:3]
        ends = end_forces((dot(force, u), dot(force, w)), (lam[3], lam[4]), self.length)
        thrust = self.thrust_radius / self.radius * sympy.Abs(dot(force, cross(u, w)))
        return sum(norm(end) for end in ends) + thrust
