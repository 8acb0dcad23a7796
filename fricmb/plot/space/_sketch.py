"""What a drawing of a scene in space consists of, and where each piece of it is from picture to picture.

As :mod:`fricmb.plot._sketch` does for the plane, this knows neither matplotlib nor the browser: both draw from it.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from fricmb.integrate.problem import Codes
from fricmb.plot._sketch import Floats

#: A solid by its number (-1: space itself) and a point in its own axes.
Spot = tuple[int, Floats]
FIXED = -1


@dataclass(kw_only=True)
class Solid:
    """A piece that moves and turns as one.

    Attributes
    ----------
    name : str
    faces : list of (k, 3)
        Flat polygons in its own axes, in the order that is counter-clockwise from outside.
    shades : list of int
        Of each face: 0 or 1, so that a turn of something round is seen.
    lines : list of (k, 3)
        Edges, spokes, arms.
    outward : list of (3,)
        Of each line where the face that it is on looks to; 0 where it is on none, and always seen.
    """

    name: str
    faces: list[Floats] = field(default_factory=list)
    shades: list[int] = field(default_factory=list)
    lines: list[Floats] = field(default_factory=list)
    outward: list[Floats] = field(default_factory=list)

    def edge(self, line: Floats, outward: Floats | None = None) -> None:
        """Add a line."""
        self.lines.append(line)
        self.outward.append(np.zeros(3) if outward is None else outward)

    def joined(self, other: Solid, at: Floats) -> None:
        """Take in another one, shifted."""
        self.faces += [face + at for face in other.faces]
        self.shades += other.shades
        self.lines += [line + at for line in other.lines]
        self.outward += other.outward

    def corners(self) -> Floats:
        """All its points (k, 3)."""
        return np.concatenate([np.zeros((1, 3)), *self.faces, *self.lines])


@dataclass(kw_only=True)
class SpaceLink:
    """A spring, damper or rod between two spots."""

    kind: str
    a: Spot
    b: Spot


@dataclass(kw_only=True)
class SpaceTouch:
    """Friction: where it acts, whether it sticks, and the force over the largest break-away force of the run.

    ``at`` (3, n); ``force`` (3, n), None where it is no force at a point (a journal, a ball joint) or nothing has run.
    """

    name: str
    at: Floats
    force: Floats | None = None
    mode: Codes | None = None


@dataclass(kw_only=True)
class Floor:
    """A plane that something touches: rows u, w, e of ``frame`` (3, 3), e its normal; ``angle`` (n,) it has turned."""

    through: Floats
    frame: Floats
    angle: Floats
    half: float = 1.0


@dataclass(kw_only=True)
class SpaceSketch:
    """A drawing.

    Attributes
    ----------
    places : (n_solids, 3, n)
        Where the origin of each solid is.
    turns : (n_solids, 3, 3, n)
        Its axes, as columns.
    pins : list of Spot
        Where joints are.
    rails : list of (k, 3)
        Lines that rest.
    box : (3, 2)
        Least and largest x, y, z of all that is drawn, in all pictures.
    """

    title: str
    t: Floats
    solids: list[Solid] = field(default_factory=list)
    places: Floats = field(default_factory=lambda: np.zeros((0, 3, 1)))
    turns: Floats = field(default_factory=lambda: np.zeros((0, 3, 3, 1)))
    links: list[SpaceLink] = field(default_factory=list)
    pins: list[Spot] = field(default_factory=list)
    touches: list[SpaceTouch] = field(default_factory=list)
    floors: list[Floor] = field(default_factory=list)
    rails: list[Floats] = field(default_factory=list)
    box: Floats = field(default_factory=lambda: np.array([[-1.0, 1.0]] * 3))

    @property
    def size(self) -> float:
        """The longest edge of the box."""
        return float(np.ptp(self.box, axis=1).max())

    def points_at(self, solid: int, points: Floats, i: int) -> Floats:
        """Points (k, 3) of a solid in picture i."""
        if solid == FIXED:
            return points
        return np.asarray(points @ self.turns[solid, :, :, i].T + self.places[solid, :, i])

    def where(self, spot: Spot, i: int) -> Floats:
        """A spot in picture i."""
        return np.asarray(self.points_at(spot[0], spot[1][None], i)[0])

    def path(self, solid: int) -> Floats | None:
        """The way (n, 3) of a solid, where it goes farther than it is large."""
        way = self.places[solid].T
        own = float(np.ptp(self.solids[solid].corners(), axis=0).max())
        return way if float(np.ptp(way, axis=0).max()) > max(0.5 * own, 0.05 * self.size) else None

    def grid(self, floor: Floor, i: int) -> list[Floats]:
        """Lines of a floor in picture i: its border and squares, which turn with it."""
        c, s = np.cos(floor.angle[i]), np.sin(floor.angle[i])
        u, w = c * floor.frame[0] + s * floor.frame[1], c * floor.frame[1] - s * floor.frame[0]
        at = np.linspace(-floor.half, floor.half, 9)
        ends = np.array([-floor.half, floor.half])
        along = [floor.through + np.outer(ends, u) + x * w for x in at]
        return along + [floor.through + np.outer(ends, w) + x * u for x in at]

    def frame(self) -> None:
        """Let floors reach as far as what stands on them, and fit the box to everything."""
        n = self.t.size
        seen = np.unique(np.linspace(0, n - 1, 40).astype(int))
        corners = [self.points_at(k, solid.corners(), i) for k, solid in enumerate(self.solids) for i in seen]
        corners += [self.where(pin, 0)[None] for pin in self.pins] + self.rails
        corners += [self.where(end, i)[None] for link in self.links for end in (link.a, link.b) for i in seen]
        every = np.concatenate(corners) if corners else np.zeros((1, 3))
        for floor in self.floors:
            if not np.any(floor.angle):  # one that turns does so about its own middle
                middle = 0.5 * (every.min(axis=0) + every.max(axis=0))
                floor.through = middle - ((middle - floor.through) @ floor.frame[2]) * floor.frame[2]
            across = (every - floor.through) @ floor.frame[:2].T
            floor.half = 1.1 * float(np.abs(across).max()) or 1.0
            every = np.concatenate([every, *(line for line in self.grid(floor, 0))])
        low, high = every.min(axis=0), every.max(axis=0)
        least = 0.1 * (float((high - low).max()) or 1.0)
        room = np.maximum(0.0, least - (high - low)) / 2
        self.box = np.column_stack((low - room, high + room))


def helix(a: Floats, b: Floats, radius: float, coils: int = 7) -> Floats:
    """A spring from b to a."""
    along = a - b
    length = float(np.linalg.norm(along)) or 1e-12
    e = along / length
    u = np.cross(e, np.eye(3)[int(np.argmin(np.abs(e)))])
    u /= np.linalg.norm(u)
    angle = np.linspace(0.0, 2 * np.pi * coils, 16 * coils + 1)
    share = 0.12 + 0.76 * angle / angle[-1]
    turns = np.outer(np.cos(angle), u) + np.outer(np.sin(angle), np.cross(e, u))
    return np.concatenate([b[None], b + share[:, None] * along + radius * turns, a[None]])
