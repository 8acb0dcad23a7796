"""Friction of constant size along one coordinate: a torque in a joint, a force between two bodies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fricmb.errors import SceneError
from fricmb.laws import Coulomb, FrictionLaw
from fricmb.scene._axes import Direction, check_axis
from fricmb.scene._contact import Contact
from fricmb.scene._guide_friction import GuideFriction, along_guide
from fricmb.scene._joints import Prismatic
from fricmb.scene._one_coordinate import ANGLE, one_coordinate
from fricmb.scene._part import GROUND, End, Part
from fricmb.scene._turning import relative_angle
from fricmb.values import is_list, value_of


def law_of_limits(part: Part, static: Any, kinetic: Any, law: FrictionLaw | None) -> FrictionLaw:
    """The law of a part whose limits are given, or the law that is given in their place."""
    if law is not None:
        for argument, value in (("static", static), ("kinetic", kinetic)):
            if value is not None:
                part._refuse(argument, value, "left out beside law, whose coefficients are the limits")
        return law
    if static is None:
        given = "" if kinetic is None else ", got kinetic alone"
        raise SceneError(f"{part._label()}: static or law must be given{given}")
    limit = part._number("static", static, minimum=0.0)
    if kinetic is None:
        return Coulomb(mu_s=limit)
    slip = part._number("kinetic", kinetic, minimum=0.0)
    if value_of(slip) > value_of(limit):
        part._refuse("kinetic", kinetic, f"a finite number >= 0 and <= static = {value_of(limit):g}")
    return Coulomb(mu_s=limit, mu_k=slip)


@dataclass(frozen=True, eq=False, init=False)
class DryFriction(Contact):
    """Dry friction independent of any load: up to ``static`` it holds, in slip ``kinetic`` opposes the motion.

    Data sheets and robot descriptions give the friction of seals, preloaded bearings and drives in this form.  The part
    is a contact along one coordinate under the normal force 1, so that the coefficients of its law are forces (about an
    angle, torques).  Sticking, break-away and reversals are located; see ``sol.force(name)`` and ``sol.mode(name)``.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, RigidBody, Driven, a point or GROUND
        Ends; b defaults to GROUND, beside a joint to its other end.
    axis : "x", "y", "z", "angle", tuple of float, Revolute or Prismatic
        Coordinate of a less that of b: along a letter or a direction tuple; "angle" of bodies that turn in the plane.
        A pin stands for the angle of its bodies, a guide for the distance along its line, which may turn: the part is a
        :class:`GuideFriction` then, whose law is ``"dry.friction.mu_s"`` among the parameters.
    static : float, Parameter or expression of parameters
        Force (torque) that breaks away, >= 0.
    kinetic : float, Parameter or expression of parameters, optional
        Force (torque) of slip, at most ``static``; None: follows ``static``.
    law : FrictionLaw, optional
        In place of both, any law of one direction: its coefficients are forces (torques), ``r`` is the relative speed.
        ``static`` and ``kinetic`` are short for ``law=Coulomb(mu_s=static, mu_k=kinetic)``.
    normal_force : float or SymPy expression, optional
        Factor of the limits, 1 by default: for friction per unit of a load, as in :class:`Contact`.
    slide : float or expression in ``fm.t``, optional
        Added to a's velocity relative to b.

    Raises
    ------
    SceneError
        If ends, axis or values are not accepted.

    Notes
    -----
    ``F in [-static, static]`` while ``g = 0``, ``F = -kinetic sign(g)`` else, with the rate g of the coordinate.

    Friction by the load of a joint (``friction=`` of :class:`Revolute`) may stand beside it on the same joint: both
    hold together, and slip sets in where the sum of their limits is reached (how much each of them holds before is not
    determined, and ``sol.stats.notes`` says so).  Joints of robots have both, with Stribeck's and a viscous part: B.
    Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, A survey of models, analysis tools and compensation methods for
    the control of machines with friction, Automatica 30 (1994) 1083-1138.

    Parameters of a scene are those of the law: ``"dry.law.mu_s"`` and ``"dry.law.mu_k"``.

    Examples
    --------
    An arm of 2 kg is let go at 80 degrees; its joint holds it where the moment of its weight is at most 3 N m.

    >>> import math
    >>> import fricmb as fm
    >>> at = math.radians(80)
    >>> arm = fm.RigidBody("arm", mass=2.0, inertia=0.1, angle=at, points={"pin": (0.0, 0.5)},
    ...                    position=(0.5*math.sin(at), -0.5*math.cos(at)))
    >>> pin = fm.Revolute("pin", arm.point("pin"))
    >>> dry = fm.DryFriction("dry", arm, axis=pin, static=3.0)
    >>> sol = fm.simulate(fm.Scene("arm", [arm, pin, dry, fm.Gravity("g")]), t_end=5.0)
    >>> [event.kind for event in sol.events]
    ['reversal', 'stick']
    """

    def __new__(cls, *arguments: Any, axis: Any = None, **given: Any) -> Any:
        """Along a guide of the plane a :class:`GuideFriction`: its line may turn."""
        if not isinstance(axis, Prismatic):
            return super().__new__(cls)
        return _on_guide(cls, axis, *arguments, **given)

    def __init__(
        self,
        name: str,
        a: End,
        b: End = GROUND,
        *,
        axis: Any = None,
        static: Any = None,
        kinetic: Any = None,
        law: FrictionLaw | None = None,
        normal_force: Any = 1.0,
        slide: Any = None,
        axes: Any = None,
    ) -> None:
        self._set("name", name)
        b, axis = one_coordinate(self, a, b, self._given_axis(axis, axes))
        self._set("a", a)
        self._set("b", b)
        self._set("axes", (axis,))
        self._set("law", law_of_limits(self, static, kinetic, law))
        self._set("normal_force", normal_force)
        self._set("slide", slide)
        self.__post_init__()

    @property
    def static(self) -> float:
        """Force (torque) that breaks away at rest."""
        return float(self.law.break_away())

    @property
    def kinetic(self) -> float:
        """Force (torque) of slip, in the limit of slow slip."""
        return float(self.law.slip_limit())

    # -- fields -------------------------------------------------------------------------------------------------
    def _given_axis(self, axis: Any, axes: Any) -> Any:
        """The axis; ``axes`` is how a copy with other values hands it on."""
        if axis is not None and axes is not None:
            self._refuse("axes", axes, "left out beside axis")
        if axes is not None and (not is_list(axes) or len(axes) != 1):
            self._refuse("axes", axes, "one axis; of friction in a plane take a fm.Contact")
        return axis if axes is None else axes[0]

    # -- what a contact asks ------------------------------------------------------------------------------------
    def _checked_axes(self) -> tuple[Any, ...]:
        assert self.axes is not None
        if self.axes[0] == ANGLE:
            self._direction(ANGLE, ANGLE)
            return (ANGLE,)
        if 1 not in self.law.dimensions:
            self._refuse("law", self.law, "a law of one direction of slip")
        return (check_axis(self, "axis", self.axes[0]),)

    def letters_along(self) -> tuple[str, ...] | None:
        """The letter; None where the axis is none."""
        assert self.axes is not None
        return None if self.axes[0] == ANGLE else super().letters_along()

    def _direction(self, axis: Any, label: str) -> Direction:
        if axis == ANGLE:
            return Direction(ANGLE, ((ANGLE, 1.0),), relative_angle(self, self.a, self.b))
        return super()._direction(axis, label)


def _on_guide(
    cls: type[DryFriction], guide: Prismatic, name: str, a: End, b: End = GROUND, *, static: Any = None,
    kinetic: Any = None, law: FrictionLaw | None = None, normal_force: Any = 1.0, slide: Any = None,
) -> GuideFriction:  # fmt: skip
    """As the arguments of :class:`DryFriction` say."""
    part = object.__new__(cls)
    part._set("name", name)
    if slide is not None:
        part._refuse("slide", slide, "left out along a guide")
    load = part._number("normal_force", normal_force, above=0.0)
    return along_guide(part, a, b, guide, law_of_limits(part, static, kinetic, law), load)
