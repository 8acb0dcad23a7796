"""Velocities over time, enlarged where swings are too many to be seen."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._figure import new_picture
from fricmb.plot._fine import Floats, looks, period_of, refined, window_of
from fricmb.plot._style import NAMED_CURVES, figure_of, finish, line, name_figure, paint, panels, remark
from fricmb.plot._units import Units, is_angle, is_direction, unit_of_rate

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: More swings than this in a panel are a solid block, and how many of them are enlarged.
SOLID, SWINGS = 80, 8
#: More contacts than this are not drawn unasked.
_CONTACTS = 12


@dataclass(kw_only=True)
class Panel:
    """Curves that share an axis: (label, name of a motion or contact, row of the contact)."""

    label: str
    curves: list[tuple[str, str, int]] = field(default_factory=list)

    def values(self, sol: Solution) -> list[Floats]:
        """The velocities of all curves."""
        return [velocity_of(sol, name, row) for _, name, row in self.curves]


def velocity_of(sol: Solution, name: str, row: int) -> Floats:
    """Velocity of a motion, or in one direction of a contact."""
    return sol.velocity(name) if row < 0 else sol.relative_velocity(name)[row]


def panels_of(sol: Solution, names: Iterable[str] | None, units: Units, *, one: bool) -> list[Panel]:
    """What stands in which panel: a panel for each direction, for the modes of a body, for directions of contacts.

    ``one``: a single panel for all of them.
    """
    found: dict[str, Panel] = {}
    for name in _default(sol) if names is None else [names] if isinstance(names, str) else names:
        for key, label, curve in _curves(sol, name, units):
            found.setdefault("" if one else key, Panel(label=label)).curves.append(curve)
    if one and len({unit_of_rate(c[1], units) for panel in found.values() for c in panel.curves}) > 1:
        found[""].label = f"velocity [{units.velocity}]"
    return list(found.values())


def _default(sol: Solution) -> list[str]:
    """All degrees of freedom; where some are modes, also what happens at the contacts."""
    names = list(sol.dof_names)
    modal = any(_mode(name) for name in names)
    return names + (list(sol.contact_names) if modal and len(sol.contact_names) <= _CONTACTS else [])


def _mode(name: str) -> bool:
    last = name.rpartition(".")[2]
    return last.startswith("mode") and last[4:].isdigit()


def _curves(sol: Solution, name: str, units: Units) -> list[tuple[str, str, tuple[str, str, int]]]:
    """Panel, label of its axis and curve, for a name."""
    if name in sol.contact_names:
        axes = sol.names.axes(name)
        label = f"relative velocity [{units.velocity}]"
        return [(f"contact {axis}", label, (f"{name}.{axis}", name, row)) for row, axis in enumerate(axes)]
    owner, _, last = name.rpartition(".")
    if _mode(name):
        return [(f"modes {owner}", f"modal velocity of {owner}", (last, name, -1))]
    if is_angle(name):
        return [("angle", f"angular velocity [{units.angular_velocity}]", (name, name, -1))]
    if is_direction(name):
        return [(f"axes {owner}", f"rate of axes of {owner} [{units.rate}]", (last, name, -1))]
    return [(last, f"velocity [{units.velocity}]", (name, name, -1))]


def draw_velocities(
    sol: Solution,
    found: list[Panel],
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
        columns = _two_columns(len(found), title)
    for k, panel in enumerate(found):
        _draw(columns[0][k], panel, seen)
        if close is not None:
            columns[0][k].axvspan(*close, color=paint().quiet, alpha=0.35, linewidth=0)
            near = refined(sol, *close)
            for i, values in enumerate(panel.values(near)):
                columns[1][k].plot(near.t, values, **line(i, len(panel.curves)))
            finish(columns[1][k], x="", y="")
            columns[1][k].set_xlim(close)
            columns[1][k].locator_params(axis="x", nbins=4)
    for column in columns:
        column[-1].set_xlabel(time)
    return figure_of(columns[0])


def _draw(ax: Axes, panel: Panel, seen: Solution) -> None:
    count = len(panel.curves)
    for i, ((label, _, _), values) in enumerate(zip(panel.curves, panel.values(seen), strict=True)):
        ax.plot(seen.t, values, label=label, **line(i, count))
    finish(ax, x="", y=panel.label, legend=count <= NAMED_CURVES)
    if count > NAMED_CURVES:
        remark(ax, f"{panel.curves[0][0]} (dark) to {panel.curves[-1][0]} (light)")


def _window(
    sol: Solution, found: list[Panel], span: tuple[float, float], zoom: bool | tuple[float, float] | None
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


def _two_columns(count: int, title: str) -> list[list[Axes]]:
    """Whole and enlarged panels side by side."""
    figure = new_picture(7.4, 2.4 * count + 0.8)
    axes = figure.subplots(count, 2, squeeze=False, sharex="col", width_ratios=[2, 1])
    name_figure(figure, title)
    axes[0, 1].set_title("enlarged", loc="left", fontsize="small")
    return [list(axes[:, 0]), list(axes[:, 1])]
