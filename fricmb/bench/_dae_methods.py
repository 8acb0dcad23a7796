"""Solvers of implicit equations of index 1: ``solve_dae`` and its nearest peer, on the same compiled residual.

An equation that describes a mechanism is also run as one, from its bodies and joints.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np

import fricmb as fm
from fricmb._simulate._compile_watch import CompileWatch
from fricmb.bench._cell import Outcome, one_line
from fricmb.bench._daes import DaeCase
from fricmb.bench._metrics import Metrics
from fricmb.bench._peers import PeerError
from fricmb.bench._reference import Floats
from fricmb.bench._run import Setting
from fricmb.bench._timed import timed
from fricmb.errors import FricmbError

TOLERANCES = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
#: Absolute tolerance of a component: this, times rtol, times its size at the end.
FLOOR = 1e-2


class DaeMethod(ABC):
    """Base: solve the case, return the state at its end and counters."""

    name: str
    peer: bool

    @abstractmethod
    def solve(self, case: DaeCase, rtol: float) -> tuple[Floats, dict[str, int]]:
        """The solution at ``case.t_end``; raises where the solver gives up."""

    def takes(self, case: DaeCase) -> bool:
        """Whether it can solve the case."""
        return True

    def settings(self, quick: bool) -> list[Setting]:
        """Tolerances from loose to tight."""
        return [Setting(rtol=rtol) for rtol in (TOLERANCES[1:6:2] if quick else TOLERANCES)]


@dataclass(frozen=True)
class SolveDae(DaeMethod):
    """``fm.solve_dae``."""

    name: str = "solve_dae"
    peer: bool = False

    def solve(self, case: DaeCase, rtol: float) -> tuple[Floats, dict[str, int]]:
        """Run it with the residual alone; derivatives by differences."""
        sol: Any = fm.solve_dae(
            case.residual, (0.0, case.t_end), case.y0, case.yp0, rtol=rtol, atol=FLOOR * rtol * case.size,
            t_eval=[case.t_end],
        )  # fmt: skip
        if not sol.success:
            raise fm.FricmbError(sol.message)
        counters = {"n_steps": sol.nsteps, "n_rejected": sol.nrejected, "n_rhs": sol.nfev, "n_jac": sol.njev}
        return sol.y[:, -1], {**counters, "n_lu": sol.nlu}


@dataclass(frozen=True)
class Mechanism(DaeMethod):
    """``fm.simulate`` of the bodies and joints that the equation describes."""

    name: str = "simulate"
    peer: bool = False

    def takes(self, case: DaeCase) -> bool:
        """Where there is such a scene."""
        return case.scene is not None

    def solve(self, case: DaeCase, rtol: float) -> tuple[Floats, dict[str, int]]:
        """Run the scene."""
        if case.scene is None or case.read is None:
            raise TypeError(f"{case.name} has no scene")
        sol = fm.simulate(case.scene(), t_end=case.t_end, rtol=rtol)
        stats = sol.stats
        return case.read(sol), {"n_steps": stats.n_steps, "n_rejected": stats.n_rejected, "n_rhs": stats.n_rhs,
                                "n_jac": stats.n_jac, "n_lu": stats.n_lu}  # fmt: skip


@dataclass(frozen=True)
class IdaDae(DaeMethod):
    """IDA of SUNDIALS through scikit-sundae."""

    name: str = "IDA"
    peer: bool = True

    def solve(self, case: DaeCase, rtol: float) -> tuple[Floats, dict[str, int]]:
        """Run it with the residual alone; derivatives by differences."""
        from sksundae.ida import IDA

        compiled = case.residual

        def residual(t: float, y: Floats, yp: Floats, out: Floats) -> None:
            compiled(t, y, yp, out)

        solver = IDA(
            residual, rtol=rtol, atol=FLOOR * rtol * case.size, max_num_steps=10_000_000,
            algebraic_idx=list(case.algebraic) or None,
        )  # fmt: skip
        sol = solver.solve(np.array([0.0, 0.5 * case.t_end, case.t_end]), case.y0, case.yp0)
        if not sol.success:
            raise PeerError(f"IDA: {sol.message}")
        return np.asarray(sol.y)[-1], {"n_rhs": int(sol.nfev), "n_jac": int(sol.njev)}


@dataclass(frozen=True)
class Explicit(DaeMethod):
    """DOP853 of scipy, where the equation is an explicit one."""

    name: str = "scipy DOP853"
    peer: bool = True

    def takes(self, case: DaeCase) -> bool:
        """Where its rates are there."""
        return case.rates is not None

    def solve(self, case: DaeCase, rtol: float) -> tuple[Floats, dict[str, int]]:
        """Run it with the compiled rates."""
        from scipy.integrate import solve_ivp

        rates = case.rates
        if rates is None:
            raise TypeError(f"{case.name} is no explicit equation")

        def right(t: float, y: Floats) -> Floats:
            out = np.empty(y.size)
            rates(t, y, out)
            return out

        span, atol = (0.0, case.t_end), FLOOR * rtol * case.size
        sol = solve_ivp(right, span, case.y0, method="DOP853", rtol=max(rtol, 1e-13), atol=atol, t_eval=[case.t_end])
        if not sol.success:
            raise PeerError(f"DOP853: {sol.message}")
        return np.asarray(sol.y[:, -1]), {"n_rhs": int(sol.nfev)}


def dae_methods() -> list[DaeMethod]:
    """What is installed."""
    return [SolveDae(), Mechanism(), Explicit(), *([IdaDae()] if find_spec("sksundae") else [])]


def measure_dae(case: DaeCase, method: DaeMethod, setting: Setting) -> Outcome:
    """Run a cell: error of the state at the end, relative in each component, and the least time of several."""
    known: dict[str, Any] = {"case": case.name, "method": method.name, "setting": setting, "peer": method.peer}
    rtol = 1e-6 if setting.rtol is None else setting.rtol
    times: list[float] = []
    try:
        with CompileWatch() as watch:
            y, counters = method.solve(case, rtol)
        while not times or (sum(times) < 0.5 and len(times) < 5):
            times.append(timed(lambda: method.solve(case, rtol))[1])
    except (FricmbError, ArithmeticError, ValueError, RuntimeError, TypeError) as error:
        return Outcome(**known, failure=one_line(error))
    known_part = slice(None, case.compared)
    worst = float((np.abs(y[known_part] - case.end) / case.size[known_part]).max())
    state = worst if np.isfinite(worst) else float("inf")
    return Outcome(
        **known, metrics=Metrics(state=state, grown=state), seconds=min(times), first=watch.seconds, counters=counters
    )
