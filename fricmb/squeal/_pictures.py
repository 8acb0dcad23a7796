"""Pictures of a study."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb import plot
from fricmb.analysis._eigenvalues import growing
from fricmb.plot._style import drawn, figure_of, finish, paint, panels

if TYPE_CHECKING:
    from fricmb.analysis import StabilityMap
    from fricmb.squeal import Feed, Growth, Study, Uncertainty

#: Places of a map along its first parameter in a picture.
_FINE = 201


def overview(study: Study, ax: Axes | None = None) -> Figure:
    """The map over two parameters; eigenvalues over one."""
    if len(study.over) > 1 and min(study.shape) > 1:
        found: Figure = plot.stability(_refined(study), ax=ax)
        panel = found.axes[0] if ax is None else ax
        second = study.over[1]
        critical = [(t.at[second], t.value) for t in study.thresholds]
        if critical:
            panel.plot(*zip(*critical, strict=True), "k.", markersize=5.0)
        return found
    return modes(study, ax)


def _refined(study: Study) -> StabilityMap:
    """The map with places between its own, so that the largest growth rate is 0 where a threshold was found."""
    held, (first, second) = study.map, study.over[:2]
    values = study.values[0]
    fine = np.union1d(values, np.linspace(values[0], values[-1], _FINE))
    growth = np.empty((fine.size, held.growth.shape[1]))
    for j, at in enumerate(study.values[1]):
        found = [t.value for t in study.thresholds if t.over == first and t.at[second] == at]
        x, y = list(values), list(held.growth[:, j])
        for a, b, low, high in zip(values[:-1], values[1:], y[:-1], y[1:], strict=True):
            inside = [value for value in found if a < value < b]
            if inside and low * high < 0.0:  # further ones are of modes that follow
                x.append(min(inside) if low < 0.0 else max(inside))
                y.append(0.0)
        order = np.argsort(x)
        growth[:, j] = np.interp(fine, np.array(x)[order], np.array(y)[order])
    return replace(held, values=(fine, held.values[1]), growth=growth, unstable=(growth > 0.0).astype(int))


@drawn
def modes(study: Study, ax: Axes | None = None) -> Figure:
    """Frequency of every mode over the first parameter, growing ones thick."""
    (panel,) = panels(1, ax, height=4.0)
    values, (n_a, n_b) = study.eigenvalues, study.shape
    j = n_b - 1
    grows = growing(values)[:, j]
    first = int(np.argmax(grows.any(axis=0)))  # one of several names them all
    for k in range(values.shape[2]):
        column = values[:, j, k]
        panel.plot(study.values[0], column.imag, color=paint().quiet, linewidth=0.9)
        loud = np.where(grows[:, k], column.imag, np.nan)
        options: dict[str, Any] = {"zorder": 3, "marker": "o" if n_a < 40 else ""}
        if k == first and grows.any():
            options["label"] = "growing"
        panel.plot(study.values[0], loud, color=paint().slip, linewidth=2.2, **options)
    where = f", at {study.over[1]} = {study.values[1][j]:.6g}" if n_b > 1 else ""
    frequency = f"angular frequency [{study.scene.units.angular_frequency}]"
    finish(panel, x=study.over[0] + where, y=frequency, legend=bool(grows.any()))
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
    straight = growth.eigenvalue.real * growth.t  # of the logarithm; where it begins is up to the push
    begin = float(np.median(np.log(growth.share) - straight))
    panel.semilogy(growth.t, np.exp(begin + straight), "--", color=paint().ink, label="eigenvalue")
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
