"""How long a step may be at each time so that no prescribed function is passed over.

Within a step what acts is seen at the nodes of the method.  A polynomial of degree n - 1 through n Radau nodes errs by
at most ``W h^n C``, ``W = 2 (n!)^2/(2n)!`` (at the begin of the step), where the n-th Taylor coefficient is below C.
Steps are kept so short that this is below ``tol`` of the function's largest value.  The bounds hold for all times: no
pulse is too short to be seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.compile.kernel import kernel
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.problem import Floats, Input, Problem
from fricmb.integrate.run.breakpoints import EPS, count_until
from fricmb.integrate.signals.jets import bounds
from fricmb.integrate.signals.largest_value import FIRST, largest_value

#: Most stretches of all; halvings of one.
MOST, DEEPEST = 200_000, 40
#: A stretch is halved where that saves so much of its steps; stretches are one where their steps differ by less.
SAVES, ALIKE = 0.75, 1.4
#: So many steps of a stretch are worth a look at its quarters.
MANY = 16
#: Where quarters save nothing, many short bells may hide in each: ``SAMPLES`` of those left are looked at in so
#: many parts in turn, where steps are ``MANY`` times as many as parts.
PARTS, SAMPLES = (32, 256, 2048), 2
#: Part of such a step that BDF takes at most: it looks at its ends alone.
OF_BDF = 0.25
#: Stretches of a run on which a function without bounds is sampled; round-off of its differences.
SAMPLED, ROUND_OFF = 2048, 1e-12


@dataclass(frozen=True, eq=False)
class LongestSteps:
    """``edge`` (k + 1,) times, rising, and the longest step ``longest`` (k,) from any time between two of them.

    Where a function bends between two of them steps end: the longest step from there on is given with a minus sign.
    """

    edge: Floats
    longest: Floats

    @classmethod
    def none(cls) -> LongestSteps:
        """No function limits steps."""
        return cls(np.array([-np.inf, np.inf]), np.array([np.inf]))


def steps_of_run(problem: Problem, t_start: float, t_end: float, tolerance: Tolerance) -> LongestSteps:
    """The longest steps of a run of a problem."""
    rtol = tolerance.rtol
    inputs, kinks = problem.signals.inputs, problem.signals.kinks
    # series of a million numbers are not kept
    find = longest_steps.__wrapped__ if any(given.tables for given in inputs) else longest_steps
    found = find(inputs, t_start, t_end, tol=rtol, nodes=5 if rtol > 1e-5 else 7)
    found = LongestSteps(found.edge, np.minimum(found.longest, tolerance.max_step))
    return _with_kinks(found, kinks[(kinks > t_start) & (kinks < t_end)]) if kinks.size else found


def shortest_of(steps: LongestSteps, t_start: float, t_end: float, breakpoints: Floats) -> float:
    """The shortest time that inputs tell apart: of steps they let be, and between bends and jumps of theirs."""
    ends = np.unique(np.concatenate([steps.edge, breakpoints, [t_start, t_end]]))
    ends = ends[(ends >= t_start) & (ends <= t_end)]
    return float(min(np.abs(steps.longest).min(), np.diff(ends).min(initial=t_end - t_start)))


def _with_kinks(steps: LongestSteps, kinks: Floats) -> LongestSteps:
    """The same where steps end at kinks as well."""
    edge = np.unique(np.concatenate([steps.edge, kinks]))
    longest = _at(steps, edge[:-1])
    place = np.searchsorted(edge, kinks)
    longest[place] *= -1.0
    return LongestSteps(edge, longest)


@lru_cache(maxsize=256)
def longest_steps(inputs: tuple[Input, ...], t_start: float, t_end: float, *, tol: float, nodes: int) -> LongestSteps:
    """The longest steps under all of these inputs from ``t_start`` to ``t_end``, to ``tol`` of each one's size.

    ``nodes``: at how many times of a step a method looks.
    """
    found = LongestSteps.none()
    for given in inputs:
        found = _both(found, _of_one(given, t_start, t_end, tol, nodes))
    return found


def _of_one(given: Input, t_start: float, t_end: float, tol: float, nodes: int) -> LongestSteps:
    if not t_end > t_start:
        return LongestSteps.none()
    if given.tape is None:
        return _sampled(given, t_start, t_end, tol, nodes)
    edge = np.linspace(t_start, t_end, FIRST + 1)
    low, high = edge[:-1], edge[1:]
    scale = largest_value(given, t_start, t_end)
    if scale == 0.0:
        return LongestSteps.none()
    steps = _allowed(given, low, high, nodes, scale)
    part = tol ** (1.0 / nodes)
    done: list[tuple[Floats, Floats, Floats]] = []
    due = np.zeros(low.size)  # halvings that are known to pay in the end
    for depth in range(DEEPEST):
        short = part * steps < high - low
        open_ = short if low.size < MOST and depth < DEEPEST - 1 else np.zeros_like(short)
        done.append((low[~open_], high[~open_], steps[~open_]))
        if not open_.any():
            break
        low, high, steps, due = low[open_], high[open_], steps[open_], due[open_]
        middle = 0.5 * (low + high)
        left, right = _allowed(given, low, middle, nodes, scale), _allowed(given, middle, high, nodes, scale)
        due = np.maximum(due, _halvings(given, (low, high, steps), (left, right), nodes, scale, part))
        better = due > 0
        done.append((low[~better], high[~better], steps[~better]))
        low, high = np.concatenate([low[better], middle[better]]), np.concatenate([middle[better], high[better]])
        steps, due = np.concatenate([left[better], right[better]]), np.tile(due[better] - 1, 2)
        if not low.size:
            break
    low, high, steps = (np.concatenate([d[i] for d in done]) for i in range(3))
    order = np.argsort(low)
    # where a function has no bound at all, as a root where it begins, steps are as long as what was looked at
    longest = np.maximum(part * steps[order], np.where(steps[order] == 0.0, high[order] - low[order], 0.0))
    return _merged(LongestSteps(np.append(low[order], t_end), longest))


def _halvings(
    given: Input, whole: tuple[Floats, Floats, Floats], halves: tuple[Floats, Floats], nodes: int, scale: float,
    part: float,
) -> Floats:  # fmt: skip
    """After how many halvings of stretches ``whole`` (low, high, steps) steps are saved; 0 where none are known to."""
    low, high, steps = whole
    found = np.where(_saved(2.0, steps, *halves), 1.0, 0.0)
    with np.errstate(divide="ignore"):
        many = (high - low) / (part * steps)
    again = (found == 0.0) & (many > MANY)
    if again.any():  # a bell in the middle of a stretch is in both halves, and each saves little
        found[again] = _saves_in_parts(given, low[again], high[again], steps[again], 4, nodes, scale)
    for count in PARTS:
        again = np.flatnonzero((found == 0.0) & (many > MANY * count))
        if not again.size:
            break
        some = again[:: max(1, again.size // SAMPLES)]
        if _saves_in_parts(given, low[some], high[some], steps[some], count, nodes, scale).any():
            found[again] = math.log2(count)
    return found


def _saves_in_parts(
    given: Input, low: Floats, high: Floats, steps: Floats, count: int, nodes: int, scale: float
) -> NDArray[np.bool_]:
    """Whether ``count`` parts of each stretch are better than the stretch as a whole."""
    ends = np.linspace(low, high, count + 1)
    parts = _allowed(given, ends[:-1].ravel(), ends[1:].ravel(), nodes, scale)
    return _saved(float(count), steps, *parts.reshape(count, -1))


def _saved(count: float, steps: Floats, *parts: Floats) -> NDArray[np.bool_]:
    """Whether ``count`` parts of stretches, by the steps allowed in each, are better than the stretches as a whole."""
    with np.errstate(divide="ignore", invalid="ignore"):
        before, after = count / steps, np.sum([1.0 / part for part in parts], axis=0)
        return np.asarray((after < SAVES * before) | ~np.isfinite(before))


def _allowed(given: Input, low: Floats, high: Floats, nodes: int, scale: float) -> Floats:
    """Step (k,) over tol^(1/nodes) on intervals; towards a pole what counts is the function's size there."""
    assert given.tape is not None
    jet = bounds(given.tape, given.parameters, low, high, nodes + given.rates)
    most = jet.size(nodes)
    factor = 1.0
    for rate in range(1, given.rates + 1):
        factor *= nodes + rate
        most = np.maximum(most, factor * jet.size(nodes + rate))
    least = np.where(jet.low[0] > 0.0, jet.low[0], np.where(jet.high[0] < 0.0, -jet.high[0], 0.0))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        found = (np.maximum(scale, least) / (_farthest(nodes) * most)) ** (1.0 / nodes)
    return np.where(np.isnan(found), 0.0, found)


