"""Derivatives by differences of runs: what the tangent pass is compared with, and shares no code with."""

import re
from collections.abc import Sequence
from typing import Any

import numpy as np

import fricmb as fm


def _ends(sol: Any) -> np.ndarray:
    """State at the end, then times of events."""
    return np.concatenate([sol.q[:, -1], sol.v[:, -1], sol.events.t])


def _kinds(sol: Any) -> dict[str, list[str]]:
    """Of each contact what happens to it, in order."""
    found: dict[str, list[str]] = {}
    for event in sol.events:
        found.setdefault(event.contact, []).append(event.kind)
    return found


def _run(scene: Any, name: str, value: float, options: dict[str, Any]) -> Any:
    return fm.simulate(scene, parameters={name: value}, rtol=1e-12, **options)


def difference(scene: Any, name: str, *, step: float = 2e-3, **options: Any) -> tuple[np.ndarray, np.ndarray] | None:
    """Richardson's difference of the state at the end and of event times, and how sure it is.

    None where the order of events changes between the runs: there is no difference that means anything.
    """
    p = float(scene.parameters[name])
    size = max(abs(p), 0.1) * step
    base = _kinds(_run(scene, name, p, options))
    slopes = []
    for h in (4.0 * size, 2.0 * size, size):
        try:
            both = [_run(scene, name, p + sign * h, options) for sign in (1.0, -1.0)]
        except fm.LawError:  # at the end of what the law takes (mu_k = mu_s)
            return None
        if any(_kinds(sol) != base for sol in both):
            return None
        slopes.append((_ends(both[0]) - _ends(both[1])) / (2.0 * h))
    first, second = (4.0 * slopes[1] - slopes[0]) / 3.0, (4.0 * slopes[2] - slopes[1]) / 3.0
    best = (16.0 * second - first) / 15.0
    return best, np.abs(best - second) + 1e-11 / size


def derived(sol: Any, name: str) -> np.ndarray:
    """The same of the tangent pass."""
    signals = [*sol.dof_names, *(f"{dof}.velocity" for dof in sol.dof_names)]
    return np.array([*(sol.sensitivity(s, name)[-1] for s in signals), *(e.sensitivity(name) for e in sol.events)])


def agreed(found: Sequence[tuple[np.ndarray, np.ndarray] | None]) -> tuple[np.ndarray, np.ndarray] | None:
    """Of differences of two steps the better, and no surer than the two agree."""
    sure = sorted((one for one in found if one is not None), key=lambda one: one[1].max())
    if len(sure) < 2:
        return sure[0] if sure else None
    (value, unsure), (other, less) = sure
    return value, np.maximum(unsure, np.maximum(np.abs(value - other) - less, 0.0))


def shares_off(
    sol: Any, names: Sequence[str], *, steps: Sequence[float] = (2e-3, 2e-4), enough: float = 0.0, **options: Any
) -> dict[str, float]:
    """Of derivatives of a run how far they are from differences of runs, less what these are unsure by.

    In shares of the largest; by parameters whose differences mean anything.  Of the steps of differences the second is
    taken where the first leaves open whether derivatives are within ``enough``.
    """
    found = {}
    for name in names:
        own, differences = derived(sol, name), []
        for step in steps:
            differences.append(difference(sol.scene, name, step=step, **options))
            best = agreed(differences)
            if best is None:
                continue
            value, unsure = best
            off, size = np.abs(own - value), max(float(np.abs(value).max()), 1e-2)
            found[name] = float(np.maximum(off - 3.0 * unsure, 0.0).max() / size)
            if (off + 3.0 * unsure).max() < enough * size:
                break
    return found


def said(sol: Any) -> list[float]:
    """By how much of their size derivatives may be off as notes of a run say, or to how much they are known."""
    sizes = re.compile(r"(?:by|to) (\d\S+?),? (?:of their size|')")
    return [float(x) for note in sol.stats.notes for x in sizes.findall(note)]


def worst(
    scene: Any, names: Sequence[str], *, rtol: float, step: float = 2e-3, events: bool = True, **options: Any
) -> dict[str, float]:
    """Largest error of each derivative in tolerances of its size, less what the difference is unsure by.

    Sizes are at least 0.01, scenes being of the order of 1.  ``events``: of the times of events as well.  A difference
    that is no surer than 1000 tolerances says nothing.
    """
    sol = fm.simulate(scene, sensitivities=tuple(names), rtol=rtol, **options)
    found = {}
    for name in names:
        expected = difference(scene, name, step=step, **options)
        if expected is None:
            continue
        value, unsure = expected
        n = len(sol.dof_names)
        own = derived(sol, name)
        groups = (slice(0, n), slice(n, 2 * n), slice(2 * n, None))
        errors, least = [0.0], 1e-2 * float(np.abs(value).max()) + 1e-2
        for group in groups if events else groups[:2]:
            if own[group].size:
                size = max(float(np.abs(value[group]).max()), least)
                assert (unsure[group] <= 1e3 * rtol * size).all(), (name, unsure)
                off = np.maximum(np.abs(own[group] - value[group]) - 3.0 * unsure[group], 0.0)
                errors.append(float(off.max() / size))
        found[name] = max(errors) / rtol
    return found
