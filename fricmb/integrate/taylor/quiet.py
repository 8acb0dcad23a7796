"""Rest under loads that cannot tear anything off: from bounds of the loads, until when.

A load that swings below what the ground holds was followed by three steps a period, for as long as it swung.  Where
each degree of freedom is held by one contact of its own, the force that a contact holds is known but for the loads,
and these are bounded on stretches of the run (:mod:`fricmb.integrate.signals.jets`): nothing can happen before the
first stretch on which a bound passes a cone.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.problem import LAW_SMOOTH, NORMAL_CONSTANT, STICK, Floats, Input, Problem
from fricmb.integrate.signals.jets import bounds
from fricmb.integrate.taylor.network import Net
from fricmb.integrate.taylor.polynomials import hold_force
from fricmb.integrate.taylor.signals import call_signal

#: Stretches of a run; contacts times stretches at most; a leap is worth it from so many steps on.
STRETCHES, MOST, WORTH = 512, 2**18, 4.0
#: Part of what a contact holds that is left as a margin: round-off of bounds and forces.
MARGIN = 1e-9

#: Ends of stretches, bounds of what loads add to the force of each contact, and that force by each load.
Quiet = tuple[Floats, Floats, Floats, Floats]


def never_quiet() -> Quiet:
    """No stretches."""
    return np.zeros(1), np.zeros((0, 0)), np.zeros((0, 0)), np.zeros((0, 0))


def quiet_of(problem: Problem, t_start: float, t_end: float) -> Quiet:
    """Bounds for a run; no stretches where something else than loads on held blocks could move them."""
    gain = _gain(problem)
    if gain is None or not t_end > t_start:
        return never_quiet()
    edge = np.linspace(t_start, t_end, STRETCHES + 1)
    least, most = np.zeros((2, problem.m, STRETCHES))
    for j, given in enumerate(problem.signals.forces):
        assert given is not None
        # series of a million numbers are not kept
        low, high = (_bounds.__wrapped__ if given.tables else _bounds)(given, t_start, t_end)
        one, other = gain[:, j, None] * low, gain[:, j, None] * high
        with np.errstate(invalid="ignore"):
            least += np.minimum(one, other)
            most += np.maximum(one, other)
    broken = ~(np.isfinite(least) & np.isfinite(most))
    least[broken], most[broken] = -np.inf, np.inf
    return edge, least, most, gain


@lru_cache(maxsize=256)
def _bounds(given: Input, t_start: float, t_end: float) -> tuple[Floats, Floats]:
    """Bounds of a load on each stretch."""
    assert given.tape is not None
    edge = np.linspace(t_start, t_end, STRETCHES + 1)
    jet = bounds(given.tape, given.parameters, edge[:-1], edge[1:], 1)
    return jet.low[0], jet.high[0]


def _gain(problem: Problem) -> Floats | None:
    """Force of each contact by each load (m, n_u), where each degree of freedom is held by one contact of its own."""
    contacts, signals = problem.contacts, problem.signals
    m, n = problem.m, problem.n
    if m != n or problem.n_c != n or not signals.forces or m * STRETCHES > MOST:
        return None
    if any(given is None or given.tape is None for given in signals.forces):
        return None
    at_rest = not np.any(contacts.w) and not np.any(contacts.Wu)
    plain = np.all(contacts.normal == NORMAL_CONSTANT) and not np.any(contacts.law == LAW_SMOOTH)
    W = np.asarray(contacts.W)
    alone = np.all(np.count_nonzero(W, axis=0) == 1) and np.all(np.count_nonzero(W, axis=1) == 1)
    driven = np.any(problem.linear.Kx[:, n:]) or np.any(problem.linear.Cx[:, n:])
    if not (at_rest and plain and alone) or driven or len(problem.elements.table.address):
        return None
    row = np.argmax(W != 0.0, axis=0)
    found: Floats = -np.asarray(problem.linear.B)[row] / W[row, np.arange(m)][:, None]
    return found


@kernel
def rests(net: Net) -> bool:
    """Whether nothing moves."""
    speed, slips = 0.0, 0
    for c in range(net.mode.shape[0]):  # as many as degrees of freedom
        speed = max(speed, abs(net.v[c]))
        slips += net.mode[c] != STICK
    return bool(speed == 0.0 and slips == 0)


@kernel
def quiet_until(net: Net, left: float) -> float:
    """The time up to which nothing can happen at rest; at most ``left`` from now."""
    t = net.time
    stretches = net.quiet_edge.shape[0] - 1
    first, last = net.quiet_edge[0], net.quiet_edge[stretches]
    k = max(0, min(stretches - 1, int((t - first) / (last - first) * stretches)))
    while k > 0 and net.quiet_edge[k] > t:
        k -= 1
    while k < stretches - 1 and net.quiet_edge[k + 1] <= t:
        k += 1
    work = net.quiet_work
    for c in range(net.mode.shape[0]):
        force = hold_force(net, c, 0.0)
        for j in range(net.series.shape[0]):
            if not call_signal(net, j, t):
                return t
            force -= net.quiet_gain[c, j] * net.window[3]
        work[c] = force
    while k < stretches:
        for c in range(net.mode.shape[0]):
            hold = net.stick[c] * (1.0 - MARGIN)
            if not (work[c] + net.quiet_most[c, k] <= hold and work[c] + net.quiet_least[c, k] >= -hold):
                return float(min(net.quiet_edge[k], t + left))
        k += 1
    return float(min(last, t + left))


@kernel
def leap(net: Net, h: float, left: float) -> bool:
    """Make a step of length h that is about to be made at rest one as long as nothing can happen; whether it is."""
    if not rests(net):
        return False
    until = quiet_until(net, left)
    if net.n_samples < net.times.shape[0]:
        # forces are wanted there: a step that knows the loads goes over it
        until = min(until, net.times[net.n_samples] - h)
    if not until - net.time > WORTH * h:
        return False
    for k in range(1, net.Q.shape[0]):
        for j in range(net.v.shape[0]):
            if net.Q[k, j] != 0.0:
                return False
    net.step = until - net.time
    net.leaps_to = until
    net.next_step = net.longest
    return True
