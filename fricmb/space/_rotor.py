"""A body of revolution: its axis and the angle by which it spins about it are coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, field
from types import MappingProxyType
from typing import Any, ClassVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Floats
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._joint import Joint
from fricmb.scene._part import GROUND, End
from fricmb.scene._space_body import InnerConstraint, Read, SpaceBody, SpacePoint, check_triple, plain
from fricmb.space._turn import cross, dot, unit
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class Rotor(SpaceBody):
    """A rigid body of revolution: a top, a wheel, a disc, a coin, an axle.

    Degrees of freedom ``"name.x"``, ``"name.y"``, ``"name.z"`` (centre of mass), ``"name.axis_x"``, ``"name.axis_y"``,
    ``"name.axis_z"`` (unit vector n along the axis) and ``"name.spin"``, whose rate is the part of the angular velocity
    along the axis.  In results also ``sol["name.axis"]`` and ``sol["name.omega"]``, (3, n_t) each.

    Fast spin costs no steps: the axis moves slowly, and the angle of spin evenly.  The price: what is not symmetric
    about the axis cannot be told from the coordinates, since the angle of spin depends on the way the axis has taken.
    Points lie on the axis (``stations``).

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    mass : float
        > 0.
    inertia_across, inertia_axial : float
        > 0, about the centre of mass: across the axis, and about the axis.
    position, velocity : (float, float, float)
        Of the centre of mass at the start.
    axis : (float, float, float)
        Direction of the axis at the start.
    spin : float
        Angular velocity about the axis at the start, the axis itself being at rest.
    angular_velocity : (float, float, float), optional
        The whole angular velocity along the axes of space, instead of ``spin``.
    stations : dict of str to float
        Points on the axis by their distance from the centre of mass along it.

    Raises
    ------
    SceneError
        If a value is not accepted.

    Notes
    -----
    With A across and C about the axis the kinetic energy is ``(m r'^2 + A n'^2 + C s'^2)/2``, the angular velocity
    ``omega = n x n' + s' n``, and a torque tau the force ``tau x n`` on n and ``tau . n`` on s: ``A n'' = C s' n x n' +
    tau x n`` beside what keeps n a unit vector (from ``L = A n x n' + C s' n`` and ``L' = tau``).

    Examples
    --------
    >>> import fricmb as fm
    >>> wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2, axis=(1, 0, 0), spin=50.0)
    >>> sol = fm.simulate(fm.Scene("free", [wheel]), t_end=1.0)
    >>> float(round(sol["wheel.spin"][-1], 9))
    50.0
    """

    turning: ClassVar[tuple[str, ...]] = ("axis_x", "axis_y", "axis_z", "spin")
    seen: ClassVar[Mapping[str, str]] = MappingProxyType({"axis": "axis", "omega": "rotor"})
    _fixed: ClassVar[tuple[str, ...]] = ("name",)

    _: KW_ONLY
    mass: Any
    inertia_across: Any
    inertia_axial: Any
    position: Any = (0.0, 0.0, 0.0)
    axis: Any = (0.0, 0.0, 1.0)
    spin: Any = 0.0
    velocity: Any = (0.0, 0.0, 0.0)
    angular_velocity: Any = None
    stations: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        for argument in ("mass", "inertia_across", "inertia_axial"):
            self._set(argument, self._number(argument, getattr(self, argument), above=0.0))
        self._set_triples("position", "velocity")
        self._set("axis", check_triple(self, "axis", self.axis))
        unit(self._label(), "axis", value_of(self.axis))
        self._set("spin", self._number("spin", self.spin))
        if self.angular_velocity is not None:
            self._set("angular_velocity", check_triple(self, "angular_velocity", self.angular_velocity))
            if value_of(self.spin) != 0.0:
                raise SceneError(f"{self._label()}: give spin or angular_velocity, not both (spin is part of it)")
        self._check_points("stations")
        self._set("stations", MappingProxyType({name: held[0] for name, held in self.stations.items()}))

    def check_offset(self, argument: str, value: Any) -> tuple[Any, ...]:
        """One number, along the axis."""
        return (self._number(argument, value),)

    @property
    def offsets(self) -> Mapping[str, Any]:
        """Stations by name."""
        return {name: (value,) for name, value in self.stations.items()}

    def station(self, name: str, distance: Any = None) -> SpacePoint:
        """A point on the axis: an end for joints, contacts and elements.

        Parameters
        ----------
        name : str
        distance : float, optional
            From the centre of mass along the axis; left out for a name in ``stations``.

        Raises
        ------
        UnknownNameError
            If there is no such station and no distance is given.
        """
        return self._point(name, distance)

    def place(self, offset: tuple[float, ...], letter: str) -> LinearForm:
        """A point on the axis."""
        return LinearForm.of({f"{self.name}.{letter}": 1.0, f"{self.name}.axis_{letter}": offset[0]})

    def start_axis(self) -> Floats:
        """Declared axis (3,), a unit vector."""
        return unit(self._label(), "axis", value_of(self.axis))

    def turned_start(self, argument: str) -> tuple[float, ...]:
        """Axis and spin, or their rates."""
        n = self.start_axis()
        if argument == "position":
            return (*n.tolist(), 0.0)
        if self.angular_velocity is None:
            return (0.0, 0.0, 0.0, float(value_of(self.spin)))
        omega = np.array(value_of(self.angular_velocity), dtype=float)
        return (*np.cross(omega, n).tolist(), float(omega @ n))

    def masses(self, read: Read = plain) -> tuple[Any, ...]:
        """Mass, A and C."""
        m, A = read("mass", self.mass), read("inertia_across", self.inertia_across)
        return m, m, m, A, A, A, read("inertia_axial", self.inertia_axial)

    def axis_forms(self) -> tuple[LinearForm, ...]:
        """The axis n."""
        return self.turning_forms()[:3]

    def spin_form(self) -> LinearForm:
        """The angle of spin."""
        return self.turning_forms()[3]

    def inner(self) -> Joint:
        """The axis has length 1."""
        return UnitAxis(self.name, self)

    def gyroscopic(self) -> Element:
        """What turns the axis sideways."""
        return Gyroscopic(self.name, self, inertia_axial=self.inertia_axial)


@dataclass(frozen=True, eq=False)
class UnitAxis(InnerConstraint):
    """Keeps the axis of a rotor a unit vector."""

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """The axis."""
        return super().local_coordinates()[:3]

    def define_constraint(self, x: tuple[Any, ...]) -> tuple[Any, ...]:
        """Half of what its square is beside 1."""
        return ((dot(x, x) - 1) / 2,)


@dataclass(frozen=True, eq=False)
class Gyroscopic(Element):
    """The force ``C s' n x n'`` on the axis of a rotor; C has the name that it has there, by which it is known."""

    body: End = GROUND
    _: KW_ONLY
    inertia_axial: Any

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """Axis and spin."""
        body: Any = self.body
        return (*body.axis_forms(), body.spin_form())

    def define_force(self, x: tuple[Any, ...], x_dot: tuple[Any, ...], t: Any) -> tuple[Any, ...]:
        """Does no work."""
        return (*(self.inertia_axial * x_dot[3] * c for c in cross(x, x_dot)), 0)
