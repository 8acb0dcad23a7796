"""Filters of series: what scipy.signal does, with even times seen to."""

from __future__ import annotations

from fractions import Fraction
from typing import Any, Literal

import numpy as np

from fricmb.errors import SceneError, shown
from fricmb.integrate.problem import Floats

#: Times are even where their spacing varies by less than this part.
_EVEN = 1e-4


def spacing_of(signal: Any) -> float:
    """The spacing of even times; SceneError, with the place, where they are not."""
    steps = np.diff(signal.t)
    usual = float(np.median(steps))
    odd = np.flatnonzero(np.abs(steps - usual) > _EVEN * usual)
    if odd.size:
        i = int(odd[0])
        raise SceneError(
            f"Signal {signal.name!r}: filters take even times, spaced by {usual:.6g}; from t = {signal.t[i]:.10g} to"
            f" {signal.t[i + 1]:.10g} there is {steps[i]:.6g}; signal.resampled(...) makes them even"
        )
    return usual


def filtered(signal: Any, kind: Literal["lowpass", "highpass"], frequency: Any, order: Any) -> Floats:
    """Values through Butterworth's filter, forth and back."""
    from scipy.signal import butter, sosfiltfilt

    most = 0.5 / spacing_of(signal)
    _number(
        signal, "frequency", frequency, f"a number between 0 and half that of the values, {most:.6g}", most
    )
    if not isinstance(order, int) or isinstance(order, bool) or not 1 <= order <= 20:
        raise SceneError(f"Signal {signal.name!r}: order must be a whole number from 1 to 20, got {shown(order)}")
    sections = butter(order, float(frequency) / most, kind, output="sos")
    reach = min(signal.y.size - 1, round(6.0 * most / float(frequency)))
    found: Floats = sosfiltfilt(sections, signal.y, padtype="odd", padlen=reach)
    return found


def resampled(signal: Any, step: Any) -> tuple[Floats, Floats]:
    """Even times, and values there."""
    from scipy.signal import resample_poly

    span = float(signal.t[-1] - signal.t[0])
    _number(signal, "step", step, f"a number between 0 and the duration, {span:.6g}", span)
    steps = np.diff(signal.t)
    own = float(step)
    if np.ptp(steps) > _EVEN * np.median(steps):
        # to the finest spacing first
        own = min(float(steps.min()), own)
        if span / own > 1e8:
            raise SceneError(f"Signal {signal.name!r}: times {steps.min():.3g} apart are too uneven to be made even")
        t = np.linspace(signal.t[0], signal.t[-1], int(np.ceil(span / own * (1.0 - 1e-9))) + 1)
        y = signal(t)
        own = float(t[1] - t[0])
    else:
        t, y, own = signal.t, signal.y, span / (signal.t.size - 1)
    ratio = Fraction(float(own / float(step))).limit_denominator(1000)
    made = own / float(ratio)
    found = resample_poly(y, ratio.numerator, ratio.denominator, padtype="line")
    times = t[0] + made * np.arange(found.size)
    inside = times <= t[-1] * (1.0 + 1e-12)
    return times[inside], found[inside]


def lag(signal: Any, other: Any, within: Any) -> float:
    """How much later the one has to be to fit the other."""
    from scipy.signal import correlate, correlation_lags

    step = min(float(np.median(np.diff(one.t))) for one in (signal, other))
    a, b = (np.arange(one.t[0], one.t[-1] + 0.5 * step, step) for one in (signal, other))
    x, y = (np.interp(t, one.t, one.y) for t, one in ((a, signal), (b, other)))
    x, y = x - x.mean(), y - y.mean()
    if not (x.any() and y.any()):
        raise SceneError(f"Signal {signal.name!r}: aligned with {other.name!r}: one of them is constant")
    product = correlate(y, x, method="fft")
    lags = correlation_lags(y.size, x.size)
    shift = lags * step + b[0] - a[0]
    overlap = np.minimum(lags + x.size, y.size) - np.maximum(lags, 0)
    good = overlap >= 0.5 * min(x.size, y.size)
    if within is not None:
        _number(signal, "within", within, "a number > 0", np.inf)
        good &= np.abs(shift) <= float(within)
    if not good.any():
        raise SceneError(f"Signal {signal.name!r}: within = {shown(within)} is below the spacing {step:.6g}")
    i = int(np.argmax(np.where(good, product, -np.inf)))
    if 0 < i < product.size - 1:  # between two values: the top of a parabola
        before, here, after = product[i - 1 : i + 2]
        bend = before - 2.0 * here + after
        return float(shift[i] + (0.5 * (before - after) / bend * step if bend < 0.0 else 0.0))
    return float(shift[i])


def _number(signal: Any, argument: str, value: Any, accepted: str, most: float) -> None:
    number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
    if not (number and 0.0 < value < most):
        raise SceneError(f"Signal {signal.name!r}: {argument} must be {accepted}, got {shown(value)}")
