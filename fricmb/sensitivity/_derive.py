"""Derivatives of a solution, put where its times are."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.sensitivity._asked_events import with_asked_events
from fricmb.sensitivity._pass import Tangent
from fricmb.solution import Derivatives


def derive(sol: Any, asked: tuple[str, ...]) -> None:
    """Give a solution its derivatives; the pass over the run is kept with the run, for other times of it."""
    tangents = sol.run.__dict__.setdefault("_tangents", {})
    if asked not in tangents:
        tangents[asked] = Tangent(sol, asked)
        sol.add_notes(tangents[asked].notes)
    tangent = tangents[asked]
    t = sol.t
    twice = np.zeros(t.size, dtype=bool)
    twice[:-1] = sol.has_rows & (np.diff(t) == 0.0)
    found = Derivatives(
        asked=asked,
        columns=tangent.columns,
        n_states=len(tangent.states),
        S=tangent.at(t, left=twice),
        end=tangent.S[-1],
        event_times=tangent.event_times,
        transversality=tangent.transversality,
        unsafe=tangent.unsafe,
    )
    sol.take_derivatives(with_asked_events(sol, tangent, found))
