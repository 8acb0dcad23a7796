"""One scene under set-valued, regularised and bristle friction: what the replacement costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb.analysis._errors import checked_integer, checked_scene, positive
from fricmb.errors import unknown_name
from fricmb.laws import FrictionLaw
from fricmb.laws._creep import Creep
from fricmb.scene import Scene
from fricmb.solution import Solution


@dataclass(frozen=True, kw_only=True)
class Regime:
    """A scene under one form of a contact's law.

    Attributes
    ----------
    name : str
        "set-valued", "regularised" or "bristle".
    law : FrictionLaw
    creep : Creep
        Of the law, under half its break-away.
    solution : Solution
    crept : float
        Distance that the contact moves (integral of its slip speed) while the set-valued contact sticks; largest of all
        its sticks.
    creep_speed : float
        Largest slip speed in the middle half of its sticks.
    deviation : float
        Largest difference of a position from that of the set-valued run, relative to the largest position.
    """

    name: str
    law: FrictionLaw
    creep: Creep
    solution: Solution
    crept: float
    creep_speed: float
    deviation: float

    def __str__(self) -> str:
        return (
            f"{self.name:12s} creeps {self.crept:.3g} a stick, at up to {self.creep_speed:.3g}; positions differ by"
            f" {self.deviation:.2e}; {self.solution.stats.n_steps} steps"
        )


@answers
def compare_regimes(
    scene: Scene, contact: str, *, v_reg: float, stiffness: float, t_end: float, v_s: float | None = None,
    damping: float = 0.0, points: int = 4001, **options: Any,
) -> tuple[Regime, Regime, Regime]:  # fmt: skip
    """Run a scene with a set-valued law, with its regularised form, and with its bristle form.

    Parameters
    ----------
    scene : Scene
    contact : str
        The contact whose law is replaced; a set-valued law.
    v_reg : float
        See :class:`fricmb.laws.Regularised`.
    stiffness, damping, v_s : float
        See :class:`fricmb.laws.Bristle`.
    t_end : float
    points : int
        Times at which runs are compared.
    **options
        Of :func:`fricmb.simulate`.

    Returns
    -------
    tuple of Regime
        Set-valued, regularised, bristle.
    """
    who = "compare_regimes"
    names = [part.name for part in checked_scene(who, scene).contacts]
    if not isinstance(contact, str) or contact not in names:
        raise unknown_name("contact", contact, names)
    check_options(who, options, simulate, "t_end", "t_eval", call=compare_regimes)
    points = checked_integer(who, "points", points, 2, 10_000_000)
    t_end = positive(who, "t_end", t_end)
    part: Any = scene[contact]
    law: FrictionLaw = part.law
    forms = {
        "set-valued": law,
        "regularised": law.regularised(v_reg),
        "bristle": law.bristle(stiffness, damping=damping, v_s=v_s),
    }
    t = np.linspace(0.0, t_end, points)
    runs = {
        name: simulate(scene.replace(contact, law=form), t_end=t_end, t_eval=t, **options)
        for name, form in forms.items()
    }
    sticks = _sticks(runs["set-valued"], contact, t)
    reference = runs["set-valued"].q
    found = []
    for name, sol in runs.items():
        speed = np.linalg.norm(sol.relative_velocity(contact), axis=0)
        crept = [float(np.trapezoid(speed[a:b], t[a:b])) for a, b in sticks]
        middle = [speed[a + (b - a) // 4 : b - (b - a) // 4].max(initial=0.0) for a, b in sticks]
        deviation = float(np.abs(sol.q - reference).max() / np.abs(reference).max())
        found.append(
            Regime(
                name=name, law=forms[name], creep=forms[name].creep(0.5), solution=sol, crept=max(crept, default=0.0),
                creep_speed=float(max(middle, default=0.0)), deviation=deviation,
            )
        )  # fmt: skip
    return tuple(found)  # type: ignore[return-value]


def _sticks(sol: Solution, contact: str, t: Any) -> list[tuple[int, int]]:
    """Ranges of indices in which a contact sticks."""
    stuck = np.concatenate([[False], sol.mode(contact) == 0, [False]])
    edges = np.flatnonzero(np.diff(stuck.astype(int)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a > 3]
