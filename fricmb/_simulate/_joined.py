"""Runs of islands seen as one run of the whole scene."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace
from typing import Any, TypeVar

import numpy as np

from fricmb._simulate._members import Idle, Member
from fricmb.integrate import OPEN, STICK, MotionSamples, Samples, Start, Trajectory, Transitions
from fricmb.integrate.problem import Floats, Ints
from fricmb.integrate.run.chunked_run import KeptTrajectory, add_counters, take
from fricmb.integrate.run.spread_motion import SpreadMotion, constant
from fricmb.scene import Contact
from fricmb.solution import IslandStats, Names
from fricmb.values import value_of

THINNED = "rows are thinned: accepted steps of many islands; the dense output has everything"


class JoinedRun(Trajectory):
    """Trajectories of islands as one: rows at the steps of all of them, between them each one's dense output.

    Parameters
    ----------
    runs : sequence of (int, Trajectory)
        Number of the member and its run; the others rest.
    methods : sequence of str
        Names of the integrators.
    members : sequence of Member
    names : Names
        Of the whole.
    start : Start
        Of the whole: where what rests is.
    idle : Idle or None
    rows : bool
        Whether the rows will be asked for: values at given times need none.
    """

    def __init__(
        self,
        runs: Sequence[tuple[int, Trajectory]],
        methods: Sequence[str],
        members: Sequence[Member],
        names: Names,
        start: Start,
        idle: Idle | None,
        rows: bool = True,
    ) -> None:
        self.runs = tuple(runs)
        self.methods = tuple(methods)
        self._start = start
        self._shape = len(names.dofs), len(names.contacts), int(names.row[-1]), int(names.z_start[-1])
        self._pressed = _resting_forces(members, {i for i, _ in runs}, len(names.contacts))
        self._take(members, idle)
        stopped = [(run.ends[1], i, run.failure) for i, run in runs if run.failure is not None]
        self.moving = np.concatenate([members[i].place.dofs for i, _ in runs])
        self.failure = None
        t_end = max(run.ends[1] for _, run in runs)
        if stopped:
            t_end, i, reason = min(stopped)
            self.failure = f"{members[i]}: {reason}"
        self._t: Floats | None = None
        self.transitions = self._joined_transitions(t_end)
        self.counters = add_counters([run.counters for _, run in runs])
        self.end = self._joined_end(t_end)
        if rows and self._find_times():
            self.counters = replace(self.counters, notes=(*self.counters.notes, THINNED))

    def _find_times(self) -> bool:
        """The times of the rows; whether they are thinned."""
        runs = [run for _, run in self.runs]
        kept = [run for run in runs if isinstance(run, KeptTrajectory)]
        # a long run holds its values at the times asked for alone: these are the rows of all
        times = [run.t for run in kept[:1]] or [run.t for run in runs]
        self._t, thinned = common_times(times, self.end.t, self._width)
        return thinned

    def _take(self, members: Sequence[Member], idle: Idle | None) -> None:
        self._places = [members[i].place for i, _ in self.runs]
        self._idle = idle

    @property
    def _width(self) -> int:
        n, n_c, m, n_z = self._shape
        return 2 * n + 2 * m + 3 * n_c + n_z + 3

    @property
    def t(self) -> Floats:
        """Times of the rows (n_t,)."""
        if self._t is None:
            self._find_times()
        assert self._t is not None
        return self._t

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        return self._start.t, self.end.t

    @property
    def breakpoints(self) -> Floats:
        """Times at which inputs of any island jump or bend."""
        return np.unique(np.concatenate([run.breakpoints for _, run in self.runs]))

    def rows(self) -> Samples:
        """Values at the rows; at a transition first the left, then the right-hand values."""
        t = self.t
        return self._complete(t, [_at_rows(run.rows(), run.sample, t, Samples) for _, run in self.runs])

    def row_motion(self) -> MotionSamples:
        """As :meth:`rows`, without energies."""
        t = self.t
        return self._assemble(t, [_at_rows(run.row_motion(), run.motion, t, MotionSamples) for _, run in self.runs])

    def sample(self, t: Floats) -> Samples:
        """Values at times within the run, in any order; the right-hand value at a transition."""
        return self._complete(t, [run.sample(t) for _, run in self.runs])

    def motion(self, t: Floats) -> MotionSamples:
        """As :meth:`sample`, without energies."""
        return self._assemble(t, [run.motion(t) for _, run in self.runs])

    def _complete(self, t: Floats, parts: Sequence[Samples]) -> Samples:
        motion = self._assemble(t, parts)
        loss = np.zeros((self._shape[1], t.size))
        for place, part in zip(self._places, parts, strict=True):
            loss[place.contacts] = part.friction_loss
        return motion.with_energies(
            friction_loss=loss,
            damping_loss=np.sum([part.damping_loss for part in parts], axis=0),
            input=np.sum([part.input for part in parts], axis=0),
        )  # fmt: skip

    def _assemble(self, t: Floats, parts: Sequence[MotionSamples]) -> MotionSamples:
        _, n_c, m, _ = self._shape
        n_t = t.size
        found = SpreadMotion.of(
            self._start.q,
            [(place.dofs, part) for place, part in zip(self._places, parts, strict=True)],
            t=t,
            z=constant(self._start.z, n_t),
            F=np.zeros((m, n_t)), g=np.zeros((m, n_t)),
            N=constant(self._pressed, n_t),
            mode=np.full((n_c, n_t), STICK, dtype=np.int8),
        )  # fmt: skip
        for place, part in zip(self._places, parts, strict=True):
            found.z[place.states] = part.z
            found.F[place.rows], found.g[place.rows] = part.F, part.g
            found.N[place.contacts], found.mode[place.contacts] = part.N, part.mode
        if self._idle is not None:
            self._idle.fill(found)
        return found

    def _joined_transitions(self, t_end: float) -> Transitions:
        found = [(run.transitions, place) for (_, run), place in zip(self.runs, self._places, strict=True)]
        t = np.concatenate([x.t for x, _ in found])
        contact = np.concatenate([place.contacts[x.contact] for x, place in found])
        kind = np.concatenate([x.kind for x, _ in found])
        order = np.argsort(t, kind="stable")
        order = order[t[order] <= t_end]
        return Transitions(t=t[order], contact=contact[order], kind=kind[order])

    def _joined_end(self, t_end: float) -> Start:
        n, n_c, m, _ = self._shape
        q, v, z = self._start.q.copy(), np.zeros(n), self._start.z.copy()
        mode, direction = np.full(n_c, STICK, dtype=np.int8), np.zeros(m)
        if self._idle is not None:
            mode[self._idle.place.contacts] = OPEN
        known = True
        for (_, run), place in zip(self.runs, self._places, strict=True):
            end = run.end
            if end.t != t_end:  # stopped by the failure of another
                last = run.motion(np.array([t_end]))
                end = Start(t=t_end, q=last.q[:, 0], v=last.v[:, 0], z=last.z[:, 0])
            q[place.dofs], v[place.dofs], z[place.states] = end.q, end.v, end.z
            if end.mode is not None and end.direction is not None:
                mode[place.contacts], direction[place.rows] = end.mode, end.direction
            elif place.contacts.size:
                known = False
        return Start(t=t_end, q=q, v=v, z=z, mode=mode if known else None, direction=direction if known else None)

    def attach_members(self, members: Sequence[Member], idle: Idle | None) -> None:
        """Give the parts of an unpickled run their problems again."""
        self._take(members, idle)
        for i, run in self.runs:
            run.attach(members[i].system.problem)

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name not in ("_places", "_idle")}


def _resting_forces(members: Sequence[Member], run: set[int], n_c: int) -> Floats:
    """Normal forces (n_c,) of contacts in islands that rest; they are constant."""
    pressed = np.zeros(n_c)
    for i, member in enumerate(members):
        if i not in run and member.contacts:
            contacts = [part for name in member.contacts if isinstance(part := member.scene[name], Contact)]
            pressed[member.place.contacts] = [max(0.0, float(value_of(c.normal_force))) for c in contacts]
    return pressed


_Samples = TypeVar("_Samples", bound=MotionSamples)


def _at_rows(own: _Samples, between: Callable[[Floats], _Samples], t: Floats, kind: type[_Samples]) -> _Samples:
    """Values at the joined rows, as ``kind``: of a run's own rows where it has them, in their order; else between."""
    if own.t.size == t.size and bool((own.t == t).all()):
        return own
    found = between(t)
    first = np.searchsorted(own.t, t, side="left")
    count = np.searchsorted(own.t, t, side="right") - first
    again = np.arange(t.size) - np.searchsorted(t, t, side="left")
    mine = np.flatnonzero(count > 0)
    rows: Ints = first[mine] + np.minimum(again[mine], count[mine] - 1)
    held = take(own, rows)
    for name in (f.name for f in fields(kind) if f.name != "t"):
        getattr(found, name)[..., mine] = getattr(held, name)
    return found


