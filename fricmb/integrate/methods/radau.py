"""Radau IIA with located transitions as an integrator: the one-step method for any scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

from fricmb.integrate.formulas.tableau import radau
from fricmb.integrate.methods.one_step import OneStepMethod
from fricmb.integrate.model.problem_structs import softness
from fricmb.integrate.problem import Problem


def against_sharing(problem: Problem) -> str | None:
    """What stands against friction whose limit at rest differs by the sense, or None: that it is shared in a loop."""
    if not problem.contacts.lean.any():
        return None
    if problem.mechanism is None:
        shared = softness(problem) > 0.0
    else:
        # slow to load
        from fricmb.integrate.implicit.scene.problem_structs import leans_in_a_loop

        shared = leans_in_a_loop(problem)
    what = "friction whose limit at rest differs by the sense is not shared among contacts that are redundant"
    return what if shared else None


@dataclass(frozen=True, kw_only=True)
class Radau(OneStepMethod):
    """Radau IIA of ``stages`` stages, order 2 stages - 1, on linear and nonlinear structures, with joints and without.

    Parameters
    ----------
    stages : int, optional
        2 to 9; by default from the tolerance.
    """

    name: ClassVar[str] = "radau"
    order: ClassVar[str] = "2s - 1"
    two_limits: ClassVar[bool] = True

    stages: int | None = None

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        return against_sharing(problem) or super().refuses(problem)

    def nodes(self, problem: Problem, rtol: float) -> Sequence[float]:
        """Right Radau points."""
        # slow to load
        from fricmb.integrate.implicit import stages_for

        return tuple(radau(stages_for(problem, rtol, self.stages)).c.tolist())
