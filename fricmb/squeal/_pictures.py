"""Pictures of a study."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb import plot
from fricmb.analysis._eigenvalues import growing
from fricmb.plot._style import drawn, figure_of, finish, paint, panels

if TYPE_CHECKING:
    from fricmb.squeal import Feed, Growth, Study, Uncertainty


def overview(study: Study, ax: Axes | None = None) -> Figure:
    """The map over two parameters; eigenvalues over one."""
    if len(study.over) > 1 and min(study.shape) > 1:
        found: Figure = plot.stability(study.map, ax=ax)
        panel = found.axes[0] if ax is None else ax
        second = study.over[1]
        critical = [(t.at[second], t.value) for t in study.thresholds]
        if critical:  # to round-off, where the line between colours goes from place to place
            panel.plot(*zip(*critical, strict=True), "k.", markersize=5.0)
        return found
    return modes(study, ax)


@drawn
def modes(study: Study, ax: Axes | None = None) -> Figure:
    """Frequency of every mode over the first parameter, growing ones thick."""
    (panel,) = panels(1, ax, height=4.0)
    values, (n_a, n_b) = study.eigenvalues, study.shape
    j = n_b - 1
    grows = growing(values)
    for k in range(values.shape[2]):
        column = values[:, j, k]
        panel.plot(study.values[0], column.imag, color=paint().quiet, linewidth=0.9)
        loud = np.where(grows[:, j, k], column.imag, np.nan)
        panel.plot(study.values[0], loud, color=paint().slip, linewidth=2.2, marker="o" if n_a < 40 else "")
    finish(panel, x=study.over[0], y=f"angular frequency [{study.scene.units.angular_frequency}]", legend=False)
    return figure_of([panel])


@drawn
def shares(feed: Feed, ax: Axes | None = None) -> Figure:
    """What each part adds to the growth rate."""
    names = list(feed.parts)[::-1][-24:]
    (panel,) = panels(1, ax, height=1.0 + 0.22 * max(len(names), 3))
    size = [feed.parts[name] for name in names]
    panel.barh(names, size, color=[paint().slip if x > 0.0 else paint().stick for x in size])
    panel.axvline(0.0, color=paint().ink, linewidth=0.7)
    finish(panel, x="share of the growth rate", y="", legend=False)
    return figure_of([panel])


@drawn
def rates(growth: Growth, ax: Axes | None = None) -> Figure:
    """The mode's share of the motion in a run, and the growth of the eigenvalue."""
    (panel,) = panels(1, ax, height=3.4)
    panel.semilogy(growth.t, growth.share, color=paint().slip, label="run")
    panel.semilogy(growth.t, np.exp(growth.eigenvalue.real * growth.t), "--", color=paint().ink, label="eigenvalue")
    finish(panel, x="time", y="share of the mode", legend=True)
    return figure_of([panel])


@drawn
def spread(found: Uncertainty, ax: Axes | None = None) -> Figure:
    """Distribution of the largest growth rate."""
    (panel,) = panels(1, ax, height=3.4)
    growth = found.growth[np.isfinite(found.growth)]
    panel.hist(growth, bins=40, color=paint().stick)
    panel.axvline(0.0, color=paint().ink, linewidth=1.0)
    finish(panel, x="largest growth rate", y="samples", legend=False)
    return figure_of([panel])
