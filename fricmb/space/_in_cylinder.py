"""A ball in a tube: it rolls or slides on the inside of a cylinder."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import kept_distance
from fricmb.scene._one_sided import OneSided
from fricmb.scene._part import GROUND
from fricmb.scene._space_body import check_triple
from fricmb.space._ball import Ball
from fricmb.space._joint import SpaceJoint
from fricmb.space._turn import triad
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class InCylinder(OneSided, SpaceJoint):
    """A ball touches the inside of a fixed cylinder, and slides or rolls on it in two directions.

    Reaction: force on the ball, inward.  Friction acts where it touches, in the directions "around" (counter-clockwise
    about the axis) and "along" the axis; sticking is rolling.

    Parameters
    ----------
    name : str
    a : Ball
    axis : (float, float, float)
        Direction of the cylinder.
    through : (float, float, float)
        A point of its axis; default: the origin.
    radius : float
        Of the cylinder, more than that of the ball.
    push_only, when_lost : bool, str
        As of :class:`OnPlane`: where the cylinder would have to pull, contact is lost.
    friction : FrictionLaw, optional
        In two directions; normal force: magnitude of the reaction.

    Raises
    ------
    SceneError
        If ``a`` is no ball, or a value is not accepted.

    Notes
    -----
    With the ball's radius R and the unit vectors rho outward, t around and e along the axis, slip is ``r' . t + R omega
    . e`` and ``r' . e - R omega . t``.  A ball that rolls in an upright tube does not fall out: it goes up and down at
    ``sqrt(2/7)`` of the rate at which it goes round (the golfer's dilemma; M. Gualtieri et al., Am. J. Phys. 74 (2006)
    497-501).

    Examples
    --------
    >>> import fricmb as fm
    >>> ball = fm.space.Ball("ball", mass=0.05, radius=0.02, position=(0.13, 0, 0), velocity=(0, 1.17, 0.1),
    ...     angular_velocity=(0, 5.0, -58.5))
    >>> tube = fm.space.InCylinder("tube", ball, axis=(0, 0, 1), radius=0.15, friction=fm.laws.Coulomb(mu_s=2.0))
    >>> weight = fm.Gravity("g", acceleration={"z": -9.81})
    >>> sol = fm.simulate(fm.Scene("ball in a tube", [ball, tube, weight]), t_end=1.3052, rtol=1e-8)
    >>> round(float(sol["ball.z"][-1]), 4)  # a whole period: back where it was
    0.0
    """

    only_relative: ClassVar[bool] = False
    slip_rows: ClassVar[int] = 2
    directions: ClassVar[tuple[str, ...]] = ("axis",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis", "through")
    _: KW_ONLY
    axis: Any
    through: Any = (0.0, 0.0, 0.0)
    radius: Any

    def _check_own(self) -> None:
        if self.b is not GROUND:
            self._refuse("b", self.b, "left out: the cylinder is fixed")
        if not isinstance(self.a, Ball):
            self._refuse("a", self.a.end_name, "a Ball of fm.space")
        self._set("through", check_triple(self, "through", self.through))
        self._set("radius", self._number("radius", self.radius, above=0.0))
        if float(value_of(self.radius)) <= float(value_of(self.a.radius)):
            raise SceneError(f"{self._label()}: radius must be more than that of the ball, {value_of(self.a.radius):g}")

    def labels(self) -> tuple[str, ...]:
        """Directions of slip: "around" and "along"."""
        return ("around", "along")

    def frame(self) -> Floats:
        """Two directions across the axis and the axis, as rows (3, 3)."""
        e = self.direction("axis")
        return np.array([*triad(e), e])

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Place of the ball's centre about the axis, turn of its surface, distance R_c - R."""
        ball: Any = self.a
        start, own = (float(c) for c in value_of(self.through)), float(value_of(ball.radius))
        place = [ball.motion(c) - LinearForm((), s) for c, s in zip("xyz", start, strict=True)]
        turned = [form * own for form in ball.spins()]
        free = LinearForm((), float(value_of(self.radius)) - own)
        return (*self.seen(place), *self.seen(turned), free)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance to the wall, scaled to unit slope inward; kept 0."""
        (outward,) = kept_distance(x[0:2], x[6])
        return (-outward,)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Velocity of the material where the ball touches: around the axis, and along it."""
        import sympy

        off = sympy.sqrt(x[0] ** 2 + x[1] ** 2)
        t = (-x[1] / off, x[0] / off)
        return (*t, 0, 0, 0, 1), (0, 0, 1, -t[0], -t[1], 0)
