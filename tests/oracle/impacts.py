"""Scenes with impacts: blocks between stops and with play, balls on a table that moves, bodies thrown on a floor, a
pendulum against stops, wheels in mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .drawn import Drawn, Generator, at, even, formula, limits, some, wave
from .struck import Dry, Struck, Surface
from .struck_judge import Hard

G = 9.81


def impacts(rng: Generator) -> Drawn:
    """One of the situations."""
    names = list(SITUATIONS)
    situation = names[rng.choice(len(names), p=[0.4, 0.15, 0.25, 0.1, 0.1])]
    return Drawn("impacts", "impacts", {"situation": situation, **SITUATIONS[situation][0](rng)})


def restitution(rng: Generator) -> float:
    """Of one in eight nothing is thrown back."""
    return 0.0 if rng.random() < 0.125 else even(rng, 0.1, 0.9)


def dry_of(rng: Generator, size: float) -> list[float]:
    """Limits at rest and in slip, none of one in three."""
    return [0.0, 0.0] if rng.random() < 0.33 else [round(size * mu, 4) for mu in limits(rng, 0.1, 0.8)]


def poisson(rng: Generator) -> Drawn:
    """The same by Poisson's law, without restitution along slip."""
    drawn = impacts(rng)
    return Drawn("poisson", "impacts", {**drawn.n, "e_t": 0.0, "poisson": True})


def carried(rng: Generator) -> Drawn:
    """A disc, a rod or a box thrown on a table that swings up and down under it, with friction and a belt on it."""
    n, w = draw_thrown(rng), some(rng, 4.0, 20.0)
    swing = [round(some(rng, 0.1, 1.5) * G / w**2, 5), w, even(rng, 0.0, 6.28)]
    law = {"poisson": True, "e_t": 0.0} if rng.random() < 0.3 else {}
    return Drawn("carried", "impacts", {"situation": "thrown", **n, "swing": swing, **law})


# -- blocks in line ---------------------------------------------------------------------------------------------
def draw_blocks(rng: Generator) -> dict[str, Any]:
    """One to three blocks with springs, loads and dry friction; stops, play and bumpers."""
    n = int(rng.integers(1, 4))
    given: dict[str, Any] = {
        "masses": [some(rng, 0.5, 2.0) for _ in range(n)], "k": [some(rng, 0.5, 8.0) for _ in range(n)],
        "c": [0.0 if rng.random() < 0.5 else some(rng, 0.01, 0.2) for _ in range(n)],
        "loads": [wave(rng, 1.0) if rng.random() < 0.7 else [0.0] * 4 for _ in range(n)],
        "dry": [dry_of(rng, 0.5) for _ in range(n)], "q": [even(rng, -0.08, 0.08) for _ in range(n)],
        "v": [even(rng, -2.0, 2.0) for _ in range(n)], "parts": [], "t_end": even(rng, 4.0, 12.0),
    }  # fmt: skip
    for i in range(n):
        e = restitution(rng)
        if i and rng.random() < 0.7:
            kind = ("play", "bumper")[rng.integers(2)]
            given["parts"].append([kind, i, i - 1, even(rng, 0.2, 0.8), e])
        elif i == 0 or rng.random() < 0.3:
            kind = ("both", "lower", "upper")[rng.integers(3)]
            given["parts"].append([kind, i, -1, even(rng, 0.1, 0.8), e])
    return given


