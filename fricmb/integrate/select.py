"""The choice of ``method="auto"``; an integrator is loaded where it is chosen."""

from __future__ import annotations

import math

from fricmb.integrate.collocation.suits import against, takes_one_contact
from fricmb.integrate.guard import Guarded
from fricmb.integrate.integrator import Integrator
from fricmb.integrate.methods.free_vibration import Exact
from fricmb.integrate.methods.radau import Radau
from fricmb.integrate.once_per import once_per
from fricmb.integrate.problem import Problem
from fricmb.integrate.suits_taylor import against_taylor, fastest

#: Damping ratio below which a mode rings, and how many times as fast as what rings (the geometric mean of the slowest
#: and the fastest that do) anything may be for Taylor steps, which follow it.  At 1e-6 they took, times the time of
#: radau, 0.6 where that was 28 (a brake whose rotor hangs on a soft spring), 0.5 at 26, 0.2 at 14 (masses in a row),
#: 0.8 at 31, 1.0 and 3.5 at 100 (modes up to 1e4 times as fast as the first), 1.5 at 77, 8 at 96, 3 at 300 (dampers).
RINGS, STIFF = 0.1, 40.0


def choose(problem: Problem, rtol: float = 1e-6) -> tuple[Integrator, str]:
    """The integrator for a problem at a tolerance, and why."""
    return once_per(problem, ("choice", rtol), lambda: _choose(problem, rtol))


def _choose(problem: Problem, rtol: float) -> tuple[Integrator, str]:
    if problem.mechanism is not None:
        return Radau(), "bodies that turn or joints: Radau IIA on the index-reduced system"
    exact = Exact()
    if exact.refuses(problem) is None:
        return exact, "free vibration of a linear structure: closed form"
    if takes_one_contact(problem) and Guarded().refuses(problem) is None and against(problem, rtol) is None:
        return Guarded(), "linear structure with one contact under constant friction: exact between transitions"
    reason = against_taylor(problem) or _bends_often(problem) or _holds_taylor(problem)
    if reason is None:
        # slow to load
        from fricmb.integrate.guarded_taylor import GuardedTaylor

        series = GuardedTaylor()
        reason = series.refuses(problem)
        if reason is None:
            contacts = "one contact" if problem.n_c == 1 else f"{problem.n_c} contacts"
            return series, f"{contacts} whose friction follows formulas: Taylor steps, corrected locally at transitions"
    return Radau(), f"the general method: {reason}"


#: Instants at which loads bend, from which on steps are made by them, and contacts up to which an implicit one is the
#: cheaper then: with 2000 values radau took, times the time of taylor, 0.5 with one contact and with two, 1.1 with 4,
#: 1.6 with 8, 2.7 with 64; with 20 000 values and one contact 0.4.
KINKS, FEW = 100, 2


def _bends_often(problem: Problem) -> str | None:
    """What stands against Taylor steps, which go to and from each bend of a load; or None."""
    kinks = problem.signals.kinks.size
    if kinks < KINKS or problem.n_c > FEW:
        return None
    return f"loads bend at {kinks} instants, at which steps end"


def _holds_taylor(problem: Problem) -> str | None:
    """What stands against steps that follow all that moves: it is far faster than what rings, or a law bends."""
    if problem.contacts.knots.size:
        return "a friction law has kinks, at which its steps end"
    if problem.omega.size < problem.n:
        return None  # frequencies are not known
    rings = problem.omega[(problem.omega > 0.0) & (problem.zeta < RINGS)]
    if fastest(problem) > STIFF * (math.sqrt(rings[0] * rings[-1]) if rings.size else 0.0):
        return f"a part is more than {STIFF:g} times as fast as the modes that ring"
    return None
