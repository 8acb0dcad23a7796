"""How a friction law answers a prescribed motion of its contact: loops, break-away, lag."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb._calls import answers
from fricmb.analysis._errors import (
    AnalysisError,
    checked_growth,
    checked_integer,
    checked_law,
    checked_number,
    checked_numbers,
    positive,
    refuse,
)
from fricmb.equations import function, law_template, numbers
from fricmb.integrate.problem import Floats
from fricmb.laws import FrictionLaw


@dataclass(frozen=True, kw_only=True)
class Path:
    """Motion of a contact along its first direction, and the friction force on its ``a``.

    Attributes
    ----------
    t, displacement, velocity, force : ndarray, (n_t,)
    state : ndarray, (n_states, n_t)
    """

    t: Floats
    displacement: Floats
    velocity: Floats
    force: Floats
    state: Floats

    @property
    def work(self) -> float:
        """Work of the friction force along the path, trapezoidal from time to time; negative where it takes energy."""
        return float(np.trapezoid(self.force * self.velocity, self.t))

    @property
    def amplitude(self) -> float:
        """Half the range of the displacement."""
        return float(0.5 * np.ptp(self.displacement))


@answers
def path(
    law: FrictionLaw,
    velocity: Callable[[Any], Any],
    t: Floats,
    *,
    normal_force: float = 1.0,
    state: Floats | None = None,
    rtol: float = 1e-8,
) -> Path:
    """Friction along a prescribed motion.

    Parameters
    ----------
    law : FrictionLaw
        A set-valued law answers with its force in slip (0 at v = 0).
    velocity : callable
        Velocity of the contact along its first direction at times (n,).
    t : ndarray, (n_t,)
        Increasing times.
    normal_force : float
    state : ndarray, (n_states,), optional
        States at t[0]; default 0.
    rtol : float
        Of the states.

    Returns
    -------
    Path

    Raises
    ------
    AnalysisError
        For arguments that are not accepted, and where the states cannot be followed.
    """
    d = checked_law("path", law).dimensions[0]
    t, normal_force, rtol = checked_growth("path", "t", t), _load("path", normal_force), _tolerance("path", rtol)
    v = _velocity(velocity, t)
    x = _displacement(velocity, t)
    directions = np.vstack([v, np.zeros((d - 1, len(t)))])
    z = np.zeros((law.n_states(d), len(t)))
    if len(z):
        z = _states(law, d, velocity, t, normal_force, _start(state, len(z)), rtol)
    force = np.asarray(law.force(directions, normal_force, z if len(z) else None))[0]
    return Path(t=t, displacement=x, velocity=v, force=force, state=z)


def _load(who: str, normal_force: Any) -> float:
    return checked_number(who, "normal_force", normal_force, "a number of at least 0", lambda N: N >= 0.0)


def _tolerance(who: str, rtol: Any) -> float:
    return checked_number(who, "rtol", rtol, "a number from 1e-13 to 0.1", lambda x: 1e-13 <= x <= 0.1)


def _velocity(velocity: Any, t: Floats) -> Floats:
    accepted = "a function of times (n,) that returns finite velocities (n,)"
    if not callable(velocity):
        refuse("path", "velocity", velocity, accepted)
    v = checked_numbers("path", "velocity", velocity(t), accepted)
    if v.shape != t.shape or not np.isfinite(v).all():
        refuse("path", "velocity", velocity, accepted)
    return v


def _displacement(velocity: Callable[[Any], Any], t: Floats) -> Floats:
    """Integral of the velocity from t[0], by Gauss's rule of eight nodes between neighbouring times."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = 0.5 * np.diff(t)
    inside = t[:-1, None] + half[:, None] * (1.0 + nodes)
    v = _velocity(velocity, inside.ravel()).reshape(inside.shape)
    return np.concatenate([[0.0], np.cumsum(half * (v @ weights))])


def _start(state: Any, n_z: int) -> Floats:
    if state is None:
        return np.zeros(n_z)
    accepted = f"({n_z},) finite numbers"
    z = checked_numbers("path", "state", state, accepted)
    if z.shape != (n_z,) or not np.isfinite(z).all():
        refuse("path", "state", state, accepted)
    return z


@answers
def compiled_force(law: FrictionLaw, d: int) -> tuple[Callable[[Floats], tuple[Floats, Floats]], int]:
    """The compiled force: x = [v, N, z] -> values [F, z'] and Jacobian; and the number of states."""
    known = checked_law("compiled_force", law).dimensions
    if not isinstance(d, int) or d not in known:
        refuse("compiled_force", "d", d, " or ".join(map(str, known)))
    template = law_template(law, d)
    p = law.parameter_block() if template.function is not None else np.array(numbers(law))
    compiled, n_z = function(template.address), law.n_states(d)
    rows, columns = d + n_z, d + n_z + 1

    def evaluate(x: Floats) -> tuple[Floats, Floats]:
        out = np.full(rows * (columns + 1) + 1, np.nan)  # behind: a switch, where the law states one
        compiled(np.ascontiguousarray(x), p, out)
        return out[:rows].copy(), out[rows:-1].reshape(rows, columns).copy()

    return evaluate, n_z