def blocks(n: dict[str, Any]) -> Hard:
    """Both forms."""
    count = len(n["masses"])
    K, C = np.zeros((count, count)), np.zeros((count, count))
    bodies = [
        fm.Body(f"b{i}", mass=m, position={"x": q}, velocity={"x": v})
        for i, (m, q, v) in enumerate(zip(n["masses"], n["q"], n["v"], strict=True))
    ]
    parts: list[Any] = list(bodies)
    dries, surfaces = [], []
    for i, body in enumerate(bodies):
        other = bodies[i - 1] if i else fm.GROUND
        row = np.eye(count)[i] - (np.eye(count)[i - 1] if i else 0.0)
        K += n["k"][i] * np.outer(row, row)
        C += n["c"][i] * np.outer(row, row)
        parts.append(fm.Spring(f"k{i}", body, other, axis="x", stiffness=n["k"][i], length=0.0))
        if n["c"][i]:
            parts.append(fm.Damper(f"c{i}", body, other, axis="x", damping=n["c"][i]))
        if any(n["loads"][i]):
            parts.append(fm.Force(f"f{i}", body, axis="x", value=formula(n["loads"][i], fm.t)))
        static, kinetic = n["dry"][i]
        if static:
            parts.append(fm.DryFriction(f"d{i}", body, axis="x", static=static, kinetic=kinetic))
            dries.append(Dry(name=f"d{i}", row=np.eye(count)[i], static=static, kinetic=kinetic))
    for j, (kind, a, b, width, e) in enumerate(n["parts"]):
        name, ends = f"s{j}", (bodies[a], fm.GROUND if b < 0 else bodies[b])
        row = np.eye(count)[a] - (np.eye(count)[b] if b >= 0 else 0.0)
        if kind == "play":
            parts.append(fm.Backlash(name, *ends, axis="x", gap=width, restitution=e))
            width = width / 2
        else:
            sides = {"lower": -width, "upper": width} if kind == "both" else {
                "lower": {"lower": -width}, "upper": {"upper": width}, "bumper": {"lower": -width}
            }[kind]  # fmt: skip
            parts.append(fm.Stop(name, *ends, axis="x", restitution=e, **sides))
        for side, sign in (("lower", 1.0), ("upper", -1.0)):
            if kind in ("play", "both", side) or (kind == "bumper" and side == "lower"):
                surfaces.append(flat(f"{name}.{side}", sign * row, width, e))

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([at(w, t) for w in n["loads"]]) - K @ q - C @ v

    problem = Struck(
        M=np.diag(n["masses"]), force=force, q=np.array(n["q"]), v=np.array(n["v"]), t_end=n["t_end"],
        surfaces=tuple(surfaces), dries=tuple(dries), longest=0.1,
    )  # fmt: skip
    names = tuple(f"b{i}.x" for i in range(count))
    return Hard(name="", scene=fm.Scene("blocks", parts), problem=problem, signals=names)


def flat(name: str, row: np.ndarray, width: float, e: float, **more: Any) -> Surface:
    """``row q >= -width``."""
    return Surface(name=name, gap=lambda q: float(row @ q) + width, row=lambda q: row, e=e, **more)


def swings(A: float, w: float, phase: float) -> Callable[[float], tuple[float, float, float]]:
    """Place, speed and acceleration of ``A sin(w t + phase)``."""

    def moves(t: float) -> tuple[float, float, float]:
        s, c = math.sin(w * t + phase), math.cos(w * t + phase)
        return A * s, A * w * c, -A * w * w * s

    return moves


# -- on a table -------------------------------------------------------------------------------------------------
def draw_table(rng: Generator) -> dict[str, Any]:
    """One or two balls, one on the other, above a table that swings."""
    n, w = int(rng.integers(1, 3)), some(rng, 2.0, 12.0)
    return {
        "masses": [some(rng, 0.5, 2.0) for _ in range(n)], "e": [restitution(rng) for _ in range(n)],
        "height": [even(rng, 0.05, 0.5) for _ in range(n)], "v": [even(rng, -1.0, 1.0) for _ in range(n)],
        "A": round(some(rng, 0.2, 2.0) * G / w**2, 5), "w": w, "phase": even(rng, 0.0, 6.28),
        "t_end": even(rng, 2.0, 5.0),
    }  # fmt: skip


