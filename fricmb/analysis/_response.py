"""Frequency response of a driven scene: what it settles to at each frequency, upwards and downwards."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb._facade import facade
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb._simulate._progress import bar
from fricmb.analysis._errors import (
    AnalysisError,
    Floats,
    checked_integer,
    checked_kind,
    checked_numbers,
    checked_scene,
)
from fricmb.analysis.cycles import Branch, Cycle, continue_cycle, limit_cycle
from fricmb.analysis.cycles._drive import drive_period
from fricmb.errors import IntegrationError, unknown_name
from fricmb.integrate import STICK

if TYPE_CHECKING:
    from fricmb.plot._response import ResponsePlots
    from fricmb.scene import Scene
    from fricmb.solution import Solution

_WHO = "frequency_response"
#: Samples of a period that amplitudes are taken from.
_SAMPLES = 200
#: Periods that amplitudes are taken from.
_MEASURED = 4

Measure = str | Callable[["Solution"], float]


@dataclass(frozen=True, kw_only=True)
class FrequencyResponse:
    """Settled amplitude of a driven scene over a parameter, upwards and downwards.

    Attributes
    ----------
    over : str
    values : (n,)
        Of the parameter, rising.
    measure : str
        The signal whose amplitude is meant, or the name of the function.
    up, down : (n,)
        The measure with the parameter rising and falling, nan where a run failed.
    stick_up, stick_down : (n_contacts, n)
        Share of the time that each contact sticks.
    contacts : tuple of str
    branch : Branch or None
        Cycles, stable and unstable, where they were asked for.
    scene : Scene
    """

    over: str
    values: Floats
    measure: str
    up: Floats
    down: Floats
    stick_up: Floats
    stick_down: Floats
    contacts: tuple[str, ...]
    branch: Branch | None
    scene: Any

    @property
    @facade
    def plot(self) -> ResponsePlots:
        """Pictures: ``found.plot.amplitude()``."""

    @property
    def peak(self) -> tuple[float, float]:
        """Value of the parameter, and the measure, where the measure is largest."""
        both = np.where(np.isnan(self.down), self.up, np.fmax(self.up, self.down))
        i = int(np.nanargmax(both))
        return float(self.values[i]), float(both[i])

    def __str__(self) -> str:
        apart = np.abs(self.up - self.down) > 0.01 * np.nanmax(np.fmax(self.up, self.down))
        at, most = self.peak
        lines = [f"{self.measure} over {self.over}, {self.values.size} values, largest {most:.6g} at {at:.6g}"]
        if apart.any():
            low, high = self.values[apart][[0, -1]]
            lines.append(f"  rising and falling differ between {low:.6g} and {high:.6g}")
        return "\n".join(lines)


@answers
def frequency_response(
    scene: Scene,
    *,
    over: str,
    values: ArrayLike,
    measure: Measure,
    periods: int = 60,
    cycles: bool = False,
    progress: bool = True,
    **options: Any,
) -> FrequencyResponse:
    """Amplitude of a driven scene over a parameter of its drive, upwards and downwards.

    Each run goes on from where the one before has ended, at a whole number of periods: jumps and hysteresis show.

    Parameters
    ----------
    scene : Scene
        Driven in time, by an expression in a parameter: ``fm.Force("load", body, axis="x",
        value=F * sympy.cos(omega * fm.t))`` with ``omega = fm.parameter("omega", 1.0)``.
    over : str
        Out of ``scene.parameters``, the angular frequency or another parameter.
    values : (n,)
    measure : str or callable
        A signal, as in ``sol[name]``, whose amplitude (half of what lies between its extremes) is taken over the last
        periods; or a function of these last periods, as a Solution.
    periods : int
        Of the drive in each run; the last four are measured.
    cycles : bool
        Follow the cycles too, stable and unstable, by :func:`continue_cycle`; needs a signal as measure.
    progress : bool
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    FrequencyResponse

    Raises
    ------
    AnalysisError
        For a scene without a drive, or arguments that are not accepted.
    UnknownNameError
        For a parameter or a signal that is not there.
    """
    checked_scene(_WHO, scene)
    checked_kind(_WHO, "over", over, str, "a name out of scene.parameters")
    if over not in scene.parameters:
        raise unknown_name("parameter", over, scene.parameters)
    grid = checked_numbers(_WHO, "values", values, "(n,) and finite")
    if grid.ndim != 1 or not grid.size or not np.isfinite(grid).all():
        raise AnalysisError(f"{_WHO}: values must be (n,) and finite; got shape {grid.shape}")
    grid = np.sort(grid)
    if not isinstance(measure, str) and not callable(measure):
        raise AnalysisError(f"{_WHO}: measure must be the name of a signal or a function of a Solution")
    if cycles and not isinstance(measure, str):
        raise AnalysisError(f"{_WHO}: cycles=True needs the name of a signal as measure, whose amplitude cycles have")
    checked_integer(_WHO, "periods", periods, _MEASURED + 1, 10**6)
    own = ("t_end", "t_start", "t_eval", "parameters", "initial")
    check_options(_WHO, options, simulate, *own, call=frequency_response)
    sweep = _Sweep(scene=scene, over=over, measure=measure, periods=periods, options=options)
    with bar(2 * grid.size, "run", "response", progress) as shown:
        up = sweep.through(grid, None, shown)
        down = sweep.through(grid[::-1], sweep.last, shown)
    branch = _branch(scene, over, grid, sweep.cycle_start) if cycles else None
    return FrequencyResponse(
        over=over, values=grid, measure=measure if isinstance(measure, str) else measure.__name__,
        up=np.array([row[0] for row in up]), down=np.array([row[0] for row in down])[::-1],
        stick_up=np.array([row[1] for row in up]).T, stick_down=np.array([row[1] for row in down])[::-1].T,
        contacts=sweep.contacts, branch=branch, scene=scene,
    )  # fmt: skip


@dataclass(kw_only=True)
class _Sweep:
    """Runs one after the other."""

    scene: Scene
    over: str
    measure: Measure
    periods: int
    options: dict[str, Any]
    last: Solution | None = None
    cycle_start: Solution | None = None
    contacts: tuple[str, ...] = ()

    def through(self, values: Floats, start: Solution | None, shown: Any) -> list[tuple[float, Floats]]:
        """The measure, and the share of stick of each contact, for each value in this order."""
        found = []
        self.last = start
        for value in values.tolist():
            found.append(self._one(value))
            shown.update()
        return found

    def _one(self, value: float) -> tuple[float, Floats]:
        scene = self.scene.with_parameters({self.over: value})
        period = drive_period(scene, 1, _WHO).value(scene.parameters)
        end = self.periods * period
        try:
            sol = simulate(scene, t_end=end, initial=self._initial(), **self.options)
        except IntegrationError:
            self.last = None
            return np.nan, np.full(len(self.contacts), np.nan)
        self.last, self.contacts = sol, sol.contact_names
        self.cycle_start = self.cycle_start or sol
        t = np.linspace(end - _MEASURED * period, end, _MEASURED * _SAMPLES + 1)
        seen = sol.at(np.union1d(t, sol.events.t[sol.events.t >= t[0]]))
        if callable(self.measure):
            amount = float(self.measure(seen))
        else:
            amount = 0.5 * float(np.ptp(seen.scalar(self.measure, _WHO)))
        steps = np.diff(seen.t)
        stuck = seen.record.samples.mode[:, :-1] == STICK
        return amount, stuck @ steps / steps.sum()

    def _initial(self) -> dict[str, Any] | None:
        """The end of the run before as the start of the next one.

        That begins at t = 0 again: a whole number of periods later the drive is where it was.
        """
        if self.last is None:
            return None
        end = self.last.at([self.last.t_end])
        names = self.last.dof_names
        held = {contact: end.state(contact)[:, 0] for contact in self.last.contact_names if end.state(contact).size}
        return {
            "position": dict(zip(names, end.q[:, 0].tolist(), strict=True)),
            "velocity": dict(zip(names, end.v[:, 0].tolist(), strict=True)),
            "state": held,
        }


def _branch(scene: Scene, over: str, grid: Floats, start: Solution | None) -> Branch:
    first: Cycle = limit_cycle(scene.with_parameters({over: float(grid[0])}), start=start)
    return continue_cycle(first, over, to=float(grid[-1]), progress=False)
