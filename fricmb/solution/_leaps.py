"""What a run stores more, or less, where a driven position jumps: its driver has brought it in at once."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, TypeVar

import numpy as np

from fricmb.integrate import MotionSamples, Samples, Trajectory
from fricmb.integrate.problem import Floats

_Samples = TypeVar("_Samples", bound=MotionSamples)
_Energies = TypeVar("_Energies", bound=Samples)
#: A time this near to that of a jump, relative to it, is that time; to either side of it goes half as much.
SAME = 1.5e-14


@dataclass(frozen=True)
class Leaps:
    """Times ``t`` (k,) within a run, rising, and the stored energy ``gain`` (k,) that came by each.

    ``span``: ends of the run, at which a position may jump as well: it has done so at its start, and not yet at its
    end; None where no position can jump.
    """

    t: Floats
    gain: Floats
    span: tuple[float, float] | None

    @classmethod
    def of(cls, trajectory: Trajectory, mechanics: Any) -> Leaps:
        """Of a run: springs whose end jumps."""
        t = mechanics.leaps(*trajectory.ends)
        if t is None or not t.size:
            return cls(np.zeros(0), np.zeros(0), None if t is None else trajectory.ends)
        there = trajectory.motion(t)
        after, first = (_stored(mechanics, _moved(there, side)) for side in (0.5, -0.5))
        return cls(t, np.cumsum(after - first), trajectory.ends)

    def seen(self, samples: _Samples) -> _Samples:
        """Samples whose times, where something jumps, lie behind the jump: functions of time are asked there."""
        if self.span is None:
            return samples
        begin, end = (np.abs(samples.t - at) <= SAME * abs(at) for at in self.span)
        return _moved(samples, np.where(end, -0.5, np.where(self._at(samples.t) | begin, 0.5, 0.0)))

    def added(self, samples: _Energies) -> _Energies:
        """Samples with what jumps have brought among their input."""
        passed = np.searchsorted(self.t, samples.t + SAME * np.abs(samples.t), side="right")
        return replace(samples, input=samples.input + np.append(0.0, self.gain)[passed])

    def _at(self, t: Floats) -> Any:
        if not self.t.size:
            return np.zeros(t.shape, dtype=bool)
        near = np.searchsorted(self.t, t + SAME * np.abs(t), side="right") - 1
        return (near >= 0) & (np.abs(t - self.t[np.maximum(near, 0)]) <= SAME * np.abs(t))


def _stored(mechanics: Any, samples: MotionSamples) -> Floats:
    """Stored energy, the potential of loads included: by that their work jumps as well, which is none."""
    given, stored = mechanics.delivered(samples), mechanics.potential(samples)
    found: Floats = stored if given is None else stored - given
    return found


def _moved(samples: _Samples, side: Any) -> _Samples:
    """Samples a little later or before, where ``side`` is not 0."""
    return replace(samples, t=samples.t + side * (SAME * np.abs(samples.t) + 1e-300))
