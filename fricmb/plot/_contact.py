"""Pictures of a contact: its force against the cone, its modes."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import LogFormatter
from numpy.typing import NDArray

from fricmb.plot._fine import at_once, looks, period_of, window_of
from fricmb.plot._style import THIN, finish, paint, remark
from fricmb.plot._units import Units

if TYPE_CHECKING:
    from fricmb.solution import Solution

Floats = NDArray[np.float64]
STICK, SLIP, OPEN = 0, 1, 2
#: More contacts than this are drawn without their names.
NAMED = 30
#: Phases shorter than the shortest hundredth of all by this factor are put on the lower edge.
_SHORT = 1e-3
#: More swings than this in a panel are a solid block, and how many of them are enlarged.
SOLID, SWINGS = 40, 8
#: A plane that is this many times wider than high, or the reverse, has axes of two scales.
_NARROW = 8.0
#: Forces that move by less than this share of the largest stand still.
_STILL = 1e-9


def _bars() -> dict[int, dict[str, Any]]:
    """How the bar of a mode is drawn."""
    stick, ink = paint().stick, paint().ink
    return {
        STICK: {"facecolor": stick, "edgecolor": stick, "linewidth": 0.4},
        OPEN: {"facecolor": "none", "edgecolor": ink, "hatch": "////", "linewidth": 0.4},
    }


def static_limit(sol: Solution, contact: str) -> Floats | None:
    """Break-away force (n_t,) of a contact, None for a law that never sticks."""
    law, normal_force = sol.scene[contact].law, sol.normal_force(contact)
    if law.kind == "smooth":
        return None
    if not law.load_dependent:
        return np.asarray(law.break_away() * normal_force)
    loads, where = np.unique(normal_force, return_inverse=True)
    return np.array([law.break_away(load) for load in loads])[where] * normal_force


def static_centre(sol: Solution, contact: str) -> Floats:
    """Centre (d, n_t) of the cone of a contact: 0, but for a law with offsets."""
    law = sol.scene[contact].law
    offsets = np.array(law.numeric().rest_offsets() or (0.0,) * len(sol.force(contact)), dtype=float)
    found: Floats = -offsets[:, None] * sol.normal_force(contact)
    return found


def force_window(sol: Solution, contact: str, span: tuple[float, float]) -> tuple[float, float] | None:
    """A few swings of a force that swings too often to be seen."""

    def signals(seen: Solution) -> list[Floats]:
        force = seen.force(contact)
        moves = np.ptp(force, axis=1) > _STILL * np.abs(force).max(initial=0.0)
        return [np.where(alive, x, x[:1]) for x, alive in zip(force, moves, strict=True)]

    look = looks(sol)
    period = period_of(sol, signals, *span, look)
    if period is None or (span[1] - span[0]) / period <= SOLID:
        return None
    return window_of(sol, signals, *span, swings=SWINGS, look=look)


def draw_force_history(
    sol: Solution, contact: str, ax: Axes, units: Units, *, legend: bool = True
) -> None:  # fmt: skip
    """Force over time; in one dimension signed, in two its magnitude; the break-away force as bounds."""
    force, limit = sol.force(contact), static_limit(sol, contact)
    planar = len(force) == 2
    shown = np.hypot(*force) if planar else force[0]
    ax.plot(sol.t, shown, color=paint().stick, linewidth=THIN, label="friction force")
    centre = static_centre(sol, contact) if limit is not None else np.zeros((1, 1))
    if limit is not None and not (planar and centre.any()):
        bound: dict[str, Any] = {"color": paint().slip, "linestyle": "--", "linewidth": THIN}
        ax.plot(sol.t, limit + centre[0], label="break-away force", **bound)
        if not planar:
            ax.plot(sol.t, centre[0] - limit, **bound)
    name = f"|F| of {contact}" if planar else f"F of {contact}"
    finish(ax, x=f"time [{units.time}]", y=f"{name} [{units.force}]", legend=legend)


def draw_cone(sol: Solution, contact: str, ax: Axes, units: Units) -> None:
    """Force in the plane of the contact, with the largest break-away circle of the run."""
    _draw_plane(sol, contact, ax, units, legend=True)
    ax.set_aspect("equal", adjustable="box")


def zoom(sol: Solution, contact: str, ax: Axes, units: Units) -> None:
    """The same, enlarged to where the force was; a circle stays one unless the force hardly moves along one axis."""
    _draw_plane(sol, contact, ax, units)
    force = sol.force(contact)
    largest = float(np.abs(force).max(initial=0.0))
    spans = [_with_margin(values, largest) for values in force]
    ax.set_xlim(spans[0])
    ax.set_ylim(spans[1])
    width, height = (high - low for low, high in spans)
    if 1 / _NARROW < height / width < _NARROW:
        ax.set_aspect("equal", adjustable="box")
        remark(ax, "enlarged")
    else:
        remark(ax, "enlarged, axes of different scale")
    ax.locator_params(axis="x", nbins=5)


def _with_margin(values: Floats, largest: float) -> tuple[float, float]:
    """Limits around values; what moves by round-off of the largest is drawn as standing still."""
    low, high = float(values.min()), float(values.max())
    if high - low <= _STILL * largest:
        middle = 0.5 * (low + high)
        return middle - 0.1 * (largest or 1.0), middle + 0.1 * (largest or 1.0)
    margin = 0.06 * (high - low)
    return low - margin, high + margin


def along(axis: str) -> str:
    """A direction in a label: "along x"; a name like "around" stands for itself."""
    return f"along {axis}" if len(axis) == 1 else axis


def _draw_plane(sol: Solution, contact: str, ax: Axes, units: Units, *, legend: bool = False) -> None:
    force, limit, mode = sol.force(contact), static_limit(sol, contact), sol.mode(contact)
    ax.plot(*np.where(mode == STICK, force, np.nan), color=paint().quiet, linewidth=0.7, label="stick")
    ax.plot(*np.where(mode == SLIP, force, np.nan), color=paint().stick, linewidth=1.2, label="slip")
    ax.plot(*force[:, :1], "o", color=paint().ink, markersize=3.5, label="start")
    if limit is not None:
        angle = np.linspace(0, 2 * np.pi, 3601)
        radius = limit.max(initial=0.0)
        x, y = static_centre(sol, contact)[:, int(np.argmax(limit))] if limit.size else (0.0, 0.0)
        ax.plot(
            x + radius * np.cos(angle), y + radius * np.sin(angle), "--", color=paint().slip, linewidth=THIN,
            label="cone",
        )  # fmt: skip
    first, second = sol.names.axes(contact)
    finish(ax, x=f"force {along(first)} [{units.force}]", y=f"force {along(second)} [{units.force}]", legend=legend)


def phases(sol: Solution) -> list[tuple[Floats, NDArray[np.int8]]]:
    """Bounds (n+1,) and modes (n,) of the stretches between the events of each contact.

    All contacts are looked up together: a long run would be gone through for each of them.  Only scenes whose samples
    are large are looked at in parts.
    """
    own: dict[str, list[float]] = {name: [] for name in sol.contact_names}
    for event in sol.events:
        if event.contact in own:
            own[event.contact].append(event.t)
    bounds = [np.array([sol.t_start, *times, sol.t_end]) for times in own.values()]
    ends = np.cumsum([each.size - 1 for each in bounds])
    middles = np.concatenate([np.zeros(0), *(0.5 * (each[:-1] + each[1:]) for each in bounds)])
    mode, step = np.empty(middles.size, dtype=np.int8), at_once(sol)
    for first in range(0, middles.size, step):
        seen, last = sol.at(middles[first : first + step]), min(first + step, middles.size)
        low, high = np.searchsorted(ends, (first, last - 1), side="right").tolist()
        for k in range(low, high + 1):
            mine = slice(max(first, ends[k] - bounds[k].size + 1), min(last, ends[k]))
            mode[mine] = seen.mode(sol.contact_names[k])[mine.start - first : mine.stop - first]
    return [(each, mode[end - each.size + 1 : end]) for each, end in zip(bounds, ends, strict=True)]


def draw_modes(sol: Solution, ax: Axes, span: tuple[float, float]) -> None:
    """A bar for each contact: filled where it sticks, hatched where it is open."""
    names, opens, sticks, held = sol.contact_names, False, False, False
    for row, (name, (bounds, mode)) in enumerate(zip(names, phases(sol), strict=True)):
        opens, sticks = opens or bool((mode == OPEN).any()), sticks or bool((mode == STICK).any())
        rest = sol.rest_spans(name)
        held = held or bool(rest.size)
        if rest.size:
            spans = [(a, b - a) for a, b in rest.tolist()]
            ax.broken_barh(spans, (row - 0.35, 0.7), facecolor=paint().stick, alpha=0.35, linewidth=0.0)
        for code, style in _bars().items():
            spans = [(bounds[i], bounds[i + 1] - bounds[i]) for i in np.flatnonzero(mode == code)]
            ax.broken_barh(spans, (row - 0.35, 0.7), **style)
    if len(names) <= NAMED:
        ax.set_yticks(range(len(names)), names)
    ax.set_ylim(len(names) - 0.4, -0.6)
    words = [(True, "filled: stick" if sticks else "no stick"), (opens, "hatched: open")]
    remark(ax, ", ".join(word for so, word in (*words, (held, "pale: at rest, held by others")) if so))
    finish(ax, x="", y="contact")
    ax.set_xlim(span[0] - 0.01 * (span[1] - span[0]), span[1] + 0.01 * (span[1] - span[0]))


class _PlainLog(LogFormatter):
    """Labels where matplotlib puts them, as plain numbers."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}" if super().__call__(x, pos) else ""