def table(n: dict[str, Any]) -> Hard:
    """Both forms; the table's mean height is 0."""
    count, A, w, phase = len(n["masses"]), n["A"], n["w"], n["phase"]
    heights = A + np.cumsum(n["height"])
    plate = fm.Driven("plate", position={"y": A * sympy.sin(w * fm.t + phase)}, axes="y")
    bodies = [
        fm.Body(f"b{i}", mass=n["masses"][i], axes="y", position={"y": heights[i]}, velocity={"y": n["v"][i]})
        for i in range(count)
    ]
    below = [plate, *bodies]
    stops = [fm.Stop(f"s{i}", body, below[i], axis="y", lower=0.0, restitution=n["e"][i]) for i, body in
             enumerate(bodies)]  # fmt: skip

    surfaces = [flat("s0.lower", np.eye(count)[0], 0.0, n["e"][0], moves=swings(A, w, phase))]
    if count > 1:
        surfaces.append(flat("s1.lower", np.array([-1.0, 1.0]), 0.0, n["e"][1]))
    masses = np.array(n["masses"])
    problem = Struck(
        M=np.diag(masses), force=lambda t, q, v: -G * masses, q=heights, v=np.array(n["v"]), t_end=n["t_end"],
        surfaces=tuple(surfaces), longest=0.3 / w,
    )  # fmt: skip
    scene = fm.Scene("table", [plate, *bodies, *stops, fm.Gravity("g")])
    return Hard(name="", scene=scene, problem=problem, signals=tuple(f"b{i}.y" for i in range(count)))


# -- thrown on a floor ------------------------------------------------------------------------------------------
def draw_thrown(rng: Generator) -> dict[str, Any]:
    """A disc, a rod that meets the floor with its tip, or a box with two corners; perhaps a wall beside it."""
    body, r = ("disc", "rod", "box")[rng.integers(3)], even(rng, 0.1, 0.5)
    points = {"disc": [], "rod": [[-r, 0.0]], "box": [[-r, -even(rng, 0.5, 1.5) * r]]}[body]
    if body == "box":
        points.append([r, points[0][1]])
    mass, angle = some(rng, 0.5, 2.0), {"disc": 0.0, "rod": even(rng, 0.3, 1.2), "box": even(rng, -0.4, 0.4)}[body]
    mu = limits(rng, 0.1, 0.5) if rng.random() < 0.8 else (0.0, 0.0)
    e = restitution(rng)
    return {
        "body": body, "r": r, "points": points, "mass": mass, "inertia": round(mass * r * r * even(rng, 0.3, 0.6), 6),
        "mu": mu if rng.random() < 0.5 else [mu[1], mu[1]], "e": e,
        "e_t": e if mu[0] and rng.random() < 0.4 else 0.0, "angle": angle, "above": even(rng, 0.05, 0.4),
        "v": [even(rng, -2.0, 2.0), even(rng, -1.0, 1.0)], "spin": even(rng, -6.0, 6.0) * (1.0 if body == "disc" else
        0.3), "belt": even(rng, -1.0, 1.0) if mu[0] and rng.random() < 0.3 else 0.0,
        "wall": [even(rng, 0.1, 0.6), restitution(rng)] if rng.random() < 0.3 else None,
        "k": some(rng, 1.0, 20.0) if rng.random() < 0.3 else 0.0,
        "t_end": {"disc": even(rng, 1.0, 2.5), "rod": 0.5, "box": even(rng, 0.8, 1.5)}[body],
    }  # fmt: skip


def corner(name: str, p: list[float], **more: Any) -> Surface:
    """A point of a body (x, y, angle) above the floor y = 0."""
    a, b = p

    def turned(q: np.ndarray) -> tuple[float, float]:
        s, c = math.sin(q[2]), math.cos(q[2])
        return a * c - b * s, a * s + b * c

    return Surface(
        name=name, gap=lambda q: q[1] + turned(q)[1], row=lambda q: np.array([0.0, 1.0, turned(q)[0]]),
        bend=lambda q, v: -v[2] ** 2 * turned(q)[1], along=lambda q: np.array([1.0, 0.0, -turned(q)[1]]),
        along_bend=lambda q, v: -v[2] ** 2 * turned(q)[0], **more,
    )  # fmt: skip


