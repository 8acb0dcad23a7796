"""When stops and flanks touch: beginnings and ends, located on the dense output of a run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.errors import SceneError
from fricmb.field._signals import from_scene
from fricmb.integrate.problem import Floats
from fricmb.scene import Backlash, Scene, Stop
from fricmb.scene._rigid_stops import RigidBacklash, RigidStop

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Places within each step that are looked at.
WITHIN = 16
#: Halvings of such a place.
HALVINGS = 60
#: Errors of speeds over ``rtol`` times the greatest one, up to which a force of 0 is no parting.
ERRORS = 10.0
#: In place of ``rtol`` for runs of fixed steps.
FIXED = 1e-3


@dataclass(frozen=True, kw_only=True)
class Touches:
    """When a stop or a flank pushed.

    Attributes
    ----------
    begin, end : (n,)
        Times, rising in ``begin``; those of the run where it begins or ends in touch.
    side : list of str
        "lower" or "upper", the limit that was pressed.
    """

    begin: Floats
    end: Floats
    side: list[str]

    def __len__(self) -> int:
        return len(self.side)


def touches(sol: Solution, name: str) -> Touches:
    """See :meth:`fricmb.Solution.touches`."""
    part = sol.scene[name] if isinstance(sol.scene, Scene) else None
    if isinstance(part, RigidStop | RigidBacklash):
        raise SceneError(f"touches: {name!r} is rigid, with restitution; sol.impulse({name!r}) has its impacts")
    if not isinstance(part, Stop | Backlash):
        raise SceneError(f"touches: {name!r} must be a Stop or a Backlash")
    sides = [side for side, limit in zip(("lower", "upper"), part.limits(), strict=True) if limit is not None]
    steps = np.unique(sol.run.row_motion().samples.t)
    t = np.unique(np.concatenate([steps[:-1] + share * np.diff(steps) for share in np.arange(WITHIN) / WITHIN]))
    t = np.append(t, steps[-1])
    found: list[tuple[float, float, str]] = []
    for i, side in enumerate(sides):
        found += [(begin, end, side) for begin, end in _Limit(sol, part, i).touches(t)]
    found.sort()
    begin, end = (np.array([span[i] for span in found], dtype=float) for i in (0, 1))
    return Touches(begin=begin, end=end, side=[span[2] for span in found])


@dataclass(frozen=True)
class _Limit:
    """One limit of a part, over times (n_t,): where it is pressed, pushes, and where errors alone feign that it parts.

    A great loss brings the speed of parting to where the force is 0, and there it stays to round-off until the spring
    is free: the sign of the computed force is that of an error.
    """

    sol: Solution
    part: Any
    i: int

    def terms(self, t: Floats) -> tuple[Floats, Floats, Floats]:
        """Depth, the force of parting over speed and stiffness, and the rate of the depth."""
        own = self.part.numeric()
        seen = self.sol.at(t)
        x, rate = (from_scene(seen, quantity, self.part.name) for quantity in ("elongation", "rate"))
        depth, speed = own.depths(*own.coordinate(x, rate, np))[self.i]
        share = np.clip(depth / own.damping_depth, 0.0, 1.0) if own.damping_depth is not None else 0.0 * depth
        return depth, own.grip(depth, share) / own.stiffness, speed

    def depth(self, t: Floats) -> Floats:
        """How far the spring is pressed."""
        return self.terms(t)[0]

    def pushes(self, t: Floats) -> Floats:
        """Above 0 where there is a force."""
        depth, grip, speed = self.terms(t)
        return np.asarray(np.minimum(depth, depth + grip * speed))

    def presses(self, t: Floats) -> Floats:
        """Above 0 where the spring is pressed and there may be a force, within errors."""
        depth, grip, speed = self.terms(t)
        return np.asarray(np.minimum(depth, depth + grip * (speed + self.error)))

    @cached_property
    def error(self) -> float:
        """Of the rate."""
        tolerance = self.sol.stats.rtol if self.sol.stats.rtol is not None else FIXED
        return ERRORS * tolerance * float(np.max(np.abs(self.terms(np.unique(self.sol.t))[2]), initial=0.0))

    def touches(self, t: Floats) -> list[tuple[float, float]]:
        """Each from where it first pushes to where it last does; to where it is free, if it does not part before."""
        found, pushed = [], _spans(self.pushes, t)
        for low, high in _spans(self.presses, t):
            within = [span for span in pushed if low <= span[0] <= high]
            if within:
                last = np.array([high])
                parts = self.presses(last)[0] <= 0.0 < self.depth(last)[0]
                found.append((within[0][0], within[-1][1] if parts else high))
        return found


def _spans(pushes: Callable[[Floats], Floats], t: Floats) -> list[tuple[float, float]]:
    """Beginnings and ends of where a function is above 0, from its signs at rising times."""
    on = pushes(t) > 0.0
    turned = np.flatnonzero(on[1:] != on[:-1])
    low, high, before = t[turned], t[turned + 1], on[turned]
    for _ in range(HALVINGS if turned.size else 0):
        middle = 0.5 * (low + high)
        same = (pushes(middle) > 0.0) == before
        low, high = np.where(same, middle, low), np.where(same, high, middle)
    times = high.tolist()
    if on[0]:
        times.insert(0, float(t[0]))
    if on[-1]:
        times.append(float(t[-1]))
    return list(zip(times[::2], times[1::2], strict=True))
