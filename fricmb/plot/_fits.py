"""Pictures of a fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._style import drawn, figure_of, finish, paint, panels, remark
from fricmb.plot._units import bare, unit_in_scene

if TYPE_CHECKING:
    from fricmb._fit import Fit
    from fricmb._fit._data import Measured


class FitPlots:
    """Pictures of a fit: ``found.plot.residuals()``, ``found.plot.curves()``.

    Parameters
    ----------
    fit : Fit
    """

    def __init__(self, fit: Fit) -> None:
        self.fit = fit

    @drawn
    def residuals(self, *, ax: Axes | None = None) -> Figure:
        """Prediction less measurement over time, a panel for each quantity; with ``ax`` the first alone.

        Residuals that swing instead of scattering say that the scene lacks something, not only its parameters.
        """
        shown = self.fit.measured if ax is None else self.fit.measured[:1]
        axes = panels(len(shown), ax)
        for panel, m in zip(axes, shown, strict=True):
            residual = self.fit.residuals[m.name]
            panel.axhline(0.0, color=paint().quiet, linewidth=0.8)
            panel.plot(_times(m), residual, ".", color=paint().slip, markersize=4)
            finish(panel, x="", y=f"{m.name}: predicted - measured [{self._unit(m)}]")
            remark(panel, f"standard deviation {residual.std():.3g}")
        axes[-1].set_xlabel(bare(f"time [{self.fit.scene.units.time}]"))
        return figure_of(axes)

    @drawn
    def curves(self, *, ax: Axes | None = None) -> Figure:
        """Measured signals as dots and the fitted run as a curve; with ``ax`` the first alone."""
        signals = [m for m in self.fit.measured if m.kind == "signal"]
        axes = panels(max(len(signals), 1), ax, sharex=True) if ax is None else [ax]
        sol = self.fit.solution
        for panel, m in zip(axes, signals, strict=False):
            assert sol is not None
            t = np.linspace(sol.t_start, sol.t_end, 2000)
            x = m.x - self.fit.offsets.get(m.name, 0.0)
            panel.plot(m.t, x, ".", color=paint().slip, markersize=4, label="measured")
            panel.plot(t, sol.at(t).scalar(m.name), color=paint().stick, linewidth=1.0, label="fitted")
            finish(panel, x="", y=f"{m.name} [{self._unit(m)}]", legend=True)
        axes[-1].set_xlabel(bare(f"time [{self.fit.scene.units.time}]"))
        return figure_of(axes)


    def _unit(self, m: Measured) -> str:
        """Of a signal; of periods and times of transitions that of time."""
        scene = self.fit.scene
        return unit_in_scene(scene, m.name) if m.kind == "signal" else scene.units.time


def _times(m: Measured) -> np.ndarray:
    return np.arange(m.x.size, dtype=float) if m.kind == "period" else m.t
