"""What a run has left: polynomials of steps, forces and reactions found again at any time."""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np

from fricmb.integrate.implicit.equations.instants import instants
from fricmb.integrate.implicit.output.step_energies import integrate_between, integrate_powers, scale_of
from fricmb.integrate.implicit.scene.problem_structs import masses, mech_of
from fricmb.integrate.implicit.scene.structure import mechanism_of, with_open
from fricmb.integrate.implicit.workspace import evaluation
from fricmb.integrate.model.damped_normals import damped_normals
from fricmb.integrate.problem import LAW_SMOOTH, Codes, Floats, Ints, Problem, Start
from fricmb.integrate.run.outcomes import FAIL_INFINITE, FAILURES
from fricmb.integrate.trajectory import Counters, MotionSamples, Samples, Trajectory, Transitions


class StepTrajectory(Trajectory):
    """A run kept step by step; arrays as in ``Record``."""

    def __init__(
        self,
        problem: Problem,
        span: Floats,
        values: Floats,
        force: Floats,
        ahead: Floats,
        mode: Codes,
        opened: Codes,
        after: Ints,
        transitions: Transitions,
        counters: Counters,
        end: Start,
        failure: str | None,
        nodes: Floats,
        rtol: float,
    ) -> None:
        super().__init__(problem, transitions, counters, end, failure)
        self._span, self._values, self._mode, self._after = span, values, mode, after
        self._force, self._ahead = force, ahead
        self._nodes, self._opened, self._rtol = nodes, opened, rtol
        # every step's end, the start of the run, and right-hand values after transitions
        twice = after != 0
        twice[-1:] = False
        count = 1 + twice
        self._row_step, self._row_side = np.repeat(np.arange(len(span)), count), np.ones(count.sum(), int)
        behind = (np.cumsum(count) - 1)[twice]
        self._row_step[behind] += 1
        self._row_side[behind] = 0
        if len(span):
            self._row_step, self._row_side = np.append(0, self._row_step), np.append(0, self._row_side)

    @cached_property
    def t(self) -> Floats:
        """Times of the accepted steps; none where the start has no values."""
        if not len(self._span):
            return np.array([] if self.failure == FAILURES[FAIL_INFINITE] else [self.end.t])
        start = self._span[self._row_step, 0]
        ends = np.append(self._span[1:, 0], self.end.t)[self._row_step]
        times: Floats = np.where(self._row_side == 0, start, ends)
        return times

    def rows(self) -> Samples:
        """Values at the accepted steps."""
        if not len(self._span):
            return self._only_start()
        motion, stored = self._at_rows()
        return self._with_work(motion, stored, self._spent[self._row_step, self._row_side])

    def row_motion(self) -> MotionSamples:
        """Values at the accepted steps without energies."""
        return self._at_rows()[0] if len(self._span) else self._only_start()

    def _at_rows(self) -> tuple[MotionSamples, Floats]:
        values = self._values[self._row_step, np.where(self._row_side == 0, 0, len(self._nodes) - 1)]
        # what a step ends with belongs to the side of a breakpoint that it comes from
        side = np.where(self._row_side == 0, self.t, np.nextafter(self.t, -np.inf))
        # where a step begins, or ends in a transition, it says itself where slip goes, of whose speed round-off may be
        # all there is
        force = self._force[self._row_step]
        ends = (self._row_side == 1) & (self._after[self._row_step] != 0)
        force[ends, force.shape[1] - self.problem.m :] = self._ahead[self._row_step[ends]]
        still = np.full(len(self.t), _still(values[:, self.problem.n : 2 * self.problem.n]))
        still[ends | (self._row_side == 0)] = np.inf
        return self._complete(self.t, values, self._row_step, side=side, still=still, force=force)[:2]

    def sample(self, t: Floats) -> Samples:
        """Dense output."""
        t = np.ascontiguousarray(t, dtype=float)
        if not len(self._span):
            return self._only_start(len(t))
        step, values = self._inside(t)
        motion, stored, _ = self._complete(t, values, step, project=True)
        said, before = values[:, -self._width :], self._values[step, 0, -self._width :]
        own = said - before
        if not self._is_smooth:
            own = integrate_between(self._powers, t, step, said, self._span[step, 0], before, self._rtol, self._scale)
        return self._with_work(motion, stored, self._spent[step, 0] + own)

    def motion(self, t: Floats) -> MotionSamples:
        """Dense output without energies."""
        t = np.ascontiguousarray(t, dtype=float)
        if not len(self._span):
            return self._only_start(len(t))
        step, values = self._inside(t)
        return self._complete(t, values, step, project=True)[0]

    def _inside(self, t: Floats) -> tuple[Ints, Floats]:
        """The step of every time, and the values there (n_t, .)."""
        step = np.clip(np.searchsorted(self._span[:, 0], t, side="right") - 1, 0, len(self._span) - 1)
        return step, self._at(t, step)

    def _at(self, t: Floats, step: Ints) -> Floats:
        """Values (n_t, .) of the polynomials of steps."""
        x = np.clip((t - self._span[step, 0]) / self._span[step, 1], 0.0, 1.0)
        found: Floats = np.einsum("tj,tjw->tw", lagrange_weights(self._nodes, x), self._values[step])
        return found

    def __getstate__(self) -> dict[str, Any]:
        made = {"t", "_said", "_scale", "_spent", "_stored_at_start"}
        return {name: value for name, value in super().__getstate__().items() if name not in made}

    # -- energies -----------------------------------------------------------------------------------------------
    @property
    def _width(self) -> int:
        """Number of energies: lost by each port, by damping, and brought in."""
        return self.problem.n_c + 2

    @property
    def _is_smooth(self) -> bool:
        """Whether a law may be so steep that it makes any force of what velocities between stages err by."""
        return bool((self.problem.contacts.law == LAW_SMOOTH).any())

    @cached_property
    def _said(self) -> Floats:
        """Energies of every step as its stages say (k, w)."""
        said: Floats = self._values[:, -1, -self._width :] - self._values[:, 0, -self._width :]
        return said

    @cached_property
    def _scale(self) -> Floats:
        n = self.problem.n
        moved = 0.5 * np.max(self._values[:, -1, n : 2 * n] ** 2 @ masses(mechanism_of(self.problem)), initial=0.0)
        return scale_of(self._said, moved, self._rtol)

    @cached_property
    def _spent(self) -> Floats:
        """Energies at the start and at the end of every step (k, 2, w); impulses come between two."""
        steps = np.arange(len(self._span))
        start, end = self._span[:, 0], np.append(self._span[1:, 0], self.end.t)
        found = self._said
        if not self._is_smooth:
            found = integrate_powers(self._powers, start, end, steps, found, self._rtol, self._scale)
        leaps = self._values[:, 0, -self._width :].copy()
        leaps[1:] -= self._values[:-1, -1, -self._width :]
        parts = np.stack([leaps, found], axis=1)
        spent: Floats = np.cumsum(parts.reshape(-1, self._width), axis=0).reshape(parts.shape)
        return spent

    def _powers(self, t: Floats, step: Ints) -> Floats:
        """Powers (n_t, w) of the dense output at times within steps."""
        return self._complete(t, self._at(t, step), step, project=True)[2]

    def _with_work(self, motion: MotionSamples, stored: Floats, work: Floats) -> Samples:
        """With energies; of contacts with damping all that they take counts as lost, less what they store."""
        damping = work[:, -2] - stored + self._stored_at_start
        return motion.with_energies(friction_loss=work[:, :-2].T.copy(), damping_loss=damping, input=work[:, -1].copy())

    def _only_start(self, count: int = 1) -> Samples:
        values = np.concatenate([self.end.q, self.end.v, self.end.z, np.zeros(self._width)])
        joints, nc, rows = mechanism_of(self.problem).joints, self.problem.n_c, self.problem.m
        m = int(joints.row[-1])
        self._opened = np.zeros((1, len(joints.port)), np.int8)
        self._force = np.zeros((1, m + 2 * rows))
        self._mode = np.ones((1, nc), np.int8) if self.end.mode is None else self.end.mode[None]
        if self.end.direction is not None:
            self._force[0, m + rows :] = self.end.direction
        start = self._complete(np.full(count, self.end.t), np.tile(values, (count, 1)), np.zeros(count, int))[0]
        return start.with_energies(
            friction_loss=np.zeros((nc, count)), damping_loss=np.zeros(count), input=np.zeros(count)
        )

    @cached_property
    def _stored_at_start(self) -> float:
        """What contacts with damping store before anything is lost."""
        if not damped_normals(self.problem).any():
            return 0.0
        return float(self._complete(self._span[:1, 0], self._values[:1, 0], np.zeros(1, int))[1][0])

    def _complete(
        self, t: Floats, values: Floats, step: Ints, *, project: bool = False, side: Floats | None = None,
        still: Floats | None = None, force: Floats | None = None,
    ) -> tuple[MotionSamples, Floats, Floats]:
        """The motion, what contacts with damping store (n_t,), and powers (n_t, w); ``force``: see ``complete_at``."""
        problem = self.problem
        n, nz = problem.n, problem.n_z
        q, v, z, _ = (np.ascontiguousarray(x) for x in np.split(values, np.cumsum([n, n, nz]), axis=1))
        found = complete_open(
            problem, self._opened[step], t, q, v, z, self._mode[step], self._force[step] if force is None else force,
            project=project, side=side, still=still,
        )  # fmt: skip
        motion = MotionSamples(
            t=t, q=q.T.copy(), v=v.T.copy(), z=z.T.copy(), F=found[0], g=found[2], N=found[1],
            mode=np.ascontiguousarray(self._mode[step].T),
        )  # fmt: skip
        return motion, found[5][0], found[6].T


