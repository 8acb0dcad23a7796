"""The finite differences of ``_jacobian.Differences`` for a compiled function, without Python."""

from __future__ import annotations

import math
from typing import Any

from fricmb.dae._foreign import call
from fricmb.dae._jacobian import CLEAR, CUBE_ROOT, ROOT, ROUNDS
from fricmb.integrate.compile.kernel import kernel

KNOWN, CENTRAL, CALLS = 0, 1, 2  # entries of ``flags``
# rows of ``work``
_SIZE, _RATE, _LEVEL, _EFFECT, _THERE, _OUT, _OTHER, _MOVE = range(8)
WORK_ROWS = 8


@kernel
def residual(address: Any, t: Any, y: Any, yp: Any, out: Any, p: Any, n: Any) -> bool:
    """Evaluate the user's function; False if it is not finite."""
    call(address, (t, y, yp, out, p, n))
    for i in range(len(out)):  # noqa: SIM110 - a loop compiles faster than a generator
        if not math.isfinite(out[i]):
            return False
    return True


@kernel
def _residual_beside(
    address: Any, t: Any, y: Any, yp: Any, p: Any, n: Any, work: Any, of_y: bool, columns: Any, factor: float, row: int
) -> bool:
    """Evaluate with some columns moved by ``factor`` times their increment, into a row of ``work``."""
    there = work[_THERE]
    base = y if of_y else yp
    for i in range(len(base)):
        there[i] = base[i]
    for j in columns:
        there[j] = base[j] + factor * work[_SIZE if of_y else _RATE, j]
    if of_y:
        return residual(address, t, there, yp, work[row], p, n)
    return residual(address, t, y, there, work[row], p, n)


@kernel
def _fill(
    values: Any, address: Any, t: Any, y: Any, yp: Any, f: Any, p: Any, n: Any,
    work: Any, of_y: bool, columns: Any, pattern: Any, flags: Any,
) -> bool:  # fmt: skip
    """Differences of one group of columns."""
    start, rows, place = pattern
    base = y if of_y else yp
    step = work[_SIZE if of_y else _RATE]
    sign = 1.0
    flags[CALLS] += 1
    if not _residual_beside(address, t, y, yp, p, n, work, of_y, columns, sign, _OUT):
        sign = -1.0
        flags[CALLS] += 1
        if not _residual_beside(address, t, y, yp, p, n, work, of_y, columns, sign, _OUT):
            return False
    both = False
    if flags[CENTRAL]:
        flags[CALLS] += 1
        both = _residual_beside(address, t, y, yp, p, n, work, of_y, columns, -sign, _OTHER)
    for j in columns:
        width = (base[j] + sign * step[j]) - base[j]
        back = (base[j] - sign * step[j]) - base[j]
        for q in range(start[j], start[j + 1]):
            i = rows[q]
            if both:
                values[place[q]] = (work[_OUT, i] - work[_OTHER, i]) / (width - back)
            else:
                values[place[q]] = (work[_OUT, i] - f[i]) / width
    return True


@kernel
def _levels(y: Any, yp: Any, f: Any, dy: Any, dyp: Any, pattern: Any, level: Any) -> None:
    start, rows, place = pattern
    for i in range(len(y)):
        level[i] = abs(f[i]) + 1e-300
    for j in range(len(y)):
        for q in range(start[j], start[j + 1]):
            level[rows[q]] += abs(dy[place[q]] * y[j]) + abs(dyp[place[q]] * yp[j])


@kernel
def _confirmed(
    address: Any, t: Any, y: Any, yp: Any, f: Any, p: Any, n: Any, c: float, rtol: Any, atol: Any,
    dy: Any, dyp: Any, pattern: Any, direction: Any, work: Any, flags: Any,
) -> bool:  # fmt: skip
    """Whether dF/dyp at hand explains what a move of all components of yp does."""
    start, rows, place = pattern
    for j in range(len(y)):
        scale = abs(c) * (atol[j] + rtol[j] * abs(y[j]))
        work[_MOVE, j] = direction[j] * 1e-2 * max(abs(yp[j]), scale)
        work[_THERE, j] = yp[j] + work[_MOVE, j]
    flags[CALLS] += 1
    if not residual(address, t, y, work[_THERE], work[_OUT], p, n):
        return False
    _levels(y, yp, f, dy, dyp, pattern, work[_LEVEL])
    for i in range(len(y)):
        work[_EFFECT, i] = 0.0
        work[_OTHER, i] = 0.0
    for j in range(len(y)):
        for q in range(start[j], start[j + 1]):
            term = dyp[place[q]] * work[_MOVE, j]
            work[_EFFECT, rows[q]] += term
            work[_OTHER, rows[q]] += abs(term)
    for i in range(len(y)):
        wrong = abs(work[_OUT, i] - f[i] - work[_EFFECT, i])
        if not wrong <= 1e-5 * work[_OTHER, i] + 4e-15 * work[_LEVEL, i]:
            return False
    return True


@kernel
def differences(
    address: Any, t: Any, y: Any, yp: Any, f: Any, p: Any, n: Any, c: float, h: float, rtol: Any, atol: Any,
    dy: Any, dyp: Any, pattern: Any, members: Any, ends: Any, floor: Any, direction: Any, work: Any, flags: Any,
) -> bool:  # fmt: skip
    """Both Jacobians; ``members[ends[g]:ends[g + 1]]`` are the columns of group g.  See ``_jacobian.Differences``."""
    start, rows, place = pattern
    size = len(y)
    again = flags[KNOWN] and _confirmed(
        address, t, y, yp, f, p, n, c, rtol, atol, dy, dyp, pattern, direction, work, flags
    )
    flags[KNOWN] = 1
    root = CUBE_ROOT if flags[CENTRAL] else ROOT
    part = 1e-1 if flags[CENTRAL] else 1e-2
    largest = 0.0
    for j in range(size):
        largest = max(largest, abs(y[j]))
        tolerance = atol[j] + rtol[j] * abs(y[j])
        least = max(max(root * max(abs(y[j]), abs(h * yp[j])), part * tolerance), floor[j])
        work[_SIZE, j] = -least if h * yp[j] < 0.0 else least
        work[_RATE, j] = max(root * abs(yp[j]), abs(c) * max(least, tolerance))
    for g in range(len(ends) - 1):
        columns = members[ends[g] : ends[g + 1]]
        if not _fill(dy, address, t, y, yp, f, p, n, work, True, columns, pattern, flags):
            return False
        if not again and not _fill(dyp, address, t, y, yp, f, p, n, work, False, columns, pattern, flags):
            return False
    for _ in range(ROUNDS - 1):
        _levels(y, yp, f, dy, dyp, pattern, work[_LEVEL])
        done = True
        for j in range(size):
            width = abs(work[_SIZE, j])
            effect = 0.0
            for q in range(start[j], start[j + 1]):
                effect = max(effect, abs(dy[place[q]] + c * dyp[place[q]]) * width / work[_LEVEL, rows[q]])
            if effect > 1e4 * CLEAR:
                floor[j] *= 1e-3
            if effect < CLEAR and 1e3 * width <= ROOT * largest:
                done = False
                floor[j] = 1e3 * width
                work[_SIZE, j] *= 1e3
                work[_RATE, j] = max(work[_RATE, j], abs(c * work[_SIZE, j]))
                one = members[0:1].copy()
                one[0] = j
                if not _fill(dy, address, t, y, yp, f, p, n, work, True, one, pattern, flags):
                    return False
                if not again and not _fill(dyp, address, t, y, yp, f, p, n, work, False, one, pattern, flags):
                    return False
        if done:
            break
    return True
