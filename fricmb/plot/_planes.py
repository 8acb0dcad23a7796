"""Phase planes and paths."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes

from fricmb.plot._contact import along
from fricmb.plot._fine import Floats, looks, period_of, refined, window_of
from fricmb.plot._style import THIN, finish, paint
from fricmb.plot._units import Units, unit_of, unit_of_rate

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: A plane that is this many times wider than high, or the reverse, has axes of two scales.
_NARROW = 8.0
_LAST = 3
#: Of more turns than this the last ones stand out.
TURNS = 20
#: A curve in a plane: its values (2, n_t) in a run.
Curve = Callable[["Solution"], Floats]


def draw_phase(sol: Solution, name: str, span: tuple[float, float], ax: Axes, units: Units) -> None:
    """Velocity over position; of a contact the plane of relative velocity, or force over it in one dimension."""
    if name not in sol.contact_names:
        x, v = unit_of(name, units), unit_of_rate(name, units)
        _curve(sol, lambda seen: np.array([seen[name], seen.velocity(name)]), span, ax)
        finish(ax, x=f"{name} [{x}]", y=f"velocity of {name} [{v}]", legend=_named(ax))
    elif len(sol.names.axes(name)) == 2:
        _curve(sol, lambda seen: seen.relative_velocity(name), span, ax)
        ax.plot(0, 0, "+", color=paint().slip, markersize=9, markeredgewidth=1.5, label="stick")
        first, second = sol.names.axes(name)
        finish(
            ax,
            x=f"relative velocity {along(first)} at {name} [{units.velocity}]",
            y=f"{along(second)} [{units.velocity}]",
            legend=True,
        )
    else:
        _curve(sol, lambda seen: np.array([seen.relative_velocity(name)[0], seen.force(name)[0]]), span, ax)
        finish(
            ax,
            x=f"relative velocity at {name} [{units.velocity}]",
            y=f"friction force [{units.force}]",
            legend=_named(ax),
        )


def draw_path(sol: Solution, x: str, y: str, span: tuple[float, float], ax: Axes, units: Units) -> None:
    """One motion over another, with its start; equal scales unless the path is narrow."""
    _curve(sol, lambda seen: np.array([seen[x], seen[y]]), span, ax)
    seen = sol.at(np.array([span[0]]))
    ax.plot(seen[x], seen[y], "o", color=paint().ink, markersize=4, label="start")
    labels = (f"{name} [{unit_of(name, units)}]" for name in (x, y))
    finish(ax, x=next(labels), y=next(labels), legend=True)
    held = ax.dataLim
    if unit_of(x, units) == unit_of(y, units) and held.width > 0 and held.height > 0:
        if 1 / _NARROW < held.height / held.width < _NARROW:
            ax.set_aspect("equal", adjustable="datalim")
        else:
            ax.text(0.99, 0.01, "axes of different scale", transform=ax.transAxes, ha="right", fontsize="small")


def _named(ax: Axes) -> bool:
    return bool(ax.get_legend_handles_labels()[0])


def _curve(sol: Solution, curve: Curve, span: tuple[float, float], ax: Axes) -> None:
    """A curve; of more turns than can be told apart the last ones stand out."""
    values = curve(refined(sol, *span))

    size = np.maximum(np.ptp(values, axis=1), 1e-300)

    def signals(seen: Solution) -> list[Floats]:
        return list(curve(seen) / size[:, None])

    look = looks(sol)
    period = period_of(sol, signals, *span, look)
    near = None
    if period is not None and (span[1] - span[0]) / period > TURNS:
        near = window_of(sol, signals, *span, swings=_LAST, look=look)
    if near is None:
        ax.plot(*values, color=paint().stick, linewidth=0.7)
        return
    ax.plot(*values, color=paint().quiet, linewidth=0.35, alpha=0.6, label="whole run", rasterized=True)
    label = f"{_LAST} swings from t = {near[0]:.6g} on"
    ax.plot(*curve(refined(sol, *near)), color=paint().stick, linewidth=THIN, label=label)

