"""Consistent initial values of an index-1 problem, and what tells that a problem is none.

At (t, y, yp) let N span the kernel of B = dF/dyp and V complete it; A = dF/dy.  The components of y along N are the
algebraic ones, those of yp along V the derivatives that F = 0 knows of.  The problem has index 1 where the square
matrix K = [B V, A N] is regular; then Newton's method for F = 0 with moves ``yp += V a, y += N b`` keeps the
differential part of y, and differentiating F = 0 once, K (a, b) = -(F_t + A V V^T yp), gives the rest of yp (b along N)
and the second derivatives (a along V).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.dae._split import Split, no_start
from fricmb.errors import IntegrationError
from fricmb.integrate.problem import Floats

_ITERATIONS = 200  # exponentials come down by a fixed amount each time


@dataclass(frozen=True, kw_only=True)
class Start:
    """Consistent values; ``ypp``: second derivatives of the differential part (0 elsewhere), or None if unknown."""

    y: Floats
    yp: Floats
    ypp: Floats | None
    algebraic: int


def consistent(system: Any, t: float, y0: Floats, yp0: Floats | None, span: float, *, trust: bool = True) -> Start:
    """Consistent (y, yp) next to (y0, yp0); what is consistent as it was given is not touched.

    ``system``: a :class:`System`.  ``trust``: a consistent yp0 is the truth in its algebraic components too.

    Raises
    ------
    IntegrationError
        The residual is not finite, or the problem is singular or of an index above 1 there, or has no solution nearby.
    """
    y, yp = y0.copy(), np.zeros_like(y0) if yp0 is None else yp0.copy()
    f = np.empty_like(y)
    if not system.residual(t, y, yp, f):
        bad = int(np.flatnonzero(~np.isfinite(f))[0])
        raise no_start(t, f"fun is not finite at the initial values (component {bad} is {f[bad]})")
    if not system.jacobian.evaluate(t, y, yp, f, 0.0, 0.0):
        raise no_start(t, "the Jacobian is not finite at the initial values")
    trust = trust and yp0 is not None
    if trust and not f.any():
        return Start(y=y, yp=yp, ypp=None, algebraic=-1)
    try:
        split = Split(system.matrix, t)
        move = split.move(f)
    except IntegrationError:
        if trust and _negligible(system, y, yp, f):
            return Start(y=y, yp=yp, ypp=None, algebraic=-1)
        raise
    if trust:
        weight = system.weight(y)
        small = 1e-2 * max(_norm(yp, weight), 1.0 / span)
        if _norm(move[1], weight) <= 1e-2 and _norm(move[0], weight) <= small:
            return Start(y=y, yp=yp, ypp=None, algebraic=split.algebraic)
    y, yp, f, split = _newton(system, split, t, y, yp, f, move, span)
    return _rest(system, split, t, y, yp, f, span)


def _norm(x: Floats, weight: Floats) -> float:
    return float(np.sqrt(np.mean((x * weight) ** 2)))


def _negligible(system: Any, y: Floats, yp: Floats, f: Floats) -> bool:
    """Whether the residual is round-off of the terms it consists of."""
    m = system.matrix
    terms = abs(m.as_sparse(m.dy)) @ np.abs(y) + abs(m.as_sparse(m.dyp)) @ np.abs(yp)
    return bool(np.all(np.abs(f) <= 1e-8 * terms))


def _newton(
    system: Any, split: Split, t: float, y: Floats, yp: Floats, f: Floats, move: tuple[Floats, Floats], span: float
) -> tuple[Floats, Floats, Floats, Split]:
    """Damped Newton iteration; the size of a move is judged in the norm that the next one is measured in too."""
    trial = np.empty_like(f)
    weight = system.weight(y)

    def size(d: tuple[Floats, Floats]) -> float:
        return _norm(d[1], weight) + _norm(d[0], weight) * 1e-3 * span

    for _ in range(_ITERATIONS):
        fraction, before = 1.0, size(move)
        while True:
            y_new, yp_new = y + fraction * move[1], yp + fraction * move[0]
            fine = system.residual(t, y_new, yp_new, trial)
            if fine and (size(split.move(trial)) <= max((1.0 - 0.25 * fraction) * before, 1e-10)):
                break
            fraction *= 0.5
            if fraction < 1e-6:
                raise no_start(
                    t, "Newton's method does not converge; give algebraic components of y0 nearer to a solution"
                )
        y, yp, f = y_new, yp_new, trial.copy()
        after = split.move(f)
        if fraction == 1.0 and (not f.any() or _tiny(after, y, yp, span)):
            return y, yp, f, split
        if not system.jacobian.evaluate(t, y, yp, f, 0.0, 0.0):
            raise no_start(t, "the Jacobian is not finite")
        split = Split(system.matrix, t)
        move, weight = split.move(f), system.weight(y)
    raise no_start(t, "Newton's method does not converge; give algebraic components of y0 nearer to a solution")


def _tiny(move: tuple[Floats, Floats], y: Floats, yp: Floats, span: float) -> bool:
    level = np.abs(y).max()
    limit = 1e-11
    return bool(
        np.all(np.abs(move[1]) <= limit * (np.abs(y) + 1e-3 * level) + 1e-300)
        and np.all(np.abs(move[0]) <= limit * (np.abs(yp) + np.abs(yp).max() + 1e-3 * level / span) + 1e-300)
    )


def _rest(system: Any, split: Split, t: float, y: Floats, yp: Floats, f: Floats, span: float) -> Start:
    """Derivatives of the algebraic part, and second derivatives, from F = 0 differentiated once."""
    yp = split.differential(yp)
    at = np.empty_like(f)
    here = np.empty_like(f)
    dt = 1e-7 * span if t == 0.0 else max(1e-7 * abs(span), 1.5e-8 * abs(t))
    dt = (t + np.copysign(dt, system.direction)) - t
    if not (system.residual(t, y, yp, here) and system.residual(t + dt, y, yp, at)):
        return Start(y=y, yp=yp, ypp=None, algebraic=split.algebraic)
    m = system.matrix
    slope = (at - here) / dt + m.as_sparse(m.dy) @ yp
    ypp, rate = split.move(slope)
    return Start(y=y, yp=yp + rate, ypp=ypp, algebraic=split.algebraic)
