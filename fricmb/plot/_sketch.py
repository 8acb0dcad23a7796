"""What a drawing of a scene consists of, and where each piece of it is from picture to picture.

A sketch knows neither matplotlib nor the browser: both draw from it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fricmb.scene import Backlash, Stop
from fricmb.scene._rigid_stops import RigidBacklash, RigidStop
from fricmb.values import is_expression, value_of

if TYPE_CHECKING:
    from fricmb.solution import Solution

Floats = NDArray[np.float64]
#: A shape by its number (-1: the ground) and a point in its own axes.
Spot = tuple[int, float, float]
#: Positions (n,) of a named motion.
Motion = Callable[[str], Floats]
GROUND_SHAPE = -1


@dataclass(kw_only=True)
class Shape:
    """A piece that moves and turns as one.

    Attributes
    ----------
    name : str
        Its label; "" for none.
    face : {"body", "moved", "plate", "dot", "ring"}
    outline : (k, 2)
        Closed polygon in its own axes.
    marks : list of (k, 2)
        Lines in its own axes, such as the spoke of a wheel.
    label : (float, float)
        Where its name stands, in its own axes.
    band : float
        Width over which strokes run that show how far it has gone, instead of its own motion; 0: none.
    """

    name: str
    face: str
    outline: Floats
    marks: list[Floats] = field(default_factory=list)
    label: tuple[float, float] = (0.0, 0.0)
    band: float = 0.0


@dataclass(kw_only=True)
class Link:
    """A spring, damper, play, rod or torsional spring between two spots; ``side``: shifted across, in units.

    ``idle``: of value 0, drawn pale: it is declared, and left out of runs.  ``wide``: width over the usual one, smaller
    where links are close together.
    """

    kind: str
    name: str
    a: Spot
    b: Spot
    side: float = 0.0
    wide: float = 1.0
    coils: int = 5
    idle: bool = False


def link_kind(part: Any) -> str:
    """As what an element is drawn: "damper", "play" of stops and flanks, "spring"."""
    if isinstance(part, Stop | Backlash) or is_limit(part):
        return "play"
    return "damper" if "Damper" in type(part).__name__ else "spring"


def is_limit(part: Any) -> bool:
    """Whether a part is a stop or play that does not give."""
    return isinstance(part, RigidStop | RigidBacklash)


def is_idle(part: Any) -> bool:
    """Whether a spring or damper has the value 0."""
    values = [getattr(part, name) for name in ("stiffness", "damping", "cubic") if hasattr(part, name)]
    return bool(values) and not any(is_expression(value) or np.any(value_of(value)) for value in values)


@dataclass(kw_only=True)
class Mark:
    """A sign at a spot: "support", "wall", "pin", "line", "circle", "spiral", "arrow", "turn".

    ``angle``: its direction in the axes of the shape; ``size``: half the length of a line, radius of a circle, half the
    height of a wall (0: as fits the unit).
    """

    kind: str
    at: Spot
    angle: float = 0.0
    size: float = 0.0


@dataclass(kw_only=True)
class Touch:
    """A contact: where it is, and its force over the largest break-away force of the run.

    ``turns``: friction of a pin, whose force is a moment.
    """

    name: str
    at: Spot
    turns: bool = False
    force: Floats | None = None
    limit: Floats | None = None
    mode: NDArray[np.int8] | None = None


@dataclass(kw_only=True)
class Sketch:
    """A drawing.

    Attributes
    ----------
    places : (n_shapes, 3, n)
        x, y and angle of each shape.
    strokes : dict of int to (n,)
        How far the bands among the shapes have gone.
    view : (left, right, bottom, top)
    unit, reach, letters : float
        Lengths that pins and coils, the arrow of the largest break-away force, and names are drawn by.
    floor : float, optional
        Height of the ground, where it is drawn.
    """

    title: str
    t: Floats
    unit: float = 0.7
    reach: float = 0.7
    letters: float = 1.0
    shapes: list[Shape] = field(default_factory=list)
    links: list[Link] = field(default_factory=list)
    marks: list[Mark] = field(default_factory=list)
    touches: list[Touch] = field(default_factory=list)
    places: Floats = field(default_factory=lambda: np.zeros((0, 3, 1)))
    strokes: dict[int, Floats] = field(default_factory=dict)
    view: tuple[float, float, float, float] = (-1.0, 1.0, -1.0, 1.0)
    floor: float | None = None

    def where(self, spot: Spot, i: int) -> Floats:
        """A spot in picture i."""
        return np.asarray(self.turned(spot[0], np.array([spot[1:]]), i)[0])

    def angle(self, spot: Spot, i: int) -> float:
        """The angle of the shape that a spot is on, in picture i."""
        return 0.0 if spot[0] == GROUND_SHAPE else float(self.places[spot[0], 2, i])

    def turned(self, shape: int, points: Floats, i: int) -> Floats:
        """Points (k, 2) of a shape in picture i."""
        if shape == GROUND_SHAPE:
            return points
        x, y, angle = self.places[shape, :, i]
        c, s = np.cos(angle), np.sin(angle)
        moved: Floats = points @ np.array([[c, s], [-s, c]]) + [x, y]
        return moved

    def frame(self, margin: float) -> None:
        """Fit the view to all shapes in all pictures, and to what stands at the ground."""
        corners = [np.array([mark.at[1:]]) for mark in self.marks if mark.at[0] == GROUND_SHAPE]
        corners += [np.array([end[1:]]) for link in self.links for end in (link.a, link.b) if end[0] == GROUND_SHAPE]
        for mark in self.marks:
            if mark.kind == "circle" and mark.at[0] == GROUND_SHAPE:
                corners.append(np.array(mark.at[1:]) + box(2 * mark.size, 2 * mark.size))
        n = self.places.shape[2]
        for k, shape in enumerate(self.shapes):
            corners += [self.turned(k, shape.outline, i) for i in np.unique(np.linspace(0, n - 1, 60).astype(int))]
        for link in self.links:
            length = float(np.hypot(*(self.where(link.a, 0) - self.where(link.b, 0))))
            link.coils = int(np.clip(length / (0.35 * self.unit), 4, 16))
        every = np.concatenate(corners) if corners else np.zeros((1, 2))
        (left, bottom), (right, top) = every.min(axis=0) - margin, every.max(axis=0) + margin
        self.view = (float(left), float(right), float(bottom), float(top))


def motions_of(sol: Solution) -> Motion:
    """Motions of a run at its times; what a driven body does not do is 0."""
    known = set(sol.names.known_motions())
    return lambda name: sol[name] if name in known else np.zeros(sol.t.size)


def motions_at_start(scene: Any) -> Motion:
    """Motions as a scene declares them, (1,) each."""
    values = dict(zip(scene.dof_names, scene.initial_values()[0].tolist(), strict=True))

    def position(name: str) -> Floats:
        if name in values:
            return np.array([values[name]])
        owner, _, letter = name.rpartition(".")
        if any(body.name == owner for body in scene.driven):
            return np.array([_at_zero(scene[owner].position.get(letter, 0.0))])
        form = scene.motion(name)
        return np.array([form.constant + sum(c * values.get(dof, 0.0) for dof, c in form.terms)])

    return position


def _at_zero(value: Any) -> float:
    """A number, or an expression at time 0."""
    from fricmb.scene import t

    return float(value_of(value.subs({t: 0.0}) if is_expression(value) else value))


def box(width: float, height: float) -> Floats:
    """A rectangle about the origin."""
    return np.asarray(np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * np.array([width, height]) / 2)


def disc(radius: float, points: int = 40) -> Floats:
    """A circle about the origin."""
    angle = np.linspace(0.0, 2 * np.pi, points, endpoint=False)
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))


def rounded(points: ArrayLike, radius: float) -> Floats:
    """The outline of a body through points: their hull, wider by a radius."""
    from scipy.spatial import ConvexHull

    every = (np.asarray(points, dtype=float)[:, None] + disc(radius, 24)).reshape(-1, 2)
    return every[ConvexHull(every).vertices]


def _line(a: Floats, b: Floats) -> tuple[float, Floats, Floats]:
    """Length from b to a, the direction along and that across."""
    along = a - b
    length = max(float(np.hypot(*along)), 1e-12)
    e: Floats = along / length
    return length, e, np.array([-e[1], e[0]])


def coil(a: Floats, b: Floats, unit: float, side: float, coils: int, wide: float = 1.0) -> Floats:
    """A spring from b to a, shifted across by ``side`` units."""
    _, _, n = _line(a, b)
    s = np.concatenate([[0.0], np.linspace(0.14, 0.86, 2 * coils + 2), [1.0]])
    across = np.concatenate([[0.0, 0.0], 0.22 * wide * unit * (-1.0) ** np.arange(2 * coils), [0.0, 0.0]])
    points: Floats = b + s[:, None] * (a - b) + (across + side * unit)[:, None] * n
    return points


def pot(a: Floats, b: Floats, unit: float, side: float, wide: float = 1.0) -> list[Floats]:
    """A damper from b to a: rod, pot, rod."""
    length, e, n = _line(a, b)
    start, end, wide = b + side * unit * n, a + side * unit * n, 0.2 * wide * unit
    middle, half = 0.5 * (start + end), min(0.35 * unit, 0.3 * length) * e
    cup = [middle + half + wide * n, middle - half + wide * n, middle - half - wide * n, middle + half - wide * n]
    plate = [middle + 0.75 * wide * n, middle - 0.75 * wide * n]
    return [np.array([start, middle - half]), np.array(cup), np.array(plate), np.array([middle, end])]


def plates(a: Floats, b: Floats, unit: float, side: float) -> list[Floats]:
    """A stop, or play, between b and a: two plates that may touch."""
    length, e, n = _line(a, b)
    start, end, wide = b + side * unit * n, a + side * unit * n, 0.3 * unit * n
    middle, half = 0.5 * (start + end), min(0.12 * unit, 0.2 * length) * e
    near, far = middle - half, middle + half
    lines = (start, near), (near + wide, near - wide), (far + wide, far - wide), (far, end)
    return [np.array(line) for line in lines]
