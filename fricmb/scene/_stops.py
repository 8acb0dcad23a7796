"""Springs that cannot pull: stops at the ends of a way, and the play between teeth."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from fricmb.errors import SceneError, shown
from fricmb.scene._axes import check_ends, direction
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._guided_way import along, along_rate, check_way, guide_coordinates
from fricmb.scene._one_coordinate import ANGLE
from fricmb.scene._part import GROUND, End
from fricmb.scene._rigid import angle_of
from fricmb.scene._rigid_stops import RigidBacklash, RigidStop
from fricmb.scene._turning import relative_angle
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class _Touching(Element):
    """What pushes back where a coordinate goes beyond limits.

    With ``restitution=`` the call makes a part that does not give, the class ``_rigid``.
    """

    _rigid: ClassVar[type]

    bends: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("stiffness",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "axis", "guide")

    a: End
    b: End = GROUND
    _: KW_ONLY
    axis: Any = None
    stiffness: Any
    hunt_crossley: Any = 0.0
    damping: Any = 0.0
    damping_depth: Any = None
    guide: Any = None
    angle: Any = None

    def __new__(cls, *arguments: Any, restitution: Any = None, **fields: Any) -> Any:
        """A part of this class, or with a coefficient of restitution one that does not give."""
        if restitution is None:
            return super().__new__(cls)
        for argument in ("stiffness", "hunt_crossley", "damping", "damping_depth"):
            if fields.get(argument) is not None:
                name = shown(arguments[0] if arguments else fields.get("name"))
                raise SceneError(
                    f"{cls.__name__} {name}: {argument} must be left out beside restitution (what is rigid does not"
                    f" give), got {shown(fields[argument])}"
                )
        return cls._rigid(*arguments, restitution=restitution, **fields)

    def __post_init__(self) -> None:
        self._check_axis()
        check_ends(self, self.a, self.b)
        self._check_limits()
        super().__post_init__()
        for argument in ("damping", "hunt_crossley"):
            self._set(argument, self._number(argument, getattr(self, argument), minimum=0.0))
        if self.damping_depth is not None:
            self._set("damping_depth", self._number("damping_depth", self.damping_depth, above=0.0))
        elif value_of(self.damping) > 0.0:
            accepted = "given beside damping, the depth over which that comes in: without it the force would jump"
            self._refuse("damping_depth", None, accepted)
        self.local_coordinates()

    def _check_axis(self) -> None:
        """Refuse an axis that is not accepted, and take what a joint stands for."""
        check_way(self)

    def coordinate(self, x: Any, rates: Any, functions: Any) -> tuple[Any, Any]:
        """What is limited, and its rate, of the local coordinates; ``functions``: NumPy or SymPy."""
        if self.guide is None:
            return x[0], rates[0]
        return along(x, self.angle, functions), along_rate(x, rates, self.angle, functions)

    def _check_limits(self) -> None:
        """Refuse limits that are not accepted."""

    def limits(self) -> tuple[Any, Any]:
        """Lower and upper limit of the coordinate; None where there is none."""
        raise NotImplementedError

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """What is limited; along a guide the distance of its points, and the angle of its line's body."""
        if self.guide is not None:
            return guide_coordinates(self)
        if self.axis == ANGLE:
            return (relative_angle(self, self.a, self.b),)
        return (direction(self, "axis", self.axis, self.a, self.b).form,)

    def depths(self, x: Any, rate: Any) -> tuple[tuple[Any, Any], ...]:
        """How far it is pressed beyond each limit, and the rate of that."""
        lower, upper = self.limits()
        sides = [] if lower is None else [(lower - x, -rate)]
        return (*sides, *([] if upper is None else [(x - upper, rate)]))

    def grip(self, depth: Any, share: Any) -> Any:
        """Force over speed at a depth; ``share``: that of ``damping_depth``, at most 1."""
        return self.stiffness * depth * self.hunt_crossley + self.damping * share**2 * (3 - 2 * share)

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Potential energy of springs that push and cannot pull."""
        import sympy

        place, _ = self.coordinate(x, (0, 0, 0), sympy)
        return sum(self.stiffness * sympy.Max(0, depth) ** 2 / 2 for depth, _ in self.depths(place, 0))

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any:
        """Dissipation function; damping resists separation with at most the force of the spring.

        At faster separation the total force would pull; it is 0 instead, and the energy that the spring gives back is
        lost.
        """
        import sympy

        lost: Any = 0
        for depth, rate in self.depths(*self.coordinate(x, x_dot, sympy)):
            spring = self.stiffness * depth
            grip = self.grip(depth, 0 if self.damping_depth is None else sympy.Min(1, depth / self.damping_depth))
            pressed = sympy.Piecewise((grip * rate**2 / 2, spring + grip * rate > 0), (-spring * rate, True))
            lost += sympy.Piecewise((pressed, depth > 0), (0, True))
        return lost


@dataclass(frozen=True, eq=False)
class Stop(_Touching):
    """Limits of a coordinate: beyond them a spring and a damper push back and never pull, or the ends are rigid.

    With the depth ``d = x - upper`` (``d = lower - x`` at the other end) and its rate d' the force on a is ``max(0,
    stiffness d (1 + hunt_crossley d') + damping s(d) d')``, back between the limits, where ``d > 0``, else 0.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, RigidBody, Driven, a point or GROUND
        Ends; b defaults to GROUND, beside a joint to its other end.
    axis : "x", "y", "z", "angle", tuple of float, Revolute or Prismatic
        The coordinate x: that of a less that of b, as in :class:`DryFriction`; along a guide, that of its line, which
        may turn (``guide`` and ``angle`` keep its name and direction; not with restitution).
    lower, upper : float, optional
        Limits of x, one of them or both, lower < upper.
    stiffness : float
        Stiffness of both ends, force per length (torque per radian), > 0.
    hunt_crossley : float
        Loss that grows with the force of the spring, 1/speed, >= 0.
    damping : float
        Force per speed, >= 0, at a depth of ``damping_depth`` and beyond.
    damping_depth : float
        Depth over which ``damping`` comes in, > 0: ``s(d) = u^2 (3 - 2 u)``, ``u = min(1, d/damping_depth)``.  Required
        with damping, whose force would otherwise jump at the first touch.
    restitution : float
        In place of all these: coefficient of restitution of rigid ends, from 0 to 1.  A body that meets one at speed v
        leaves it at ``restitution`` v.  Impacts are events (see ``sol.impulse(name)`` and ``sol.energy.impact_loss``),
        bounces are followed until they come to rest, and ``sol.reaction(name)`` is the force on a while it is held.

    Raises
    ------
    SceneError
        If ends, axis, limits or values are not accepted.

    Notes
    -----
    Contact begins at ``d = 0`` and ends where the force falls to 0: in a fast separation before the spring is free, so
    that the stop never pulls.  Steps end at both instants; :meth:`Solution.touches` lists them.  K. H. Hunt, F. R. E.
    Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42 (1975) 440-445;
    ``damping`` as of the function IMPACT of MSC Adams.

    Examples
    --------
    A block between two stops, half a period of 10 rad/s in each:

    >>> import fricmb as fm
    >>> block = fm.Body("block", mass=1.0, velocity={"x": 2.0})
    >>> ends = fm.Stop("ends", block, axis="x", lower=-1.0, upper=1.0, stiffness=100.0)
    >>> sol = fm.simulate(fm.Scene("block", [block, ends]), t_end=3.0, rtol=1e-8)
    >>> touches = sol.touches("ends")
    >>> [float(t.round(6)) for t in touches.begin], touches.side
    ([0.5, 1.814159], ['upper', 'lower'])

    Between rigid stops it loses half its speed at each:

    >>> rigid = fm.Stop("ends", block, axis="x", lower=-1.0, upper=1.0, restitution=0.5)
    >>> sol = fm.simulate(fm.Scene("block", [block, rigid]), t_end=3.0, rtol=1e-8)
    >>> [(round(hit.t, 6), hit.side, round(hit.impulse, 6)) for hit in sol.events.of(kind="impact")]
    [(0.5, 'upper', 3.0), (2.5, 'lower', 1.5)]
    """

    _rigid: ClassVar[type] = RigidStop
    _: KW_ONLY
    lower: Any = None
    upper: Any = None

    if TYPE_CHECKING:  # what `__new__` takes as well

        def __init__(
            self, name: str, a: End, b: End = GROUND, *, axis: Any = None, stiffness: Any = None,
            hunt_crossley: Any = 0.0, damping: Any = 0.0, damping_depth: Any = None, guide: Any = None,
            angle: Any = None, lower: Any = None,
            upper: Any = None, restitution: Any = None,
        ) -> None: ...  # fmt: skip

    def _check_limits(self) -> None:
        if self.lower is None and self.upper is None:
            raise SceneError(f"{self._label()}: lower or upper must be given")
        for argument in ("lower", "upper"):
            if getattr(self, argument) is not None:
                self._set(argument, self._number(argument, getattr(self, argument)))
        if self.lower is not None and self.upper is not None and value_of(self.lower) >= value_of(self.upper):
            self._refuse("upper", self.upper, f"above lower = {value_of(self.lower):g}")

    def limits(self) -> tuple[Any, Any]:
        """The limits as declared."""
        return self.lower, self.upper


@dataclass(frozen=True, eq=False)
class Backlash(_Touching):
    """Play: two bodies are free within a gap, and held by a spring and a damper that cannot pull at both ends of it.

    The force on a is that of a :class:`Stop` with the limits ``-gap/2`` and ``gap/2``.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    a, b : Body, RigidBody, Driven, a point or GROUND
        Ends; b defaults to GROUND, beside a joint to its other end.
    axis : "x", "y", "z", "angle", tuple of float, Revolute or Prismatic
        The coordinate: that of a less that of b, as in :class:`Stop`.
    ratio : float, optional
        In place of ``axis``, for two wheels in mesh: radius of b over that of a, not 0 (< 0 for an internal gear or a
        shaft).  The coordinate is then ``angle of a + ratio (angle of b)``, as for a :class:`Gear`.
    gap : float
        The whole play, >= 0: from one flank to the other.
    stiffness : float
        Stiffness of each flank, force per length (torque on a per radian of a), > 0.
    hunt_crossley : float
        Loss that grows with the force of the spring, 1/speed, >= 0.
    damping, damping_depth : float
        Force per speed, >= 0, and the depth over which it comes in, > 0.
    restitution : float
        In place of all these: coefficient of restitution of rigid flanks, as for a :class:`Stop`; then gap > 0.

    Raises
    ------
    SceneError
        If ends, axis, gap or values are not accepted.

    Notes
    -----
    M. Nordin, P.-O. Gutman, Controlling mechanical systems with backlash - a survey, Automatica 38 (2002) 1633-1649,
    section 2: the dead zone with damping, here without its pull.  See :class:`Stop`.

    Examples
    --------
    >>> import fricmb as fm
    >>> motor, load = fm.Body("motor", mass=1.0, velocity={"x": 1.0}), fm.Body("load", mass=1.0)
    >>> mesh = fm.Backlash("mesh", motor, load, axis="x", gap=0.2, stiffness=200.0)
    >>> sol = fm.simulate(fm.Scene("drive", [motor, load, mesh]), t_end=0.4, rtol=1e-8)
    >>> [round(abs(float(sol.velocity(name)[-1])), 6) for name in ("motor.x", "load.x")]
    [0.0, 1.0]
    """

    _rigid: ClassVar[type] = RigidBacklash
    _: KW_ONLY
    gap: Any
    ratio: Any = None

    if TYPE_CHECKING:  # what `__new__` takes as well

        def __init__(
            self, name: str, a: End, b: End = GROUND, *, axis: Any = None, stiffness: Any = None,
            hunt_crossley: Any = 0.0, damping: Any = 0.0, damping_depth: Any = None, guide: Any = None,
            angle: Any = None, gap: Any,
            ratio: Any = None, restitution: Any = None,
        ) -> None: ...  # fmt: skip

    def _check_axis(self) -> None:
        if self.ratio is None:
            super()._check_axis()
            return
        if self.guide is not None or self.angle is not None:
            self._refuse("ratio", self.ratio, "left out along a guide")
        if self.axis is not None:
            self._refuse("ratio", self.ratio, "left out beside axis")
        self._set("ratio", self._number("ratio", self.ratio))
        if value_of(self.ratio) == 0.0:
            self._refuse("ratio", self.ratio, "another than 0")

    def _check_limits(self) -> None:
        self._set("gap", self._number("gap", self.gap, minimum=0.0))

    def limits(self) -> tuple[Any, Any]:
        """Half the gap on each side."""
        return -self.gap / 2, self.gap / 2

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The play, or both angles of wheels in mesh."""
        if self.ratio is None:
            return super().local_coordinates()
        return angle_of(self, "a", self.a), angle_of(self, "b", self.b)

    def coordinate(self, x: Any, rates: Any, functions: Any) -> tuple[Any, Any]:
        """The play and its rate; for wheels in mesh, from both angles."""
        if self.ratio is None:
            return super().coordinate(x, rates, functions)
        return x[0] + self.ratio * x[1], rates[0] + self.ratio * rates[1]
