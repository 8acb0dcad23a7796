"""A torque on a body in space."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from fricmb.errors import SceneError, shown
from fricmb.scene._element import Element
from fricmb.scene._forms import LinearForm
from fricmb.scene._space_body import SpacePoint, check_triple
from fricmb.space._ball import Ball
from fricmb.space._directors import RigidBody
from fricmb.space._rotor import Rotor
from fricmb.space._turn import cross, dot, unit
from fricmb.values import value_of


@dataclass(frozen=True, eq=False)
class Torque(Element):
    """A constant torque on a body about a direction that is fixed in space.

    Parameters
    ----------
    name : str
        Unique in a scene, without dots.
    body : Ball, Rotor or RigidBody of ``fm.space``
    axis : (float, float, float)
        Direction in space.
    value : float
        Torque about it.

    Examples
    --------
    >>> import fricmb as fm
    >>> wheel = fm.space.Rotor("wheel", mass=1.0, inertia_across=0.1, inertia_axial=0.2)
    >>> torque = fm.space.Torque("drive", wheel, axis=(0, 0, 1), value=0.4)
    >>> sol = fm.simulate(fm.Scene("spun up", [wheel, torque]), t_end=1.0)
    >>> float(round(sol.velocity("wheel.spin")[-1], 9))
    2.0
    """

    _fixed: ClassVar[tuple[str, ...]] = ("name", "body", "kind")
    is_load: ClassVar[bool] = True

    body: Any
    _: KW_ONLY
    axis: Any
    value: Any

    def __post_init__(self) -> None:
        if isinstance(self.body, SpacePoint):
            self._set("body", self.body.body)
        if not isinstance(self.body, Ball | Rotor | RigidBody):
            given = getattr(self.body, "end_name", self.body)
            raise SceneError(f"Torque {shown(self.name)}: body must be a body of fm.space, got {shown(given)}")
        super().__post_init__()
        self._set("axis", check_triple(self, "axis", self.axis))
        unit(self._label(), "axis", value_of(self.axis))
        self._set("value", self._number("value", self.value))

    def local_coordinates(self) -> tuple[LinearForm, ...]:
        """What turns: angles of a ball, the axis and the spin of a rotor, the axes of a body; others at rest."""
        body, still = self.body, LinearForm()
        if isinstance(body, Ball):
            return (*body.spins(), *(still for _ in range(13)))
        if isinstance(body, Rotor):
            return (*(still for _ in range(3)), *body.axis_forms(), body.spin_form(), *(still for _ in range(9)))
        return (*(still for _ in range(7)), *body.turning_forms())

    def define_force(self, x: tuple[Any, ...], x_dot: tuple[Any, ...], t: Any) -> tuple[Any, ...]:
        """``tau`` on angles; ``tau x n`` and ``tau . n`` on axis and spin; ``tau x d/2`` on each axis of a body."""
        import sympy

        length = sympy.sqrt(dot(self.axis, self.axis))
        tau = tuple(self.value * c / length for c in self.axis)
        n = x[3:6]
        halves = [c / 2 for i in (7, 10, 13) for c in cross(tau, x[i : i + 3])]
        return (*tau, *cross(tau, n), dot(tau, n), *halves)
