"""Limit cycles: periodic motion through stick and slip, stable or not, with its multipliers and derivatives."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb._calls import answers
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options
from fricmb.analysis._errors import AnalysisError, Floats, checked_integer, positive, refuse
from fricmb.analysis.cycles._drive import drive_period, given_period, is_driven, places_are_integrals
from fricmb.analysis.cycles._extremes import amplitude_slope, extremes
from fricmb.analysis.cycles._flow import Flow, check_scene, detached, initial_slots, states_at
from fricmb.analysis.cycles._recurrence import guess_cycle
from fricmb.analysis.cycles._section import Section, calm_time, checked_section
from fricmb.analysis.cycles._shooting import Orbit, Shooting, solve
from fricmb.errors import unknown_name
from fricmb.solution import Solution
from fricmb.system import build

if TYPE_CHECKING:
    from fricmb.scene import Scene
    from fricmb.solution import Events, Solution

_WHO = "limit_cycle"
#: How many periods of the slowest oscillation, or of the drive, are run where no start is given.
_RUN_IN = 40
#: Most laps of one cycle.
_MOST_LAPS = 10_000
#: Options of simulate that it sets itself.
_OWN = ("t_end", "t_start", "t_eval", "initial", "sensitivities", "parameters", "rtol", "dense", "chunk", "on_chunk")


@dataclass(frozen=True, kw_only=True)
class Cycle:
    """A periodic motion; made by :func:`limit_cycle` and along a :class:`Branch`.

    Attributes
    ----------
    scene : Scene
        With the values at which it was found.
    period : float
        Of all laps together.
    multipliers : (n_y,) or (n_y - 1,) complex
        Floquet multipliers, largest first; without a drive the one of the free phase (1) is left out.  Each contact
        that sticks once a lap makes one of them 0.
    solution : Solution
        One lap, from the section on.
    residual : float
        Distance of the lap's end from its start, relative to the extent of the motion.
    """

    scene: Scene
    period: float
    multipliers: NDArray[np.complex128]
    solution: Solution
    residual: float
    orbit: Orbit = field(repr=False)

    @property
    def stable(self) -> bool:
        """Whether all multipliers lie inside the unit circle."""
        return bool((np.abs(self.multipliers) < 1.0).all())

    @property
    def events(self) -> Events:
        """Transitions of one lap."""
        return self.solution.events

    def amplitude(self, name: str) -> float:
        """Half the range of a degree of freedom or point over the cycle."""
        low, high = extremes(self.solution, name)
        return 0.5 * (high.value - low.value)

    def sensitivity(self, quantity: str, name: str) -> float:
        """Derivative along the cycle of the period or of an amplitude by a parameter.

        Parameters
        ----------
        quantity : str
            "period", or the degree of freedom or point whose amplitude is meant.
        name : str
            Out of ``scene.parameters``; an initial value has no influence on a cycle.
        """
        if not isinstance(name, str) or name not in self.scene.parameters:
            raise unknown_name("parameter", name, self.scene.parameters)
        if name in initial_slots(self.scene):
            return 0.0
        start, period = self._slopes(name)
        if not isinstance(quantity, str):
            raise unknown_name("quantity", quantity, ["period", *self.scene.dof_names])
        return period if quantity == "period" else amplitude_slope(self, quantity, name, start)

    def _slopes(self, name: str) -> tuple[Floats, float]:
        """Derivatives of the state at the time of the section, and of the period, by a parameter."""
        kept = self._kept_slopes
        if name not in kept:
            orbit = self.orbit.shooting.orbit(self.orbit.y, self.orbit.T, by=(name,))
            step = -np.linalg.lstsq(orbit.matrix, orbit.column(name), rcond=None)[0]
            k, drive = orbit.tangent.shape[1], self.orbit.shooting.drive
            slope = float(step[k]) if drive is None else drive.slope(name, self.scene.parameters)
            start = orbit.belt_shift(name) + orbit.tangent @ step[:k]
            if drive is not None and slope:  # at the time of the section, which moves with the period
                start = start - slope * orbit.shooting.phase * orbit.first_rate
            kept[name] = start, slope
        return kept[name]

    @cached_property
    def _kept_slopes(self) -> dict[str, tuple[Floats, float]]:
        return {}

    def __str__(self) -> str:
        kind = "stable" if self.stable else "unstable"
        counts = [event.kind for event in self.events]
        shown = ", ".join(f"{counts.count(kind)} {kind}" for kind in dict.fromkeys(counts)) or "no transitions"
        largest = np.abs(self.multipliers[:1]).max(initial=0.0)
        return f"{kind} cycle, period {self.period:.12g}, {shown}; largest multiplier {largest:.6g}"


@answers
def limit_cycle(
    scene: Scene,
    *,
    start: Solution | Cycle | None = None,
    period: float | None = None,
    section: tuple[str, float] | None = None,
    laps: int = 1,
    rtol: float = 1e-10,
    **options: Any,
) -> Cycle:
    """Find a periodic motion, stable or unstable, by Newton's method on one lap.

    Parameters
    ----------
    scene : Scene
    start : Solution or Cycle, optional
        A run whose second half is near the cycle, or another cycle.  Default: the scene is run for 40 periods.
    period : float, optional
        Period of one lap: of the drive where the scene is driven (default: read from its expressions), else a guess
        (default: the time after which the run comes back).
    section : (str, float), optional
        Where the cycle is cut: a degree of freedom or velocity and its value, ``("mass.x.velocity", 0.0)``.  Default:
        across the motion, in the middle of its longest slip.
    laps : int
        Laps that make up the cycle: 2 after a period doubling.
    rtol : float
        Accuracy of the runs.
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    Cycle

    Raises
    ------
    AnalysisError
        If the run does not come back to where it was, a drive has no period, or no cycle is found; says which.
    UnknownNameError
        For a section of something that is no degree of freedom.

    Notes
    -----
    The lap's derivative is exact through its transitions, so that Newton's method converges quadratically and the
    multipliers are its eigenvalues.  A section at which contacts stick is varied along the stuck states alone.
    """
    check_scene(scene, _WHO)
    if values := options.pop("parameters", None):  # a cycle's period, derivatives and branches follow from the scene
        scene = scene.with_parameters(values)
    laps = checked_integer(_WHO, "laps", laps, 1, _MOST_LAPS)
    period = None if period is None else positive(_WHO, "period", period)
    if start is not None and not isinstance(start, Solution | Cycle):
        refuse(_WHO, "start", start, "a Solution or a Cycle")
    check_options(_WHO, options, simulate, *_OWN, call=limit_cycle)
    flow = Flow(scene=detached(scene), options={"rtol": rtol, **options})
    drive = None
    if is_driven(scene):
        drive = drive_period(scene, laps, _WHO) if period is None else given_period(period, laps)
    run = start.solution if isinstance(start, Cycle) else start
    if run is None:
        run = _run_in(flow, None if drive is None else drive.value(scene.parameters) / laps)
    cut = None if section is None else checked_section(section, run.names, _WHO)
    if isinstance(start, Cycle):
        first = _again(flow, start, laps)
    else:
        first = _first(flow, run, drive, cut, laps, period)
    return as_cycle(solve(first, rtol, _WHO))


def as_cycle(orbit: Orbit) -> Cycle:
    """A closed orbit as a result."""
    flow = orbit.shooting.flow
    return Cycle(
        scene=flow.scene, period=orbit.T, multipliers=orbit.multipliers, solution=orbit.arc.solution,
        residual=orbit.miss, orbit=orbit,
    )  # fmt: skip


def _run_in(flow: Flow, period: float | None) -> Solution:
    if period is None:
        omega = build(flow.scene).problem.omega
        slow = omega[omega > 0.0]
        if not slow.size:
            raise AnalysisError(f"{_WHO}: the scene has no oscillation that tells how long to run; give start=")
        period = 2.0 * np.pi / float(slow.min())
    return simulate(flow.scene, t_end=_RUN_IN * period, **{**flow.options, "rtol": 1e-6})


def _first(flow: Flow, run: Solution, drive: Any, section: Section | None, laps: int, period: float | None) -> Orbit:
    """The lap of a run from which Newton's method starts."""
    if drive is None:
        at, T = guess_cycle(run, section, laps, period, _WHO)
        phase = 0.0
    else:
        T = drive.value(flow.scene.parameters)
        at = _instant(flow.scene, run, T)
        phase = (at / T) % 1.0
    y = states_at(run, np.array([at]))[:, 0]
    lap = run.at(np.linspace(max(run.t_start, run.t_end - T), run.t_end, 2001)).record.samples
    scale = np.concatenate([np.ptp(x, axis=1) for x in (lap.q, lap.v, lap.z)])
    bare = Shooting(
        flow=flow, names=run.names, phase=phase, drive=drive, section=section, anchor=y,
        normal=np.zeros(y.size), scale=_no_zeros(scale, run),
    )  # fmt: skip
    return _start(bare, y, T)


