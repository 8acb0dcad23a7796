"""Poincaré sections of runs, and what they show over a parameter."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb._facade import facade
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb._sweep import sweep
from fricmb.analysis._errors import (
    AnalysisError,
    Floats,
    checked_kind,
    checked_number,
    checked_numbers,
    checked_scene,
    checked_solution,
    positive,
    refuse,
)
from fricmb.errors import IntegrationError
from fricmb.field import AskedEvent

if TYPE_CHECKING:
    from fricmb.plot._branches import DiagramPlots
    from fricmb.scene import Scene
    from fricmb.solution import Solution


@dataclass(frozen=True, kw_only=True)
class Poincare:
    """Points at which a motion meets a section.

    Attributes
    ----------
    t : (n,)
    solution : Solution
        The run at these times.
    """

    t: Floats
    solution: Solution = field(repr=False)

    @property
    def dofs(self) -> tuple[str, ...]:
        """Names of the rows of q and v."""
        return self.solution.dof_names

    @property
    def q(self) -> Floats:
        """Positions (n_dof, n)."""
        return self.solution.q

    @property
    def v(self) -> Floats:
        """Velocities (n_dof, n)."""
        return self.solution.v

    def __getitem__(self, name: str) -> Floats:
        """A signal (n,) there, by its name in ``sol[name]``."""
        return self.solution.scalar(name)


@answers
def poincare_section(
    sol: Solution,
    section: tuple[str, float] | None = None,
    *,
    period: float | None = None,
    rising: bool | None = True,
    discard: float = 0.5,
) -> Poincare:
    """Points of a run on a section, or once a period.

    Parameters
    ----------
    sol : Solution
        With its dense output.
    section : (str, float), optional
        A signal, as in ``sol[name]``, and its value, ``("mass.x.velocity", 0.0)``; or give ``period``.
    period : float, optional
        Of a drive.
    rising : bool or None
        Passes in which the signal rises, falls, or both (None).
    discard : float
        Part of the run that is left out at its start.

    Returns
    -------
    Poincare

    Raises
    ------
    AnalysisError
        For arguments that are not accepted.
    """
    checked_solution("poincare_section", sol)
    _check("poincare_section", section, period, discard)
    begin = sol.t_start + discard * (sol.t_end - sol.t_start)
    if period is not None:
        t = np.arange(np.ceil(begin / period - 1e-9), np.floor(sol.t_end / period + 1e-9) + 1.0) * period
    else:
        assert section is not None
        t = _passes(sol, *section, begin, rising)
    return Poincare(t=t, solution=sol.at(t))


def _check(who: str, section: Any, period: Any, discard: Any) -> None:
    """Refuse arguments of a section that are not accepted."""
    if (section is None) == (period is None):
        raise AnalysisError(f"{who}: give either section= or period=")
    checked_number(who, "discard", discard, "a number from 0 to below 1", lambda x: 0.0 <= x < 1.0)
    if period is not None:
        positive(who, "period", period)
        return
    accepted = 'a name and a value such as ("mass.x.velocity", 0.0)'
    if not isinstance(section, tuple | list) or len(section) != 2 or not isinstance(section[0], str):
        refuse(who, "section", section, accepted)
    checked_number(who, "section", section[1], accepted, np.isfinite)


def _passes(sol: Solution, name: str, level: float, begin: float, rising: bool | None) -> Floats:
    found = [np.zeros(0)]
    for t, sign in AskedEvent("section", (name, level)).changes(sol, begin):
        found.append(t if rising is None else t[sign == (1.0 if rising else -1.0)])
    return np.concatenate(found)


@dataclass(frozen=True, kw_only=True)
class BifurcationDiagram:
    """Settled motion of runs over a parameter: a signal at the passes of a section.

    Attributes
    ----------
    over, signal : str
    values : (n_values,)
    points : tuple of (n_i,)
        The signal at the passes of a section, for each value; empty for a run that failed, or does not pass it.
    failed : tuple of (float, str)
        Values of runs that failed, and why.
    """

    over: str
    signal: str
    values: Floats
    points: tuple[Floats, ...]
    failed: tuple[tuple[float, str], ...]

    def count(self, tolerance: float = 1e-4) -> Floats:
        """Number of different points (n_values,); those closer than ``tolerance`` of the whole extent count as one."""
        every = np.concatenate([*self.points, np.zeros(0)])
        near = tolerance * float(np.ptp(every)) if every.size else 0.0
        return np.array([0 if not p.size else 1 + int((np.diff(np.sort(p)) > near).sum()) for p in self.points])

    @property
    @facade
    def plot(self) -> DiagramPlots:
        """Pictures: ``found.plot.diagram()``."""

@dataclass(frozen=True, kw_only=True)
class _Reduce:
    """What is kept of a run, in its worker."""

    section: tuple[str, float] | None
    period: float | None
    rising: bool | None
    discard: float
    signal: str

    def __call__(self, sol: Solution) -> Floats:
        section = poincare_section(sol, self.section, period=self.period, rising=self.rising, discard=self.discard)
        return section[self.signal]


@answers
def bifurcation_diagram(
    scene: Scene,
    over: str,
    values: ArrayLike,
    *,
    t_end: float,
    signal: str,
    section: tuple[str, float] | None = None,
    period: float | None = None,
    rising: bool | None = True,
    discard: float = 0.5,
    follow: bool = False,
    progress: bool = True,
    workers: Any = None,
    **options: Any,
) -> BifurcationDiagram:
    """Settled motion of plain runs over a parameter, for motion that has no branch of cycles.

    Parameters
    ----------
    scene : Scene
    over : str
        Out of ``scene.parameters``.
    values : (n_values,)
    t_end : float
        Length of each run.
    signal : str
        As in ``sol[name]``: "mass.x.velocity", "sole.force".
    section, period, rising, discard
        As :func:`poincare_section`.  A drive's period that depends on ``over`` has to be left to a section.
    follow : bool
        Start each run where the one before has ended, one after the other: shows hysteresis.  Default: each from the
        scene's own start, on all cores.
    progress : bool
    workers : int, optional
        As :func:`fricmb.sweep`.
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    BifurcationDiagram
    """
    who = "bifurcation_diagram"
    checked_scene(who, scene)
    checked_kind(who, "over", over, str, "a name out of scene.parameters")
    checked_kind(who, "signal", signal, str, 'the name of a signal, such as "mass.x.velocity"')
    _check(who, section, period, discard)
    check_options(who, options, simulate, "t_end", "parameters", "initial", call=bifurcation_diagram)
    grid = checked_numbers(who, "values", values, "(n,) and finite")
    if grid.ndim != 1 or not np.isfinite(grid).all():
        raise AnalysisError(f"bifurcation_diagram: values must be (n,) and finite; got shape {grid.shape}")
    keep = _Reduce(section=section, period=period, rising=rising, discard=discard, signal=signal)
    runs = [{over: value} for value in grid.tolist()]
    if follow:
        results = _followed(scene, runs, t_end, keep, progress, options)
    else:
        results = sweep(scene, runs, t_end=t_end, reduce=keep, progress=progress, workers=workers, **options)
    failed = [isinstance(found, IntegrationError) for found in results]
    return BifurcationDiagram(
        over=over, signal=signal, values=grid,
        points=tuple(np.zeros(0) if bad else found for bad, found in zip(failed, results, strict=True)),
        failed=tuple((float(x), str(r)) for x, r, bad in zip(grid, results, failed, strict=True) if bad),
    )  # fmt: skip


def _followed(
    scene: Scene, runs: Sequence[dict[str, float]], t_end: float, keep: _Reduce, progress: bool, options: Any
) -> list[Any]:
    from fricmb._simulate._progress import bar

    before: Solution | None = None
    found: list[Any] = []
    with bar(len(runs), "run", "diagram", progress) as shown:
        for run in runs:
            t = 0.0 if before is None else before.t_end
            try:
                before = simulate(scene, parameters=run, t_end=t + t_end, initial=before, **options)
                found.append(keep(before))
            except IntegrationError as error:
                found.append(error)
            shown.update()
    return found