def thrown(n: dict[str, Any]) -> Hard:
    """Both forms."""
    r, belt, (mu_s, mu_k) = n["r"], n["belt"], n["mu"]
    more = {"e": n["e"], "e_t": n["e_t"], "mu_s": mu_s, "mu_k": mu_k, "slides": lambda t: (belt, 0.0)}
    s, c = math.sin(n["angle"]), math.cos(n["angle"])
    lowest = -r if n["body"] == "disc" else min(a * s + b * c for a, b in n["points"])
    A, w, phase = n.get("swing", (0.0, 1.0, 0.0))
    place = (0.0, n["above"] + A - lowest)
    body = fm.RigidBody(
        "b", mass=n["mass"], inertia=n["inertia"], position=place, velocity=tuple(n["v"]), angle=n["angle"],
        angular_velocity=n["spin"], points={f"p{i}": tuple(p) for i, p in enumerate(n["points"])},
    )  # fmt: skip
    rub = {"friction": fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), "tangential_restitution": n["e_t"]} if mu_s else {}
    if mu_s:
        rub["slide"] = belt
    rub |= {"push_only": True, "restitution": n["e"]}
    parts: list[Any] = [body, fm.Gravity("g")]
    under: Any = fm.GROUND
    if A:
        under = fm.Driven("plate", position={"y": A * sympy.sin(w * fm.t + phase)})
        parts.append(under)
        more["moves"] = swings(A, w, phase)
    surfaces = []
    if n["body"] == "disc":
        parts.append(fm.Wheel("c0", body, under, radius=r, **rub))
        along = np.array([1.0, 0.0, r])
        surfaces.append(flat("c0", np.array([0.0, 1.0, 0.0]), -r, along=lambda q: along, **more))
    for i, p in enumerate(n["points"]):
        parts.append(fm.RollerOnLine(f"c{i}", body.point(f"p{i}"), under, **rub))
        surfaces.append(corner(f"c{i}", p, **more))
    if n["wall"]:
        width, e = n["wall"]
        parts.append(fm.Stop("wall", body, axis="x", lower=-width, upper=width, restitution=e))
        row = np.array([1.0, 0.0, 0.0])
        surfaces += [flat("wall.lower", row, width, e), flat("wall.upper", -row, width, e)]
    if n["k"]:
        parts.append(fm.Spring("k", body, axis="x", stiffness=n["k"], length=0.0))

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([-n["k"] * q[0], -n["mass"] * G, 0.0])

    problem = Struck(
        M=np.diag([n["mass"], n["mass"], n["inertia"]]), force=force, q=np.array([*place, n["angle"]]),
        v=np.array([*n["v"], n["spin"]]), t_end=n["t_end"], surfaces=tuple(surfaces), longest=min(0.05, 0.3 / w),
    )  # fmt: skip
    scene = fm.Scene("thrown", parts)
    return Hard(name="", scene=scene, problem=problem, signals=("b.x", "b.y", "b.angle"))


# -- on pins ----------------------------------------------------------------------------------------------------
def draw_pendulum(rng: Generator) -> dict[str, Any]:
    """On a pin with dry friction, between stops or against one."""
    return {
        "mass": some(rng, 0.5, 2.0), "half": even(rng, 0.2, 0.8), "inertia": some(rng, 0.02, 0.2),
        "dry": dry_of(rng, 1.0), "stops": [even(rng, -1.0, -0.1), even(rng, 0.1, 1.0)][: 1 + int(rng.integers(2))],
        "e": restitution(rng), "angle": even(rng, -0.05, 0.05), "rate": even(rng, -6.0, 6.0),
        "t_end": even(rng, 2.0, 5.0),
    }  # fmt: skip


def pendulum(n: dict[str, Any]) -> Hard:
    """Both forms: the oracle has the angle alone."""
    m, h, angle, rate, e = n["mass"], n["half"], n["angle"], n["rate"], n["e"]
    s, c = math.sin(angle), math.cos(angle)
    body = fm.RigidBody(
        "b", mass=m, inertia=n["inertia"], position=(h * s, -h * c), angle=angle, angular_velocity=rate,
        velocity=(h * c * rate, h * s * rate), points={"root": (0.0, h)},
    )  # fmt: skip
    sides = dict(zip(("lower", "upper"), n["stops"], strict=False))
    parts = [
        body, fm.Revolute("pin", body.point("root"), fm.GROUND), fm.Gravity("g"),
        fm.Stop("s", body, axis="angle", restitution=e, **sides),
    ]  # fmt: skip
    one = np.ones(1)
    surfaces = [
        flat(f"s.{side}", sign * one, abs(sides[side]), e)
        for side, sign in (("lower", 1.0), ("upper", -1.0))
        if side in sides
    ]
    dries = ()
    static, kinetic = n["dry"]
    if static:
        parts.append(fm.DryFriction("d", body, axis="angle", static=static, kinetic=kinetic))
        dries = (Dry(name="d", row=one, static=static, kinetic=kinetic),)
    problem = Struck(
        M=np.array([[n["inertia"] + m * h * h]]), force=lambda t, q, v: np.array([-m * G * h * math.sin(q[0])]),
        q=np.array([angle]), v=np.array([rate]), t_end=n["t_end"], surfaces=tuple(surfaces), dries=dries, longest=0.05,
    )  # fmt: skip
    return Hard(name="", scene=fm.Scene("pendulum", parts), problem=problem, signals=("b.angle",))


