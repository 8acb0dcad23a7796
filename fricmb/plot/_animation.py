"""Drawings of scenes and runs as moving pictures, by matplotlib."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import animation
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

from fricmb.analysis import AnalysisError
from fricmb.plot._contact import OPEN, SLIP, STICK
from fricmb.plot._figure import new_picture
from fricmb.plot._make_sketch import in_space, shown_span, sketch_of_run, sketch_of_scene
from fricmb.plot._sketch import Floats, Link, Mark, Shape, Sketch, Touch, coil, plates, pot
from fricmb.plot._style import Paint, drawn, figure_of, name_figure, paint

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: How far apart running strokes are.
STROKES = 0.5
#: Of more contacts than this the first and the last are named.
NAMED = 6


class Drawing:
    """A sketch on axes; :meth:`show` puts it into picture i."""

    def __init__(self, sketch: Sketch, ax: Axes) -> None:
        self.sketch, self.ax, self.paint = sketch, ax, paint()
        self.unit = sketch.unit
        left, right, _, _ = sketch.view
        #: Points of print for each unit of length, and the size of names.
        self.points = 72.0 * ax.get_position().width * figure_of([ax]).get_figwidth() / (right - left)
        self.font = float(np.clip(0.36 * self.points * sketch.letters, 4.0, 8.0))
        self.floor()
        self.marks = [self._mark(mark) for mark in sketch.marks]
        self.links = [
            self._line(1.1, zorder=3, color=self.paint.quiet if link.idle else self.paint.ink) for link in sketch.links
        ]
        self.shapes = [self._shape(shape) for shape in sketch.shapes]
        self.touches = [self._touch(touch) for touch in sketch.touches]
        self.clock = ax.set_title("", loc="left", fontsize=9)
        self.show(0)

    def floor(self) -> None:
        """The ground that bodies stand on."""
        left, right, bottom, top = self.sketch.view
        self.ax.set_xlim(left, right)
        self.ax.set_ylim(bottom, top)
        self.ax.set_aspect("equal")
        self.ax.axis("off")
        if self.sketch.floor is not None:
            level = self.sketch.floor
            self.ax.set_ylim(min(bottom, level - 0.35), top)
            self.ax.plot([left, right], [level, level], color=self.paint.ink, linewidth=1.0)
            self._hatch([left, right], level - 0.25, level)

    def _hatch(self, x: Any, low: float, high: float) -> None:
        self.ax.fill_between(x, low, high, facecolor="none", edgecolor=self.paint.quiet, hatch="////", linewidth=0.0)

    def _line(self, width: float, **options: Any) -> Any:
        (line,) = self.ax.plot([], [], color=options.pop("color", self.paint.ink), linewidth=width, **options)
        return line

    # ---- what is there

    def _shape(self, shape: Shape) -> tuple[Any, Any, Any]:
        faces = {"body": self.paint.body, "moved": self.paint.moved, "plate": self.paint.body, "dot": self.paint.ink}
        small = shape.face in ("dot", "ring")
        patch = Polygon(
            shape.outline,
            closed=True,
            facecolor=faces.get(shape.face, "none"),
            edgecolor=self.paint.ink,
            linewidth=1.0,
            alpha=0.75 if shape.face == "plate" else 1.0,
            zorder=5 if small else 2,
        )
        self.ax.add_patch(patch)
        marks = self._line(0.8, zorder=2.5)
        ha, va = ("left", "center") if shape.face == "plate" else ("center", "center")
        name = self.ax.text(0, 0, shape.name, ha=ha, va=va, fontsize=self.font, zorder=8)
        return patch, marks, name

    def _mark(self, mark: Mark) -> Any:
        if mark.kind == "pin":
            circle = Circle((0, 0), 0.32 * self.unit, facecolor=self.paint.paper, edgecolor=self.paint.ink, zorder=6)
            return self.ax.add_patch(circle)
        if mark.kind == "weld":
            return self.ax.add_patch(Circle((0, 0), 0.3 * self.unit, facecolor=self.paint.ink, zorder=6))
        line = self._line(1.0, zorder=1.5 if mark.kind in ("support", "wall") else 4)
        if mark.kind in ("line", "circle"):
            line.set_zorder(1)
            line.set_color(self.paint.quiet)
        return line

    def _touch(self, touch: Touch) -> tuple[Any, Any, Any]:
        dot = Circle((0, 0), 0.3 * self.unit if touch.turns else 0.16 * self.unit, zorder=9, linewidth=0.8)
        dot.set_edgecolor(self.paint.ink)
        self.ax.add_patch(dot)
        cone = self._line(0.9, color=self.paint.quiet, linestyle="--", zorder=7)
        arrow = self._line(2.0, color=self.paint.ink, zorder=10, solid_capstyle="butt")
        return dot, cone, arrow

    # ---- where it is in picture i

    def show(self, i: int) -> list[Artist]:
        """Draw picture i."""
        sketch = self.sketch
        for k, (shape, (patch, marks, name)) in enumerate(zip(sketch.shapes, self.shapes, strict=True)):
            patch.set_xy(sketch.turned(k, shape.outline, i))
            lines = [sketch.turned(k, line, i) for line in (*shape.marks, *strokes(sketch, k, i))]
            marks.set_data(*_joined(lines))
            if shape.marks:  # a wheel turns under its name
                name.set_position(sketch.places[k, :2, i] + shape.label)
            else:
                name.set_position(sketch.turned(k, np.array([shape.label]), i)[0])
        for line, link in zip(self.links, sketch.links, strict=True):
            line.set_data(*_joined(link_lines(sketch, link, i)))
        for artist, mark in zip(self.marks, sketch.marks, strict=True):
            if isinstance(artist, Circle):
                artist.set_center(tuple(sketch.where(mark.at, i)))
            else:
                artist.set_data(*_joined(mark_lines(sketch, mark, i)))
        for artists, touch in zip(self.touches, sketch.touches, strict=True):
            self._show_touch(artists, touch, i)
        if sketch.t.size > 1:
            self.clock.set_text(f"t = {sketch.t[i]:.6g}")
        return [*self.links, self.clock]

    def _show_touch(self, artists: tuple[Any, Any, Any], touch: Touch, i: int) -> None:
        dot, cone, arrow = artists
        at = self.sketch.where(touch.at, i)
        dot.set_center(tuple(at))
        colours = {STICK: self.paint.stick, SLIP: self.paint.slip, OPEN: self.paint.paper}
        dot.set_facecolor(self.paint.quiet if touch.mode is None else colours[int(touch.mode[i])])
        if touch.force is None:
            return
        reach = self.sketch.reach
        cone.set_data(*_joined(cone_lines(touch, at, reach, i)))
        arrow.set_data(*_joined(arrow_lines(touch, at, reach, i, self.unit)))


def _joined(lines: list[Floats]) -> tuple[list[float], list[float]]:
    """Lines as one, with gaps."""
    x: list[float] = []
    y: list[float] = []
    for line in lines:
        x += [*line[:, 0].tolist(), np.nan]
        y += [*line[:, 1].tolist(), np.nan]
    return x, y


def strokes(sketch: Sketch, shape: int, i: int) -> list[Floats]:
    """Strokes on a band that run with it, in its own axes."""
    shift = sketch.strokes.get(shape)
    if shift is None:
        return []
    width = sketch.shapes[shape].band
    half = 0.5 * float(np.ptp(sketch.shapes[shape].outline[:, 1]))
    step = width / max(1, round(width / STROKES))
    at = (np.arange(0.0, width - 1e-9, step) + float(shift[i])) % width - width / 2
    return [np.array([[x, -half], [x, -0.55 * half]]) for x in at]


def link_lines(sketch: Sketch, link: Link, i: int) -> list[Floats]:
    """A spring as a coil, a damper as a pot, play as two plates apart, a rod as a line."""
    a, b = sketch.where(link.a, i), sketch.where(link.b, i)
    if link.kind == "rod":
        return [np.array([a, b])]
    if link.kind == "damper":
        return pot(a, b, sketch.unit, link.side, link.wide)
    if link.kind == "play":
        return plates(a, b, sketch.unit, link.side)
    return [coil(a, b, sketch.unit, link.side, link.coils, link.wide)]


def mark_lines(sketch: Sketch, mark: Mark, i: int) -> list[Floats]:
    """The strokes of a sign."""
    at, unit, turn = sketch.where(mark.at, i), sketch.unit, sketch.angle(mark.at, i) + mark.angle
    e = np.array([np.cos(turn), np.sin(turn)])
    n = np.array([-e[1], e[0]])
    if mark.kind == "support":
        foot = at + unit * np.array([[-0.8, -1.1], [0.0, 0.0], [0.8, -1.1], [-0.8, -1.1]])
        return [foot, *(at + unit * np.array([[x, -1.1], [x - 0.3, -1.5]]) for x in (-0.6, 0.0, 0.6))]
    if mark.kind == "wall":
        tall = mark.size or 0.35 * unit
        strokes = (tall * np.array([x * n, (x - 0.43) * n + 0.57 * e]) for x in (-0.57, -0.17, 0.23, 0.6, 1.0))
        return [np.array([at - tall * n, at + tall * n]), *(at + stroke for stroke in strokes)]
    if mark.kind == "line":
        return [np.array([at - mark.size * e, at + mark.size * e])]
    if mark.kind == "circle":
        angle = np.linspace(0, 2 * np.pi, 73)
        return [at + mark.size * np.column_stack((np.cos(angle), np.sin(angle)))]
    if mark.kind == "spiral":
        angle = np.linspace(0, 5 * np.pi, 60)
        radius = unit * np.linspace(0.3, 1.2, 60)
        return [at + radius[:, None] * np.column_stack((np.cos(angle), np.sin(angle)))]
    if mark.kind == "turn":
        angle = np.linspace(0.6, 2.4, 20)
        arc = at + 1.5 * unit * np.column_stack((np.cos(angle), np.sin(angle)))
        tip, back = arc[-1], np.array([np.sin(2.4), -np.cos(2.4)])
        out = np.array([np.cos(2.4), np.sin(2.4)])
        head = np.array([tip + 0.35 * unit * (back + 0.6 * out), tip, tip + 0.35 * unit * (back - 0.6 * out)])
        return [arc, head]
    return []


def cone_lines(touch: Touch, at: Floats, reach: float, i: int) -> list[Floats]:
    """Break-away force: a circle in the plane, in one direction a bar on both sides."""
    if touch.limit is None or touch.turns or touch.force is None:
        return []
    radius = reach * float(touch.limit[i])
    if np.ptp(touch.force[1]) > 0.0 and np.ptp(touch.force[0]) > 0.0:
        angle = np.linspace(0, 2 * np.pi, 49)
        return [at + radius * np.column_stack((np.cos(angle), np.sin(angle)))]
    along = touch.force[:, np.argmax(np.hypot(*touch.force))]
    size = float(np.hypot(*along))
    e = along / size if size > 0.0 else np.array([1.0, 0.0])
    n = 0.12 * reach * np.array([-e[1], e[0]])
    return [np.array([at + s * radius * e - n, at + s * radius * e + n]) for s in (-1.0, 1.0)]


def arrow_lines(touch: Touch, at: Floats, reach: float, i: int, unit: float) -> list[Floats]:
    """The friction force as an arrow; of a pin its moment as an arc."""
    assert touch.force is not None
    force = touch.force[:, i]
    if touch.turns:
        share = float(touch.force[0, i]) if abs(touch.force[0]).max() >= abs(touch.force[1]).max() else 0.0
        angle = np.pi / 2 + np.linspace(0.0, 0.75 * 2 * np.pi * share, 24)
        return [at + 0.62 * unit * np.column_stack((np.cos(angle), np.sin(angle)))]
    length = reach * float(np.hypot(*force))
    if length < 0.02 * reach:
        return []
    e = force / np.hypot(*force)
    n, tip = np.array([-e[1], e[0]]), at + length * e
    head = 0.25 * min(reach, 2 * length)
    return [np.array([at, tip]), np.array([tip - head * (e + 0.5 * n), tip, tip - head * (e - 0.5 * n)])]


def canvas(sketch: Sketch, ax: Axes | None = None) -> tuple[Figure, Axes]:
    """Axes that a sketch fits into."""
    if ax is not None:
        figure = ax.figure
        assert isinstance(figure, Figure)
        return figure, ax
    left, right, bottom, top = sketch.view
    width = min(12.0, max(5.0, 0.9 * (right - left) / sketch.unit))
    height = min(8.0, max(2.2, width * (top - bottom) / (right - left) + 0.9))
    figure = new_picture(width, height)
    name_figure(figure, sketch.title)
    return figure, figure.subplots()


@drawn
def draw_scene(scene: Any, *, ax: Axes | None = None) -> Figure:
    """A scene at its start: bodies with their names, springs and dampers, joints, contacts."""
    if in_space(scene):
        from fricmb.plot.space import draw_in_space

        return draw_in_space(scene, ax)
    sketch = sketch_of_scene(scene)
    figure, panel = canvas(sketch, ax)
    drawing = Drawing(sketch, panel)
    taken: list[tuple[Floats, float]] = []
    for touch in _named(sketch.touches):
        at = sketch.where(touch.at, 0)
        away = drawing.points * sketch.unit * (0.3 if touch.turns else 0.16) + 2.0
        low = -away - 0.4 * drawing.font
        for other, its in taken:  # names at one place stand below one another
            if np.hypot(*(at - other)) < 0.5 * sketch.unit:
                low = min(low, its - drawing.font)
        taken.append((at, low))
        style: dict[str, Any] = {"fontsize": drawing.font - 1, "zorder": 11}
        panel.annotate(touch.name, tuple(at.tolist()), xytext=(away, low), textcoords="offset points", **style)
    return figure


def _named(touches: Sequence[Touch]) -> list[Touch]:
    """Contacts whose names are written: of many the first and the last."""
    return list(touches) if len(touches) <= NAMED else [touches[0], touches[-1]]


def legend(ax: Axes, colours: Paint, touches: Sequence[Any], *, arrows: bool, cones: bool = False) -> None:
    """What the colours of contacts mean, and arrows and the signs of break-away forces, where there are any."""
    modes = {int(mode) for touch in touches if touch.mode is not None for mode in np.unique(touch.mode)}
    named = {STICK: ("stick", colours.stick), SLIP: ("slip", colours.slip), OPEN: ("open", colours.paper)}
    for mode, (label, colour) in named.items():
        if mode in modes:
            ax.plot([], [], "o", color=colour, markeredgecolor=colours.ink, label=label)
    if arrows:
        ax.plot([], [], color=colours.ink, linewidth=2.0, label="friction")
    if cones:
        ax.plot([], [], "--", color=colours.quiet, label="break-away")
    if modes:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=5, fontsize="x-small", borderaxespad=0.0)


@drawn
def animate(
    sol: Solution,
    path: str | PathLike[str] | None,
    *,
    t_start: float | None,
    t_end: float | None,
    frames: int | None,
    fps: float,
    magnify: float | None,
) -> animation.FuncAnimation | Path:
    """The animation, or the file it was written to."""
    file = None if path is None else Path(path)
    if file is not None:
        _check_kind(file)
    if file is not None and file.suffix.lower() in (".html", ".htm"):
        from fricmb.plot._view import solution_page

        page = solution_page(sol, t_start=t_start, t_end=t_end, magnify=magnify)
        file.write_text(page, encoding="utf-8")
        return file
    begin, end, count = shown_span(sol, t_start, t_end)
    frames = count if frames is None else frames
    figure, drawing = _of_run(sol, np.linspace(begin, end, frames), magnify)
    moving = animation.FuncAnimation(figure, drawing.show, frames=frames, interval=1000 / fps, blit=False)
    if file is None:
        return moving
    if file.suffix.lower() == ".gif":
        moving.save(file, writer=animation.PillowWriter(fps=round(fps)), dpi=80)
    else:
        moving.save(file, writer=animation.FFMpegWriter(fps=round(fps)), dpi=120)
    return file


def _of_run(sol: Solution, times: Floats, magnify: float | None) -> tuple[Figure, Any]:
    """A figure, and the drawing in it that shows a run at given times."""
    if in_space(sol.scene):
        from fricmb.plot.space import space_drawing_of_run

        return space_drawing_of_run(sol, times)
    sketch = sketch_of_run(sol, times, magnify)
    figure, ax = canvas(sketch)
    cones = any(touch.limit is not None and not touch.turns for touch in sketch.touches)
    legend(ax, paint(), sketch.touches, arrows=True, cones=cones)
    return figure, Drawing(sketch, ax)


def _check_kind(file: Path) -> None:
    """Refuse what cannot be written, before anything is drawn."""
    kind = file.suffix.lower()
    if kind not in (".mp4", ".gif", ".html", ".htm"):
        raise AnalysisError(f"animation: the name must end in .mp4, .gif or .html; got {file.name!r}")
    if kind == ".mp4" and not animation.writers.is_available("ffmpeg"):
        raise AnalysisError(f"animation: {file.name} needs ffmpeg, which is not on the PATH; write .gif or .html")
