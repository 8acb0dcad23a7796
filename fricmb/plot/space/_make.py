"""From a scene with bodies in space, or a run of it, to its sketch."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb.plot._contact import static_limit
from fricmb.plot._layout import owner
from fricmb.plot._make_sketch import check_drawn
from fricmb.plot._sketch import Floats, Motion, link_kind, motions_at_start, motions_of
from fricmb.plot.space._shapes import axle, ball, cone, cuboid, cylinder_of, disc, edges_of
from fricmb.plot.space._sketch import FIXED, Floor, Solid, SpaceLink, SpaceSketch, SpaceTouch, Spot
from fricmb.plot.space._turns import turns_of
from fricmb.scene import Contact, RigidBody, SpaceBody, t
from fricmb.values import is_expression, value_of

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Size of what has none of its own, as a share of how far bodies are apart.
SMALL = 0.05
#: An end of a spring on the ground is this share of the whole away from the body, where nothing says where it is.
AWAY = 0.35


def space_sketch_of_scene(scene: Any) -> SpaceSketch:
    """A scene as it stands at the start."""
    check_drawn(scene)
    return _Making(scene, motions_at_start(scene), np.zeros(1)).sketch


def space_sketch_of_run(sol: Solution, times: Floats) -> SpaceSketch:
    """A run at given times, with the forces and modes of its contacts."""
    check_drawn(sol.scene)
    seen = sol.at(times)
    making = _Making(sol.scene, motions_of(seen), times)
    for touch in making.sketch.touches:
        touch.mode = seen.mode(touch.name)
        directions = _directions(sol.scene[touch.name])
        if directions is not None:
            force = directions.T @ seen.force(touch.name)[: len(directions)]  # a moment is no arrow
            limit = static_limit(seen, touch.name)
            most = float((np.linalg.norm(force, axis=0) if limit is None else limit).max(initial=0.0))
            touch.force = force / (most or 1.0)
    return making.sketch


#: Lines that show a tube.
LINES = 16


def _directions(part: Any) -> Floats | None:
    """Directions of space (d, 3) that a friction force has; None where it is none at a point."""
    from fricmb.space import OnPlane, Pad, WheelRail

    if isinstance(part, OnPlane | WheelRail | Pad):
        return np.asarray(part.frame()[:2])
    if isinstance(part, Contact):
        along = np.zeros((len(part.directions()), 3))
        for k, row in enumerate(part.directions()):
            for letter, share in row.vector:
                if letter in "xyz":  # about an angle it is a moment
                    along[k, "xyz".index(letter)] += share
        return along
    return None


class _Making:
    """The making of a sketch."""

    def __init__(self, scene: Any, position: Motion, times: Floats) -> None:
        self.scene, self.position, self.n = scene, position, times.size
        self.sketch = SpaceSketch(title=str(scene.name), t=times)
        self.number: dict[str, int] = {}
        bodies = [body for body in (*scene.bodies, *scene.driven) if self._has_place(body)]
        self.sketch.places = np.array([self._place(body) for body in bodies])
        self.sketch.turns = np.array([turns_of(body, position, self.n) for body in bodies])
        self.extent = self._extent(bodies)
        for body in bodies:
            self.number[body.name] = len(self.number)
            self.sketch.solids.append(self._solid(body))
        for joint in scene.joints:
            self._joint(joint)
        for part in scene.contacts:
            if isinstance(part, Contact):
                self.sketch.touches.append(SpaceTouch(name=part.name, at=self._at(part.a)))
        for part in scene.elements:
            self._link(part)
        self.sketch.frame()

    # ---- bodies

    def _has_place(self, body: Any) -> bool:
        return any(self.scene.has_motion(f"{body.name}.{letter}") for letter in "xyz")

    def _place(self, body: Any) -> Floats:
        """Where a body is (3, n)."""
        found = np.zeros((3, self.n))
        for row, letter in enumerate("xyz"):
            if self.scene.has_motion(f"{body.name}.{letter}"):
                found[row] = self.position(f"{body.name}.{letter}")
        return found

    def _extent(self, bodies: list[Any]) -> float:
        """How far apart bodies and fixed points are at the first time, or how large the largest body is."""
        corners = [*self.sketch.places[:, :, 0]]
        for joint in self.scene.joints:
            corners += [self._at(end)[:, 0] for end in (joint.a, joint.b) if hasattr(end, "letters") and end.letters]
        own = [np.sqrt(max(body.masses()) / body.masses()[0]) for body in bodies if isinstance(body, SpaceBody)]
        return float(max(np.ptp(np.array(corners), axis=0).max(), *own, 1e-290))

    def _solid(self, body: Any) -> Solid:
        import fricmb.space as space

        name = str(body.name)
        if isinstance(body, space.Ball):
            return ball(name, float(value_of(body.radius)))
        if isinstance(body, space.Rotor):
            return self._rotor(body)
        if isinstance(body, space.RigidBody):
            inertia = np.array([float(value_of(J)) for J in body.inertia])
            return self._with_arms(cuboid(name, edges_of(float(value_of(body.mass)), inertia)), body.points.values())
        if isinstance(body, RigidBody):
            edge = float(np.sqrt(6.0 * value_of(body.inertia) / value_of(body.mass)))
            arms = [(u, v, 0.0) for u, v in body.points.values()]
            return self._with_arms(cuboid(name, edge * np.array([1.0, 1.0, SMALL])), arms)
        return ball(name, SMALL * self.extent)

    def _with_arms(self, solid: Solid, points: Any) -> Solid:
        """Lines to the points of a body that lie outside of what it is drawn as."""
        reach = np.abs(solid.corners()).max(axis=0)
        for point in points:
            end = np.array([float(value_of(x)) for x in point])
            if (np.abs(end) > reach).any():
                solid.edge(np.array([np.zeros(3), end]))
        return solid

    def _rotor(self, body: Any) -> Solid:
        """The disc whose edge touches a plane, else the cylinder that has its inertia; tips, the axis."""
        wheels = self._wheels(body)
        if wheels:
            return axle(str(body.name), wheels)
        mass, _, _, across, _, _, axial = body.masses()
        radius, half = cylinder_of(mass, across, axial)
        radius = next((float(value_of(joint.radius)) for joint in self._edges(body)), radius)
        tips = self._tips(body)
        half = min(half, 3.0 * radius, *(0.5 * abs(tip) for tip in tips if tip != 0.0))
        solid = disc(str(body.name), radius, half)
        for tip in tips:
            if abs(tip) > half:
                solid.joined(cone(solid.name, 0.6 * radius, float(np.sign(tip)) * half, tip), np.zeros(3))
        ends = [float(value_of(x)) for x in body.stations.values()] + [-half, half]
        if max(ends) - min(ends) > 2.0 * half:
            solid.edge(np.array([[0.0, 0.0, min(ends)], [0.0, 0.0, max(ends)]]))
        return solid

    def _wheels(self, body: Any) -> list[tuple[float, float]]:
        """Places of wheels on an axle, and their radii."""
        from fricmb.space import WheelRail

        held: list[Any] = [j for j in self.scene.joints if isinstance(j, WheelRail) and j.a.owner is body]
        return [(j.a.offset[0], float(value_of(j.rolling_radius))) for j in held]

    def _edges(self, body: Any) -> list[Any]:
        """Contacts of the edge of a disc."""
        from fricmb.space import OnPlane

        return [j for j in self.scene.joints if isinstance(j, OnPlane) and j.a is body and j.shape == "edge"]

    def _tips(self, body: Any) -> list[float]:
        """Stations that a rotor stands on, or hangs from."""
        from fricmb.space import OnPlane, Spherical

        standing = [j for j in self.scene.joints if isinstance(j, OnPlane | Spherical)]
        return [end.offset[0] for j in standing for end in (j.a, j.b) if end.owner is body and hasattr(end, "offset")]

    # ---- ends

    def _at(self, end: Any) -> Floats:
        """Where an end is (3, n)."""
        found = np.zeros((3, self.n))
        for row, letter in enumerate("xyz"):
            if end.letters is None or letter in end.letters:
                form = end.motion(letter)
                found[row] = form.constant + sum(c * self.position(name) for name, c in form.terms)
        return found

    def _spot(self, end: Any) -> Spot:
        """The solid that an end is on, and where on it."""
        solid = self.number.get(owner(end), FIXED)
        if solid == FIXED:
            return FIXED, self._at(end)[:, 0]
        apart = self._at(end)[:, 0] - self.sketch.places[solid, :, 0]
        return solid, self.sketch.turns[solid, :, :, 0].T @ apart

    # ---- joints, contacts, springs

    def _joint(self, joint: Any) -> None:
        from fricmb.space import InCylinder, OnPlane, Pad, Rod, WheelRail

        sketch = self.sketch
        if isinstance(joint, Rod):
            sketch.links.append(SpaceLink(kind="rod", a=self._spot(joint.a), b=self._spot(joint.b)))
            return
        if isinstance(joint, OnPlane):
            at = self._lowest(joint)
            start = np.array([float(c) for c in value_of(joint.through)])
            sketch.floors.append(Floor(through=start, frame=joint.frame(), angle=self._turned(joint.turning)))
        elif isinstance(joint, WheelRail):
            along, up = joint.direction("along"), joint.direction("up")
            at = self._at(joint.a) - float(value_of(joint.rolling_radius)) * up[:, None]
            run = (at.T - at[:, 0]) @ along
            reach = float(value_of(joint.rolling_radius))
            ends = np.array([run.min() - 2.0 * reach, run.max() + 2.0 * reach])
            sketch.rails.append(np.array([float(c) for c in value_of(joint.through)]) + np.outer(ends, along))
        elif isinstance(joint, InCylinder):
            at = self._tube(joint)
        elif isinstance(joint, Pad):
            at = self._pressed(joint)
        elif not getattr(joint.a, "letters", None):
            return
        else:
            at = self._at(joint.a)
            sketch.pins.append(self._spot(joint.a))
        if joint.friction is not None:
            sketch.touches.append(SpaceTouch(name=joint.name, at=at))

    def _tube(self, joint: Any) -> Floats:
        """Where a ball touches a tube (3, n); the tube by lines along it, as far as the ball comes."""
        u, w, e = joint.frame()
        start = np.array([float(c) for c in value_of(joint.through)])
        own, radius = float(value_of(joint.a.radius)), float(value_of(joint.radius))
        place = self._at(joint.a)
        apart = place - start[:, None]
        outward = apart - np.outer(e, e @ apart)
        ends = np.array([(e @ apart).min() - 2.0 * own, (e @ apart).max() + 2.0 * own])
        for angle in np.linspace(0.0, 2.0 * np.pi, LINES, endpoint=False):
            foot = start + radius * (np.cos(angle) * u + np.sin(angle) * w)
            self.sketch.rails.append(foot + np.outer(ends, e))
        return np.asarray(place + own * outward / np.linalg.norm(outward, axis=0))

    def _pressed(self, pad: Any) -> Floats:
        """Where a pad touches (3, n); its spring, from the face outward."""
        place, normal = np.array([float(c) for c in value_of(pad.at)]), pad.direction("normal")
        away = place + AWAY * self.extent * normal
        self.sketch.links.append(SpaceLink(kind="spring", a=(FIXED, place), b=(FIXED, away)))
        return np.repeat(place[:, None], self.n, axis=1)

    def _lowest(self, joint: Any) -> Floats:
        """Where a body touches a plane (3, n)."""
        place, e = self._at(joint.a), joint.frame()[2][:, None]
        if joint.shape == "ball":
            return np.asarray(place - float(value_of(joint.a.owner.radius)) * e)
        if joint.shape == "point":
            return place
        radius = float(value_of(joint.radius))
        if joint.shape == "tip":
            return np.asarray(place - radius * e)
        n = np.array([self.position(f"{joint.a.owner.name}.axis_{c}") for c in "xyz"])
        along = (e * n).sum(axis=0)
        across = np.sqrt(np.maximum(1e-12, 1.0 - along**2))
        return np.asarray(place - radius * (e - along * n) / across)

    def _turned(self, rate: Any) -> Floats:
        """How far a turntable has turned (n,)."""
        times = self.sketch.t
        if not is_expression(rate):
            return float(value_of(rate)) * times
        rates = np.array([float(value_of(rate.subs({t: time}))) for time in times])
        steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(times)
        return np.concatenate([[rates[0] * times[0]], rates[0] * times[0] + np.cumsum(steps)])

    def _link(self, part: Any) -> None:
        """A spring or a damper."""
        a, b = getattr(part, "a", None), getattr(part, "b", None)
        kind = link_kind(part)
        if a is None or b is None or "Torsion" in type(part).__name__ or not a.letters:
            return
        start = self._spot(a)
        end = self._anchor(part, start) if owner(b) == "ground" else self._spot(b)
        self.sketch.links.append(SpaceLink(kind=kind, a=start, b=end))

    def _anchor(self, part: Any, start: Spot) -> Spot:
        """The end on the ground: its own, or for a spring along an axis a place some way along it."""
        if part.b.letters is not None:
            return self._spot(part.b)
        if hasattr(part, "anchor"):
            given = [float(x) for x in value_of(part.anchor)]
            return FIXED, np.array([*given, 0.0][:3])
        along = np.zeros(3)
        for name, coefficient in part.local_coordinates()[0].terms:
            letter = name.rpartition(".")[2]
            if letter in ("x", "y", "z") and name.partition(".")[0] == owner(part.a):
                along["xyz".index(letter)] += coefficient
        length = float(np.linalg.norm(along))
        along = along / length if length > 0.0 else np.array([1.0, 0.0, 0.0])
        return FIXED, self.sketch.where(start, 0) - AWAY * self.extent * along
