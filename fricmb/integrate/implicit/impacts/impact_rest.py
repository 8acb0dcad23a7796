"""When bounces come to rest: infinitely many in a finite time, dated from the last of them that is computed.

A contact leaves with speed v and is slowed by ``rises``, then falls back by ``falls`` (accelerations towards the
surface; they differ where friction turns round on the way, or a force depends on velocity).  With constant ones hops
shrink by ``e sqrt(falls/rises)`` and all of them take

    T = (v/rises) (1 + sqrt(rises/falls)) / (1 - e sqrt(falls/rises)),

with equal ones ``2 v/(a (1 - e))``.  Where the acceleration changes at a rate j, ``T - (j/3a) T^2`` is left, up to
terms of the third order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.integrate.problem import Floats, Floats2
from fricmb.integrate.run.breakpoints import EPS

#: Bounces end when what is left of them is less than this part of the time in which the acceleration would bring about
#: the largest speed so far: earlier the dating errs, later round-off of positions does.
SHORT = 3e-5
#: Part by which the acceleration may change meanwhile.
CALM = 3e-3
#: Roundings of the time by which an impact is located.
LOCATED = 16.0
#: Time until a further contact is met, in those between the last two impacts, within which it comes to rest with them.
NEXT = 10.0
#: Impacts no further apart are at one instant, as a part of the time: roundings of a located one.
INSTANT = 8.0 * EPS
#: Height of a hop beside the round-off of distances, below which there is none.
SEEN = 1e3
#: Part of the last time between impacts to which a geometric series has to tell what is left.
STEADY = 1e-3


@dataclass(frozen=True, kw_only=True)
class Hop:
    """A bounce: whether bounces ``end`` with it; then the time ``left`` until rest, and a ``bound`` of its error."""

    ends: bool
    left: float = 0.0
    bound: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Leaving:
    """A contact behind an impact.

    Attributes
    ----------
    joint : int
    t : float
    speed : float
        With which it leaves.
    e : float
        Coefficient of restitution.
    rises, falls : float
        Accelerations towards the surface on the way up and on the way back.
    size : float
        Largest speed so far.
    noise : float
        Round-off of the distance.
    """

    joint: int
    t: float
    speed: float
    e: float
    rises: float
    falls: float
    size: float
    noise: float


def hop_of(gap: float, rate: float, pressed: float) -> float:
    """Time until a contact at a distance ``gap`` that opens at a rate meets its surface, pressed by an acceleration."""
    height = max(gap, 0.0)
    root = float(np.sqrt(max(rate * rate + 2.0 * pressed * height, 0.0)))
    return 2.0 * height / (root - rate) if rate < 0.0 else (rate + root) / pressed


class Bounces:
    """What is known of the last impacts of each of n joints in a run from ``t_start`` with a tolerance ``rtol``.

    Attributes
    ----------
    t, falls, count, times : (n,), (n,), (n,) int64, (n, 3)
        Of each its last impact and what it fell with then, their number, times between the last ones.
    clock : (4,)
        Last impact of any and the time since the one before; last impact and number of those at one instant.
    """

    def __init__(self, n: int, t_start: float, rtol: float) -> None:
        self._t_start, self._rtol = t_start, rtol
        self.t: Floats = np.full(n, -np.inf)
        self.falls: Floats = np.zeros(n)
        self.count = np.zeros(n, np.int64)
        self.times: Floats2 = np.full((n, 3), np.inf)
        self._shared = -np.inf, 0.0
        self.clock: Floats = np.array([t_start, 0.0, -np.inf, 0.0])

    def begin(self, t: float) -> None:
        """An impact of any of them at t."""
        self.clock[:2] = t, t - self.clock[0]

    def at_once(self, t: float) -> int:
        """An impact of any of them at t: how many there were at this instant before it."""
        self.clock[3] = self.clock[3] + 1 if t - self.clock[2] <= INSTANT * abs(t) else 0
        self.clock[2] = t
        return int(self.clock[3])

    def among_others(self, leaving: Leaving, gap: float, ratio: float, pace: float) -> Hop:
        """The hop of a contact that others have thrown up, or that is on its way back, while these come to rest.

        ``ratio``: by which speeds fall from one impact to the next.  Bounces in turn shrink with it, and end together.
        ``pace``: acceleration that is usual.  Of two that fall side by side there is next to none between them.
        """
        if not leaving.rises > 0.0:
            return Hop(ends=False)
        T = hop_of(gap, leaving.speed, leaving.rises) / (1.0 - min(max(ratio, leaving.e), 0.99))
        # what is about to hit as fast as anything moves has a short way as well
        slow = leaving.speed >= -SHORT * leaving.size
        ends = slow and SHORT * leaving.size / max(leaving.rises, pace) >= T and NEXT * self.clock[1] >= T
        bound = T + self._rtol * (leaving.t - self._t_start)
        return Hop(ends=bool(ends), left=T, bound=bound)

    def after(self, leaving: Leaving) -> Hop:
        """The bounce that begins."""
        j, since = leaving.joint, leaving.t - self.t[leaving.joint]
        rate = (leaving.falls - self.falls[j]) / since if np.isfinite(since) and since > 0.0 else np.inf
        self.t[j], self.falls[j] = leaving.t, leaving.falls
        self.count[j] += 1
        self.times[j] = np.append(self.times[j][1:], since)
        if not (leaving.rises > 0.0 and leaving.falls > 0.0):
            return self._in_series(leaving)
        ratio = leaving.e * np.sqrt(leaving.falls / leaving.rises)
        if not ratio < 1.0:
            return self._in_series(leaving)
        up = leaving.speed / leaving.rises
        T = float(up * (1.0 + np.sqrt(leaving.rises / leaving.falls)) / (1.0 - ratio))
        a = leaving.falls
        lost = leaving.speed * up / 2.0 < SEEN * leaving.noise or 64.0 * EPS * abs(leaving.t) >= T
        calm = abs(rate) * T <= CALM * a
        if not lost and not (SHORT * leaving.size / a >= T and calm):
            # hops that shrink otherwise than accelerations say have others on their way
            _, one, other = self.times[j]
            odd = bool(np.isfinite(one)) and abs(other - ratio * one) > 0.1 * other
            return self._in_series(leaving) if odd else Hop(ends=False)
        change = rate * T / a if calm else CALM
        left = T * (1.0 - change / 3.0)
        bound = T * change * change + leaving.noise / leaving.speed / (1.0 - ratio) + (T if lost and not calm else 0.0)
        # what another contact has struck meanwhile, as in a stack, need not make the hops that gravity alone would; nor
        # does what goes on bouncing beside it
        if self.clock[1] < 0.999 * since < np.inf:
            self._shared = leaving.t + NEXT * left, float(left)
        bound += self._shared[1] if leaving.t <= self._shared[0] else 0.0
        return Hop(ends=True, left=float(left), bound=float(bound) + self._unknown(leaving))

    def _in_series(self, leaving: Leaving) -> Hop:
        """A bounce on whose way accelerations change: times between impacts alone say how they shrink.

        So do those of a disc that slips on a floor as it leaves a wall, and rolls back to it.
        """
        times = self.times[leaving.joint]
        if not (np.isfinite(times).all() and times.min() > 0.0 and leaving.speed <= SHORT * leaving.size):
            return Hop(ends=False)
        before, ratio = times[1:] / times[:-1]
        if not ratio < 1.0 or abs(ratio - before) > STEADY * (1.0 - ratio) ** 2:
            return Hop(ends=False)
        left = times[-1] * ratio / (1.0 - ratio)
        bound = times[-1] * abs(ratio - before) / (1.0 - ratio) ** 2 + leaving.noise / leaving.speed / (1.0 - ratio)
        return Hop(ends=True, left=float(left), bound=float(bound) + self._unknown(leaving))

    def _unknown(self, leaving: Leaving) -> float:
        """What impacts so far may be off by in time."""
        located = LOCATED * EPS * abs(leaving.t) * float(self.count[leaving.joint])
        return located + self._rtol * (leaving.t - self._t_start)
