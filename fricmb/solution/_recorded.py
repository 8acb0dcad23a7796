"""What a run has recorded: times, motion, and the run behind it for other times."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from fricmb.errors import IntegrationError, SceneError, unknown_name
from fricmb.integrate import MotionSamples, Start
from fricmb.integrate.problem import Floats
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._events import Events
from fricmb.solution._names import Names
from fricmb.solution._run import Record, Run, first_bad, is_finite
from fricmb.solution._stats import Stats
from fricmb.solution._stored import Stored
from fricmb.values import Units

_Samples = TypeVar("_Samples", bound=MotionSamples)


class Recorded:
    """Times and motion of a run; :class:`Solution` is made of it.

    ``find_notes(sol)``: further sentences for the notes, found when these are first read; a function of a module.
    """

    def __init__(
        self, *, names: Names, run: Run, stats: Stats, events: Events | None = None, times: Floats | None = None,
        find_notes: Callable[[Any], tuple[str, ...]] | None = None,
    ) -> None:  # fmt: skip
        self.names = names
        self._stats, self._find_notes = stats, find_notes
        self._run: Run | Stored = run
        self._events = events
        self._look_for: Any = None
        #: What was asked for beside transitions.
        self.asked_events: tuple[Any, ...] = ()
        self._span = run.t_start, run.t_end
        self.has_rows = times is None
        self._energies: tuple[Floats, Floats] | None = None
        self._units: Units | None = None
        self._asked: tuple[str, ...] = ()
        self._derivatives: Derivatives | None = None
        self.record: Record[MotionSamples] = finite(run.row_motion() if times is None else run.motion(times))

    @property
    def stats(self) -> Stats:
        """Method, counters, notes and cost of the run.  Reading the notes may integrate energies."""
        return self._stats if self._find_notes is None else self._stats.until_read(self._notes)

    @stats.setter
    def stats(self, stats: Stats) -> None:
        self._stats, self._find_notes = stats, None

    def take_time(self, wall_s: float) -> None:
        """Say what the whole call took."""
        self._stats = replace(self._stats, wall_s=wall_s)

    def add_notes(self, notes: tuple[str, ...]) -> None:
        """Further notes that are known already."""
        self._stats = replace(self._stats, notes=tuple(dict.fromkeys((*self._stats.notes, *notes))))

    def _notes(self) -> tuple[str, ...]:
        if self._find_notes is not None:
            self._stats = replace(self._stats, notes=(*self._stats.notes, *self._find_notes(self)))
            self._find_notes = None
        return self._stats.notes

    @property
    def t(self) -> Floats:
        """Times (n_t,)."""
        return self.record.samples.t

    @property
    def q(self) -> Floats:
        """Positions (n_dof, n_t), in the order of ``sol.names.dofs``."""
        return self.record.samples.q

    @property
    def v(self) -> Floats:
        """Velocities (n_dof, n_t)."""
        return self.record.samples.v

    @property
    def t_start(self) -> float:
        """Start of the run, whatever the times of the solution."""
        return self._span[0]

    @property
    def t_end(self) -> float:
        """End of the run."""
        return self._span[1]

    @property
    def dof_names(self) -> tuple[str, ...]:
        """Names of the rows of q and v."""
        return self.names.dofs

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts."""
        return self.names.contacts

    def velocity(self, name: str) -> Floats:
        """Velocity (n_t,) of a degree of freedom, a point or a driven body."""
        return self._motion(name, 1)

    def _motion(self, name: str, derivative: int) -> Floats:
        names, values = self.names, self.v if derivative else self.q
        try:
            if name in names.dof_index:
                return row_of(values, names.dof_index[name])
            if name in names.motions:
                motion = names.motions[name]
                return motion.velocity(self.q, self.v) if derivative else motion.position(self.q)
            if name in names.vectors:
                if derivative:
                    raise SceneError(f"velocity: {name!r} is no coordinate whose rate is kept; sol[{name!r}] has it")
                return names.vectors[name].value(self.q, self.v)
            if name in names.signals:
                return self.run.signal(names.signals[name], self.t)[derivative]
        except TypeError:  # an unhashable name
            pass
        raise unknown_name("motion", name, names.known_motions())

    def __call__(self, t: Any) -> Floats:
        """State at any time of the run, q over v: (2 n_dof, len(t)), or (2 n_dof,) for a single time.

        At a transition the right-hand value.  Raises SceneError for a time outside the run.
        """
        run = self.run
        samples = finite(run.motion(run.inside(t))).samples
        state = np.concatenate((samples.q, samples.v))
        return state[:, 0] if np.ndim(t) == 0 else state

    @property
    def run(self) -> Run:
        """The run behind the arrays (of a loaded file opened at first use)."""
        if not isinstance(self._run, Run):
            self._run = self._run.open()
        return self._run

    @property
    def scene(self) -> Any:
        """The scene that was run, with the values it was run with (of joined runs the last)."""
        return self.run.scene

    @property
    def units(self) -> Units:
        """Names of the units, those of the scene (of a loaded file without opening it)."""
        if self._units is None:
            self._units = getattr(self.scene, "units", None) or Units()
        return self._units

    @property
    def end(self) -> Start:
        """State, law states, contact modes and slip directions at the end of the run."""
        return self.run.end


def row_of(values: Floats, index: int) -> Floats:
    """One signal of many."""
    signal: Floats = values[index]
    return signal


def finite(record: Record[_Samples]) -> Record[_Samples]:
    """The record, or IntegrationError where a value in it is not finite."""
    samples = record.samples
    if is_finite(samples, record.moving):
        return record
    t = float(samples.t[first_bad(samples)])
    raise IntegrationError(f"the run is not finite at t = {t:.10g}", t=t, reason="a value is not finite")