def _still(v: Floats) -> float:
    """Round-off of velocities (n_t, n)."""
    return 1e-11 * float(np.abs(v).max(initial=0.0))


def complete_open(
    problem: Problem, opened: Codes, t: Floats, q: Floats, v: Floats, z: Floats, mode: Codes, force: Floats,
    *, project: bool = False, side: Floats | None = None, still: float | Floats | None = None,
) -> tuple[Floats, ...]:  # fmt: skip
    """As :func:`complete_at`, ``opened`` (n_t, n_j) saying which joints are open."""
    side = t if side is None else side
    still = np.broadcast_to(_still(v) if still is None else still, t.shape)
    if not opened.any() and not mechanism_of(problem).has_impacts:
        return complete_at(problem, t, q, v, z, mode, force, project=project, side=side, still=still)
    patterns, which = np.unique(opened, axis=0, return_inverse=True)
    found: list[Floats] = []
    for i, pattern in enumerate(patterns):
        mine = np.flatnonzero(which.ravel() == i)
        q_here, v_here = q[mine], v[mine]
        part = complete_at(
            with_open(problem, pattern), t[mine], q_here, v_here, z[mine], mode[mine], force[mine], project=project,
            side=side[mine], still=still[mine],
        )  # fmt: skip
        q[mine], v[mine] = q_here, v_here
        found = found or [np.zeros((len(x), len(t))) for x in part]
        for whole, x in zip(found, part, strict=True):
            whole[:, mine] = x
    return tuple(found)


