"""A wheel on a rail: creepage from where the wheel stands, and how it turns."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._one_sided import OneSided
from fricmb.scene._part import GROUND
from fricmb.scene._space_body import SpacePoint, check_triple
from fricmb.space._joint import SpaceJoint
from fricmb.space._rotor import Rotor
from fricmb.space._turn import cross, dot
from fricmb.values import is_one_of, value_of

#: Directions of the rail are at right angles to this.
SQUARE = 1e-9


@dataclass(frozen=True, eq=False)
class WheelRail(OneSided, SpaceJoint):
    """A wheel of an axle rolls on a straight rail, with creepage.

    The middle of the wheel, a station of a :class:`Rotor`, stays at the height ``rolling_radius`` above the rail; the
    reaction is the force of the rail upward.  Slip is the velocity of the wheel's material at its lowest point
    relative to the rail, first along the wheel's plane ("along"), then along its axle ("across"); the force follows
    from a law of creepage, ``friction=`` :class:`LinearCreep`, :class:`ShenHedrickElkins` or :class:`Polach` (or by any
    law of two directions).

    Scenes may stand where the vehicle is: ``speed`` is the speed at which the rail passes below it.  With ``speed=0``
    the rail rests and the vehicle moves.

    Parameters
    ----------
    name : str
    a : station of a Rotor
        Not at the middle of the axle: the side of the station says on which side the wheel has its flange.
    through : (float, float, float)
        A point of the rail, straight below the wheel's middle where the wheel stands centred.
    rolling_radius : float
        > 0, of the centred wheel.
    conicity : float
        Change of the rolling radius per displacement of the wheel outward, towards its end of the axle.
    along, up : (float, float, float)
        Directions of the rail (in which the vehicle runs) and away from it, at right angles.
    speed : number or SymPy expression in ``fm.t``
        Of the vehicle along the rail, where the scene's axes go with it.
    push_only, when_lost : bool, str
        As of :class:`OnPlane`.
    friction : FrictionLaw, optional
        In two directions; normal force: the reaction.

    Raises
    ------
    SceneError
        If ``a`` is no station beside the middle of a rotor, or a value is not accepted.

    Notes
    -----
    This is the geometry of the linear theory of running stability (K. Knothe, S. Stichel, Rail Vehicle Dynamics,
    Springer 2017, section 9): conicity changes the rolling radius alone.  The axle stays level: it neither rolls nor
    rises where its wheels run on larger radii, and there is no flange.  Where the axle stands askew or displaced,
    slip, load and creep forces are those of large angles.

    Examples
    --------
    >>> import fricmb as fm
    >>> axle = fm.space.Rotor("axle", mass=1250.0, inertia_across=700.0, inertia_axial=100.0, position=(0, 0, 0.45),
    ...     axis=(0, 1, 0), spin=100.0, stations={"left": 0.75, "right": -0.75})
    >>> creep = fm.space.LinearCreep(f11=8e6, f22=7e6, speed=45.0)
    >>> wheels = [
    ...     fm.space.WheelRail(side, axle.station(side), through=(0, y, 0), rolling_radius=0.45, conicity=0.05,
    ...         speed=45.0, friction=creep)
    ...     for side, y in (("left", 0.75), ("right", -0.75))
    ... ]
    >>> sol = fm.simulate(fm.Scene("axle", [axle, *wheels, fm.Gravity("g", acceleration={"z": -9.81})]), t_end=1.0)
    >>> round(float(sol.normal_force("left")[-1]), 6)
    6131.25
    """

    slip_rows: ClassVar[int] = 2
    directions: ClassVar[tuple[str, ...]] = ("along", "up")
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "through", "along", "up")
    _: KW_ONLY
    through: Any
    rolling_radius: Any
    conicity: Any = 0.0
    along: Any = (1.0, 0.0, 0.0)
    up: Any = (0.0, 0.0, 1.0)
    speed: Any = 0.0
    end: str | None = None

    def _check_own(self) -> None:
        if self.b is not GROUND:
            self._refuse("b", self.b, "left out: the rail is fixed")
        if not isinstance(self.a, SpacePoint) or not isinstance(self.a.owner, Rotor) or self.a.offset[0] == 0.0:
            self._refuse("a", self.a.end_name, "a station of a fm.space.Rotor beside its middle")
        self._set("through", check_triple(self, "through", self.through))
        self._set("rolling_radius", self._number("rolling_radius", self.rolling_radius, above=0.0))
        self._set("conicity", self._number("conicity", self.conicity))
        if abs(self.direction("along") @ self.direction("up")) > SQUARE:
            raise SceneError(f"{self._label()}: along and up must be at right angles")
        lean = float(self.a.owner.start_axis() @ self.frame()[1])
        if abs(lean) < 0.5:
            raise SceneError(f"{self._label()}: the axle lies along the rail or stands up; turn its axis across")
        # which end of the axle, and which way its axis points: both say where the flange is
        end = "front" if self.a.offset[0] > 0.0 else "back"
        if not is_one_of(self.end, None, end):
            self._refuse("end", self.end, f"left out (it is {end!r}, from a)")
        self._set("end", end)
        self._set("speed", check_expression(self, "speed", self.speed, motions=False))

    def _takes_expression(self, field: str) -> bool:
        return field == "speed"

    def labels(self) -> tuple[str, ...]:
        """Directions of slip of the wheel: "along" and "across"."""
        return ("along", "across")

    def frame(self) -> Floats:
        """Along the rail, to its left, and up, as rows (3, 3)."""
        along, up = self.direction("along"), self.direction("up")
        return np.array([along, np.cross(up, along), up])

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The wheel's middle from the rail, the axle's axis turned to the left, and its spin about that."""
        start = (float(c) for c in value_of(self.through))
        place = self.seen([self.a.motion(c) - LinearForm((), s) for c, s in zip("xyz", start, strict=True)])
        axle: Any = self.a.owner
        left = float(np.sign(axle.start_axis() @ self.frame()[1]))
        axis = (form * left for form in self.seen(axle.axis_forms()))
        return (*place, *axis, axle.spin_form() * left, LinearForm((), left))

    def drives(self) -> tuple[Any, ...]:
        """How far the vehicle has run."""
        return (("rate", self.speed, 0.0),) if self.friction is not None else ()

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """The height of the wheel's middle."""
        return (x[2] - self.rolling_radius,)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """``r' + omega x c + speed`` with ``omega = n x n' + s' n``, c from the wheel's middle to its lowest point."""
        import sympy

        length = sympy.sqrt(dot(x[3:6], x[3:6]))
        n = tuple(component / length for component in x[3:6])
        radius = self.rolling_radius + self.conicity * (x[7] if self.end == "front" else -x[7]) * x[1]
        c = (0, 0, -radius)
        level = sympy.sqrt(n[0] ** 2 + n[1] ** 2)
        rows = []
        for t in ((n[1] / level, -n[0] / level, 0), (n[0] / level, n[1] / level, 0)):
            # t . ((n x n') x c) = (n . c) t . n' - (t . n) n' . c, and t . (n x c) s'
            swing = [(dot(n, c) * t[i] - dot(t, n) * c[i]) / length for i in range(3)]
            rows.append((*t, *swing, dot(t, cross(n, c)), 0, t[0]))
        return tuple(rows)
