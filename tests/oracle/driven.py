"""Loops that a crank drives: a slide, a slider crank or a parallelogram carries something with dry friction."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .drawn import Drawn, Generator, even, limits, some
from .judge import Case
from .problem import Contact, Problem
from .references import constant

ORIGIN = (0.0, 0.0)
#: Position and acceleration of what carries, as functions of time.
Path = tuple[Callable[[float], float], Callable[[float], float]]


def driven(rng: Generator) -> Drawn:
    """What drives, what is carried, and their numbers."""
    support = ("slide", "crank", "parallelogram")[rng.integers(3)]
    carried = ("pendulum", "bead", "tied")[rng.integers(3)]
    crank, speed = some(rng, 0.1, 0.4), some(rng, 0.5, 6.0)
    start = even(rng, 1.2, 1.9) if support == "parallelogram" else even(rng, 0.3, 2.8)
    swing = even(rng, 0.2, 0.9) if support == "parallelogram" else even(rng, 0.2, 3.0)
    mass, half = some(rng, 0.5, 2.0), some(rng, 0.2, 0.6)
    if support == "parallelogram":  # what it carries stays pressed
        crank = min(crank, round(0.6 * 9.81 / (swing * (1.0 + swing) * speed**2), 4))
    return Drawn("driven", "driven", {
        "support": support, "carried": carried, "crank": crank, "rod": round(crank * rng.uniform(1.5, 4.0), 4),
        "speed": speed, "start": start, "swing": swing, "mass": mass, "half": half,
        "inertia": round(mass * half**2 * rng.uniform(0.2, 0.6), 5), "radius": even(rng, 0.02, 0.1),
        "mu": limits(rng, 0.1, 0.5), "k": some(rng, 0.5, 20.0), "N": some(rng, 0.3, 3.0),
        "angle": even(rng, -1.0, 1.0), "rate": 0.0 if rng.random() < 0.5 else even(rng, -2.0, 2.0),
        "g": 9.81, "t_end": even(rng, 3.0, 6.0),
    })  # fmt: skip


def turn(n: dict[str, Any], t: Any, functions: Any) -> Any:
    """The angle of the crank."""
    return n["start"] + n["swing"] * functions.sin(n["speed"] * t)


def paths(n: dict[str, Any]) -> tuple[Path, Path]:
    """X and y of what carries, less its place at angle 0, in formulas of plane geometry."""
    t = sympy.Symbol("t")
    phi, r = turn(n, t, sympy), n["crank"]
    if n["support"] == "slide":
        x, y = r * sympy.sin(n["speed"] * t), sympy.Integer(0)
    elif n["support"] == "crank":
        x, y = r * sympy.cos(phi) + sympy.sqrt(n["rod"] ** 2 - (r * sympy.sin(phi)) ** 2), sympy.Integer(0)
    else:
        x, y = r * sympy.cos(phi), r * sympy.sin(phi)
    return tuple(  # type: ignore[return-value]
        tuple(sympy.lambdify(t, sympy.diff(e, t, k), "math") for k in (0, 1, 2)) for e in (x, y)
    )


def support_of(n: dict[str, Any], x: Any, y: Any) -> tuple[Any, list[Any]]:
    """The body that carries, where it is at the start, and all that drives it."""
    r, speed = n["crank"], n["swing"] * n["speed"]
    here, moving = (x[0](0.0), y[0](0.0)), (x[1](0.0), y[1](0.0))
    carrier = fm.RigidBody("s", mass=1.0, inertia=0.2, position=here, velocity=moving)
    if n["support"] == "slide":
        drive = fm.DrivenSlide("drive", carrier, fm.ground_point(*ORIGIN), distance=r * sympy.sin(n["speed"] * fm.t))
        return carrier, [carrier, fm.Prismatic("rails", carrier, fm.ground_point(*ORIGIN)), drive]
    phi = n["start"]
    parts: list[Any] = [carrier]
    tips = []
    for name, across in (("p", 0.0), ("p2", 0.7)) if n["support"] == "parallelogram" else (("p", 0.0),):
        crank = fm.RigidBody(
            name, mass=0.5, inertia=0.01, angle=phi, angular_velocity=speed, position=(across, 0.0),
            points={"tip": (r, 0.0)},
        )  # fmt: skip
        parts += [crank, fm.Revolute(f"{name}_root", crank, fm.ground_point(across, 0.0))]
        tips.append(crank)
    parts.append(fm.DrivenAngle("drive", tips[0], angle=turn(n, fm.t, sympy)))
    if n["support"] == "parallelogram":
        parts += [
            fm.Revolute(f"{c.name}_tip", carrier.point(f"at{i}", (0.7 * i, 0.0)), c.point("tip"))
            for i, c in enumerate(tips)
        ]
        return carrier, parts
    tip = np.array([r * math.cos(phi), r * math.sin(phi)])
    lean = math.asin(-tip[1] / n["rod"])  # of the rod, from the tip to the slider
    turns = -r * math.cos(phi) * speed / (n["rod"] * math.cos(lean))
    v_tip = speed * np.array([-tip[1], tip[0]])
    along = np.array([math.cos(lean), math.sin(lean)])
    middle, v_middle = tip + 0.5 * n["rod"] * along, v_tip + 0.5 * n["rod"] * turns * np.array([-along[1], along[0]])
    ends = {"root": (-0.5 * n["rod"], 0.0), "tip": (0.5 * n["rod"], 0.0)}
    rod = fm.RigidBody(
        "rod", mass=0.4, inertia=0.02, angle=lean, angular_velocity=turns, position=tuple(middle),
        velocity=tuple(v_middle), points=ends,
    )  # fmt: skip
    return carrier, [
        *parts, rod, fm.Revolute("crank_pin", rod.point("root"), tips[0].point("tip")),
        fm.Revolute("wrist", rod.point("tip"), carrier), fm.Prismatic("rails", carrier, fm.ground_point(*ORIGIN)),
    ]  # fmt: skip


def driven_case(n: dict[str, Any]) -> Case:
    """Both forms."""
    x, y = paths(n)
    carrier, parts = support_of(n, x, y)
    parts.append(fm.Gravity("g", acceleration={"y": -n["g"]}))
    carried = {"pendulum": pendulum, "bead": bead, "tied": tied}[n["carried"]]
    more, signal, contact, mass, start, act = carried(n, carrier, x, y)
    one = np.ones((1, 1))
    longest = min(n["t_end"] / 100.0, 0.25 / (n["speed"] * (1.0 + n["swing"])))
    problem = Problem(
        M=mass * one, K=0.0 * one, C=0.0 * one, q=np.array([start[0]]), v=np.array([start[1]]), t_end=n["t_end"],
        contacts=(contact,), extra=lambda t, q, v: np.array([act(t, q[0], v[0])]), max_step=longest,
    )  # fmt: skip
    seen = None
    if n["carried"] == "bead":  # along the rail for the oracle, in space for the scene
        def seen(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            return q + np.array([[x[0](s) for s in t]]), v + np.array([[x[1](s) for s in t]])

    scene = fm.Scene("driven", [*parts, *more])
    return Case(name=f"{n['support']}-{n['carried']}", scene=scene, problem=problem, signals=(signal,), seen=seen)


def law(n: dict[str, Any]) -> Any:
    """Its friction."""
    return fm.laws.Coulomb(mu_s=n["mu"][0], mu_k=n["mu"][1])


def dry(n: dict[str, Any], lever: float, **load: Any) -> Contact:
    """The contact."""
    given = {"N": constant(math.nan), **load}
    return Contact(
        name="c", W=np.array([[lever]]), mu=constant(n["mu"][1]), mu_s=constant(n["mu"][0]), **given
    )


def pendulum(n: dict[str, Any], carrier: Any, x: Any, y: Any) -> tuple[Any, ...]:
    """On a dry pin of what carries."""
    m, half, angle, rate, g = n["mass"], n["half"], n["angle"], n["rate"], n["g"]
    s, c = math.sin(angle), math.cos(angle)
    link = fm.RigidBody(
        "b", mass=m, inertia=n["inertia"], angle=angle, angular_velocity=rate, points={"root": (0.0, half)},
        position=(x[0](0.0) + half * s, y[0](0.0) - half * c),
        velocity=(x[1](0.0) + half * c * rate, y[1](0.0) + half * s * rate),
    )  # fmt: skip
    pin = fm.Revolute("c", link.point("root"), carrier, radius=n["radius"], friction=law(n))

    def act(t: float, q: float, v: float) -> float:
        return -m * half * ((g + y[2](t)) * math.sin(q) + x[2](t) * math.cos(q))

    def reaction(t: float, q: Any, v: Any, a: Any) -> float:
        s, c = math.sin(q[0]), math.cos(q[0])
        along = x[2](t) + half * (c * a[0] - s * v[0] ** 2)
        return m * math.hypot(along, g + y[2](t) + half * (s * a[0] + c * v[0] ** 2))

    contact = dry(n, n["radius"], reaction=reaction)
    return [link, pin], "b.angle", contact, n["inertia"] + m * half**2, (angle, rate), act


def bead(n: dict[str, Any], carrier: Any, x: Any, y: Any) -> tuple[Any, ...]:
    """On a dry rail of what carries, held by a spring to it."""
    m, start, rate = n["mass"], 0.3 * n["angle"], 0.3 * n["rate"]
    body = fm.RigidBody(
        "b", mass=m, inertia=0.1, position=(x[0](0.0) + start, y[0](0.0)), velocity=(x[1](0.0) + rate, y[1](0.0))
    )
    parts = [body, fm.Prismatic("c", body, carrier, friction=law(n)), fm.Spring("k", body, carrier, stiffness=n["k"],
             axis="x", length=0.0)]  # fmt: skip
    contact = dry(n, 1.0, N=lambda t, q, v: abs(m * (n["g"] + y[2](t))))
    return parts, "b.x", contact, m, (start, rate), lambda t, q, v: -m * x[2](t) - n["k"] * q


def tied(n: dict[str, Any], carrier: Any, x: Any, y: Any) -> tuple[Any, ...]:
    """A block on the ground, tied to what carries by a spring."""
    body = fm.Body("b", mass=n["mass"], position={"x": n["angle"]}, velocity={"x": n["rate"]})
    parts = [
        body, fm.Contact("c", body, law=law(n), normal_force=n["N"]),
        fm.Spring("k", body, carrier, axis="x", stiffness=n["k"], length=0.0),
    ]  # fmt: skip
    contact = dry(n, 1.0, N=constant(n["N"]))
    return parts, "b.x", contact, n["mass"], (n["angle"], n["rate"]), lambda t, q, v: -n["k"] * (q - x[0](t))


MAKERS = {"driven": driven_case}
