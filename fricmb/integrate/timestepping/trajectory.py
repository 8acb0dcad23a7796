"""A run kept as its steps: between them velocities are straight lines, displacements parabolas."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from fricmb.integrate.problem import SLIP, STICK, Codes, Floats, Problem, Start
from fricmb.integrate.trajectory import Counters, Samples, Stretches, Trajectory, Transitions


@dataclass(frozen=True, kw_only=True)
class SteppedStart(Start):
    """A start that knows what held its contacts last.

    ``F``, ``ends``, ``hold`` (m,), ``grip``, ``when``, ``known`` (n_c,): see Run.
    """

    F: Floats
    ends: Floats
    hold: Floats
    grip: Floats
    when: Floats
    known: Codes


class SteppedRun(Trajectory):
    """Rows are the ends of steps; in ``chunks``, by their names in Run, until they are first asked for."""

    def __init__(
        self, problem: Problem, chunks: list[dict[str, Any]], transitions: Transitions, counters: Counters,
        end: Start, failure: str | None,
    ) -> None:  # fmt: skip
        super().__init__(problem, transitions, counters, end, failure)
        self._chunks = chunks

    @cached_property
    def _samples(self) -> Samples:
        chunks, self._chunks = self._chunks, []
        row = {name: np.concatenate([chunk.pop(name) for chunk in chunks]) for name in list(chunks[0])}
        return Samples(
            t=row["row_t"], q=row["row_q"].T, v=row["row_v"].T, z=np.empty((0, len(row["row_t"]))), F=row["row_F"].T,
            g=row["row_g"].T, N=row["row_N"].T, mode=row["row_mode"].T, friction_loss=row["row_loss"].T,
            damping_loss=row["row_x"][:, 0].copy(), input=row["row_x"][:, 1].copy(),
        )  # fmt: skip

    def __getstate__(self) -> dict[str, Any]:
        samples = self._samples
        state = {name: value for name, value in super().__getstate__().items() if name != "_chunks"}
        return {**state, "_samples": samples}

    @property
    def t(self) -> Floats:
        """Times of the ends of steps."""
        return self._samples.t

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        chunks = vars(self).get("_chunks")
        return (float(chunks[0]["row_t"][0]), float(chunks[-1]["row_t"][-1])) if chunks else super().ends

    @property
    def unlocated(self) -> Stretches:
        """Steps that went over a transition."""
        t, event = self._samples.t, self.transitions.t
        over = (np.diff(self._samples.mode, axis=1) != 0).any(axis=0)
        at = np.searchsorted(t, event, side="right") - 1
        inside = (at >= 0) & (at < len(over))
        over[at[inside & (t[at] < event)]] = True
        over &= np.diff(t) > 0.0
        return t[:-1][over], t[1:][over]

    def rows(self) -> Samples:
        """Values at the ends of steps."""
        return self._samples

    def sample(self, t: Floats) -> Samples:
        """Values at any times within the run."""
        rows = self._samples
        t = np.ascontiguousarray(t, dtype=float)
        if len(rows.t) < 2:
            return _take(rows, np.zeros(len(t), dtype=int), t)
        at = np.searchsorted(rows.t, t, side="right") - 1
        k = np.clip(at, 0, len(rows.t) - 2)
        h = rows.t[k + 1] - rows.t[k]
        s = (t - rows.t[k]) / h

        def line(x: Floats) -> Floats:
            left = x[..., k]
            return left + s * (x[..., k + 1] - left)

        v0 = rows.v[:, k]
        q = rows.q[:, k] + h * (s * v0 + 0.5 * s * s * (rows.v[:, k + 1] - v0))
        g = line(rows.g)
        # where slip begins or ends within the step its velocity, a line, is not 0 anywhere inside
        begins = (s > 0.0) & (rows.mode[:, k] == STICK) & (rows.mode[:, k + 1] == SLIP)
        mode = np.where(begins, SLIP, rows.mode[:, np.clip(at, 0, len(rows.t) - 1)])
        return Samples(
            t=t, q=q, v=line(rows.v), z=np.empty((0, len(t))), F=self._forces(k, s, g, mode), g=g,
            N=rows.N[:, k + 1], mode=mode,
            friction_loss=self._losses(k, s),
            damping_loss=line(rows.damping_loss), input=line(rows.input) + self._belt_work(k, s),
        )  # fmt: skip

    def _losses(self, k: np.ndarray, s: Floats) -> Floats:
        """Friction losses within steps: in proportion to the way slipped."""
        rows = self._samples
        left = rows.friction_loss[:, k]
        r0, r1 = self._speeds(k), self._speeds(k + 1)
        way = 0.5 * (r0 + r1)
        share = np.where(way > 0.0, (s * r0 + 0.5 * s * s * (r1 - r0)) / np.where(way > 0.0, way, 1.0), s)
        return left + share * (rows.friction_loss[:, k + 1] - left)

    def _belt_work(self, k: np.ndarray, s: Floats) -> Floats:
        """What the work of belts within steps is beside a straight line, where holding forces rise or fall."""
        rows, contacts = self._samples, self.problem.contacts
        owner = contacts.of_row
        same = (rows.mode[:, k] == rows.mode[:, k + 1])[owner]
        W = contacts.csr("W")

        def power(at: np.ndarray) -> Floats:
            F = np.where(same, rows.F[:, at], 0.0)
            found: Floats = (rows.v[:, at] * (W @ F)).sum(axis=0) - (F * rows.g[:, at]).sum(axis=0)
            return found

        change = power(k + 1) - power(k)
        beside: Floats = 0.5 * (rows.t[k + 1] - rows.t[k]) * change * (s * s - s)
        return beside

    def _speeds(self, k: np.ndarray) -> Floats:
        """Slip speeds (n_c, n_t) in rows."""
        return self._sizes(self._samples.g[:, k])

    def _forces(self, k: np.ndarray, s: Floats, g: Floats, mode: np.ndarray) -> Floats:
        """Forces within steps: lines where a contact's mode stays; those of slip along it, also where it begins."""
        rows, row = self._samples, self.problem.contacts.row
        if len(row) < 2:
            return rows.F[:, k]
        owner = self.problem.contacts.of_row
        before, after = rows.F[:, k], rows.F[:, k + 1]
        left, right = rows.mode[:, k], rows.mode[:, k + 1]
        share = np.where(left == right, s, (mode == right).astype(float))
        found: Floats = before + share[owner] * (after - before)
        # in slip it is the size that is on a line: where slip turns round, forces do
        size = self._sizes(before) + share * (self._sizes(after) - self._sizes(before))
        speed = self._sizes(g)
        along = ((mode == SLIP) & (speed > 0.0))[owner]
        return np.where(along, -size[owner] * g / np.where(speed > 0.0, speed, 1.0)[owner], found)

    def _sizes(self, rows: Floats) -> Floats:
        """Lengths (n_c, n_t) of what has the rows of contacts."""
        first = self.problem.contacts.row[:-1]
        if len(first) == len(rows):
            return np.abs(rows)
        found: Floats = np.sqrt(np.add.reduceat(rows**2, first, axis=0))
        return found


def _take(rows: Samples, k: np.ndarray, t: Floats) -> Samples:
    taken: dict[str, Any] = {name: getattr(rows, name)[..., k] for name in Samples.__dataclass_fields__}
    return Samples(**{**taken, "t": t})
