"""Points that roll or slide on a line or a circle."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import kept_distance
from fricmb.scene._one_sided import OneSided
from fricmb.scene._plane_joint import BetweenPoints, PlaneJoint
from fricmb.scene._rigid import angle_of
from fricmb.signal import is_series
from fricmb.values import is_list


@dataclass(frozen=True, eq=False)
class Surface(OneSided, PlaneJoint):
    """What a line and a circle share."""

    only_relative: ClassVar[bool] = True


@dataclass(frozen=True, eq=False)
class RollerOnLine(Surface):
    """A point of a stays on a line through b, fixed in b.  Reaction: force on a along the line's left-hand normal.

    Parameters
    ----------
    name : str
    a, b : ends
    angle : float
        Direction of the line in the axes of b; the normal is 90 degrees further.
    push_only : bool
        The line can push but not pull; where it would have to pull, contact is lost.
    when_lost : str
        "end": the run ends there with an error that says so.  "open": it goes on without this joint, and ends with an
        error where the point meets the line again (impacts are not computed without ``restitution``).  A scene that
        starts with the point away from the line, on the side of the normal, or leaving it, starts open.
    restitution : float, optional
        Coefficient of restitution, from 0 to 1, with ``push_only``: a point that meets the line at speed v leaves it at
        ``restitution`` v.  All contacts hit or held at that instant are solved together (:class:`ImpactLaw`);
        ``when_lost`` is then "open".
    tangential_restitution : float, optional
        Coefficient of restitution along the line, from -1 to 1 (default 0), as far as friction in the impact allows it.
    mu_impact : float, optional
        Coefficient of friction in impacts, >= 0; default: mu_k of a Coulomb law.  Other laws need it.
    slide : number or SymPy expression in ``fm.t``, or two of them
        Velocity of the surface along the line; a second one is that across the plane, where the point is guided: slip
        across is then part of the cone.
    friction : FrictionLaw, optional
        Normal force: magnitude of the reaction.
    """

    only_relative: ClassVar[bool] = True
    _: KW_ONLY
    angle: Any = 0.0
    push_only: bool = False
    slide: Any = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        self._settle("angle")
        several = is_list(self.slide) and not is_series(self.slide)
        given = tuple(self.slide) if several else (self.slide,)
        if len(given) > 2:
            self._refuse("slide", self.slide, "one value, or two: along the line and across the plane")
        checked = tuple(check_expression(self, "slide", value, motions=False) for value in given)
        self._set("slide", checked if several else checked[0])
        self.local_coordinates()

    @property
    def slip_rows(self) -> int:  # type: ignore[override]
        """Along the line, and with a second slide across."""
        return len(self.slide) if is_list(self.slide) else 1

    def _takes_expression(self, field: str) -> bool:
        return field == "slide"

    def drives(self) -> tuple[Any, ...]:
        """The surface's own motion."""
        given = self.slide if is_list(self.slide) else (self.slide,)
        return tuple(("rate", value, 0.0) for value in given) if self.friction is not None else ()

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Distance of the points and angle of b."""
        b = angle_of(self, "b", self.b) if self._turns() else LinearForm()
        return (*self.apart(), b)

    def _turns(self) -> bool:
        try:
            angle_of(self, "b", self.b)
        except SceneError:
            return False
        return True

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance across the line, kept 0."""
        import sympy

        turn = x[2] + self.angle
        return (x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn),)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Along the line, seen from b, less the motion of its surface; and that across."""
        import sympy

        turn = x[2] + self.angle
        across = x[1] * sympy.cos(turn) - x[0] * sympy.sin(turn)
        along = sympy.cos(turn), sympy.sin(turn), across, -1
        return along if len(x) == 4 else ((*along, 0), (0, 0, 0, 0, -1))


@dataclass(frozen=True, eq=False)
class RollerOnCircle(BetweenPoints, Surface):
    """A point of a stays on a circle about b.  Reaction: force on a, outward.

    Parameters
    ----------
    name : str
    a, b : ends
    radius : float
        > 0.
    push_only, when_lost : bool, str
        As of RollerOnLine; the circle pushes outward.
    restitution, tangential_restitution, mu_impact : float, optional
        As of RollerOnLine.
    friction : FrictionLaw, optional
        Normal force: magnitude of the reaction; slip relative to a circle that does not turn.
    """

    positive: ClassVar[tuple[str, ...]] = ("radius",)
    _: KW_ONLY
    radius: Any

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Distance less the radius, scaled to unit slope outward; kept 0."""
        return kept_distance(x, self.radius)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Counter-clockwise along the circle."""
        return -x[1] / self.radius, x[0] / self.radius