def draw_phases(sol: Solution, ax: Axes, units: Units, span: tuple[float, float]) -> None:
    """How long each phase lasts, over its beginning: a point for each, by mode.

    A few phases that are shorter than all others by orders of magnitude (two transitions at one instant, apart by
    round-off) stand on the lower edge, so that the axis shows the others.
    """
    kinds = {STICK: ("stick", "o", paint().stick), SLIP: ("slip", "x", paint().slip), OPEN: ("open", "s", paint().ink)}
    begin, length, mode, cut = _spans(sol, span)
    floor = _floor(length)
    short = (length < floor) & ~cut
    for code, (label, marker, colour) in kinds.items():
        style: dict[str, Any] = {"color": colour, "linestyle": "none"}
        if (here := mode == code).any():
            whole = here & ~short & ~cut
            ax.plot(begin[whole], length[whole], marker, markersize=3, label=label, **style)
            ax.plot(begin[here & short], np.full((here & short).sum(), floor), 11, markersize=5, **style)
            ax.plot(begin[here & cut], length[here & cut], "^", markersize=5, markerfacecolor="none", **style)
    ax.plot([], [], "^", color=paint().ink, markersize=5, markerfacecolor="none", linestyle="none", label="cut: longer")
    ax.set_yscale("log")
    if short.any():
        ax.set_ylim(bottom=floor / 1.5)
        least = f"{length.min():.0e}" if length.min() > 0.0 else "0"
        remark(ax, f"{short.sum()} shorter than {floor:.0e}, down to {least}: on the lower edge", loc="left")
    # plain numbers: the default sets powers of ten as formulas, which takes as long as the rest of the picture
    ax.yaxis.set_major_formatter(_PlainLog())
    ax.yaxis.set_minor_formatter(_PlainLog(minor_thresholds=(1, 0.4)))
    finish(ax, x=f"time [{units.time}]", y=f"length of phase [{units.time}]", legend=True)


def _spans(
    sol: Solution, span: tuple[float, float]
) -> tuple[Floats, Floats, NDArray[np.int8], NDArray[np.bool_]]:
    """Beginning, length and mode of all phases that begin in a stretch of the run, or hold at its start.

    Last, which of them the ends of the run cut: they may last longer than what is seen of them.
    """
    found = []
    for bounds, mode in phases(sol):
        inside = (bounds[1:] > span[0]) & (bounds[:-1] < span[1])
        cut = (bounds[:-1] <= sol.t_start) | (bounds[1:] >= sol.t_end)
        found.append((bounds[:-1][inside], np.diff(bounds)[inside], mode[inside], cut[inside]))
    begin, length, mode, ends = (np.concatenate(column) for column in zip(*found, strict=True))
    return np.maximum(begin, span[0]), length, mode.astype(np.int8), ends.astype(bool)


def _floor(length: Floats) -> float:
    """The length below which phases stand on the edge: far below the shortest hundredth of those that last."""
    lasting = length[length > 1e-9 * length.max(initial=0.0)]
    return float(_SHORT * np.quantile(lasting, 0.01)) if lasting.size else 0.0
