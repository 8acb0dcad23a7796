"""Drawings of scenes in space by matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3D, Poly3DCollection

from fricmb.plot._animation import legend
from fricmb.plot._contact import OPEN, SLIP, STICK
from fricmb.plot._figure import new_picture
from fricmb.plot._sketch import Floats
from fricmb.plot._style import name_figure, paint
from fricmb.plot.space._make import space_sketch_of_run, space_sketch_of_scene
from fricmb.plot.space._sketch import SpaceLink, SpaceSketch, helix

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Where the camera stands, in degrees, and where light comes from.
ELEVATION, AZIMUTH = 22.0, -58.0
LIGHT = np.array([0.3, -0.5, 0.81])
#: Length of the largest break-away force, radius of springs and size of pins, as shares of the whole.
REACH, COIL = 0.22, 0.015


class SpaceDrawing:
    """A sketch on axes of three dimensions; :meth:`show` puts it into picture i."""

    def __init__(self, sketch: SpaceSketch, ax: Axes3D) -> None:
        self.sketch, self.ax, self.paint = sketch, ax, paint()
        ax.set_axis_off()
        ax.set_proj_type("ortho")
        ax.view_init(elev=ELEVATION, azim=AZIMUTH)
        for axis, (low, high) in zip("xyz", sketch.box.tolist(), strict=True):
            getattr(ax, f"set_{axis}lim")(low, high)
        ax.set_box_aspect(np.ptp(sketch.box, axis=1), zoom=1.0)
        ax.computed_zorder = False
        self.floors = [self._line(0.5, self.paint.quiet, zorder=0) for _ in sketch.floors]
        for rail in sketch.rails:
            ax.plot(*rail.T, color=self.paint.quiet, linewidth=2.0, zorder=1)
        for k in range(len(sketch.solids)):
            way = sketch.path(k) if sketch.t.size > 1 else None
            if way is not None:
                ax.plot(*way.T, color=self.paint.quiet, linewidth=0.8, zorder=1)
        self.links = [self._line(1.1, self.paint.ink, zorder=3) for _ in sketch.links]
        self.solids = [self._faces() for _ in sketch.solids]
        self.edges = [self._line(0.6, self.paint.ink, zorder=5) for _ in sketch.solids]
        self.pins = self._dots(self.paint.paper)
        self.arrows = [self._line(2.0, self.paint.ink, zorder=8) for _ in sketch.touches]
        self.touches = [self._dots(self.paint.quiet) for _ in sketch.touches]
        self.names = [ax.text(0, 0, 0, solid.name, fontsize=7, ha="center", zorder=10) for solid in sketch.solids]
        self.clock = ax.set_title("", loc="left", fontsize=9)
        self.show(0)

    def _line(self, width: float, colour: str, zorder: float) -> Line3D:
        (line,) = self.ax.plot([], [], [], color=colour, linewidth=width, zorder=zorder)
        return line

    def _dots(self, face: str) -> Line3D:
        (dots,) = self.ax.plot([], [], [], "o", color=face, markeredgecolor=self.paint.ink, markersize=5, zorder=9)
        return dots

    def _faces(self) -> Poly3DCollection:
        faces = Poly3DCollection([np.zeros((3, 3))], linewidths=0.0, zorder=4)
        self.ax.add_collection3d(faces)
        return faces

    def show(self, i: int) -> list[Artist]:
        """Draw picture i."""
        sketch, size = self.sketch, self.sketch.size
        self._place_solids(i)
        for line, floor in zip(self.floors, sketch.floors, strict=True):
            line.set_data_3d(*joined(sketch.grid(floor, i)))
        for line, link in zip(self.links, sketch.links, strict=True):
            line.set_data_3d(*joined(link_lines(sketch, link, i)))
        self.pins.set_data_3d(*joined([sketch.where(pin, i)[None] for pin in sketch.pins]))
        colours = {STICK: self.paint.stick, SLIP: self.paint.slip, OPEN: self.paint.paper}
        for dots, arrow, touch in zip(self.touches, self.arrows, sketch.touches, strict=True):
            at = touch.at[:, i]
            dots.set_data_3d(*at[:, None])
            dots.set_markerfacecolor(self.paint.quiet if touch.mode is None else colours[int(touch.mode[i])])
            if touch.force is not None:
                arrow.set_data_3d(*joined(arrow_lines(at, REACH * size * touch.force[:, i])))
        if sketch.t.size > 1:
            self.clock.set_text(f"t = {sketch.t[i]:.6g}")
        return [self.clock]

    def _place_solids(self, i: int) -> None:
        """Solids, those behind first: each is drawn as a whole."""
        a, b = np.radians(AZIMUTH), np.radians(ELEVATION)
        towards = np.array([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])
        depth = [float(place[:, i] @ towards) for place in self.sketch.places]
        for k, (faces, line) in enumerate(zip(self.solids, self.edges, strict=True)):
            solid = self.sketch.solids[k]
            moved = [self.sketch.points_at(k, face, i) for face in solid.faces]
            base = (self.paint.body, self.paint.stick)
            faces.set_verts(moved)
            faces.set_facecolor([shaded(base[s], face) for s, face in zip(solid.shades, moved, strict=True)])
            over = 0.5 * float(np.searchsorted(np.sort(depth), depth[k])) / len(depth)
            faces.set_zorder(4 + over)
            line.set_zorder(4 + over + 0.2 / len(depth))
            turned = [self.sketch.points_at(k, edge, i) for edge in solid.lines]
            facing = [self.sketch.turns[k, :, :, i].T @ towards @ out >= 0.0 for out in solid.outward]
            line.set_data_3d(*joined([edge for edge, seen in zip(turned, facing, strict=True) if seen]))
            middle = self.sketch.places[k, :, i]
            top = max(float(points[:, 2].max()) for points in (middle[None], *moved, *turned))
            self.names[k].set_position_3d((middle[0], middle[1], top + 0.05 * self.sketch.size))


def shaded(colour: Any, face: Floats) -> tuple[float, ...]:
    """The colour of a face, by how it stands to the light."""
    normal = np.cross(face[1] - face[0], face[2] - face[0])
    length = float(np.linalg.norm(normal))
    bright = 0.75 + 0.25 * (float(normal @ LIGHT) / length if length > 0.0 else 0.0)
    return tuple(bright * c for c in to_rgb(colour))


def joined(lines: list[Floats]) -> Floats:
    """Lines as one (3, k), with gaps."""
    if not lines:
        return np.zeros((3, 0))
    gap = np.full((1, 3), np.nan)
    return np.concatenate([part for line in lines for part in (line, gap)]).T


def link_lines(sketch: SpaceSketch, link: SpaceLink, i: int) -> list[Floats]:
    """A spring as a coil, a damper as a line with a thick middle, a rod as a line."""
    a, b = sketch.where(link.a, i), sketch.where(link.b, i)
    if link.kind == "spring":
        return [helix(a, b, COIL * sketch.size)]
    if link.kind == "damper":
        return [np.array([a, b]), helix(b + 0.4 * (a - b), b + 0.6 * (a - b), 1.5 * COIL * sketch.size, coils=3)]
    return [np.array([a, b])]


def arrow_lines(at: Floats, force: Floats) -> list[Floats]:
    """An arrow from a point."""
    length = float(np.linalg.norm(force))
    if length == 0.0:
        return []
    e = force / length
    n = np.cross(e, [0.0, 0.0, 1.0])
    n = n / (np.linalg.norm(n) or 1.0) if np.linalg.norm(n) > 1e-6 else np.array([1.0, 0.0, 0.0])
    tip, head = at + force, 0.25 * length
    return [np.array([at, tip]), np.array([tip - head * (e + 0.5 * n), tip, tip - head * (e - 0.5 * n)])]


def draw_in_space(scene: Any, ax: Any) -> Figure:
    """A scene at its start."""
    sketch = space_sketch_of_scene(scene)
    figure, panel = space_canvas(sketch, ax)
    SpaceDrawing(sketch, panel)
    return figure


def space_drawing_of_run(sol: Solution, times: Floats) -> tuple[Figure, SpaceDrawing]:
    """A figure, and the drawing in it that shows a run at given times."""
    sketch = space_sketch_of_run(sol, times)
    figure, ax = space_canvas(sketch)
    legend(ax, paint(), sketch.touches, arrows=any(touch.force is not None for touch in sketch.touches))
    return figure, SpaceDrawing(sketch, ax)


def space_canvas(sketch: SpaceSketch, ax: Any = None) -> tuple[Figure, Axes3D]:
    """Axes of three dimensions for a sketch.

    Raises
    ------
    AnalysisError
        If the axes given have two.
    """
    from fricmb.analysis import AnalysisError

    if ax is not None:
        if not isinstance(ax, Axes3D):
            raise AnalysisError("a scene with bodies in space is drawn on axes made with projection='3d'")
        figure = ax.figure
        assert isinstance(figure, Figure)
        return figure, ax
    figure = new_picture(6.4, 5.2)
    name_figure(figure, sketch.title)
    made = figure.add_subplot(projection="3d")
    assert isinstance(made, Axes3D)
    return figure, made
