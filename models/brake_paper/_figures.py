"""Figures 2 to 12: what each shows, our picture, our numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from matplotlib.figure import Figure

import fricmb as fm
from fricmb.models.brake4dof import CASES
from fricmb.models.brake_paper._measures import Finding, spikes
from fricmb.plot import BLUE, ORANGE, finish

from . import _findings as find
from ._draw import across, enlarge_across, page, page_with_close, spectrum, velocities, window, write_places

OMEGA1, OMEGA2 = "Omega1", "Omega2"
#: A few swings across, where the whole run is a band.
ENLARGED = (300.0, 310.0)


@dataclass(frozen=True, kw_only=True)
class PaperFigure:
    """One figure of the source.

    Attributes
    ----------
    number : int
    case : str
    shows : str
        What it shows, in our words.
    draw : callable
        ``draw(sol)`` -> Figure.
    check : callable
        ``check(sol)`` -> list of Finding.
    """

    number: int
    case: str
    shows: str
    draw: Callable[[fm.Solution], Figure]
    check: Callable[[fm.Solution], list[Finding]]

    @property
    def title(self) -> str:
        """Number and case."""
        return f"Figure {self.number}, case {self.case}"


def _frequencies(case: str) -> dict[str, float]:
    return dict(zip((OMEGA1, OMEGA2), CASES[case][:2], strict=True))


def _two_velocities(sol: fm.Solution) -> Figure:
    figure, (top, bottom) = page(2)
    whole = window(sol, 0.0, sol.t_end)
    velocities(top, whole, "x")
    velocities(bottom, whole, "y")
    return figure


def _first_y_velocities(sol: fm.Solution) -> Figure:
    figure, (ax,) = page(1)
    velocities(ax, window(sol, 0.0, 30.0), "y")
    return figure


def _four_panels(case: str, prominence: float = 10.0) -> Callable[[fm.Solution], Figure]:
    def four(sol: fm.Solution) -> Figure:
        figure, axes = page(2, 2)
        whole = window(sol, 0.0, sol.t_end)
        velocities(axes[0], whole, "x")
        velocities(axes[1], whole, "y")
        across(axes[2], whole)
        spectrum(axes[3], spikes(sol, prominence=prominence), named=_frequencies(case))
        return figure

    return four


def _close_y1(sol: fm.Solution) -> Figure:
    figure, (ax,) = page(1)
    across(ax, window(sol, *find.CLOSE))
    return figure


def _x_and_y1(sol: fm.Solution) -> Figure:
    figure, (top, bottom), beside = page_with_close(1, height=2.6)
    whole = window(sol, 0.0, sol.t_end)
    velocities(top, whole, "x")
    across(bottom, whole)
    enlarge_across(bottom, beside, window(sol, *ENLARGED))
    return figure


def _spectrum(case: str, low: float, high: float) -> Callable[[fm.Solution], Figure]:
    def one(sol: fm.Solution) -> Figure:
        figure, (ax,) = page(1, height=3.8)
        found = spikes(sol)
        spectrum(ax, found, named=_frequencies(case), low=low, high=high)
        write_places(ax, found, low, high)
        return figure

    return one


def _y1_and_spectrum(case: str) -> Callable[[fm.Solution], Figure]:
    def both(sol: fm.Solution) -> Figure:
        figure, (top, bottom), beside = page_with_close(0, height=3.0)
        across(top, window(sol, 0.0, sol.t_end))
        enlarge_across(top, beside, window(sol, *ENLARGED))
        found = spikes(sol)
        spectrum(bottom, found, named=_frequencies(case))
        if case == "3b":
            write_places(bottom, found, 10.5, 21.0)
        return figure

    return both


def _angle(sol: fm.Solution) -> Figure:
    figure, (ax,) = page(1, height=3.4)
    seen = window(sol, *find.CLOSE)
    force = seen.force("lining")
    slip, angle = -seen.relative_velocity("lining")[0], np.degrees(np.arctan2(force[1], force[0]))
    ax.plot(seen.t, angle, color=BLUE, linewidth=0.9, label="angle of the friction force")
    finish(ax, x="time [1]", y="angle [degrees]", legend=True)
    other = ax.twinx()
    other.plot(seen.t, slip, "--", color=ORANGE, linewidth=0.9)
    other.set_ylabel("slip along x (dashed)")
    return figure


_ALL = (
    PaperFigure(
        number=2, case="1", draw=_two_velocities, check=find.figure2,
        shows="Velocities along x: the rotor is braked almost linearly while the pad's swings, sticking and slipping,"
        " fill the wedge below it. Velocities along y: a single slow swing of both, hardly disturbed.",
    ),
    PaperFigure(
        number=3, case="1", draw=_first_y_velocities, check=find.figure3,
        shows="The first swings along y: pad and rotor together, stick-slip barely to be seen.",
    ),
    PaperFigure(
        number=4, case="2", draw=_four_panels("2"), check=find.figure4,
        shows="Braking along x as in case 1; across, the pad is kicked in a regular train. The spectrum of y1 is a row"
        " of spikes 1 apart that fall faster past Omega1, where there is no peak.",
    ),
    PaperFigure(
        number=5, case="2", draw=_close_y1, check=find.figure5,
        shows="A few kicks close up: each is followed by a small decaying oscillation at a higher frequency.",
    ),
    PaperFigure(
        number=6, case="3", draw=_x_and_y1, check=find.figure6,
        shows="Braking along x is unaffected by the frequencies across; y1 is kicked again, with more structure.",
    ),
    PaperFigure(
        number=7, case="3", draw=_spectrum("3", 0.0, 16.5), check=find.figure7,
        shows="Peaks 1 apart, shifted by Omega2 (visible: 0.07), that grow from Omega1 to Omega2 and fall after; none"
        " at Omega1.",
    ),
    PaperFigure(
        number=8, case="3b", draw=_y1_and_spectrum("3b"), check=find.figure8,
        shows="The same with other frequencies: the shift is again Omega2, 15.81.",
    ),
    PaperFigure(
        number=9, case="4", draw=_y1_and_spectrum("4"), check=find.figure9,
        shows="Peaks grow up to Omega2, fall after, and fall faster past Omega1.",
    ),
    PaperFigure(
        number=10, case="4", draw=_spectrum("4", 4.0, 12.5), check=find.figure10,
        shows="A part of it: the peaks are shifted by Omega2, to k + 0.07.",
    ),
    PaperFigure(
        number=11, case="5", draw=_four_panels("5", 2.0), check=find.figure11,
        shows="Case 2 with damping: the train of kicks is weaker, and its onset is delayed.",
    ),
    PaperFigure(
        number=12, case="2", draw=_angle, check=find.figure12,
        shows="The angle of the friction force peaks, by less than 1 degree, slightly after each valley of the slip"
        " along x, before and after the first stick.",
    ),
)  # fmt: skip

#: Figures of the source by their number.
FIGURES = MappingProxyType({figure.number: figure for figure in _ALL})
