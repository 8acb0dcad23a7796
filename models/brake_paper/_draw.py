"""What the figures share: panels of signals and spectra."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.models.brake_paper._measures import Spikes
from fricmb.plot import BLUE, DARK, ORANGE, THIN, finish
from fricmb.plot._figure import new_picture, offer

#: Long signals are drawn from this many points.
POINTS = 20_000
#: Frequencies that are written lie at least this share of the axis apart.
APART = 0.02


def page(rows: int, columns: int = 1, *, height: float = 2.6) -> tuple[Figure, list[Axes]]:
    """A figure with panels, row by row."""
    figure = new_picture(4.6 * columns + 2.6, height * rows + 0.4)
    offer(figure)
    return figure, list(figure.subplots(rows, columns, squeeze=False).ravel())


@lru_cache(maxsize=32)
def window(sol: fm.Solution, begin: float, end: float) -> fm.Solution:
    """The run between two times, at enough of them for curves."""
    return sol.at(np.linspace(begin, min(end, sol.t_end), POINTS))


def velocities(ax: Axes, sol: fm.Solution, letter: str) -> None:
    """Pad (solid) and rotor (dashed) along x or y."""
    ax.plot(sol.t, sol.velocity(f"pad.{letter}"), color=BLUE, linewidth=0.6, label="pad")
    ax.plot(sol.t, sol.velocity(f"rotor.{letter}"), "--", color=ORANGE, linewidth=1.2, label="rotor")
    finish(ax, x="time [1]", y=f"velocity along {letter} [1]", legend=True)


def page_with_close(row: int, *, height: float) -> tuple[Figure, list[Axes], Axes]:
    """A figure of two rows, of which one has a narrow panel beside it for an enlarged part."""
    figure = new_picture(7.2, 2.0 * height + 0.4)
    offer(figure)
    grid = figure.add_gridspec(2, 4)
    panels = [figure.add_subplot(grid[k, :3] if k == row else grid[k, :]) for k in range(2)]
    return figure, panels, figure.add_subplot(grid[row, 3], sharey=panels[row])


def across(ax: Axes, sol: fm.Solution) -> None:
    """The pad's position across."""
    ax.plot(sol.t, sol["pad.y"], color=BLUE, linewidth=0.6)
    finish(ax, x="time [1]", y="y1 [1]")


def enlarge_across(ax: Axes, beside: Axes, sol: fm.Solution) -> None:
    """A part of the pad's position across, enlarged; shaded where it is from."""
    across(beside, sol)
    beside.set_ylabel("")
    beside.tick_params(labelleft=False)
    beside.set_title("enlarged", loc="right", fontsize="small")
    ax.axvspan(float(sol.t[0]), float(sol.t[-1]), color=DARK, alpha=0.25, linewidth=0.0)


def spectrum(ax: Axes, found: Spikes, *, named: dict[str, float], low: float = 0.0, high: float = 22.0) -> None:
    """Density over frequency with the peaks, and frequencies by name."""
    part = (found.omega >= low) & (found.omega <= high)
    ax.semilogy(found.omega[part], found.power[part], color=BLUE, linewidth=THIN)
    peaks = (found.peaks.omega >= low) & (found.peaks.omega <= high)
    ax.semilogy(found.peaks.omega[peaks], found.peaks.height[peaks], ".", color=DARK, markersize=4, label="peaks")
    for i, (name, omega) in enumerate(named.items()):
        ax.axvline(omega, color=ORANGE, linestyle=("--", ":")[i % 2], linewidth=1.2, label=name)
    finish(ax, x="angular frequency [1]", y="power density of y1 [1]", legend=True)


def write_places(ax: Axes, found: Spikes, low: float, high: float) -> None:
    """The frequency beside each peak; of peaks whose frequencies would stand on one another beside the highest."""
    told: list[float] = []
    for i in np.argsort(-found.peaks.height):
        omega, height = float(found.peaks.omega[i]), float(found.peaks.height[i])
        if low <= omega <= high and min((abs(omega - other) for other in told), default=np.inf) > APART * (high - low):
            told.append(omega)
            ax.annotate(
                f"{omega:.2f}",
                (omega, height),
                xytext=(0, 3),
                textcoords="offset points",
                fontsize=7,
                ha="center",
                va="bottom",
                rotation=90,
                bbox={"facecolor": ax.get_facecolor(), "edgecolor": "none", "pad": 0.4},
            )
    bottom, top = ax.get_ylim()
    ax.set_ylim(bottom, top * 30)
