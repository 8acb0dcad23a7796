"""Long runs: piece by piece, of which only what was asked for is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from typing import Any, TypeVar

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.problem import Floats, Problem, Start
from fricmb.integrate.trajectory import (
    Counters,
    MotionSamples,
    SampledTrajectory,
    Samples,
    Trajectory,
    Transitions,
)

_Samples = TypeVar("_Samples", bound=MotionSamples)

#: Bytes of rows that a run keeps for its dense output where the times that are asked for are known.
MEMORY = 6.4e7
#: Bytes of each piece behind the first, at most: while a piece is put together nobody looks for Ctrl-C.
LATER = 8e6


@dataclass(frozen=True, kw_only=True)
class Losses:
    """Energies cumulated before a piece: friction by contact (n_c,), damping, input."""

    friction: Floats
    damping: float = 0.0
    input: float = 0.0


class KeptTrajectory(SampledTrajectory):
    """A run of which the values at certain times are kept, and nothing between.

    ``samples`` hold the first and the last time of the run.
    """

    def sample(self, t: Floats) -> Samples:
        """Values at some of the times that are kept.

        Raises
        ------
        SceneError
            For a time that is not.
        """
        index = np.searchsorted(self.t, t, side="right") - 1
        lost = np.flatnonzero(self.t[np.maximum(index, 0)] != t)
        if lost.size:
            raise SceneError(
                f"t: {t[lost[0]]:.17g} is between the times that this long run has kept; expected one of these, or "
                "simulate(..., dense=True), which keeps the dense output"
            )
        return take(self._samples, index)


def pieces(
    integrator: Integrator, problem: Problem, start: Start, stops: Floats, *, memory: float | None,
    later: float = np.inf, **options: Any,
) -> Iterator[Trajectory]:  # fmt: skip
    """Runs that go on from each other: from the start to each of the stops, or as far as memory allows.

    A piece behind the first takes no more than ``later`` bytes either.
    """
    if integrator.pauses and memory is not None:
        options = {**options, "memory": memory}
    for stop in stops.tolist():
        while start.t < stop:
            trajectory = integrator.integrate(problem, start, stop, **options)
            if "memory" in options:
                options["memory"] = min(options["memory"], later)
            yield trajectory
            if trajectory.failure is not None:
                return
            start = trajectory.end
            if not integrator.pauses:  # a fixed step ends a little before or after
                break


def run_kept(
    integrator: Integrator, problem: Problem, start: Start, t_end: float, *, t_eval: Floats | None = None,
    memory: float = MEMORY, look: Callable[[Trajectory], None] | None = None, **options: Any,
) -> Trajectory:  # fmt: skip
    """A run that keeps no more than ``memory`` bytes of rows at a time.

    A run that needs less comes back whole, with its dense output.  Of a longer one the values at ``t_eval`` are kept
    (None: at the accepted steps); ``look`` is called with each of its parts before the rest of the part is let go;
    ``options`` are those of :meth:`Integrator.integrate`.
    """
    kept: list[Samples] = []
    parts: list[Trajectory] = []
    before = Losses(friction=np.zeros(problem.n_c))
    stops = np.array([t_end])
    for part in pieces(integrator, problem, start, stops, memory=memory, later=LATER, t_eval=t_eval, **options):
        last = part.failure is not None or part.end.t >= t_end or not integrator.pauses
        if last and not kept:
            return part
        if look is not None:
            look(part)
        samples = with_losses(values_of(part, t_eval, last), before)
        kept.append(samples)
        before = losses_after(part, before)
        parts.append(_light(part))
    transitions = Transitions(
        **{f.name: np.concatenate([getattr(p.transitions, f.name) for p in parts]) for f in fields(Transitions)}
    )
    end, failure = parts[-1].end, parts[-1].failure
    return KeptTrajectory(
        problem, concatenate(kept, Samples), transitions, add_counters([p.counters for p in parts]), end, failure
    )


def values_of(part: Trajectory, t_eval: Floats | None, last: bool) -> Samples:
    """Values at the first time, at the times asked for, and of the last piece at the end.

    Where two pieces meet the later one has the say.
    """
    if t_eval is None:
        rows = part.rows()
        return rows if last else take(rows, slice(0, rows.t.size - 1))
    t = part.t
    inside = t_eval[(t_eval > t[0]) & (t_eval < t[-1])]
    ends = [t[:1], inside, t[-1:]] if last else [t[:1], inside]
    return part.sample(np.concatenate(ends))


def losses_after(part: Trajectory, before: Losses) -> Losses:
    """Energies cumulated up to the end of a piece."""
    ends = part.sample(part.t[-1:])
    return Losses(
        friction=before.friction + ends.friction_loss[:, 0],
        damping=before.damping + float(ends.damping_loss[0]),
        input=before.input + float(ends.input[0]),
    )


def with_losses(samples: Samples, before: Losses) -> Samples:
    """Samples of a piece with energies counted from the start of the run."""
    return replace(
        samples,
        friction_loss=samples.friction_loss + before.friction[:, None],
        damping_loss=samples.damping_loss + before.damping,
        input=samples.input + before.input,
    )


def add_counters(counters: list[Counters]) -> Counters:
    """Work of several pieces."""
    names = ("n_steps", "n_rejected", "n_rhs", "n_jac", "n_lu")
    notes = tuple(dict.fromkeys(note for part in counters for note in part.notes))
    return Counters(**{name: sum(getattr(part, name) for part in counters) for name in names}, notes=notes)


def take(samples: _Samples, columns: Any) -> _Samples:
    """A part of the times."""
    return type(samples)(**{f.name: getattr(samples, f.name)[..., columns] for f in fields(samples)})


def concatenate(parts: list[_Samples], kind: type[_Samples]) -> _Samples:
    """One after the other: what ``kind`` holds of them."""
    if len(parts) == 1 and type(parts[0]) is kind:
        return parts[0]
    return kind(**{f.name: np.concatenate([getattr(part, f.name) for part in parts], axis=-1) for f in fields(kind)})


def _light(part: Trajectory) -> Trajectory:
    """What of a piece is kept beside its samples."""
    none = take(part.sample(part.t[-1:]), slice(0, 0))
    return KeptTrajectory(part.problem, none, part.transitions, part.counters, part.end, part.failure)
