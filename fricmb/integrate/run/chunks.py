"""Rows of a run, taken out of the kernels' recorder chunk by chunk, until its end."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fricmb.integrate.problem import Codes, Contacts, Floats, Ints, Start
from fricmb.integrate.run.mode_changes import kind_of_change
from fricmb.integrate.run.outcomes import FULL
from fricmb.integrate.run.stop import ended, in_slices
from fricmb.integrate.trajectory import Counters, Transitions


class Chunks:
    """What the loop of a run has left so far.

    ``recorder`` has ``used`` (2,) numbers of rows and transitions, ``event`` (n_e, 3) time, contact and kind of these,
    and the arrays named ``columns``, row by row.  From the first row on in which the first of them is not finite, all
    are left out, and the run is ``broken``.
    """

    def __init__(self, recorder: Any, *columns: str) -> None:
        self.recorder = recorder
        self.columns = columns
        self.parts: list[tuple[Any, ...]] = []
        self.broken = False
        self._events: list[Any] = []

    def take(self) -> None:
        """Take out what is there."""
        k, e = (int(x) for x in self.recorder.used)
        if not self.broken:
            values = getattr(self.recorder, self.columns[0])[:k]
            found = np.isfinite(values).all(axis=tuple(range(1, values.ndim)))
            self.broken = not found.all()
            k = int(np.argmin(found)) if self.broken else k
            self.parts.append(tuple(getattr(self.recorder, name)[:k].copy() for name in self.columns))
        self._events.append(self.recorder.event[:e].copy())
        self.recorder.used[:] = 0

    def note_changes(self, contacts: Contacts, start: Start, mode: Codes, n: Floats) -> None:
        """Record what has changed, at the start of a run that goes on from ``start``, from the modes that it was given.

        The run before ended just short of a transition; ``mode`` (n_c,) and directions ``n`` (m,) are those now.
        """
        if start.mode is None:
            return
        was = n if start.direction is None else start.direction
        for c in range(contacts.row.size - 1):
            kind = kind_of_change(contacts, c, int(start.mode[c]), int(mode[c]), was, n)
            if kind >= 0:
                self._events.insert(0, np.array([[start.t, c, kind]]))

    def fill(
        self, step: Callable[[], int], y: Any, memory: float | None, progress: Callable[[float], None] | None
    ) -> int:
        """Let ``step`` fill the recorder, again and again, until the end of the run, of memory (bytes), or a failure.

        ``y``: the state of the run.  Returns what the last call did; FULL or SLICE_OVER where
        something else ended the run.
        """
        tell = None if progress is None else lambda: progress(float(y.t))
        code = FULL
        while code == FULL and ended() is None:
            code = in_slices(step, tell=tell)
            self.take()
            if tell is not None:
                tell()
            if memory is not None and sum(part[0].nbytes for part in self.parts) >= memory:
                break
        return code

    def transitions(self) -> Transitions:
        """All that were recorded."""
        event = np.concatenate(self._events) if self._events else np.zeros((0, 3))
        return Transitions(t=event[:, 0], contact=event[:, 1].astype(int), kind=event[:, 2].astype(int))


def counters(counts: Ints, notes: tuple[str, ...] = ()) -> Counters:
    """Work done, from the kernels' counts."""
    steps, rejected, rhs, jac, lu = (int(x) for x in counts[:5])
    return Counters(n_steps=steps, n_rejected=rejected, n_rhs=rhs, n_jac=jac, n_lu=lu, notes=notes)


def end_of(y: Any) -> Start:
    """Where the run ends: from there it can go on."""
    return Start(t=float(y.t), q=y.q.copy(), v=y.v.copy(), z=y.z.copy(), mode=y.mode.copy(), direction=y.n.copy())
