"""CVODE and IDA of SUNDIALS through scikit-sundae (extra ``peers``)."""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

from fricmb.bench._kernels import jacobian, right_hand_side
from fricmb.bench._method import Method
from fricmb.bench._peers import Answer, PeerError, Smoothed
from fricmb.bench._reference import Floats
from fricmb.bench._smooth import SmoothScene

#: Steps allowed between two output times.
MANY = 10_000_000


@dataclass(frozen=True)
class Cvode(Smoothed):
    """CVODE, BDF."""

    name: str = "CVODE"

    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Run CVODE with the analytic Jacobian, or with a band."""
        from sksundae.cvode import CVODE

        floats, ints = scene.floats, scene.ints
        options: dict[str, Any] = {"rtol": rtol, "atol": atol, "max_num_steps": MANY}

        def rhs(t: float, y: Floats, yp: Floats) -> None:
            right_hand_side(t, y, yp, floats, ints)

        def jac(t: float, y: Floats, yp: Floats, J: Floats) -> None:
            J[:] = 0.0
            jacobian(t, y, J, floats, ints)

        if 4 * scene.band < len(scene.start):
            options |= {"linsolver": "band", "lband": scene.band, "uband": scene.band}
        else:
            options["jacfn"] = jac
        sol = CVODE(rhs, **options).solve(t, scene.start)
        return _answer(self.name, sol)


@dataclass(frozen=True)
class Ida(Smoothed):
    """IDA on the residual y' - f(t, y)."""

    name: str = "IDA"

    def solve(self, scene: SmoothScene, t: Floats, rtol: float, atol: Floats, steps: bool) -> Answer:
        """Run IDA with the analytic Jacobian, or with a band."""
        from sksundae.ida import IDA

        floats, ints = scene.floats, scene.ints
        size = len(scene.start)
        options: dict[str, Any] = {"rtol": rtol, "atol": atol, "max_num_steps": MANY}

        def residual(t: float, y: Floats, yp: Floats, res: Floats) -> None:
            right_hand_side(t, y, res, floats, ints)
            np.subtract(yp, res, out=res)

        def jac(t: float, y: Floats, yp: Floats, res: Floats, cj: float, J: Floats) -> None:
            J[:] = 0.0
            jacobian(t, y, J, floats, ints)
            np.negative(J, out=J)
            J[np.arange(size), np.arange(size)] += cj

        if 4 * scene.band < size:
            options |= {"linsolver": "band", "lband": scene.band, "uband": scene.band}
        else:
            options["jacfn"] = jac
        sol = IDA(residual, **options).solve(t, scene.start, scene.rhs(float(t[0]), scene.start))
        return _answer(self.name, sol)


def _answer(name: str, sol: Any) -> Answer:
    if not sol.success or not np.isfinite(sol.y).all():
        raise PeerError(f"{name}: {sol.message}")
    counters = {"n_rhs": int(sol.nfev), "n_jac": int(sol.njev)}
    return Answer(t=np.asarray(sol.t), y=np.ascontiguousarray(np.asarray(sol.y).T), counters=counters)


def sundials_methods() -> list[Method]:
    """CVODE and IDA where scikit-sundae is installed."""
    return [Cvode(), Ida()] if find_spec("sksundae") else []
