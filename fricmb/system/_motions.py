"""Named motions as rows of arrays: degrees of freedom, points of modal bodies, driven bodies."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.equations import Expression, Signal, signal_expression, uniform_signal
from fricmb.errors import SceneError
from fricmb.integrate.problem import Codes
from fricmb.scene import Driven
from fricmb.system._tables import TIME_ARGUMENT, Argument, Row, TableBuilder
from fricmb.values import is_expression, value_of


@dataclass(frozen=True, kw_only=True)
class DrivenMotion:
    """Motion of a driven body along an axis.

    ``rate``: the constant velocity, or None; ``start``: position at the start of the run where a velocity is given.
    """

    body: Driven
    letter: str
    rate: float | None
    start: float

    @property
    def name(self) -> str:
        """Such as "belt.x"."""
        return f"{self.body.name}.{self.letter}"

    @property
    def integrated(self) -> bool:
        """Whether the position is the integral of a given velocity."""
        return self.letter in self.body.velocity

    def signal(self) -> Signal:
        """The template of position, velocity and acceleration."""
        if self.rate is not None:
            return uniform_signal(self.rate, self.start)
        source = self.body.velocity if self.integrated else self.body.position
        what = f"Driven {self.body.name!r}: {'velocity' if self.integrated else 'position'}[{self.letter!r}]"
        return signal_expression(source[self.letter], "rate" if self.integrated else "value", self.start, what)


def driven_motions(bodies: Sequence[Driven]) -> dict[str, DrivenMotion]:
    """Every prescribed motion by name."""
    found = {}
    for body in bodies:
        for letter in body.moving:
            motion = _driven_motion(body, letter)
            found[motion.name] = motion
    return found


def _driven_motion(body: Driven, letter: str) -> DrivenMotion:
    start = 0.0
    if letter in body.velocity:
        rate = _number(body.velocity[letter])
        start = float(value_of(body.position.get(letter, 0.0)))
    else:
        fixed = _number(body.position[letter])
        rate = None if fixed is None else 0.0
        start = 0.0 if fixed is None else fixed
    return DrivenMotion(body=body, letter=letter, rate=rate, start=start)


def _number(value: Any) -> float | None:
    if not is_expression(value):
        return float(value_of(value))
    try:
        return float(value_of(value))
    except TypeError:
        return None


class Signals:
    """Signals of a problem, allocated when something needs them."""

    def __init__(self) -> None:
        self.table = TableBuilder()
        self.held: list[Signal] = []
        self.index: dict[str, int] = {}
        #: How often one was asked for.
        self.asked = 0

    def add(self, name: str, make: Callable[[], Signal]) -> int:
        """Index of the signal called ``name``, made if it is new."""
        self.asked += 1
        if name not in self.index:
            self.put(name, make())
        return self.index[name]

    def put(self, name: str, signal: Signal) -> None:
        """Append a signal of a new name."""
        self.index[name] = len(self.held)
        self.held.append(signal)
        self.table.add(signal.template.address, signal.parameters)

    def uniform(self) -> Codes:
        """Which signals are linear in time, by their derivation."""
        return np.array([bool(signal.template.facts.get("uniform", False)) for signal in self.held], dtype=np.int8)

    def need_position(self, name: str) -> None:
        """Refuse a motion whose position has no closed form where something depends on it."""
        signal = self.held[self.index[name]]
        if not signal.template.facts.get("closed", True):
            body, _, letter = name.rpartition(".")
            raise SceneError(
                f"Driven {body!r}: the integral of velocity[{letter!r}] has no closed form and the scene depends on the"
                f" position; give position={{{letter!r}: ...}} instead"
            )


class Motions:
    """Turns linear forms in named motions into rows of arrays."""

    def __init__(self, scene: Any, dof_index: dict[str, int], signals: Signals) -> None:
        self._scene = scene
        self.dofs = dof_index
        self.signals = signals
        self.driven = driven_motions([p for p in scene.parts if isinstance(p, Driven)])

    def row(self, form: Any, *, position: bool = True) -> Row:
        """A row for a form; its signals are allocated.  ``position``: the form's value counts, not its rate alone."""
        q: list[tuple[int, float]] = []
        u: list[tuple[int, float]] = []
        constant = form.constant
        known = all(name in self.dofs or name in self.driven for name, _ in form.terms)
        for name, coefficient in (form if known else self._scene.expand(form)).terms:
            if name in self.dofs:
                q.append((self.dofs[name], coefficient))
                continue
            motion = self.driven[name]
            if motion.rate == 0.0:
                constant += coefficient * motion.start
                continue
            u.append((self.signals.add(name, motion.signal), coefficient))
            if position:
                self.signals.need_position(name)
        return Row(tuple(q), tuple(u), constant)

    def forget_scene(self) -> None:
        """Nothing more is asked: what was built of some parts is kept longer than the scene it was built for."""
        self._scene = None

    def named_row(self, name: str) -> Row:
        """The row of a named motion."""
        return self.row(self._scene.motion(name))

    def arguments(self, expression: Expression) -> list[Argument]:
        """Arguments of an expression's template."""
        return [
            *(self.named_row(name).value() for name in expression.coordinates),
            *(self.row(self._scene.motion(name), position=False).rate() for name in expression.speeds),
            *([TIME_ARGUMENT] if expression.timed else []),
        ]

    def slip_row(self, form: Any) -> tuple[Row, float]:
        """A row whose rate alone counts, with the constant velocities of driven bodies taken out."""
        uniform = 0.0
        terms = []
        for name, coefficient in form.terms:
            motion = self.driven.get(name)
            if motion is not None and motion.rate is not None:
                uniform += coefficient * motion.rate
            else:
                terms.append((name, coefficient))
        return self.row(type(form)(tuple(terms)), position=False), uniform
