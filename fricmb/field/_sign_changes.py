"""Where a function of time changes its sign along a run: every pair of changes within a step included.

A step is looked at through its Chebyshev polynomial of degree 16, and halved until the polynomial is as good as the
function there and has no extremum that may or may not pass 0 (Trefethen, Approximation Theory and Approximation
Practice, chapter 18).  Places are then found on the function itself.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from fricmb.integrate.problem import Floats

#: A function of rising or unordered times (n,).
Function = Callable[[Floats], Floats]

_DEGREE, _FINE = 16, 64
#: A polynomial whose last terms are smaller than this part of the function tells the function's signs.
_FITS = 1e-3
#: Halvings of a step, and rounds in which places are found.
_HALVINGS, _ROUNDS = 50, 200
#: Numbers that are looked at together, and the least number of spans.
_TOGETHER, _LEAST = 2e5, 64

_places = np.cos(np.pi * np.arange(_DEGREE, -1, -1) / _DEGREE)
_coefficients = np.linalg.inv(chebyshev.chebvander(_places, _DEGREE))
_fine_places = np.linspace(-1.0, 1.0, _FINE + 1)
_to_fine = chebyshev.chebvander(_fine_places, _DEGREE) @ _coefficients


def sign_changes(function: Function, steps: Floats, band: float, *, width: int = 1) -> Iterator[tuple[Floats, Floats]]:
    """Times at which a function passes from one sign to the other, in rising order and found as they are asked for.

    Parameters
    ----------
    function : callable
        Smooth within steps; it may jump from one to the next.
    steps : (n,)
        Times, the ends of all steps.
    band : float
        Values up to this size count as 0: what only comes up to 0 and turns back within it does not pass.
    width : int
        Numbers that one call holds for each time, so that little memory is taken.

    Yields
    ------
    t, sign : (n_changes,)
        The next changes, and the sign that the function has from each of them on.
    """
    steps = np.unique(steps)
    together = max(int(_TOGETHER / (_DEGREE + 1) / max(width, 1)), _LEAST)
    last: tuple[Floats, Floats] = (np.zeros(0), np.zeros(0))
    for k in range(0, steps.size - 1, together):
        ends = steps[k : k + together + 1]
        for told in _looked_at(function, ends[:-1], ends[1:], band, together):
            t, sign = (np.concatenate([before, part[told[1] != 0.0]]) for before, part in zip(last, told, strict=True))
            turned = np.flatnonzero(sign[1:] != sign[:-1])
            if turned.size:
                yield _located(function, t[turned], t[turned + 1], sign[turned + 1]), sign[turned + 1]
            last = t[-1:], sign[-1:]


def _looked_at(
    function: Function, low: Floats, high: Floats, band: float, together: int, halvings: int = _HALVINGS
) -> Iterator[tuple[Floats, Floats]]:
    """Rising times and signs there (0 within the band), such that between two that follow at most one changes.

    Spans that are too many are looked at one half after the other, so that the first changes are found first.
    """
    held: list[tuple[Floats, Floats]] = []
    while low.size:
        if low.size > together:
            order = np.argsort(low)
            parts = np.array_split(order, 2)
            yield from _merged(held, [_looked_at(function, low[k], high[k], band, together, halvings) for k in parts])
            return
        good, told = _told(function, low, high, band, halvings == 0)
        held.append(told)
        low, high = low[~good], high[~good]
        middle = 0.5 * (low + high)
        low, high, halvings = np.concatenate([low, middle]), np.concatenate([middle, high]), halvings - 1
    yield _rising(held)


def _merged(
    held: list[tuple[Floats, Floats]], later: Iterable[Iterator[tuple[Floats, Floats]]]
) -> Iterator[tuple[Floats, Floats]]:
    """What is known already, put between what is found span by span."""
    known = _rising(held)
    for spans in later:
        for told in spans:
            before = known[0] <= told[0].max(initial=-np.inf)
            yield _rising([(known[0][before], known[1][before]), told])
            known = known[0][~before], known[1][~before]
    yield known


def _rising(parts: list[tuple[Floats, Floats]]) -> tuple[Floats, Floats]:
    """All of them in the order of their times."""
    t, sign = (np.concatenate([part[i] for part in parts]) for i in (0, 1)) if parts else (np.zeros(0), np.zeros(0))
    order = np.argsort(t, kind="stable")
    return t[order], sign[order]


def _told(
    function: Function, low: Floats, high: Floats, band: float, last: bool
) -> tuple[NDArray[np.bool_], tuple[Floats, Floats]]:
    """Which of some spans need not be halved, and times and signs within these."""
    t = low[:, None] + 0.5 * (1.0 + _places) * (high - low)[:, None]
    t[:, -1] = np.nextafter(high, low)  # the value before what happens at the end
    y = function(t.ravel()).reshape(t.shape)
    size = np.abs(y).max(axis=1)
    tail = 2.0 * np.abs(y @ _coefficients[-3:].T).sum(axis=1)
    fine = y @ _to_fine.T
    narrow = (high - low <= 16.0 * np.spacing(np.maximum(np.abs(low), np.abs(high)))) | last
    good = (size <= band) | narrow | ((tail <= _FITS * size) & ~_may_touch(fine, np.maximum(tail, band)))
    at = low[good, None] + 0.5 * (1.0 + _fine_places) * (high - low)[good, None]
    at[:, -1] = t[good, -1]
    unsure = np.where(narrow[good], np.inf, np.maximum(tail[good], band))[:, None]
    sign = np.where(np.abs(fine[good]) <= unsure, 0.0, np.sign(fine[good]))
    ends = y[good][:, [0, -1]]  # the function itself: here signs of neighbours meet
    sign[:, [0, -1]] = np.where(np.abs(ends) <= band, 0.0, np.sign(ends))
    return good, _needed(at, sign)


def _may_touch(fine: Floats, unsure: Floats) -> NDArray[np.bool_]:
    """Whether a polynomial has an extremum next to 0 of which its values do not tell whether it passes 0."""
    left, here, right = fine[:, :-2], fine[:, 1:-1], fine[:, 2:]
    margin = np.abs(left - 2.0 * here + right) / 4.0 + unsure[:, None]
    nearest = (np.abs(here) <= np.abs(left)) & (np.abs(here) <= np.abs(right))
    same = (np.sign(left) == np.sign(here)) & (np.sign(right) == np.sign(here))
    found: NDArray[np.bool_] = (nearest & same & (np.abs(here) <= margin) & (np.abs(here) > 0.0)).any(axis=1)
    return found


def _needed(t: Floats, sign: Floats) -> tuple[Floats, Floats]:
    """Both ends of each row, and all of rows whose sign is not the same throughout."""
    kept = np.zeros(t.shape, dtype=bool)
    kept[:, [0, -1]] = True
    kept[(sign != sign[:, :1]).any(axis=1)] = True
    return t[kept], sign[kept]


def _located(function: Function, low: Floats, high: Floats, sign: Floats) -> Floats:
    """The places between ``low`` and ``high`` at which the function takes ``sign``, to round-off.

    Regula falsi with the weight of an end that stays halved (Illinois), and a halving each third time.
    """
    if not low.size:
        return high
    low, high = low.copy(), high.copy()
    y_low, y_high = sign * function(low), sign * function(high)
    for k in range(_ROUNDS):
        left = high - low > 2.0 * np.spacing(np.maximum(np.abs(low), np.abs(high)))
        if not left.any():
            break
        rise = y_high - y_low
        share = np.where(rise > 0.0, -y_low / np.where(rise > 0.0, rise, 1.0), 0.5)
        t = low + (high - low) * (0.5 if k % 3 == 2 else np.clip(share, 0.0, 1.0))
        t = np.clip(t, np.nextafter(low, high), np.nextafter(high, low))
        y = sign * function(t)
        above = left & (y >= 0.0)
        below = left & ~above
        y_low, y_high = np.where(above, 0.5 * y_low, y_low), np.where(below, 0.5 * y_high, y_high)
        high, y_high = np.where(above, t, high), np.where(above, y, y_high)
        low, y_low = np.where(below, t, low), np.where(below, y, y_low)
    return high
