"""Peaks of a spectrum: where, how strong, how wide, how sure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb.analysis._errors import (
    AnalysisError,
    Floats,
    checked_integer,
    checked_numbers,
    checked_samples,
    positive,
    refuse,
)
from fricmb.analysis._spectrum import maximum_entropy_spectrum

Estimate = Callable[[Floats, float], tuple[Floats, Floats]]
_WHO = "spectral_peaks"
#: Peaks that a printed list holds at most, those of most power.
_SHOWN = 20


@dataclass(frozen=True, kw_only=True)
class Peaks:
    """Peaks of a spectrum by rising frequency; each attribute (n_peaks,) but the last.

    Attributes
    ----------
    omega : angular frequency of the maximum, between grid points by a parabola through the logarithm.
    uncertainty : standard error of ``omega``: the spread over parts of the record, scaled to the whole; inf where a
        peak is found in fewer than two of them.
    power : the integral of the density between the minima on both sides.
    power_uncertainty : its standard error, likewise.
    height : density at the maximum.
    prominence : height over the higher of the two minima beside it, in dB.
    width : between the half-height points.
    resolution : float, 2 pi over the length of the record.
    """

    omega: Floats
    uncertainty: Floats
    power: Floats
    power_uncertainty: Floats
    height: Floats
    prominence: Floats
    width: Floats
    resolution: float

    def __len__(self) -> int:
        return len(self.omega)

    def __str__(self) -> str:
        if not len(self):
            return "no peaks: none rises above the minima beside it by prominence= (dB)"
        rows = [f"{'omega':>12} {'+-':>9} {'power':>11} {'+-':>9} {'width':>9} {'dB':>6}"]
        columns = (self.omega, self.uncertainty, self.power, self.power_uncertainty, self.width, self.prominence)
        shown = np.sort(np.argsort(-self.power, kind="stable")[:_SHOWN])
        rows += [
            f"{w:12.6g} {dw:9.2g} {p:11.4g} {dp:9.2g} {b:9.2g} {d:6.1f}"
            for w, dw, p, dp, b, d in zip(*(column[shown] for column in columns), strict=True)
        ]
        if len(self) > _SHOWN:
            rows.append(f"and {len(self) - _SHOWN} of less power")
        if np.isinf(self.uncertainty[shown]).any():
            rows.append("inf: found again in fewer than two parts of the record, so its spread is not known")
        return "\n".join(rows)

    def near(self, omega: float) -> int:
        """Index of the peak nearest to a frequency; AnalysisError if no peak was found."""
        if not len(self):
            raise AnalysisError(f"{_WHO}: there are no peaks")
        return int(np.argmin(np.abs(self.omega - omega)))


@answers
def spectral_peaks(
    x: ArrayLike,
    dt: float,
    *,
    estimate: Estimate = maximum_entropy_spectrum,
    prominence: float = 10.0,
    between: tuple[float, float] | None = None,
    parts: int = 7,
) -> Peaks:
    """Peaks of the spectrum of a uniformly sampled signal, with standard errors.

    Parameters
    ----------
    x : (n,) array_like
        Samples; their mean is taken off.
    dt : float
        Sampling interval.
    estimate : callable
        ``estimate(x, dt)`` -> ``(omega, power)``: :func:`maximum_entropy_spectrum` (default), :func:`welch_spectrum`,
        or one of them with options (``functools.partial``).
    prominence : float
        Least height over the minima beside a peak, in dB.
    between : (float, float), optional
        Range of angular frequencies.
    parts : int
        Overlapping parts of the record, each a quarter of it, over which the spread is taken; 2 to 50.

    Returns
    -------
    Peaks

    Raises
    ------
    AnalysisError
        Options or data that are not accepted.

    Notes
    -----
    The standard error is empirical: the peak nearest in each part (nearer than half the way to the next one), the
    standard deviation of its place over the parts, and a factor 1/2, since the record is four times as long as a part.
    For a signal that changes while it lasts, such as a braking, it includes that change.  It cannot include a bias that
    all parts share: autoregressive peaks in noise move by several standard errors if the order is low.
    """
    samples = checked_samples(_WHO, x, dt)
    checked_integer(_WHO, "parts", parts, 2, 50)
    positive(_WHO, "prominence", prominence)
    if not callable(estimate):
        refuse(_WHO, "estimate", estimate, "a function estimate(x, dt) that returns (omega, power)")
    low, high = (0.0, np.pi / dt) if between is None else _range(between)
    grid, power = estimate(samples, dt)
    whole = _find(grid, power, prominence)
    place = whole[0]
    gap = _half_gaps(place)
    length = len(samples) // 4
    starts = np.linspace(0, len(samples) - length, parts).astype(int)
    found = np.full((2, parts, place.size), np.nan)
    for i, start in enumerate(starts):
        other = _find(*estimate(samples[start : start + length], dt), prominence)
        if other[0].size and place.size:
            nearest = np.argmin(np.abs(other[0][:, None] - place), axis=0)
            close = np.abs(other[0][nearest] - place) < gap
            found[0, i, close], found[1, i, close] = other[0][nearest[close]], other[1][nearest[close]]
    spread = _standard_errors(found)
    keep = (place >= low) & (place <= high)
    return Peaks(
        omega=place[keep],
        uncertainty=spread[0][keep],
        power=whole[1][keep],
        power_uncertainty=spread[1][keep],
        height=whole[2][keep],
        prominence=whole[3][keep],
        width=whole[4][keep],
        resolution=2 * np.pi / (dt * len(samples)),
    )


def _range(between: Any) -> tuple[float, float]:
    """Two frequencies."""
    accepted = "two rising frequencies of at least 0"
    found = checked_numbers(_WHO, "between", between, accepted)
    if found.shape != (2,) or not 0.0 <= found[0] < found[1]:
        refuse(_WHO, "between", between, accepted)
    return float(found[0]), float(found[1])


def _standard_errors(found: Floats) -> Floats:
    """Over the parts (2, parts, n) of place and power; inf where fewer than two were found."""
    count = np.isfinite(found).sum(axis=1)
    result = np.full(count.shape, np.inf)
    for i in range(2):
        several = count[i] >= 2
        result[i, several] = np.nanstd(found[i][:, several], axis=0, ddof=1) / 2.0
    return result


def _half_gaps(place: Floats) -> Floats:
    """Half the way to the nearest neighbour (n,)."""
    if place.size < 2:
        return np.full(place.size, np.inf)
    steps = np.diff(place)
    gaps: Floats = 0.5 * np.minimum(np.append(steps, np.inf), np.insert(steps, 0, np.inf))
    return gaps


def _find(grid: Floats, power: Floats, prominence: float) -> tuple[Floats, Floats, Floats, Floats, Floats]:
    """Places, powers, heights, prominences in dB, widths."""
    from scipy import signal

    floor = power[power > 0.0].min() if (power > 0.0).any() else 1.0
    level = 10 * np.log10(np.maximum(power, floor))
    peaks, facts = signal.find_peaks(level, prominence=prominence)
    total = np.concatenate([np.zeros(1), np.cumsum(0.5 * (power[1:] + power[:-1]) * np.diff(grid))])
    # the minima between neighbouring peaks bound their powers
    bounds = [int(np.argmin(level[a:b])) + a for a, b in zip([0, *peaks], [*(peaks + 1), len(level)], strict=True)]
    if peaks.size:
        bounds[-1] = int(np.argmin(level[peaks[-1] :])) + int(peaks[-1])
    left, right = np.array(bounds[:-1], dtype=int), np.array(bounds[1:], dtype=int)
    width = np.array([_width(grid, power, int(k)) for k in peaks])
    place = np.array([_vertex(grid[k - 1 : k + 2], level[k - 1 : k + 2]) for k in peaks])
    return place, total[right] - total[left], power[peaks], facts["prominences"], width


def _vertex(x: Floats, y: Floats) -> float:
    """Place of the maximum of the parabola through three points."""
    left, right = (y[1] - y[0]) / (x[1] - x[0]), (y[2] - y[1]) / (x[2] - x[1])
    if left == right:
        return float(x[1])
    return float(np.clip(0.5 * (x[0] + x[1]) + 0.5 * (x[2] - x[0]) * left / (left - right), x[0], x[2]))


def _width(grid: Floats, power: Floats, k: int) -> float:
    """Between the points where the density is half that at k."""
    half = 0.5 * power[k]
    right = np.flatnonzero(power[k:] < half)
    left = np.flatnonzero(power[k::-1] < half)
    high = k + int(right[0]) if right.size else len(grid) - 1
    low = k - int(left[0]) if left.size else 0
    return float(_crossing(grid, power, high - 1, high, half) - _crossing(grid, power, low + 1, low, half))


def _crossing(grid: Floats, power: Floats, inside: int, outside: int, half: float) -> float:
    a, b = float(power[inside]), float(power[outside])
    share = 0.0 if a == b else float(np.clip((a - half) / (a - b), 0.0, 1.0))
    return float(grid[inside] + share * (grid[outside] - grid[inside]))
