"""A ball, the edge of a disc, the tip of a top or a point of a body on a plane."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.laws import FrictionLaw
from fricmb.scene._expressions import check_expression
from fricmb.scene._forms import LinearForm
from fricmb.scene._one_sided import OneSided
from fricmb.scene._part import GROUND
from fricmb.scene._resistance import resistance_law
from fricmb.scene._space_body import SpacePoint, check_triple
from fricmb.space._ball import Ball
from fricmb.space._directors import RigidBody
from fricmb.space._joint import SpaceJoint
from fricmb.space._resistance import TurningResistance
from fricmb.space._rotor import Rotor
from fricmb.space._turn import cross, dot, triad
from fricmb.space._turning import KINDS, kind_of, turning_forms, turning_rows
from fricmb.values import is_expression, is_one_of, value_of

#: A disc lies flat where the sine of its angle with the plane is no more than this.
FLAT = 1e-3


@dataclass(frozen=True, eq=False)
class OnPlane(OneSided, SpaceJoint):
    """A body touches a fixed plane at one point, and slides or rolls on it in two directions.

    What touches follows from ``a``:

    - a :class:`Ball`: its surface;
    - a :class:`Rotor`: the edge of a disc of ``radius`` through its centre of mass, at right angles to its axis (a
      coin, a wheel);
    - a station of a rotor: a tip that is rounded with ``radius`` about the station (0: a point);
    - a point of a :class:`RigidBody`.

    Reaction: force on a along the normal.  Friction acts at the point of contact, in directions "1" and "2" of the
    plane (``"x"`` and ``"y"`` of the normal z; in general ``"1" x "2" = normal``): slip is the velocity of the body's
    material there, sticking is rolling.

    Parameters
    ----------
    name : str
    a : Ball, Rotor, a station of a rotor, or a point of a RigidBody
    normal : (float, float, float)
        Of the plane, towards the side where the body is.
    through : (float, float, float)
        A point of the plane; default: the origin.
    radius : float
        Of the edge or the tip; that of a ball is its own.
    patch : float, optional
        Radius of the patch by which the body touches, for laws of sliding and spinning (``Contensou``,
        ``ContensouPade``): a third direction "spin" is the speed of the patch's rim, radius times the angular velocity
        about the normal; its force is the moment over the radius.  Left out: the body touches at a point.
    turning : number or SymPy expression in ``fm.t``
        Angular velocity at which the plane turns about its normal in ``through``: a turntable.
    push_only : bool
        The plane can push but not pull; where it would have to pull, contact is lost.
    when_lost : str
        "end": the run ends there with an error that says so.  "open": it goes on without this contact, and ends with an
        error where the body meets the plane again (impacts are not computed).  A scene that starts with the body
        above the plane, or leaving it, starts open.
    friction : FrictionLaw, optional
        In two directions, with a patch in three; normal force: magnitude of the reaction.
    rolling_resistance, spinning_resistance : float or FrictionLaw, optional
        Arms of torques against the angular velocity along the plane (in two directions), and about its normal, lengths:
        each is its arm times the load, and at rest up to that.  A law has arms for coefficients.  They are parts of
        their own beside this one, ``name_rolling`` and ``name_spinning``, as that of a :class:`fricmb.Wheel`.

    Raises
    ------
    SceneError
        If nothing of ``a`` can touch, or a value is not accepted.

    Notes
    -----
    The lowest point of an edge is ``c = -R (e - n_e n)/sqrt(1 - n_e^2)`` from the centre, e the normal of the plane and
    n_e the part of the axis along it; slip is ``r' + omega x c`` (never ``c'``, since another point of the edge touches
    in the next moment).  A disc that lies flat touches everywhere: a run that comes to it ends.

    Examples
    --------
    >>> import fricmb as fm
    >>> ball = fm.space.Ball("ball", mass=0.17, radius=0.03, position=(0, 0, 0.03), velocity=(1, 0, 0))
    >>> cloth = fm.space.OnPlane("cloth", ball, normal=(0, 0, 1), friction=fm.laws.Coulomb(mu_s=0.2))
    >>> sol = fm.simulate(fm.Scene("billiard", [ball, cloth, fm.Gravity("g", acceleration={"z": -9.81})]), t_end=1.0)
    >>> round(float(sol.events[0].t), 6)  # it rolls from 2 v / (7 mu g) on
    0.145624
    """

    only_relative: ClassVar[bool] = False
    directions: ClassVar[tuple[str, ...]] = ("normal",)
    _fixed: ClassVar[tuple[str, ...]] = (
        "name", "a", "b", "normal", "through", "rolling_resistance", "spinning_resistance",
    )  # fmt: skip
    _: KW_ONLY
    normal: Any
    through: Any = (0.0, 0.0, 0.0)
    radius: Any = None
    patch: Any = None
    turning: Any = 0.0
    shape: str | None = None
    rolling_resistance: Any = None
    spinning_resistance: Any = None

    @property
    def slip_rows(self) -> int:  # type: ignore[override]
        """Two directions of the plane, and with a patch its spin."""
        return 2 if self.patch is None else 3

    def _check_directions(self, law: FrictionLaw) -> None:
        if self.slip_rows == 3 and 3 not in law.dimensions:
            self._refuse("friction", law, "a law of sliding and spinning, as fm.laws.Contensou, where there is a patch")
        if self.slip_rows == 2 and law.dimensions == (3,):
            raise SceneError(f"{self._label()}: patch must be given, the radius that spins, for the law {law!r}")
        if self.slip_rows == 2:
            super()._check_directions(law)

    def _check_own(self) -> None:
        if self.b is not GROUND:
            self._refuse("b", self.b, "left out: the plane is fixed")
        self._set("through", check_triple(self, "through", self.through))
        found = self._shape()
        if not is_one_of(self.shape, None, found):
            self._refuse("shape", self.shape, f"left out (it is {found!r}, from a)")
        self._set("shape", found)
        self._set("radius", self._radius(found))
        if self.patch is not None:
            self._set("patch", self._number("patch", self.patch, above=0.0))
            if self.friction is None:
                self._refuse("patch", self.patch, "left out where there is no friction")
        self._set("turning", check_expression(self, "turning", self.turning, motions=False))
        self.companions()

    def companions(self) -> tuple[TurningResistance, ...]:
        """Resistances against rolling and spinning."""
        return tuple(
            TurningResistance(
                f"{self.name}_{kind}", self.a, of=self.name, declared=(given, self.turning),
                normal=self.normal, spins=spins, turning=self.turning if spins else 0.0,
                friction=resistance_law(self, f"{kind}_resistance", given),
            )
            for kind, given, spins in (
                ("rolling", self.rolling_resistance, False), ("spinning", self.spinning_resistance, True),
            )
            if given is not None
        )  # fmt: skip

    def _takes_expression(self, field: str) -> bool:
        return field == "turning"

    def _shape(self) -> str:
        """What touches."""
        if isinstance(self.a, Ball):
            return "ball"
        if isinstance(self.a, Rotor):
            return "edge"
        if isinstance(self.a, SpacePoint):
            return "tip" if isinstance(self.a.owner, Rotor) else "point"
        accepted = "a Ball, a Rotor, a station of one, or a point of a RigidBody of fm.space"
        if isinstance(self.a, RigidBody):
            accepted += " (of a RigidBody name the point that touches: body.point('foot', (0, 0, -1)))"
        self._refuse("a", self.a.end_name, accepted)

    def _radius(self, shape: str) -> Any:
        """Of what touches."""
        if shape == "ball":
            if self.radius is not None:
                self._refuse("radius", self.radius, "left out: a ball has its own")
            return None
        if shape == "edge":
            return self._number("radius", self.radius, above=0.0)
        radius = self._number("radius", 0.0 if self.radius is None else self.radius, minimum=0.0)
        if shape == "point" and value_of(radius) != 0.0:
            raise SceneError(f"{self._label()}: a point of a RigidBody has no radius; a rounded tip is that of a Rotor")
        return radius

    def labels(self) -> tuple[str, ...]:
        """Letters where the plane's directions are along axes, "1" and "2" where they are not."""
        rows = self.frame()[:2]
        found = ("xyz"[int(np.argmax(row))] if row.max() == 1.0 else str(i + 1) for i, row in enumerate(rows))
        return (*found, *(("spin",) if self.patch is not None else ()))

    def frame(self) -> Floats:
        """Directions 1 and 2 of the plane, and its normal, as rows (3, 3)."""
        e = self.direction("normal")
        u, w = triad(e)
        return np.array([u, w, e])

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The point, seen from the plane's own; then axis and spin of a rotor.

        Of a ball its lowest point, and how far its surface has turned: its radius is in the forms; with a patch also
        how far it has turned about the normal.
        """
        start = (float(c) for c in value_of(self.through))
        place = [self.a.motion(c) - LinearForm((), s) for c, s in zip("xyz", start, strict=True)]
        x, y, z = self.seen(place)
        owner = self.a.owner
        if isinstance(owner, Ball):
            radius = float(value_of(owner.radius))
            turns = self.seen(owner.spins())
            spin = () if self.patch is None else turns[2:]
            return x, y, z - LinearForm((), radius), *(form * radius for form in turns), *spin
        if isinstance(owner, Rotor):
            return x, y, z, *self.seen(owner.axis_forms()), owner.spin_form()
        if self.patch is not None:  # a point of a rigid body, which spins
            axes = turning_forms(owner)
            return x, y, z, *(form for i in (0, 3, 6) for form in self.seen(axes[i : i + 3]))
        return x, y, z

    def drives(self) -> tuple[Any, ...]:
        """The angle of a turntable."""
        still = not is_expression(self.turning) and value_of(self.turning) == 0.0
        return () if still or self.friction is None else (("rate", self.turning, 0.0),)

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """How high the lowest point is."""
        if self.shape == "edge":
            _, across = self._axis(x)
            return (x[2] - self.radius * across,)
        return (x[2] - self.radius if self.shape == "tip" else x[2],)

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Velocity of the material at the lowest point, relative to the plane."""
        first: list[Any] = [1, 0, 0]
        second: list[Any] = [0, 1, 0]
        c: tuple[Any, ...] = (0, 0, 0)
        if self.shape == "ball":
            first, second = [*first, 0, -1, 0], [*second, 1, 0, 0]
        elif self.shape != "point":
            c = self._lowest(x)
            first, second = ([*row, *self._turn_factors(x, c, i)] for i, row in enumerate((first, second)))
        spin = self._spins(x)
        own = max(len(first), len(spin))
        if len(x) > own:  # a turntable moves under the point, across the way to it
            rest = [0] * (own - len(first))
            first, second = [*first, *rest, x[1] + c[1]], [*second, *rest, -x[0] - c[0]]
            spin = [*spin, -self.patch] if spin else spin
        return (tuple(first), tuple(second), *((tuple(spin),) if spin else ()))

    def _spins(self, x: tuple[Any, ...]) -> list[Any]:
        """Factors of the speed of the patch's rim; without a patch none."""
        if self.patch is None:
            return []
        if self.shape == "ball":
            return [*(0,) * 6, self.patch]
        kind = kind_of(self, "a")
        return [0, 0, 0, *(self.patch * factor for factor in turning_rows(kind, x[3 : 3 + KINDS[kind]])[2])]

    def undefined(self, values: Mapping[str, float]) -> str:
        """A disc that lies flat."""
        if self.shape != "edge":
            return ""
        name = self.a.owner.name
        across = np.cross([values[f"{name}.axis_{c}"] for c in "xyz"], self.frame()[2])
        if np.linalg.norm(across) > FLAT:
            return ""
        return (
            f"{name!r} has come to lie flat on the plane of {self.name!r}: one point of its edge touched, now all of"
            " its edge does"
        )

    def _lowest(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """From the point of a rotor to where it touches."""
        if self.shape == "tip":
            return 0, 0, -self.radius
        n, across = self._axis(x)
        return tuple(-self.radius * (e - n[2] * c) / across for e, c in zip((0, 0, 1), n, strict=True))

    def _axis(self, x: tuple[Any, ...]) -> tuple[Any, Any]:
        """The axis as a unit vector, which stages leave a little, and the sine of its angle with the normal."""
        import sympy

        length = sympy.sqrt(dot(x[3:6], x[3:6]))
        n = tuple(c / length for c in x[3:6])
        return n, sympy.sqrt(n[0] ** 2 + n[1] ** 2)

    def _turn_factors(self, x: tuple[Any, ...], c: Any, i: int) -> list[Any]:
        """Factors of n' and s' in component i of ``omega x c``, with ``omega = n x n' + s' n``.

        ``(n x n') x c = (n . c) n' - n (n' . c)``.
        """
        import sympy

        length = sympy.sqrt(dot(x[3:6], x[3:6]))
        n, _ = self._axis(x)
        along = dot(n, c)
        swing = [((along if i == j else 0) - n[i] * c[j]) / length for j in range(3)]
        return [*swing, cross(n, c)[i]]
