"""A scene of rigid bodies as it stands: links, wheels and blocks, with pins, guides and supports, to scale."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.plot._layout import owner
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
    is_limit,
    link_kind,
    rounded,
)
from fricmb.scene import (
    Body,
    Contact,
    DrivenAngle,
    DrivenSlide,
    Fixed,
    Gear,
    Prismatic,
    Revolute,
    RigidBody,
    Rod,
    RollerOnCircle,
    RollerOnLine,
    Rope,
    Torque,
    TorsionSpring,
    Wheel,
)
from fricmb.values import value_of

#: Size of a pin as a share of the whole, and half the width of a link in pins.
_PIN, _HALF = 0.06, 0.55
#: Distance of springs and dampers that stand side by side, and of names above one another, in units.
_BESIDE, _LINE = 0.7, 0.4
#: A body of one point is a bar about its centre where its inertia is at least this share of such a bar's.
_SLENDER = 0.25


def linkage(scene: Any, position: Motion, t: Floats) -> Sketch:
    """The sketch of a scene with rigid bodies."""
    return _Linkage(scene, position, t).sketch


class _Linkage:
    """The making of a sketch."""

    def __init__(self, scene: Any, position: Motion, t: Floats) -> None:
        self.scene, self.position, self.n = scene, position, t.size
        self.joints = list(scene.joints)
        self.sketch = Sketch(title=str(scene.name), t=t)
        self.number: dict[str, int] = {}
        self._shift: dict[str, float] = {}  # how far wheels have been moved aside
        self.points = self._points()
        unit = self.sketch.unit = _PIN * self._extent()
        self.sketch.reach, self.sketch.letters = 2.2 * unit, 4.0 * unit
        self._bodies()
        self._spread()
        for joint in self.joints:
            self._joint(joint)
        for part in scene.parts:
            if isinstance(part, Contact):
                self.sketch.touches.append(Touch(name=part.name, at=self._spot(part.a)))
        for part in (*scene.elements, *filter(is_limit, self.joints)):
            self._element(part)
        self._beside()
        self._names()
        self.sketch.frame(2.2 * self.sketch.unit)

    def _beside(self) -> None:
        """Springs and dampers between the same two places stand side by side, and so high are their walls."""
        sketch = self.sketch
        found: dict[Any, list[Link]] = {}
        for link in sketch.links:
            if link.kind in ("spring", "damper"):
                ends = [tuple(np.round(sketch.where(end, 0) / sketch.unit, 2).tolist()) for end in (link.a, link.b)]
                found.setdefault(frozenset(ends), []).append(link)
        for links in found.values():
            for k, link in enumerate(links):
                apart = sketch.where(link.a, 0) - sketch.where(links[0].a, 0)
                way = _BESIDE if np.hypot(*apart) < 0.1 * sketch.unit else -_BESIDE
                link.side = way * (k - 0.5 * (len(links) - 1))
                for mark in sketch.marks:
                    if mark.kind == "wall" and mark.at in (link.a, link.b) and len(links) > 1:
                        mark.size = (0.5 * _BESIDE * (len(links) - 1) + 0.35) * sketch.unit

    def _names(self) -> None:
        """Names that would stand on one another stand above one another."""
        sketch = self.sketch
        taken: list[Floats] = []
        for k, shape in enumerate(sketch.shapes):
            at = sketch.turned(k, np.array([shape.label]), 0)[0] / sketch.unit
            turn = sketch.places[k, 2, 0]
            while shape.name and any(abs(at - other) @ [1.0, 4.0] < 1.4 for other in taken):
                at = at + np.array([0.0, _LINE])
                up = _LINE * sketch.unit * np.array([np.sin(turn), np.cos(turn)])
                shape.label = (shape.label[0] + up[0], shape.label[1] + up[1])
            taken.append(at)

    # ---- bodies

    def _points(self) -> dict[str, list[tuple[float, float]]]:
        """Where things hang on each rigid body, in its own axes."""
        found: dict[str, list[tuple[float, float]]] = {}
        for body in self.scene.bodies:
            if isinstance(body, RigidBody):
                found[body.name] = [(float(value_of(u)), float(value_of(v))) for u, v in body.points.values()]
        for point in self.scene.rigid_points.values():
            if point.offset not in found[point.body.name]:
                found[point.body.name].append(point.offset)
        return found

    def _extent(self) -> float:
        """Size of the whole at the first time, of a lone body its radius of gyration."""
        corners, gyration = [], []
        for name, points in self.points.items():
            body = self.scene[name]
            x, y, angle = (float(self.position(f"{name}.{c}")[0]) for c in ("x", "y", "angle"))
            turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
            corners += [np.array([x, y]), *(np.array(p) @ turn + [x, y] for p in points)]
            gyration.append(float(np.sqrt(value_of(body.inertia) / value_of(body.mass))))
        for joint in self.joints:
            for end in (joint.a, joint.b):
                if isinstance(joint, Wheel) and end is joint.a:
                    reach = float(value_of(joint.radius))
                    corners += [corners[0] + [reach, reach], corners[0] - [reach, reach]]
                if owner(end) == "ground":
                    corners.append(np.array(self._spot(end)[1:]))
        size = float(np.ptp(np.array(corners), axis=0).max()) if corners else 0.0
        return size if size > 0.0 else 4.0 * max(gyration, default=0.25)

    def _bodies(self) -> None:
        places: list[Floats] = []
        for part in (*self.scene.bodies, *self.scene.driven):
            here = np.zeros((3, self.n))
            for row, letter in enumerate(("x", "y", "angle")):
                if self.scene.has_motion(f"{part.name}.{letter}"):
                    here[row] = self.position(f"{part.name}.{letter}")
            self.number[part.name] = len(places)
            places.append(here)
            self.sketch.shapes.append(self._shape(part))
        self.sketch.places = np.array(places).reshape(-1, 3, self.n)

    def _shape(self, part: Any) -> Shape:
        unit, name = self.sketch.unit, str(part.name)
        if not isinstance(part, RigidBody):
            face, radius = "body" if part in self.scene.bodies else "moved", self._ball(name)
            if radius > 0.0:
                return Shape(name=name, face=face, outline=disc(radius), label=(0.0, -radius - 0.9 * unit))
            return Shape(name=name, face=face, outline=disc(0.8 * unit), label=(1.4 * unit, 1.3 * unit))
        points = list(dict.fromkeys(self.points[name]))
        away = [p for p in points if np.hypot(*p) > 1e-9]
        if not away:
            return self._plain(part)
        if len(points) == 1:
            (p,) = away
            bar = value_of(part.inertia) >= _SLENDER * value_of(part.mass) * np.hypot(*p) ** 2 / 3
            points.append((-p[0], -p[1]) if bar else (0.0, 0.0))
        outline = rounded(points, _HALF * unit)
        middle = np.mean(points, axis=0)
        return Shape(name=name, face="body", outline=outline, label=(float(middle[0]), float(middle[1]) + 1.1 * unit))

    def _are_balls(self, joint: RollerOnCircle) -> bool:
        """Whether a joint keeps two points as far apart as balls that touch: neither of them turns."""
        return joint.push_only and all(isinstance(end, Body) for end in (joint.a, joint.b))

    def _ball(self, name: str) -> float:
        """Radius of a body that touches others as a ball; 0: it is none."""
        for joint in self.joints:
            if not isinstance(joint, RollerOnCircle) or not self._are_balls(joint):
                continue
            if name in (owner(joint.a), owner(joint.b)):
                return float(value_of(joint.radius)) / 2
        return 0.0

    def _plain(self, body: RigidBody) -> Shape:
        """A body that nothing hangs on but at its centre: a block in a guide, else a wheel."""
        unit = self.sketch.unit
        guided = any(isinstance(j, Prismatic) and body.name in (owner(j.a), owner(j.b)) for j in self.joints)
        if guided:
            label = (0.0, 1.5 * unit)
            return Shape(name=body.name, face="body", outline=box(3.2 * unit, 1.8 * unit), label=label)
        radius = self._radius(body)
        spokes = [0.92 * radius * np.array([[0.0, 0.0], [np.cos(a), np.sin(a)]]) for a in (0.0, 2.1, 4.2)]
        outline = disc(radius)
        return Shape(name=body.name, face="body", outline=outline, marks=spokes, label=(0.0, radius + 0.7 * unit))

    def _radius(self, body: RigidBody) -> float:
        """Of a wheel: that of a gear it meshes in, else such that a disc has its inertia, if that is to be seen."""
        whole = self.sketch.unit / _PIN
        for joint in self.joints:
            if isinstance(joint, Wheel) and owner(joint.a) == body.name:
                return float(value_of(joint.radius))
            if isinstance(joint, Gear) and body.name in (owner(joint.a), owner(joint.b)):
                ratio = abs(float(value_of(joint.ratio)))
                first = owner(joint.a) == body.name
                a, b = (self.scene[owner(end)] for end in (joint.a, joint.b))
                apart = float(np.hypot(*(value_of(a.position[c]) - value_of(b.position[c]) for c in "xy")))
                span = apart if apart > 0.0 else 0.6 * whole
                return span * (1.0 / (1.0 + ratio) if first else ratio / (1.0 + ratio))
        own = float(np.sqrt(2.0 * value_of(body.inertia) / value_of(body.mass)))
        return min(max(own, 0.08 * whole), 0.4 * whole)

    def _spread(self) -> None:
        """Wheels on one place are drawn side by side: gears that mesh touch, others stand apart."""
        places, shapes = self.sketch.places, self.sketch.shapes
        wheels = [name for name, points in self.points.items() if not points and shapes[self.number[name]].marks]
        done: list[str] = []
        shifts = self._shift
        for name in wheels:
            k = self.number[name]
            same = [o for o in done if np.allclose(places[self.number[o], :2], places[k, :2])]
            if same:
                last = self.number[same[-1]]
                mesh = any(isinstance(j, Gear) and {owner(j.a), owner(j.b)} == {name, same[-1]} for j in self.joints)
                reach = shapes[last].outline[:, 0].max() + shapes[k].outline[:, 0].max()
                shifts[name] = shifts.get(same[-1], 0.0) + reach + (0.0 if mesh else 2.5 * self.sketch.unit)
            done.append(name)
        for name, shift in shifts.items():
            places[self.number[name], 0] += shift

    # ---- ends

    def _spot(self, end: Any) -> Spot:
        """Where an end is."""
        name = owner(end)
        if name == "ground":
            return (GROUND_SHAPE, float(getattr(end, "x", 0.0)), float(getattr(end, "y", 0.0)))
        offset = end.offset if hasattr(end, "offset") else (0.0, 0.0)
        return (self.number.get(name, GROUND_SHAPE), *offset)

    # ---- joints

    def _joint(self, joint: Any) -> None:
        sketch, a, b = self.sketch, self._spot(joint.a), self._spot(joint.b)
        fixed = b[0] == GROUND_SHAPE or a[0] == GROUND_SHAPE
        moved = a if a[0] != GROUND_SHAPE else b
        if isinstance(joint, Revolute):
            if fixed:
                sketch.marks.append(Mark(kind="support", at=self._at_ground(moved, a if b is moved else b)))
            sketch.marks.append(Mark(kind="pin", at=moved))
            if joint.friction is not None:
                sketch.touches.append(Touch(name=joint.name, at=moved, turns=True))
        elif isinstance(joint, Prismatic | RollerOnLine | DrivenSlide):
            long = 0.3 * sketch.unit / _PIN
            angle = float(value_of(joint.angle))
            sketch.marks.append(Mark(kind="line", at=b, angle=angle, size=max(long, 1.3 * self._reach(a, b, angle))))
            if getattr(joint, "friction", None) is not None:
                at = self._foot(joint, a, b) if isinstance(joint, Wheel) else a
                sketch.touches.append(Touch(name=joint.name, at=at))
        elif isinstance(joint, RollerOnCircle) and self._are_balls(joint):
            pass  # they are drawn as large as they are
        elif isinstance(joint, RollerOnCircle):
            sketch.marks.append(Mark(kind="circle", at=b, size=float(value_of(joint.radius))))
            if joint.friction is not None:
                sketch.touches.append(Touch(name=joint.name, at=a))
        elif isinstance(joint, Rod):
            sketch.links.append(Link(kind="rod", name=joint.name, a=a, b=b))
        elif isinstance(joint, Rope):
            self._rope(joint)
        elif isinstance(joint, Gear) and joint.friction is not None:
            sketch.touches.append(Touch(name=joint.name, at=moved, turns=True))
        elif isinstance(joint, Fixed):
            sketch.marks.append(Mark(kind="support" if fixed else "weld", at=b if fixed else a))
        elif isinstance(joint, DrivenAngle):
            sketch.marks.append(Mark(kind="turn", at=moved, size=2.2 * sketch.unit))

    def _foot(self, wheel: Wheel, a: Spot, b: Spot) -> Spot:
        """Where a wheel touches its line, which is no point of the wheel: a shape of its own."""
        sketch, radius = self.sketch, float(value_of(wheel.radius))
        here = np.zeros((3, self.n))
        for i in range(self.n):
            turn = sketch.angle(b, i) + float(value_of(wheel.angle))
            here[:2, i] = sketch.where(a, i) - radius * np.array([-np.sin(turn), np.cos(turn)])
        sketch.shapes.append(Shape(name="", face="dot", outline=disc(0.05 * sketch.unit, 16)))
        sketch.places = np.concatenate((sketch.places, here[None]))
        return len(sketch.shapes) - 1, 0.0, 0.0

    def _rope(self, rope: Rope) -> None:
        """Its drum as a circle, and what runs off it to both ends."""
        drum, radius = self._spot(rope.drum), abs(float(value_of(rope.radius))) or self.sketch.unit
        self.sketch.marks.append(Mark(kind="circle", at=drum, size=radius))
        for end in (rope.a, rope.b):
            if end is not rope.drum and owner(end) != "ground":
                self.sketch.links.append(Link(kind="rod", name=rope.name, a=self._spot(end), b=drum))
        self.sketch.touches.append(Touch(name=rope.name, at=drum, turns=True))

    def _at_ground(self, moved: Spot, ground: Spot) -> Spot:
        """The fixed end of a pin; beside its place for a wheel that was moved aside."""
        name = next((n for n, k in self.number.items() if k == moved[0]), "")
        return (ground[0], ground[1] + self._shift.get(name, 0.0), ground[2])

    def _reach(self, a: Spot, b: Spot, angle: float) -> float:
        """How far a point goes along a line from its middle."""
        steps = np.unique(np.linspace(0, self.n - 1, 40).astype(int))
        far = 0.0
        for i in steps.tolist():
            apart = self.sketch.where(a, i) - self.sketch.where(b, i)
            turn = self.sketch.angle(b, i) + angle
            far = max(far, abs(float(apart @ [np.cos(turn), np.sin(turn)])))
        return far + 2.0 * self.sketch.unit

    # ---- elements

    def _element(self, part: Any) -> None:
        sketch = self.sketch
        if isinstance(part, Torque):
            sketch.marks.append(Mark(kind="turn", at=self._spot(part.body), size=2.2 * sketch.unit))
            return
        a, b = getattr(part, "a", None), getattr(part, "b", None)
        if a is None or b is None:
            return
        start, end = self._spot(a), self._spot(b)
        name = type(part).__name__
        if "Torsion" in name:
            self._torsion(part, start, end)
            return
        kind = link_kind(part)
        if kind == "play" and part.local_coordinates()[0].motions[0].endswith(".angle"):
            if end[0] != GROUND_SHAPE:
                sketch.links.append(Link(kind=kind, name=part.name, a=start, b=end))
            return
        if end[0] == GROUND_SHAPE and kind == "play" and getattr(part, "axis", None) in ("x", "y"):
            self._walls(part, start)
            return
        if end[0] == GROUND_SHAPE:
            end = self._anchor(part, start, end)
            here = self.sketch.where(start, 0)
            angle = float(np.arctan2(end[2] - here[1], end[1] - here[0]))
            sketch.marks.append(Mark(kind="wall", at=end, angle=angle))
        sketch.links.append(Link(kind=kind, name=part.name, a=start, b=end))

    def _walls(self, part: Any, start: Spot) -> None:
        """Where limits along an axis are, as walls that what moves runs against."""
        sketch, row, number = self.sketch, "xy".index(part.axis), start[0]
        here = sketch.where(start, 0)
        outline = sketch.turned(number, sketch.shapes[number].outline, 0)
        rim, size = outline[:, row] - here[row], 0.5 * float(np.ptp(outline[:, 1 - row]))
        for limit, side, beyond in zip(part.limits(), (-1.0, 1.0), (rim.min(), rim.max()), strict=True):
            if limit is not None:
                at = here.copy()
                at[row] = float(value_of(limit)) + beyond
                angle = float(np.arctan2(side, 0.0) if row else np.arctan2(0.0, side))
                spot = (GROUND_SHAPE, float(at[0]), float(at[1]))
                sketch.marks.append(Mark(kind="wall", at=spot, angle=angle, size=size))

    def _torsion(self, part: Any, start: Spot, end: Spot) -> None:
        """A spiral at the pin of a body that is held from the ground, a coiled shaft between two wheels."""
        if end[0] == GROUND_SHAPE or np.allclose(self.sketch.where(start, 0), self.sketch.where(end, 0)):
            pins = [m.at for m in self.sketch.marks if m.kind == "pin" and m.at[0] == start[0]]
            if isinstance(part, TorsionSpring):
                self.sketch.marks.append(Mark(kind="spiral", at=pins[0] if pins else start))
            return
        side = 0.0 if isinstance(part, TorsionSpring) else 0.9
        kind = "spring" if isinstance(part, TorsionSpring) else "damper"
        self.sketch.links.append(Link(kind=kind, name=part.name, a=start, b=end, side=side))

    def _anchor(self, part: Any, start: Spot, end: Spot) -> Spot:
        """Where a spring is held: its anchor, or for one along an axis a place that far from the body."""
        if hasattr(part, "anchor"):
            u, v = (float(x) for x in value_of(part.anchor))
            return (GROUND_SHAPE, u, v)
        along = np.zeros(2)
        for name, coefficient in part.local_coordinates()[0].terms:
            letter = name.rpartition(".")[2]
            if letter in "xy" and name.partition(".")[0] == owner(part.a):
                along["xy".index(letter)] += coefficient
        length = float(np.hypot(*along))
        along = along / length if length > 0.0 else np.array([1.0, 0.0])
        far = self.sketch.where(start, 0) - 6.0 * self.sketch.unit * along
        return (GROUND_SHAPE, float(far[0]), float(far[1]))
