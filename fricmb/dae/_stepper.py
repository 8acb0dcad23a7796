"""One step of the BDF of ``solve_dae``: orders 1 to 5, by the backward differences that scenes are run with as well.

The prediction plus d is y, and its slope plus c d is yp, c = gamma_k/h (``formulas/backward_differences``).  What is
asked of d is F(t, y, yp) = 0, by Newton's method with factors of dF/dy + c dF/dyp that serve for other steps too.

Source: K. E. Brenan, S. L. Campbell, L. R. Petzold, Numerical Solution of Initial-Value Problems in
Differential-Algebraic Equations, SIAM 1996, chapter 5, for Newton's method and what follows a failure.
"""

from __future__ import annotations

import math

import numpy as np

from fricmb.dae import _layout as L
from fricmb.dae._layout import Stepper
from fricmb.integrate.compile.kernel import entry, kernel
from fricmb.integrate.formulas.backward_differences import (
    best_order,
    bring_forward,
    change_order,
    predicted,
    rescale,
    shortened,
)
from fricmb.integrate.formulas.newton import left_over
from fricmb.integrate.formulas.step_control import BDF_RUNGS, ladder
from fricmb.integrate.problem import Floats

#: Growth of a step at most: until the first failure, and behind it.
EARLY_GROWTH, GROWTH = 4.0, 2.0
_LEAST = 0.2  # of its length that a step's error leaves of it
_NEWTON_TOLERANCE = 0.03  # of the error test's 1
_MAX_ITERATIONS = 4
#: Rates of convergence: before any is known; the least that is believed of the step before; the largest that serves.
_UNKNOWN_RATE, _LEAST_RATE, _MAX_RATE = 0.95, 0.01, 0.9
_SAME_FACTORS = 0.6  # factors are used while c/made lies between this and its inverse
_JACOBIAN_LIFE = 50
_PATIENCE = 3  # failures of a step after which its history is taken for that of another motion
_MAX_FAILS = 60


@kernel
def weighted_norm(values: Floats, weight: Floats) -> float:
    """Root mean square in units of the tolerances."""
    total = 0.0
    for i in range(values.shape[0]):
        total += (values[i] * weight[i]) ** 2
    return math.sqrt(total / values.shape[0])


@kernel
def _fit_into_run(s: Stepper) -> None:
    """Let steps end at the end of the run, the last two rather equal than the last a sliver."""
    left, h = s.t_end - s.t, s.h
    if abs(h) * (1.0 + 1e-10) >= abs(left):
        h = left
    elif 2.0 * abs(h) > abs(left) and s.equal == 0:
        h = 0.5 * left
    if h != s.h:
        rescale(s, h / s.h)
        s.h = h
    s.now[0] = s.t_end if h == left else s.t + h


@kernel
def _begin(s: Stepper, rtol: Floats, atol: Floats) -> int:
    """Predict at t + h and say what the Newton iteration needs first."""
    _fit_into_run(s)
    for i in range(s.y.shape[0]):
        s.weight[i] = 1.0 / (atol[i] + rtol[i] * abs(s.D[0, i]))
        s.y[i], psi = predicted(s, i)
        s.yp[i] = psi / s.h
        s.d[i] = 0.0
    s.c = s.gamma[s.order] / s.h
    s.iteration = s.at_start = 0
    if s.age >= _JACOBIAN_LIFE:
        return _renew(s)
    ratio = s.c / s.made if s.made != 0.0 else 0.0
    if ratio < _SAME_FACTORS or ratio * _SAME_FACTORS > 1.0:
        return _refactor(s)
    # factors of another c leave this part of a change undone, however fast they converged at their own
    s.scale = 2.0 / (1.0 + ratio)
    s.convergence = max(s.convergence, abs(1.0 - ratio) / (1.0 + ratio))
    return L.RESIDUAL


@kernel
def _refactor(s: Stepper) -> int:
    s.made = s.c
    s.scale = 1.0
    s.convergence = _UNKNOWN_RATE
    return L.FACTOR


@kernel
def _renew(s: Stepper) -> int:
    _refactor(s)
    s.fresh = 1
    s.age = 0
    return L.JACOBIAN


