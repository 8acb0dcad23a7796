"""Stretches of a run between transitions: their ends, and the modes and signs of slip that hold in each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.integrate.problem import Codes, Floats, Ints
from fricmb.integrate.run.chunked_run import KeptTrajectory

#: Times this close, relative to 1 or themselves, are the same breakpoint.
SAME = 1e-11
#: How far beside them functions of time are evaluated, relative to 1 or the time.
BESIDE = 1e-14
#: How far before the end of a stretch slopes are evaluated: further than round-off of a run moves a switch of formulas.
BEFORE = 1e-12


@dataclass(frozen=True, kw_only=True)
class Phases:
    """Accepted steps of a run and what holds in them.

    Attributes
    ----------
    t : (n_k+1,)
        Ends of steps and times of transitions.
    mode, sign : (n_c, n_k), (m, n_k)
        Of the contacts in each stretch; the sign of slip in one direction, nan on the rows of contacts with two.
    speed : (n,)
        The largest of each degree of freedom, of those in the middles of the stretches.
    """

    t: Floats
    mode: Codes
    sign: Floats
    speed: Floats

    def of(self, t: Floats) -> Ints:
        """Number of the stretch that each time lies in, on the right at their ends."""
        found: Ints = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, self.t.size - 2)
        return found


def phases_of(piece: Any, events: Floats, row: Ints, breakpoints: Floats, bends: Floats) -> Phases:
    """Stretches of one piece of a run; ``row``: first rows of contacts.

    ``breakpoints``: times at which functions of time break; ``bends``: those at which slopes of friction do, which may
    be very near the end of a step.
    """
    trajectory = piece.trajectory
    if isinstance(trajectory, KeptTrajectory):
        raise SceneError("sensitivities: a run without dense output has none; simulate with dense=True")
    t = np.unique(np.concatenate([trajectory.t, events]))
    t = t[(t >= piece.t_start) & (t <= piece.t_end)]
    far = [b for b in breakpoints if np.abs(t - b).min() > SAME * max(1.0, abs(b))]
    t = np.union1d(np.union1d(t, far), bends)
    middle = 0.5 * (t[:-1] + t[1:])
    seen = trajectory.motion(middle)
    sign = np.where(seen.g < 0.0, -1.0, 1.0)
    wide = np.repeat(np.diff(row) > 1, np.diff(row))
    sign[wide] = np.nan
    return Phases(t=t, mode=seen.mode, sign=sign, speed=np.abs(seen.v).max(axis=1, initial=0.0))