def _states(
    law: FrictionLaw, d: int, velocity: Callable[[Any], Any], t: Floats, N: float, start: Floats, rtol: float
) -> Floats:
    from scipy.integrate import solve_ivp

    evaluate, _ = compiled_force(law, d)

    def at(time: float, z: Floats) -> tuple[Floats, Floats]:
        return evaluate(np.concatenate([[float(velocity(time))], np.zeros(d - 1), [N], z]))

    scale = np.maximum(np.abs(start), 1e-3 * rtol)
    found = solve_ivp(
        lambda time, z: at(time, z)[0][d:], (t[0], t[-1]), start, method="Radau", t_eval=t,
        jac=lambda time, z: at(time, z)[1][d:, d + 1 :], rtol=rtol, atol=1e-6 * rtol * scale,
        max_step=(t[-1] - t[0]) / 50.0,
    )  # fmt: skip
    if not found.success:
        reached = found.t[-1] if found.t.size else t[0]
        raise AnalysisError(f"path: the states of {law._label()} cannot be followed beyond t = {reached:g}")
    return np.asarray(found.y)


@answers
def cycle(
    law: FrictionLaw, *, amplitude: float, period: float, normal_force: float = 1.0, cycles: int = 3, points: int = 400,
    rtol: float = 1e-7,
) -> Path:  # fmt: skip
    """The last of several harmonic cycles of the displacement: the hysteresis loop of a law.

    Parameters
    ----------
    law : FrictionLaw
    amplitude : float
        Of the displacement: below the law's presliding distance the loop is one of presliding, far above of sliding.
    period : float
    normal_force : float
    cycles : int
    points : int
        On the last cycle.
    rtol : float
        Of the states.
    """
    who = "cycle"
    checked_law(who, law)
    amplitude, period = positive(who, "amplitude", amplitude), positive(who, "period", period)
    cycles = checked_integer(who, "cycles", cycles, 1, 1_000_000)
    points = checked_integer(who, "points", points, 4, 10_000_000)
    omega = 2.0 * np.pi / period
    t = np.linspace(0.0, cycles * period, cycles * points + 1)
    whole = path(
        law, lambda time: amplitude * omega * np.cos(omega * np.asarray(time)), t, normal_force=normal_force, rtol=rtol
    )
    last = slice((cycles - 1) * points, None)
    moved = amplitude * np.sin(omega * t)
    return Path(
        t=t[last], displacement=moved[last], velocity=whole.velocity[last], force=whole.force[last],
        state=whole.state[:, last],
    )  # fmt: skip


@answers
def settling_distance(law: FrictionLaw, normal_force: float = 1.0) -> float:
    """Slip distance (its order of magnitude) over which friction settles to its steady value, sliding from rest."""
    normal_force = _load("settling_distance", normal_force)
    d, speed = checked_law("settling_distance", law).dimensions[0], 1e-3
    v = np.zeros(d)
    v[0] = speed
    evaluate, n_z = compiled_force(law, d)
    state, distance = np.zeros(n_z), 1e-12
    while distance < 1e3:
        values, jacobian = evaluate(np.concatenate([v, [normal_force], state]))
        rate = values[d:]
        pace = np.abs(np.diag(jacobian[d:, d + 1 :])).max(initial=0.0)
        if pace * distance / speed > 0.5 or not np.isfinite(rate).all():
            return distance
        state = rate * distance / speed
        distance *= 2.0
    return 1e-3


@answers
def pull(
    law: FrictionLaw, *, normal_force: float = 1.0, speed: float = 1e-6, points: int = 800, rtol: float = 1e-7
) -> Path:
    """Slow pulling from rest into slip: presliding, break-away, and the way to steady slip.

    Parameters
    ----------
    law : FrictionLaw
        With internal states.
    normal_force : float
    speed : float
        Of the pulling.
    points : int
    rtol : float
        Of the states.
    """
    speed = positive("pull", "speed", speed)
    points = checked_integer("pull", "points", points, 2, 10_000_000)
    distance = 20.0 * settling_distance(checked_law("pull", law), _load("pull", normal_force))
    t = np.linspace(0.0, 1.0, points + 1) ** 2 * distance / speed
    return path(law, lambda time: np.full(np.shape(time), speed), t, normal_force=normal_force, rtol=rtol)
