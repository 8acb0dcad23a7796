"""A run kept as its steps, its transitions and a few states from which any part can be run again."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.compile.exchange import numbers_of, put_numbers, with_arrays
from fricmb.integrate.problem import Codes, Floats, Problem, Start
from fricmb.integrate.run.chunked_run import take
from fricmb.integrate.run.stop import in_slices
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.prepare import net_lent, no_samples
from fricmb.integrate.taylor.prepare_groups import has_planar
from fricmb.integrate.taylor.step_loop import PAUSE, drive_taylor
from fricmb.integrate.trajectory import Counters, Samples, Trajectory, Transitions

#: Numbers that checkpoints and rows may hold altogether.
NUMBERS, ROWS = 3_000_000, 20_000_000
#: Round-off of a time that is a step's beginning and its length times a part of it.
GRAIN = 1e-14
#: Steps at a time on the way to samples.
STRIDE = 16
#: Steps that one of the times asked for may cost where a run leaps over rest.
ASKED = 10
#: Arrays that a run has once, which the first of the states keeps; those of each.
ONCE = ("stops", "edge", "within", "quiet_edge", "quiet_least", "quiet_most", "quiet_gain")
STATE = (
    "q", "v", "top", "mode", "sigma", "loss", "mark", "since", "large", "free", "window",
)  # fmt: skip


class Checkpoints:
    """States at the starts of steps, a stride apart; every other one goes when they are too many."""

    def __init__(self, n: int) -> None:
        self._most = int(np.clip(NUMBERS / (7 * max(n, 1)), 4, 64))
        self.stride = STRIDE
        self.held: list[dict[str, Any]] = []

    def add(self, net: Net) -> None:
        """Keep the present state."""
        names = STATE if self.held else (*STATE, *ONCE)
        state = {name: getattr(net, name).copy() for name in names}
        self.held.append({**state, "t": net.time, "numbers": numbers_of(net)})
        if len(self.held) > self._most:
            del self.held[1::2]
            self.stride *= 2


class TaylorRun(Trajectory):
    """See the module; values at the times asked for in advance are held, others are run again from a checkpoint."""

    def __init__(
        self, problem: Problem, degree: int, steps: Floats, events: Floats, counters: Counters, end: Start,
        failure: str | None, marks: list[dict[str, Any]], kept: Samples | None,
    ) -> None:  # fmt: skip
        self.problem = problem
        self.counters = counters
        self.end = end
        self.failure = failure
        self._degree = degree
        self._steps = steps
        self._events = events
        self._marks = marks
        self._kept = kept

    @property
    def steps(self) -> Floats:
        """Begin and length of the steps (n_steps, 2)."""
        return self._steps

    def until(self, end: Start, failure: str) -> TaylorRun:
        """The run up to ``end``, where the scene does not let it go on."""
        held = self._kept if self._kept is None else take(self._kept, self._kept.t <= end.t)
        cut = TaylorRun(
            self.problem, self._degree, self._steps[self._steps[:, 0] < end.t], self._events, self.counters, end,
            failure, self._marks, held,
        )  # fmt: skip
        cut.of_scene = True
        return cut

    @cached_property
    def transitions(self) -> Transitions:  # type: ignore[override]
        """The transitions; a run that stops within a step ends where that began."""
        t, contact, kind = self._events[self._events[:, 0] <= self.end.t].T
        return Transitions(t=t.copy(), contact=contact.astype(int), kind=kind.astype(int))

    @cached_property
    def _row_times(self) -> tuple[Floats, Codes]:
        """Times of the rows, and whether the left-hand value is meant."""
        starts = np.append(self._steps[:, 0], self.end.t)
        width = 2 * self.problem.n + 4 * max(self.problem.n_c, 1)
        # what jumps at a breakpoint has a value on each side, too
        breaks = self.problem.signals.breakpoints
        events = np.append(self.transitions.t, breaks[(breaks > starts[0]) & (breaks < starts[-1])])
        if (len(starts) + 2 * len(events)) * width <= ROWS:
            inner = starts[~_beside(starts, np.sort(events))]
            t = np.concatenate([inner, events, events])
            left = np.concatenate([np.zeros(len(inner)), np.ones(len(events)), np.zeros(len(events))])
            order = np.lexsort((-left, t))
            t, left = t[order], left[order]
            # transitions at one instant share their rows
            new = np.append(True, (np.diff(t) > 0.0) | (np.diff(left) != 0.0))
            return t[new], left[new].astype(np.int8)
        thin = max(1, -(-len(starts) * width // ROWS))
        chosen = np.append(starts[:-1:thin], starts[-1])
        return chosen, np.zeros(len(chosen), np.int8)

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        return float(self._steps[0, 0]) if len(self._steps) else self.end.t, self.end.t

    @property
    def t(self) -> Floats:
        """Times of the rows."""
        return self._row_times[0]

    def rows(self) -> Samples:
        """Values at the steps, and on both sides of transitions where these are not too many."""
        return self._again(*self._row_times)

    def sample(self, t: Floats) -> Samples:
        """Values at any times within the run."""
        t = np.ascontiguousarray(t, dtype=float)
        if self._kept is not None and np.array_equal(t, self._kept.t):
            return self._kept
        order = np.argsort(t, kind="stable")
        found = self._again(t[order], np.zeros(len(t), np.int8))
        if np.array_equal(order, np.arange(len(t))):
            return found
        back = np.empty_like(order)
        back[order] = np.arange(len(t))
        return Samples(**{name: getattr(found, name)[..., back] for name in Samples.__dataclass_fields__})

    def _again(self, t: Floats, left: Codes) -> Samples:
        """Run again through rising times."""
        problem = self.problem
        with net_lent(problem, self._degree) as lent:
            if len(t) == 0:
                return samples_of(problem, with_arrays(lent, **no_samples(problem.n, problem.m)), slice(0, 0))
            state = self._state_before(float(t[0]))
            for name in STATE:
                getattr(lent, name)[:] = state[name]
            put_numbers(lent, state["numbers"])
            last = len(self.transitions.t)
            net = with_arrays(
                lent, **{name: self._marks[0][name] for name in ONCE},
                events=np.zeros((last + problem.m + 1, 3)),
                # pauses at marks may end steps, too, and each of the times a leap at rest
                steps=np.zeros((2 * len(self._steps) + ASKED * len(t) + STRIDE, 2)),
                **{**no_samples(problem.n, problem.m, len(t)), "times": np.ascontiguousarray(t), "left": left},
            )  # fmt: skip
            net.n_samples = 0
            if self.failure is not None:
                net.end = self.end.t  # nothing comes behind it
            while net.n_samples < len(t) and in_slices(drive_taylor, net, int(net.n_steps) + STRIDE) == PAUSE:
                pass
            for at in range(int(net.n_samples), len(t)):  # of a run that could not begin
                net.out_q[at], net.out_v[at], net.out_mode[at] = net.q, net.v, net.mode
            return samples_of(problem, net, slice(0, len(t)))

    def _state_before(self, t: float) -> dict[str, Any]:
        times = [state["t"] for state in self._marks]
        # a left-hand value at the start of a step belongs to the step before
        return self._marks[max(0, int(np.searchsorted(times, t, side="left")) - 1)]


def _beside(t: Floats, events: Floats) -> NDArray[np.bool_]:
    """Whether times (n_t,) are those of transitions (rising), but for round-off.

    A step in which nothing accelerates ends at a break-away, which the next one finds at its beginning: a value there
    belongs to one side or the other, and a row of its own would be taken for the left one.
    """
    found = np.zeros(len(t), dtype=bool)
    for k in (-1, 0):
        at = np.clip(np.searchsorted(events, t) + k, 0, max(len(events) - 1, 0))
        if len(events):
            found |= np.abs(events[at] - t) <= GRAIN * np.maximum(np.abs(t), 1e-300)
    return found


def samples_of(problem: Problem, net: Net, part: slice) -> Samples:
    """What a run has kept at wanted times."""
    t = net.times[part]
    # islands joined write their rows into it
    N = np.repeat(np.asarray(problem.contacts.N, float)[:, None], len(t), axis=1)
    first = problem.contacts.row[:-1]
    mode, loss = net.out_mode[part].T, net.out_loss[part].T
    if has_planar(problem):
        mode, loss = mode[first], np.add.reduceat(loss, first, axis=0)
    return Samples(
        t=t, q=net.out_q[part].T, v=net.out_v[part].T, z=np.empty((0, len(t))), F=net.out_F[part].T,
        g=net.out_g[part].T, N=N, mode=mode, friction_loss=loss,
        damping_loss=net.out_x[part, 1].copy(), input=net.out_x[part, 0].copy(),
    )  # fmt: skip
