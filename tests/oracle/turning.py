"""Rigid bodies in space in angles and joint coordinates: Kane's equations by recursion from each body to the next."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .problem import OracleError

EZ = np.array([0.0, 0.0, 1.0])
#: Sine or cosine of an angle below which the other two cannot be told from each other any more.
UPRIGHT = 0.05
Array = np.ndarray


@dataclass
class Pose:
    """A body at an instant; what its velocities would change by if all generalised accelerations were 0."""

    x: Array
    R: Array
    v: Array
    omega: Array
    Jv: Array
    Jw: Array
    bv: Array
    bw: Array
    hinge: Array = field(default_factory=lambda: np.zeros(3))
    """Where the joint is that carries the body."""
    touch: Array = field(default_factory=lambda: np.zeros(3))
    """From the centre of mass to where it touches the floor."""
    touch_rate: Array = field(default_factory=lambda: np.zeros(3))


#: Of a joint: the pose of a body from that of the one before (None: the ground), its first coordinate, q and v.
Joint = Callable[[Pose | None, int, Array, Array], Pose]


def wheel(w: Array) -> Array:
    """The matrix of ``w x``."""
    return np.array([[0.0, -w[2], w[1]], [w[2], 0.0, -w[0]], [-w[1], w[0], 0.0]])


def cross(a: Array, b: Array) -> Array:
    """``a x b`` of two vectors in space; numpy's own takes stacks of them, and ten times as long for two."""
    (x, y, z), (u, v, w) = a, b
    return np.array([y * w - z * v, z * u - x * w, x * v - y * u])


def about(axis: Array, angle: float) -> Array:
    """The rotation about a unit vector."""
    K = wheel(axis)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def ground(n: int) -> Pose:
    """What does not move."""
    zero = np.zeros(3)
    return Pose(zero, np.eye(3), zero, zero, np.zeros((3, n)), np.zeros((3, n)), zero, zero)


def carried(before: Pose, R: Array, Jw: Array, bw: Array, v: Array, there: Array, own: Array) -> Pose:
    """A body that turns like this, its point ``own`` (body axes) at the point ``there`` (axes of the one before)."""
    omega, r, s = Jw @ v, before.R @ there, R @ own
    Jv = before.Jv - wheel(r) @ before.Jw + wheel(s) @ Jw
    bv = before.bv + cross(before.bw, r) + cross(before.omega, cross(before.omega, r))
    bv = bv - cross(bw, s) - cross(omega, cross(omega, s))
    return Pose(before.x + r - s, R, Jv @ v, omega, Jv, Jw, bv, bw, hinge=before.x + r)


def ball_joint(*, there: Array, own: Array, R0: Array) -> Joint:
    """Three angles about x, then the new y, then the new z, from how the body stands at the start."""

    def pose(before: Pose | None, at: int, q: Array, v: Array) -> Pose:
        before = before or ground(q.size)
        a, b, c = q[at : at + 3]
        first = about(np.array([1.0, 0.0, 0.0]), a)
        second = first @ about(np.array([0.0, 1.0, 0.0]), b)
        axes = [np.array([1.0, 0.0, 0.0]), first[:, 1], second[:, 2]]
        Jw = np.zeros((3, q.size))
        Jw[:, at : at + 3] = np.array(axes).T
        if abs(np.cos(b)) < UPRIGHT:
            raise OracleError("angles are near where they are singular")
        da, db, dc = v[at : at + 3]
        bw = da * db * cross(axes[0], axes[1]) + dc * cross(da * axes[0] + db * axes[1], axes[2])
        return carried(before, second @ about(EZ, c) @ R0, Jw, bw, v, there, own)

    return pose


def axle(
    *, there: Array, own: Array, R0: Array, R0_before: Array, axis: Array, turns: bool = True, slides: bool = False
) -> Joint:
    """An angle about ``axis`` (body axes) from how both bodies stand at the start, and a way along it."""
    start = R0_before.T @ R0

    def pose(before: Pose | None, at: int, q: Array, v: Array) -> Pose:
        before = before or ground(q.size)
        R = before.R @ start @ about(axis, q[at] if turns else 0.0)
        e = R @ axis
        Jw, bw = before.Jw.copy(), before.bw
        if turns:
            Jw[:, at] += e
            bw = bw + v[at] * cross(before.omega, e)
        if not slides:
            return carried(before, R, Jw, bw, v, there, own)
        on = at + int(turns)
        found = carried(before, R, Jw, bw, v, there + q[on] * start @ axis, own)
        found.Jv[:, on] += e
        found.v = found.Jv @ v
        found.bv = found.bv + 2.0 * v[on] * cross(before.omega, e)
        return found

    return pose


