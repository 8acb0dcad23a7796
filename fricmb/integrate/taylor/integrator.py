"""The integrator: degree and step from the tolerance, the run, its checkpoints."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from fricmb.integrate.compile.exchange import put_zeros, with_arrays
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.problem import SLIP, Floats, Problem, Start
from fricmb.integrate.run.memory import lengthen
from fricmb.integrate.run.stop import ended, in_slices
from fricmb.integrate.signals.longest_steps import steps_of_run
from fricmb.integrate.suits_taylor import fastest
from fricmb.integrate.taylor.driving import Driving, find_driving
from fricmb.integrate.taylor.friction_curve import LEAST
from fricmb.integrate.taylor.layout import GOES_ON
from fricmb.integrate.taylor.network import OF_RUN, Net
from fricmb.integrate.taylor.prepare import net_lent, no_samples, refusal
from fricmb.integrate.taylor.prepare_groups import has_planar
from fricmb.integrate.taylor.quiet import quiet_of
from fricmb.integrate.taylor.starting_modes import settle_start
from fricmb.integrate.taylor.step_loop import (
    CREEPS,
    CROWDED,
    DONE,
    FULL,
    NOT_FINITE,
    PAUSE,
    SETTLE,
    TOO_SHORT,
    TOO_STEEP,
    WIDE,
    drive_taylor,
)  # fmt: skip
from fricmb.integrate.taylor.trajectory import Checkpoints, TaylorRun, samples_of
from fricmb.integrate.trajectory import Counters, Trajectory

FAILURES = {
    CROWDED: "more than {limit} transitions in one step: too dense to be located one by one (take radau)",
    WIDE: "a transition is felt by too many degrees of freedom within one step (take radau)",
    NOT_FINITE: "the state grew beyond floating-point numbers",
    TOO_SHORT: "the step size fell below round-off: a function of time cannot be followed",
    CREEPS: "the direction of slip turns so fast that steps are next to nothing (take radau or bdf)",
    TOO_STEEP: "the coefficient of friction of contact {contact!r} is followed over slip speeds of {range:.1e} alone: "
    "it falls without bound there (give its law a finite slope at rest, or take radau or bdf)",
}
#: A friction curve over less than this part of the largest speed is that of a law without a slope.
NARROW = 1e-10
#: Bytes that tables of twice the length take beside those there are, per byte of these: the others are let go, and
#: values at the rows are found by steps that are made again, in tables twice as long (and something is left).
GROWTH = 6.0
#: What to do where tables find no room.
ADVICE = "on_chunk= keeps less, and method='auto' or 'radau' may take longer steps"


def degree_for(rtol: float) -> int:
    """Degree of the polynomials that takes the least time to a tolerance."""
    return int(np.clip(round(7.0 - math.log10(rtol)), 8, 22))


@dataclass(frozen=True, kw_only=True)
class Taylor(Integrator):
    """Taylor steps of all degrees of freedom at once, with polynomial corrections around every transition.

    For many contacts, along a line or in a plane, under constant coefficients or formulas of slip speed, in structures
    with a diagonal mass matrix and few neighbours a degree of freedom (chains, grids).  Explicit: the fastest mode
    limits the step.

    Attributes
    ----------
    degree : int or None
        Of the polynomials, 6 to 30; None: from the tolerance.
    reach : float
        Longest step times the highest frequency.
    crowd : int
        Transitions a contact, on average, from which on a step counts as too crowded.
    """

    degree: int | None = None
    reach: float = 3.0
    crowd: int = 20

    name: ClassVar[str] = "taylor"
    order: ClassVar[str] = "8 to 22"
    takes: ClassVar[frozenset[str]] = frozenset({"linear", "ports"})

    def refuses(self, problem: Problem) -> str | None:
        """Why this integrator cannot run the problem, or None."""
        reason = refusal(problem)
        return None if reason is None else f"taylor takes chains and their like; {reason}"

    def integrate(
        self,
        problem: Problem,
        start: Start,
        t_end: float,
        *,
        tolerance: Tolerance,
        step: float | None = None,
        t_eval: Floats | None = None,
        progress: Callable[[float], None] | None = None,
        memory: float | None = None,
    ) -> Trajectory:
        """Run from ``start`` to ``t_end`` (see :class:`Integrator`)."""
        degree = self.degree or degree_for(tolerance.rtol)
        with net_lent(problem, degree) as lent:
            net = set_start(problem, lent, start, t_end, tolerance, self.reach, self.crowd)
            if t_eval is not None:
                empty = no_samples(problem.n, problem.m, len(t_eval))
                net = with_arrays(net, **{**empty, "times": np.ascontiguousarray(t_eval, dtype=float)})
            settle_start(net, start.mode is not None)
            marks = Checkpoints(problem.n)
            code, net, short = run(net, marks, (t_end - start.t) / 100.0, progress)
            failure = None if code == DONE else ended() or short or failure_text(problem, net, code)
            done = _trajectory(problem, net, degree, marks, failure, t_eval)
            if net.groups.work[LEAST] >= 0.0:
                return done
        driving = find_driving(problem, done, done.steps, tolerance.rtol)
        return done if driving is None else done.until(driving.end, _drives(problem, driving))


def set_start(
    problem: Problem, net: Net, start: Start, t_end: float, tolerance: Tolerance, reach: float, crowd: int
) -> Net:
    """The state and the numbers of a run."""
    net.q[:], net.v[:] = start.q, start.v
    net.top[:] = np.abs(start.v)
    if tolerance.atol_v is not None:
        np.maximum(net.top, tolerance.atol_v / tolerance.rtol, out=net.top)
    # series of functions that bend are made on one side, as at a breakpoint
    breaks = np.concatenate([problem.signals.breakpoints, problem.signals.kinks])
    inside = np.unique(breaks[(breaks > start.t) & (breaks < t_end)])
    limits = steps_of_run(problem, start.t, t_end, tolerance)
    ends, least, most, gain = quiet_of(problem, start.t, t_end)
    net = with_arrays(
        net, stops=np.append(inside, t_end), edge=limits.edge, within=limits.longest, quiet_edge=ends,
        quiet_least=least, quiet_most=most, quiet_gain=gain,
    )  # fmt: skip
    span = t_end - start.t
    w = fastest(problem)
    degree = net.Q.shape[0] - 1
    # what a break-away early in a step leaves beyond the last degree is seen after the step alone
    unseen = math.exp((math.log(tolerance.rtol) + math.lgamma(degree + 1.0)) / degree)
    longest = min(span, min(reach, unseen) / w) if w > 0.0 else span
    speed = max(np.abs(start.v).max(initial=0.0), np.abs(problem.contacts.w).max(initial=0.0))
    put_zeros(net, OF_RUN)
    net.time, net.end, net.longest, net.next_step = start.t, t_end, longest, longest
    # the direction of slip turns faster than all else where slip is slow: stick and slip lose their phase by that
    net.tol = (0.01 if has_planar(problem) else 0.1) * tolerance.rtol
    net.step = longest
    net.noise = 1e-13 * speed
    net.limit = crowd * problem.n_c + 1000
    net.phase = SETTLE
    net.groups.work[LEAST] = 0.0
    net.loss[:], net.large[:] = 0.0, 0.0
    net.mode[:], net.sigma[:] = SLIP, 1.0
    net.free[:] = 1.0
    net.since[:] = -1.0
    if start.mode is not None:
        net.mode[:] = start.mode[problem.contacts.of_row]
        net.since[net.mode == SLIP] = GOES_ON
        if start.direction is not None:
            net.sigma[:] = np.where(start.direction == 0.0, 1.0, start.direction)
    return net


def run(
    net: Net, marks: Checkpoints, every: float, progress: Callable[[float], None] | None
) -> tuple[int, Net, str | None]:
    """Drive to the end, or to where rows find no room and why; checkpoints are taken where a stride is done."""
    marks.add(net)
    report = float(net.time) + every
    while True:
        code = in_slices(drive_taylor, net, int(net.n_steps) + marks.stride)
        if code == PAUSE and ended() is None:
            marks.add(net)
            if progress is not None and net.time > report:
                report += every
                progress(float(net.time))
        elif code == FULL and ended() is None:
            steps = int(net.n_steps)
            wanted = GROWTH * float(net.events.nbytes + net.steps.nbytes)
            longer, short = lengthen(partial(_more_rows, net), wanted, "taylor", steps, ADVICE)
            if longer is None:
                return code, net, short
            net = with_arrays(net, **longer)
        else:
            return code, net, None


def failure_text(problem: Problem, net: Net, code: int) -> str:
    """Why a run stopped; steps that shrink, and stick and slip without end, may be a law's."""
    narrow = np.where(net.groups.half > 0.0, net.groups.half, math.inf)
    if code in (CROWDED, TOO_SHORT) and narrow.min(initial=math.inf) < NARROW * net.fastest:
        at = int(narrow.argmin())
        row = np.flatnonzero(net.groups.lawful == at)[0]
        contact = problem.contact_names[problem.contacts.of_row[row]]
        return FAILURES[TOO_STEEP].format(contact=contact, range=2.0 * narrow[at])
    return FAILURES[code].format(limit=int(net.limit))


