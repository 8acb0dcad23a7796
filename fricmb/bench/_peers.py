"""Solvers of other packages on smoothed friction: each with the compiled right-hand side and the analytic Jacobian."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass, field

import numpy as np

from fricmb.bench._case import SceneCase
from fricmb.bench._method import Method
from fricmb.bench._reference import Floats, Transitions
from fricmb.bench._run import Run, Setting
from fricmb.bench._smooth import STUCK, SmoothScene, refuses, smooth
from fricmb.errors import FricmbError

#: Widths of the smoothing over the largest speed, each with a tolerance that does not spoil it.
WIDTHS = ((1e-2, 1e-4), (1e-3, 1e-5), (1e-4, 1e-6), (1e-5, 1e-7), (1e-6, 1e-8), (1e-7, 1e-9))
#: A law with states is smooth as it is: the tolerance alone counts.
TOLERANCES = (1e-3, 1e-4, 1e-6, 1e-8, 1e-10)


class PeerError(FricmbError):
    """A solver that gave up, with its own message."""


@dataclass(frozen=True, eq=False)
class Answer:
    """What a solver returns: states (N, n_t) on the times asked for, or at its steps; counters."""

    t: Floats
    y: Floats
    counters: dict[str, int] = field(default_factory=dict)


class Smoothed(Method):
    """Base of the peers: smooths the scene, asks the solver, reads positions, forces and transitions off the states."""

    peer = True

    @abstractmethod
    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Run the solver over ``t``; with ``steps`` return its own steps instead.

        Raises
        ------
        PeerError
            Where the solver gives up.
        """

    def settings(self, case: SceneCase, quick: bool) -> list[Setting]:
        """Widths of the smoothing, wide to narrow; tolerances alone where the law is smooth."""
        if _is_smooth(case):
            return [Setting(rtol=rtol) for rtol in TOLERANCES[:: 3 if quick else 1]]
        return [Setting(rtol=rtol, eps=eps) for eps, rtol in (WIDTHS[1:4:2] if quick else WIDTHS)]

    def refuses(self, case: SceneCase) -> str | None:
        """What the smoothing cannot represent."""
        from fricmb.system import build

        if not case.peers:
            return "left out for its size"
        return refuses(build(case.build()).problem_for(0.0, case.t_end))

    def run(self, case: SceneCase, setting: Setting, *, detail: bool) -> Run:
        """Solve the smoothed scene; with ``detail`` a second time for the transitions at its steps."""
        reference = case.reference()
        speed = float(reference.scales[1].max())
        scene = smooth(case.build(), (setting.eps or 1e-9) * speed, case.t_end)
        rtol = 1e-6 if setting.rtol is None else setting.rtol
        atol = np.full(len(scene.start), 1e-2 * rtol * speed)
        atol[2 * scene.n :] *= 1e-6
        alone = len(reference.t) == 1
        # a solver that is given two times alone may return all its steps
        times = np.array([0.0, 0.5, 1.0]) * reference.t[-1] if alone else reference.t
        answer = self.solve(scene, times, rtol, atol, steps=False)
        q, v = scene.split(answer.y[:, -1:] if alone else answer.y)
        if not detail:
            return Run(q=q, v=v)
        if alone:
            return Run(q=q, v=v, counters=answer.counters)
        g, F = scene.contacts(times, answer.y)
        found = None
        if setting.eps is not None and reference.transitions is not None:
            fine = self.solve(scene, times[[0, -1]], rtol, atol, steps=True)
            found = _transitions(scene, fine)
        return Run(q=q, v=v, F=F, g=g, transitions=found, counters=answer.counters)


def _is_smooth(case: SceneCase) -> bool:
    from fricmb.system import build

    law = build(case.build()).problem.contacts.law
    return bool(len(law)) and bool((law == 2).all())


#: A stay below STUCK eps that is shorter than so many times a straight pass is a pass, not a stick.
LINGER = 4.0


def _transitions(scene: SmoothScene, fine: Answer) -> Transitions:
    """Where the slip speed of a contact crosses ``STUCK`` times eps for longer than a pass takes.

    A pass is a reversal in one dimension and nothing in two.
    """
    g, _ = scene.contacts(fine.t, fine.y)
    found: list[tuple[float, int, str]] = []
    for k in range(len(scene.rows) - 1):
        own = g[scene.rows[k] : scene.rows[k + 1]]
        speed = np.linalg.norm(own, axis=0)
        limit = STUCK * scene.eps
        entered: tuple[float, float] | None = (float(fine.t[0]), np.inf) if speed[0] <= limit else None
        for i in np.flatnonzero((speed[1:] > limit) != (speed[:-1] > limit)):
            time = _crossing(fine.t, speed - limit, int(i))
            if speed[i + 1] <= limit:
                rate = (speed[i] - speed[i + 1]) / (fine.t[i + 1] - fine.t[i])
                entered = (time, LINGER * 2.0 * limit / rate)
            elif entered is not None:
                since, pass_time = entered
                if time - since > pass_time or since == fine.t[0]:
                    found += [(since, k, "stick")] if since > fine.t[0] else []
                    found.append((time, k, "slip"))
                elif len(own) == 1:
                    found.append((0.5 * (since + time), k, "reversal"))
                entered = None
        if entered is not None and entered[0] > fine.t[0]:
            found.append((entered[0], k, "stick"))
    return Transitions.of(found)


def _crossing(t: Floats, away: Floats, i: int) -> float:
    """Where ``away`` crosses zero between steps i and i + 1, on a straight line."""
    return float(t[i] + away[i] / (away[i] - away[i + 1]) * (t[i + 1] - t[i]))
