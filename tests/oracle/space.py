"""Bodies in space with dry friction: trees of bodies on dry ball joints and hinges, tops, coins and balls on a floor.

As fricmb has them (axes as coordinates, joints as constraints), and in angles and joint coordinates, without
constraints.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .judge import Case
from .laws import parts_of
from .problem import Contact, Problem
from .turning import EZ, Body, Pose, Tree, about, axle, ball_joint, cross, floor, wheel

G = 9.81
EX = np.array([1.0, 0.0, 0.0])
AXES = "xyz"
Triple = tuple[float, float, float]


@dataclass
class Link:
    """A body and the joint that carries it.

    ``joint``: "spherical", "revolute", "cylindrical", "prismatic" (along z at the start), at ``there`` of the one
    before (of the ground: a place in space) and at ``own`` of its own axes; or "edge", "tip", "ball", on the floor.  A
    ``round`` one has equal moments across its third axis, on which its points lie.
    """

    joint: str
    mass: float
    inertia: Triple
    start: list[float]
    rates: list[float]
    round: bool = False
    there: Triple = (0.0, 0.0, 0.0)
    own: Triple = (0.0, 0.0, 0.0)
    axis: Triple = (0.0, 0.0, 1.0)
    law: str = ""
    fields: dict[str, float] = field(default_factory=dict)
    radius: float = 0.0
    length: float = 0.0
    thrust: float = 0.0
    width: float = 0.0
    reach: float = 0.0
    """``start``: a rotation vector, or on the floor x, y, heading, tilt, spin; ``radius``: what slips, or touches."""

    @property
    def on_floor(self) -> bool:
        """Whether it stands on the floor."""
        return self.joint in ("edge", "tip", "ball")


@dataclass
class Push:
    """A force along an axis of space on a body's centre: constant + amplitude sin(omega t + phase)."""

    body: int
    axis: int
    constant: float
    amplitude: float
    omega: float
    phase: float


@dataclass
class Bodies:
    """A tree of links; each carries the next. ``springs``: body, axis, stiffness, damping, to the ground."""

    kind: str
    links: list[Link]
    t_end: float
    springs: list[tuple[int, int, float, float]] = field(default_factory=list)
    pushes: list[Push] = field(default_factory=list)
    torque: Triple | None = None
    """On the last, constant, fixed in space."""

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def case_of(spec: Bodies) -> Case:
    """Both forms."""
    tree = tree_of(spec)
    return Case(
        name=spec.kind, scene=scene(spec, tree), problem=numbers(spec, tree), signals=signals(spec),
        seen=seen(spec, tree),
    )  # fmt: skip


# -- in angles ------------------------------------------------------------------------------------------------------
def start(spec: Bodies) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and their rates: angles of joints count from the start."""
    q = [x for link in spec.links for x in (link.start if link.on_floor else [0.0] * len(link.rates))]
    return np.array(q), np.array([x for link in spec.links for x in link.rates])


def turned(link: Link) -> np.ndarray:
    """How a link that hangs stands at the start."""
    angle = float(np.linalg.norm(link.start))
    return about(np.array(link.start) / angle, angle) if angle else np.eye(3)


def tree_of(spec: Bodies) -> Tree:
    """The recursion."""
    bodies: list[Body] = []
    first, before = 0, np.eye(3)
    for i, link in enumerate(spec.links):
        if link.on_floor:
            joint = floor(
                edge=link.radius if link.joint == "edge" else 0.0, reach=link.reach if link.joint == "tip" else 0.0,
                tip=link.radius,
            )  # fmt: skip
        else:
            R0 = turned(link)
            places = {"there": np.array(link.there), "own": np.array(link.own), "R0": R0}
            if link.joint == "spherical":
                joint = ball_joint(**places)
            else:
                ways = {"turns": link.joint != "prismatic", "slides": link.joint in ("cylindrical", "prismatic")}
                joint = axle(**places, R0_before=before, axis=np.array(link.axis), **ways)
            before = R0
        bodies.append(Body(mass=link.mass, inertia=link.inertia, joint=joint, before=i - 1, first=first))
        first += len(link.rates)

    def load(t: float, i: int, pose: Pose) -> tuple[np.ndarray, np.ndarray]:
        F, torque = -spec.links[i].mass * G * EZ, np.zeros(3)
        for body, axis, k, c in spec.springs:
            if body == i:
                F[axis] -= k * pose.x[axis] + c * pose.v[axis]
        for p in spec.pushes:
            if p.body == i:
                F[p.axis] += p.constant + p.amplitude * math.sin(p.omega * t + p.phase)
        if spec.torque is not None and i == len(spec.links) - 1:
            torque += spec.torque
        return F, torque

    return Tree(bodies, load)


def numbers(spec: Bodies, tree: Tree) -> Problem:
    """As the oracle has it."""
    q, v = start(spec)
    dry = [i for i, link in enumerate(spec.links) if link.law]

    def slip(q: np.ndarray) -> np.ndarray:
        poses = tree.poses(q, np.zeros(q.size))
        return np.hstack([rows(spec, tree, i, poses, q.size).T for i in dry])

    def slip_rate(q: np.ndarray, v: np.ndarray) -> np.ndarray:
        poses = tree.poses(q, v)
        return np.concatenate([changes(spec, i, poses) for i in dry])

    zero = np.zeros((q.size, q.size))
    return Problem(
        M=zero, C=zero, K=zero, q=q, v=v, t_end=spec.t_end, mass=tree.mass, extra=tree.given, slip=slip,
        slip_rate=slip_rate, contacts=tuple(contact(spec, tree, i, q.size) for i in dry),
    )  # fmt: skip


def before(i: int, poses: list[Pose], what: str) -> Any:
    """Of the body that carries body ``i``; 0 for the ground."""
    return getattr(poses[i - 1], what) if i else 0.0


def levers(link: Link) -> list[float]:
    """What slips of the joint's own coordinates, where these are those of a hinge, a sleeve or a guide."""
    return {"revolute": [link.radius], "cylindrical": [link.radius, 1.0], "prismatic": [1.0]}[link.joint]


