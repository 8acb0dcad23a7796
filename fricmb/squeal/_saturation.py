"""Where the growth of a mode ends: runs until the vibration keeps its size, and the limit cycle that it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg

from fricmb._simulate import simulate
from fricmb.analysis import AnalysisError, Cycle, SteadySliding, limit_cycle
from fricmb.errors import IntegrationError, unknown_name
from fricmb.squeal._growth import _room, pushed

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Speed of the first vibration, in parts of the speed of slip.
_FIRST = 0.1
#: Periods of the mode in one piece of the run, change of its amplitude that counts as settled, most pieces.
_PIECE, _SETTLED, _PIECES = 40, 0.01, 40
#: Powers of e by which the mode has to grow before it is looked whether it has settled.
_POWERS = 5.0


@dataclass(frozen=True, kw_only=True)
class Saturation:
    """The vibration that a growing mode ends in.

    Attributes
    ----------
    at : dict of str to float
        Values of the parameters.
    eigenvalue : complex
        The mode that it began with.
    amplitude : dict of str to float
        Half the range of each degree of freedom over the last periods.
    settled : bool
        Whether amplitudes kept their size to 1 % over the last two pieces of the run.
    cycle : Cycle or None
        The limit cycle that the run ended near, where Newton's method finds one.
    why : str
        Why there is no cycle; "" where there is one.
    solution : Solution
        The last piece of the run.
    """

    at: Mapping[str, float]
    eigenvalue: complex
    amplitude: Mapping[str, float]
    settled: bool
    cycle: Cycle | None
    why: str
    solution: Solution

    def __str__(self) -> str:
        most = max(self.amplitude, key=lambda name: self.amplitude[name], default="")
        lines = ["settled" if self.settled else "not settled: amplitudes still change"]
        lines += [f"  amplitude of {most}: {self.amplitude[most]:.6g}"] if most else []
        lines.append(f"  {self.cycle}" if self.cycle is not None else f"  no limit cycle: {self.why}")
        return "\n".join(lines)


def saturation(
    steady: SteadySliding, at: Mapping[str, float], near: complex, closed: bool, options: Mapping[str, Any]
) -> Saturation:
    """Run a scene from steady sliding with a push along the mode next to ``near`` until it keeps its size.

    Parameters
    ----------
    closed : bool
        Whether the limit cycle is looked for.
    """
    values, right = scipy.linalg.eig(steady.matrix())
    k = int(np.argmin(np.abs(values - near)))
    value = complex(values[k])
    if not value.imag:
        raise AnalysisError(f"saturation: the mode does not oscillate; its eigenvalue is {value.real:.6g}")
    period = 2.0 * np.pi / abs(value.imag)
    begin = _POWERS / value.real if value.real > 0.0 else 0.0
    names = [steady.system.dof_names[i] for i in steady.free]
    start: Any = pushed(steady, _FIRST * _room(steady, right[:, k]) * right[:, k])
    known: dict[str, float] = {}
    settled, end = False, 0.0
    for piece in range(_PIECES):
        end += _PIECE * period + (begin if piece == 0 else 0.0)
        sol = simulate(steady.scene, t_end=end, initial=start, **{"rtol": 1e-6, **options})
        found = _amplitudes(sol, names, end - _PIECE * period)
        size = max(found.values(), default=0.0)
        settled = bool(known) and all(abs(found[name] - known[name]) <= _SETTLED * size for name in names)
        start, known = sol, found
        if settled:
            break
    cycle, why = _cycle(steady, sol, options) if closed else (None, "not looked for")
    if cycle is not None:
        exact = {name: cycle.amplitude(name) for name in names}
        why = _differs(cycle, known, exact)
        cycle, known = (None, known) if why else (cycle, exact)
    return Saturation(
        at=dict(at), eigenvalue=value, amplitude=known, settled=settled, cycle=cycle, why=why, solution=sol
    )


def _amplitudes(sol: Solution, names: list[str], begin: float) -> dict[str, float]:
    """Half the range of motions from a time on."""
    seen = sol.at(np.linspace(max(begin, sol.t_start), sol.t_end, 64 * _PIECE + 1))
    return {name: 0.5 * float(np.ptp(seen[name])) for name in names}


def _cycle(steady: SteadySliding, sol: Solution, options: Mapping[str, Any]) -> tuple[Cycle | None, str]:
    """The limit cycle near the end of a run, or why there is none."""
    kept = {name: value for name, value in options.items() if name not in ("rtol", "t_eval", "observe")}
    try:
        found: Cycle = limit_cycle(steady.scene, start=sol, rtol=1e-8, **kept)
    except (AnalysisError, IntegrationError) as error:
        return None, str(error)
    return found, ""


def _differs(cycle: Cycle, seen: Mapping[str, float], exact: Mapping[str, float]) -> str:
    """Why a cycle is not what the run ended in; "" where it is."""
    if not cycle.stable:
        return (
            f"the cycle next to the run is unstable (multiplier {np.abs(cycle.multipliers[0]):.4g}), no run ends in it"
        )
    size = max(seen.values(), default=0.0)
    off = max((abs(seen[name] - exact[name]) for name in seen), default=0.0)
    return f"the cycle next to the run has other amplitudes, by {off:.4g}" if off > 0.05 * size else ""


@dataclass(frozen=True, kw_only=True)
class Amplitudes:
    """What makes the amplitude of one motion at each place of a study, here or in a worker."""

    places: Any
    name: str
    options: Mapping[str, Any]

    @property
    def scene(self) -> Any:
        """The scene of the study."""
        return self.places.scene

    def run(self, parameters: Mapping[str, Any]) -> Any:
        """Half the range of the motion once it has settled; 0 where nothing grows, nan where there is no sliding."""
        try:
            steady = self.places.steady(parameters)
        except AnalysisError:
            return float("nan")
        if self.name not in steady.system.dof_names:
            raise unknown_name("degree of freedom", self.name, steady.system.dof_names)
        values = np.linalg.eigvals(steady.matrix()).astype(complex)
        values = values[self.places.kept(values)]
        oscillates = values[values.imag > 0.0]
        if not oscillates.size or not oscillates.real.max() > 1e-9 * abs(oscillates).max():
            return 0.0
        near = complex(oscillates[np.argmax(oscillates.real)])
        try:
            return saturation(steady, parameters, near, False, self.options).amplitude[self.name]
        except IntegrationError as error:
            return error