def draw_gears(rng: Generator) -> dict[str, Any]:
    """Two wheels in mesh with play: one is driven, held by a spring, the other has a dry shaft."""
    return {
        "J": [some(rng, 0.05, 0.5) for _ in range(2)], "ratio": even(rng, 0.4, 2.5), "gap": even(rng, 0.05, 0.4),
        "e": restitution(rng), "torque": wave(rng, 0.5), "k": some(rng, 0.3, 5.0), "dry": dry_of(rng, 0.15),
        "rates": [even(rng, -1.0, 1.0), even(rng, -1.0, 1.0)], "t_end": even(rng, 3.0, 8.0),
    }  # fmt: skip


def gears(n: dict[str, Any]) -> Hard:
    """Both forms: the oracle has angles alone."""
    wheels = [
        fm.RigidBody(f"w{i}", mass=1.0, inertia=J, position=(float(i), 0.0), angular_velocity=rate)
        for i, (J, rate) in enumerate(zip(n["J"], n["rates"], strict=True))
    ]
    parts: list[Any] = [
        *wheels, fm.Revolute("p0", wheels[0], fm.GROUND), fm.Revolute("p1", wheels[1], fm.ground_point(1.0, 0.0)),
        fm.Backlash("mesh", *wheels, ratio=n["ratio"], gap=n["gap"], restitution=n["e"]),
        fm.Torque("drive", wheels[0], value=formula(n["torque"], fm.t)),
        fm.TorsionSpring("k", wheels[0], stiffness=n["k"]),
    ]  # fmt: skip
    row = np.array([1.0, n["ratio"]])
    surfaces = tuple(
        flat(f"mesh.{side}", sign * row, n["gap"] / 2, n["e"]) for side, sign in (("lower", 1.0), ("upper", -1.0))
    )
    dries = ()
    static, kinetic = n["dry"]
    if static:
        parts.append(fm.DryFriction("d", wheels[1], axis="angle", static=static, kinetic=kinetic))
        dries = (Dry(name="d", row=np.array([0.0, 1.0]), static=static, kinetic=kinetic),)

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([at(n["torque"], t) - n["k"] * q[0], 0.0])

    problem = Struck(
        M=np.diag(n["J"]), force=force, q=np.zeros(2), v=np.array(n["rates"]), t_end=n["t_end"], surfaces=surfaces,
        dries=dries, longest=0.1,
    )  # fmt: skip
    return Hard(name="", scene=fm.Scene("gears", parts), problem=problem, signals=("w0.angle", "w1.angle"))


Draw = Callable[[Generator], dict[str, Any]]
SITUATIONS: dict[str, tuple[Draw, Callable[[dict[str, Any]], Hard]]] = {
    "blocks": (draw_blocks, blocks), "table": (draw_table, table), "thrown": (draw_thrown, thrown),
    "pendulum": (draw_pendulum, pendulum), "gears": (draw_gears, gears),
}  # fmt: skip


def impacts_case(n: dict[str, Any]) -> Hard:
    """Both forms."""
    case = replace(SITUATIONS[n["situation"]][1](n), name=n["situation"])
    if not n.get("poisson"):
        return case
    scene = fm.Scene(case.scene.name, [*case.scene.parts, fm.ImpactLaw("impacts", law="poisson")])
    return replace(case, scene=scene, problem=replace(case.problem, poisson=True))


MAKERS = {"impacts": impacts_case}
