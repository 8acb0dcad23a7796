"""Pictures of the stability of steady sliding."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._style import DARK, NAMED_CURVES, figure_of, finish, line, panels

if TYPE_CHECKING:
    from fricmb.analysis import Eigenvalues, StabilityMap


def eigenvalues(found: Eigenvalues) -> Figure:
    """Frequencies and growth rates of the modes over the parameter, critical values as vertical lines.

    Parameters
    ----------
    found : Eigenvalues
        Of :func:`fricmb.analysis.complex_eigenvalues`.
    """
    top, bottom = panels(2, None, height=5.2, sharex=True)
    count = found.eigenvalues.shape[1]
    for k in range(count):
        moves = found.dofs[int(np.argmax(np.abs(found.shapes[0, k])))]
        top.plot(found.values, found.frequency[:, k], label=f"{k}: {moves}", **line(k, count))
        bottom.plot(found.values, found.growth[:, k], **line(k, count))
    for panel in (top, bottom):
        for critical in found.critical:
            panel.axvline(critical.value, color=DARK, linewidth=0.7, linestyle=":")
    bottom.axhline(0.0, color=DARK, linewidth=0.7)
    finish(top, x="", y="angular frequency", legend=0 < count <= NAMED_CURVES)
    finish(bottom, x=found.over, y="growth rate")
    return figure_of([top, bottom])


def stability(found: StabilityMap, *, ax: Axes | None = None) -> Figure:
    """Largest growth rate over two parameters; the border of stability as a line, unstable modes hatched by number.

    Parameters
    ----------
    found : StabilityMap
        Of :func:`fricmb.analysis.stability_map`.
    ax : Axes, optional
    """
    (panel,) = panels(1, ax, height=4.2)
    y, x = found.values
    largest = float(np.abs(found.growth).max()) or 1.0
    filled = panel.contourf(
        x, y, found.growth, levels=np.linspace(-largest, largest, 15), cmap="PuOr_r", vmin=-largest, vmax=largest
    )
    if found.unstable.any():
        panel.contourf(x, y, found.unstable, levels=[0.5, np.inf], colors="none", hatches=["//"])
    if found.growth.min() < 0.0 < found.growth.max():
        panel.contour(x, y, found.growth, levels=[0.0], colors=[DARK], linewidths=1.4)
    figure_of([panel]).colorbar(filled, ax=panel, label="largest growth rate (hatched: unstable)")
    panel.set_xlabel(found.over[1])
    panel.set_ylabel(found.over[0])
    return figure_of([panel])