def floor(*, edge: float, reach: float, tip: float) -> Joint:
    """On a floor, with coordinates x, y, heading, angle of the axis with the vertical, spin.

    ``edge`` > 0: it touches with the lowest point of the edge of a disc; else with a tip of radius ``tip`` about the
    point ``-reach`` on its axis (a ball: reach 0).
    """

    def pose(before: Pose | None, at: int, q: Array, v: Array) -> Pose:
        n_q = q.size
        heading, tilt, spin = q[at + 2 : at + 5]
        s, c = np.sin(tilt), np.cos(tilt)
        if s < UPRIGHT:
            raise OracleError("angles are near where they are singular")
        out = np.array([np.cos(heading), np.sin(heading), 0.0])
        across = cross(EZ, out)
        n, n_tilt = s * out + c * EZ, c * out - s * EZ
        dh, dt, dspin = v[at + 2 : at + 5]
        n_dot = dt * n_tilt + dh * s * across
        Jw = np.zeros((3, n_q))
        Jw[:, at + 2 : at + 5] = np.array([EZ, across, n]).T
        omega = Jw @ v
        bw = dh * dt * -out + dspin * n_dot  # across' = -heading' out
        if edge:  # the lowest point is n_tilt times the radius away (n_tilt: down the disc)
            height, first, second = edge * s, edge * c, -edge * s
            touch, touch_rate = edge * n_tilt, edge * (-dt * n + dh * c * across)
        else:
            height, first, second = reach * c + tip, -reach * s, -reach * c
            touch, touch_rate = -reach * n - tip * EZ, -reach * n_dot
        Jv = np.zeros((3, n_q))
        Jv[0, at] = Jv[1, at + 1] = 1.0
        Jv[2, at + 3] = first
        x = np.array([q[at], q[at + 1], height])
        R = np.array([n_tilt, across, n]).T @ about(EZ, spin)
        return Pose(x, R, Jv @ v, omega, Jv, Jw, EZ * second * dt**2, bw, touch=touch, touch_rate=touch_rate)

    return pose


@dataclass(frozen=True, kw_only=True)
class Body:
    """A body and what carries it; ``before``: the number of the body at the other side of its joint, or -1."""

    mass: float
    inertia: tuple[float, float, float]
    joint: Joint
    before: int
    first: int
    """The number of its first coordinate."""


#: Force and torque about the centre of mass on body ``i`` in that pose at that time.
Load = Callable[[float, int, Pose], tuple[Array, Array]]


class Tree:
    """Bodies that carry each other."""

    def __init__(self, bodies: list[Body], load: Load) -> None:
        self.bodies, self.load = bodies, load
        self.key: bytes = b""
        self.held: list[Pose] = []

    def poses(self, q: Array, v: Array) -> list[Pose]:
        """Of all bodies; kept for the same positions and velocities."""
        key = q.tobytes() + v.tobytes()
        if key != self.key:
            self.held = []
            for body in self.bodies:
                before = self.held[body.before] if body.before >= 0 else None
                self.held.append(body.joint(before, body.first, q, v))
            self.key = key
        return self.held

    def turning(self, i: int, pose: Pose) -> tuple[Array, Array]:
        """Inertia about the centre of mass in space, and ``omega x L``."""
        inertia = pose.R @ np.diag(self.bodies[i].inertia) @ pose.R.T
        return inertia, cross(pose.omega, inertia @ pose.omega)

    def mass(self, q: Array) -> Array:
        """The mass matrix."""
        M = np.zeros((q.size, q.size))
        for i, pose in enumerate(self.poses(q, np.zeros(q.size))):
            M += self.bodies[i].mass * pose.Jv.T @ pose.Jv + pose.Jw.T @ self.turning(i, pose)[0] @ pose.Jw
        return M

    def given(self, t: float, q: Array, v: Array) -> Array:
        """Generalised forces other than friction."""
        out = np.zeros(q.size)
        for i, pose in enumerate(self.poses(q, v)):
            inertia, gyroscopic = self.turning(i, pose)
            F, torque = self.load(t, i, pose)
            out += pose.Jv.T @ (F - self.bodies[i].mass * pose.bv)
            out += pose.Jw.T @ (torque - gyroscopic - inertia @ pose.bw)
        return out

    def borne(self, i: int, t: float, q: Array, v: Array, a: Array) -> tuple[Array, Array]:
        """Force and torque (about its point) through the joint of body ``i``, on the body."""
        force, torque, poses = np.zeros(3), np.zeros(3), self.poses(q, v)
        for j, pose in enumerate(poses):
            if not self.hangs_on(j, i):
                continue
            inertia, gyroscopic = self.turning(j, pose)
            F, M = self.load(t, j, pose)
            push = self.bodies[j].mass * (pose.Jv @ a + pose.bv) - F
            force += push
            torque += inertia @ (pose.Jw @ a + pose.bw) + gyroscopic - M + cross(pose.x - poses[i].hinge, push)
        return force, torque

    def hangs_on(self, j: int, i: int) -> bool:
        """Whether body i carries body j (or is it)."""
        while j > i:
            j = self.bodies[j].before
        return j == i