def complete_at(
    problem: Problem, t: Floats, q: Floats, v: Floats, z: Floats, mode: Codes, force: Floats, *, project: bool = False,
    side: Floats | None = None, still: float | Floats | None = None,
) -> tuple[Floats, ...]:  # fmt: skip
    """F (m_p, n_t), N (n_c, n_t), g (m_p, n_t), multipliers (m, n_t) and accelerations (n, n_t) at states (n_t, .).

    The last two are energies (1, n_t) that contacts with damping store, and powers (n_c + 2, n_t).

    ``project``: q and v are first moved onto the constraints, in place.  ``side`` (n_t,): a time on the side of a
    breakpoint on which each state is, where that is not the right-hand one.  ``still`` (n_t,): slip slower than this
    keeps the direction that ``force`` gives it (default: round-off of these velocities).
    """
    m, nc, rows, count = mechanism_of(problem).n_rows, problem.n_c, problem.m, len(t)
    F, N, g = np.zeros((count, rows)), np.zeros((count, nc)), np.zeros((count, rows))
    lam, a, stored = np.zeros((count, m)), np.zeros((count, problem.n)), np.zeros(count)
    power = np.zeros((count, nc + 2))
    mech = mech_of(problem)
    solid = np.ascontiguousarray
    still = np.array(np.broadcast_to(_still(v) if still is None else still, t.shape), float)  # no view: it is read-only
    with evaluation(problem) as workspace:
        instants(
            mech, workspace.k, workspace.w, workspace.y, solid(t), q, v, z, solid(mode, np.int8), solid(force, float),
            still, F, N, g, lam, a, stored, project, solid(t if side is None else side, float),
            power,
        )  # fmt: skip
    return F.T.copy(), N.T.copy(), g.T.copy(), lam.T.copy(), a.T.copy(), stored[None], power.T.copy()


def lagrange_weights(nodes: Floats, x: Floats) -> Floats:
    """Weights (n_t, k) of values at the nodes for their polynomial at x."""
    last = len(nodes) - 1
    apart = nodes[:, None] - nodes
    np.fill_diagonal(apart, 1.0)
    weight = np.empty((len(nodes), len(x)))
    weight[0] = 1.0
    for j in range(last):  # products over the nodes before each one, and then over those behind it
        np.multiply(weight[j], x - nodes[j], out=weight[j + 1])
    behind = np.ones(len(x))
    for j in range(last, -1, -1):
        weight[j] *= behind / apart[j].prod()
        behind *= x - nodes[j]
    return weight.T
