"""Pictures of a body beside measurements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._arguments import refuse
from fricmb.plot._style import THIN, drawn, figure_of, finish, paint, panels

if TYPE_CHECKING:
    from fricmb.measure import Comparison


CYCLES = "cycles per unit of time"
#: Pairs of modes whose numbers are written.
MOST = 120


class ComparisonPlots:
    """Pictures of a comparison: ``found.plot.mac()``.

    Parameters
    ----------
    found : Comparison
    """

    def __init__(self, found: Comparison) -> None:
        self.found = found

    @drawn
    def mac(self, *, ax: Axes | None = None) -> Figure:
        """Likeness of the shapes of body and test, from 0 to 1.

        Parameters
        ----------
        ax : Axes, optional
        """
        mac = self.found.mac
        if not mac.size:
            refuse("mac", "found", "no modes", "a comparison with modes")
        axes = panels(1, ax, height=4.2)
        image = axes[0].imshow(mac, origin="lower", cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
        axes[0].set_xticks(
            range(mac.shape[1]), [f"{w / (2 * np.pi):.5g}" for w in self.found.frequencies[1]], rotation=60
        )
        axes[0].set_yticks(range(mac.shape[0]), [f"{w / (2 * np.pi):.5g}" for w in self.found.frequencies[0]])
        axes[0].figure.colorbar(image, ax=axes[0], label="modal assurance criterion")
        for (i, j), value in np.ndenumerate(mac if mac.size <= MOST else np.zeros((0, 0))):
            axes[0].text(j, i, f"{value:.2f}", ha="center", va="center", color="white" if value > 0.6 else "black")
        finish(axes[0], x=f"test, {CYCLES}", y=f"body, {CYCLES}")
        axes[0].grid(visible=False)
        return figure_of(axes)

    @drawn
    def responses(self, number: int = 0, *, ax: Axes | None = None) -> Figure:
        """One response, measured and of the body.

        Parameters
        ----------
        number : int
            Which of ``responses``.
        ax : Axes, optional
        """
        if not 0 <= number < len(self.found.responses):
            refuse("responses", "number", number, f"from 0 to {len(self.found.responses) - 1}")
        measured, values = self.found.responses[number]
        axes = panels(1, ax, height=3.8)
        axes[0].semilogy(measured.f, np.abs(measured.values), linewidth=THIN, color=paint().stick, label="measured")
        axes[0].semilogy(measured.f, np.abs(values), linewidth=THIN, color=paint().slip, label="body")
        what = f"{measured.kind} {measured.node}.{measured.axis} over {measured.reference}.{measured.reference_axis}"
        finish(axes[0], x=f"frequency, {CYCLES}", y=what, legend=True)
        return figure_of(axes)
