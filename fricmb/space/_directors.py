"""A rigid body with three different axes: they are its coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import LETTERS
from fricmb.scene._space_body import InnerConstraint, Read, SpaceBody, SpacePoint, check_triple, plain
from fricmb.space._turn import dot, rotation
from fricmb.values import is_list, value_of

#: Moments that a body is flat by are equal to this; what an axis without mass counts in changes, beside the others.
FLAT, LEAST = 1e-12, 1e-2
#: Axes of the body, and the names of their components.
DIRECTORS = ("d1", "d2", "d3")
_IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class RigidBody(SpaceBody):
    """A rigid body in space.

    Degrees of freedom ``"name.x"``, ``"name.y"``, ``"name.z"`` (centre of mass) and the components of its three
    principal axes, unit vectors d1, d2, d3: ``"name.d1_x"``, ...  In results also ``sol["name.rotation"]`` (3, 3, n_t),
    whose columns are the axes, and ``sol["name.omega"]`` (3, n_t), the angular velocity along the axes of space.

    A body of revolution that spins fast is better a :class:`Rotor`: here a step has to follow every turn.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    mass : float
        > 0.
    inertia : (float, float, float)
        Principal moments about the centre of mass, along the body's own axes: > 0, and none more than the other two
        together (equal to their sum in a flat body).
    position, velocity : (float, float, float)
        Of the centre of mass at the start.
    orientation : 3 x 3 numbers
        Rotation matrix at the start, ``x_space = R @ x_body``; :func:`turned` makes one.
    angular_velocity : (float, float, float)
        Along the axes of space, at the start.
    points : dict of str to (float, float, float)
        Points fixed in the body, in its own axes from the centre of mass on.

    Raises
    ------
    SceneError
        If a value is not accepted.

    Notes
    -----
    With ``E_i = (J1 + J2 + J3)/2 - J_i`` the kinetic energy is ``(m r'^2 + sum E_i d_i'^2)/2``; the axes are kept unit
    vectors at right angles by six constraints.  ``omega = sum d_i x d_i' / 2``, and a torque tau is the force
    ``tau x d_i / 2`` on every axis.  (Betsch and Steinmann, Int. J. Numer. Meth. Engng 50, 2001.)

    Examples
    --------
    >>> import fricmb as fm
    >>> book = fm.space.RigidBody("book", mass=1.0, inertia=(1.0, 2.0, 2.5), angular_velocity=(0.1, 2.0, 0.05))
    >>> sol = fm.simulate(fm.Scene("tumbling", [book]), t_end=1.0)
    >>> sol["book.rotation"].shape[:2], sol["book.omega"].shape[:1]
    ((3, 3), (3,))
    """

    turning: ClassVar[tuple[str, ...]] = tuple(f"{d}_{c}" for d in DIRECTORS for c in LETTERS)
    seen: ClassVar[Mapping[str, str]] = MappingProxyType({"rotation": "rotation", "omega": "directors"})
    _fixed: ClassVar[tuple[str, ...]] = ("name", "orientation")

    _: KW_ONLY
    mass: Any
    inertia: Any
    position: Any = (0.0, 0.0, 0.0)
    orientation: Any = _IDENTITY
    velocity: Any = (0.0, 0.0, 0.0)
    angular_velocity: Any = (0.0, 0.0, 0.0)
    points: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        self._set("mass", self._number("mass", self.mass, above=0.0))
        self._set("inertia", self._principal())
        self._set_triples("position", "velocity", "angular_velocity")
        self._set("orientation", rotation(self._label(), self.orientation))
        self._check_points("points")

    def _principal(self) -> tuple[Any, ...]:
        """Principal moments that a body can have."""
        if not is_list(self.inertia) or len(self.inertia) != 3:
            self._refuse("inertia", self.inertia, "three numbers, the principal moments about the centre of mass")
        found = tuple(self._number(f"inertia[{i}]", value, above=0.0) for i, value in enumerate(self.inertia))
        a, b, c = (float(value_of(value)) for value in found)
        if min(b + c - a, a + c - b, a + b - c) < -FLAT * max(a, b, c):
            raise SceneError(
                f"{self._label()}: inertia must have no principal moment above the other two together, got"
                f" ({a:g}, {b:g}, {c:g})"
            )
        return found

    def check_offset(self, argument: str, value: Any) -> tuple[Any, ...]:
        """Three numbers, in the body's axes."""
        return check_triple(self, argument, value)

    @property
    def offsets(self) -> Mapping[str, Any]:
        """Points by name."""
        return self.points

    def point(self, name: str, offset: Any = None) -> SpacePoint:
        """A point fixed in the body: an end for joints, contacts and elements.

        Parameters
        ----------
        name : str
        offset : (float, float, float), optional
            In the body's axes from its centre of mass on; left out for a name in ``points``.

        Raises
        ------
        UnknownNameError
            If there is no such point and no offset is given.
        """
        return self._point(name, offset)

    def place(self, offset: tuple[float, ...], letter: str) -> LinearForm:
        """A point fixed in the body."""
        turned = {f"{self.name}.{d}_{letter}": x for d, x in zip(DIRECTORS, offset, strict=True)}
        return LinearForm.of({f"{self.name}.{letter}": 1.0, **turned})

    def start_rotation(self) -> Floats:
        """Declared orientation (3, 3)."""
        return np.array(self.orientation, dtype=float)

    def turned_start(self, argument: str) -> tuple[float, ...]:
        """The axes, one after the other, or their rates."""
        R = self.start_rotation()
        if argument == "velocity":
            omega = np.array([float(value_of(self.angular_velocity[c])) for c in LETTERS])
            R = np.cross(omega, R.T).T
        return tuple(R.T.ravel().tolist())

    def masses(self, read: Read = plain) -> tuple[Any, ...]:
        """Mass, and three times each E."""
        m = read("mass", self.mass)
        a, b, c = (read(f"inertia.{i + 1}", value) for i, value in enumerate(self.inertia))
        E = [(b + c - a) / 2, (a + c - b) / 2, (a + b - c) / 2]
        if read is plain:  # of a flat body round-off may leave less than nothing
            E = [e if e > FLAT * (a + b + c) else 0.0 for e in E]
        return m, m, m, *(e for e in E for _ in LETTERS)

    def least_masses(self) -> tuple[float, ...]:
        """A part of the largest for each component of an axis."""
        masses = self.masses()
        return (0.0, 0.0, 0.0, *(LEAST * max(masses[3:]) for _ in masses[3:]))

    def direction_forms(self, components: Any) -> tuple[LinearForm, ...]:
        """A direction fixed in the body, by its components in the body's axes."""
        return tuple(
            LinearForm.of({f"{self.name}.{d}_{c}": float(x) for d, x in zip(DIRECTORS, components, strict=True)})
            for c in LETTERS
        )

    def inner(self) -> Joint:
        """The axes are orthonormal."""
        return Orthonormal(self.name, self)


@dataclass(frozen=True, eq=False)
class Orthonormal(InnerConstraint):
    """Keeps the axes of a body unit vectors at right angles."""

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Lengths, then right angles."""
        d1, d2, d3 = x[0:3], x[3:6], x[6:9]
        lengths = tuple((dot(d, d) - 1) / 2 for d in (d1, d2, d3))
        return (*lengths, dot(d2, d3), dot(d3, d1), dot(d1, d2))
