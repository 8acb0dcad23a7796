"""A ball: all axes are alike, so that its angular velocity is a rate of coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from types import MappingProxyType
from typing import Any, ClassVar

from fricmb.scene._forms import LinearForm
from fricmb.scene._part import LETTERS
from fricmb.scene._space_body import Read, SpaceBody, plain
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class Ball(SpaceBody):
    """A ball with its centre of mass in the middle and the same inertia about every axis.

    Degrees of freedom ``"name.x"``, ``"name.y"``, ``"name.z"`` and ``"name.turn_x"``, ``"name.turn_y"``,
    ``"name.turn_z"``, whose rates are the angular velocity along the axes of space.  (Turns in space do not add up:
    the three say how far the ball has turned about each axis in all, not how it stands.)  ``sol["name.omega"]`` (3,
    n_t) is the angular velocity.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    mass, radius : float
        > 0.
    inertia : float, optional
        > 0, about the centre; default: that of a solid ball, ``2/5 mass radius^2``.
    position, velocity : (float, float, float)
        Of the centre at the start.
    angular_velocity : (float, float, float)
        Along the axes of space, at the start.

    Raises
    ------
    SceneError
        If a value is not accepted.

    Examples
    --------
    >>> import fricmb as fm
    >>> ball = fm.space.Ball("ball", mass=0.17, radius=0.0286, angular_velocity=(0, 0, 50))
    >>> sol = fm.simulate(fm.Scene("spinning", [ball]), t_end=1.0)
    >>> sol["ball.omega"][:, -1]
    array([ 0.,  0., 50.])
    """

    turning: ClassVar[tuple[str, ...]] = ("turn_x", "turn_y", "turn_z")
    seen: ClassVar[Mapping[str, str]] = MappingProxyType({"omega": "ball"})
    _fixed: ClassVar[tuple[str, ...]] = ("name",)

    _: KW_ONLY
    mass: Any
    radius: Any
    inertia: Any = None
    position: Any = (0.0, 0.0, 0.0)
    velocity: Any = (0.0, 0.0, 0.0)
    angular_velocity: Any = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        super().__post_init__()
        for argument in ("mass", "radius", *(("inertia",) if self.inertia is not None else ())):
            self._set(argument, self._number(argument, getattr(self, argument), above=0.0))
        self._set_triples("position", "velocity", "angular_velocity")

    def turned_start(self, argument: str) -> tuple[float, ...]:
        """Turned by nothing, with the angular velocity."""
        if argument == "position":
            return (0.0, 0.0, 0.0)
        return tuple(float(value_of(self.angular_velocity[c])) for c in LETTERS)

    def masses(self, read: Read = plain) -> tuple[Any, ...]:
        """Mass and inertia."""
        m = read("mass", self.mass)
        J = m * read("radius", self.radius) ** 2 * 2 / 5 if self.inertia is None else read("inertia", self.inertia)
        return m, m, m, J, J, J

    def spins(self) -> tuple[LinearForm, ...]:
        """Coordinates whose rates are the angular velocity."""
        return self.turning_forms()
