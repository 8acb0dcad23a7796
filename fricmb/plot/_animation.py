"""A run as moving pictures: bodies, springs, contact forces with their cones, stick in another colour."""

from __future__ import annotations

from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import animation
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle
from numpy.typing import NDArray

from fricmb.analysis import AnalysisError
from fricmb.plot._contact import OPEN, STICK, static_limit
from fricmb.plot._layout import HEIGHT, ROW, WIDTH, Layout, layout
from fricmb.plot._style import BLUE, DARK, ORANGE

if TYPE_CHECKING:
    from fricmb.solution import Solution

Floats = NDArray[np.float64]
#: A body that travels this many times farther than the one that travels least, nearly all in one direction, is drawn
#: as a band.
_BAND, _ONE_WAY = 3.0, 0.9
_REACH = 0.45
_MODES = {STICK: ("stick", BLUE), 1: ("slip", ORANGE), OPEN: ("open", "white")}


class Animation:
    """The drawing of one run, and what changes in it from picture to picture."""

    def __init__(self, sol: Solution, times: Floats, magnify: float | None) -> None:
        self.sol, self.seen, self.layout = sol, sol.at(times), layout(sol.scene)
        self.offsets, self.bands = _displacements(self.seen, self.layout, magnify)
        self.figure, self.ax = canvas(self.layout, str(sol.scene.name))
        self.boxes = {name: self._box(name) for name in self.layout.places}
        self.names = {name: self.ax.text(0, 0, name, ha="center", va="center", fontsize=8) for name in self.boxes}
        self.ticks = {name: self._ticks() for name in self.bands}
        self.links = [self.ax.plot([], [], color=DARK, linewidth=0.9)[0] for _ in self.layout.links]
        self.marks = [self._contact(name) for name, _, _ in self.layout.contacts]
        self.clock = self.ax.text(0.01, 0.98, "", transform=self.ax.transAxes, va="top", fontsize=9)
        self.limits = {name: _largest(sol, self.seen, name) for name, _, _ in self.layout.contacts}

    def _box(self, name: str) -> Rectangle:
        moves = name in self.bands
        box = Rectangle(
            (0, 0),
            self.layout.widths[name],
            HEIGHT,
            facecolor="0.93" if moves else "0.8",
            edgecolor=DARK,
            linewidth=1.0,
        )
        self.ax.add_patch(box)
        return box

    def _ticks(self) -> Any:
        return self.ax.plot([], [], color=DARK, linewidth=0.7)[0]

    def _contact(self, name: str) -> tuple[Any, Any, Any]:
        (dot,) = self.ax.plot([], [], "o", markersize=11, markeredgecolor=DARK, zorder=5)
        (arrow,) = self.ax.plot([], [], color="black", linewidth=2.2, zorder=6)
        planar = len(self.sol.names.axes(name)) == 2
        cone = Ellipse((0, 0), 2 * _REACH, 2 * _REACH if planar else 0.12, fill=False, edgecolor=ORANGE, linestyle="--")
        self.ax.add_patch(cone)
        return dot, arrow, cone

    def centre(self, name: str, i: int) -> Floats:
        """Where a body is drawn in picture i."""
        if name == "ground":
            return np.array([0.0, 0.0])
        x = self.offsets[name][:, i] if name not in self.bands else np.zeros(2)
        return np.asarray(np.array(self.layout.places[name]) + x)

    def show(self, i: int) -> list[Artist]:
        """Draw picture i."""
        for name, box in self.boxes.items():
            x, y = self.centre(name, i)
            box.set_xy((x - self.layout.widths[name] / 2, y - HEIGHT / 2))
            self.names[name].set_position((x, y))
        for name, line in self.ticks.items():
            line.set_data(*_tick_lines(self.centre(name, i), float(self.bands[name][i]), self.layout.widths[name]))
        for line, (kind, _, a, b) in zip(self.links, self.layout.links, strict=True):
            line.set_data(*link(kind, self.centre(a, i), self._anchor(a, b, i), b != "ground"))
        for marks, (name, a, b) in zip(self.marks, self.layout.contacts, strict=True):
            self._show_contact(marks, name, a, b, i)
        self.clock.set_text(f"t = {self.seen.t[i]:.4g}")
        return [*self.boxes.values(), *self.links, self.clock]

    def _anchor(self, a: str, b: str, i: int) -> Floats:
        """The far end of a link; of one to the ground a place at the body's left."""
        if b != "ground":
            return self.centre(b, i)
        x, y = self.layout.places[a]
        return np.array([x - WIDTH / 2 - 0.8, y])

    def _show_contact(self, marks: tuple[Any, Any, Any], name: str, a: str, b: str, i: int) -> None:
        dot, arrow, cone = marks
        x, y = self.centre(a, i)
        y -= 0.5 * ROW if b != a else 0.0
        mode = int(self.seen.mode(name)[i])
        dot.set_data([x], [y])
        dot.set_markerfacecolor(_MODES[mode][1])
        force = self.seen.force(name)[:, i] / self.limits[name] * _REACH
        across = float(force[1]) if len(force) == 2 else 0.0
        arrow.set_data([x, x + float(force[0])], [y, y + across])
        cone.center = (x, y)


