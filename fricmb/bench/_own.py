"""fricmb's own integrators as methods, through the public ``simulate``."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import fricmb as fm
from fricmb.bench._case import SceneCase
from fricmb.bench._method import LADDER, QUICK_LADDER, Method
from fricmb.bench._reference import KINDS, Transitions
from fricmb.bench._run import Run, Setting

_COUNTERS = ("n_steps", "n_rejected", "n_rhs", "n_jac", "n_lu")


@dataclass(frozen=True)
class Own(Method):
    """An integrator of fricmb, or "auto"."""

    name: str
    peer: bool = False

    @property
    def _adaptive(self) -> bool:
        return self.name == "auto" or fm.integrators[self.name].adaptive

    def settings(self, case: SceneCase, quick: bool) -> list[Setting]:
        """Tolerances, or the steps of the case."""
        if self._adaptive:
            ladder: tuple[float, ...] = QUICK_LADDER if quick else LADDER
            if quick and self.name != "auto" and fm.integrators[self.name].order == "2":
                ladder = ladder[:-1]  # a formula of order 2 takes longer for the tightest than the rest of the suite
            return [Setting(rtol=rtol) for rtol in ladder]
        return [Setting(step=step) for step in (case.steps[:2] if quick else case.steps)]

    def refuses(self, case: SceneCase) -> str | None:
        """What the integrator says of the scene."""
        if self.name == "auto":
            return None
        if not self._adaptive and not case.steps:
            return "a fixed step would need too many steps here"
        from fricmb.system import build

        return fm.integrators[self.name]().refuses(build(case.build()).problem_for(0.0, case.t_end))

    def run(self, case: SceneCase, setting: Setting, *, detail: bool) -> Run:
        """Simulate the scene on the times of the reference."""
        scene, times = case.build(), case.reference().t
        t_eval = times[times > 0.0] if len(times) == 1 else times
        options = {"step": setting.step} if setting.step is not None else {"rtol": setting.rtol}
        sol = fm.simulate(scene, t_end=float(times[-1]), t_eval=t_eval, method=self.name, **options)
        if not detail:
            return Run(q=sol.q, v=sol.v)
        names = contact_names(scene)
        known = [event for event in sol.events if event.kind in KINDS]
        return Run(
            q=sol.q,
            v=sol.v,
            F=np.concatenate([sol.force(name) for name in names]) if names else None,
            g=np.concatenate([sol.relative_velocity(name) for name in names]) if names else None,
            transitions=Transitions.of([(event.t, names.index(event.contact), event.kind) for event in known]),
            energy=float(np.abs(sol.energy.residual).max()),
            counters={name: getattr(sol.stats, name) for name in _COUNTERS},
            used=sol.stats.method,
        )


def contact_names(scene: fm.Scene) -> list[str]:
    """Names of a scene's contacts in the order of their rows."""
    from fricmb.system import build

    return list(build(scene).contact_names)


def own_methods() -> list[Method]:
    """The choice of fricmb, then every integrator it has."""
    return [Own("auto"), *(Own(name) for name in fm.integrators)]
