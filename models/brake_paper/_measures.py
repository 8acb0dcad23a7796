"""Numbers for what the source says about spectra."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

import fricmb as fm
from fricmb.analysis import Peaks, maximum_entropy_spectrum, spectral_peaks, uniform

Floats = NDArray[np.float64]

#: Sampling of y1 and order of its autoregressive model for all spectra.
DT, ORDER = 0.05, 300


@dataclass(frozen=True, kw_only=True)
class Finding:
    """A statement of the source, what we find, and whether they agree."""

    statement: str
    found: str
    agrees: bool

    def __str__(self) -> str:
        return f"[{'agrees' if self.agrees else 'DIFFERS'}] {self.statement}: {self.found}"


@dataclass(frozen=True, kw_only=True)
class Spikes:
    """Spectrum of y1 and its peaks.

    Attributes
    ----------
    omega, power : (n_omega,)
        The density over angular frequency.
    peaks : Peaks
    """

    omega: Floats
    power: Floats
    peaks: Peaks

    def level(self, omega: float) -> float:
        """Density at a frequency in dB."""
        return float(10 * np.log10(np.interp(omega, self.omega, self.power)))

    def part(self, low: float, high: float) -> tuple[Floats, Floats]:
        """Places and powers of the peaks within a range."""
        inside = (self.peaks.omega > low) & (self.peaks.omega < high)
        return self.peaks.omega[inside], self.peaks.power[inside]


@lru_cache(maxsize=32)
def spikes(sol: fm.Solution, *, dt: float = DT, order: int = ORDER, prominence: float = 10.0) -> Spikes:
    """Maximum-entropy spectrum of the pad's motion across, up to 22, and its peaks."""
    signal = uniform(sol, "pad.y", dt)

    def estimate(x: Floats, dt: float) -> tuple[Floats, Floats]:
        return maximum_entropy_spectrum(x, dt, order=order, omega=np.linspace(0.0, 22.0, 22001))

    omega, power = estimate(signal.x, dt)
    return Spikes(
        omega=omega, power=power, peaks=spectral_peaks(signal.x, dt, estimate=estimate, prominence=prominence)
    )


def shift_of(places: Floats) -> tuple[float, float]:
    """Mean shift of peaks from whole numbers, 0 to 1, and its standard deviation, both on the circle."""
    mean = np.exp(2j * np.pi * places).mean()
    spread = np.sqrt(-2 * np.log(min(float(np.abs(mean)), 1.0))) / (2 * np.pi)
    return float(np.angle(mean) / (2 * np.pi) % 1.0), float(spread)


def slope(places: Floats, powers: Floats) -> float:
    """Change of the power of peaks in dB per unit of frequency, by least squares."""
    return float(np.polyfit(places, 10 * np.log10(powers), 1)[0])


def apart(places: Floats) -> Finding:
    """The peaks are one apart: the slope of their places over whole numbers."""
    number = np.round(places - shift_of(places)[0])
    spacing, start = np.polyfit(number, places, 1)
    scatter = float(np.std(places - start - spacing * number))
    return Finding(
        statement="peaks are 1 apart (the pad's frequency along x)",
        found=f"{spacing:.4f} apart over {len(places)} peaks, scatter {scatter:.3f}",
        agrees=abs(spacing - 1) < 0.01 and scatter < 0.05,
    )


def shifted(places: Floats, Omega2: float) -> Finding:
    """The peaks are shifted by Omega2."""
    found, spread = shift_of(places)
    difference = (found - Omega2 + 0.5) % 1.0 - 0.5
    return Finding(
        statement=f"peaks are shifted by Omega2 = {Omega2:.4g}, that is by {Omega2 % 1.0:.3f}",
        found=f"{found:.3f}, scatter {spread:.3f}",
        agrees=abs(difference) < max(0.01, 2 * spread),
    )


def silent(found: Spikes, Omega1: float) -> Finding:
    """There is no peak at Omega1."""
    nearest = found.peaks.omega[found.peaks.near(Omega1)]
    below = found.level(float(nearest)) - found.level(Omega1)
    return Finding(
        statement=f"no peak at Omega1 = {Omega1:.4g}, the pad's own frequency across",
        found=f"nearest peak at {nearest:.3f}; the density at Omega1 is {below:.0f} dB below it",
        agrees=bool(abs(nearest - Omega1) > 0.2 and below > 3),
    )


def trend(found: Spikes, low: float, high: float, *, rising: bool) -> Finding:
    """Peaks grow or fall from one frequency to another."""
    places, powers = found.part(low, high)
    rate = slope(places, powers)
    return Finding(
        statement=f"peaks {'grow' if rising else 'fall'} from {low:.4g} to {high:.4g}",
        found=f"{rate:+.1f} dB per unit of frequency over {len(places)} peaks",
        agrees=(rate > 0) == rising,
    )


def steeper(found: Spikes, low: float, middle: float, high: float) -> Finding:
    """Peaks fall faster past a frequency."""
    before, after = slope(*found.part(low, middle)), slope(*found.part(middle - 0.6, high))
    return Finding(
        statement=f"peaks fall faster past Omega1 = {middle:.4g}",
        found=f"{before:+.1f} dB per unit before, {after:+.1f} after (to {high:.4g})",
        agrees=after < before < 0,
    )
