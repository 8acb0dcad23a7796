"""A run of one contact, kept as the rows of its steps."""

from __future__ import annotations

from functools import cached_property, partial
from typing import Any

import numpy as np

from fricmb.integrate.collocation.free_blocks import has_ledger
from fricmb.integrate.collocation.one_contact.constants import linear_part, stick_forces, structure
from fricmb.integrate.collocation.one_contact.held import HeldLedger
from fricmb.integrate.collocation.one_contact.held_samples import held_states
from fricmb.integrate.collocation.one_contact.ledger import from_row_starts, power_of
from fricmb.integrate.collocation.one_contact.prepare import Rows, run_of, with_rows
from fricmb.integrate.collocation.one_contact.room import Run
from fricmb.integrate.collocation.one_contact.sample import BY_FORCE, locate, sample_rows
from fricmb.integrate.collocation.structure_blocks import MANY
from fricmb.integrate.compile.lanes import padded
from fricmb.integrate.problem import STICK, Floats, Ints, Problem, Start
from fricmb.integrate.trajectory import Counters, MotionSamples, Samples, Trajectory, Transitions

#: Positions, and as many velocities, that are asked for together on the way to energies.
NUMBERS = 1_000_000


class SingleRun(Trajectory):
    """Rows of steps, evaluated on demand."""

    def __init__(
        self, problem: Problem, s: int, rows: Rows, transitions: Transitions, counters: Counters, end: Start,
        failure: str | None,
    ) -> None:  # fmt: skip
        super().__init__(problem, transitions, counters, end, failure)
        self._s = s
        self._rows = rows
        self._n_rows = len(rows.kinds)
        self._totals: Floats | None = None
        self._arrays: Run | None = None

    def _run(self) -> Run:
        """The arrays of the problem with the rows of this run."""
        if self._arrays is None:
            self._arrays = with_rows(run_of(self.problem, self._s), self._rows)
        return self._arrays

    def attach(self, problem: Problem) -> None:
        """Take the problem again after unpickling."""
        super().attach(problem)
        self._arrays = None

    def __getstate__(self) -> dict[str, Any]:
        state = {**super().__getstate__(), "_arrays": None}
        state.pop("_row_times", None)
        return state

    @cached_property
    def _row_times(self) -> tuple[Ints, Floats, Floats]:
        """Row, time since its start and time of every sample of :meth:`rows`: starts, and ends before transitions."""
        k = self._n_rows
        start = self._rows.steps[:k, 0] + self._rows.steps[:k, 1]
        stop = np.append(start[1:], self.end.t)
        length = (stop - self._rows.steps[:k, 0]) - self._rows.steps[:k, 1]
        known = self.transitions.t
        turns = np.searchsorted(known, stop, side="right") > np.searchsorted(known, stop)
        turns[-1:] = True
        count = 1 + turns
        row = np.repeat(np.arange(k), count)
        late = np.zeros(len(row), dtype=bool)
        late[np.cumsum(count)[turns] - 1] = True
        return row, np.where(late, length[row], 0.0), np.where(late, stop[row], start[row])

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        if self._n_rows == 0:
            return self.end.t, self.end.t
        return float(self._rows.steps[0, 0] + self._rows.steps[0, 1]), self.end.t

    @property
    def t(self) -> Floats:
        """Times of the rows."""
        if self._n_rows == 0:
            return np.array([self.end.t])
        return self._row_times[2]

    def rows(self) -> Samples:
        """Values at the rows."""
        return self._at_rest() if self._n_rows == 0 else self._samples(*self._row_times)

    def row_motion(self) -> MotionSamples:
        """Values at the rows, without energies."""
        return self._at_rest() if self._n_rows == 0 else self._motion(*self._row_times)[0]

    def sample(self, t: Floats) -> Samples:
        """Values at any times within the run."""
        return self._at_rest(t) if self._n_rows == 0 else self._samples(*self._located(t))

    def motion(self, t: Floats) -> MotionSamples:
        """Values at any times within the run, without energies."""
        return self._at_rest(t) if self._n_rows == 0 else self._motion(*self._located(t))[0]

    def _located(self, t: Floats) -> tuple[Ints, Floats, Floats]:
        """Row of each time, time since its start, and the time."""
        t = np.ascontiguousarray(t, dtype=float)
        row, tau = np.empty(len(t), dtype=np.int64), np.empty(len(t))
        locate(self._run(), self._n_rows, t, row, tau)
        return row, tau, t

    def _at_rest(self, t: Floats | None = None) -> Samples:
        """The state of a run of no length."""
        times = np.array([self.end.t]) if t is None else np.ascontiguousarray(t, dtype=float)
        k, problem = len(times), self.problem
        wide = partial(np.repeat, repeats=k, axis=1)
        g = problem.contacts.W.T @ self.end.v - problem.contacts.w
        mode = np.zeros(1, np.int8) if self.end.mode is None else self.end.mode
        empty = np.zeros((problem.m, k))
        return Samples(
            t=times, q=wide(self.end.q[:, None]), v=wide(self.end.v[:, None]), z=np.zeros((0, k)), F=empty,
            g=wide(g[:, None]), N=wide(problem.contacts.N[:, None]), mode=wide(mode[:, None]),
            friction_loss=np.zeros((problem.n_c, k)), damping_loss=np.zeros(k), input=np.zeros(k),
        )  # fmt: skip

    def _states(
        self, row: Ints, tau: Floats, t: Floats, *, with_loss: bool = False
    ) -> tuple[Floats, Floats, Floats, Floats, Ints, Floats]:
        problem = self.problem
        n, m, k = problem.n, problem.m, len(row)
        hold, load = stick_forces(problem)
        q, v, F, g = np.empty((n, k)), np.empty((n, k)), np.empty((m, k)), np.empty((m, k))
        mode, loss = np.empty(k, dtype=np.int64), np.empty(k if with_loss else 0)
        sample_rows(
            self._run(), row, tau, t, hold, load, np.zeros((m, padded(self._s))),
            np.zeros((BY_FORCE + 2 * m, padded(n))), q, v, F, g, mode, loss,
        )  # fmt: skip
        return q, v, F, g, mode, loss

    def _power_states(self, row: Ints, tau: Floats) -> tuple[Floats, Floats, Floats, Floats]:
        stuck = self._rows.kinds[row, 0] == STICK
        if self.problem.n >= MANY and stuck.any():
            held = held_states(self._run(), *stick_forces(self.problem), row[stuck], tau[stuck])
            if stuck.all():
                return held
            found = tuple(np.empty((*part.shape[:-1], len(row))) for part in held)
            for whole, one, other in zip(found, held, self._power_states(row[~stuck], tau[~stuck]), strict=True):
                whole[..., stuck], whole[..., ~stuck] = one, other
            return found[0], found[1], found[2], found[3]
        t = self._rows.steps[row, 0] + tau
        q, v, F, _, _, _ = self._states(row, tau, t)
        return t, q, v, F

    def _energies(self, row: Ints, tau: Floats) -> Floats:
        """Damping loss and input (2, n_t) since the start of the run."""
        start, rate = linear_part(self.problem)
        if not has_ledger(self.problem):
            return np.zeros((2, len(row)))
        held = structure(self.problem).piece.arrays
        fastest = float(np.sqrt(np.abs(held["w2"])).max(initial=0.0)) + float(np.abs(held["damp"]).max(initial=0.0))
        at_once = max(1000, NUMBERS // max(1, self.problem.n))
        short = HeldLedger(self.problem, self._rows.kinds[: self._n_rows, 0] == STICK, fastest, at_once)
        power = power_of(self.problem, start, rate)
        since = partial(from_row_starts, self._power_states, power, short, fastest=fastest, at_once=at_once)
        tau = np.maximum(tau, 0.0)
        if self._totals is not None:
            return self._totals[:, row] + since(row, tau)
        # the first time the ends of all rows are asked for along with these times: one pass over the run
        k = self._n_rows
        begin = self._rows.steps[:k, 0] + self._rows.steps[:k, 1]
        length = np.maximum(np.append(begin[1:], self.end.t) - begin, 0.0)
        found = since(np.append(np.arange(k), row), np.append(length, tau))
        self._totals = np.cumsum(np.hstack([np.zeros((2, 1)), found[:, :k]]), axis=1)
        return self._totals[:, row] + found[:, k:]

    def _motion(self, row: Ints, tau: Floats, t: Floats, *, with_loss: bool = False) -> tuple[MotionSamples, Floats]:
        """Motion, and the loss to friction if it is wanted."""
        q, v, F, g, mode, loss = self._states(row, tau, t, with_loss=with_loss)
        found = MotionSamples(
            t=t, q=q, v=v, z=np.empty((0, len(t))), F=F, g=g, N=np.full((1, len(t)), self.problem.contacts.N[0]),
            mode=mode.astype(np.int8)[None],
        )  # fmt: skip
        return found, loss

    def _samples(self, row: Ints, tau: Floats, t: Floats) -> Samples:
        motion, loss = self._motion(row, tau, t, with_loss=True)
        damping, supply = self._energies(row, tau)
        return motion.with_energies(friction_loss=loss[None], damping_loss=damping, input=supply)