def _instant(scene: Scene, run: Solution, T: float) -> float:
    """A time of the last lap; where a drive's position is the integral of its velocity, a whole number of periods."""
    if run.t_end - run.t_start < T:
        raise AnalysisError(f"{_WHO}: start lasts {run.t_end - run.t_start:g}, less than the period {T:g}")
    if places_are_integrals(build(scene), scene):
        return float(np.floor(run.t_end / T * (1 + 1e-12)) * T)
    return calm_time(run, run.t_end - T, run.t_end)


def _again(flow: Flow, cycle: Cycle, laps: int) -> Orbit:
    """The laps of another cycle, for the values of this scene."""
    old = cycle.orbit.shooting
    drive = None if old.drive is None else replace(old.drive, laps=old.drive.laps * laps)
    bare = replace(old, flow=flow, drive=drive, phase=old.phase / laps)
    y = bare.onto_belt(cycle.orbit.y, cycle.orbit.sticks)
    return _start(bare, y, bare.period(cycle.period * laps))


def _start(bare: Shooting, y: Floats, T: float) -> Orbit:
    orbit = bare.orbit(y, T)
    if bare.drive is None and bare.section is None:
        orbit = replace(orbit, shooting=bare.anchored(y, orbit.arc.solution))
    return orbit


def _no_zeros(scale: Floats, run: Solution) -> Floats:
    """Extents of states that do not move are those of the others, or 1."""
    n = len(run.names.dofs)
    for part in (slice(0, n), slice(n, 2 * n), slice(2 * n, None)):
        own = scale[part]
        own[own <= 1e-12 * own.max(initial=0.0)] = own.max(initial=0.0) or 1.0
    return scale
