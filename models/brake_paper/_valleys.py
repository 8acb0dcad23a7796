"""The mechanism: valleys of the slip along x, and what the friction force does across in each of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

import fricmb as fm

Floats = NDArray[np.float64]
_POINTS = 6001


@dataclass(frozen=True, kw_only=True)
class Valleys:
    """A row for each valley of the slip along x, one in every period 2 pi of the pad; all (n_valleys,).

    Attributes
    ----------
    begin, end : where the slip is least: one time, or the stretch over which the lining sticks.
    least : least slip along x.
    peak : time of the largest angle of the friction force around the valley, while it slips.
    angle : that angle in degrees, signed, from the x direction.
    impulse : momentum that the friction force brings to the pad across within 1 to both sides of the valley's begin,
        less what its mean over the rest of the period would bring.
    """

    begin: Floats
    end: Floats
    least: Floats
    peak: Floats
    angle: Floats
    impulse: Floats

    @property
    def sticks(self) -> NDArray[np.bool_]:
        """Valleys that reach down to stick."""
        return self.least <= 1e-9

    @property
    def lag(self) -> Floats:
        """By how much the angle's peak comes after the end of the valley."""
        return self.peak - self.end


def valleys(sol: fm.Solution) -> Valleys:
    """Every valley of a run of the brake, from its dense output."""
    rows = []
    middle = _first_valley(sol)
    while middle + np.pi < sol.t_end:
        row = _valley(sol, middle)
        rows.append(row)
        middle = row[0] + 2 * np.pi
    columns = np.array(rows).reshape(-1, 6).T
    return Valleys(
        begin=columns[0], end=columns[1], least=columns[2], peak=columns[3], angle=columns[4], impulse=columns[5]
    )


def _first_valley(sol: fm.Solution) -> float:
    """In the first whole period after the start."""
    t = np.linspace(sol.t_start + np.pi, sol.t_start + 3 * np.pi, _POINTS)
    return float(t[np.argmin(-sol.at(t).relative_velocity("lining")[0])])


def _valley(sol: fm.Solution, middle: float) -> tuple[float, ...]:
    t = np.linspace(middle - np.pi, min(middle + np.pi, sol.t_end), _POINTS)
    seen = sol.at(t)
    slip = -seen.relative_velocity("lining")[0]
    force = seen.force("lining")
    near = np.abs(t - middle) < 0.5 * np.pi
    least = float(slip[near].min())
    low = np.flatnonzero(near & (slip <= least + 1e-12))
    begin, end = float(t[low[0]]), float(t[low[-1]])
    sideways = np.degrees(np.arctan2(force[1], force[0]))
    around = (np.abs(t - middle) < 0.5 * np.pi) & (seen.mode("lining") == 1)
    k = int(np.flatnonzero(around)[np.argmax(np.abs(sideways[around]))]) if around.any() else int(low[0])
    return begin, end, max(least, 0.0), float(t[k]), float(sideways[k]), _impulse(t, force[1], middle)


def _impulse(t: Floats, across: Floats, middle: float) -> float:
    """Integral around the valley of what stands out of the force far from it."""
    inside = np.abs(t - middle) < 1.0
    background = float(np.mean(across[~inside]))
    return float(np.trapezoid(np.where(inside, across - background, 0.0), t))
