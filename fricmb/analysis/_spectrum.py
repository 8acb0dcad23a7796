"""Maximum-entropy spectrum: an autoregressive model fitted by Burg's method."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from fricmb._calls import answers
from fricmb.analysis._burg import CRITERIA, Autoregression, burg
from fricmb.analysis._errors import Floats, checked_frequencies, checked_integer, checked_samples
from fricmb.errors import unknown_name

#: Largest order chosen by default: high orders split sharp peaks.
DEFAULT_ORDER = 300
_WHO = "maximum_entropy_spectrum"


@answers
def maximum_entropy_spectrum(
    x: ArrayLike, dt: float, *, order: int | str | None = None, omega: ArrayLike | None = None
) -> tuple[Floats, Floats]:
    """Power spectral density of a uniformly sampled signal by the maximum-entropy (Burg) method.

    Parameters
    ----------
    x : (n,) array_like
        Samples; their mean is taken off.
    dt : float
        Sampling interval.
    order : int or {"FPE", "AIC", "MDL"}, optional
        Order of the autoregressive model, 1 to n-1, or the criterion that chooses it among orders up to 300 or a third
        of n, whichever is smaller: Akaike's final prediction error, Akaike's information criterion, Rissanen's minimum
        description length.  Default: "FPE".  A higher order resolves closer peaks; too high a one splits a peak in two.
        Signals without noise, as runs are, often have no best order: the criteria then take one near the largest
        allowed.
    omega : (n_omega,) array_like, optional
        Angular frequencies from 0 to pi/dt.  Default: an equidistant grid over that range, eight times as fine as the
        signal's own resolution, and more points at peaks that are narrower than that.

    Returns
    -------
    omega : (n_omega,)
    power : (n_omega,)
        One-sided density over omega: its integral from 0 to pi/dt is the variance of x.

    Raises
    ------
    AnalysisError
        A frequency outside 0 to pi/dt, an order that the data cannot carry, samples that are not finite.
    UnknownNameError
        A criterion that is not known.

    Notes
    -----
    J. P. Burg, Maximum entropy spectral analysis, 37th meeting of the Society of Exploration Geophysicists (1967).
    The model ends before ``order`` where the signal is predicted to round-off, as a few sines without noise are.
    """
    model = autoregression(_WHO, x, dt, order)
    if omega is None:
        return density_of(model, len(np.asarray(x)), dt)
    grid = checked_frequencies(_WHO, omega, dt)
    return grid, model.density(grid, dt)


def autoregression(who: str, x: ArrayLike, dt: float, order: int | str | None) -> Autoregression:
    """The model behind the spectrum."""
    samples = checked_samples(who, x, dt)
    n = len(samples)
    largest = max(1, min(DEFAULT_ORDER, n // 3))
    if order is None or isinstance(order, str):
        criterion = "FPE" if order is None else order
        if criterion not in CRITERIA:
            raise unknown_name(f"criterion for the order of {who}", order, CRITERIA)
        return burg(samples, largest, criterion)
    return burg(samples, checked_integer(who, "order", order, 1, n - 1))


def density_of(model: Autoregression, n: int, dt: float) -> tuple[Floats, Floats]:
    """Density at equidistant frequencies, and at more around the poles that are nearer to the unit circle."""
    nyquist = np.pi / dt
    count = 4 * 2 ** int(np.ceil(np.log2(max(n, 2 * model.order)))) + 1
    even = np.linspace(0.0, nyquist, count)
    with np.errstate(divide="ignore"):
        density = model.variance * dt / np.pi / np.abs(np.fft.rfft(model.a, 2 * (count - 1))) ** 2
    sharp = np.unique(_around_poles(model, nyquist / (count - 1), dt))
    sharp = np.setdiff1d(sharp[(sharp > 0.0) & (sharp < nyquist)], even)
    grid = np.concatenate([even, sharp])
    order = np.argsort(grid, kind="stable")
    return grid[order], np.concatenate([density, model.density(sharp, dt)])[order]


def _around_poles(model: Autoregression, spacing: float, dt: float) -> Floats:
    """Frequencies around the poles whose width is less than a few spacings."""
    if model.order == 0:
        return np.zeros(0)
    poles = np.roots(model.a)
    poles = poles[poles.imag >= 0.0]
    with np.errstate(divide="ignore"):
        width = np.abs(np.log(np.abs(poles))) / dt
    sharp = width < 4 * spacing
    if not sharp.any():
        return np.zeros(0)
    centre, width = np.angle(poles[sharp]) / dt, np.maximum(width[sharp], 1e-15 * np.pi / dt)
    # from a twentieth of the half-width of each peak to where the even grid takes over
    away = width[:, None] * np.geomspace(0.05, np.maximum(4 * spacing / width, 1.0), 250).T
    return np.concatenate([(centre[:, None] - away).ravel(), centre, (centre[:, None] + away).ravel()])
