"""Friction of constant size about or along the axis of a joint in space."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.laws import FrictionLaw
from fricmb.scene._dry_friction import law_of_limits
from fricmb.scene._forms import LinearForm
from fricmb.scene._one_coordinate import joint_ends
from fricmb.scene._part import GROUND, End
from fricmb.space._guides import Cylindrical, Prismatic
from fricmb.space._joint import AxisJoint
from fricmb.space._revolute import Revolute
from fricmb.space._turn import cross, triad
from fricmb.values import is_one_of

#: What may be rubbed: the angle about the axis, or the distance along it.
ANGLE, SLIDE = "angle", "slide"


@dataclass(frozen=True, eq=False, init=False)
class DryFriction(AxisJoint):
    """Dry friction in space independent of any load: a torque about an axis, or a force along it.

    The part constrains nothing and stands beside the joint that does; see :class:`fricmb.DryFriction` for coordinates
    in the plane and along letters (which serve bodies in space as well).

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Rotor, RigidBody, a point of one, or GROUND
        Ends; b defaults to GROUND, beside a joint to its other end.
    axis : (float, float, float), Revolute, Prismatic or Cylindrical
        In space, as the bodies are declared; a joint stands for its own axis.
    along : "angle" or "slide", optional
        The coordinate that rubs: the angle about the axis, or the distance along it, which is fixed in b.  Default: the
        one that the joint leaves free (of a Cylindrical it must be given); "angle" where no joint is given.
    static, kinetic : float, Parameter or expression of parameters
        Torque (force) that breaks away, and that of slip (None: follows ``static``).
    law : FrictionLaw, optional
        In place of both, any law of one direction: its coefficients are torques (forces).
    load : float, optional
        Factor of the limits, 1 by default.

    Raises
    ------
    SceneError
        If ends, axis or values are not accepted.

    Notes
    -----
    About the axis e the rate is ``omega . e`` of a relative to b, along it the rate of ``(a - b) . e``.  Equations as
    of :class:`fricmb.DryFriction`.  Parameters of a scene are those of the law: ``"dry.friction.mu_s"``.

    Examples
    --------
    A wheel runs out against the drag of its seal:

    >>> import fricmb as fm
    >>> wheel = fm.space.Rotor("wheel", mass=2.0, inertia_across=0.1, inertia_axial=0.2, spin=6.0)
    >>> axle = fm.space.Revolute("axle", wheel, axis=(0, 0, 1))
    >>> seal = fm.space.DryFriction("seal", wheel, axis=axle, static=0.3)
    >>> sol = fm.simulate(fm.Scene("wheel", [wheel, axle, seal]), t_end=10.0)
    >>> round(float(sol.events[0].t), 9)  # C spin / M
    4.0
    """

    constrains: ClassVar[bool] = False
    takes_friction: ClassVar[bool] = True
    only_relative: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("load",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis", "along")

    _: KW_ONLY
    along: str
    load: Any

    def __init__(
        self,
        name: str,
        a: End,
        b: End = GROUND,
        *,
        axis: Any = None,
        along: str | None = None,
        static: Any = None,
        kinetic: Any = None,
        law: FrictionLaw | None = None,
        load: Any = 1.0,
        friction: FrictionLaw | None = None,
    ) -> None:
        self._set("name", name)
        if axis is None:
            raise SceneError(f"{self._label()}: axis must be given: three numbers, or a joint of fm.space")
        kinds: tuple[str, ...] = (ANGLE, SLIDE)
        if isinstance(axis, Revolute | Prismatic | Cylindrical):
            a, b = joint_ends(self, a, b, axis)
            kinds = (ANGLE,) if isinstance(axis, Revolute) else (SLIDE,) if isinstance(axis, Prismatic) else kinds
            along = kinds[0] if along is None and len(kinds) == 1 else along
            axis = axis.axis
        elif along is None:
            along = ANGLE
        if not is_one_of(along, *kinds):
            self._refuse("along", along, " or ".join(repr(kind) for kind in kinds))
        for field, value in (("a", a), ("b", b), ("axis", axis), ("along", along), ("load", load)):
            self._set(field, value)
        self._set("friction", law_of_limits(self, static, kinetic, friction if law is None else law))
        self.__post_init__()

    @property
    def static(self) -> float:
        """Torque (force) that breaks away at rest."""
        assert self.friction is not None
        return float(self.friction.break_away())

    @property
    def kinetic(self) -> float:
        """Torque (force) of slip, in the limit of slow slip."""
        assert self.friction is not None
        return float(self.friction.slip_limit())

    def labels(self) -> tuple[str, ...]:
        """Names of the coordinates along which friction acts."""
        return (self.along,)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """About the axis: it, two directions across, what turns.  Along it: the distance, two directions of b."""
        if self.along == ANGLE:
            return (*self.hinge(), *self.turn())
        u, w = triad(self.axis_unit())
        return (*self.apart(), *self.carried("b", u), *self.carried("b", w))

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """``omega . e = (u' . w - w' . u)/2`` of two directions across; or the rate of ``(a - b) . (u x w)``."""
        if self.along == ANGLE:
            u, w, own_u, own_w, side = x[3:6], x[6:9], x[9:12], x[12:15], x[16]
            one = [*(c / 2 for c in own_w), *(-c / 2 for c in own_u), 1]
            other = [*(-side * c / 2 for c in w), *(side * c / 2 for c in u)]
            return (0, 0, 0, *other, *one)
        apart, u, w = x[0:3], x[3:6], x[6:9]
        return (*cross(u, w), *cross(w, apart), *cross(apart, u))

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Factor of the limits."""
        return self.load
