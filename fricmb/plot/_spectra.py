"""Pictures of spectra: density with its peaks, running spectra over frequency and over order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm

from fricmb.analysis import (
    AnalysisError,
    OrderMap,
    Peaks,
    Samples,
    Spectrogram,
    maximum_entropy_spectrum,
    spectral_peaks,
)
from fricmb.plot._style import THIN, finish, paint, remark
from fricmb.plot._units import Units, bare

#: Decades of power that a map shows.
_DECADES = 8
#: Peaks that are marked at most, those of most power, and those whose frequency is told.
_PEAKS, _TOLD = 20, 3
#: Frequencies that are told lie at least this share of the axis apart.
_APART = 0.1


@dataclass(frozen=True, kw_only=True)
class Axis:
    """A frequency axis: what angular frequency is divided by, and what it is called."""

    divisor: float
    label: str
    unit: str

    @classmethod
    def of(cls, hz: bool, units: Units) -> Axis:
        """Frequency in turns, or angular frequency."""
        if hz:
            return cls(divisor=2.0 * np.pi, label=f"frequency [{units.frequency}]", unit=units.frequency)
        return cls(divisor=1.0, label=f"angular frequency [{units.angular_frequency}]", unit=units.angular_frequency)


def density_label(name: str, unit: str, axis: str) -> str:
    """What a power density is, with its unit where the signal has one; ``axis``: unit of what it is over."""
    if not bare(f"[{unit}]") or not bare(f"[{axis}]"):
        return f"power density of {name}"
    squared = f"({unit})²" if "/" in unit or " " in unit else f"{unit}²"
    below = f"({axis})" if "/" in axis else axis
    return f"power density of {name} [{squared}/{below}]"


def draw_spectrum(signal: Samples, highest: float | None, ax: Axes, axis: Axis, unit: str = "") -> Peaks:
    """Maximum-entropy density up to a frequency; peaks marked, with their standard errors as bars.

    ``highest`` is a frequency of that axis.
    """
    omega, power = maximum_entropy_spectrum(signal.x, signal.dt)
    peaks = spectral_peaks(signal.x, signal.dt)
    top = np.pi / signal.dt if highest is None else highest * axis.divisor
    shown = omega <= top
    ax.semilogy(omega[shown] / axis.divisor, power[shown] * axis.divisor, color=paint().stick, linewidth=THIN)
    named = np.flatnonzero(peaks.omega <= top)
    named = named[np.argsort(-peaks.power[named], kind="stable")[:_PEAKS]]
    bars = np.where(np.isfinite(peaks.uncertainty), peaks.uncertainty, 0.0)[named] / axis.divisor
    at, height = peaks.omega[named] / axis.divisor, peaks.height[named] * axis.divisor
    ax.errorbar(at, height, xerr=bars, fmt=".", color=paint().slip, markersize=4, label="peaks")
    told: list[float] = []
    for x, y in zip(at.tolist(), height.tolist(), strict=True):
        if len(told) == _TOLD or min((abs(x - other) for other in told), default=np.inf) < _APART * top / axis.divisor:
            continue
        told.append(x)
        ax.annotate(f"{x:.4g}", (x, y), xytext=(4, 3), textcoords="offset points", fontsize="x-small")
    finish(ax, x=axis.label, y=density_label(signal.name, unit, axis.unit), legend=bool(named.size))
    ax.margins(y=0.08)
    return peaks


def draw_spectrogram(
    running: Spectrogram, name: str, highest: float | None, ax: Axes, axis: Axis, time: str, unit: str = ""
) -> None:
    """Density over time and frequency; ``highest`` is a frequency of that axis."""
    shown = running.omega <= (running.omega[-1] if highest is None else highest * axis.divisor)
    power = running.power[shown] * axis.divisor
    _map(ax, running.t, running.omega[shown] / axis.divisor, power, density_label(name, unit, axis.unit))
    ax.set_xlabel(bare(time))
    ax.set_ylabel(bare(axis.label))


def draw_orders(found: OrderMap, name: str, ax: Axes, units: Units, hz: bool) -> None:
    """Density over time and order."""
    divisor = 2.0 * np.pi if hz else 1.0
    if np.ma.getmaskarray(found.power).all():
        raise AnalysisError(
            "orders: got a stretch in which no order is seen: nothing slides, or orders lie beyond what is sampled; "
            "expected one in which the contact slides, or a smaller highest="
        )
    _map(ax, found.t, found.order / divisor, found.power * divisor, f"power density of {name}")
    ax.set_xlabel(bare(f"time [{units.time}]"))
    per = "1" if units.dimensionless else f"1/{units.length}"
    radians = "1" if per == "1" else f"rad{per[1:]}"
    ax.set_ylabel(bare(f"order: swings per length slid [{per}]" if hz else f"order [{radians}]"))
    remark(ax, ("order = frequency / sliding speed" if hz else "order = angular frequency / sliding speed"))


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
    ax.grid(False)
    ax.figure.colorbar(mesh, ax=ax, label=label)
