"""A rope over a drum: tensions on both sides of a capstan, whose spans may stretch and whose ends may be pulled."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError
from fricmb.laws import Coulomb, FrictionLaw
from fricmb.scene._axes import check_axis, is_direction_tuple, is_end
from fricmb.scene._expressions import check_expression, expression_uses
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import GROUND, End
from fricmb.scene._rigid import angle_of
from fricmb.scene._rope_ends import Side, ends_of, out, start_out
from fricmb.signal import is_series
from fricmb.values import is_list, is_one_of, value_of


@dataclass(frozen=True, eq=False, init=False)
class Rope(Joint):
    """A massless rope (belt, band) over a drum on which it sticks or slips; its free spans may stretch.

    ``sol.tensions(name)`` has the tensions on both sides of the drum.  Reaction: their mean; ``sol.force(name)``: their
    difference, that on the first side less that on the second.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    ends : (end, end)
        Ends of the rope: two of Body, RigidBody, a point of one, ``ground_point(x, y)`` or GROUND; or, in place of one
        of them, the tension there: a number >= 0, an expression as in :class:`Force`, or a Signal.
    axes : (axis, axis)
        For each end the direction in which the rope runs off the drum towards it, a letter or a direction tuple; the
        rope pulls against it.  Directions stay as they are: the ends move along them.  A tension has none (None);
        beside one the other end's direction alone will do.
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
        Sum of the distances of both ends from the drum along the directions, spans free of tension; default: as the
        ends are declared here, also where a scene gives them other positions later, and under ``pretension``.
    when_slack : "end" or "open"
        Where a tension would have to be negative the run ends with an error that says so, or goes on without the rope
        and ends with an error where that is taut again.
    stiffness : (float, float), optional
        Stiffness of each free span, EA over its length; None for one that does not stretch, and for a tension.
    damping : (float, float), optional
        Force per speed of each span that stretches, >= 0 (default 0); > 0 where no end is held by the rope itself, as
        nothing else says then how fast a massless rope slips.
    pretension : float, optional
        Tension, as declared, of spans that stretch; default: the tension at the other end where that is a number, else
        0.

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
    links.  Where spans stretch, ``T1 = k1 (x1 - s1) + c1 (x1 - s1)'`` with the place s1 at which the rope leaves the
    drum, and the same on the other side: spans are springs, beside a capstan on which the rope does not stretch (S.-J.
    Hwang, N. C. Perkins, A. G. Ulsoy, R. J. Meckstroth, Rotational response and slip prediction of serpentine belt
    drive systems, J. Vib. Acoust. 116 (1994) 71-78).  Before it slips as a whole, parts of an elastic rope creep on the
    drum; here they do not.

    Ends that stretch or are pulled are parts of their own beside the rope: bodies ``rope_1`` and ``rope_2`` of a
    ten-billionth of the mass that they pull at, whose ``x`` is how far the rope is out at the drum; ``rope_1_span``, a
    spring with a damper; ``rope_2_pull``, the tension that is given.

    Where friction jumps as such a rope lets go (mu_s > mu_k), or the rope slides from the start, its way follows within
    c/k.  Steps may be longer than that: the motion of bodies is right, and the loss of the dampers in ``sol.energy`` is
    not, which notes of the run and the audit say.  For ropes that start at rest ``max_step`` below c/k closes the
    ledger.

    Parameters of a scene are ``"rope.mu"``, ``"rope.angle"``, ``"rope_1_span.stiffness"`` and the like, and, of a law
    with mu_s > mu_k, ``"rope.friction.mu_s"``: how many times the difference at break-away is that of slip.

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

    The same with a hand that is no body, on a hawser that stretches:

    >>> hawser = fm.Rope("hawser", (ship, 10.0), axes="x", angle=math.pi, friction=0.5, stiffness=(500.0, None),
    ...                  damping=(20.0, None))
    >>> sol = fm.simulate(fm.Scene("mooring", [ship, hawser, wind]), t_end=5.0, rtol=1e-9)
    >>> first, second = sol.tensions("hawser")
    >>> float(abs(first[-1] / second[-1] - math.exp(0.5 * math.pi))) < 1e-12
    True
    """

    takes_friction: ClassVar[bool] = True
    has_tensions: ClassVar[bool] = True
    positive: ClassVar[tuple[str, ...]] = ("angle",)
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "drum", "axes", "when_slack", "beside")

    _: KW_ONLY
    axes: Any
    drum: Any
    radius: Any
    angle: Any
    mu: Any
    length: Any
    when_slack: str
    beside: tuple[Any, ...]

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
        stiffness: Any = None,
        damping: Any = None,
        pretension: Any = None,
        a: Any = None,
        b: Any = None,
        mu: Any = None,
        beside: tuple[Any, ...] = (),
    ) -> None:
        self._set("name", name)
        for field, value in (("radius", radius), ("angle", angle), ("length", length), ("when_slack", when_slack)):
            self._set(field, value)
        self._set("drum", is_end(self, "drum", drum))
        self._set("mu", mu)
        self._set("friction", friction)
        self._set("beside", beside)
        if ends is None:
            self._set("a", is_end(self, "ends", a))
            self._set("b", is_end(self, "ends", b))
            self._set("axes", self._both(axes))
        else:
            self._check_drum()
            self._of_ends(ends, axes, stiffness, damping, pretension)
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
        self._check_drum()
        if self.drum.owner is GROUND and GROUND in (self.a.owner, self.b.owner):
            self._refuse("drum", "ground", "one that turns where an end is held: else the rope could not move on it")
        if self.length is None:
            self._set("length", sum(start_out(self, end, axis) for end, axis in self._sides()))
        self._set("length", self._number("length", self.length))
        self.local_coordinates()

    # -- fields -------------------------------------------------------------------------------------------------
    def _check_drum(self) -> None:
        """Refuse what a drum cannot be, and one that turns without a radius."""
        if not is_one_of(self.when_slack, "end", "open"):
            self._refuse("when_slack", self.when_slack, "'end' or 'open'")
        self._set("radius", self._number("radius", self.radius))
        if self.drum.owner is GROUND:
            return
        angle_of(self, "drum", self.drum)
        if value_of(self.radius) == 0.0:
            self._refuse("radius", self.radius, "given for a drum that turns, with its sign")

    def _of_ends(self, ends: Any, axes: Any, stiffness: Any, damping: Any, pretension: Any) -> None:
        """Ends, directions, and what stands beside them, as declared."""
        if not is_list(ends) or is_series(ends) or len(ends) != 2:
            self._refuse("ends", ends, "two ends, such as (a, b)")
        tensions = [None if isinstance(end, End) else end for end in ends]
        if not any(isinstance(end, End) for end in ends):
            self._refuse("ends", ends, "two ends, or one end and a tension in place of the other")
        one = next((i for i, tension in enumerate(tensions) if tension is not None), None)
        if one is not None:
            tensions[one] = self._tension(tensions[one])
            axes = self._beside_tension(axes, one)
        given = self._each("stiffness", stiffness, tensions), self._each("damping", damping, tensions)
        pair = self._both(axes)
        for i in range(2):
            if given[0][i] is None and given[1][i] not in (None, 0.0):
                self._refuse("damping", damping, "left out where a span does not stretch")
        sides = tuple(
            Side(end if isinstance(end, End) else None, axis, tension, k, 0.0 if c is None else c)
            for end, axis, tension, k, c in zip(ends, pair, tensions, *given, strict=True)
        )
        held, beside = ends_of(self, (sides[0], sides[1]), self._pretension(pretension, tensions))
        self._set("a", held[0])
        self._set("b", held[1])
        self._set("axes", tuple(s.axis if s.is_rigid else "x" for s in sides))
        self._set("beside", beside)

    def _tension(self, value: Any) -> Any:
        """A tension in place of an end."""
        return check_expression(self, "ends", value, motions=True, minimum=0.0)

    def _beside_tension(self, axes: Any, one: int) -> Any:
        """Two directions, where one end has none."""
        pair = list(axes) if is_list(axes) and not is_direction_tuple(axes) else [axes, axes]
        if len(pair) == 1:
            pair = [pair[0], pair[0]]
        if isinstance(axes, str) and len(axes) == 2:
            pair = list(axes)
        if len(pair) != 2:
            self._refuse("axes", axes, "the direction of the end that is no tension")
        pair[one] = "x"
        return tuple(pair)

    def _each(self, argument: str, value: Any, tensions: list[Any]) -> tuple[Any, Any]:
        """One number for each side, or None."""
        if value is None:
            return None, None
        if not is_list(value) or len(value) != 2:
            self._refuse(argument, value, "two numbers, one for each span, None for one that does not stretch")
        found: list[Any] = []
        for entry, tension in zip(value, tensions, strict=True):
            if entry is None:
                found.append(None)
                continue
            if tension is not None:
                self._refuse(argument, value, "None on the side of a tension: what it pulls at stretches nothing")
            more: dict[str, Any] = {"above": 0.0} if argument == "stiffness" else {"minimum": 0.0}
            found.append(self._number(argument, entry, **more))
        return found[0], found[1]

    def _pretension(self, value: Any, tensions: list[Any]) -> float:
        if value is not None:
            return float(value_of(self._number("pretension", value, minimum=0.0)))
        plain = [t for t in tensions if t is not None and expression_uses(t).constant]
        return float(value_of(plain[0])) if plain else 0.0

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

    def companions(self) -> tuple[Any, ...]:
        """Ends without mass, with their spans and pulls."""
        return self.beside

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
        drum = LinearForm() if self.drum.owner is GROUND else angle_of(self, "drum", self.drum)
        return (*(out(self, end, axis) for end, axis in self._sides()), drum)

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
