"""Every element, normal law and joint in one small scene with dry friction, and the same in minimal coordinates."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .judge import Case
from .problem import Contact, Problem
from .references import constant

T = fm.t
LAW = fm.laws.Coulomb(mu_s=0.5, mu_k=0.4)
G = 9.81


def on_ground(n: int, axis: int = 0, **more: Any) -> Contact:
    """Coulomb friction of LAW along one coordinate."""
    W = np.zeros((n, 1))
    W[axis, 0] = more.pop("lever", 1.0)
    given = {"N": constant(1.0), "mu": constant(0.4), "mu_s": constant(0.5), **more}
    return Contact(name=more.get("name", "c"), W=W, **{k: v for k, v in given.items() if k != "name"})


def made(name: str, parts: list[Any], signals: tuple[str, ...], problem: Problem) -> Case:
    """Both forms together."""
    return Case(name=name, scene=fm.Scene(name, parts), problem=problem, signals=signals)


def numbers(
    q: Any, v: Any, t_end: float, contacts: tuple[Contact, ...], force: Callable[..., Any], mass: Any = None
) -> Problem:
    """Everything that acts in one function."""
    n = len(q)
    M = np.eye(n) if mass is None else np.asarray(mass, dtype=float)
    zero = np.zeros((n, n))
    return Problem(
        M=M, K=zero, C=zero, q=np.array(q, dtype=float), v=np.array(v, dtype=float), t_end=t_end, contacts=contacts,
        extra=lambda t, q, v: np.array(force(t, q, v), dtype=float),
    )  # fmt: skip


# -- elements -------------------------------------------------------------------------------------------------------
def block(load: Any = None) -> tuple[Any, list[Any]]:
    """A block with friction and a load along x."""
    body = fm.Body("m", mass=1.0, position={"x": 0.3}, velocity={"x": 0.2})
    value = 1.5 * sympy.sin(1.3 * T) if load is None else load
    return body, [body, fm.Contact("c", body, law=LAW, normal_force=1.0), fm.Force("f", body, axis="x", value=value)]


def drive(t: float) -> float:
    """The load of :func:`block`."""
    return 1.5 * math.sin(1.3 * t)


def spring() -> Case:
    body, parts = block()
    parts.append(fm.Spring("k", body, axis="x", stiffness=2.0, cubic=3.0, length=0.1))

    def force(t: float, q: Any, v: Any) -> Any:
        e = q[0] - 0.1
        return [drive(t) - 2.0 * e - 3.0 * e**3]

    return made("Spring", parts, ("m.x",), numbers([0.3], [0.2], 8.0, (on_ground(1),), force))


def damper() -> Case:
    body, parts = block()
    parts += [fm.Damper("d", body, axis="x", damping=0.3), fm.Spring("k", body, axis="x", stiffness=1.0)]
    problem = numbers([0.3], [0.2], 8.0, (on_ground(1),), lambda t, q, v: [drive(t) - q[0] - 0.3 * v[0]])
    return made("Damper", parts, ("m.x",), problem)


def force() -> Case:
    x, rate = fm.coordinate("m.x"), fm.speed("m.x")
    _, parts = block(1.5 * sympy.sin(1.3 * T) - 2.0 * sympy.sin(x) - 0.2 * rate**3)
    problem = numbers(
        [0.3], [0.2], 8.0, (on_ground(1),), lambda t, q, v: [drive(t) - 2.0 * math.sin(q[0]) - 0.2 * v[0] ** 3]
    )
    return made("Force", parts, ("m.x",), problem)


def plane(parts: list[Any], body: Any, act: Callable[..., Any], name: str) -> Case:
    """A block that slides along x alone with friction and moves freely along y."""
    parts = [body, *parts, fm.Contact("c", body, law=LAW, normal_force=1.0, axes="x")]
    problem = numbers([0.8, 0.3], [0.2, -0.1], 7.0, (on_ground(2),), act)
    return made(name, parts, ("m.x", "m.y"), problem)


def free() -> Any:
    """The block of :func:`plane`."""
    return fm.Body("m", mass=1.0, axes="xy", position={"x": 0.8, "y": 0.3}, velocity={"x": 0.2, "y": -0.1})


def point_spring() -> Case:
    body = free()
    parts = [fm.PointSpring("k", body, stiffness=3.0, length=0.7, anchor=(-0.5, 0.2))]

    def act(t: float, q: Any, v: Any) -> Any:
        e = np.array(q) - [-0.5, 0.2]
        r = np.hypot(*e)
        return -3.0 * (r - 0.7) * e / r

    return plane(parts, body, act, "PointSpring")


def point_damper() -> Case:
    body = free()
    parts: list[Any] = [fm.PointDamper("d", body, damping=0.4, anchor=(-2.0, 0.2))]
    parts += [fm.Spring(f"k{c}", body, axis=c, stiffness=2.0) for c in "xy"]

    def act(t: float, q: Any, v: Any) -> Any:
        e = np.array(q) - [-2.0, 0.2]
        n = e / np.hypot(*e)
        return -2.0 * np.array(q) - 0.4 * (n @ v) * n

    return plane(parts, body, act, "PointDamper")


def matrices() -> Case:
    body = free()
    M, C = [[0.3, 0.1], [0.1, 0.2]], [[0.1, 0.3], [-0.3, 0.05]]
    K = [[2.0, 0.5], [-0.4, 3.0]]
    parts = [fm.MatrixElement("matrices", ["m.x", "m.y"], M=np.array(M), C=np.array(C), K=np.array(K))]
    case = plane(parts, body, lambda t, q, v: -np.array(K) @ q - np.array(C) @ v, "MatrixElement")
    return replace(case, problem=replace(case.problem, M=np.eye(2) + np.array(M)))


def gravity() -> Case:
    body = free()
    parts = [fm.Gravity("g", acceleration={"x": 0.3, "y": -1.0}), fm.Spring("k", body, axis="x", stiffness=1.0)]
    return plane(parts, body, lambda t, q, v: [0.3 - q[0], -1.0], "Gravity")


def rotor(parts: Callable[[Any], list[Any]], act: Callable[..., Any], name: str) -> Case:
    """A wheel that a block rubs: a dry pin of constant load (a weight on its axle that nothing moves)."""
    wheel = fm.RigidBody("w", mass=2.0, inertia=0.5, angle=0.4, angular_velocity=0.3, points={"pin": (0.0, 0.0)})
    pin = fm.Revolute("c", wheel.point("pin"), radius=0.2, friction=LAW)
    weight = fm.Gravity("weight", acceleration={"y": -1.5})
    contact = on_ground(1, lever=0.2, N=constant(3.0))
    problem = numbers([0.4], [0.3], 8.0, (contact,), act, [[0.5]])
    return made(name, [wheel, pin, weight, *parts(wheel)], ("w.angle",), problem)


def torsion_spring() -> Case:
    def parts(wheel: Any) -> list[Any]:
        return [fm.TorsionSpring("k", wheel, stiffness=1.2, angle=0.1), torque(wheel)]

    return rotor(parts, lambda t, q, v: [0.9 * math.sin(1.3 * t) - 1.2 * (q[0] - 0.1)], "TorsionSpring")


def torque(wheel: Any) -> Any:
    """That drives the wheel."""
    return fm.Torque("drive", wheel, value=0.9 * sympy.sin(1.3 * T))


def torsion_damper() -> Case:
    def parts(wheel: Any) -> list[Any]:
        return [fm.TorsionDamper("d", wheel, damping=0.2), torque(wheel)]

    return rotor(parts, lambda t, q, v: [0.9 * math.sin(1.3 * t) - 0.2 * v[0]], "TorsionDamper")


def turning() -> Case:
    return rotor(lambda wheel: [torque(wheel)], lambda t, q, v: [0.9 * math.sin(1.3 * t)], "Torque")


def dry_friction() -> Case:
    """A wheel with a seal, held by a spring; the pin is free."""
    wheel = fm.RigidBody("w", mass=2.0, inertia=0.5, angle=0.4, angular_velocity=0.3)
    pin = fm.Revolute("pin", wheel)
    parts = [
        wheel, pin, torque(wheel), fm.TorsionSpring("k", wheel, stiffness=1.2, angle=0.1),
        fm.DryFriction("c", wheel, axis=pin, static=0.35, kinetic=0.25),
    ]  # fmt: skip
    contact = on_ground(1, mu_s=constant(0.35), mu=constant(0.25))
    act = lambda t, q, v: [0.9 * math.sin(1.3 * t) - 1.2 * (q[0] - 0.1)]  # noqa: E731
    return made("DryFriction", parts, ("w.angle",), numbers([0.4], [0.3], 8.0, (contact,), act, [[0.5]]))


def pushed_back(depth: float, rate: float, k: float, hunt_crossley: float, damping: float, over: float) -> float:
    """What a stop of stiffness k pushes back with."""
    if depth <= 0.0:
        return 0.0
    u = min(1.0, depth / over)
    return max(0.0, k * depth * (1.0 + hunt_crossley * rate) + damping * u**2 * (3.0 - 2.0 * u) * rate)


def stop() -> Case:
    body, parts = block(2.5 * sympy.sin(1.3 * T))
    parts.append(fm.Stop("ends", body, axis="x", lower=-0.4, upper=0.5, stiffness=40.0, hunt_crossley=0.3))

    def act(t: float, q: Any, v: Any) -> Any:
        ends = pushed_back(-0.4 - q[0], -v[0], 40.0, 0.3, 0.0, 1.0) - pushed_back(q[0] - 0.5, v[0], 40.0, 0.3, 0.0, 1.0)
        return [2.5 * math.sin(1.3 * t) + ends]

    return made("Stop", parts, ("m.x",), numbers([0.3], [0.2], 8.0, (on_ground(1),), act))


def backlash() -> Case:
    """A motor drives a dry load through play."""
    body, parts = block(0.0)
    motor = fm.Body("motor", mass=0.3, position={"x": 0.3})
    parts += [
        motor, fm.Force("torque", motor, axis="x", value=2.5 * sympy.sin(1.3 * T)),
        fm.Backlash("mesh", motor, body, axis="x", gap=0.2, stiffness=60.0, damping=0.8, damping_depth=0.02),
    ]  # fmt: skip

    def act(t: float, q: Any, v: Any) -> Any:
        x, rate = q[1] - q[0], v[1] - v[0]
        mesh = pushed_back(x - 0.1, rate, 60.0, 0.0, 0.8, 0.02) - pushed_back(-x - 0.1, -rate, 60.0, 0.0, 0.8, 0.02)
        return [mesh, 2.5 * math.sin(1.3 * t) - mesh]

    problem = numbers([0.3, 0.3], [0.2, 0.0], 6.0, (on_ground(2),), act, [[1.0, 0.0], [0.0, 0.3]])
    return made("Backlash", parts, ("m.x", "motor.x"), problem)


# -- normal laws ----------------------------------------------------------------------------------------------------
def pressed(normal: Any, N: Callable[[float, float], float], name: str, preload: float, stored: bool = True) -> Case:
    """A block that bounces on its own contact while it is shaken along it."""
    body = fm.Body("m", mass=1.0, axes="xy", velocity={"x": 0.4})
    shake = 0.5 * sympy.sin(2.0 * T)
    parts = [
        body, fm.Contact("c", body, law=LAW, normal_force=normal, axes="x"),
        fm.Spring("k", body, axis="x", stiffness=2.0),
        fm.Force("fx", body, axis="x", value=1.2 * sympy.sin(1.1 * T)), fm.Force("fy", body, axis="y", value=shake),
    ]  # fmt: skip
    if not stored:
        parts.append(fm.Spring("ky", body, axis="y", stiffness=5.0))

    def load(t: float, q: Any, v: Any) -> float:
        return N(q[1], v[1]) if stored else N(t, q[1])

    def act(t: float, q: Any, v: Any) -> Any:
        up = max(load(t, q, v), 0.0) - preload if stored else -5.0 * q[1]
        return [1.2 * math.sin(1.1 * t) - 2.0 * q[0], 0.5 * math.sin(2.0 * t) + up]

    contact = on_ground(2, N=load, constant=False)
    return made(name, parts, ("m.x", "m.y"), numbers([0.0, 0.0], [0.4, 0.0], 8.0, (contact,), act))


def normal_spring() -> Case:
    law = fm.normal.Spring(axis="y", stiffness=6.0, damping=0.2, preload=1.0)
    return pressed(law, lambda e, rate: 1.0 - 6.0 * e - 0.2 * rate, "normal.Spring", 1.0)


def hertz() -> Case:
    law = fm.normal.Hertz(axis="y", stiffness=30.0, damping=0.3, preload=1.0)
    at_rest = (1.0 / 30.0) ** (2.0 / 3.0)

    def N(e: float, rate: float) -> float:
        delta = at_rest - e
        return 30.0 * math.copysign(abs(delta) ** 1.5, delta) * (1.0 - 0.3 * rate)

    return pressed(law, N, "normal.Hertz", 1.0)


def constant_load() -> Case:
    return pressed(fm.normal.Constant(force=1.4), lambda t, y: 1.4, "normal.Constant", 0.0, stored=False)


def prescribed() -> Case:
    given = 1.0 + 0.4 * sympy.sin(3.0 * T) - fm.coordinate("m.y")
    law = fm.normal.Prescribed(force=given)
    return pressed(law, lambda t, y: 1.0 + 0.4 * math.sin(3.0 * t) - y, "normal.Prescribed", 0.0, stored=False)


# -- joints ---------------------------------------------------------------------------------------------------------
def tilted(joint: Callable[[Any], Any], name: str) -> Case:
    """A body on a line at 0.3 rad under its weight and a push along and across it."""
    c, s = math.cos(0.3), math.sin(0.3)
    body = fm.RigidBody("m", mass=1.5, inertia=0.1, velocity=(0.5 * c, 0.5 * s), points={"p": (0.0, 0.0)})
    parts = [
        body, joint(body), fm.Gravity("g", acceleration={"y": -G}),
        fm.Force("fx", body, axis="x", value=9.0 * sympy.sin(1.7 * T)),
    ]  # fmt: skip

    def along(t: float) -> float:
        return 9.0 * math.sin(1.7 * t) * c - 1.5 * G * s

    def across(t: float, q: Any, v: Any) -> float:
        return abs(1.5 * G * c + 9.0 * math.sin(1.7 * t) * s)

    # the coordinate is x = distance * c: mass and forces along the line over c
    contact = on_ground(1, lever=1.0 / c, N=across)
    problem = numbers([0.0], [0.5 * c], 4.0, (contact,), lambda t, q, v: [along(t) / c], [[1.5 / c**2]])
    return made(name, parts, ("m.x",), problem)


def prismatic() -> Case:
    origin = fm.ground_point(0.0, 0.0)
    return tilted(lambda b: fm.Prismatic("c", b.point("p"), origin, angle=0.3, friction=LAW), "Prismatic")


def on_line() -> Case:
    return tilted(
        lambda b: fm.RollerOnLine("c", b.point("p"), fm.ground_point(0.0, 0.0), angle=0.3, friction=LAW), "RollerOnLine"
    )


def on_circle() -> Case:
    """A bead on a hoop: its load is weight and centrifugal force."""
    angle, rate, R, m = 0.9, 0.4, 0.8, 1.5
    c, s = math.cos(angle), math.sin(angle)
    body = fm.RigidBody(
        "m", mass=m, inertia=0.1, position=(R * s, -R * c), velocity=(R * rate * c, R * rate * s),
        points={"p": (0.0, 0.0)},
    )  # fmt: skip
    parts = [
        body, fm.RollerOnCircle("c", body.point("p"), fm.ground_point(0.0, 0.0), radius=R, friction=LAW),
        fm.Gravity("g", acceleration={"y": -G}), hoop_counter(body),
    ]  # fmt: skip
    contact = on_ground(1, lever=R, N=lambda t, q, v: abs(m * G * math.cos(q[0]) + m * R * v[0] ** 2))
    act = lambda t, q, v: [-m * G * R * math.sin(q[0])]  # noqa: E731
    problem = numbers([angle], [rate], 3.0, (contact,), act, [[m * R**2]])
    return replace(made("RollerOnCircle", parts, ("m.x", "m.y"), problem), seen=around(R))


def hoop_counter(body: Any) -> Any:
    """Something that acts on the bead's own turning, which is free."""
    return fm.TorsionDamper("turning", body, damping=0.1)


