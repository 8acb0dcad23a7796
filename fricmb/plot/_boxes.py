"""A scene of bodies that do not turn, as boxes: displacements are magnified about where each body stands."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.plot._layout import HEIGHT, ROW, Layout, layout, owner
from fricmb.plot._sketch import (
    GROUND_SHAPE,
    Floats,
    Link,
    Mark,
    Motion,
    Shape,
    Sketch,
    Spot,
    Touch,
    box,
    disc,
    is_idle,
    is_limit,
    link_kind,
)
from fricmb.scene import Contact, ModalBody

#: A body that travels this many times farther than the one that travels least, nearly all in one direction, is drawn
#: as a band.
_BAND, _ONE_WAY = 3.0, 0.9
#: What a letter looks like on paper.
_ON_PAPER = {"x": (1.0, 0.0), "y": (0.0, 1.0), "z": (0.6, 0.45)}
#: How far anchors stand from the bodies, and neighbouring links apart.
_ANCHOR, _SLOT = 1.0, 0.42


def boxes(scene: Any, position: Motion, t: Floats, magnify: float | None) -> Sketch:
    """The sketch of a scene without rigid bodies.

    ``magnify``: drawn displacement per displacement; None: so that the largest fills the room between bodies.
    """
    return _Boxes(scene, position, t, magnify).sketch


class _Boxes:
    """The making of a sketch."""

    def __init__(self, scene: Any, position: Motion, t: Floats, magnify: float | None) -> None:
        self.scene, self.position, self.n = scene, position, t.size
        self.layout = layout(scene)
        self.letters = _letters(scene)
        self.sketch = Sketch(title=str(scene.name), t=t)
        self.number: dict[str, int] = {}
        self._slots: dict[tuple[str, str], int] = {}
        self._wanted: dict[tuple[str, str], int] = {}
        self._bodies(magnify)
        self._touches()
        for _ in range(2):  # first to count the links on each side of each body
            self._wanted, self._slots = self._slots, {}
            self.sketch.links, self.sketch.marks = [], []
            for part in (*scene.elements, *filter(is_limit, scene.joints)):
                self._link(part)
        if not self.layout.above and any(b == "ground" for _, _, b in self.layout.contacts):
            self.sketch.floor = ROW - HEIGHT / 2 - 0.2
        self.sketch.frame(0.5)

    # ---- bodies

    def _bodies(self, magnify: float | None) -> None:
        moved = {name: self._offset(name) for name in self.layout.order}
        self.own = dict(moved)
        bands = _bands(self.layout, moved)
        room = 0.75 if self.layout.above else 1.2
        largest = max((float(np.ptp(x, axis=1).max()) for n, x in moved.items() if n not in bands), default=0.0)
        self.scale = (room / largest if largest > 0.0 else 1.0) if magnify is None else magnify
        places: list[Floats] = []
        for name in self.layout.order:
            x, y = self.layout.places[name]
            here = np.zeros((3, self.n))
            here[:2] = np.array([[x], [y]])
            if name in bands:
                self.sketch.strokes[len(places)] = self.scale * (moved[name][0] - moved[name][0][0])
                moved[name] = moved[name] * [[0.0], [1.0 if self.layout.above else 0.0]]
            here[:2] += self.scale * (moved[name] - moved[name].mean(axis=1, keepdims=True))
            self.number[name] = len(places)
            self.sketch.shapes.append(self._shape(name, name in bands))
            places.append(here)
        self.sketch.places = np.array(places).reshape(-1, 3, self.n)

    def _shape(self, name: str, band: bool) -> Shape:
        width, height = self.layout.sizes[name]
        plate = name in self.layout.under.values() and self.layout.above
        at = (-width / 2 + 0.12, height / 2 - 0.28) if plate else (0.0, 0.22 * height if self.layout.above else 0.0)
        face = "moved" if self.layout.moving[name] else "plate" if plate else "body"
        return Shape(
            name=name, face=face, outline=box(width, height), label=at, band=width if band else 0.0
        )

    def _offset(self, name: str) -> Floats:
        """Displacement (2, n) on paper; of a modal body the mean over its points."""
        body = self.scene[name]
        if isinstance(body, ModalBody):
            points = [self._of(f"{name}.{point}", body.axes) for point in body.shapes]
            return np.asarray(np.mean(points, axis=0))
        return self._of(name, getattr(body, "axes", None) or "xyz")

    def _of(self, name: str, letters: Any) -> Floats:
        total = np.zeros((2, self.n))
        for letter in letters:
            if self.scene.has_motion(f"{name}.{letter}"):
                total += np.outer(self.letters[letter], self.position(f"{name}.{letter}"))
        return total

    # ---- contacts

    def _touches(self) -> None:
        pairs: dict[tuple[str, str], list[Any]] = {}
        for part in self.scene.parts:
            if isinstance(part, Contact):
                pairs.setdefault((owner(part.a), owner(part.b)), []).append(part)
        for (a, b), parts in pairs.items():
            width, height = self.layout.sizes[a]
            for k, part in enumerate(parts):
                share = (k + 0.5) / len(parts) - 0.5
                # from above: below the name of the body, of a plate beside what lies on it
                low = -0.38 if a in self.layout.under.values() else -0.12
                spot = (share * 0.9 * width, low * height if self.layout.above else -height / 2 - 0.1)
                ends = [self._point(part.a, a, spot, b), self._point(part.b, b, spot, a)]
                # of a modal body the contact is at its point, of others somewhere on the body
                at: Spot = (self.number[a], *spot) if ends[0] == self.number[a] else (ends[0], 0.0, 0.0)
                self.sketch.touches.append(Touch(name=part.name, at=at))

    def _point(self, end: Any, name: str, spot: tuple[float, float], other: str) -> int:
        """A point of a modal body as a shape of its own; for other ends the number of their body."""
        if name == "ground" or not isinstance(self.scene[name], ModalBody):
            return self.number.get(name, GROUND_SHAPE)
        reference = name if name in self.number and self.layout.under.get(name) == other else other
        x, y = self.layout.places.get(reference, self.layout.places[name])
        first = reference == name
        here = np.zeros((3, self.n))
        # with its body, and as it moves relative to that
        here[:2] = self.sketch.places[self.number[name], :2] - np.array(self.layout.places[name])[:, None]
        here[:2] += self.scale * (self._of(end.end_name, end.body.axes) - self.own[name])
        here[:2] += np.array([[x + spot[0]], [y + spot[1]]])
        self.sketch.shapes.append(Shape(name="", face="dot" if first else "ring", outline=disc(0.07, 16)))
        self.sketch.places = np.concatenate((self.sketch.places, here[None]))
        return len(self.sketch.shapes) - 1

    # ---- links

    def _link(self, part: Any) -> None:
        a, b = getattr(part, "a", None), getattr(part, "b", None)
        if a is None or b is None or owner(a) == owner(b):
            return
        along = self._direction(part)
        first, second = owner(a), owner(b)
        if first == "ground":
            first, second = second, first
        if second == "ground":
            start, end = self._to_ground(first, along)
        else:
            start, end = self._between(first, second, along)
        level = abs(along[1]) < 1e-6
        side, extent = ("left", 1) if level else ("top", 0)
        # what stands side by side is drawn narrow enough not to touch; a gap belongs to the body on its right
        at = first if second == "ground" else max((first, second), key=lambda name: self.layout.places[name][0])
        room = 0.42 * self._step(at, side, self.layout.sizes[at][extent])
        wide = min(1.0, room / (0.22 * self.sketch.unit))
        kind, idle = link_kind(part), is_idle(part)
        self.sketch.links.append(Link(kind=kind, name=part.name, a=start, b=end, wide=wide, idle=idle))
        if second == "ground":
            angle = float(np.arctan2(end[2] - self._world(start)[1], end[1] - self._world(start)[0]))
            wall = min(0.35 * self.sketch.unit, room)
            self.sketch.marks.append(Mark(kind="wall", at=end, angle=angle, size=wall))

    def _world(self, spot: Spot) -> tuple[float, float]:
        """Where a spot stands in the layout."""
        x, y = self.layout.places[self.layout.order[spot[0]]]
        return x + spot[1], y + spot[2]

    def _direction(self, part: Any) -> Floats:
        """Unit direction of an element on paper."""
        forms = part.local_coordinates()
        anchor = [float(v) for v in getattr(part, "anchor", ())]
        if any(anchor):
            along = np.sum([v * self.letters[c] for v, c in zip(anchor, "xyz", strict=False)], axis=0)
        else:
            along = np.zeros(2)
            for name, coefficient in forms[0].terms[:1] if len(forms) > 1 else forms[0].terms:
                letter = name.rpartition(".")[2]
                if owner(part.a) == name.partition(".")[0] and letter in self.letters:
                    along += coefficient * self.letters[letter]
        length = float(np.hypot(*along))
        return along / length if length > 0.0 else np.array([1.0, 0.0])

    def _slot(self, name: str, side: str, room: float) -> float:
        """Where on a side the next link starts: all of a side about its middle, of a plate beside what it carries."""
        k = self._slots.get((name, side), 0)
        self._slots[name, side] = k + 1
        wanted = self._wanted.get((name, side), 1)
        carries = self.layout.above and name in self.layout.under.values()
        start, room = (0.7 * room / 2, 0.3 * room) if carries else (0.0, room)
        return start + (k - 0.5 * (wanted - 1)) * self._step(name, side, room)

    def _step(self, name: str, side: str, room: float) -> float:
        """Between the links on a side."""
        return min(_SLOT, 0.9 * room / self._wanted.get((name, side), 1))

    def _to_ground(self, name: str, along: Floats) -> tuple[Spot, Spot]:
        """From the rim of a body to an anchor beside all bodies, to the left, upwards, or between."""
        (x, y), (width, height) = self.layout.places[name], self.layout.sizes[name]
        left, _, _, top = self.layout.bounds
        k = self.number[name]
        if abs(along[1]) < 1e-6:
            down = -self._slot(name, "left", height)
            outer = left if self.layout.above else self._clear_left(name)
            return (k, -width / 2, down), (GROUND_SHAPE, outer - _ANCHOR, y + down)
        if abs(along[0]) < 1e-6:
            right = self._slot(name, "top", width)
            return (k, right, height / 2), (GROUND_SHAPE, x + right, top + _ANCHOR)
        up = along if along[1] > 0.0 else -along
        reach = min(width / 2 / abs(up[0]), height / 2 / abs(up[1]))
        rim = reach * up
        far = np.array([x, y]) + rim + up * (top + _ANCHOR - y - rim[1]) / max(up[1], 0.35)
        return (k, float(rim[0]), float(rim[1])), (GROUND_SHAPE, float(far[0]), float(far[1]))

    def _clear_left(self, name: str) -> float:
        """The left edge of what stands in the same row without a gap."""
        return self.layout.places[name][0] - self.layout.sizes[name][0] / 2 - 0.1

    def _between(self, first: str, second: str, along: Floats) -> tuple[Spot, Spot]:
        """Between facing edges of two bodies, or between a body and the rim of the plate that it lies on."""
        if self.layout.under.get(second) == first:
            first, second = second, first
        (x, y), (width, height) = self.layout.places[first], self.layout.sizes[first]
        (u, v), (wide, high) = self.layout.places[second], self.layout.sizes[second]
        level = abs(along[0]) >= abs(along[1])
        if self.layout.under.get(first) == second and self.layout.above:
            if level:
                at = self._slot(first, "right", height)
                return (self.number[first], width / 2, at), (self.number[second], wide / 2, y - v + at)
            at = self._slot(first, "low", width)
            return (self.number[first], at, -height / 2), (self.number[second], x - u + at, -high / 2)
        if abs(y - v) < 0.5 * height or (level and abs(x - u) > 0.5 * (width + wide)):
            right = 1.0 if u >= x else -1.0
            # the gap belongs to the body on its right, whose links to the ground stand in it, too
            at = -self._slot(second if right > 0 else first, "left", height)
            return (self.number[first], right * width / 2, at), (self.number[second], -right * wide / 2, at)
        # one above the other: beside them
        at = width / 2 + 0.15 + 0.3 * self._slots.get((first, "beside"), 0)
        self._slots[first, "beside"] = self._slots.get((first, "beside"), 0) + 1
        return (self.number[first], at, 0.0), (self.number[second], x - u + at, 0.0)


def _letters(scene: Any) -> dict[str, Floats]:
    """What each letter looks like on paper: where there is but one, it runs from left to right."""
    used = {name.rpartition(".")[2] for name in scene.motion_names} & set("xyz")
    used |= {c for body in scene.bodies if isinstance(body, ModalBody) for c in body.axes}
    moving = {name.rpartition(".")[2] for name in scene.dof_names} & set("xyz") or used
    if len(moving) == 1:
        (only,) = moving
        others = [c for c in "xyz" if c != only]
        return {only: np.array([1.0, 0.0]), others[0]: np.array([0.0, 1.0]), others[1]: np.array(_ON_PAPER["z"])}
    return {c: np.array(v) for c, v in _ON_PAPER.items()}


def _bands(found: Layout, moved: dict[str, Floats]) -> set[str]:
    """Bodies that are drawn with running strokes: driven ones, and those that travel far in one direction."""
    travel = {name: float(np.ptp(x, axis=1).max()) for name, x in moved.items()}
    free = {name: way for name, way in travel.items() if not found.moving[name] and way > 0.0}
    least = min(free.values(), default=1.0)
    bands = set()
    for name, x in moved.items():
        one_way = bool((np.abs(x[:, -1] - x[:, 0]) > _ONE_WAY * travel[name]).any())
        if travel[name] > 0.0 and (found.moving[name] or (one_way and travel[name] > _BAND * least)):
            bands.add(name)
    return bands
