"""Runs that go on from each other as one solution."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import pairwise

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.solution._events import Events
from fricmb.solution._run import ROUND_OFF, Run
from fricmb.solution._solution import Solution
from fricmb.solution._stats import Stats
from fricmb.values import has_entries


def join(solutions: Iterable[Solution]) -> Solution:
    """One solution of several, in the order given; each starts at the time at which the one before ends.

    Where all of them hold their accepted steps the joined one does, else it has the times of all, one after the other.
    Raises SceneError where dofs, contacts or times do not match.
    """
    if not has_entries(solutions):
        raise SceneError(f"Solution.join: got {shown(solutions)}; expected a list of solutions")
    parts = list(solutions)
    if not parts:
        raise SceneError("Solution.join: got no solution; expected one or more")
    for i, part in enumerate(parts):
        if not isinstance(part, Solution):
            raise SceneError(f"Solution.join: entry {i} is {shown(part)}; expected a Solution")
    for earlier, later in pairwise(parts):
        _check(earlier, later)
    if len(parts) == 1:
        return parts[0]
    run = Run(tuple(piece for part in parts for piece in part.run.pieces))
    rows = all(part.has_rows for part in parts)
    times = None if rows else np.concatenate([part.t for part in parts])
    events = Events(event for part in parts for event in part.events)
    return Solution(
        names=parts[-1].names, run=run, stats=Stats.total([part.stats for part in parts]), events=events, times=times
    )


def _check(earlier: Solution, later: Solution) -> None:
    for what in ("dofs", "contacts", "directions", "states", "scale"):
        ours, theirs = getattr(earlier.names, what), getattr(later.names, what)
        if ours != theirs:
            raise SceneError(f"Solution.join: the solutions have different {what}: {ours!r} and {theirs!r}")
    gap = later.t_start - earlier.t_end
    if abs(gap) > ROUND_OFF * max(abs(earlier.t_end), abs(later.t_start)):
        raise SceneError(
            f"Solution.join: a solution that starts at t = {later.t_start:.10g} follows one that ends at "
            f"{earlier.t_end:.10g}; expected one that goes on from there (initial=)"
        )