def _farthest(nodes: int) -> float:
    """The largest product of the distances of a place in [0, 1] from the Radau nodes."""
    return 2.0 / math.comb(2 * nodes, nodes)


def _sampled(given: Input, t_start: float, t_end: float, tol: float, nodes: int) -> LongestSteps:
    """Of a function without bounds: from its differences on stretches, each seen at ``nodes`` + 1 times."""
    assert given.function is not None
    edge = np.linspace(t_start, t_end, SAMPLED + 1)
    h = edge[1] - edge[0]
    places = 0.5 - 0.5 * np.cos(np.linspace(0.0, np.pi, nodes + 1))
    times = edge[:-1, None] + h * places
    value = np.array([_value(given, float(t)) for t in times.ravel()]).reshape(times.shape)
    scale = np.max(np.abs(value), initial=0.0)
    if scale == 0.0:
        return LongestSteps.none()
    gaps = np.prod(np.where(np.eye(nodes + 1, dtype=bool), 1.0, places[:, None] - places), axis=1)
    most = np.abs(value @ (1.0 / gaps)) / h**nodes
    with np.errstate(divide="ignore"):
        least = ROUND_OFF * scale / h**nodes
        allowed = (tol * scale / (_farthest(nodes) * np.maximum(most, least))) ** (1.0 / nodes)
    return _merged(LongestSteps(edge, np.maximum(allowed, h)))


