"""A run of the general method as rows, and its dense output."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.compile.lapack import load_lapack
from fricmb.integrate.compile.parallel_compile import load_blocks
from fricmb.integrate.model.damped_normals import damped_normals
from fricmb.integrate.model.instant_workspace import InstantWorkspace, instant_workspace
from fricmb.integrate.model.problem_structs import packed_of
from fricmb.integrate.output.hermite_output import sample_rows
from fricmb.integrate.output.recorder import AFTER, INSIDE
from fricmb.integrate.output.step_energies import integrate_between, integrate_powers, scale_of
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Codes2, Floats, Floats2, Ints, Problem, Start
from fricmb.integrate.trajectory import Counters, MotionSamples, Samples, Trajectory, Transitions

#: Rows as they were collected: values (n_r, width) as in Rows, kind (n_r,), mode (n_r, n_c).
Chunk = tuple[Floats, Codes, Codes2]


class RowTrajectory(Trajectory):
    """A run kept as rows, in chunks until they are first asked for: to put them together takes as long as a copy.

    ``rtol``: tolerance of the run, to which energies are integrated.
    """

    rtol: float = 1e-6
    #: Whether a step's own energies are looked at again; those of exact structure are collocated with the motion.
    integrates: bool = True

    def __init__(
        self, problem: Problem, chunks: list[Chunk], transitions: Transitions, counters: Counters, end: Start,
        failure: str | None,
    ) -> None:  # fmt: skip
        super().__init__(problem, transitions, counters, end, failure)
        values, kind, mode = zip(*chunks, strict=True)
        self._parts: dict[str, Sequence[Any]] = {"values": values, "kind": kind, "mode": mode}

    @cached_property
    def _values(self) -> Floats:
        return np.concatenate(self._parts.pop("values"))

    @cached_property
    def _kind(self) -> Codes:
        return np.concatenate(self._parts.pop("kind"))

    @cached_property
    def _mode(self) -> Codes2:
        return np.concatenate(self._parts.pop("mode"))

    @cached_property
    def _times(self) -> Floats:
        return np.ascontiguousarray(self._values[:, 0])

    @cached_property
    def _steps(self) -> Ints:
        """Rows of accepted steps."""
        return np.flatnonzero(self._kind != INSIDE)

    def __getstate__(self) -> dict[str, Any]:
        rows = {name: getattr(self, name) for name in ("_values", "_kind", "_mode", "_times", "_steps")}
        made = {"_parts", "_integrates", "_damped_out", "_recorded", "_scale", "_spent"}
        return {name: value for name, value in {**super().__getstate__(), **rows}.items() if name not in made}

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the run."""
        parts = vars(self).get("_parts", {})
        if not {"values", "kind"} <= parts.keys():
            return super().ends
        last = np.flatnonzero(parts["kind"][-1] != INSIDE)
        if not last.size:
            return super().ends
        return float(parts["values"][0][0, 0]), float(parts["values"][-1][last[-1], 0])

    @property
    def t(self) -> Floats:
        """Times of the accepted steps."""
        return self._times[self._steps]

    def rows(self) -> Samples:
        """Values at the accepted steps, as they were found."""
        motion, said = self._sampled(self.t, self._steps)
        return self._complete(motion, self._spent.T if self._integrates else said)

    def row_motion(self) -> MotionSamples:
        """The same without energies."""
        return self._sampled(self.t, self._steps)[0]

    def sample(self, t: Floats) -> Samples:
        """Dense output."""
        t = np.ascontiguousarray(t, dtype=float)
        motion, said = self._sampled(t, self._row_before(t))
        if not self._integrates:
            return self._complete(motion, said)
        step = np.maximum(np.searchsorted(self.t, t, side="right") - 1, 0)
        before = self._recorded[step]
        own = integrate_between(self._powers, t, step, said.T, self.t[step], before, self.rtol, self._scale)
        damped = self._damped_out[np.minimum(step, self._damped_out.size - 1)]
        own[damped, -2] = (said.T - before)[damped, -2]
        return self._complete(motion, (self._spent[step] + own).T)

    def motion(self, t: Floats) -> MotionSamples:
        """Dense output without energies, for which powers are integrated anew."""
        t = np.ascontiguousarray(t, dtype=float)
        return self._sampled(t, self._row_before(t), False)[0]

    def _row_before(self, t: Floats) -> Ints:
        return np.maximum(np.searchsorted(self._times, t, side="right") - 1, 0)

    # -- energies -----------------------------------------------------------------------------------------------
    @cached_property
    def _integrates(self) -> bool:
        """Whether powers are integrated anew.

        Where damped contacts open, what they store knows more than powers; and steep smooth laws make any force of what
        velocities between steps err by.
        """
        smooth = bool((self.problem.contacts.law == LAW_SMOOTH).any())
        return self.integrates and not smooth and not damped_normals(self.problem).any()

    @cached_property
    def _damped_out(self) -> NDArray[np.bool_]:
        """Steps (n_t - 1,), or one, in which dampers calm something that the step does not follow.

        What velocities between its stages err by, squared, is then no measure of what is lost.
        """
        structure = packed_of(self.problem).structure
        inertia = np.repeat(structure.M[structure.own], np.diff(structure.first))
        rate = np.max(np.abs(structure.C) / inertia, initial=0.0)
        return np.append(np.diff(self.t) * rate > 1.0, False)

    @cached_property
    def _recorded(self) -> Floats:
        """Energies at the accepted steps (n_t, n_c + 2), as their stages say."""
        return self._sampled(self.t, self._steps)[1].T

    @cached_property
    def _scale(self) -> Floats:
        n, structure = self.problem.n, packed_of(self.problem).structure
        moved = 0.5 * np.max(self._values[:, 1 + n : 1 + 2 * n] ** 2 @ structure.M[structure.own], initial=0.0)
        return scale_of(np.diff(self._recorded, axis=0), moved, self.rtol)

    @cached_property
    def _spent(self) -> Floats:
        """Energies at the accepted steps (n_t, n_c + 2)."""
        t, own = self.t, np.diff(self._recorded, axis=0)
        steps = np.flatnonzero(np.diff(t) > 0.0)
        start, end = t[steps], t[steps + 1]
        said = own[:, -2].copy()
        own[steps] = integrate_powers(self._powers, start, end, steps, own[steps], self.rtol, self._scale)
        damped = self._damped_out[:-1]
        own[damped, -2] = said[damped]
        return np.concatenate([self._recorded[:1], self._recorded[0] + np.cumsum(own, axis=0)])

    def _powers(self, t: Floats, step: Ints) -> Floats:
        """Powers (n_t, n_c + 2) at times within steps."""
        power = np.zeros((len(t), self.problem.n_c + 2))
        self._sampled(t, self._row_before(t), False, power)
        return power

    def _complete(self, motion: MotionSamples, work: Floats2) -> Samples:
        damping = work[-2] - self._lost_at_start if self._lost_at_start else work[-2]
        return motion.with_energies(friction_loss=work[:-2], damping_loss=damping, input=work[-1])

    @cached_property
    def _lost_at_start(self) -> float:
        """Damping loss before there was any: less by what contacts with damping store at the start."""
        if not damped_normals(self.problem).any():
            return 0.0
        return float(self._sampled(self._times[:1], np.zeros(1, np.int64), False)[1][-2, 0])

    def _sampled(
        self, t: Floats, index: Ints, energies: bool = True, power: Floats2 | None = None
    ) -> tuple[MotionSamples, Floats2]:
        """Motion within the rows ``index``, and energies (n_c+2, n_t); ``power`` (n_t, n_c+2), if given, is filled."""
        problem = self.problem
        n, m, nc, nz = problem.n, problem.m, problem.n_c, problem.n_z
        out = np.zeros((len(t), 1 + 2 * n + nz + 2 * m + nc + nc + 2))
        modes = np.zeros((len(t), nc), np.int8)
        index = index.astype(np.int64)
        side = np.where(self._arriving[index] & (t <= self._times[index]), np.nextafter(t, -np.inf), self._times[index])
        with instant_workspace(problem) as workspace:
            none = np.zeros((0, 0))
            self._fill(workspace, index, t, side, out, modes, energies, none if power is None else power)
        ends = np.cumsum([1, n, n, nz, m, nc, m, nc + 2])
        _, q, v, z, F, N, g, work = np.split(np.ascontiguousarray(out.T), ends[:-1])
        return MotionSamples(t=t, q=q, v=v, z=z, F=F, g=g, N=N, mode=np.ascontiguousarray(modes.T)), work

    @cached_property
    def _arriving(self) -> NDArray[np.bool_]:
        """Rows that end what lies before their time: where a function of time jumps, they have not seen it yet."""
        row = np.arange(len(self._times))
        fresh = np.diff(self._times, prepend=-np.inf) > 0.0
        first = np.maximum.accumulate(np.where(fresh, row, 0))
        passed = np.maximum.accumulate(np.where(self._kind == AFTER, row, -1))
        return passed < first

    def _fill(
        self, workspace: InstantWorkspace, index: Ints, t: Floats, side: Floats, out: Floats2, modes: Codes2,
        energies: bool, power: Floats2,
    ) -> None:  # fmt: skip
        """Rows of values and modes at times within the rows ``index``.

        ``side``: a time on the side of a breakpoint on which each is; ``energies``: whether they are needed.
        """
        packed, problem = packed_of(self.problem), self.problem
        load_lapack()
        load_blocks("complete")
        sizes, pivots = np.zeros(4, np.int32), np.zeros(max(1, problem.m, problem.n), np.int32)
        rows = int(np.diff(self._steps).max(initial=1)) + 1
        part = np.zeros((rows if energies else 0, 2, problem.n_c + 2))
        sample_rows(
            packed, workspace.s, workspace.y, self._values, self._kind, self._mode, packed.breakpoints, index, t, side,
            part, out, modes, power, sizes, pivots,
        )  # fmt: skip
