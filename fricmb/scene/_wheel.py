"""A round body on a line: it slides, rolls, lifts off."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.scene._resistance import RollingResistance, resistance_law
from fricmb.scene._rigid import angle_of
from fricmb.scene._rollers import RollerOnLine


@dataclass(frozen=True, eq=False)
class Wheel(RollerOnLine):
    """A disc centred at a point of a stands on a line fixed in b.  Reaction: force on a along the line's normal.

    With friction it slips where rim and line have different velocities, and rolls where they stick: ``sol.mode(name)``
    is 0 while it rolls, and both changes are located.

    Parameters
    ----------
    name : str
    a : RigidBody or a point of one
        The centre of the disc.
    b : end
        The line goes through it.
    radius : float
        Of the disc, > 0.
    angle : float
        Direction of the line in the axes of b; the disc is on the side of the normal, 90 degrees further.
    push_only, when_lost : bool, str
        As of :class:`RollerOnLine`: whether it may lift off, and what happens then.
    restitution, tangential_restitution, mu_impact : float, optional
        Impacts, as for :class:`RollerOnLine`.
    slide : number or SymPy expression in ``fm.t``
        Velocity of the surface along the line (a belt, a roller table).
    friction : FrictionLaw, optional
        Normal force: magnitude of the reaction.
    rolling_resistance : float or FrictionLaw, optional
        Arm of the torque against rolling, a length: the torque is the arm times the load, at rest at most that.  The
        coefficients of a law (one direction, over the rate of the angle) are arms.

    Raises
    ------
    SceneError
        If ends or values are not accepted.

    Notes
    -----
    With the direction t of the line, the velocity v of the centre and the rate w of the disc, counter-clockwise, slip
    is ``v . t + radius w``, less the surface's own motion.  On a line that falls by alpha a disc with the radius of
    gyration k rolls while ``tan alpha <= mu_s (1 + radius^2/k^2)``.

    With the arm f of rolling resistance a wheel stays on a slope of ``tan alpha <= f/radius``, and rolls down a steeper
    one with ``(g sin alpha - f/radius g cos alpha)/(1 + k^2/radius^2)``.  The resistance is a part of its own beside
    the wheel, ``name_rolling``: ``sol.force("floor_rolling")`` is the torque, ``sol.mode("floor_rolling")`` 0 where the
    wheel does not turn, ``"floor_rolling.friction.mu_s"`` the parameter.

    Examples
    --------
    A disc slides until it rolls, at 2/3 of its first speed:

    >>> import fricmb as fm
    >>> disc = fm.RigidBody("disc", mass=2.0, inertia=0.01, position=(0.0, 0.1), velocity=(3.0, 0.0))
    >>> floor = fm.Wheel("floor", disc, radius=0.1, friction=fm.laws.Coulomb(mu_s=0.2))
    >>> sol = fm.simulate(fm.Scene("bowl", [disc, floor, fm.Gravity("g")]), t_end=2.0)
    >>> event = sol.events[0]
    >>> event.kind, round(float(event.t), 6)  # v/(3 mu g)
    ('stick', 0.509684)
    """

    positive: ClassVar[tuple[str, ...]] = ("radius",)
    _fixed: ClassVar[tuple[str, ...]] = (*RollerOnLine._fixed, "rolling_resistance")
    _: KW_ONLY
    radius: Any
    rolling_resistance: Any = None

    @property
    def slip_rows(self) -> int:  # type: ignore[override]
        """1: slip along the line."""
        return 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if isinstance(self.slide, tuple):
            self._refuse("slide", self.slide, "one value, along the line")
        self.companions()

    def companions(self) -> tuple[RollingResistance, ...]:
        """The resistance against rolling."""
        given = self.rolling_resistance
        if given is None:
            return ()
        law = resistance_law(self, "rolling_resistance", given)
        name = f"{self.name}_rolling"
        return (RollingResistance(name, self.a, self.b, of=self.name, declared=(given,), friction=law),)

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points, angles of b and of a."""
        return (*super().local_coordinates(), angle_of(self, "a", self.a))

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The centre is a radius away from the line."""
        return (super().define_constraint(x)[0] - self.radius,)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the rim on the line, seen from b, less the motion of its surface."""
        import sympy

        turn = x[2] + self.angle
        across = super().define_constraint(x)[0]
        return sympy.cos(turn), sympy.sin(turn), across - self.radius, self.radius, -1
