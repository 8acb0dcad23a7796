"""Machines of several parts in a row: motor, lossy gear, shaft or play, drum with a rope, block, wheel on the ground.

Each machine has some of them, and the pieces of its equations stand beside the parts that they are of.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

import fricmb as fm

from .drawn import Drawn, Generator, at, even, formula, limits, some, wave
from .drives import back, between, flank
from .judge import Case
from .problem import Contact, Problem
from .references import constant

NONE = constant(math.nan)
Array = np.ndarray


def machines(rng: Generator) -> Drawn:
    """Numbers of one machine; what it is made of is drawn first."""
    has = [name for name in ("motor", "rope", "wheel") if rng.random() < 0.65] or ["rope"]
    n: dict[str, Any] = {"has": has, "t_end": even(rng, 3.0, 6.0)}
    if "motor" in has:
        n["motor"] = {
            "inertias": [some(rng, 0.1, 1.0), some(rng, 0.1, 1.0)],
            "ratio": float(round(some(rng, 0.5, 3.0) * (1 if rng.random() < 0.7 else -1), 4)),
            "losses": [even(rng, 0.4, 0.95), even(rng, 0.2, 0.9)] if rng.random() < 0.6 else None,
            "wave": wave(rng, 1.5), "held": some(rng, 0.3, 3.0), "shaft": link(rng),
            "seal": sided(rng, 0.05, 0.5) if rng.random() < 0.5 else None,
        }  # fmt: skip
    n["drum"] = {"inertia": some(rng, 0.1, 0.5), "wave": wave(rng, 0.5), "held": some(rng, 0.3, 3.0)}
    if "rope" in has:
        pull = [even(rng, 6.0, 12.0), even(rng, 6.0, 12.0)]
        n["rope"] = {
            "masses": [some(rng, 0.3, 1.0), some(rng, 0.3, 1.0)], "radius": some(rng, 0.2, 0.5),
            "angle": even(rng, 0.5, 5.0), "mu": limits(rng, 0.05, 0.3), "k": some(rng, 0.5, 3.0),
            "waves": [[p, even(rng, 0.0, 0.3 * p), some(rng, 0.3, 4.0), even(rng, 0.0, 6.28)] for p in pull],
            # an elastic strand, at whose end hangs the first weight
            "strand": [some(rng, 0.3, 1.0), some(rng, 10.0, 60.0), some(rng, 0.1, 1.0)] if rng.random() < 0.5 else None,
        }  # fmt: skip
    seals = [name for name, there in (("drum", True), ("block", "rope" in has), ("wheel", "wheel" in has)) if there]
    # who has a seal of his own has no second: the load of the rope would not follow from accelerations
    n["seal"] = [seals[rng.integers(len(seals))], *sided(rng, 0.1, 0.8)]
    n["stop"] = {"lower": -even(rng, 0.1, 0.5), "upper": even(rng, 0.1, 0.5), **flank(rng)}
    n["stopped"] = bool(rng.random() < 0.5)
    if "wheel" in has:
        n["wheel"] = {
            "mass": some(rng, 0.5, 2.0), "radius": some(rng, 0.1, 0.5), "shape": even(rng, 0.3, 1.0),
            "g": some(rng, 1.0, 10.0), "mu": limits(rng, 0.1, 0.5),
            "arm": limits(rng, 0.005, 0.05) if rng.random() < 0.6 else None,
            "waves": [wave(rng, 2.0), wave(rng, 0.3)], "v": even(rng, -1.0, 1.0), "spin": even(rng, -3.0, 3.0),
            "k": some(rng, 0.5, 5.0), "coupling": link(rng),
        }  # fmt: skip
    return Drawn("machines", "machine", n)


def link(rng: Generator) -> dict[str, Any]:
    """A spring or play."""
    if rng.random() < 0.5:
        return {"kind": "play", "gap": some(rng, 0.01, 0.2), **flank(rng)}
    return {"kind": "spring", "stiffness": some(rng, 0.5, 30.0)}


def sided(rng: Generator, low: float, high: float) -> list[float]:
    """Limits at rest and in slip, and by how much they are higher forward; one in three has none."""
    mu_s, mu_k = limits(rng, low, high)
    return [mu_s, mu_k, 0.0 if rng.random() < 0.3 else round(mu_k * rng.uniform(-0.9, 0.9), 4)]


class Machine:
    """Parts of a scene, and beside them coordinates, inertias, forces and contacts."""

    def __init__(self) -> None:
        """Without parts."""
        self.parts: list[Any] = []
        self.names: list[str] = []
        self.masses: list[float] = []
        self.start: list[float] = []
        self.forces: list[Callable[[float, Array, Array], dict[str, float]]] = []
        self.contacts: list[tuple[dict[str, float], dict[str, Any]]] = []

    def moves(self, signal: str, mass: float, start: float = 0.0) -> str:
        """One more coordinate."""
        self.names.append(signal)
        self.masses.append(mass)
        self.start.append(start)
        return signal

    def pushed(self, signal: str, values: list[float]) -> None:
        """By a wave."""
        self.forces.append(lambda t, q, v: {signal: at(values, t)})

    def tied(self, a: str, b: str | None, given: dict[str, Any]) -> None:
        """The pull of a spring, or of play, between two coordinates."""
        i, j = self.names.index(a), None if b is None else self.names.index(b)

        def force(t: float, q: Array, v: Array) -> dict[str, float]:
            x, rate = (q[i], v[i]) if j is None else (q[i] - q[j], v[i] - v[j])
            push = -given["stiffness"] * x - given.get("damper", 0.0) * rate
            if given["kind"] == "play":
                push = between(given, x, rate, 0.5 * given["gap"])
            return {a: push} if b is None else {a: push, b: -push}

        self.forces.append(force)

    def total(self, t: float, q: Array, v: Array) -> Array:
        """Of all forces along each coordinate."""
        out = dict.fromkeys(self.names, 0.0)
        for force in self.forces:
            for name, value in force(t, q, v).items():
                out[name] += value
        return np.array([out[name] for name in self.names])

    def rubbed(self, name: str, along: dict[str, float], mu: tuple[float, float] | list[float], **more: Any) -> None:
        """A contact with limits at rest and in slip."""
        given = {"N": constant(1.0), "mu_s": constant(mu[0]), "mu": constant(mu[1]), **more}
        self.contacts.append((along, {"name": name, **given}))

    def problem(self, t_end: float) -> Problem:
        """As numbers."""
        count = len(self.names)
        contacts = tuple(
            Contact(W=np.array([[along.get(name, 0.0)] for name in self.names]), **given)
            for along, given in self.contacts
        )
        zero = np.zeros((count, count))
        return Problem(
            M=np.diag(self.masses), K=zero, C=zero, q=np.zeros(count), v=np.array(self.start), t_end=t_end,
            contacts=contacts, extra=self.total,
        )  # fmt: skip


def dry(m: Machine, name: str, body: Any, axis: str, signal: str, given: list[float]) -> None:
    """A seal, stronger one way: the half of the difference is a force of its own beside a symmetric limit."""
    mu_s, mu_k, more = given
    law: Any = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    if more:
        law = fm.laws.Offset.by_sense(mu_s=(mu_s + more, mu_s - more), mu_k=(mu_k + more, mu_k - more))
    m.parts.append(fm.DryFriction(name, body, axis=axis, law=law))
    m.forces.append(lambda t, q, v: {signal: -more})
    m.rubbed(name, {signal: 1.0}, (mu_s, mu_k))


def tie(m: Machine, name: str, a: Any, b: Any, axis: str, given: dict[str, Any]) -> None:
    """The part that :meth:`Machine.tied` stands for."""
    fields = {key: value for key, value in given.items() if key not in ("kind", "damper")}
    if given["kind"] == "play":
        m.parts.append(fm.Backlash(name, a, b, axis=axis, **fields))
    elif axis == "angle":
        m.parts.append(fm.TorsionSpring(name, a, b, **fields))
    else:
        m.parts.append(fm.Spring(name, a, b, axis=axis, **fields))
    if "damper" in given:
        m.parts.append(fm.Damper(f"{name}_damper", a, b, axis=axis, damping=given["damper"]))


def drum_of(m: Machine, n: dict[str, Any]) -> Any:
    """A drum on its axle, on a spring."""
    drum = fm.RigidBody("d", mass=1.0, inertia=n["inertia"])
    m.parts += [
        drum, fm.Revolute("axle", drum), fm.TorsionSpring("kd", drum, stiffness=n["held"]),
        fm.Torque("td", drum, value=formula(n["wave"], fm.t)),
    ]  # fmt: skip
    m.moves("d.angle", n["inertia"])
    m.pushed("d.angle", n["wave"])
    m.tied("d.angle", None, {"kind": "spring", "stiffness": n["held"]})
    return drum


def motor_of(m: Machine, n: dict[str, Any], drum: Any) -> None:
    """A motor on a spring, a gear, and a shaft or a clutch with play to the drum."""
    (J_a, J_b), r, shaft = n["inertias"], n["ratio"], n["shaft"]
    a = fm.RigidBody("a", mass=1.0, inertia=J_a, position=(2.0, 0.0))
    b = fm.RigidBody("b", mass=1.0, inertia=J_b, position=(3.0, 0.0))
    losses = {} if n["losses"] is None else dict(zip(("efficiency", "efficiency_back"), n["losses"], strict=True))
    m.parts += [
        a, b, fm.Revolute("pa", a, fm.ground_point(2.0, 0.0)), fm.Revolute("pb", b, fm.ground_point(3.0, 0.0)),
        fm.Gear("g", a, b, ratio=r, **losses), fm.TorsionSpring("ka", a, stiffness=n["held"]),
        fm.Torque("ta", a, value=formula(n["wave"], fm.t)),
    ]  # fmt: skip
    m.moves("a.angle", J_a + J_b / r**2)
    m.pushed("a.angle", n["wave"])
    m.tied("a.angle", None, {"kind": "spring", "stiffness": n["held"]})
    i, j = m.names.index("a.angle"), m.names.index("d.angle")

    def on_b(q: Array, v: Array) -> float:
        x, rate = -q[i] / r - q[j], -v[i] / r - v[j]
        return -shaft["stiffness"] * x if shaft["kind"] == "spring" else between(shaft, x, rate, 0.5 * shaft["gap"])

    def turned(t: float, q: Array, v: Array) -> dict[str, float]:
        return {"a.angle": -on_b(q, v) / r, "d.angle": -on_b(q, v)}

    tie(m, "shaft", b, drum, "angle", shaft)
    m.forces.append(turned)
    if n["losses"] is None:
        if n["seal"]:
            dry(m, "sa", a, "angle", "a.angle", n["seal"])
        return
    e, e_b = n["losses"]
    bare = (1 - e) * (1 - e_b) / (1 - e * e_b)
    mu, share = 2 * bare, (1 - 2 * e_b + e * e_b) / (1 - e * e_b) / 2 / bare

    def load(t: float, q: Array, v: Array, acc: Array) -> float:
        on_a = at(n["wave"], t) - n["held"] * q[i]
        F = (J_a + J_b / r**2) * acc[i] - (on_a - on_b(q, v) / r)
        return float(mu * abs(J_a * acc[i] - on_a - share * F))

    m.rubbed("g", {"a.angle": 1.0}, (1.0, 1.0), N=NONE, reaction=load)


def rope_of(m: Machine, n: dict[str, Any], drum: Any, sealed: bool) -> Any:
    """Two weights on a rope over the drum; the first may hang on an elastic strand."""
    (m_a, m_b), R, (mu_s, mu_k) = n["masses"], n["radius"], n["mu"]
    a, b = fm.Body("w1", mass=m_a), fm.Body("w2", mass=m_b)
    m.parts += [
        a, b, fm.Rope("c", (a, b), axes="xx", angle=n["angle"], drum=drum, radius=R,
                      friction=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)),
        fm.Spring("kb", b, axis="x", stiffness=n["k"]), fm.Force("fb", b, axis="x", value=formula(n["waves"][1], fm.t)),
    ]  # fmt: skip
    m.moves("w2.x", m_a + m_b)
    m.pushed("w2.x", n["waves"][1])
    m.tied("w2.x", None, {"kind": "spring", "stiffness": n["k"]})
    i, hung, far = m.names.index("w2.x"), a, None
    pull = n["waves"][0]
    if n["strand"] is not None:
        mass, stiffness, damper = n["strand"]
        hung = fm.Body("w3", mass=mass)
        m.parts.append(hung)
        m.moves("w3.x", mass)
        far = m.names.index("w3.x")
        tie(m, "strand", hung, a, "x", {"kind": "spring", "stiffness": stiffness, "damper": damper})
        m.pushed("w3.x", pull)
    m.parts.append(fm.Force("fa", hung, axis="x", value=formula(pull, fm.t)))

    def on_first(t: float, q: Array, v: Array) -> float:
        """Along its own way, which is that of the second turned round."""
        if far is None:
            return at(pull, t)
        return float(stiffness * (q[far] + q[i]) + damper * (v[far] + v[i]))

    def drawn(t: float, q: Array, v: Array) -> dict[str, float]:
        back_on = on_first(t, q, v)
        return {"w2.x": -back_on} if far is None else {"w2.x": -back_on, "w3.x": -back_on}

    m.forces.append(drawn)
    wind, j = math.tanh(0.5 * mu_k * n["angle"]), m.names.index("d.angle")

    def load(t: float, q: Array, v: Array, acc: Array) -> float:
        first = on_first(t, q, v) + m_a * acc[i]
        on = m.total(t, q, v)
        if sealed:
            # the drum has no seal then: what turns it beside its own forces is the difference of the tensions
            difference = (on[j] - m.masses[j] * acc[j]) / R
            return float(wind * (2.0 * first - difference))
        second = on[i] + on_first(t, q, v) - m_b * acc[i]
        return float(wind * (first + second))

    power = math.tanh(0.5 * mu_s * n["angle"]) / wind
    m.rubbed("c", {"w2.x": 1.0, "d.angle": -R}, (power, 1.0), N=NONE, reaction=load, constant=False)
    return b


def wheel_of(m: Machine, n: dict[str, Any], block: Any) -> Any:
    """A disc on a floor, on a spring to the ground, and tied to the block where there is one."""
    mass, R, g, (mu_s, mu_k) = n["mass"], n["radius"], n["g"], n["mu"]
    inertia = n["shape"] * mass * R**2
    body = fm.RigidBody(
        "w", mass=mass, inertia=inertia, position=(0.0, R), velocity=(n["v"], 0.0), angular_velocity=n["spin"]
    )
    arm = {"rolling_resistance": fm.laws.Coulomb(mu_s=n["arm"][0], mu_k=n["arm"][1])} if n["arm"] else {}
    m.parts += [
        body, fm.Wheel("floor", body, radius=R, friction=fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k), **arm),
        fm.Force("weight", body, axis="y", value=-mass * g), fm.Spring("kw", body, axis="x", stiffness=n["k"]),
        fm.Force("fw", body, axis="x", value=formula(n["waves"][0], fm.t)),
        fm.Torque("tw", body, value=formula(n["waves"][1], fm.t)),
    ]  # fmt: skip
    m.moves("w.x", mass, n["v"])
    m.moves("w.angle", inertia, n["spin"])
    m.tied("w.x", None, {"kind": "spring", "stiffness": n["k"]})
    m.pushed("w.x", n["waves"][0])
    m.pushed("w.angle", n["waves"][1])
    if block is not None:
        tie(m, "coupling", block, body, "x", n["coupling"])
        m.tied("w2.x", "w.x", n["coupling"])
    m.rubbed("floor", {"w.x": 1.0, "w.angle": R}, (mu_s, mu_k), N=constant(mass * g))
    if n["arm"]:
        m.rubbed("floor_rolling", {"w.angle": 1.0}, n["arm"], N=constant(mass * g))
    return body


def machine(n: dict[str, Any]) -> Case:
    """Both forms."""
    m, block, body = Machine(), None, None
    drum = drum_of(m, n["drum"])
    where, *given = n["seal"]
    if "motor" in n["has"]:
        motor_of(m, n["motor"], drum)
    if "rope" in n["has"]:
        block = rope_of(m, n["rope"], drum, where == "block")
    if "wheel" in n["has"]:
        body = wheel_of(m, n["wheel"], block)
    places = {"drum": (drum, "angle", "d.angle"), "block": (block, "x", "w2.x"), "wheel": (body, "x", "w.x")}
    dry(m, "seal", *places[where], given)
    if n["stopped"]:
        last, axis, signal = places["wheel" if body is not None else "block" if block is not None else "drum"]
        ends, i = n["stop"], m.names.index(signal)
        m.parts.append(fm.Stop("stop", last, axis=axis, **ends))
        m.forces.append(lambda t, q, v: {
            signal: back(ends, ends["lower"] - q[i], -v[i]) - back(ends, q[i] - ends["upper"], v[i])
        })  # fmt: skip
    return Case(
        name="machine", scene=fm.Scene("machine", m.parts), problem=m.problem(n["t_end"]), signals=tuple(m.names)
    )


MAKERS = {"machine": machine}
