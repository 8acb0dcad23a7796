"""A run of the published scheme: between its steps as smooth as its order, forces those of its own equations."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from fricmb.integrate.implicit.output.step_trajectory import StepTrajectory
from fricmb.integrate.problem import Codes, Floats, Ints, Problem
from fricmb.integrate.trajectory import MotionSamples

#: Places in a step at which cubic polynomials of positions are kept.
THIRDS = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])


class PaperTrajectory(StepTrajectory):
    """Positions are cubics by the velocities at both ends of a step; all else is linear between them."""

    def __init__(self, problem: Problem, span: Floats, values: Floats, *more: Any) -> None:
        super().__init__(problem, span, _cubic(problem.n, span[:, 1], values), *more)
        self._nodes = THIRDS

    @property
    def _is_smooth(self) -> bool:
        """Energies are those of the formula, not integrals over what is kept."""
        return True

    def _complete(
        self, t: Floats, values: Floats, step: Ints, *, project: bool = False, side: Floats | None = None,
        still: Floats | None = None, force: Floats | None = None,
    ) -> tuple[MotionSamples, Floats, Floats]:  # fmt: skip
        """As ``StepTrajectory``, with the forces of the scheme: linear between steps of the same modes."""
        motion, stored, power = super()._complete(t, values, step, project=project, side=side, still=still, force=force)
        if not len(self._span):
            return motion, stored, power
        m = self.problem.m
        before, own = np.maximum(step - 1, 0), self._force[:, :m]
        x = ((t - self._span[step, 0]) / self._span[step, 1])[:, None]
        same = _same(self._mode, before, step)[:, None]
        F = np.where(same, (1.0 - x) * own[before] + x * own[step], own[step])
        return dataclasses.replace(motion, F=F.T.copy()), stored, power


def _same(mode: Codes, a: Ints, b: Ints) -> Any:
    """Whether two steps have the same modes."""
    return (mode[a] == mode[b]).all(axis=1)


def _cubic(n: int, h: Floats, ends: Floats) -> Floats:
    """Values (k, 4, w) at thirds of steps from those at both ends (k, 2, w): [q, v, ...]."""
    x = THIRDS[:, None]
    first, last = ends[:, :1], ends[:, 1:]
    values: Floats = first + x * (last - first)
    q0, q1, v0, v1 = first[..., :n], last[..., :n], first[..., n : 2 * n], last[..., n : 2 * n]
    way = h[:, None, None]
    values[..., :n] = (
        q0 + (q1 - q0) * x * x * (3.0 - 2.0 * x) + way * x * (1.0 - x) * ((1.0 - x) * v0 - x * v1)
    )  # Hermite
    values[:, 0], values[:, -1] = ends[:, 0], ends[:, 1]
    return values
