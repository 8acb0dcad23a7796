"""Force over displacement of contacts, joints and elements."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb.plot._contact import SOLID, along
from fricmb.plot._fine import Floats, looks, period_of, refined, window_of
from fricmb.plot._style import THIN, figure_of, finish, paint, panels, remark
from fricmb.plot._units import Units, unit_of_signal

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Loops that are drawn strongly where there are too many.
_LAST = 3


def draw_hysteresis(
    sol: Solution, name: str, span: tuple[float, float], ax: Axes | None, title: str, units: Units
) -> Figure:
    """A panel for each direction: the force that resists over the displacement."""
    seen = refined(sol, *span)
    force, displacement, axes_names = _loop(seen, name)
    count = 1 if ax is not None else len(axes_names)
    axes = panels(count, ax, title=title, height=3.0 * count + 0.8)
    unit = unit_of_signal(sol, f"{name}.force.{axes_names[0]}", units)
    turns = unit[0] == "torque"
    length = "rad" if turns and not units.dimensionless else "1" if turns else units.length
    near = _near(sol, name, span)
    for i, panel in enumerate(axes):
        x, y = displacement[i], -force[i]
        if near is None:
            panel.plot(x, y, color=paint().stick, linewidth=THIN)
        else:
            last = (seen.t >= near[0]) & (seen.t <= near[1])
            panel.plot(x, y, color=paint().quiet, linewidth=0.35, alpha=0.6, label="whole run", rasterized=True)
            label = f"{_LAST} cycles from t = {near[0]:.4g} on"
            panel.plot(x[last], y[last], color=paint().stick, linewidth=THIN, label=label)
        where = f" {along(axes_names[i])}" if len(axes_names) > 1 else ""
        finish(
            panel, x=f"displacement at {name}{where} [{length}]", y=f"resisting {unit[0]}{where} [{unit[1]}]",
            legend=near is not None,
        )  # fmt: skip
        lost = float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))
        energy = "" if units.energy == "1" or "force" in units.energy else f" {units.energy}"
        remark(panel, f"work {lost:.4g}{energy}", loc="left")
    return figure_of(axes)


def _loop(seen: Solution, name: str) -> tuple[Floats, Floats, tuple[str, ...]]:
    """Force and displacement (d, n_t), and what the directions are called."""
    if name in seen.contact_names:
        axes = seen.names.axes(name)
        slip = seen.relative_velocity(name)
        steps = 0.5 * (slip[:, 1:] + slip[:, :-1]) * np.diff(seen.t)
        return seen.force(name), np.concatenate([np.zeros((len(axes), 1)), np.cumsum(steps, axis=1)], axis=1), axes
    force = np.atleast_2d(seen[f"{name}.force"])
    elongation = np.atleast_2d(seen[f"{name}.elongation"])
    return force, elongation, seen.components(f"{name}.force")


def _near(sol: Solution, name: str, span: tuple[float, float]) -> tuple[float, float] | None:
    """The last cycles, where there are more than can be told apart."""

    def signals(other: Solution) -> list[Floats]:
        return list(np.atleast_2d(other[f"{name}.force"]))

    look = looks(sol)
    period = period_of(sol, signals, *span, look)
    if period is None or (span[1] - span[0]) / period <= SOLID:
        return None
    return window_of(sol, signals, *span, swings=_LAST, look=look)
