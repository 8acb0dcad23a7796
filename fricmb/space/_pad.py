"""A pad that a spring presses on the flat face of a body."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._bodies import Body
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._part import GROUND, LETTERS, End
from fricmb.scene._space_body import check_triple
from fricmb.space._joint import PARALLEL, SpaceJoint
from fricmb.space._rotor import Rotor
from fricmb.space._turn import cross, dot, triad
from fricmb.space._turning import kind_of, turning_forms, turning_rows
from fricmb.values import is_one_of, value_of


@dataclass(frozen=True, eq=False)
class Pad(SpaceJoint):
    """A pad without mass, pressed by a spring and a damper on the flat face of a body, rubs on it in two directions.

    The pad constrains nothing: its normal force is that of the spring.  Where that falls to 0 the pad lifts off, and it
    touches again when the face comes back (located events "open" and "close", as of contacts with a normal-force law).

    Parameters
    ----------
    name : str
    a : Rotor, RigidBody, or a point of one
        Whose face it is.
    b : Body with axes "xyz", optional
        Holder of the pad, which moves and does not turn; it bears what the pad presses and rubs with, so that its
        springs have to carry the preload.  Default: the holder stands still.
    at : (float, float, float)
        Where the pad touches as the body is declared; of a holder that moves, with its coordinates at 0.
    normal : (float, float, float)
        Of the face there, out of the body; of a rotor along its axis.
    preload : float
        Normal force as the bodies are declared, > 0.
    stiffness : float
        Of the spring, > 0.
    damping : float
        Normal force per speed of approach under the preload, >= 0; it grows and fades with the force of the spring (as
        Hunt and Crossley's), so that the pad lifts off where the spring is free.
    friction : FrictionLaw
        In two directions of the face (``labels()``); normal force: that of spring and damper.

    Raises
    ------
    SceneError
        If the body has no such face, or a value is not accepted.

    Notes
    -----
    The spring stands at right angles on the face: with the face's unit normal n, a point f of the face and the place p
    of the holder the spring is compressed by ``(f - p) . n`` beyond its preload, and the force ``-N n`` acts on the
    body on the line through p.  The pad touches at ``p + ((f - p) . n) n``; slip is the velocity of the body's material
    there, and friction acts there.  As the face tilts, both forces tilt with it: they follow the body, which is what
    lets steady sliding flutter (U. von Wagner, D. Hochlenert, P. Hagedorn, Minimal models for disk brake squeal, J.
    Sound Vib. 302 (2007) 527-539).

    Examples
    --------
    >>> import fricmb as fm
    >>> disc = fm.space.Rotor("disc", mass=1.0, inertia_across=0.1, inertia_axial=0.2, spin=10.0)
    >>> hub = fm.space.Revolute("hub", disc, axis=(0, 0, 1))
    >>> pad = fm.space.Pad("pad", disc, at=(0.2, 0, 0.01), normal=(0, 0, 1), preload=5.0, stiffness=1e4,
    ...                    friction=fm.laws.Coulomb(mu_s=0.4))
    >>> sol = fm.simulate(fm.Scene("brake", [disc, hub, pad]), t_end=8.0)
    >>> round(float(sol.events[0].t), 9)  # C spin / (mu N r)
    5.0
    """

    constrains: ClassVar[bool] = False
    takes_friction: ClassVar[bool] = True
    slip_rows: ClassVar[int] = 2
    directions: ClassVar[tuple[str, ...]] = ("normal",)
    positive: ClassVar[tuple[str, ...]] = ("preload", "stiffness")
    _fixed: ClassVar[tuple[str, ...]] = ("name", "a", "b", "at", "normal")
    _: KW_ONLY
    at: Any
    normal: Any
    preload: Any
    stiffness: Any
    damping: Any = 0.0
    turning: str | None = None

    def _check_own(self) -> None:
        if self.b is not GROUND and not isinstance(self.b, Body):
            self._refuse("b", self.b.end_name, "left out, or a holder that does not turn: a fm.Body with axes='xyz'")
        if self.friction is None:
            self._refuse("friction", None, "a friction law of two directions, such as fm.laws.Coulomb(mu_s=0.4)")
        self._set("at", check_triple(self, "at", self.at))
        self._set("damping", self._number("damping", self.damping, minimum=0.0))
        owner = self.a.owner
        if isinstance(owner, Rotor) and abs(abs(owner.start_axis() @ self.direction("normal")) - 1.0) > PARALLEL:
            axis = tuple(owner.start_axis().tolist())
            raise SceneError(
                f"{self._label()}: normal must be along the axis of the Rotor {owner.name!r}, {axis}: the faces of a"
                f" body of revolution are across it, got {tuple(value_of(self.normal))}"
            )
        found = kind_of(self, "a")
        if not is_one_of(self.turning, None, found):
            self._refuse("turning", self.turning, f"left out (it is {found!r}, from a)")
        self._set("turning", found)

    def labels(self) -> tuple[str, ...]:
        """Letters where the face's directions are along axes, "1" and "2" where they are not."""
        rows = self.frame()[:2]
        return tuple("xyz"[int(np.argmax(row))] if row.max() == 1.0 else str(i + 1) for i, row in enumerate(rows))

    def frame(self) -> Floats:
        """Directions 1 and 2 of the face, and its normal, as declared: rows (3, 3)."""
        e = self.direction("normal")
        u, w = triad(e)
        return np.array([u, w, e])

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """From the holder to a point of the face, and the normal, by the directions of the frame; then what turns."""
        place = np.array(value_of(self.at), dtype=float)
        normal = self.carried("a", self.direction("normal"))
        offset = float((place - _start_of(self.a)) @ self.direction("normal"))
        apart = [
            self.a.motion(letter) + n * offset - LinearForm((), float(p)) - self.b.motion(letter)
            for letter, n, p in zip("xyz", normal, place, strict=True)
        ]
        turning = turning_forms(self.a.owner)
        if isinstance(self.a.owner, Rotor):
            return (*self.seen(apart), *self.seen(normal), *self.seen(turning[:3]), turning[3])
        by_axes = [form for i in (0, 3, 6) for form in self.seen(turning[i : i + 3])]
        return (*self.seen(apart), *self.seen(normal), *by_axes)

    def parts_within(self) -> tuple[Element, ...]:
        """The spring and damper that press."""
        return (
            Presses(self.name, self, preload=self.preload, stiffness=self.stiffness, damping=self.damping),
        )

    def define_slip(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """``t . (f' + omega x c)`` along two directions t of the face, c from the point of the face to the pad."""
        import sympy

        n = _unit(x[3:6])
        depth = dot(x[0:3], n)
        c = tuple(depth * e - f for e, f in zip(n, x[0:3], strict=True))
        level = sympy.sqrt(1 - n[0] ** 2)
        first = tuple((e - n[0] * m) / level for e, m in zip((1, 0, 0), n, strict=True))
        omega = turning_rows(str(self.turning), x[6:])
        rows = []
        for t in (first, cross(n, first)):
            # t . (omega x c) = omega . (c x t)
            arm = cross(c, t)
            swing = [sum(a * row[j] for a, row in zip(arm, omega, strict=True)) for j in range(len(omega[0]))]
            rows.append((*t, 0, 0, 0, *swing))
        return tuple(rows)

    def define_load(self, x: tuple[Any, ...], lam: tuple[Any, ...]) -> Any:
        """Normal force of the spring; below 0 the pad has lifted off."""
        return _spring(self, x)

    def define_load_rates(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Of the damper, none where the spring is free."""
        import sympy

        spring = _spring(self, x)
        factor = sympy.Piecewise((spring * _damper(self), spring > 0), (0, True))
        return tuple(factor * slope for slope in _slopes(x))


@dataclass(frozen=True, eq=False)
class Presses(Element):
    """Spring and damper of a pad."""

    positive: ClassVar[tuple[str, ...]] = ("preload", "stiffness")
    _fixed: ClassVar[tuple[str, ...]] = ("name", "pad")

    pad: Pad
    _: KW_ONLY
    preload: Any
    stiffness: Any
    damping: Any

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Of the face."""
        return self.pad.local_coordinates()[:6]

    def define_potential(self, x: tuple[Any, ...]) -> Any:
        """Of the spring, 0 as declared; what it has left once it is free."""
        import sympy

        depth = dot(x[0:3], _unit(x[3:6]))
        free = -(self.preload**2) / (2 * self.stiffness)
        held = self.preload * depth + self.stiffness * depth**2 / 2
        return sympy.Piecewise((held, _spring(self, x) > 0), (free, True))

    def define_dissipation(self, x: tuple[Any, ...], x_dot: tuple[Any, ...]) -> Any:
        """Of the damper, which does not pull: ``S c e'^2/2`` with the force S of the spring, where ``1 + c e' > 0``.

        Beyond, the spring alone would push, and is held back: no more than the slope of this counts.
        """
        import sympy

        rate = sum(slope * v for slope, v in zip(_slopes(x), x_dot, strict=False))
        spring, c = _spring(self, x), _damper(self)
        pressed = sympy.Piecewise((c * rate**2 / 2, 1 + c * rate > 0), (-rate, True))
        return sympy.Piecewise((spring * pressed, spring > 0), (0, True))


def _spring(pad: Any, x: tuple[Any, ...]) -> Any:
    """Force of the spring, below 0 where the pad is off."""
    return pad.preload + pad.stiffness * dot(x[0:3], _unit(x[3:6]))


def _damper(pad: Any) -> Any:
    """Of Hunt and Crossley's factor ``1 + c e'`` the number c."""
    return pad.damping / pad.preload


def _start_of(end: End) -> Floats:
    """Where a point of a body is as declared (3,)."""
    owner: Any = end.owner
    start = {f"{owner.name}.{c}": float(value_of(value)) for c, value in owner.start_values("position").items()}
    forms = [end.motion(letter) for letter in LETTERS]
    return np.array([form.constant + sum(c * start[name] for name, c in form.terms) for form in forms])


def _unit(n: Any) -> tuple[Any, ...]:
    """Of length 1, which stages leave a little."""
    import sympy

    length = sympy.sqrt(dot(n, n))
    return tuple(c / length for c in n)


def _slopes(x: tuple[Any, ...]) -> tuple[Any, ...]:
    """Factors of the rates of x in the rate of the compression ``x[0:3] . n``, n = x[3:6] made a unit vector."""
    import sympy

    n = _unit(x[3:6])
    length, depth = sympy.sqrt(dot(x[3:6], x[3:6])), dot(x[0:3], n)
    return (*n, *((f - depth * e) / length for f, e in zip(x[0:3], n, strict=True)))