def rod() -> Case:
    """A body that hangs on a rod, with a damper along x."""
    angle, R = 0.9, 0.8
    body = fm.RigidBody(
        "m", mass=1.5, inertia=0.1, position=(R * math.sin(angle), -R * math.cos(angle)), points={"p": (0.0, 0.0)}
    )
    parts = [
        body, fm.Rod("c", body.point("p"), fm.ground_point(0.0, 0.0), length=R),
        fm.Gravity("g", acceleration={"y": -G}), fm.Damper("d", body.point("p"), axis="x", damping=0.4),
    ]  # fmt: skip

    def act(t: float, q: Any, v: Any) -> Any:
        c = math.cos(q[0])
        return [-1.5 * G * R * math.sin(q[0]) - 0.4 * (R * c) ** 2 * v[0]]

    case = made("Rod", parts, ("m.x", "m.y"), numbers([angle], [0.0], 4.0, (), act, [[1.5 * R**2]]))
    return replace(case, seen=around(R))


def around(R: float) -> Any:
    """x and y of a point on a circle, its angle from below."""

    def seen(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        c, s = np.cos(q[0]), np.sin(q[0])
        return R * np.array([s, -c]), R * v[0] * np.array([c, s])

    return seen


def wheel() -> Case:
    """A disc that a pushed axle and a torque on it let roll and slide on the floor."""
    m, inertia, R = 1.5, 0.02, 0.2
    body = fm.RigidBody("m", mass=m, inertia=inertia, position=(0.0, R), velocity=(0.3, 0.0))
    parts = [
        body, fm.Wheel("c", body, radius=R, friction=LAW), fm.Gravity("g", acceleration={"y": -2.0}),
        fm.Force("f", body, axis="x", value=6.0 * sympy.sin(1.3 * T)),
        fm.Torque("w", body, value=0.5 * sympy.cos(2 * T)),
    ]  # fmt: skip
    W = np.array([[1.0], [R]])
    contact = Contact(name="c", W=W, N=constant(m * 2.0), mu=constant(0.4), mu_s=constant(0.5))
    act = lambda t, q, v: [6.0 * math.sin(1.3 * t), 0.5 * math.cos(2.0 * t)]  # noqa: E731
    problem = numbers([0.0, 0.0], [0.3, 0.0], 5.0, (contact,), act, [[m, 0.0], [0.0, inertia]])
    return made("Wheel", parts, ("m.x", "m.angle"), problem)


def rolling_resistance() -> Case:
    """A disc that is pushed to and fro rolls against a torque of an arm times its load, which a force presses too."""
    m, inertia, R, arm, g = 1.5, 0.02, 0.2, 0.06, 2.0
    body = fm.RigidBody("m", mass=m, inertia=inertia, position=(0.0, R), velocity=(0.3, 0.0))
    law = fm.laws.Coulomb(mu_s=1.2 * arm, mu_k=arm)
    parts = [
        body, fm.Wheel("c", body, radius=R, friction=LAW, rolling_resistance=law),
        fm.Gravity("g", acceleration={"y": -g}), fm.Force("p", body, axis="y", value=-1.0 * sympy.sin(T)),
        fm.Force("f", body, axis="x", value=3.0 * sympy.sin(1.3 * T)),
    ]  # fmt: skip

    def N(t: float, q: Any, v: Any) -> float:
        return m * g + math.sin(t)

    contacts = (
        Contact(name="c", W=np.array([[1.0], [R]]), N=N, mu=constant(0.4), mu_s=constant(0.5), constant=False),
        Contact(
            name="c_rolling", W=np.array([[0.0], [1.0]]), N=N, mu=constant(arm), mu_s=constant(1.2 * arm),
            constant=False,
        ),
    )  # fmt: skip
    act = lambda t, q, v: [3.0 * math.sin(1.3 * t), 0.0]  # noqa: E731
    problem = numbers([0.0, 0.0], [0.3, 0.0], 9.0, contacts, act, [[m, 0.0], [0.0, inertia]])
    return made("RollingResistance", parts, ("m.x", "m.angle"), problem)


def rope() -> Case:
    """Two blocks on a rope over a fixed drum; the coordinate is that of the second."""
    a, b = fm.Body("a", mass=1.2, velocity={"x": -0.2}), fm.Body("b", mass=0.7, velocity={"x": 0.2})
    parts = [
        a, b, fm.Rope("c", (a, b), axes="xx", angle=2.0, friction=0.2),
        fm.Force("fa", a, axis="x", value=3.0), fm.Force("fb", b, axis="x", value=3.0 + 2.5 * sympy.sin(1.3 * T)),
    ]  # fmt: skip

    def pull(t: float) -> float:
        return 3.0 + 2.5 * math.sin(1.3 * t)

    def load(t: float, q: Any, v: Any, a: Any) -> float:
        return math.tanh(0.2) * (3.0 + 1.2 * a[0] + pull(t) - 0.7 * a[0])

    contact = on_ground(1, reaction=load, mu=constant(1.0), mu_s=constant(1.0))
    problem = numbers([0.0], [0.2], 8.0, (contact,), lambda t, q, v: [pull(t) - 3.0], [[1.9]])
    return made("Rope", parts, ("b.x",), problem)


def elastic_rope() -> Case:
    """The same where the first block hangs on a span that stretches; both are coordinates then."""
    a, b = fm.Body("a", mass=1.2, velocity={"x": -0.2}), fm.Body("b", mass=0.7, velocity={"x": 0.2})
    parts = [
        a, b, fm.Rope("c", (a, b), axes="xx", angle=2.0, friction=0.2, stiffness=(60.0, None), pretension=3.0),
        fm.Force("fa", a, axis="x", value=3.0), fm.Force("fb", b, axis="x", value=3.0 + 2.5 * sympy.sin(1.3 * T)),
    ]  # fmt: skip

    def span(q: Any) -> float:
        return 3.0 + 60.0 * float(q[0] + q[1])

    def pull(t: float) -> float:
        return 3.0 + 2.5 * math.sin(1.3 * t)

    def load(t: float, q: Any, v: Any, a: Any) -> float:
        return math.tanh(0.2) * (span(q) + pull(t) - 0.7 * a[1])

    contact = on_ground(2, axis=1, reaction=load, mu=constant(1.0), mu_s=constant(1.0))
    act = lambda t, q, v: [3.0 - span(q), pull(t) - span(q)]  # noqa: E731
    problem = numbers([0.0, 0.0], [-0.2, 0.2], 8.0, (contact,), act, [[1.2, 0.0], [0.0, 0.7]])
    return made("Rope, elastic", parts, ("a.x", "b.x"), problem)


def pulled_rope() -> Case:
    """A block on a rope whose other end is pulled by a tension."""
    a = fm.Body("a", mass=1.2, velocity={"x": -0.2})
    tension = 3.0 + 2.5 * sympy.sin(1.3 * T)
    parts = [a, fm.Rope("c", (a, tension), axes="x", angle=2.0, friction=0.2), fm.Force("fa", a, axis="x", value=3.0)]

    def pull(t: float) -> float:
        return 3.0 + 2.5 * math.sin(1.3 * t)

    def load(t: float, q: Any, v: Any, a: Any) -> float:
        return math.tanh(0.2) * (3.0 - 1.2 * a[0] + pull(t))

    contact = on_ground(1, reaction=load, mu=constant(1.0), mu_s=constant(1.0))
    problem = numbers([0.0], [-0.2], 8.0, (contact,), lambda t, q, v: [3.0 - pull(t)], [[1.2]])
    return made("Rope, pulled", parts, ("a.x",), problem)


def gear() -> Case:
    """A wheel on a dry pin of constant load drives another: a = -1.5 b."""
    a = fm.RigidBody("a", mass=2.0, inertia=0.5, points={"pin": (0.0, 0.0)})
    b = fm.RigidBody("b", mass=1.0, inertia=0.8, points={"pin": (0.0, 0.0)})
    parts = [
        a, b, fm.Revolute("c", a.point("pin"), radius=0.2, friction=LAW), fm.Revolute("free", b.point("pin")),
        fm.Gravity("weight", acceleration={"y": -1.5}), fm.Gear("teeth", a, b, ratio=1.5), torque(b),
    ]  # fmt: skip
    contact = on_ground(1, lever=-0.2 * 1.5, N=constant(3.0))
    act = lambda t, q, v: [0.9 * math.sin(1.3 * t)]  # noqa: E731
    return made("Gear", parts, ("b.angle",), numbers([0.0], [0.0], 8.0, (contact,), act, [[0.8 + 2.25 * 0.5]]))


def driven_angle() -> Case:
    """A bead on an arm that turns as prescribed: its load is that of Coriolis and of the arm's acceleration."""
    turn, m = T + 0.3 * (1 - sympy.cos(T)), 1.2
    arm = fm.RigidBody("arm", mass=1.0, inertia=0.3, angular_velocity=1.0, points={"pin": (0.0, 0.0)})
    bead = fm.RigidBody("m", mass=m, inertia=0.1, position=(0.5, 0.0), velocity=(0.6, 0.5), angular_velocity=1.0)
    parts = [
        arm, bead, fm.Revolute("pin", arm.point("pin")), fm.DrivenAngle("drive", arm, angle=turn),
        fm.Prismatic("c", bead, arm.point("pin"), friction=LAW),
    ]  # fmt: skip

    def rates(t: float) -> tuple[float, float]:
        return 1.0 + 0.3 * math.sin(t), 0.3 * math.cos(t)

    def N(t: float, q: Any, v: Any) -> float:
        w, w_rate = rates(t)
        return abs(m * (2.0 * w * v[0] + w_rate * q[0]))

    contact = on_ground(1, N=N)
    problem = numbers([0.5], [0.6], 3.0, (contact,), lambda t, q, v: [m * rates(t)[0] ** 2 * q[0]], [[m]])
    return replace(made("DrivenAngle", parts, ("m.x", "m.y"), problem), seen=turning_with)


def turning_with(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and y of the bead of :func:`driven_angle`."""
    angle, w = t + 0.3 * (1.0 - np.cos(t)), 1.0 + 0.3 * np.sin(t)
    c, s = np.cos(angle), np.sin(angle)
    return q[0] * np.array([c, s]), v[0] * np.array([c, s]) + q[0] * w * np.array([-s, c])


def driven_slide() -> Case:
    """A pendulum on a dry pin of a cart that is shaken."""
    m, inertia, half, r = 1.2, 0.1, 0.5, 0.06
    cart = fm.RigidBody("cart", mass=1.0, inertia=1.0, velocity=(0.6, 0.0), points={"pin": (0.0, 0.0)})
    start: dict[str, Any] = {"position": (0.0, -half), "velocity": (0.6, 0.0)}
    link = fm.RigidBody("m", mass=m, inertia=inertia, points={"root": (0.0, half)}, **start)
    origin = fm.ground_point(0.0, 0.0)
    parts = [
        cart, link, fm.Prismatic("rails", cart.point("pin"), origin),
        fm.DrivenSlide("shaker", cart.point("pin"), origin, distance=0.3 * sympy.sin(2 * T)),
        fm.Revolute("c", link.point("root"), cart.point("pin"), radius=r, friction=LAW),
        fm.Gravity("g", acceleration={"y": -G}),
    ]  # fmt: skip

    def push(t: float) -> float:
        return -1.2 * math.sin(2.0 * t)

    def act(t: float, q: Any, v: Any) -> Any:
        return [-m * half * (G * math.sin(q[0]) + push(t) * math.cos(q[0]))]

    def reaction(t: float, q: Any, v: Any, a: Any) -> float:
        c, s = math.cos(q[0]), math.sin(q[0])
        x = push(t) + half * (c * a[0] - s * v[0] ** 2)
        y = G + half * (s * a[0] + c * v[0] ** 2)
        return m * math.hypot(x, y)

    contact = on_ground(1, lever=r, reaction=reaction)
    problem = numbers([0.0], [0.0], 5.0, (contact,), act, [[inertia + m * half**2]])
    return made("DrivenSlide", parts, ("m.angle",), problem)


def welded() -> Case:
    """Two bodies welded in one, swinging on a dry pin: inertia and weight add up."""
    ends = {"root": (0.0, 0.5), "tip": (0.0, -0.5)}
    first = fm.RigidBody("a", mass=1.0, inertia=0.05, position=(0.0, -0.5), points=ends)
    second = fm.RigidBody("b", mass=0.7, inertia=0.03, position=(0.4, -1.0), points={"root": (-0.4, 0.0)})
    parts = [
        first, second, fm.Revolute("c", first.point("root"), radius=0.1, friction=LAW),
        fm.Fixed("weld", second.point("root"), first.point("tip")), fm.Gravity("g", acceleration={"y": -G}),
        fm.Torque("drive", first, value=5.0 * sympy.sin(2.0 * T)),
    ]  # fmt: skip
    centres = np.array([[0.0, -0.5], [0.4, -1.0]])
    masses = np.array([1.0, 0.7])
    inertia = 0.08 + float(masses @ (centres**2).sum(axis=1))

    def turned(q: Any) -> tuple[np.ndarray, np.ndarray]:
        c, s = math.cos(q[0]), math.sin(q[0])
        at = centres @ np.array([[c, s], [-s, c]])
        return at, np.column_stack([-at[:, 1], at[:, 0]])

    def act(t: float, q: Any, v: Any) -> Any:
        at, _ = turned(q)
        return [5.0 * math.sin(2.0 * t) - G * float(masses @ at[:, 0])]

    def reaction(t: float, q: Any, v: Any, a: Any) -> float:
        at, way = turned(q)
        total = masses @ (way * a[0] - at * v[0] ** 2) + np.array([0.0, masses.sum() * G])
        return float(np.hypot(*total))

    contact = on_ground(1, lever=0.1, reaction=reaction)
    return made("Fixed", parts, ("a.angle",), numbers([0.0], [0.0], 4.0, (contact,), act, [[inertia]]))


CASES: dict[str, Callable[[], Case]] = {
    "Spring": spring, "Damper": damper, "Force": force, "PointSpring": point_spring, "PointDamper": point_damper,
    "MatrixElement": matrices, "Gravity": gravity, "TorsionSpring": torsion_spring, "TorsionDamper": torsion_damper,
    "Torque": turning, "DryFriction": dry_friction, "Stop": stop, "Backlash": backlash,
    "normal.Spring": normal_spring, "normal.Hertz": hertz, "normal.Constant": constant_load,
    "normal.Prescribed": prescribed, "Fixed": welded, "Prismatic": prismatic, "RollerOnLine": on_line,
    "RollerOnCircle": on_circle, "Rod": rod, "Gear": gear, "Rope": rope, "Wheel": wheel,
    "Rope, elastic": elastic_rope, "Rope, pulled": pulled_rope,
    "RollingResistance": rolling_resistance,
    "DrivenAngle": driven_angle, "DrivenSlide": driven_slide,
}  # fmt: skip
