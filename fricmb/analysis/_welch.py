"""Averaged and running spectra of uniformly sampled signals, by scipy."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb.analysis._errors import AnalysisError, Floats, checked_integer, checked_number, checked_samples, refuse
from fricmb.errors import shown
from fricmb.values import as_float


@answers
def welch_spectrum(
    x: ArrayLike, dt: float, *, segment: int | None = None, overlap: float = 0.5, window: str = "hann"
) -> tuple[Floats, Floats]:
    """Power spectral density averaged over overlapping segments (Welch's method).

    Parameters
    ----------
    x : (n,) array_like
        Samples; their mean is taken off.
    dt : float
        Sampling interval.
    segment : int, optional
        Samples in a segment, 2 to n; the resolution is about ``2 pi / (segment dt)``.  Default: an eighth of n.
    overlap : float
        Share of a segment that the next one repeats, 0 to 0.95.
    window : str
        Name of a window of ``scipy.signal.get_window``.

    Returns
    -------
    omega : (n_omega,)
        From 0 to pi/dt.
    power : (n_omega,)
        One-sided density over omega: its integral is the mean square of x under the window.

    Raises
    ------
    AnalysisError
        A segment or overlap that is not accepted, samples that are not finite.

    Notes
    -----
    P. D. Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70; ``scipy.signal.welch``.
    """
    from scipy import signal

    samples = checked_samples("welch_spectrum", x, dt)
    length, shared = _segments("welch_spectrum", len(samples), segment, overlap, 8)
    shape = _window("welch_spectrum", window, length)
    frequency, density = signal.welch(  # type: ignore[call-overload]  # the stubs know no arrays for window
        samples, fs=1.0 / dt, window=shape, nperseg=length, noverlap=shared, detrend=False, scaling="density"
    )
    return 2 * np.pi * frequency, density / (2 * np.pi)


@dataclass(frozen=True, kw_only=True)
class Spectrogram:
    """A running spectrum.

    Attributes
    ----------
    t : (n_t,)
        Middles of the segments.
    omega : (n_omega,)
        From 0 to pi/dt.
    power : (n_omega, n_t)
        One-sided density over omega: its integral is the mean square of the segment under the window.
    """

    t: Floats
    omega: Floats
    power: Floats


@answers
def spectrogram(
    x: ArrayLike,
    dt: float,
    *,
    t_start: float = 0.0,
    segment: int | None = None,
    overlap: float = 0.75,
    window: str = "hann",
) -> Spectrogram:
    """Short-time spectrum of a uniformly sampled signal.

    Parameters
    ----------
    x : (n,) array_like
        Samples; their mean is taken off.
    dt : float
        Sampling interval.
    t_start : float
        Time of the first sample.
    segment : int, optional
        Samples in a segment, 2 to n: longer resolves frequencies, shorter times.  Default: a sixteenth of n.
    overlap : float
        Share of a segment that the next one repeats, 0 to 0.95.
    window : str
        Name of a window of ``scipy.signal.get_window``.

    Returns
    -------
    Spectrogram

    Raises
    ------
    AnalysisError
        A segment or overlap that is not accepted, samples that are not finite.
    """
    from scipy import signal

    samples = checked_samples("spectrogram", x, dt)
    t_start = checked_number("spectrogram", "t_start", t_start, "a finite time", np.isfinite)
    length, shared = _segments("spectrogram", len(samples), segment, overlap, 16)
    shape = _window("spectrogram", window, length)
    transform = signal.ShortTimeFFT(shape, hop=length - shared, fs=1.0 / dt, fft_mode="onesided2X", scale_to="psd")
    # whole segments alone: a segment that reaches beyond the record has less power
    first, last = transform.lower_border_end[1], transform.upper_border_begin(len(samples))[1]
    power = np.abs(transform.stft(samples, p0=first, p1=max(last, first + 1))) ** 2
    t: Floats = t_start + transform.delta_t * np.arange(first, max(last, first + 1), dtype=np.float64)
    return Spectrogram(t=t, omega=2 * np.pi * transform.f, power=power / (2 * np.pi))


def _segments(who: str, n: int, segment: int | None, overlap: float, parts: int) -> tuple[int, int]:
    """Length of a segment and what two neighbours share, in samples."""
    length = min(n, max(2, n // parts)) if segment is None else checked_integer(who, "segment", segment, 2, n)
    if not 0.0 <= as_float(overlap) <= 0.95:
        raise AnalysisError(f"{who}: overlap must lie between 0 and 0.95; got {shown(overlap)}")
    return length, min(length - 1, int(overlap * length))


def _window(who: str, name: Any, length: int) -> Floats:
    from scipy import signal

    try:
        shape: Floats = signal.get_window(name, length)
    except (ValueError, TypeError, IndexError) as error:
        raise AnalysisError(
            f"{who}: window must be one of scipy.signal.get_window; got {shown(name)} ({' '.join(str(error).split())})"
        ) from None
    if not np.isfinite(shape).all():  # a number is taken for the parameter of Kaiser's window
        refuse(who, "window", name, "one of scipy.signal.get_window")
    return shape
