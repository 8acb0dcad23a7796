"""A run beside what was measured."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from fricmb._fit._data import Measured, read
from fricmb.errors import SceneError
from fricmb.plot._arguments import refuse
from fricmb.plot._fine import refined
from fricmb.plot._style import figure_of, finish, paint, panels, remark
from fricmb.plot._units import Units, unit_of_signal

if TYPE_CHECKING:
    from fricmb.solution import Solution


def measured_signals(data: Any, signals: str | Iterable[str] | None) -> tuple[Measured, ...]:
    """What was measured over time.

    Raises
    ------
    SceneError
        Where there is no signal in the data.
    """
    found = tuple(m for m in read(data, signals, None) if m.kind == "signal")
    if not found:
        raise SceneError('compare: data holds no signal over time; expected {"t": t, "mass.x": x} or a table')
    return found


def draw_measured(
    sol: Solution, measured: Sequence[Measured], span: tuple[float, float], ax: Axes | None, title: str, units: Units
) -> Figure:
    """A panel for each signal: dots, and the run as a curve."""
    if ax is not None and len(measured) > 1:
        refuse("compare", "ax", ax, f"left out for {len(measured)} signals; name one with signals=")
    axes = panels(len(measured), ax, title=title, sharex=True)
    seen = refined(sol, *span)
    for panel, m in zip(axes, measured, strict=True):
        inside = (m.t >= span[0]) & (m.t <= span[1])
        panel.plot(m.t[inside], m.x[inside], ".", color=paint().slip, markersize=4, label="measured")
        panel.plot(seen.t, seen.scalar(m.name), color=paint().stick, linewidth=1.0, label="run")
        unit = unit_of_signal(sol, m.name, units)[1]
        finish(panel, x="", y=f"{m.name} [{unit}]", legend=True)
        if inside.any():
            off = sol.at(m.t[inside]).scalar(m.name) - m.x[inside]
            remark(panel, f"root mean square difference {np.sqrt(np.mean(off**2)):.3g}", loc="left")
    finish(axes[-1], x=f"time [{units.time}]", y=axes[-1].get_ylabel())
    return figure_of(axes)