def _value(given: Input, t: float) -> float:
    """The function; 0 where it has no value."""
    assert given.function is not None
    try:
        found = float(given.function((*given.parameters, t)))
    except (ArithmeticError, ValueError):
        return 0.0
    return found if np.isfinite(found) else 0.0


def _merged(steps: LongestSteps) -> LongestSteps:
    """Neighbours that are alike as one, with the shorter step."""
    with np.errstate(divide="ignore", over="ignore"):
        rung = np.floor(np.log(steps.longest) / np.log(ALIKE))
    first = np.flatnonzero(np.append(True, rung[1:] != rung[:-1]))
    return LongestSteps(np.append(steps.edge[first], steps.edge[-1]), np.minimum.reduceat(steps.longest, first))


def _both(a: LongestSteps, b: LongestSteps) -> LongestSteps:
    """The shorter of two at each time."""
    inside = np.unique(np.concatenate([a.edge, b.edge]))
    at = inside[:-1]
    return LongestSteps(inside, np.minimum(_at(a, at), _at(b, at)))


def _at(steps: LongestSteps, t: Floats) -> Floats:
    place = np.searchsorted(steps.edge, t, side="right") - 1
    known = (place >= 0) & (place < steps.longest.size)
    return np.where(known, steps.longest[np.clip(place, 0, steps.longest.size - 1)], np.inf)


@kernel
def stretch_at(edge: Floats, longest: Floats, t: float) -> int:
    """Number of the stretch at t; the first and the last go on outside."""
    return int(min(max(count_until(edge, t) - 1, 0), longest.shape[0] - 1))


@kernel
def longest_from(edge: Floats, longest: Floats, t: float) -> float:
    """The longest step from t: none reaches into a stretch farther than that allows; it may go over the next kink."""
    low = stretch_at(edge, longest, t)
    h = abs(longest[low])
    for j in range(low + 1, longest.shape[0]):
        if edge[j] >= t + h or longest[j] < 0.0:
            break
        h = max(edge[j] - t, min(h, longest[j]))
    return float(h)


@kernel
def kink_from(edge: Floats, longest: Floats, t: float, within: float) -> float:
    """How far the next kink is from t; infinity where there is none as near as ``within``."""
    if longest.shape[0] == 1:
        return np.inf
    for j in range(stretch_at(edge, longest, t + 4.0 * EPS * abs(t)) + 1, longest.shape[0]):
        if edge[j] > t + within:
            break
        if longest[j] < 0.0:
            return float(edge[j] - t)
    return np.inf
