"""From an integrator's trajectory to a solution, or to an error with the part that is sound."""

from __future__ import annotations

import time
from functools import partial

import numpy as np

from fricmb._simulate._arguments import Span
from fricmb._simulate._blame import blame, blame_end, jumping_rate, undefined
from fricmb._simulate._cannot_lock import lock_notes
from fricmb._simulate._circumstances import circumstances
from fricmb._simulate._closes import ledger_note
from fricmb._simulate._digits import digit_notes
from fricmb._simulate._joined import JoinedRun, island_stats
from fricmb._simulate._mechanics import SceneMechanics
from fricmb._simulate._misses import miss_notes
from fricmb._simulate._moved_centres import centre_notes
from fricmb.errors import IntegrationError
from fricmb.integrate import MotionSamples, Trajectory
from fricmb.integrate.problem import LAW_COEFFICIENT, Floats
from fricmb.integrate.run.chunked_run import KeptTrajectory
from fricmb.integrate.run.memory import BEGINS
from fricmb.integrate.run.touches import own_run, without_touches
from fricmb.solution import LooksFor, Piece, Run, Solution, Stats

#: What counts as round-off at a slip speed of round-off, where the direction of slip is round-off, too: power of
#: friction relative to the largest of its contact, and speed relative to the largest.
POWER, SPEED = 1e-9, 1e-12


def make_solution(
    mechanics: SceneMechanics, trajectory: Trajectory, span: Span, method: str, why: str, begin: float,
    compile_s: float, rtol: float | None, atol: tuple[float, ...] | None = None, ended: bool = False,
    asked: LooksFor | None = None,
) -> Solution:  # fmt: skip
    """The solution of a run; ``begin`` is when the call began (perf_counter); ``rtol`` None: fixed steps.

    ``atol``: as in :class:`Stats`.  ``ended``: the run was ended from outside, so no part of the scene is to blame.
    ``asked``: events beside the transitions.

    Raises
    ------
    IntegrationError
        Where the integrator gave up, a number is not finite or a friction coefficient negative; with the solution up
        to there.
    """
    counters = trajectory.counters
    method, why = trajectory.instead or (method, why)
    counts = {name: getattr(counters, name) for name in ("n_steps", "n_rejected", "n_rhs", "n_jac", "n_lu")}
    stats = Stats(
        method=method, why=why, compile_s=compile_s, wall_s=time.perf_counter() - begin, rtol=rtol, atol=atol,
        islands=island_stats(trajectory, mechanics.members),
        notes=tuple(dict.fromkeys((*mechanics.plan.cautions, *counters.notes))), **counts,
    )  # fmt: skip
    if trajectory.failure is not None and trajectory.t.size == 0:
        said = trajectory.failure if ended else f"{trajectory.failure}{blame_end(mechanics, trajectory.end)}"
        t = trajectory.end.t
        raise IntegrationError(f"{method} stopped at t = {t:.10g}: {said}", t=t, reason=said)
    failure = trajectory.failure or not_there(trajectory, span, rtol is None)
    if failure is None:
        try:
            sol = _solution(mechanics, trajectory, stats, None, span.t_eval, asked)
            sol.take_time(time.perf_counter() - begin)
            return sol
        except _Unsound as unsound:
            t, reason, end = unsound.t, unsound.reason, unsound.end
    else:
        t = trajectory.ends[1]
        reason, end = f"{failure}{jumping_rate(mechanics)}", t
    if not (ended or reason.startswith(BEGINS)):
        digits = "".join(f"; {note}" for note in digit_notes(trajectory, None))
        around = blame(mechanics, trajectory, t) or circumstances(mechanics, trajectory, reason)
        reason = undefined(mechanics, trajectory, t) or f"{reason}{around}{digits}"
    # of a long run that takes much longer than ending it: Ctrl-C does not wait for it
    later = partial(_sound_part, mechanics, trajectory, stats, span, end, asked)
    raise IntegrationError(f"{method} stopped at t = {t:.10g}: {reason}", t=t, reason=reason, later=later)


def _solution(
    mechanics: SceneMechanics, trajectory: Trajectory, stats: Stats, t_end: float | None, times: Floats | None,
    asked: LooksFor | None,
) -> Solution:  # fmt: skip
    """The solution up to ``t_end`` (None: all of it), or _Unsound."""
    told = _as_told(mechanics, trajectory, stats.rtol)
    run = Run((Piece(told, mechanics.origin, mechanics, t_end),))
    try:
        sol = Solution(names=mechanics.names, run=run, stats=stats, times=times, find_notes=find_notes)
    except IntegrationError as error:
        raise _Unsound(error.t, error.reason, _step_before(trajectory, error.t)) from None
    check_friction(mechanics, trajectory, sol.record.samples, stats.rtol or 0.0)
    if asked is not None:
        sol.look_for(asked)
    return sol


