"""One step of the variable-step, variable-order BDF: fixed leading coefficient, orders 1 to 5.

The history is kept as misses: row j is y_n minus the value at t_n of the polynomial through the j points before, which
is ``prod_{i<j} (t_n - t_{n-1-i})`` times the divided difference [y_n, ..., y_{n-j}].  Going to a new step size
multiplies row j by ``prod_{i<j} (t_{n+1} - t_{n-i}) / (t_n - t_{n-1-i})`` (a starred row); the predictor of degree k
is the sum of the starred rows 0..k.  The corrector differs from the predictor by a polynomial that is 0 at
t_{n+1} - i h, i = 1..k, so ``yp = yp_predicted + C (y - y_predicted)`` with C = (1 + 1/2 + ... + 1/k)/h whatever the
steps before were.

Source of the method: K. E. Brenan, S. L. Campbell, L. R. Petzold, Numerical Solution of Initial-Value Problems in
Differential-Algebraic Equations, SIAM 1996, chapter 5; K. R. Jackson, R. Sacks-Davis, ACM TOMS 6 (1980) 295.
"""

from __future__ import annotations

import math
from typing import Any

from fricmb.dae import _layout as L
from fricmb.dae._compile import kernel
from fricmb.dae._predict import coefficients, predict, remember, weighted_norm
from fricmb.dae._step_control import allowed, choose, norm_of_sum, test_factor

_NEWTON_TOLERANCE = 0.03  # of the error test's 1
_MAX_ITERATIONS = 4
_MAX_RATE = 0.9
_SAME_FACTORS = 0.6  # factors are used while C/C_FACTOR lies between this and its inverse
_JACOBIAN_LIFE = 50
_MAX_FAILS = 60


@kernel
def _begin(whole: Any, real: Any, rows: Any, rtol: Any, atol: Any) -> int:
    """Predict at t + h and say what the Newton iteration needs first."""
    n = rows.shape[1]
    left = real[L.T_END] - real[L.T]
    h = real[L.H]
    if abs(h) > real[L.H_MAX]:
        h = math.copysign(real[L.H_MAX], h)
    if abs(h) * (1.0 + 1e-10) >= abs(left):
        h = left
    elif 2.0 * abs(h) > abs(left) and whole[L.SAME] == 0:
        h = 0.5 * left  # two equal steps to the end rather than a sliver
    if h != real[L.H_STEP]:
        whole[L.SAME] = 0
    real[L.H] = h
    real[L.H_STEP] = h
    real[L.T_NEW] = real[L.T_END] if h == left else real[L.T] + h
    if whole[L.FIRST]:
        ratio = h / real[L.AGO + 1]  # the point before the first is made up, one step back along the tangent
        real[L.AGO + 1] = h
        for i in range(n):
            rows[L.HISTORY + 1, i] *= ratio
    for i in range(n):
        rows[L.WEIGHT, i] = 1.0 / (atol[i] + rtol[i] * abs(rows[L.HISTORY, i]))
    coefficients(whole[L.ORDER], h, real)
    predict(whole[L.ORDER], real, rows)
    whole[L.ITERATION] = 0
    whole[L.AT_START] = 0
    ratio = real[L.C] / real[L.C_FACTOR] if whole[L.HAVE_FACTORS] else 0.0
    if not whole[L.HAVE_FACTORS] or whole[L.JACOBIAN_AGE] >= _JACOBIAN_LIFE:
        return _renew(whole, real)
    if ratio < _SAME_FACTORS or ratio * _SAME_FACTORS > 1.0:
        return _refactor(whole, real)
    real[L.SCALE] = 2.0 / (1.0 + ratio)
    return L.RESIDUAL


@kernel
def _refactor(whole: Any, real: Any) -> int:
    real[L.C_FACTOR] = real[L.C]
    real[L.SCALE] = 1.0
    real[L.CONTRACTION] = 20.0
    whole[L.HAVE_FACTORS] = 1
    return L.FACTOR


@kernel
def _renew(whole: Any, real: Any) -> int:
    _refactor(whole, real)
    whole[L.FRESH] = 1
    whole[L.JACOBIAN_AGE] = 0
    return L.JACOBIAN


