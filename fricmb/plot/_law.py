"""Pictures of a friction law: its coefficient, hysteresis, break-away and lag."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fricmb.analysis import cycle, path, pull, settling_distance
from fricmb.laws import FrictionLaw
from fricmb.plot._figure import new_picture
from fricmb.plot._style import drawn, few_labels, figure_of, finish, line, paint, panels
from fricmb.plot._units import Units, bare

Floats = NDArray[np.float64]
#: A curve whose values differ by less than this share is a straight line.
_FLAT = 2e-3
_Place = Literal["best", "center right"]
#: Part of the width of loops that their names take beside them.
_ROOM = 0.5
#: Of the states in a loop: more than a picture shows.
_RTOL = 1e-4


@drawn
def law_figure(law: FrictionLaw, *, normal_force: float = 1.0, units: Units | None = None) -> Figure:
    """Four panels: coefficient over slip speed, hysteresis loops, break-away, lag behind a varying speed.

    The parameters stand below the name of the law.

    Parameters
    ----------
    law : FrictionLaw
    normal_force : float
        Forces are drawn per unit of it.
    units : Units, optional
        Of the law's numbers, for the labels: ``scene.units``.

    Returns
    -------
    matplotlib Figure
    """
    figure = new_picture(9.0, 6.4)
    axes = figure.subplots(2, 2)
    figure.suptitle("\n".join((type(law).__name__, *parameter_lines(law))), x=0.01, ha="left", fontsize="medium")
    speeds = speed_range(law, normal_force)
    speed = float(np.sqrt(speeds[0] * speeds[-1]))
    length = settling_distance(law, normal_force) if law.states else speed
    draw_coefficient(law, axes[0, 0], speeds, normal_force)
    draw_loops(law, axes[0, 1], loop_length(law, normal_force) if law.states else speed, speed, normal_force)
    draw_break_away(law, axes[1, 0], normal_force)
    draw_lag(law, axes[1, 1], length, speed, normal_force)
    titles = ("steady slip", "hysteresis in harmonic cycles", "break-away", "lag behind a swinging speed")
    for ax, title in zip(axes.flat, titles, strict=True):
        ax.set_title(title, fontsize="medium", loc="left")
        _name_units(ax, units)
    return figure


@drawn
def law(
    law: FrictionLaw, *, normal_force: float = 1.0, units: Units | None = None, ax: Axes | None = None
) -> Figure:
    """The most telling panel of a law: hysteresis loops of a law with memory, else the coefficient over speed.

    Parameters
    ----------
    law : FrictionLaw
    normal_force : float
        Forces are drawn per unit of it.
    units : Units, optional
        Of the law's numbers, for the labels: ``scene.units``.
    ax : Axes, optional
    """
    (panel,) = panels(1, ax, title=type(law).__name__, height=3.2)
    speeds = speed_range(law, normal_force)
    if law.states:
        draw_loops(law, panel, loop_length(law, normal_force), float(np.sqrt(speeds[0] * speeds[-1])), normal_force)
    else:
        draw_coefficient(law, panel, speeds, normal_force)
    _name_units(panel, units)
    return figure_of([panel])


def parameter_lines(law: FrictionLaw, width: int = 100) -> list[str]:
    """The parameters of a law in lines of text; of arrays their ends."""
    lines = [""]
    for name, value in law.numeric_slots().items():
        values = np.ravel(value)
        shown = f"{float(values[0]):.4g}" if values.size == 1 else f"{values[0]:.3g} ... {values[-1]:.3g}"
        word = f"{name} = {shown}"
        if lines[-1] and len(lines[-1]) + len(word) > width:
            lines.append("")
        lines[-1] += (", " if lines[-1] else "") + word
    return [text for text in lines if text]


def loop_length(law: FrictionLaw, normal_force: float = 1.0) -> float:
    """Displacement by which friction has grown to two thirds of its largest when it is pulled from rest.

    Of a law that gives way at once, the distance over which it settles.
    """
    pulled = pull(law, normal_force=normal_force, rtol=_RTOL)
    held = np.abs(pulled.force)
    reached = int(np.argmax(held >= 0.63 * held.max()))
    length = float(pulled.displacement[reached])
    return length if reached > 0 and length > 0.0 else settling_distance(law, normal_force)


def speed_range(law: FrictionLaw, normal_force: float = 1.0) -> Floats:
    """Slip speeds (logarithmic) over which the coefficient changes, with a decade on either side."""
    grid = np.logspace(-9, 2, 441)
    mu = np.asarray(law.coefficient(grid, normal_force))
    step = np.diff(mu) / np.maximum(mu[:-1], 1e-300)
    falls = np.flatnonzero(step < -5e-4)
    # from rest, not the viscous rise
    rises = np.flatnonzero(step > 2e-2) if mu[0] < 0.5 * np.median(mu) else np.array([], dtype=np.int64)
    seen = (grid[rises] < 1.0) & (mu[rises] > 0.01 * np.median(mu))
    moving = np.concatenate([falls, rises[seen]])
    low, high = (grid[moving.min()] / 3.0, grid[moving.max()] * 3.0) if len(moving) else (1e-3, 1.0)
    return np.logspace(np.log10(low), np.log10(min(high, 1e2)), 400)


def draw_coefficient(law: FrictionLaw, ax: Axes, speeds: Floats, normal_force: float) -> None:
    """Steady coefficient over slip speed, and what holds at rest."""
    ax.semilogx(speeds, law.coefficient(speeds, normal_force), label="slip", **line(0))
    few_labels(ax.xaxis, float(speeds[0]), float(speeds[-1]))
    if law.kind != "smooth":
        held = law.break_away(normal_force)
        ax.axhline(held, color=paint().slip, linestyle="--", linewidth=0.9, label="break-away")
    ax.set_ylim(bottom=0.0)
    _finish(ax, x="slip speed", y="coefficient in steady slip", legend=law.kind != "smooth", logarithmic=True)


def draw_loops(law: FrictionLaw, ax: Axes, length: float, speed: float, normal_force: float) -> None:
    """Friction over displacement in harmonic cycles, from presliding to gross slip."""
    shares = (0.5, 2.0, 8.0) if law.states else (0.1, 1.0, 10.0)
    for i, share in enumerate(shares):
        amplitude = share * length
        top = 0.03 * speed * (1.0 if law.states else 30.0 * share)
        period = 2 * np.pi * amplitude / top
        loop = cycle(law, amplitude=amplitude, period=period, normal_force=normal_force, cycles=2, rtol=_RTOL)
        x = loop.displacement / amplitude if not law.states else loop.displacement / length
        label = f"amplitude {_short(amplitude)}" if law.states else f"speed {_short(top)}"
        ax.plot(x, -loop.force / normal_force, label=label, **line(i))
    what = f"displacement / {_short(length)}" if law.states else "displacement / amplitude"
    left, right = ax.get_xlim()
    ax.set_xlim(left, right + _ROOM * (right - left))  # loops leave no room for names but beside them
    _finish(ax, x=what, y="friction / normal force", legend=True, at="center right")


def draw_break_away(law: FrictionLaw, ax: Axes, normal_force: float) -> None:
    """Slow pulling from rest."""
    if law.states:
        pulled = pull(law, normal_force=normal_force)
        ax.plot(pulled.displacement, -pulled.force / normal_force, **line(0))
        ax.set_xlim(right=min(float(pulled.displacement[-1]), 25.0 * loop_length(law, normal_force)))
        _finish(ax, x="displacement, pulled slowly from rest", y="friction / normal force")
        return
    held = law.break_away(normal_force) if law.kind != "smooth" else 0.0
    slip = law.slip_limit(normal_force) if law.kind != "smooth" else law.creep(0.5).break_away
    centre = float(law.numeric().offsets()[0]) if law.offsets() else 0.0  # of slip forward
    ax.plot([0.0, 0.0, 0.0, 1.0], [0.0, held + centre, slip + centre, slip + centre], **line(0))
    _finish(ax, x="displacement, pulled slowly from rest", y="friction / normal force")


def draw_lag(law: FrictionLaw, ax: Axes, length: float, speed: float, normal_force: float) -> None:
    """Friction over speed while the speed swings without turning round, slow and fast."""
    for i, swings in enumerate((200.0, 10.0, 2.0)):
        omega = speed / (swings * length)
        t = np.linspace(0.0, 6.0 * np.pi / omega, 901)
        found = path(law, _swing(speed, omega), t, normal_force=normal_force, rtol=1e-6)
        last = slice(600, None)
        ax.plot(found.velocity[last], -found.force[last] / normal_force, label=f"frequency {_short(omega)}", **line(i))
    _finish(ax, x="slip speed", y="friction / normal force", legend=True)


def _name_units(ax: Axes, units: Units | None) -> None:
    """Add the unit to a label of speed or displacement; friction and displacement are also drawn as ratios."""
    label = ax.get_xlabel()
    if units is not None and label.startswith(("slip speed", "displacement,")):
        unit = units.velocity if label.startswith("slip speed") else units.length
        ax.set_xlabel(bare(f"{label} [{unit}]"))


def _finish(
    ax: Axes, x: str, y: str, *, legend: bool = False, logarithmic: bool = False, at: _Place = "best"
) -> None:
    if not logarithmic:
        ax.ticklabel_format(axis="x", style="sci", scilimits=(-2, 3))
        ax.locator_params(axis="x", nbins=6)
    finish(ax, x=x, y=y)
    low, high = ax.get_ylim()
    middle = 0.5 * (low + high)
    if high - low < _FLAT * abs(middle):  # what changes by round-off is a constant
        ax.set_ylim(middle - 0.1 * abs(middle), middle + 0.1 * abs(middle))
    if legend:
        ax.legend(loc=at, fontsize="x-small", frameon=True, framealpha=0.7, edgecolor="none")


def _swing(speed: float, omega: float) -> Callable[[Any], Any]:
    return lambda time: speed * (1.0 + 0.8 * np.sin(omega * np.asarray(time)))


def _short(value: Any) -> str:
    return f"{float(value):.2g}"
