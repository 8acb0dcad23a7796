"""Trains of play, stops and dry seals; ropes on drums; lossy gears; wheels on the ground."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import fricmb as fm

from .drawn import Drawn, Generator, at, even, formula, limits, some, wave
from .judge import Case
from .parts import pushed_back
from .problem import Contact, Problem
from .references import constant

NONE = constant(math.nan)


def drives(rng: Generator) -> Drawn:
    """One of the four."""
    maker = ("train", "train", "rope", "gear", "wheel")[rng.integers(5)]
    return Drawn("drives", maker, {"train": train, "rope": rope, "gear": gear, "wheel": wheel}[maker](rng))


def flank(rng: Generator) -> dict[str, float]:
    """What a stop or a flank is made of: loss of Hunt and Crossley, a damper that comes in, or none."""
    loss = rng.integers(3)
    stiffness = some(rng, 10.0, 300.0)
    return {
        "stiffness": stiffness, "hunt_crossley": even(rng, 0.1, 1.0) if loss == 0 else 0.0,
        "damping": round(0.2 * math.sqrt(stiffness) * rng.uniform(0.1, 1.0), 4) if loss == 1 else 0.0,
        "damping_depth": some(rng, 0.01, 0.1),
    }  # fmt: skip


def train(rng: Generator) -> dict[str, Any]:
    """Masses in a row with springs or play between, stops at some, dry friction on the ground or between."""
    count = int(rng.integers(1, 4))
    n: dict[str, Any] = {"masses": [some(rng, 0.3, 2.0) for _ in range(count)], "t_end": even(rng, 4.0, 8.0)}
    n["links"] = [
        {"kind": "play", "gap": some(rng, 0.01, 0.3), **flank(rng)} if rng.random() < 0.6
        else {"kind": "spring", "stiffness": some(rng, 0.5, 30.0)}
        for _ in range(count - 1)
    ]  # fmt: skip
    n["stops"] = {
        str(i): {"lower": -even(rng, 0.1, 0.6), "upper": even(rng, 0.1, 0.6), **flank(rng)}
        for i in range(count) if rng.random() < 0.5
    }  # fmt: skip
    n["dry"] = [
        [i, -1 if i == 0 or rng.random() < 0.6 else i - 1, *limits(rng, 0.1, 0.8), bool(rng.random() < 0.6)]
        for i in range(count) if i == 0 or rng.random() < 0.7
    ]  # fmt: skip
    n["waves"] = [wave(rng, 1.5) if i == 0 or rng.random() < 0.4 else [0.0, 0.0, 1.0, 0.0] for i in range(count)]
    n["v"] = [0.0 if rng.random() < 0.5 else even(rng, -1.0, 1.0) for _ in range(count)]
    return n


def train_case(n: dict[str, Any]) -> Case:
    """Both forms."""
    count = len(n["masses"])
    bodies = [
        fm.Body(f"b{i}", mass=m, velocity={"x": v}) for i, (m, v) in enumerate(zip(n["masses"], n["v"], strict=True))
    ]
    parts: list[Any] = list(bodies)
    for i, w in enumerate(n["waves"]):
        parts.append(fm.Force(f"f{i}", bodies[i], axis="x", value=formula(w, fm.t)))
    for i, link in enumerate(n["links"]):
        given = {key: value for key, value in link.items() if key != "kind"}
        kind = fm.Backlash if link["kind"] == "play" else fm.Spring
        parts.append(kind(f"l{i}", bodies[i], bodies[i + 1], axis="x", **given))
    parts += [fm.Stop(f"s{i}", bodies[int(i)], axis="x", **given) for i, given in n["stops"].items()]
    contacts = []
    for i, j, mu_s, mu_k, seal in n["dry"]:
        ends = (bodies[i], fm.GROUND if j < 0 else bodies[j])
        name = f"c{i}"
        law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
        parts.append(
            fm.DryFriction(name, *ends, axis="x", static=mu_s, kinetic=mu_k) if seal
            else fm.Contact(name, *ends, law=law, normal_force=1.0, axes="x")
        )  # fmt: skip
        W = np.eye(count)[:, [i]] - (np.eye(count)[:, [j]] if j >= 0 else 0.0)
        contacts.append(Contact(name=name, W=W, N=constant(1.0), mu=constant(mu_k), mu_s=constant(mu_s)))

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        out = np.array([at(w, t) for w in n["waves"]])
        for i, link in enumerate(n["links"]):
            x, rate = q[i] - q[i + 1], v[i] - v[i + 1]
            pull = link["stiffness"] * x if link["kind"] == "spring" else -between(link, x, rate, 0.5 * link["gap"])
            out[i] -= pull
            out[i + 1] += pull
        for i, ends in n["stops"].items():
            k = int(i)
            out[k] += back(ends, ends["lower"] - q[k], -v[k]) - back(ends, q[k] - ends["upper"], v[k])
        return out

    zero = np.zeros((count, count))
    problem = Problem(
        M=np.diag(n["masses"]), K=zero, C=zero, q=np.zeros(count), v=np.array(n["v"]), t_end=n["t_end"],
        contacts=tuple(contacts), extra=force,
    )  # fmt: skip
    return Case(
        name="train", scene=fm.Scene("train", parts), problem=problem, signals=tuple(f"b{i}.x" for i in range(count))
    )


def back(ends: dict[str, float], depth: float, rate: float) -> float:
    """Of one end."""
    return pushed_back(
        depth, rate, ends["stiffness"], ends["hunt_crossley"], ends["damping"], ends["damping_depth"]
    )


def between(link: dict[str, float], x: float, rate: float, half: float) -> float:
    """Force of play on the first."""
    return back(link, -half - x, -rate) - back(link, x - half, rate)


def rope(rng: Generator) -> dict[str, Any]:
    """Numbers of two blocks on a rope over a drum that is fixed or turns."""
    pull = [even(rng, 2.0, 6.0), even(rng, 2.0, 6.0)]
    share = [even(rng, 0.0, 0.4), even(rng, 0.0, 0.6)]
    return {
        "masses": [some(rng, 0.3, 1.0), some(rng, 0.3, 1.0)], "pull": pull, "angle": even(rng, 0.5, 6.0),
        "waves": [[p, round(p * s, 4), some(rng, 0.3, 4.0), even(rng, 0.0, 6.28)]
                  for p, s in zip(pull, share, strict=True)],
        "mu": limits(rng, 0.05, 0.3), "k": 0.0 if rng.random() < 0.5 else some(rng, 0.3, 3.0),
        "damping": 0.0 if rng.random() < 0.5 else some(rng, 0.05, 0.5), "v": even(rng, -0.3, 0.3),
        "drum": bool(rng.random() < 0.5), "inertia": some(rng, 0.05, 0.5), "radius": some(rng, 0.2, 0.5),
        "turns": wave(rng, 0.5), "stiff": some(rng, 0.5, 5.0), "t_end": even(rng, 4.0, 8.0),
    }  # fmt: skip


def rope_case(n: dict[str, Any]) -> Case:
    """Coordinates: the way of the second block, and of a drum that turns its angle."""
    (m_a, m_b), (mu_s, mu_k), R = n["masses"], n["mu"], n["radius"]
    a = fm.Body("a", mass=m_a, velocity={"x": -n["v"]})
    b = fm.Body("b", mass=m_b, velocity={"x": n["v"]})
    parts: list[Any] = [a, b, *(
        fm.Force(f"f{name}", body, axis="x", value=formula(w, fm.t))
        for name, body, w in zip("ab", (a, b), n["waves"], strict=True)
    )]  # fmt: skip
    turning = {}
    if n["drum"]:
        drum = fm.RigidBody("d", mass=1.0, inertia=n["inertia"])
        parts += [
            drum, fm.Revolute("axle", drum), fm.Torque("t", drum, value=formula(n["turns"], fm.t)),
            fm.TorsionSpring("kd", drum, stiffness=n["stiff"]),
        ]  # fmt: skip
        turning = {"drum": drum, "radius": R}
    if n["k"]:
        parts.append(fm.Spring("k", b, axis="x", stiffness=n["k"]))
    if n["damping"]:
        parts.append(fm.Damper("c_b", b, axis="x", damping=n["damping"]))
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    parts.append(fm.Rope("c", (a, b), axes="xx", angle=n["angle"], friction=law, **turning))
    wind = math.tanh(0.5 * mu_k * n["angle"])

    def held(t: float, q: np.ndarray, v: np.ndarray) -> float:
        return float(at(n["waves"][1], t) - n["k"] * q[0] - n["damping"] * v[0])

    def load(t: float, q: np.ndarray, v: np.ndarray, acc: np.ndarray) -> float:
        return wind * (at(n["waves"][0], t) + m_a * acc[0] + held(t, q, v) - m_b * acc[0])

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        along = held(t, q, v) - at(n["waves"][0], t)
        return np.array([along, at(n["turns"], t) - n["stiff"] * q[1]] if n["drum"] else [along])

    d = 1 + n["drum"]
    M = np.diag([m_a + m_b, n["inertia"]][:d])
    W = np.array([[1.0], [-R]])[:d]
    # what breaks away is the ratio of tensions e^(mu_s angle), not so many times the difference as mu_s is over mu_k
    more = math.tanh(0.5 * mu_s * n["angle"]) / wind
    contact = Contact(name="c", W=W, N=NONE, reaction=load, mu=constant(1.0), mu_s=constant(more))
    zero = np.zeros((d, d))
    problem = Problem(
        M=M, K=zero, C=zero, q=np.zeros(d), v=np.array([n["v"], 0.0][:d]), t_end=n["t_end"], contacts=(contact,),
        extra=force,
    )  # fmt: skip
    return Case(name="rope", scene=fm.Scene("rope", parts), problem=problem, signals=("b.x", "d.angle")[:d])


def gear(rng: Generator) -> dict[str, Any]:
    """Numbers of a lossy gear between a motor and a load that a shaft ties to another."""
    e = even(rng, 0.4, 0.95)
    ratio = float(round(some(rng, 0.5, 4.0) * (1 if rng.random() < 0.7 else -1), 4))
    return {
        "inertias": [some(rng, 0.1, 1.0) for _ in range(3)], "ratio": ratio, "efficiency": e,
        "back": even(rng, 0.2, 0.9), "waves": [wave(rng, 1.0), wave(rng, 1.0)], "shaft": some(rng, 0.5, 20.0),
        "held": some(rng, 0.3, 3.0), "seal": limits(rng, 0.05, 0.5),
        "more": even(rng, 1.0, 1.3) if rng.random() < 0.4 else 1.0,
        "v": 0.0 if rng.random() < 0.5 else even(rng, -1.0, 1.0), "t_end": even(rng, 4.0, 8.0),
    }  # fmt: skip


def gear_case(n: dict[str, Any]) -> Case:
    """Coordinates: angles of the motor and of what the shaft ends at."""
    (J_a, J_b, J_c), r, e, e_b = n["inertias"], n["ratio"], n["efficiency"], n["back"]
    v = n["v"]
    a = fm.RigidBody("a", mass=1.0, inertia=J_a, angular_velocity=v)
    b = fm.RigidBody("b", mass=1.0, inertia=J_b, angular_velocity=-v / r)
    c = fm.RigidBody("c", mass=1.0, inertia=J_c)
    law = {"friction": fm.laws.Coulomb(mu_s=n["more"], mu_k=1.0)} if n["more"] > 1.0 else {}
    parts = [
        a, b, c, *(fm.Revolute(f"p{body.name}", body) for body in (a, b, c)),
        fm.Gear("g", a, b, ratio=r, efficiency=e, efficiency_back=e_b, **law),
        fm.Torque("ta", a, value=formula(n["waves"][0], fm.t)), fm.Torque("tc", c, value=formula(n["waves"][1], fm.t)),
        fm.TorsionSpring("shaft", b, c, stiffness=n["shaft"]), fm.TorsionSpring("held", a, stiffness=n["held"]),
        fm.DryFriction("s", c, axis="angle", static=n["seal"][0], kinetic=n["seal"][1]),
    ]  # fmt: skip
    mu, share = 2 * (1 - e) * (1 - e_b) / (1 - e * e_b), (1 - 2 * e_b + e * e_b) / (1 - e * e_b) / 2
    share = share / ((1 - e) * (1 - e_b) / (1 - e * e_b))  # c of c mu
    M = J_a + J_b / r**2

    def torques(t: float, q: np.ndarray) -> tuple[float, float, float]:
        twist = n["shaft"] * (-q[0] / r - q[1])
        return at(n["waves"][0], t) - n["held"] * q[0], -twist, at(n["waves"][1], t) + twist

    def load(t: float, q: np.ndarray, v: np.ndarray, acc: np.ndarray) -> float:
        on_a, on_b, _ = torques(t, q)
        F = M * acc[0] - (on_a - on_b / r)
        return float(mu * abs(J_a * acc[0] - on_a - share * F))

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        on_a, on_b, on_c = torques(t, q)
        return np.array([on_a - on_b / r, on_c])

    mesh = Contact(
        name="g", W=np.array([[1.0], [0.0]]), N=NONE, reaction=load, mu=constant(1.0), mu_s=constant(n["more"])
    )
    seal = Contact(
        name="s", W=np.array([[0.0], [1.0]]), N=constant(1.0), mu=constant(n["seal"][1]), mu_s=constant(n["seal"][0])
    )
    zero = np.zeros((2, 2))
    # loads that are prescribed come first to the oracle only in name: reactions are asked of all contacts at once
    problem = Problem(
        M=np.diag([M, J_c]), K=zero, C=zero, q=np.zeros(2), v=np.array([v, 0.0]), t_end=n["t_end"],
        contacts=(mesh, seal), extra=force,
    )  # fmt: skip
    return Case(name="gear", scene=fm.Scene("gear", parts), problem=problem, signals=("a.angle", "c.angle"))


def wheel(rng: Generator) -> dict[str, Any]:
    """Numbers of a disc on a floor that may lean."""
    return {
        "mass": some(rng, 0.5, 2.0), "radius": some(rng, 0.1, 0.5), "shape": even(rng, 0.3, 1.0),
        "lean": 0.0 if rng.random() < 0.5 else even(rng, -0.4, 0.4), "g": some(rng, 1.0, 10.0),
        "mu": limits(rng, 0.1, 0.5), "k": 0.0 if rng.random() < 0.4 else some(rng, 0.5, 10.0),
        "waves": [wave(rng, 2.0), wave(rng, 0.5)], "v": even(rng, -1.0, 1.0), "spin": even(rng, -4.0, 4.0),
        "rolls": limits(rng, 0.02, 0.2) if rng.random() < 0.4 else None, "t_end": even(rng, 4.0, 8.0),
        "belt": 0.0 if rng.random() < 0.6 else even(rng, -1.0, 1.0),
    }  # fmt: skip


def wheel_case(n: dict[str, Any]) -> Case:
    """Coordinates: the way along the floor and the angle."""
    m, R, g = n["mass"], n["radius"], n["g"]
    c, s = math.cos(n["lean"]), math.sin(n["lean"])
    inertia = n["shape"] * m * R**2
    body = fm.RigidBody(
        "m", mass=m, inertia=inertia, position=(-R * s, R * c), velocity=(n["v"] * c, n["v"] * s),
        angular_velocity=n["spin"],
    )  # fmt: skip
    law = fm.laws.Coulomb(mu_s=n["mu"][0], mu_k=n["mu"][1])
    push = formula(n["waves"][0], fm.t)
    parts = [
        body, fm.Wheel("c", body, radius=R, angle=n["lean"], friction=law, slide=n["belt"]),
        fm.Gravity("g", acceleration={"y": -g}), fm.Force("f", body, axis=(c, s), value=push),
        fm.Torque("w", body, value=formula(n["waves"][1], fm.t)),
    ]  # fmt: skip
    if n["k"]:
        parts.append(fm.Spring("k", body, axis=(c, s), stiffness=n["k"], length=-R * s * c + R * c * s))
    W, slide = np.array([[1.0], [R]]), np.array([n["belt"]])
    contacts = [Contact(
        name="c", W=W, N=constant(m * g * c), mu=constant(n["mu"][1]), mu_s=constant(n["mu"][0]),
        slide=lambda t: slide,
    )]  # fmt: skip
    if n["rolls"]:
        parts.append(fm.DryFriction("r", body, axis="angle", static=n["rolls"][0], kinetic=n["rolls"][1]))
        contacts.append(Contact(
            name="r", W=np.array([[0.0], [1.0]]), N=constant(1.0), mu=constant(n["rolls"][1]),
            mu_s=constant(n["rolls"][0]),
        ))  # fmt: skip

    def force(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        return np.array([at(n["waves"][0], t) - m * g * s - n["k"] * q[0], at(n["waves"][1], t)])

    zero = np.zeros((2, 2))
    problem = Problem(
        M=np.diag([m, inertia]), K=zero, C=zero, q=np.zeros(2), v=np.array([n["v"], n["spin"]]), t_end=n["t_end"],
        contacts=tuple(contacts), extra=force,
    )  # fmt: skip

    def seen(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        here = np.array([-R * s, R * c])[:, None]
        return np.array([*(here + np.array([[c], [s]]) * q[0]), q[1]]), np.array([c * v[0], s * v[0], v[1]])

    # a floor that does not lean has no second signal that moves
    return Case(
        name="wheel", scene=fm.Scene("wheel", parts), problem=problem, signals=("m.x", "m.y", "m.angle"), seen=seen
    )


MAKERS = {"train": train_case, "rope": rope_case, "gear": gear_case, "wheel": wheel_case}