@kernel
def _iterate(s: Stepper) -> int:
    """Take the Newton step that was solved for: 1 converged, 0 go on, -1 it does not converge."""
    for i in range(s.y.shape[0]):
        s.delta[i] *= -s.scale
        s.d[i] += s.delta[i]
        s.y[i] += s.delta[i]
        s.yp[i] += s.c * s.delta[i]
    norm = weighted_norm(s.delta, s.weight)
    if not math.isfinite(norm):
        return -1
    m = s.iteration
    s.iteration = m + 1
    if m == 0:
        s.norm_first = norm
        if norm <= 1e-4 * _NEWTON_TOLERANCE:
            return 1
    else:
        rate = (norm / s.norm_first) ** (1.0 / m)
        if rate > _MAX_RATE:
            return -1
        s.convergence = max(_LEAST_RATE, rate)
    if left_over(norm, s.convergence) <= _NEWTON_TOLERANCE:
        return 1
    return 0 if m + 1 < _MAX_ITERATIONS else -1


@kernel
def _set_off(s: Stepper, h: float) -> None:
    """Begin again from the last point: order 1 with step h, along its slope."""
    for i in range(s.D.shape[1]):
        for j in range(1, s.D.shape[0]):
            s.D[j, i] = 0.0
        s.D[1, i] = h * s.rate[i]
    s.h, s.order, s.equal, s.first = h, 1, 0, 1


@kernel
def _reject(s: Stepper, factor: float, cause: int) -> int:
    """Make the step shorter; the code of the failure if it cannot be."""
    s.rejected += 1
    s.at_start = 1
    s.growth = GROWTH
    s.made = 0.0  # what factors of another step leave undone is noise, which differences make 2^k times larger
    h, fails = factor * s.h, s.error_fails + s.newton_fails
    if abs(h) < 16.0 * 2.2e-16 * abs(s.t) or h == 0.0 or fails > _MAX_FAILS:
        return cause
    if fails >= _PATIENCE and s.order > 1:
        _set_off(s, h)
    else:
        rescale(s, factor)
    return 0


@kernel
def _after_failed_newton(s: Stepper, cause: int) -> int:
    """New Jacobians at the same step, if those at hand are old; a shorter step otherwise."""
    if cause != L.FAILED_NONFINITE and not s.fresh:
        s.age = _JACOBIAN_LIFE
        s.at_start = 1
        return 0
    s.newton_fails += 1
    return _reject(s, 0.25, cause)


@kernel
def _judge(s: Stepper) -> int:
    """Error test of a converged step, and what follows."""
    k = s.order
    error = weighted_norm(s.d, s.weight) / (k + 1)
    if error > 1.0:
        s.error_fails += 1
        return _reject(s, shortened(error, k + 1, _LEAST), L.FAILED_ERROR)
    _accept(s)
    if s.equal > k:
        _select_order(s, error)
    return L.ACCEPTED


@kernel
def _accept(s: Stepper) -> None:
    """Make the new point the last one."""
    for i in range(s.D.shape[1]):
        bring_forward(s, i)
        s.rate[i] = s.yp[i]
        if s.first:  # along the slope of a parabola its points are half a second difference off
            s.D[2, i] = 2.0 * s.d[i]
    s.t = s.now[0]
    s.order_used = s.order
    s.equal += 1
    s.steps += 1
    s.age += 1
    s.at_start = 1
    s.first = s.fresh = s.error_fails = s.newton_fails = 0


@kernel
def _select_order(s: Stepper, error: float) -> None:
    """After k + 1 equal steps: the order and step that goes fastest."""
    k = s.order
    lower = higher = np.inf
    if k > 1:
        lower = weighted_norm(s.D[k], s.weight) / k
    if k < s.highest:
        higher = weighted_norm(s.D[k + 2], s.weight) / (k + 2)
    # half the error that is allowed: algebraic components follow slopes, which change more than values do with h
    best_k, best = best_order(k, 2.0 * lower, 2.0 * error, 2.0 * higher, 1)
    change_order(s, best_k, ladder(min(best, s.growth, s.longest / abs(s.h)), BDF_RUNGS))


@entry
def advance(s: Stepper, rtol: Floats, atol: Floats, served: int) -> int:
    """Go on until something is needed from outside or a step is done; the answer is a request of ``_layout``."""
    while True:
        if s.at_start:
            return _begin(s, rtol, atol)
        if served != L.SERVED:
            s.made = 0.0
        if served == L.NONFINITE:
            outcome = _after_failed_newton(s, L.FAILED_NONFINITE)
        elif served == L.SINGULAR:
            outcome = _after_failed_newton(s, L.FAILED_SINGULAR)
        else:
            state = _iterate(s)
            if state == 0:
                return L.RESIDUAL
            outcome = _after_failed_newton(s, L.FAILED_NEWTON) if state < 0 else _judge(s)
        if outcome != 0:
            return outcome
