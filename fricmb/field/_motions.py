"""Named motions of a scene at many times, in numpy: degrees of freedom, points of bodies, prescribed motions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb import stated
from fricmb.field._functions import Given, function
from fricmb.integrate.problem import Floats
from fricmb.scene import Driven, LinearForm, Scene
from fricmb.values import value_of

#: Coefficients of a motion's rate on the rates of the degrees of freedom: (row of v, number or (n_t,)).
Row = list[tuple[int, Any]]


@dataclass(kw_only=True)
class Frame:
    """What tells a name's motion: the scene, the rows of degrees of freedom, positions of driven bodies.

    ``driven``: position of a driven motion by name at given times, where a formula gives only its velocity;
    ``breaks``: times at which functions of time of a scene with joints jump.
    """

    scene: Scene
    index: dict[str, int]
    driven: Callable[[str, Floats], Floats]
    breaks: Floats
    _given: dict[str, tuple[Given | None, Given | float]] = field(default_factory=dict)

    def prescribed(self, name: str) -> tuple[Given | None, Given | float]:
        """Position (None: an integral without a formula here) and velocity of a driven motion."""
        found = self._given.get(name)
        if found is None:
            owner, _, letter = name.rpartition(".")
            body = self.scene[owner]
            if not isinstance(body, Driven):
                raise KeyError(name)
            if letter in body.velocity:
                found = (None, Given(body.velocity[letter]))
            else:
                found = (Given(body.position[letter]), Given(body.position[letter], order=1))
            self._given[name] = found
        return found

    def start(self, name: str) -> float:
        """Declared start of a driven motion that is given by its velocity, or of what is left out."""
        owner, _, letter = name.rpartition(".")
        body: Any = self.scene[owner]
        held = body.position if isinstance(body, Driven) else body.start_values("position")
        return float(value_of(held.get(letter, 0.0)))


@dataclass(kw_only=True)
class Moment:
    """A run at times t (n_t,), and the motions by name that follow from it.

    ``q``, ``v`` (n, n_t), ``z`` (n_z, n_t) law states, ``F`` (m, n_t) friction forces, ``lam`` of each joint (rows,
    n_t), ``N`` (n_c, n_t) and ``mode`` (n_c, n_t) as the run has them.
    """

    frame: Frame
    t: Floats
    q: Floats
    v: Floats
    z: Floats
    F: Floats
    N: Floats
    mode: NDArray[np.int8]
    lam: dict[str, Floats]
    _places: dict[str, tuple[Any, Any, Row]] = field(default_factory=dict)

    def position(self, name: str) -> Any:
        """A motion (n_t,)."""
        return self._motion(name)[0]

    def velocity(self, name: str) -> Any:
        """Its rate (n_t,)."""
        return self._motion(name)[1]

    def form(self, form: LinearForm) -> tuple[Any, Any, Row]:
        """Value, rate and row of a linear form in named motions."""
        value, rate, row = form.constant, 0.0, []
        for name, coefficient in form.terms:
            x, x_dot, own = self._motion(name)
            value, rate = value + coefficient * x, rate + coefficient * x_dot
            row += [(i, coefficient * c) for i, c in own]
        return value, rate, row

    def _motion(self, name: str) -> tuple[Any, Any, Row]:
        i = self.frame.index.get(name)
        if i is not None:
            return self.q[i], self.v[i], [(i, 1.0)]
        found = self._places.get(name)
        if found is None:
            found = self._places[name] = self._derived(name)
        return found

    def _derived(self, name: str) -> tuple[Any, Any, Row]:
        frame = self.frame
        owner, _, letter = name.rpartition(".")
        point = frame.scene.rigid_points.get(owner) if frame.scene.is_mechanism else None
        if point is not None:
            return self._point(point, letter)
        if frame.scene.has_motion(name):
            terms = frame.scene.motion(name).terms  # none: a point where all modes rest along an axis
            if terms != ((name, 1.0),):
                return self.form(LinearForm(terms))
        if name in frame.scene.dof_names:  # what the plan left out rests
            return frame.start(name), 0.0, []
        return (*self._prescribed(name), [])

    def _prescribed(self, name: str) -> tuple[Any, Any]:
        position, velocity = self.frame.prescribed(name)
        rate = velocity.at(self) if isinstance(velocity, Given) else velocity
        if position is not None:
            return position.at(self), rate
        if isinstance(velocity, Given) and velocity.number is not None:
            return self.frame.start(name) + velocity.number * self.t, rate
        return self.frame.driven(name, self.t), rate

    def _point(self, point: Any, letter: str) -> tuple[Any, Any, Row]:
        dofs = [self.frame.index[name] for name in point.body.dof_names]
        values = function(stated.place(point.body))(*self.q[dofs], *point.offset)
        k, n = point.letters.index(letter), len(dofs)
        count = len(values) // (1 + n)
        slopes = values[count + k * n : count + (k + 1) * n]
        rate = sum(c * self.v[i] for i, c in zip(dofs, slopes, strict=True))
        return values[k], rate, list(zip(dofs, slopes, strict=True))