def rows(spec: Bodies, tree: Tree, i: int, poses: list[Pose], n: int) -> np.ndarray:
    """What slips at the joint of body ``i``, of all rates."""
    link, pose = spec.links[i], poses[i]
    if link.on_floor:
        return (pose.Jv - wheel(pose.touch) @ pose.Jw)[:2]
    if link.joint == "spherical":
        return link.radius * (pose.Jw - before(i, poses, "Jw"))
    own = np.diag(levers(link))
    out, first = np.zeros((len(own), n)), tree.bodies[i].first
    out[:, first : first + len(own)] = own
    return out


def changes(spec: Bodies, i: int, poses: list[Pose]) -> np.ndarray:
    """Of slip, if all rates stayed."""
    link, pose = spec.links[i], poses[i]
    if link.on_floor:
        return (pose.bv + cross(pose.bw, pose.touch) + cross(pose.omega, pose.touch_rate))[:2]
    if link.joint == "spherical":
        return link.radius * (pose.bw - before(i, poses, "bw"))
    return np.zeros(len(levers(link)))


def contact(spec: Bodies, tree: Tree, i: int, n: int) -> Contact:
    """The joint of body ``i`` with its law."""
    link = spec.links[i]
    d = 2 if link.on_floor else 3 if link.joint == "spherical" else len(levers(link))

    def N(t: float, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> float:
        force, torque = tree.borne(i, t, q, v, a)
        if link.on_floor:
            return abs(float(force[2]))
        if link.joint == "spherical":
            return float(np.linalg.norm(force))
        e = tree.poses(q, v)[i].R @ np.array(link.axis)
        radial = force - (force @ e) * e
        couple = cross(torque, e) / link.length if link.length else np.zeros(3)
        ends = [radial / 2 + couple, radial / 2 - couple]
        if link.joint == "prismatic":  # each end is two shoes, side by side along what was x at the start
            w = cross(e, tree.poses(q, v)[i].R @ turned(link).T @ EX)
            twist = torque @ e / link.width / 2 * w if link.width else np.zeros(3)
            ends = [end / 2 + sign * twist for end in ends for sign in (1.0, -1.0)]
        thrust = link.thrust / link.radius * abs(force @ e) if link.thrust else 0.0
        return float(sum(np.linalg.norm(end) for end in ends) + thrust)

    return Contact(
        name=f"j{i}", W=np.zeros((n, d)), N=lambda t, q, v: math.nan, reaction=N, **parts_of(law_of(link), d)
    )


def law_of(link: Link) -> Any:
    """Its friction law."""
    return getattr(fm.laws, link.law)(**link.fields)


# -- fricmb ---------------------------------------------------------------------------------------------------------
def scene(spec: Bodies, tree: Tree) -> Any:
    """As fricmb has it."""
    q, v = start(spec)
    parts: list[Any] = [fm.Gravity("gravity", acceleration={"z": -G})]
    bodies: list[Any] = []
    for i, (link, pose) in enumerate(zip(spec.links, tree.poses(q, v), strict=True)):
        body = body_of(f"b{i}", link, pose, spec.links[i + 1].there if i + 1 < len(spec.links) else None)
        parts += [body, joint_of(f"j{i}", link, pose, body, bodies[-1] if bodies else None)]
        bodies.append(body)
    for number, (i, axis, k, c) in enumerate(spec.springs):
        parts.append(fm.Spring(f"k{number}", bodies[i], axis=AXES[axis], stiffness=k))
        if c:
            parts.append(fm.Damper(f"d{number}", bodies[i], axis=AXES[axis], damping=c))
    for number, p in enumerate(spec.pushes):
        value = p.constant + p.amplitude * sympy.sin(p.omega * fm.t + p.phase)
        parts.append(fm.Force(f"f{number}", bodies[p.body], axis=AXES[p.axis], value=value))
    if spec.torque is not None:
        size = math.sqrt(sum(x * x for x in spec.torque))
        parts.append(fm.space.Torque("torque", bodies[-1], axis=spec.torque, value=size))
    return fm.Scene(spec.kind, parts)


def body_of(name: str, link: Link, pose: Pose, carries: Triple | None) -> Any:
    """Its body; ``carries``: where the next one hangs on it."""
    moves = {"mass": link.mass, "position": pose.x, "velocity": pose.v}
    if link.joint == "ball":
        return fm.space.Ball(name, radius=link.radius, inertia=link.inertia[0], angular_velocity=pose.omega, **moves)
    if link.round:
        stations = {"own": link.own[2] if not link.on_floor else -link.reach}
        if carries is not None:
            stations["next"] = carries[2]
        return fm.space.Rotor(
            name, inertia_across=link.inertia[0], inertia_axial=link.inertia[2], axis=pose.R[:, 2],
            angular_velocity=pose.omega, stations=stations, **moves,
        )  # fmt: skip
    points = {"own": link.own} | ({"next": carries} if carries is not None else {})
    return fm.space.RigidBody(
        name, inertia=link.inertia, orientation=pose.R, angular_velocity=pose.omega, points=points, **moves
    )


def joint_of(name: str, link: Link, pose: Pose, body: Any, other: Any) -> Any:
    """Its joint."""
    friction = {"friction": law_of(link)} if link.law else {}
    if link.on_floor:
        end = body.station("own") if link.joint == "tip" else body
        size = {"radius": link.radius} if link.joint != "ball" else {}
        return fm.space.OnPlane(name, end, normal=(0, 0, 1), **size, **friction)
    ends = place(body, "own"), fm.space.ground_point(*link.there) if other is None else place(other, "next")
    if link.joint == "spherical":
        return fm.space.Spherical(name, *ends, **({"radius": link.radius, **friction} if friction else {}))
    kind = {"revolute": fm.space.Revolute, "cylindrical": fm.space.Cylindrical, "prismatic": fm.space.Prismatic}
    own = {"revolute": "radius length thrust_radius", "cylindrical": "radius length", "prismatic": "length width"}
    given = {"radius": link.radius, "length": link.length, "thrust_radius": link.thrust, "width": link.width}
    bearing = {name: given[name] for name in own[link.joint].split()} if friction else {}
    return kind[link.joint](name, *ends, axis=pose.R @ np.array(link.axis), **bearing, **friction)


def place(body: Any, name: str) -> Any:
    """A point of a body, by whichever name its kind has for that."""
    return body.station(name) if isinstance(body, fm.space.Rotor) else body.point(name)


# -- what is compared -----------------------------------------------------------------------------------------------
def signals(spec: Bodies) -> tuple[str, ...]:
    """Centres of mass, and axes (of balls the turns, of which rates alone can be compared, left out)."""
    names: list[str] = []
    for i, link in enumerate(spec.links):
        names += [f"b{i}.{c}" for c in AXES]
        if link.joint == "ball":
            continue
        axes = ["axis"] if link.round else ["d1", "d2", "d3"]
        names += [f"b{i}.{axis}_{c}" for axis in axes for c in AXES]
    return tuple(names)


def seen(spec: Bodies, tree: Tree) -> Any:
    """Those of the oracle's coordinates."""

    def of(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        columns = [one(tree.poses(q[:, k].copy(), v[:, k].copy())) for k in range(t.size)]
        return np.array([c[0] for c in columns]).T, np.array([c[1] for c in columns]).T

    def one(poses: list[Pose]) -> tuple[np.ndarray, np.ndarray]:
        where, rates = [], []
        for link, pose in zip(spec.links, poses, strict=True):
            where.append(pose.x)
            rates.append(pose.v)
            for k in () if link.joint == "ball" else (2,) if link.round else (0, 1, 2):
                where.append(pose.R[:, k])
                rates.append(cross(pose.omega, pose.R[:, k]))
        return np.concatenate(where), np.concatenate(rates)

    return of