def _as_told(mechanics: SceneMechanics, trajectory: Trajectory, rtol: float | None) -> Trajectory:
    """The run without sticks that are touches."""
    if rtol is None or trajectory.transitions.t.size < 2 or isinstance(trajectory, KeptTrajectory):
        return trajectory
    run = [i for i, _ in trajectory.runs] if isinstance(trajectory, JoinedRun) else None
    return without_touches(trajectory, mechanics.names.row, mechanics.continuous(run), rtol)


def find_notes(sol: Solution) -> tuple[str, ...]:
    """What a look at the whole run finds: asked for when notes are read, since it may take longer than the run."""
    (piece,), rtol = sol.run.pieces, sol.stats.rtol
    run = own_run(piece.trajectory)
    try:
        notes = ledger_note(sol, rtol)
    except IntegrationError as error:
        notes = (f"energies are too large for floating-point numbers: {error.reason}",)
    return (*notes, *lock_notes(sol), *centre_notes(sol), *digit_notes(run, rtol), *miss_notes(sol, run, rtol))


def _sound_part(
    mechanics: SceneMechanics, trajectory: Trajectory, stats: Stats, span: Span, end: float | None,
    asked: LooksFor | None,
) -> Solution | None:  # fmt: skip
    """The run up to ``end``, or as far as it is sound; None where it never is, or finds no room in memory."""
    while end is not None:
        times = None if span.t_eval is None else span.t_eval[span.t_eval <= end]
        try:
            return _solution(mechanics, trajectory, stats, end, times if times is None or times.size else None, asked)
        except _Unsound as unsound:
            end = unsound.end if unsound.end is not None and unsound.end < end else None
        except MemoryError:
            return None
    return None


def not_there(trajectory: Trajectory, span: Span, fixed: bool) -> str | None:
    """That a run which reports no failure has not reached its end, or None; a fixed step may miss it by a little."""
    missing = span.t_end - trajectory.ends[1]
    if missing <= (1e-2 if fixed else 1e-9) * (span.t_end - span.t_start):
        return None
    return "the run ended before its time, without a reason"


def differentiated(sol: Solution, asked: tuple[str, ...]) -> Solution:
    """The solution with the derivatives that were asked for."""
    if asked:
        sol._differentiate(asked)
    return sol


class _Unsound(Exception):
    """Something is wrong at ``t``; until ``end`` (None: from the start) it is not."""

    def __init__(self, t: float, reason: str, end: float | None) -> None:
        super().__init__(reason)
        self.t = t
        self.reason = reason
        self.end = end


def check_friction(mechanics: SceneMechanics, trajectory: Trajectory, samples: MotionSamples, rtol: float) -> None:
    """Refuse friction that drives, which is what a coefficient does that turns negative.

    The built-in integrators stop there by themselves; this is for others.  Between steps slip that has only begun may
    show the wrong sign by as much as the tolerance allows.  Where slip ends it may by more than that: a step whose end
    is rest to the tolerance has passed it by as much.
    """
    run = [i for i, _ in trajectory.runs] if isinstance(trajectory, JoinedRun) else None
    if samples.t.size == 0 or not mechanics.has_law(LAW_COEFFICIENT, run):
        return
    varies = mechanics.laws(run) == LAW_COEFFICIENT
    row = mechanics.names.row

    def power(samples: MotionSamples) -> Floats:
        return np.asarray(np.add.reduceat(samples.F * samples.g, row[:-1], axis=0))

    given = power(samples)
    force, speed = np.abs(samples.F).max(initial=0.0), np.abs(samples.v).max(initial=0.0)
    given[:, :-1][:, samples.t[:-1] == samples.t[1:]] = 0.0
    limit = np.where(varies, max(POWER, rtol) * np.abs(given).max(axis=1) + SPEED * speed * force, np.inf)[:, None]
    if not (given > limit).any():
        return
    # where a joint carries nothing its friction is round-off: it drives by less than SPEED of the kinetic energy
    limit = limit + SPEED * mechanics.kinetic(samples).max() / max(float(samples.t[-1] - samples.t[0]), 1e-290)
    wrong = given > limit
    if not wrong.any():
        return
    i = int(np.argmax(wrong.any(axis=0)))
    name = mechanics.names.contacts[int(np.argmax(wrong[:, i]))]
    t = float(samples.t[i])
    sound = _step_before(trajectory, t)
    while sound is not None and sound < (middle := 0.5 * (sound + t)) < t:
        if (power(trajectory.motion(np.array([middle]))) > limit).any():
            t = middle
        else:
            sound = middle
    raise _Unsound(t, f"the friction coefficient of contact {name!r} is negative", sound)


def _step_before(trajectory: Trajectory, t: float) -> float | None:
    """The last step before t."""
    times = trajectory.t
    i = int(np.searchsorted(times, t, side="left"))
    return float(times[i - 1]) if i else None
