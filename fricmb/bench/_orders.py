"""Order of convergence of each formula, on motion without transitions: error against number of steps."""

from __future__ import annotations

from typing import Any

import numpy as np

import fricmb as fm
from fricmb import models
from fricmb.bench._cell import one_line
from fricmb.bench._fit import order
from fricmb.bench._reference import shipped
from fricmb.errors import FricmbError
from fricmb.integrate import Integrator

#: The rough plane of ``planar_e``: slip in a turning direction, without a transition until t = 37.
T_END = 30.0
TOLERANCES = tuple(10.0**-k for k in range(2, 13))
STEPS = (0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
#: Beyond so many steps the order of a formula has been seen; one of order 2 takes a million for the tightest tolerance.
ENOUGH = 20_000


def configurations() -> list[tuple[str, dict[str, Any]]]:
    """Every integrator, and every number of stages or nodes where it can be set: (label, class name and options)."""
    found: list[tuple[str, dict[str, Any]]] = []
    for name, kind in fm.integrators.items():
        fields = getattr(kind, "__dataclass_fields__", {})
        option, counts = ("stages", range(2, 10)) if name == "radau" else ("nodes", range(4, 10))
        if option in fields and name != "bdf":
            found += [(f"{name}, {option} {count}", {"name": name, option: count}) for count in counts]
        else:
            found.append((name, {"name": name}))
    return found


def measure_order(label: str) -> dict[str, Any]:
    """Number of steps and state error over a ladder, and the fitted order."""
    options = dict(dict(configurations())[label])
    integrator: Integrator = fm.integrators[options.pop("name")](**options)
    steps: list[int] = []
    errors: list[float] = []
    try:
        for setting in TOLERANCES if integrator.adaptive else STEPS:
            n, error = _run(integrator, setting)
            steps.append(n)
            errors.append(error)
            if n > ENOUGH:
                break
    except FricmbError as reason:
        return {"method": label, "failure": one_line(reason)}
    # fewer steps for a tighter tolerance: another formula has taken over
    first = next((i for i in range(1, len(steps)) if steps[i] < steps[i - 1]), len(steps))
    return {"method": label, "steps": steps, "errors": errors, "order": _fitted(steps[:first], errors[:first])}


def _fitted(steps: list[int], errors: list[float]) -> float | None:
    """The order, where there are more than two points, and steps differ by enough to show one."""
    if len(steps) < 3 or max(steps) < 2 * min(steps):
        return None
    return order(steps, errors)


def _run(integrator: Integrator, setting: float) -> tuple[int, float]:
    reference = shipped("p5_e")
    grid = reference.t <= T_END
    scene = models.planar_oscillator(friction=0.1, position=(2.0, 1.0), velocity=(0.0, 0.0))
    options: dict[str, Any] = {"rtol": setting} if integrator.adaptive else {"step": setting}
    sol = fm.simulate(scene, t_end=T_END, t_eval=reference.t[grid], method=integrator, **options)
    true = np.concatenate([reference.q, reference.v])[:, grid]
    error = np.abs(np.concatenate([sol.q, sol.v]) - true).max(axis=1) / np.abs(true).max(axis=1)
    return sol.stats.n_steps, float(error.max())