def island_stats(trajectory: Trajectory, members: Sequence[Member]) -> tuple[IslandStats, ...]:
    """Work on each island that was run."""
    if not isinstance(trajectory, JoinedRun):
        return ()
    return tuple(
        IslandStats(
            dofs=members[i].selection.dofs,
            method=method,
            n_steps=run.counters.n_steps,
            n_rejected=run.counters.n_rejected,
            n_lu=run.counters.n_lu,
        )
        for (i, run), method in zip(trajectory.runs, trajectory.methods, strict=True)
    )


def runs_of(trajectory: Trajectory) -> list[Trajectory]:
    """The runs that a trajectory is made of: of each island its own."""
    return [run for _, run in trajectory.runs] if isinstance(trajectory, JoinedRun) else [trajectory]


#: Most numbers that the rows of a joined run may hold: accepted steps of many islands are thinned beyond.
MOST = 20_000_000


def common_times(times: Sequence[Floats], t_end: float, width: int) -> tuple[Floats, bool]:
    """Times of all runs, rising, one that is several times in a run (a transition) as often; whether thinned.

    Thinned are the times that occur once, so that rows of ``width`` numbers stay within MOST.
    """
    every: Floats = np.unique(np.concatenate([*times, [t_end]]))
    often = np.ones(every.size, dtype=np.int64)
    for t in times:
        here, count = np.unique(t, return_counts=True)
        place = np.searchsorted(every, here)
        often[place] = np.maximum(often[place], count)
    inside = every <= t_end
    every, often = every[inside], often[inside]
    most = MOST // width
    thinned = bool(often.sum() > most)
    if thinned:
        keep = often > 1
        keep[[0, -1]] = True
        once = np.flatnonzero(~keep)
        left = max(most - int(often[keep].sum()), 100)
        keep[once[np.unique(np.linspace(0, once.size - 1, min(left, once.size)).astype(np.int64))]] = True
        every, often = every[keep], often[keep]
    return np.repeat(every, often), thinned
