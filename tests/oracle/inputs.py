"""Scenes whose functions of time move fast, briefly or hardly: on loads, normal forces and shaken ground.

One kind of input, one place for it, one kind of body, one law: whatever a method steps over shows as a transition that
is missing.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .drawn import Generator, even, some
from .judge import Case
from .laws import parts_of
from .problem import Contact, Problem, nothing

#: Part of the inverse of a frequency that a step of the oracle takes at most; where it begins anew about what is brief,
#: in widths.
SEEN, WITHIN = 0.25, (-6.0, -4.0, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 4.0, 6.0)
FORMS = ("fast", "slow", "chirp", "bell", "triangle", "rectangle", "engagement", "noise", "beats")
PLACES = ("load", "normal", "ground")
BODIES = ("block", "pair", "modes", "line", "hinge", "space hinge")
#: Those of which the ground does not move.
HINGES = ("hinge", "space hinge")
LAWS: dict[str, dict[str, Any]] = {
    "Coulomb": {"mu_s": 0.7, "mu_k": 0.5}, "Stribeck": {"mu_s": 0.7, "mu_k": 0.5, "v_s": 0.1},
    "Tabulated": {"speed": (0.0, 0.05, 0.2, 1.0), "mu": (0.6, 0.5, 0.45, 0.5), "mu_s": 0.7},
    "LuGre": {"sigma0": 200.0, "sigma1": 0.0, "sigma2": 0.1, "mu_s": 0.7, "mu_k": 0.5, "v_s": 0.1},
    "TanhRegularised": {"mu": 0.6, "v_reg": 1e-2},
}  # fmt: skip


@dataclass
class Input:
    """A function of time: its form, and numbers that the form has a meaning for."""

    form: str
    numbers: list[float]
    samples: list[float] = field(default_factory=list)

    def formula(self) -> Any:
        """In SymPy; noise has none."""
        t, n = fm.t, self.numbers
        if self.form in ("fast", "slow"):
            return sympy.sin(n[0] * t + n[1])
        if self.form == "chirp":
            return sympy.sin((n[0] + n[1] * t) * t)
        if self.form == "drift":
            return (1 - n[3]) * sympy.sin(n[0] * t + n[1]) + n[3] * t / n[2]
        if self.form == "beats":
            return (sympy.sin(n[0] * t) + sympy.sin(1.07 * n[0] * t)) / 2
        if self.form == "bell":
            return sympy.exp(-(((t - n[0]) / n[1]) ** 2))
        if self.form == "triangle":
            return sympy.Max(0, 1 - sympy.Abs(t - n[0]) / n[1])
        if self.form == "rectangle":
            return sympy.Piecewise((0, t < n[0] - n[1]), (1, t < n[0] + n[1]), (0, True))
        return (1 + sympy.tanh((t - n[0]) / n[1])) / 2

    def given(self) -> Any:
        """What fricmb gets."""
        if self.form == "noise":
            return fm.Signal(np.linspace(0.0, self.numbers[0], len(self.samples)), self.samples)._sympy_()
        return self.formula()

    def numeric(self) -> tuple[Callable[[float], float], Callable[[float], float]]:
        """Value and slope from the right, as functions of numbers."""
        n = self.numbers
        if self.form == "noise":
            t = np.linspace(0.0, n[0], len(self.samples))
            y = np.array(self.samples)
            slope = np.append(np.diff(y) / np.diff(t), 0.0)
            place = lambda x: min(max(int(np.searchsorted(t, x, side="right")) - 1, 0), len(t) - 2)  # noqa: E731
            return (
                lambda x: float(y[place(x)] + slope[place(x)] * (x - t[place(x)])),
                lambda x: float(slope[place(x)]),
            )
        if self.form == "triangle":
            return (
                lambda x: max(0.0, 1.0 - abs(x - n[0]) / n[1]),
                lambda x: 0.0 if not -n[1] <= x - n[0] < n[1] else (1.0 if x < n[0] else -1.0) / n[1],
            )
        if self.form == "rectangle":
            return (lambda x: float(n[0] - n[1] <= x < n[0] + n[1])), nothing
        value = self.formula()
        return tuple(sympy.lambdify(fm.t, e, "math") for e in (value, sympy.diff(value, fm.t)))  # type: ignore[return-value]

    def breaks(self) -> list[float]:
        """Where explicit steps begin anew: at kinks and jumps, and in what is brief."""
        n = self.numbers
        if self.form == "noise":
            return np.linspace(0.0, n[0], len(self.samples)).tolist()
        if self.form in ("bell", "engagement"):
            return [n[0] + k * n[1] for k in WITHIN]
        if self.form == "triangle":
            return [n[0] - n[1], n[0], n[0] + n[1]]
        return [n[0] - n[1], n[0] + n[1]] if self.form == "rectangle" else []

    def fastest(self, t_end: float) -> float:
        """Its highest angular frequency."""
        n = self.numbers
        if self.form in ("fast", "slow", "beats", "drift"):
            return 1.07 * n[0]
        return n[0] + 2.0 * n[1] * t_end if self.form == "chirp" else 0.0


@dataclass
class Shaken:
    """A body on rough ground (``body``), and what acts: ``size`` times the input beside ``constant``.

    ``place``: where the input acts; a load beside it is ``constant`` times what the ground holds at rest.
    """

    body: str
    law: str
    place: str
    input: Input
    t_end: float
    constant: float
    size: float
    springs: list[float]
    v: float = 0.0
    kind: str = "inputs"

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


#: Force that ground holds at rest, the normal force, and the radius of a dry hinge, which is pressed the harder.
HOLD, N, RADIUS = 0.7, 1.0, 0.5
#: At which a force turns the hinge in space: long, so that it hardly lifts it.
ARM = 20.0


def shaken(rng: Generator) -> Shaken:
    """One of each, at random."""
    form, place = FORMS[rng.integers(len(FORMS))], PLACES[rng.integers(len(PLACES))]
    body, law = BODIES[rng.integers(len(BODIES))], list(LAWS)[rng.integers(len(LAWS))]
    if place == "ground" and form == "rectangle":
        form = "triangle"  # a surface that jumps is a transition of its own
    if body in HINGES and place == "ground":
        place = "load"
    t_end = even(rng, 10.0, 40.0)
    at = even(rng, 0.2 * t_end, 0.8 * t_end)
    width = some(rng, 1e-5, 1e-1) * t_end
    numbers = {
        "fast": [some(rng, 20.0, 100.0), even(rng, 0.0, 6.28)], "slow": [some(rng, 0.3, 3.0), even(rng, 0.0, 6.28)],
        "chirp": [some(rng, 0.5, 5.0), some(rng, 0.2, 1.0)], "beats": [some(rng, 10.0, 60.0)],
        "bell": [at, width], "triangle": [at, width], "rectangle": [at, width],
        "engagement": [at, some(rng, 1e-5, 1e-2) * t_end], "noise": [t_end],
    }[form]  # fmt: skip
    samples = [round(float(x), 4) for x in rng.uniform(-1.0, 1.0, 120)] if form == "noise" else []
    brief = form in ("bell", "triangle", "rectangle")
    moving = bool(rng.random() < 0.3)
    constant = even(rng, 0.3, 0.9) * (0.0 if moving else 1.0)
    over = even(rng, -0.03, 0.1)  # just over the cone, or just below it
    if place == "load":
        size = (1.0 - constant + over) * HOLD
        if brief and rng.random() < 0.7:
            size = HOLD * (1.0 + some(rng, 0.1, 1.0) / max(width, 1e-3))  # enough to be seen afterwards
    elif place == "normal":
        size = -(1.0 - constant - over) if constant else -even(rng, 0.2, 0.9)
        size = max(size, -0.95)
    else:
        size = some(rng, 0.02, 0.5)
    springs = [some(rng, 0.3, 10.0)] if body not in HINGES and rng.random() < 0.6 else [0.0]
    if body == "pair":
        springs.append(some(rng, 0.3, 10.0))
    return Shaken(
        body=body, law=law, place=place, input=Input(form, numbers, samples), t_end=t_end, constant=constant,
        size=round(size, 5), springs=springs, v=even(rng, 0.3, 1.0) if moving else 0.0,
    )  # fmt: skip


def excursion(rng: Generator) -> Shaken:
    """Rest under a law with a cone, left for a moment alone: by a pulse, or by crests that pass the cone late."""
    form = ("drift", "drift", "bell", "triangle", "rectangle")[rng.integers(5)]
    body = BODIES[rng.integers(len(BODIES))]
    law = ("Coulomb", "Stribeck", "Tabulated")[rng.integers(3)]
    place = "load" if form != "drift" or rng.random() < 0.7 else "normal"
    t_end = even(rng, 30.0, 70.0)
    width = some(rng, 1e-5, 1e-2) * t_end
    constant = even(rng, 0.3, 0.8)
    if form == "drift":
        numbers = [some(rng, 15.0, 40.0), even(rng, 0.0, 6.28), t_end, some(rng, 0.02, 0.3)]
        size = (1.0 - constant + some(rng, 1e-3, 3e-2)) * (HOLD if place == "load" else -1.0)
    else:
        numbers = [even(rng, 0.3 * t_end, 0.8 * t_end), width]
        size = HOLD * (1.0 + some(rng, 0.1, 1.0) / width)
    springs = [some(rng, 0.3, 10.0)] if body not in HINGES and rng.random() < 0.3 else [0.0]
    if body == "pair":
        springs.append(some(rng, 0.3, 10.0))
    return Shaken(
        body=body, law=law, place=place, input=Input(form, numbers), t_end=t_end, constant=constant,
        size=round(size, 5), springs=springs, kind="excursions",
    )  # fmt: skip


# -- both forms -----------------------------------------------------------------------------------------------------
#: Frequencies, damping ratios and shape of the body of modes at its foot.
MODES = ((1.3, 2.9, 5.3), (0.02, 0.02, 0.02), (0.8, 0.5, -0.4))


def case_of(spec: Shaken) -> Case:
    """As fricmb has it, and as numbers."""
    if spec.body == "pair":
        signals = ("b0.x", "b1.x")
    elif spec.body == "modes":
        signals = ("plate.mode1", "plate.mode2", "plate.mode3")
    else:
        jointed = {"hinge": ("b.angle",), "space hinge": ("b.d1_x", "b.d1_z"), "line": ("b.x",)}
        signals = jointed.get(spec.body, ("b0.x",))
    name = f"{spec.body}-{spec.place}-{spec.input.form}"
    return Case(name=name, scene=scene(spec), problem=numbers(spec), signals=signals,
                seen=turned if spec.body == "space hinge" else None)  # fmt: skip


def turned(t: np.ndarray, q: np.ndarray, v: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """X and z of what lay along x, of a body that turns about y."""
    return np.array([np.cos(q[0]), -np.sin(q[0])]), v[0] * np.array([-np.sin(q[0]), -np.cos(q[0])])


def scene(spec: Shaken) -> Any:
    """As fricmb has it."""
    law = getattr(fm.laws, spec.law)(**LAWS[spec.law])
    value = spec.size * spec.input.given()
    load = spec.constant * HOLD + (value if spec.place == "load" else 0.0)
    if spec.body in ("line", *HINGES):
        return jointed(spec, law, load, value)
    ground = fm.Driven("ground", velocity={"x": value}) if spec.place == "ground" else fm.GROUND
    normal = N * (1 + value) if spec.place == "normal" else N
    if spec.body == "modes":
        w, ratios, shape = MODES
        plate = fm.ModalBody("plate", frequencies=w, damping_ratios=ratios, axes="x", shapes={"foot": [shape]})
        feet, parts = [plate.point("foot")], [plate]
    else:
        feet = [fm.Body(f"b{i}", mass=1.0, velocity={"x": spec.v}) for i in range(1 + (spec.body == "pair"))]
        parts = list(feet)
    if spec.place == "ground":
        parts.append(ground)
    if spec.springs[0]:
        parts.append(fm.Spring("k0", feet[0], axis="x", stiffness=spec.springs[0]))
    if spec.body == "pair":
        parts.append(fm.Spring("k1", feet[1], feet[0], axis="x", stiffness=spec.springs[1]))
    parts.append(fm.Force("f", feet[0], axis="x", value=load))
    for i, foot in enumerate(feet):
        parts.append(fm.Contact(f"c{i}", foot, ground, law=law, normal_force=normal, axes="x"))
    return fm.Scene("inputs", parts)


def jointed(spec: Shaken, law: Any, load: Any, value: Any) -> Any:
    """A body on a line or a hinge, which its weight presses; what takes some of that away is a force."""
    weight = N if spec.body == "line" else N / RADIUS
    up, spin = {"axis": "z" if spec.body == "space hinge" else "y"}, (0.0, 1.0, 0.0)
    parts: list[Any]
    if spec.body == "space hinge":
        body = fm.space.RigidBody(
            "b", mass=1.0, inertia=(1.0, 1.0, 1.0), angular_velocity=(0.0, spec.v, 0.0), points={"arm": (-ARM, 0, 0)}
        )
        hinge = fm.space.Revolute("c", body, axis=spin, radius=RADIUS, friction=law)
        parts = [body, hinge, fm.Force("f", body.point("arm"), axis="z", value=load / ARM)]
    elif spec.body == "hinge":
        body = fm.RigidBody("b", mass=1.0, inertia=1.0, angular_velocity=spec.v)
        parts = [body, fm.Revolute("c", body, radius=RADIUS, friction=law), fm.Torque("f", body, value=load)]
    else:
        body = fm.RigidBody("b", mass=1.0, inertia=0.1, velocity=(spec.v, 0.0))
        slide = value if spec.place == "ground" else 0.0
        line = fm.RollerOnLine("c", body, friction=law, slide=slide)
        parts = [body, line, fm.Force("f", body, axis="x", value=load)]
        if spec.springs[0]:
            parts.append(fm.Spring("k", body, axis="x", stiffness=spec.springs[0]))
    if spec.place == "normal":
        parts.append(fm.Force("press", body, value=-weight * value, **up))
    return fm.Scene("inputs", [*parts, fm.Gravity("g", acceleration={up["axis"]: -weight})])


def numbers(spec: Shaken) -> Problem:
    """As the oracle has it."""
    value, slope = spec.input.numeric()
    n = {"pair": 2, "modes": 3}.get(spec.body, 1)
    M, K, C = np.eye(n), np.zeros((n, n)), np.zeros((n, n))
    ways = np.eye(n)
    if spec.body == "modes":
        w, ratios = np.array(MODES[0]), np.array(MODES[1])
        K, C, ways = np.diag(w**2), np.diag(2.0 * ratios * w), np.array([MODES[2]]).T
    K = K + spec.springs[0] * np.outer(ways[:, 0], ways[:, 0])
    if spec.body == "pair":
        K = K + spec.springs[1] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    parts = parts_of(getattr(fm.laws, spec.law)(**LAWS[spec.law]), 1)
    hinge = spec.body in HINGES
    ways = RADIUS * ways if hinge else ways
    weight = N / RADIUS if hinge else N
    normal, slide, rate = (lambda t, q, v: weight), nothing, nothing
    if spec.place == "normal":
        normal = lambda t, q, v: weight * (1.0 + spec.size * value(t))  # noqa: E731
    if spec.place == "ground":
        slide = lambda t: np.array([spec.size * value(t)])  # noqa: E731
        rate = lambda t: np.array([spec.size * slope(t)])  # noqa: E731
    pushed = ways[:, 0] if not hinge else np.ones(1)
    contacts = tuple(
        Contact(
            name="c" if spec.body in ("line", *HINGES) else f"c{i}", W=ways[:, [i]], N=normal, slide=slide,
            slide_rate=rate, constant=spec.place != "normal", **parts,
        )
        for i in range(1 if spec.body != "pair" else 2)
    )  # fmt: skip

    fastest = spec.input.fastest(spec.t_end)
    longest = min(spec.t_end / 100.0, SEEN / fastest) if fastest else spec.t_end / 100.0
    breaks = tuple(b for b in spec.input.breaks() if math.isfinite(b))
    if spec.body == "space hinge":  # the force keeps its direction, and its lever shortens as the body turns
        pushes = lambda t: spec.constant * HOLD + (spec.size * value(t) if spec.place == "load" else 0.0)  # noqa: E731
        pressed = normal
        normal = lambda t, q, v: abs(pressed(t, q, v) - pushes(t) / ARM)  # noqa: E731
        return Problem(
            M=M, K=K, C=C, q=np.zeros(n), v=np.array([spec.v]), t_end=spec.t_end, breaks=breaks, max_step=longest,
            contacts=(replace(contacts[0], N=normal),), extra=lambda t, q, v: np.cos(q) * pushes(t),
        )

    def load(t: float) -> np.ndarray:
        return pushed * (spec.constant * HOLD + (spec.size * value(t) if spec.place == "load" else 0.0))

    v = np.zeros(n) if spec.body == "modes" else np.full(n, spec.v)
    return Problem(
        M=M, K=K, C=C, q=np.zeros(n), v=v, load=load, t_end=spec.t_end, contacts=contacts, breaks=breaks,
        max_step=longest,
    )  # fmt: skip