@kernel
def _iterate(whole: Any, real: Any, rows: Any) -> int:
    """Take the Newton step that was solved for: 1 converged, 0 go on, -1 it does not converge."""
    n = rows.shape[1]
    scale = -real[L.SCALE]
    for i in range(n):
        delta = rows[L.DELTA, i] * scale
        rows[L.DELTA, i] = delta
        rows[L.CHANGE, i] += delta
        rows[L.Y, i] += delta
        rows[L.YP, i] += real[L.C] * delta
    norm = weighted_norm(rows, L.DELTA)
    if not math.isfinite(norm):
        return -1
    m = whole[L.ITERATION]
    whole[L.ITERATION] = m + 1
    if m == 0:
        real[L.NORM_FIRST] = norm
        if norm <= 1e-4 * _NEWTON_TOLERANCE:
            return 1
    else:
        rate = (norm / real[L.NORM_FIRST]) ** (1.0 / m)
        if rate > _MAX_RATE:
            return -1
        real[L.CONTRACTION] = rate / (1.0 - rate)
    if real[L.CONTRACTION] * norm <= _NEWTON_TOLERANCE:
        return 1
    return 0 if m + 1 < _MAX_ITERATIONS else -1


@kernel
def _reject(whole: Any, real: Any, factor: float, cause: int) -> int:
    """Make the step smaller; the code of the failure if it cannot be."""
    whole[L.REJECTED] += 1
    whole[L.LAST_CAUSE] = cause
    whole[L.RISING] = 0
    whole[L.AT_START] = 1
    whole[L.SAME] = 0
    real[L.H] = factor * real[L.H_STEP]
    fails = whole[L.ERROR_FAILS] + whole[L.NEWTON_FAILS]
    if abs(real[L.H]) < 16.0 * 2.2e-16 * abs(real[L.T]) or real[L.H] == 0.0 or fails > _MAX_FAILS:
        return cause
    return 0


@kernel
def _after_failed_newton(whole: Any, real: Any, cause: int) -> int:
    """New Jacobians at the same step, if those at hand are old; a smaller step otherwise."""
    if cause != L.FAILED_NONFINITE and not whole[L.FRESH]:
        whole[L.JACOBIAN_AGE] = _JACOBIAN_LIFE
        whole[L.AT_START] = 1
        return 0
    whole[L.NEWTON_FAILS] += 1
    return _reject(whole, real, 0.25, cause)


@kernel
def _judge(whole: Any, real: Any, rows: Any) -> int:
    """Error test of a converged step, and order and step size of the next."""
    k = whole[L.ORDER]
    h = real[L.H_STEP]
    change = weighted_norm(rows, L.CHANGE)
    here = real[L.SIGMA + k] * change
    down = 0.0
    best, error = k, here
    if k > 1:
        down = real[L.SIGMA + k - 1] * norm_of_sum(rows, real, k, k)
        worst = k * down
        if k > 2:
            worst = max(worst, (k - 1) * real[L.SIGMA + k - 2] * norm_of_sum(rows, real, k - 1, k))
            lower = worst <= (k + 1) * here
        else:
            lower = worst <= 0.5 * (k + 1) * here
        if lower:
            best, error = k - 1, down
    if test_factor(k, h, real) * change > 1.0:
        whole[L.ERROR_FAILS] += 1
        if whole[L.ERROR_FAILS] == 1:
            whole[L.ORDER] = best
            factor = min(0.9, max(0.25, 0.9 * allowed(error, best)))
        else:
            whole[L.ORDER] = best if whole[L.ERROR_FAILS] == 2 else max(1, k - 1)
            factor = 0.25
        return _reject(whole, real, factor, L.FAILED_ERROR)
    choose(whole, real, rows, best, here, down)
    return L.ACCEPTED


@kernel
def advance(whole: Any, real: Any, rows: Any, rtol: Any, atol: Any, served: int) -> int:
    """Go on until something is needed from outside or a step is done; the answer is a request of ``_layout``."""
    while True:
        if whole[L.AT_START]:
            return _begin(whole, real, rows, rtol, atol)
        outcome = 0
        if served != L.SERVED:
            whole[L.HAVE_FACTORS] = 0
        if served == L.NONFINITE:
            outcome = _after_failed_newton(whole, real, L.FAILED_NONFINITE)
        elif served == L.SINGULAR:
            outcome = _after_failed_newton(whole, real, L.FAILED_SINGULAR)
        else:
            state = _iterate(whole, real, rows)
            if state == 0:
                return L.RESIDUAL
            if state < 0:
                outcome = _after_failed_newton(whole, real, L.FAILED_NEWTON)
            else:
                outcome = _judge(whole, real, rows)
        if outcome == L.ACCEPTED:
            remember(whole, real, rows)
            return L.ACCEPTED
        if outcome < 0:
            return outcome
