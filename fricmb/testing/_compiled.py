"""The forces of an element as a run computes them: constant matrices, and the compiled template of the rest."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.equations import Expression, Template, element_template, force_expression, function, numbers
from fricmb.scene import Element, Force, expression_uses
from fricmb.testing._base import Floats
from fricmb.testing._stated import State
from fricmb.values import value_of


@dataclass(frozen=True)
class Values:
    """Force (n,), its derivatives by [x, v, t] (n, 2 n + 1), and the magnitude of the terms that make it up.

    ``potential``: stored energy; ``loss``: power that the dissipation takes; ``power``: of the outer force.
    """

    force: Floats
    jacobian: Floats
    potential: float
    loss: float
    power: float
    size: float

    @property
    def finite(self) -> bool:
        """Whether everything is a finite number."""
        held = [*self.force, *self.jacobian.flat, self.potential, self.loss, self.power]
        return bool(np.isfinite(held).all())


def compiled(element: Element) -> Callable[[State], Values]:
    """The compiled forces of an element as a function of a state."""
    if isinstance(element, Force):
        return _compiled_value(element)
    return _Parts(element_template(element, driven=False), len(element.local_coordinates()), numbers(element))


class _Parts:
    """The affine part, and the template of the rest if the numbers leave any."""

    def __init__(self, template: Template, n: int, p: tuple[float, ...]) -> None:
        entries = template.matrices(p)
        self.n, self.p = n, np.array(p)
        self.K, self.C, self.work_K, self.work_C = (_square(entries[k], n) for k in ("K", "C", "work_K", "work_C"))
        self.f, self.work_f = (_square(entries[k], n)[:, 0] for k in ("f", "work_f"))
        self.constant = float(template.constant(p))
        nonlinear = bool(template.facts["compiled"] and template.rest(p))
        self.places: list[tuple[str, int]] = template.facts["arguments"] if nonlinear else []
        self.call: Any = function(template.address) if nonlinear else None

    def __call__(self, state: State) -> Values:
        x, v, n = state.x, state.v, self.n
        work = self.work_f - self.work_K @ x - self.work_C @ v
        force = self.f - self.K @ x - self.C @ v + work
        jacobian = np.column_stack([-self.K - self.work_K, -self.C - self.work_C, np.zeros(n)])
        energies = np.array([self.constant - self.f @ x + 0.5 * x @ self.K @ x, v @ self.C @ v, work @ v])
        size = float(np.abs(force).max())
        if self.call is not None:
            rest, slopes, more = self._rest(state)
            force, energies, size = force + rest, energies + more, size + float(np.abs(rest).max())
            for column, (kind, i) in enumerate(self.places):
                jacobian[:, {"x": 0, "v": n, "t": 2 * n}[kind] + i] += slopes[:, column]
        stored, loss, power = map(float, energies)
        return Values(force, jacobian, stored, loss, power, size)

    def _rest(self, state: State) -> tuple[Floats, Floats, Floats]:
        held = {"x": state.x, "v": state.v, "t": np.array([state.t])}
        arguments = np.array([held[kind][i] for kind, i in self.places], dtype=float)
        out = np.full(self.n * (1 + len(arguments)) + 3, np.nan)
        self.call(arguments, self.p, out)
        return out[: self.n], out[self.n : -3].reshape(self.n, len(arguments)), out[-3:]


def _square(entries: list[tuple[int, int, float]], n: int) -> Floats:
    matrix = np.zeros((n, n))
    for i, j, value in entries:
        matrix[i, j] += value
    return matrix


def _compiled_value(element: Force) -> Callable[[State], Values]:
    """Of a force whose value is a number or an expression."""
    uses = expression_uses(element.value)
    n = 1 + len(uses.motions)
    if uses.constant:
        return lambda state: _on_first(n, float(value_of(element.value)), np.zeros(2 * n + 1), state)
    given = force_expression(element.value, f"{element._label()}: value")
    places = _places(given, uses.motions)
    call, p = function(given.template.address), np.array(given.parameters)

    def evaluate(state: State) -> Values:
        y = np.array([*state.x, *state.v, state.t])
        # the last argument is the rate of the motion that the force acts on
        arguments, out = np.array([*y[places], state.v[0]]), np.full(len(places) + 5, np.nan)
        call(arguments, p, out)
        slopes = np.zeros(2 * n + 1)
        slopes[places] = out[1 : 1 + len(places)]
        return _on_first(n, out[0], slopes, state)

    return evaluate


def _places(given: Expression, motions: tuple[str, ...]) -> list[int]:
    """Where the arguments of an expression are in [x, v, t]."""
    n = 1 + len(motions)
    places = [1 + motions.index(name) for name in given.coordinates]
    places += [n + 1 + motions.index(name) for name in given.speeds]
    return [*places, 2 * n] if given.timed else places


def _on_first(n: int, force: float, slopes: Floats, state: State) -> Values:
    forces, jacobian = np.zeros(n), np.zeros((n, 2 * n + 1))
    forces[0], jacobian[0] = force, slopes
    return Values(forces, jacobian, 0.0, 0.0, float(force * state.v[0]), abs(float(force)))
