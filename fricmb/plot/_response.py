"""Pictures of frequency responses."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import refuse
from fricmb.plot._branches import BranchPlots
from fricmb.plot._style import THIN, drawn, few_labels, figure_of, finish, paint, panels
from fricmb.plot._units import unit_in_scene
from fricmb.scene import parameter_unit

if TYPE_CHECKING:
    from fricmb.analysis import FrequencyResponse


class ResponsePlots:
    """Pictures of a frequency response: ``found.plot.amplitude()``.

    Parameters
    ----------
    found : FrequencyResponse
    """

    def __init__(self, found: FrequencyResponse) -> None:
        self.found = found

    @drawn
    def amplitude(self, contact: str | None = None, *, logarithmic: bool = True, ax: Axes | None = None) -> Figure:
        """The measure over the parameter, rising and falling; below it how long a contact sticks.

        Cycles that were followed are drawn beneath: stable ones solid, unstable ones dashed.

        Parameters
        ----------
        contact : str, optional
            Whose share of stick is shaded; default: the first.
        logarithmic : bool
            Both axes; where a value is 0 the axes are plain.
        ax : Axes, optional
            For the measure alone.
        """
        found = self.found
        if contact is not None and contact not in found.contacts:
            refuse("amplitude", "contact", contact, f"one of {', '.join(found.contacts)}")
        below = ax is None and bool(found.contacts)
        axes = panels(
            2 if below else 1, ax, height=4.6 if below else 3.8, sharex=True, height_ratios=[3, 1] if below else [1]
        )
        top = axes[0]
        if found.branch is not None:
            BranchPlots(found.branch).diagram(found.measure, ax=top)
        for values, marker, label, colour in (
            (found.up, ">", "rising", paint().stick), (found.down, "<", "falling", paint().slip),
        ):  # fmt: skip
            top.plot(found.values, values, marker=marker, markersize=3.5, linewidth=THIN, color=colour, label=label)
        both = np.concatenate([found.up, found.down])
        if logarithmic and np.nanmin(both) > 0.0 and found.values.min() > 0.0:
            top.set_yscale("log")
            top.set_xscale("log")
            few_labels(top.xaxis, float(found.values[0]), float(found.values[-1]))
            few_labels(top.yaxis, float(np.nanmin(both)), float(np.nanmax(both)))
        unit = unit_in_scene(found.scene, found.measure)
        over = f"{found.over} [{parameter_unit(found.scene, found.over)}]"
        finish(top, x="" if below else over, y=f"amplitude of {found.measure} [{unit}]", legend=True)
        if below:
            self._sticks(axes[1], found.contacts.index(contact) if contact else 0, over)
        return figure_of(axes)

    def _sticks(self, ax: Axes, k: int, over: str) -> None:
        found = self.found
        for share, colour, label in (
            (found.stick_up[k], paint().stick, "rising"), (found.stick_down[k], paint().slip, "falling"),
        ):  # fmt: skip
            ax.fill_between(found.values, 0.0, share, color=colour, alpha=0.35, linewidth=0.0, label=label)
        ax.set_ylim(0.0, 1.0)
        finish(ax, x=over, y=f"stick, {found.contacts[k]}")
