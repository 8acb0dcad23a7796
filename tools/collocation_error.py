"""Error of collocation over ``rtol`` on the certified references: ``python tools/collocation_error.py [out.json]``.

Errors are the largest of all positions and velocities at all times, each scaled by its largest value, over the growth
that the scene itself has.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from functools import partial
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import numpy as np

import fricmb as fm

TOLERANCES = [10.0**-k for k in range(3, 12)]


def planar(friction: float, position: tuple[float, float], velocity: tuple[float, float]) -> Callable[[], fm.Scene]:
    """A mass on two springs that slides in the plane."""
    return partial(fm.models.planar_oscillator, friction=friction, position=position, velocity=velocity)


SCENES: dict[str, Callable[[], fm.Scene]] = {
    "p1_1": partial(fm.models.brake4dof, "1"),
    "p1_2": partial(fm.models.brake4dof, "2"),
    "p1_5": partial(fm.models.brake4dof, "5"),
    "p2_a": partial(fm.models.belt_oscillator, damping=0.0),
    "p2_b": partial(fm.models.belt_oscillator, damping=0.05),
    "p5_a": planar(0.3, (2.0, 0.0), (0.0, 1.7)),
    "p5_b": planar(0.1, (2.0, 0.0), (0.0, 1e-2)),
    "p5_d": planar(0.05, (2.0, 0.3), (0.0, 1e-4)),
    "p5_e": planar(0.1, (2.0, 1.0), (0.0, 0.0)),
}


def error_of(reference: dict[str, Any], sol: fm.Solution) -> float:
    """The largest error of a run."""
    growth = np.maximum.accumulate(reference["growth"])[:, None] if "growth" in reference else 1.0
    worst = 0.0
    for got, true in ((sol.q, reference["q"]), (sol.v, reference["v"])):
        size = np.abs(true).max(axis=0)
        worst = max(worst, float((np.abs(got.T - true) / np.where(size > 0, size, 1.0) / growth).max()))
    return worst


def main() -> None:
    """Print and write the ratios."""
    root = Path(__file__).parents[1]
    spec = spec_from_file_location("reference", root / "tests/reference.py")
    tests = module_from_spec(spec)
    spec.loader.exec_module(tests)
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else root / "docs/benchmark/collocation_error.json"
    found = []
    for name, make in SCENES.items():
        reference, scene = tests.load(name), make()
        t = reference["t"]
        ratios = []
        for rtol in TOLERANCES:
            sol = fm.simulate(scene, t_end=float(t[-1]), rtol=rtol, t_eval=t, method="collocation")
            ratios.append(float(f"{error_of(reference, sol) / rtol:.1e}"))
        found.append({"scene": name, "rtol": TOLERANCES, "error_over_rtol": ratios})
        print(f"{name:20}", *(f"{x:7.0e}" for x in ratios), flush=True)
    out.write_text("[\n" + ",\n".join(json.dumps(row) for row in found) + "\n]\n")


if __name__ == "__main__":
    main()
