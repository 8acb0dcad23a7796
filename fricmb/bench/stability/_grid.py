"""The grid: every extreme scene through every integrator; a verdict for each."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import fricmb as fm
from fricmb.bench._cell import one_line
from fricmb.bench._store import Store
from fricmb.bench._worker import CellEnded, Worker
from fricmb.bench.stability._axis import measure_axis
from fricmb.bench.stability._contacts import contacts
from fricmb.bench.stability._extreme import RTOL, Extreme
from fricmb.bench.stability._structures import structures
from fricmb.errors import FricmbError, IntegrationError, SceneError

#: Verdicts, best first.  "wrong" is the one that must not occur.
VERDICTS = ("correct", "noted", "refused", "failed", "slow", "wrong", "crashed")


def scenes() -> list[Extreme]:
    """All scenes of the grid."""
    return [*structures(), *contacts()]


def judge(scene: Extreme, method: str) -> dict[str, Any]:
    """Run one scene.

    Verdicts: "correct" to tolerance; "refused" before the run; "failed" with an error that says why; "wrong", or
    "noted" where the run's notes say that its result may be another one.
    """
    adaptive = method == "auto" or fm.integrators[method].adaptive
    if adaptive and scene.group == "step too large":
        return _verdict(scene, method, "refused", why="chooses its steps itself")
    if not adaptive and not scene.steps:
        return _verdict(scene, method, "refused", why="a fixed step: not part of this scene")
    options: dict[str, Any] = {"rtol": RTOL} if adaptive else {"step": scene.steps[0]}
    begin = time.perf_counter()
    try:
        sol = fm.simulate(scene.build(), t_end=scene.t_end, method=method, **options)
    except SceneError as error:
        return _verdict(scene, method, "refused", why=str(error))
    except IntegrationError as error:
        return _verdict(scene, method, "failed", why=str(error))
    except FricmbError as error:
        return _verdict(scene, method, "failed", why=one_line(error))
    seconds = time.perf_counter() - begin
    error_found = scene.error(sol)
    allowed = scene.allowed if adaptive else 0.05
    right = bool(error_found <= allowed)
    verdict = "correct" if right else ("noted" if sol.stats.notes else "wrong")
    found = _verdict(scene, method, verdict, why="; ".join(sol.stats.notes) if not right else "")
    shown = float(error_found) if np.isfinite(error_found) else None
    return found | {"error": shown, "seconds": seconds, "steps": sol.stats.n_steps, "used": sol.stats.method}


def _verdict(scene: Extreme, method: str, verdict: str, why: str = "") -> dict[str, Any]:
    return {
        "group": scene.group, "value": scene.value, "method": method, "verdict": verdict,
        "why": " ".join(why.split())[:300],
    }  # fmt: skip


def judge_named(name: str, method: str) -> dict[str, Any]:
    """The same by the scene's name, in whatever process."""
    return judge(next(scene for scene in scenes() if scene.name == name), method)


def quick_scenes() -> list[Extreme]:
    """One scene of each group, short ones."""
    first: dict[str, Extreme] = {}
    for scene in scenes():
        if scene.group not in ("long run", "stiffness ratio", "step too large"):
            first.setdefault(scene.group, scene)
    return list(first.values())


#: A scene that every integrator runs at once.
_EASY = "mass ratio, caught: 1000"


def run_stability(
    quick: bool, limit: float, store: Store, progress: Callable[[int, int, str], None] | None = None
) -> dict[str, Any]:
    """Judge every scene with every integrator, and measure what becomes of vibration that steps do not resolve."""
    methods = ["auto", *fm.integrators]
    jobs: list[tuple[str, Callable[..., dict[str, Any]], tuple[Any, ...]]] = [
        (f"grid/{scene.name}/{method}", judge_named, (scene.name, method))
        for scene in (quick_scenes() if quick else scenes())
        for method in (methods[:2] if quick else methods)
    ]
    adaptive = [name for name, kind in fm.integrators.items() if kind.adaptive]
    jobs += [
        (f"axis/{method}/{stuck}", measure_axis, (method, stuck))
        for method in (adaptive[:1] if quick else adaptive)
        for stuck in (False, True)
    ]
    with Worker() as worker:
        if any(store.get(key) is None for key, _, _ in jobs):
            # what is compiled is not to count against a limit
            worker.warm(*((judge_named, (_EASY, method)) for method in methods))
        for i, (key, function, arguments) in enumerate(jobs):
            if progress is not None:
                progress(i, len(jobs), key)
            if store.get(key) is None:
                store.put(key, _guarded(worker, function, arguments, limit))
        if progress is not None:
            progress(len(jobs), len(jobs), "")
    return {
        "grid": [store.get(key) for key, _, _ in jobs if key.startswith("grid/")],
        "axis": [store.get(key) for key, _, _ in jobs if key.startswith("axis/")],
    }


def _guarded(
    worker: Worker, function: Callable[..., dict[str, Any]], arguments: tuple[Any, ...], limit: float
) -> dict[str, Any]:
    try:
        found: dict[str, Any] = worker.run(function, *arguments, limit=limit)
        return found
    except CellEnded as error:
        message = str(error)
    if function is measure_axis:
        return {"method": arguments[0], "state": "stuck" if arguments[1] else "sliding", "failure": message}
    group, _, value = arguments[0].partition(": ")
    verdict = "slow" if message.startswith("not done") else "crashed"
    return {"group": group, "value": value, "method": arguments[1], "verdict": verdict, "why": message}
