"""Prescribed positions that jump: who may depend on them, and when they do."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.model.table_values import evaluate
from fricmb.integrate.problem import Floats, Problem
from fricmb.integrate.run.breakpoints import EPS
from fricmb.scene import Contact, Driven, Element, Force, Joint
from fricmb.scene._expressions import expression_uses
from fricmb.values import is_expression, value_of

#: Part of the largest position that is no jump; how many times in a run that is looked for.
ROUND_OFF, TIMES = 1e-9, 33
#: So far on either side of a jump, relative to its time, it is looked at: beyond the round-off of that time.
BESIDE = 32.0 * EPS


@dataclass(frozen=True)
class Leap:
    """Signal number ``signal``, a position that is given as a function of time: of ``owner``, its ``field``."""

    signal: int
    scene: Any
    owner: Any
    field: str

    @property
    def what(self) -> str:
        """What is given, for messages."""
        if isinstance(self.owner, Driven):
            return f"{self.owner._label()}: position[{self.field!r}]"
        return f"{self.owner._label()}: {self.field}"

    def readers(self) -> list[str]:
        """Labels of parts to which a jump would be an infinite speed."""
        if not isinstance(self.owner, Driven):
            return [self.owner._label()]
        name = f"{self.owner.name}.{self.field}"
        return [part._label() for part in self.scene.parts if _asks_for_speed(part, self.owner, name)]


def leaps_of(scene: Any, index: dict[str, int]) -> tuple[Leap, ...]:
    """Positions given as functions of time among the signals, whose numbers ``index`` tells by name."""
    found = [
        Leap(index[f"{body.name}.{letter}"], scene, body, letter)
        for body in scene.driven
        for letter, value in body.position.items()
        if letter not in body.velocity and is_expression(value) and f"{body.name}.{letter}" in index
    ]
    for joint in scene.joints:
        for i, (given, value, _) in enumerate(joint.drives()):
            name = joint.name if i == 0 else f"{joint.name}.{i}"
            if given == "value" and is_expression(value) and name in index:
                field = next((f.name for f in fields(joint) if getattr(joint, f.name) is value), "motion")
                found.append(Leap(index[name], scene, joint, field))
    return tuple(found)


def leap_times(leaps: tuple[Leap, ...], problem: Problem, t_start: float, t_end: float) -> Floats:
    """Times within a run at which a position jumps, rising; SceneError where that would be an infinite speed."""
    breaks = problem.signals.breakpoints
    breaks = breaks[(breaks > t_start) & (breaks < t_end)]
    found = []
    for leap in leaps if breaks.size else ():
        beside = BESIDE * np.abs(breaks) + 1e-300
        around = np.concatenate([breaks - beside, breaks + beside, np.linspace(t_start, t_end, TIMES)])
        values = evaluate(problem.signals.table, leap.signal, around[:, None], 3)[0]
        jump = values[breaks.size : 2 * breaks.size] - values[: breaks.size]
        at = np.flatnonzero(np.abs(jump) > ROUND_OFF * np.abs(values).max())
        readers = leap.readers() if at.size else []
        if readers:
            i = int(at[0])
            raise SceneError(
                f"{leap.what} jumps by {jump[i]:.6g} at t = {breaks[i]:.10g}, and {', '.join(readers)} would feel an"
                " infinite speed; accepted is a motion that is continuous (its rate may jump)"
            )
        found.append(breaks[at])
    return np.unique(np.concatenate(found)) if found else np.zeros(0)


def _asks_for_speed(part: Any, body: Driven, name: str) -> bool:
    """Whether a part has an end on a driven body, or names its motion, and takes its velocity along an axis."""
    if isinstance(part, Force):
        return name in expression_uses(part.value).speeds
    if isinstance(part, Joint):
        return any(end.owner is body for end in (part.a, part.b))
    if isinstance(part, Contact):
        return _rubs_along(part, name)
    if not isinstance(part, Element):
        return False
    from fricmb.equations._authors import element_math

    forms = part.local_coordinates()
    math = element_math(part, len(forms))
    moved = {math.v[i] for i, form in enumerate(forms) if name in form.motions}
    return bool(moved) and any(moved & f.free_symbols for f in math.total_force())


def _rubs_along(contact: Contact, name: str) -> bool:
    if contact.normal_kind == "expression" and name in expression_uses(contact.normal_force).speeds:
        return True
    if any(name in direction.form.motions for direction in contact.directions()):
        return True
    pressed = contact.normal_direction()
    damping = getattr(contact.normal_force, "damping", 0.0)
    return pressed is not None and name in pressed.form.motions and bool(value_of(damping) != 0.0)
