"""Rules of a model's run."""

from __future__ import annotations

import hashlib
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricmb._simulate import simulate
from fricmb.integrate import Integrator
from fricmb.scene import Scene
from fricmb.solution import Solution
from fricmb.testing._base import Floats


@dataclass(frozen=True, kw_only=True)
class Trip:
    """How a scene is run, and the bound on what may be missing."""

    t_end: float
    method: str | Integrator
    rtol: float
    bound: float
    step: float | None = None

    def go(
        self, scene: Scene, t_end: float, initial: Solution | None = None, t_eval: Floats | None = None
    ) -> Solution:
        """A run, or what goes on from another."""
        options: dict[str, Any] = {"initial": initial, "t_eval": t_eval, "step": self.step}
        return simulate(scene, t_end=t_end, method=self.method, rtol=self.rtol, **options)


def run_findings(scene: Scene, trip: Trip) -> Iterator[str]:
    """All that is wrong with a run."""
    try:
        sol = trip.go(scene, trip.t_end)
    except Exception as error:
        yield f"a run to t_end = {trip.t_end:g} fails: {type(error).__name__}: {error}"
        return
    for rule in (_ends, _ledger, _repeats, _goes_on, _saves):
        try:
            yield from rule(scene, trip, sol)
        except Exception as error:
            yield f"{str(rule.__doc__).rstrip('.').lower()} fails: {type(error).__name__}: {error}"


def _ends(scene: Scene, trip: Trip, sol: Solution) -> Iterator[str]:
    """The end of the run."""
    if sol.t[-1] != trip.t_end:
        yield f"a run to t_end = {trip.t_end:g} ends at {sol.t[-1]:g}"
    bad = [name for name in sol.dof_names if not np.isfinite([sol[name], sol.velocity(name)]).all()]
    if bad:
        yield f"a run is not finite in {', '.join(bad)}"


def _ledger(scene: Scene, trip: Trip, sol: Solution) -> Iterator[str]:
    """The energy ledger."""
    worst = float(np.abs(sol.energy.residual).max())
    if not worst <= trip.bound:
        yield f"the energy ledger misses {worst:.2e} of its largest term, more than {trip.bound:g}"


def digest(sol: Solution) -> str:
    """Of times, positions and velocities, to the last digit."""
    return hashlib.sha256(b"".join(np.ascontiguousarray(a).tobytes() for a in (sol.t, sol.q, sol.v))).hexdigest()


def _repeats(scene: Scene, trip: Trip, sol: Solution) -> Iterator[str]:
    """The same run again."""
    if digest(trip.go(scene, trip.t_end)) != digest(sol):
        yield "the same run again has other digits"


def _goes_on(scene: Scene, trip: Trip, sol: Solution) -> Iterator[str]:
    """A run that goes on from its middle."""
    half = trip.go(scene, 0.5 * trip.t_end)
    end = trip.go(scene, trip.t_end, half)(trip.t_end)
    straight = sol(trip.t_end)
    gap, scale = np.abs(end - straight), _scale(sol)
    far = (gap > trip.bound * scale) & (gap > 1e-12)
    if far.any():
        names = [*sol.dof_names, *(f"{name} (velocity)" for name in sol.dof_names)]
        worst = int(np.argmax(np.where(far, gap / np.maximum(scale, 1e-300), 0.0)))
        yield f"in two halves it ends with {names[worst]} = {end[worst]:.9g}, straight with {straight[worst]:.9g}"


def _scale(sol: Solution) -> Floats:
    """Largest coordinate and largest velocity of the run, for each row of its state."""
    n = len(sol.dof_names)
    return np.repeat([np.abs(sol.q).max(), np.abs(sol.v).max()], n)


def _saves(scene: Scene, trip: Trip, sol: Solution) -> Iterator[str]:
    """Saving and loading."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "run.npz"
        sol.save(file)
        again = Solution.load(file)
    if digest(again) != digest(sol) or again.events != sol.events:
        yield "saved and loaded it is another run"