def canvas(found: Layout, title: str, *, legend: bool = True) -> tuple[Figure, Axes]:
    """An empty figure with room for the parts of a layout, and the ground."""
    places = np.array(list(found.places.values())) if found.places else np.zeros((1, 2))
    left, right = places[:, 0].min() - WIDTH - 1.2, places[:, 0].max() + WIDTH + 0.6
    top = places[:, 1].max() + HEIGHT + 0.5
    width = min(10.0, max(5.0, 1.1 * (right - left)))
    figure = Figure(figsize=(width, width * (top + 0.3) / (right - left) + 0.7), layout="constrained")
    ax = figure.subplots()
    ax.set_xlim(left, right)
    ax.set_ylim(-0.3, top)
    ax.set_aspect("equal")
    ax.axis("off")
    ax.axhline(0.0, color=DARK, linewidth=1.0)
    ax.fill_between([left, right], -0.25, 0.0, facecolor="none", edgecolor="0.6", hatch="////", linewidth=0.0)
    for mode, (label, colour) in _MODES.items():
        ax.plot([], [], "o", color=colour, markeredgecolor=DARK, label=label) if mode != OPEN else None
    ax.plot([], [], color="black", linewidth=2.2, label="friction force")
    ax.plot([], [], "--", color=ORANGE, label="break-away")
    if legend:
        ax.legend(loc="upper right", ncols=4, fontsize=7, frameon=False)
    ax.set_title(title, loc="left", fontsize="medium")
    return figure, ax


def _displacements(seen: Solution, found: Layout, magnify: float | None) -> tuple[dict[str, Any], dict[str, Any]]:
    """Drawn displacement (2, n) of each body, and along x of those drawn as bands."""
    offsets = {name: np.array([_motion(seen, name, c) for c in "xy"]) for name in found.places}
    travel = {name: float(np.ptp(x, axis=1).max()) for name, x in offsets.items() if np.ptp(x) > 0.0}
    free = {name: way for name, way in travel.items() if not found.moving[name]}
    least = min(free.values(), default=1.0)
    one_way = {name: bool((np.abs(x[:, -1] - x[:, 0]) > _ONE_WAY * np.ptp(x)).any()) for name, x in offsets.items()}
    bands = {n for n in found.places if found.moving[n] or (one_way[n] and travel.get(n, 0.0) > _BAND * least)}
    largest = max((way for name, way in free.items() if name not in bands), default=1.0)
    scale = 1.2 / largest if magnify is None else magnify
    means = {name: x.mean(axis=1, keepdims=True) for name, x in offsets.items()}
    return (
        {name: scale * (x - means[name]) for name, x in offsets.items()},
        {name: scale * offsets[name][0] for name in bands},
    )


def _motion(seen: Solution, body: str, letter: str) -> Floats:
    name = f"{body}.{letter}"
    return seen[name] if name in seen.names.known_motions() else np.zeros(seen.t.size)


def _largest(sol: Solution, seen: Solution, contact: str) -> float:
    """The force that an arrow of full length stands for."""
    limit = static_limit(seen, contact)
    values = np.linalg.norm(seen.force(contact), axis=0) if limit is None else limit
    return float(values.max(initial=0.0)) or 1.0


def _tick_lines(centre: Floats, shift: float, width: float) -> tuple[list[float], list[float]]:
    """Strokes on a band that run with it."""
    x, y = [], []
    for at in (np.arange(0.0, width - 1e-9, WIDTH / 8) + shift) % width - width / 2 + centre[0]:
        x += [float(at), float(at), np.nan]
        y += [centre[1] - 0.3 * HEIGHT, centre[1] + 0.3 * HEIGHT, np.nan]
    return x, y


def link(kind: str, a: Floats, b: Floats, between: bool) -> tuple[Floats, Floats]:
    """A zigzag from b to the rim of a, or for a damper a straight line beside it."""
    along = a - b
    length = max(float(np.linalg.norm(along)), 1e-9)
    unit = along / length
    start = b + unit * (WIDTH / 2 if between else 0.0)
    end = a - unit * min(WIDTH / 2, 0.9 * length)
    normal = np.array([-unit[1], unit[0]])
    if kind == "damper":
        points = np.array([start - 0.18 * normal, end - 0.18 * normal])
        return points[:, 0], points[:, 1]
    s = np.concatenate([[0.0], np.linspace(0.15, 0.85, 12), [1.0]])
    side = np.concatenate([[0.0, 0.0], 0.1 * (-1.0) ** np.arange(10), [0.0, 0.0]])
    points = start + s[:, None] * (end - start) + side[:, None] * normal + 0.12 * normal
    return points[:, 0], points[:, 1]


def animate(
    sol: Solution,
    path: str | PathLike[str] | None,
    *,
    t_start: float | None,
    t_end: float | None,
    frames: int,
    fps: float,
    magnify: float | None,
) -> animation.FuncAnimation | Path:
    """The animation, or the file it was written to."""
    file = None if path is None else Path(path)
    if file is not None:
        _check_kind(file)
    times = np.linspace(sol.t_start if t_start is None else t_start, sol.t_end if t_end is None else t_end, frames)
    drawing = Animation(sol, times, magnify)
    moving = animation.FuncAnimation(drawing.figure, drawing.show, frames=frames, interval=1000 / fps, blit=False)
    if file is None:
        return moving
    kind = file.suffix.lower()
    if kind == ".gif":
        moving.save(file, writer=animation.PillowWriter(fps=round(fps)), dpi=80)
    elif kind in (".html", ".htm"):
        file.write_text(moving.to_jshtml(fps=round(fps), default_mode="loop"), encoding="utf-8")
    else:
        moving.save(file, writer=animation.FFMpegWriter(fps=round(fps)), dpi=120)
    return file


def _check_kind(file: Path) -> None:
    """Refuse what cannot be written, before anything is drawn."""
    kind = file.suffix.lower()
    if kind not in (".mp4", ".gif", ".html", ".htm"):
        raise AnalysisError(f"animation: the name must end in .mp4, .gif or .html; got {file.name!r}")
    if kind == ".mp4" and not animation.writers.is_available("ffmpeg"):
        raise AnalysisError(f"animation: {file.name} needs ffmpeg, which is not on the PATH; write .gif or .html")