def _more_rows(net: Net) -> dict[str, Floats]:
    """Tables of events and steps with space for more."""
    events = _longer(net.events, int(net.n_events) + len(net.mode))
    return {"events": events, "steps": _longer(net.steps, int(net.n_steps))}


def _longer(table: Floats, wanted: int) -> Floats:
    if wanted < len(table):
        return table
    longer = np.zeros((len(table) + max(len(table), wanted), table.shape[1]))  # takes memory as it is filled
    longer[: len(table)] = table
    return longer


def _drives(problem: Problem, driving: Driving) -> str:
    return f"the friction coefficient of contact {problem.contact_names[driving.contact]!r} is negative"


def _trajectory(
    problem: Problem, net: Net, degree: int, marks: Checkpoints, failure: str | None, t_eval: Floats | None
) -> TaylorRun:
    events = net.events[: net.n_events].copy()
    events[:, 1] = problem.contacts.of_row[events[:, 1].astype(int)]
    steps = int(net.n_steps)
    counters = Counters(n_steps=steps, n_rejected=int(net.n_shorter), n_rhs=steps * degree, n_jac=int(net.n_searches))
    end = Start(
        t=float(net.time), q=net.q.copy(), v=net.v.copy(), z=np.zeros(0),
        mode=net.mode[problem.contacts.row[:-1]],
        direction=net.sigma.copy(),
    )  # fmt: skip
    kept = None if t_eval is None else samples_of(problem, net, slice(0, int(net.n_samples)))
    return TaylorRun(problem, degree, net.steps[:steps].copy(), events, counters, end, failure, marks.held, kept)
