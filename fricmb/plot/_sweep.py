"""Pictures of sweeps: a measure over one parameter or two."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb._sweep import SweepResults
from fricmb._sweep._results import Measure
from fricmb.errors import SceneError
from fricmb.plot._style import drawn, figure_of, finish, line, paint, panels, remark
from fricmb.plot._units import bare

#: More runs than this along a curve are not marked one by one.
_MARKED = 60


def draw_results(
    results: SweepResults, what: Measure | None = None, *, over: str | tuple[str, ...] | None = None,
    label: str | None = None, ax: Axes | None = None,
) -> Figure:  # fmt: skip
    """See :meth:`fricmb.SweepResults.plot`."""
    changing = tuple(name for name in results.parameters if np.unique(results.value(name)).size > 1)
    names = (changing or results.parameters) if over is None else (over,) if isinstance(over, str) else tuple(over)
    chosen = results._only() if what is None else what
    named = label or (chosen if isinstance(chosen, str) else "measure")
    held = [name for name in results.parameters if name not in names and np.unique(results.value(name)).size == 1]
    return _draw(
        *results.grid(chosen, over=names), names=names, label=named, ax=ax,
        labels=tuple(f"{name} [{results.units.get(name, '')}]" for name in names),
        said=", ".join(f"{name} = {results.value(name)[0]:.4g}" for name in held),
    )  # fmt: skip


@drawn
def _draw(
    axes: tuple[np.ndarray[Any, Any], ...], held: np.ndarray[Any, Any], *, names: tuple[str, ...], label: str,
    ax: Axes | None, labels: tuple[str, ...], said: str,
) -> Figure:  # fmt: skip
    """A curve over one axis, a map over two; places without a number are marked, and left empty in a map."""
    if held.ndim not in (1, 2):
        raise SceneError(f"over: got {len(names)} parameters ({', '.join(names)}); a picture has one or two: name them")
    (panel,) = panels(1, ax, height=3.6)
    if held.ndim == 1:
        _draw_curve(panel, axes[0], held)
        finish(panel, x=labels[0], y=label)
    else:
        _draw_map(panel, axes, held, label)
        panel.set_xlabel(bare(labels[0]))
        panel.set_ylabel(bare(labels[1]))
    if said:
        remark(panel, said)
    return figure_of([panel])


def _draw_curve(panel: Axes, x: np.ndarray[Any, Any], y: np.ndarray[Any, Any]) -> None:
    there = np.isfinite(y)
    panel.plot(x, y, marker="o" if x.size <= _MARKED else None, markersize=3, **line(0))
    for value in x[~there]:
        panel.axvline(value, color=paint().quiet, linewidth=0.8, linestyle=":")


def _draw_map(panel: Axes, axes: tuple[np.ndarray[Any, Any], ...], held: np.ndarray[Any, Any], label: str) -> None:
    low, high = paint().shades
    import matplotlib as mpl
    from matplotlib.colors import ListedColormap

    shades = ListedColormap(mpl.colormaps["cividis"](np.linspace(low, high, 256)))
    mesh = panel.pcolormesh(*axes, np.ma.masked_invalid(held.T), cmap=shades, shading="nearest")
    panel.figure.colorbar(mesh, ax=panel, label=label)
