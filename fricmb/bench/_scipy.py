"""scipy's solvers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from fricmb.bench._kernels import jacobian, right_hand_side
from fricmb.bench._method import Method
from fricmb.bench._peers import Answer, PeerError, Smoothed
from fricmb.bench._reference import Floats
from fricmb.bench._smooth import SmoothScene


@dataclass(frozen=True)
class Scipy(Smoothed):
    """A method of ``scipy.integrate.solve_ivp``."""

    method: str

    @property
    def name(self) -> str:  # type: ignore[override]
        """As shown."""
        return f"scipy {self.method}"

    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Run ``solve_ivp``."""
        size = len(scene.start)
        options: dict[str, Any] = {"method": self.method, "rtol": rtol, "atol": atol, "t_eval": None if steps else t}
        banded = self.method == "LSODA" and 4 * scene.band < size
        if banded:
            options |= {"lband": scene.band, "uband": scene.band}
        elif self.method != "DOP853":
            options["jac"] = lambda t, y: _full(t, y, scene)
        floats, ints = scene.floats, scene.ints

        def rhs(t: float, y: Floats) -> Floats:
            out = np.empty(size)
            right_hand_side(t, y, out, floats, ints)
            return out

        sol = solve_ivp(rhs, (float(t[0]), float(t[-1])), scene.start, **options)
        if not sol.success or not np.isfinite(sol.y).all():
            raise PeerError(f"{self.name}: {sol.message}")
        counters = {"n_rhs": int(sol.nfev), "n_jac": int(sol.njev), "n_lu": int(sol.nlu)}
        return Answer(t=sol.t, y=sol.y, counters=counters if not steps else {"n_steps": len(sol.t) - 1})


def _full(t: float, y: Floats, scene: SmoothScene) -> Floats:
    out = np.zeros((len(y), len(y)))
    jacobian(t, y, out, scene.floats, scene.ints)
    return out


def scipy_methods() -> list[Method]:
    """LSODA, BDF, Radau, DOP853."""
    return [Scipy(method) for method in ("LSODA", "BDF", "Radau", "DOP853")]
