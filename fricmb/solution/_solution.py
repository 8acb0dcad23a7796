"""The result of a run."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fricmb.errors import IntegrationError, SceneError, unknown_name
from fricmb.integrate import Samples, Start
from fricmb.integrate.problem import Codes, Floats
from fricmb.solution._derivatives import Derivatives
from fricmb.solution._energy import Energy, Reference
from fricmb.solution._events import Events
from fricmb.solution._names import Names
from fricmb.solution._rest import resting
from fricmb.solution._run import Record, Run, first_bad, is_finite
from fricmb.solution._stats import Stats
from fricmb.solution._stored import Stored
from fricmb.solution._summary import describe, summarise
from fricmb.values import Units

if TYPE_CHECKING:
    import pandas

    from fricmb.audit import Audit
    from fricmb.plot import SolutionPlots


class Solution:
    """What a run found: motion, contacts, transitions, energies, and the cost of it.

    Made by :func:`fricmb.simulate`.  Time is the last axis of every array; units are those of the scene.

    Parameters
    ----------
    names : Names
    run : Run
    stats : Stats
    events : Events, optional
        Default: the transitions of the run.
    times : (n_t,), optional
        Times of the solution; default: the accepted steps, a transition's time twice (before and after).
    """

    def __init__(
        self, *, names: Names, run: Run, stats: Stats, events: Events | None = None, times: Floats | None = None
    ) -> None:
        self.names = names
        self.stats = stats
        self._run: Run | Stored = run
        self._events = events
        self._span = run.t_start, run.t_end
        self.has_rows = times is None
        self._energies: tuple[Floats, Floats] | None = None
        self._units: Units | None = None
        self._asked: tuple[str, ...] = ()
        self._derivatives: Derivatives | None = None
        self.record = _finite(run.rows() if times is None else run.sample(times))

    # ---- motion

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

    def __getitem__(self, name: str) -> Floats:
        """Position (n_t,) of a degree of freedom, a point ("plate.tip.x") or a driven body ("belt.x").

        Of bodies in space also "rod.rotation" (3, 3, n_t), "rod.omega" and "axle.axis" (3, n_t).
        """
        return self._motion(name, 0)

    def velocity(self, name: str) -> Floats:
        """Velocity (n_t,) of a degree of freedom, a point or a driven body."""
        return self._motion(name, 1)

    def _motion(self, name: str, derivative: int) -> Floats:
        names, values = self.names, self.v if derivative else self.q
        try:
            if name in names.dof_index:
                return _row(values, names.dof_index[name])
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

    # ---- dense output

    def __call__(self, t: Any) -> Floats:
        """State at any time of the run, q over v: (2 n_dof, len(t)), or (2 n_dof,) for a single time.

        At a transition the right-hand value.  Raises SceneError for a time outside the run.
        """
        run = self.run
        samples = _finite(run.sample(run.inside(t))).samples
        state = np.concatenate((samples.q, samples.v))
        return state[:, 0] if np.ndim(t) == 0 else state

    def at(self, t: Any) -> Solution:
        """The same run seen at other times (in the order given); the right-hand value at a transition.

        Raises SceneError for a time outside the run.
        """
        run = self.run
        other = Solution(names=self.names, run=run, stats=self.stats, events=self.events, times=run.inside(t))
        other.__dict__["_reference"] = self._reference
        other._units = self._units
        other._asked = self._asked
        return other

    # ---- contacts

    def force(self, contact: str) -> Floats:
        """Friction force on the contact's first end (d, n_t)."""
        return self._rows_of(self.record.samples.F, contact, 1)

    def relative_velocity(self, contact: str) -> Floats:
        """Velocity of the first end relative to the second, with the slide (d, n_t)."""
        return self._rows_of(self.record.samples.g, contact, -1)

    def normal_force(self, contact: str) -> Floats:
        """Normal force (n_t,), at least 0."""
        return _row(self.record.samples.N, self.names.contact(contact))

    def mode(self, contact: str) -> Codes:
        """0 stick, 1 slip, 2 open (n_t,), int8."""
        codes: Codes = self.record.samples.mode[self.names.contact(contact)]
        return codes

    def state(self, contact: str) -> Floats:
        """Internal states of the contact's law (n_states, n_t); no rows for a law without."""
        k, start = self.names.contact(contact), self.names.z_start
        return self.record.samples.z[start[k] : start[k + 1]]

    def reaction(self, joint: str) -> Floats:
        """Reaction of a joint on its first end (rows, n_t): forces and torques in the order the joint's type says.

        Where constraints depend on one another, the reactions of least norm.
        """
        return self.run.reaction(joint, self.record)

    def _rows_of(self, values: Floats, contact: str, power: int) -> Floats:
        k, row = self.names.contact(contact), self.names.row
        own = slice(row[k], row[k + 1])
        scale = self.names.row_scale[own]
        return values[own] if np.all(scale == 1.0) else values[own] * scale**power

    @cached_property
    def events(self) -> Events:
        """Transitions of the run in time order."""
        if self._events is None:
            (piece,) = self.run.pieces
            found = Events.from_transitions(piece.trajectory.transitions, self.names.contacts)
            self._events = found if piece.t_end >= piece.trajectory.t[-1] else found.until(piece.t_end)
        return self._events

    # ---- derivatives

    def sensitivity(self, signal: str, name: str) -> Floats:
        """Derivative (n_t,) of a signal with respect to a parameter or an initial value, at fixed times.

        Exact through stick and slip: transitions move with the parameter, and that is part of the derivative.

        Parameters
        ----------
        signal : str
            A degree of freedom or point ("pad.x"), its velocity ("pad.x.velocity"), a law's state ("lining.state.z").
        name : str
            One of the names that ``simulate(sensitivities=...)`` was given; after "state" also "pad.position.x",
            "pad.velocity.x", "lining.state.z" for the values that the run starts with.

        Raises
        ------
        SceneError
            Where the run was made without; UnknownNameError lists names near.
        """
        return self.derivatives.signal(self.names, signal, name, self.record.samples)

    @property
    def monodromy(self) -> Floats:
        """Derivative of the state at the end with respect to that at the start (n_y, n_y), y = q over v over z.

        Needs ``simulate(sensitivities="state")``; at the start of a run in stick, what sticks is held together.
        """
        return self.derivatives.monodromy

    @property
    def derivatives(self) -> Derivatives:
        """All derivatives as arrays, over the times of the solution."""
        if self._derivatives is None:
            if not self._asked:
                raise SceneError(
                    "this solution has no derivatives: simulate with sensitivities=(names), or sensitivities="
                    '"state"; joined runs have none, each of their parts has its own'
                )
            from fricmb.sensitivity import derive

            derive(self, self._asked)
        assert self._derivatives is not None
        return self._derivatives

    def take_derivatives(self, derivatives: Derivatives) -> None:
        """Keep derivatives, those of its events with the events."""
        self._asked, self._derivatives = derivatives.asked, derivatives
        events = self.events.with_derivatives(derivatives.columns, derivatives.moved, derivatives.transversality)
        self.__dict__["events"] = self._events = events

    # ---- energy

    @cached_property
    def energy(self) -> Energy:
        """The energy ledger at the solution's times."""
        return self._ledger(self.record, None if self.has_rows else self._reference, self._energies)

    def _ledger(
        self, record: Record, reference: Reference | None, energies: tuple[Floats, Floats] | None = None
    ) -> Energy:
        kinetic, potential = self.run.energies(record) if energies is None else energies
        samples = record.samples
        return Energy(
            kinetic=kinetic,
            potential=potential,
            friction_loss_by_contact=samples.friction_loss,
            damping_loss=samples.damping_loss,
            input=samples.input,
            contacts=self.names.contacts,
            reference=reference,
        )

    @cached_property
    def _reference(self) -> Reference:
        if self.has_rows:
            return self.energy.reference
        return self._ledger(self.run.rows(), None).reference

    def time_share(self, contact: str, mode: int) -> float:
        """Share of the run that a contact spends in a mode (0 stick, 1 slip, 2 open), from the accepted steps."""
        return float(self.time_shares(mode)[self.names.contact(contact)])

    def time_shares(self, mode: int) -> Floats:
        """The same of every contact (n_contacts,)."""
        modes, spans = self._rows_of_modes
        if not spans.any():
            return np.zeros(len(self.names.contacts))
        return np.asarray((modes == mode) @ spans / spans.sum(), dtype=float)

    def rest_spans(self, contact: str) -> Floats:
        """Stretches (n, 2) in which a contact is at rest without sticking, from the accepted steps.

        That is so of joints of a mechanism which others hold: what sticks there is enough to stop them all.
        """
        t, rests = self._resting
        mine = rests[self.names.contact(contact)]
        return np.column_stack((t[:-1][mine], t[1:][mine]))

    def rest_share(self, contact: str) -> float:
        """Share of the run that a contact is at rest without sticking."""
        length = self.t_end - self.t_start
        return float(np.diff(self.rest_spans(contact)).sum() / length) if length > 0.0 else 0.0

    @property
    def _rows(self) -> Samples:
        return (self.record if self.has_rows else self.run.rows()).samples

    @cached_property
    def _rows_of_modes(self) -> tuple[Codes, Floats]:
        samples = self._rows
        return samples.mode[:, :-1], np.diff(samples.t)

    @cached_property
    def _resting(self) -> tuple[Floats, NDArray[np.bool_]]:
        samples = self._rows
        return samples.t, resting(samples, self.names.row)

    @property
    def run(self) -> Run:
        """The run behind the arrays (of a loaded file opened at first use)."""
        if not isinstance(self._run, Run):
            self._run = self._run.open()
        return self._run

    # ---- whole

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

    @property
    def plot(self) -> SolutionPlots:
        """Pictures: ``sol.plot.velocities()``, ..."""
        from fricmb.plot import SolutionPlots

        return SolutionPlots(self)

    def animate(self, path: str | PathLike[str] | None = None, **options: Any) -> Any:
        """The run as moving pictures, or in a browser with a time slider; options of ``sol.plot.animation``.

        ``sol.animate("run.html")`` writes the interactive view, ".gif" and ".mp4" moving pictures.
        """
        return self.plot.animation(path, **options)

    def audit(self, *, rtol: float | None = None, atol: Any = None, seed: int = 0) -> Audit:
        """Check the run against the equations of its scene, on a path that shares nothing with the compiled kernels.

        What every part states in SymPy is evaluated by numpy at random times of the dense output: equations of motion
        and of law states in integrated form, laws and cones of friction, creep in stick, constraints, transitions,
        energy.  Each residual is told in units of what the tolerance allows there.

        Parameters
        ----------
        rtol : float, optional
            What residuals are measured by; default: the tolerance of the run, 1e-3 for fixed steps.
        atol : float or (n_dof,) or (2 n_dof,), optional
            Errors that never matter; default: as in the run.
        seed : int
            Of the random times.

        Returns
        -------
        fricmb.audit.Audit
            ``.ok``, ``.checks``, ``.table()``; printed, three lines.
        """
        from fricmb.audit import audit

        return audit(self, rtol=rtol, atol=atol, seed=seed)

    def columns(self) -> dict[str, Floats | Codes]:
        """Every signal (n_t,) by name, as in :meth:`to_pandas`."""
        from fricmb.solution._table import columns

        return columns(self)

    def to_pandas(self) -> pandas.DataFrame:
        """All signals as a table over time; needs pandas."""
        from fricmb.solution._table import table

        return table(self)

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to an npz file, ".npz" being added if there is no suffix."""
        from fricmb.solution._files import save

        save(self, path)

    @staticmethod
    def load(path: str | PathLike[str], *, laws: Any = ()) -> Solution:
        """Read a file that :meth:`save` wrote.

        Nothing in a file is executed: arrays, names, events and energies are numpy arrays, scene and dense output
        (``sol(t)``, ``sol.at``) are data, opened when one of them is first asked for.  What belongs to fricmb is found
        by its name; own laws and elements are found where their module has been imported already.

        Parameters
        ----------
        path : path
        laws : class, iterable of classes, dict of name to class, or "import"
            Own laws and elements that the file refers to; "import": import the modules that the file names, which runs
            their code.  Without them the arrays can be read all the same.

        Raises
        ------
        FricmbError
            For a file that is damaged, inconsistent, or no solution; names file and entry.
        """
        from fricmb.solution._files import load

        return load(path, laws)

    @staticmethod
    def join(solutions: Iterable[Solution]) -> Solution:
        """Runs that go on from each other as one; see :func:`fricmb.simulate`, ``initial=``."""
        from fricmb.solution._join import join

        return join(solutions)

    def summary(self) -> str:
        """What happened, on a few lines."""
        return summarise(self)

    def _repr_html_(self) -> str:
        from fricmb.plot._view import solution_notebook

        return solution_notebook(self)

    def __repr__(self) -> str:
        return describe(self)


def _row(values: Floats, index: int) -> Floats:
    """One signal of many."""
    signal: Floats = values[index]
    return signal


def _finite(record: Record) -> Record:
    samples = record.samples
    if is_finite(samples, record.moving):
        return record
    t = float(samples.t[first_bad(samples)])
    raise IntegrationError(f"the run is not finite at t = {t:.10g}", t=t, reason="a value is not finite")


def restore(
    *,
    names: Names,
    stats: Stats,
    events: Events,
    record: Record,
    span: tuple[float, float],
    has_rows: bool,
    energies: tuple[Floats, Floats],
    reference: Reference,
    run: Stored,
    units: Units,
    derivatives: Derivatives | None = None,
) -> Solution:
    """A solution from what a file holds; ``run`` is left closed until it is needed."""
    sol = Solution.__new__(Solution)
    sol._asked, sol._derivatives = (), None
    sol.names, sol.stats, sol.record, sol.has_rows = names, stats, record, has_rows
    sol._events, sol._span, sol._energies, sol._run = events, span, energies, run
    sol._units = units
    sol.__dict__["_reference"] = reference
    if derivatives is not None:
        sol.take_derivatives(derivatives)
    return sol
