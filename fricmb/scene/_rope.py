"""A rope over a drum: tensions on both sides of a capstan."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.laws import Coulomb, FrictionLaw
from fricmb.scene._axes import check_axis, components, from_vector, is_direction_tuple, is_end
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import GROUND, LETTERS, End
from fricmb.scene._rigid import angle_of, start_place
from fricmb.values import is_list, is_one_of, value_of


@dataclass(frozen=True, eq=False, init=False)
class Rope(Joint):
    """A massless, inextensible rope (belt, band) over a drum on which it sticks or slips.

    Reaction: the mean of the tensions on both sides.  ``sol.force(name)`` is their difference, that at the first end
    less that at the second, so that the tensions are ``reaction + force/2`` and ``reaction - force/2``.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    ends : (end, end)
        Ends of the rope: two of Body, RigidBody, a point of one, ``ground_point(x, y)`` or GROUND.
    axes : (axis, axis)
        For each end the direction in which the rope runs off the drum towards it, a letter or a direction tuple; the
        rope pulls against it.  Directions stay as they are: the ends move along them.
    drum : RigidBody, one of its points, or GROUND
        The drum that the rope is wound on.
    radius : float
        Radius of a drum that turns: > 0 if its counter-clockwise rotation carries the rope from the first end to the
        second, < 0 if from the second to the first.
    angle : float
        Angle of wrap on the drum, in radians, > 0.
    friction : float or Coulomb
        Coefficient of friction mu of the rope on the drum; a law with mu_s > mu_k holds more before it slips.
    length : float, optional
        Sum of the distances of both ends from the drum along the directions; default: as the ends are declared here,
        also where a scene gives them other positions later.
    when_slack : "end" or "open"
        Where a tension would have to be negative the run ends with an error that says so, or goes on without the rope
        and ends with an error where that is taut again.

    Raises
    ------
    SceneError
        If ends, directions or values are not accepted.

    Notes
    -----
    A piece of rope on an angle ``d phi`` is pressed on the drum by ``T d phi``; the tensions T1 and T2 are in
    ``e^(-mu angle) <= T1/T2 <= e^(mu angle)``, and at the limit where the rope slips (L. Euler, Remarques sur l'effet
    du frottement dans l'equilibre, Mem. Acad. Sci. Berlin 18 (1769) 265-278).  With the mean tension T and the
    difference D that is ``|D| <= 2 tanh(mu angle/2) T``: one set-valued relation, exact for any angle, with no chain of
    links.  Before it slips as a whole, parts of an elastic rope creep; one that does not stretch does not.

    Parameters of a scene are ``"rope.mu"``, ``"rope.angle"`` and, of a law with mu_s > mu_k, ``"rope.friction.mu_s"``:
    how many times the difference at break-away is that of slip.

    Examples
    --------
    Half a turn on a fixed bollard holds e^(mu pi) times the pull:

    >>> import math
    >>> import fricmb as fm
    >>> ship, hand = fm.Body("ship", mass=10.0), fm.Body("hand", mass=1.0)
    >>> rope = fm.Rope("rope", (ship, hand), axes=("x", "x"), angle=math.pi, friction=0.5)
    >>> pull = fm.Force("pull", hand, axis="x", value=10.0)
    >>> wind = fm.Force("wind", ship, axis="x", value=10.0 + 10.0 * fm.t)
    >>> sol = fm.simulate(fm.Scene("mooring", [ship, hand, rope, pull, wind]), t_end=5.0, rtol=1e-9)
    >>> sol.events[0].kind, abs(float(sol.events[0].t) + 1.0 - math.exp(0.5 * math.pi)) < 1e-9
    ('slip', True)
    """

    takes_friction: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("angle",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "drum", "axes", "when_slack")

    _: KW_ONLY
    axes: Any
    drum: Any
    radius: Any
    angle: Any
    mu: Any
    length: Any
    when_slack: str

    def __init__(
        self,
        name: str,
        ends: Any = None,
        *,
        axes: Any,
        drum: Any = GROUND,
        radius: Any = 0.0,
        angle: Any,
        friction: Any = None,
        length: Any = None,
        when_slack: str = "end",
        a: Any = None,
        b: Any = None,
        mu: Any = None,
    ) -> None:
        self._set("name", name)
        if ends is not None and (not is_list(ends) or len(ends) != 2):
            self._refuse("ends", ends, "two ends, such as (a, b)")
        first, second = (a, b) if ends is None else ends
        self._set("a", is_end(self, "ends", first))
        self._set("b", is_end(self, "ends", second))
        self._set("axes", self._both(axes))
        self._set("drum", is_end(self, "drum", drum))
        for field, value in (("radius", radius), ("angle", angle), ("length", length), ("when_slack", when_slack)):
            self._set(field, value)
        self._set("mu", mu)
        self._set("friction", friction)
        if mu is None:
            self._of_friction(friction)
        self.__post_init__()

    def __post_init__(self) -> None:
        if not (self.a.movable or self.b.movable):
            names = f"{self.a.end_name!r} and {self.b.end_name!r}"
            raise SceneError(f"{self._label()}: one end must have degrees of freedom; of ends = {names} none has")
        if self.a.owner is self.b.owner:
            self._refuse("ends", self.a.owner.name, "of different parts")
        if not is_one_of(self.when_slack, "end", "open"):
            self._refuse("when_slack", self.when_slack, "'end' or 'open'")
        for argument in ("radius", "mu"):
            minimum = 0.0 if argument == "mu" else None
            self._set(argument, self._number(argument, getattr(self, argument), minimum=minimum))
        self._set("angle", self._number("angle", self.angle, above=0.0))
        turns = self.drum.owner is not GROUND
        if turns and value_of(self.radius) == 0.0:
            self._refuse("radius", self.radius, "given for a drum that turns, with its sign")
        if self.length is None:
            self._set("length", sum(self._start(end, axis) for end, axis in self._sides()))
        self._set("length", self._number("length", self.length))
        self.local_coordinates()

    # -- fields -------------------------------------------------------------------------------------------------
    def _both(self, axes: Any) -> tuple[Any, Any]:
        entries = tuple(axes) if is_list(axes) or isinstance(axes, str) else ()
        if len(entries) != 2 or is_direction_tuple(axes):
            self._refuse("axes", axes, "two directions, one for each end, letters or direction tuples")
        first, second = (check_axis(self, "axes", entry) for entry in entries)
        return first, second

    def _of_friction(self, friction: Any) -> None:
        """The coefficient, and what a law of more break-away holds more."""
        if friction is None:
            raise SceneError(f"{self._label()}: friction must be given, a coefficient or fm.laws.Coulomb(mu_s=, mu_k=)")
        if not isinstance(friction, FrictionLaw):
            self._set("mu", self._number("friction", friction, minimum=0.0))
            self._set("friction", Coulomb(mu_s=1.0))
            return
        if not isinstance(friction, Coulomb):
            self._refuse("friction", friction, "a coefficient or fm.laws.Coulomb(mu_s=, mu_k=)")
        self._set("mu", friction.mu_s if friction.mu_k is None else friction.mu_k)
        half = float(value_of(self._number("angle", self.angle, above=0.0))) / 2
        least = math.tanh(friction.slip_limit() * half)
        more = math.tanh(friction.break_away() * half) / least if least > 0.0 else 1.0
        if least == 0.0 and friction.break_away() > 0.0:
            self._refuse("friction", friction, "a law with mu_k > 0, or mu_s = mu_k = 0")
        self._set("friction", Coulomb(mu_s=max(more, 1.0), mu_k=1.0) if more > 1.0 else Coulomb(mu_s=1.0))

    def _sides(self) -> tuple[tuple[End, Any], tuple[End, Any]]:
        return (self.a, self.axes[0]), (self.b, self.axes[1])

    def _start(self, end: End, axis: Any) -> float:
        """How far from the origin an end is along its direction, as declared."""
        at = start_place(end)
        if at is None:
            raise SceneError(f"{self._label()}: length must be given where {end.end_name!r} is an end")
        return sum(c * at.get(letter, 0.0) for letter, c in self._vector(end, axis))

    def _vector(self, end: End, axis: Any) -> tuple[tuple[str, float], ...]:
        if end.owner is not GROUND:
            return components(self, "axes", axis, end, GROUND)
        if isinstance(axis, str):
            return ((axis, 1.0),)
        length = math.hypot(*value_of(axis))
        return tuple((letter, float(c / length)) for letter, c in zip(LETTERS, value_of(axis), strict=False))

    # -- what a joint states ------------------------------------------------------------------------------------
    @property
    def one_sided(self) -> bool:
        """True: a rope only pulls."""
        return True

    @property
    def hands_over(self) -> bool:
        """As ``when_slack``."""
        return self.when_slack == "open"

    def undefined(self, values: Mapping[str, float]) -> str:
        """"": a rope has a meaning at all positions."""
        return ""

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """How far both ends are out, and the angle of the drum."""
        out = []
        for end, axis in self._sides():
            fixed = end.owner is GROUND
            out.append(
                LinearForm((), self._start(end, axis))
                if fixed
                else from_vector(self._vector(end, axis), end, GROUND, "t").form
            )
        drum = LinearForm() if self.drum.owner is GROUND else angle_of(self, "drum", self.drum)
        return (*out, drum)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Length of the rope less the length between its ends and on the drum; it must not fall below 0."""
        return (self.length - x[0] - x[1],)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the rope on the drum, towards the second end."""
        import sympy

        half = sympy.Rational(1, 2)
        return -half, half, -self.radius

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Largest difference of the tensions in slip."""
        import sympy

        return 2 * sympy.tanh(self.mu * self.angle / 2) * lam[0]
