"""Pictures of spectra: density with its peaks, running spectra over frequency and over order."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from fricmb.analysis import OrderMap, Peaks, Samples, Spectrogram, maximum_entropy_spectrum, spectral_peaks
from fricmb.plot._style import BLUE, ORANGE, THIN, finish
from fricmb.plot._units import Units

#: Decades of power that a map shows.
_DECADES = 8


def draw_spectrum(signal: Samples, highest: float | None, ax: Axes, units: Units) -> Peaks:
    """Maximum-entropy density up to a frequency; peaks marked, with their standard errors as bars."""
    omega, power = maximum_entropy_spectrum(signal.x, signal.dt)
    peaks = spectral_peaks(signal.x, signal.dt)
    top = np.pi / signal.dt if highest is None else highest
    shown, named = omega <= top, peaks.omega <= top
    ax.semilogy(omega[shown], power[shown], color=BLUE, linewidth=THIN)
    bars = np.where(np.isfinite(peaks.uncertainty), peaks.uncertainty, 0.0)[named]
    ax.errorbar(peaks.omega[named], peaks.height[named], xerr=bars, fmt=".", color=ORANGE, markersize=4, label="peaks")
    finish(
        ax,
        x=f"angular frequency [1/{units.time}]",
        y=f"power density of {signal.name}",
        legend=bool(named.any()),
    )
    return peaks


def draw_spectrogram(running: Spectrogram, name: str, highest: float | None, ax: Axes, units: Units) -> None:
    """Density over time and frequency."""
    shown = running.omega <= (running.omega[-1] if highest is None else highest)
    _map(ax, running.t, running.omega[shown], running.power[shown], f"power density of {name}")
    ax.set_xlabel(f"time [{units.time}]")
    ax.set_ylabel(f"angular frequency [1/{units.time}]")


def draw_orders(found: OrderMap, name: str, ax: Axes, units: Units) -> None:
    """Density over time and order."""
    _map(ax, found.t, found.order, found.power, f"power density of {name}")
    ax.set_xlabel(f"time [{units.time}]")
    ax.set_ylabel(f"order [1/{units.length}]")


def _map(ax: Axes, x: Any, y: Any, power: Any, label: str) -> None:
    most = float(np.ma.max(power)) or 1.0
    mesh = ax.pcolormesh(
        x,
        y,
        np.ma.maximum(power, most * 10.0**-_DECADES),
        norm=LogNorm(most * 10.0**-_DECADES, most),
        cmap="cividis",
        shading="nearest",
        rasterized=True,
    )
    ax.figure.colorbar(mesh, ax=ax, label=label)
