"""Rules of an element's forces: what is compiled is what is stated, and it is finite and takes energy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from fricmb.scene import Element, Force
from fricmb.testing._base import Floats, Rule
from fricmb.testing._compiled import Values, compiled
from fricmb.testing._stated import State, Stated, stated

_CLOSE = 1e-9


@dataclass(frozen=True)
class Trial:
    """Where an element is tried: about ``around``, as far as ``size`` at random, as far as ``largest`` for overflow."""

    around: tuple[float, ...]
    size: float
    largest: float

    def states(self) -> Iterator[State]:
        """States at random, always the same."""
        rng, n = np.random.default_rng(0), len(self.around)
        for _ in range(6):
            x = np.array(self.around) + self.size * rng.normal(size=n)
            yield State(x, self.size * rng.normal(size=n), float(rng.uniform(0.0, 3.0)))

    def extremes(self) -> Iterator[State]:
        """At rest in the middle, hardly away from it, and far away."""
        n = len(self.around)
        one, turned = np.ones(n), np.where(np.arange(n) % 2, -1.0, 1.0)
        for scale in (0.0, 1e-200, 1e-8 * self.size, self.largest):
            for direction in (one, -one, turned):
                yield State(np.array(self.around) + scale * direction, scale * turned, 0.0)
                yield State(np.array(self.around) + scale * direction, np.zeros(n), 1.0)


def force_findings(element: Element, trial: Trial) -> Iterator[str]:
    """All that is wrong with the forces of an element; nothing more once they cannot be derived."""
    try:
        if not isinstance(element, Force) and _says_nothing(element):
            yield "none of define_potential, define_dissipation and define_force is defined"
            return
        author, run = stated(element), compiled(element)
    except Exception as error:
        yield f"its forces cannot be derived: {type(error).__name__}: {error}"
        return
    for rule in FORCE_RULES:
        yield from rule(author, run, trial)


def _says_nothing(element: Element) -> bool:
    names = ("define_potential", "define_dissipation", "define_force")
    return all(getattr(type(element), name) is getattr(Element, name) for name in names)


def _finite(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    for state in [*trial.extremes(), *trial.states()]:
        values = run(state)
        if not values.finite:
            yield f"force {values.force.tolist()} or its Jacobian is not finite at {state}"
            return


def _force(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    for state in trial.states():
        values, force = run(state), author.force(state)
        if values.finite and _differ(values.force, force, values.size):
            yield (
                f"the compiled force at {state} is {values.force.tolist()}, -dV/dx - dR/dx' + F as stated is"
                f" {force.tolist()}; does a formula use what is neither a parameter nor a word nor a flag?"
            )
            return


def _jacobian(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    for state in trial.states():
        given, jacobian = run(state).jacobian, author.jacobian(state)
        if _differ(given, jacobian, float(np.abs(given).max())):
            slopes = f"the slopes of the force are {jacobian.tolist()}"
            yield f"the compiled Jacobian at {state} is {given.tolist()}, {slopes}"
            return


def _energies(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    for state in trial.states():
        values = run(state)
        given = np.array([values.potential, values.loss, values.power])
        expected = np.array(author.energies(state))
        if _differ(given, expected, values.size * float(np.abs([*state.x, *state.v, 1.0]).max())):
            counted = f"are counted as {given.tolist()}, stated are {expected.tolist()}"
            yield f"potential, loss and power at {state} {counted}"
            return


def _loses(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    for state in [*trial.states(), *trial.extremes()]:
        values = run(state)
        if values.finite and values.loss < -_CLOSE * abs(float(values.force @ state.v)):
            yield f"the dissipation gives power at {state}: it takes {values.loss:g}"
            return


def _symmetric(author: Stated, run: Callable[[State], Values], trial: Trial) -> Iterator[str]:
    """Stiffness of a force that has a potential and nothing else."""
    for state in trial.states() if author.conservative else ():
        stiffness = -run(state).jacobian[:, : author.n]
        if _differ(stiffness, stiffness.T, float(np.abs(stiffness).max())):
            yield f"the Hessian of the potential at {state} is not symmetric: {stiffness.tolist()}"
            return


def _differ(given: Floats, expected: Floats, size: float) -> bool:
    return not bool((np.abs(given - expected) <= _CLOSE * max(size, 1e-200)).all())


FORCE_RULES: tuple[Rule, ...] = (_finite, _force, _jacobian, _energies, _loses, _symmetric)
