"""Signals over time, enlarged where swings are too many to be seen."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._contact import SOLID, SWINGS
from fricmb.plot._figure import new_picture
from fricmb.plot._fine import Floats, looks, period_of, refined, window_of
from fricmb.plot._style import NAMED_CURVES, figure_of, finish, line, name_figure, paint, panels, remark
from fricmb.plot._units import Units, is_direction, unit_of_signal

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: More contacts than this are not drawn unasked.
_CONTACTS = 12
#: Values below this share of the largest of their kind are round-off.
ROUND_OFF = 1e-13


@dataclass(kw_only=True)
class Panel:
    """Curves that share an axis: (label, name of a signal).

    ``scale``: the largest value of this kind in the run, beside which round-off is nothing.
    """

    label: str
    curves: list[tuple[str, str]] = field(default_factory=list)
    scale: float = 0.0

    def values(self, sol: Solution) -> list[Floats]:
        """Values of all curves."""
        return [np.asarray(sol.scalar(name), dtype=float) for _, name in self.curves]


def panels_of(sol: Solution, names: Iterable[str] | None, units: Units, *, rate: bool, one: bool) -> list[Panel]:
    """What stands in which panel: a panel for each direction, for the modes of a body, for directions of contacts.

    ``rate``: velocities instead of positions; ``one``: a single panel for all of them.
    """
    found: dict[str, Panel] = {}
    for name in _default(sol, rate) if names is None else [names] if isinstance(names, str) else names:
        for key, label, curve in _curves(sol, name, units, rate):
            found.setdefault("" if one else key, Panel(label=label)).curves.append(curve)
    if one and len({panel.label for panel in found.values()}) > 1:
        found[""].label = f"velocity [{units.velocity}]" if rate else f"position [{units.length}]"
    for panel in found.values():
        panel.scale = _scale(sol, panel, units)
    return list(found.values())


def signal_panels(sol: Solution, names: Iterable[str], units: Units) -> list[Panel]:
    """A panel for each kind of signal, so that what shares an axis shares its unit."""
    found: dict[str, Panel] = {}
    for name in [names] if isinstance(names, str) else names:
        sol.scalar(name, "signals")
        kind, unit = unit_of_signal(sol, name, units)
        found.setdefault(f"{kind} [{unit}]", Panel(label=f"{kind} [{unit}]")).curves.append((name, name))
    return list(found.values())


def _scale(sol: Solution, panel: Panel, units: Units) -> float:
    """The largest rate or position of the same unit among all motions of the run."""
    unit = unit_of_signal(sol, panel.curves[0][1], units)
    own = max((float(np.abs(x).max(initial=0.0)) for x in panel.values(sol)), default=0.0)
    rate = unit[0].endswith("velocity")
    values = sol.v if rate else sol.q
    suffix = ".velocity" if rate else ""
    rows = [i for i, name in enumerate(sol.dof_names) if unit_of_signal(sol, f"{name}{suffix}", units)[1] == unit[1]]
    return max(own, float(np.abs(values[rows]).max(initial=0.0)))


def _default(sol: Solution, rate: bool) -> list[str]:
    """All degrees of freedom; where some are modes, also what happens at the contacts."""
    names = list(sol.dof_names)
    modal = rate and any(_mode(name) for name in names)
    return names + (list(sol.contact_names) if modal and len(sol.contact_names) <= _CONTACTS else [])


def _mode(name: str) -> bool:
    last = name.rpartition(".")[2]
    return last.startswith("mode") and last[4:].isdigit()


def _curves(sol: Solution, name: str, units: Units, rate: bool) -> list[tuple[str, str, tuple[str, str]]]:
    """Panel, label of its axis and curve, for the name of a motion or contact."""
    if rate and name in sol.contact_names:
        axes = sol.names.axes(name)
        label = f"relative velocity [{units.velocity}]"
        return [(f"contact {axis}", label, (f"{name}.{axis}", f"{name}.relative_velocity.{axis}")) for axis in axes]
    name = name.removesuffix(".velocity") if rate else name
    signal = f"{name}.velocity" if rate else name
    _ = sol.velocity(name) if rate else sol.scalar(name, "positions")  # an unknown name is told by itself
    owner, _, last = name.rpartition(".")
    kind, unit = unit_of_signal(sol, signal, units)
    if _mode(name):
        return [(f"modes {owner}", f"{kind} of {owner} [{unit}]", (last, signal))]
    if is_direction(name):
        return [(f"axes {owner}", f"{kind} of {owner} [{unit}]", (last, signal))]
    key = last if kind in ("velocity", "position") else kind
    return [(key, f"{kind} [{unit}]", (name, signal))]


def draw_over_time(
    sol: Solution,
    found: Sequence[Panel],
    span: tuple[float, float],
    zoom: bool | tuple[float, float] | None,
    ax: Axes | None,
    title: str,
    time: str,
) -> Figure:
    """The panels, with an enlarged column beside them where it helps or is asked for."""
    seen = refined(sol, *span)
    close = None if ax is not None or zoom is False else _window(sol, found, span, zoom)
    if close is None:
        axes = panels(max(1, len(found)), ax, title=title, sharex=True)
        columns = [axes]
    else:
        columns = two_columns(len(found), title)
    for k, panel in enumerate(found):
        _draw(columns[0][k], panel, seen)
        if close is not None:
            columns[0][k].axvspan(*close, color=paint().quiet, alpha=0.35, linewidth=0)
            near = refined(sol, *close)
            for i, values in enumerate(panel.values(near)):
                columns[1][k].plot(near.t, values, **line(i, len(panel.curves)))
            finish(columns[1][k], x="", y="")
            limit_to(columns[1][k], panel.values(near), panel.scale)
            columns[1][k].set_xlim(close)
            columns[1][k].locator_params(axis="x", nbins=4)
    for column in columns:
        finish(column[-1], x=time, y=column[-1].get_ylabel())
    return figure_of(columns[0])


def limit_to(ax: Axes, values: Iterable[Floats], scale: float) -> bool:
    """Draw what is round-off as the zero that it is; whether it is."""
    largest = max((float(np.abs(x).max(initial=0.0)) for x in values), default=0.0)
    if largest > ROUND_OFF * scale and largest > 0.0:
        return False
    ax.set_ylim(-(scale or 1.0), scale or 1.0)
    return True


def _draw(ax: Axes, panel: Panel, seen: Solution) -> None:
    count, values = len(panel.curves), panel.values(seen)
    for i, ((label, _), x) in enumerate(zip(panel.curves, values, strict=True)):
        ax.plot(seen.t, x, label=label, **line(i, count))
    finish(ax, x="", y=panel.label, legend=count <= NAMED_CURVES)
    if limit_to(ax, values, panel.scale):
        remark(ax, "0 to round-off", loc="left")
    if count > NAMED_CURVES:
        remark(ax, f"{panel.curves[0][0]} (dark) to {panel.curves[-1][0]} (light)")


def _window(
    sol: Solution, found: Sequence[Panel], span: tuple[float, float], zoom: bool | tuple[float, float] | None
) -> tuple[float, float] | None:
    """The stretch that is enlarged: the one asked for, or some swings of the fastest panel where it is too full."""
    if isinstance(zoom, tuple):
        return zoom
    look = looks(sol)
    periods = [(period_of(sol, panel.values, *span, look), panel) for panel in found]
    known = [(period, panel) for period, panel in periods if period is not None]
    if not known:
        return None
    period, panel = min(known, key=lambda one: one[0])
    if zoom is None and (span[1] - span[0]) / period <= SOLID:
        return None
    return window_of(sol, panel.values, *span, swings=SWINGS, look=look)


def two_columns(count: int, title: str) -> list[list[Axes]]:
    """Whole and enlarged panels side by side."""
    figure = new_picture(7.4, 2.4 * count + 0.8)
    axes = figure.subplots(count, 2, squeeze=False, sharex="col", width_ratios=[2, 1])
    name_figure(figure, title)
    axes[0, 1].set_title("enlarged", loc="left", fontsize="small")
    return [list(axes[:, 0]), list(axes[:, 1])]
