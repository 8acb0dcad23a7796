"""Bodies on several feet: a box on two, blocks and plates on several alike; which of them hold is not determined."""

from __future__ import annotations

from typing import Any

import numpy as np

import fricmb as fm

from .drawn import Drawn, Generator, at, even, formula, limits, some, wave
from .judge import Case
from .laws import parts_of
from .problem import Contact, Problem
from .references import constant
from .spec import Pull, Spec, Touch


def feet(rng: Generator) -> Any:
    """A box on two feet, a block on several contacts, or a plate in the plane on several that share a law."""
    choice = rng.integers(4)
    if choice == 0:
        return block(rng)
    if choice == 1:
        return Drawn("feet", "plate", plate(rng))
    a = [even(rng, 0.2, 1.0), even(rng, 0.2, 1.0)]
    mu = [limits(rng, 0.2, 0.6), limits(rng, 0.2, 0.6)]
    if rng.random() < 0.3:
        a[1], mu[1] = a[0], mu[0]
    # no foot lifts: friction turns the box by less than its weight holds
    height = round(min(a) / max(m for m, _ in mu) * rng.uniform(0.0, 0.6), 4)
    mass, g = some(rng, 0.5, 2.0), some(rng, 1.0, 10.0)
    hold, t_end = mass * g * mu[0][0], even(rng, 6.0, 15.0)
    numbers = {
        "mass": mass, "g": g, "a": a, "mu": mu, "height": height, "t_end": t_end, "k": some(rng, 0.1, 5.0),
        "ramp": round(hold * rng.uniform(0.05, 0.3), 4), "wave": wave(rng, 0.3 * hold),
        "v": 0.0 if rng.random() < 0.6 else even(rng, -1.0, 1.0),
    }  # fmt: skip
    return Drawn("feet", "box", numbers)


def block(rng: Generator) -> Spec:
    """Several contacts of one block, some on a belt, and a neighbour on a spring."""
    spec = Spec("feet", 1, [some(rng, 0.5, 2.0) for _ in range(int(rng.integers(1, 3)))], even(rng, 4.0, 10.0))
    spec.belt = some(rng, 0.05, 1.0)
    grounds = [-1, -2] if rng.random() < 0.3 else [-1 if rng.random() < 0.5 else -2]
    for _ in range(int(rng.integers(2, 5))):
        mu_s, mu_k = limits(rng)
        ground = int(rng.choice(grounds))
        spec.touches.append(Touch(0, ground, "Coulomb", {"mu_s": mu_s, "mu_k": mu_k}, some(rng, 0.2, 2.0)))
    if rng.random() < 0.3:
        spec.touches = [spec.touches[0]] * len(spec.touches)
    hold = sum(t.N * t.fields["mu_s"] for t in spec.touches)
    spec.springs.append((0, -1, 0, some(rng, 0.3, 10.0)))
    if len(spec.masses) > 1:
        spec.springs.append((0, 1, 0, some(rng, 0.3, 10.0)))
    w = wave(rng, 0.7 * hold)
    spec.pulls.append(Pull(0, 0, *w))
    for _ in spec.masses:
        spec.q.append([even(rng, -1.0, 1.0)])
        spec.v.append([[0.0, spec.belt, even(rng, -1.0, 1.0)][rng.integers(3)]])
    return spec


def plate(rng: Generator) -> dict[str, Any]:
    """Numbers of a plate."""
    mu = limits(rng)
    return {
        "mass": some(rng, 0.5, 2.0), "mu": mu, "N": [some(rng, 0.2, 1.0) for _ in range(int(rng.integers(2, 5)))],
        "k": [some(rng, 0.3, 10.0), some(rng, 0.3, 10.0)], "waves": [wave(rng, 1.0), wave(rng, 1.0)],
        "belt": 0.0 if rng.random() < 0.5 else some(rng, 0.05, 1.0), "t_end": even(rng, 3.0, 8.0),
        "q": [even(rng, -1.0, 1.0), even(rng, -1.0, 1.0)],
        "v": [0.0, 0.0] if rng.random() < 0.4 else [even(rng, -1.0, 1.0), even(rng, -1.0, 1.0)],
    }  # fmt: skip


def box_case(n: dict[str, Any]) -> Case:
    """A box that slides on two feet below its centre of mass, which two supports hold upright."""
    m, g, (a, b), h, k = n["mass"], n["g"], n["a"], n["height"], n["k"]
    laws = [fm.laws.Coulomb(mu_s=s, mu_k=c) for s, c in n["mu"]]
    feet = {"left": (-a, -h), "right": (b, -h)}
    body = fm.RigidBody("b", mass=m, inertia=0.1, position=(0.0, h), velocity=(n["v"], 0.0), points=feet)
    pull = n["ramp"] * fm.t + formula(n["wave"], fm.t)
    parts = [
        body, fm.Gravity("g", acceleration={"y": -g}), fm.Force("f", body, axis="x", value=pull),
        fm.Spring("k", body, axis="x", stiffness=k),
        *(fm.RollerOnLine(f"c{i}", body.point(p), friction=laws[i]) for i, p in enumerate(feet)),
    ]  # fmt: skip

    def given(t: float, q: np.ndarray) -> float:
        return float(n["ramp"] * t + at(n["wave"], t) - k * q[0])

    def load(side: int) -> Any:
        # moments about the centre of mass: b N2 - a N1 + h (friction of both) = 0
        def N(t: float, q: np.ndarray, v: np.ndarray, acceleration: np.ndarray) -> float:
            turn = h * (m * acceleration[0] - given(t, q))
            return abs((b * m * g + turn if side == 0 else a * m * g - turn) / (a + b))

        return N

    contacts = tuple(
        Contact(name=f"c{i}", W=np.ones((1, 1)), N=constant(np.nan), reaction=load(i), mu=constant(c), mu_s=constant(s))
        for i, (s, c) in enumerate(n["mu"])
    )
    one = np.ones((1, 1))
    problem = Problem(
        M=m * one, K=0.0 * one, C=0.0 * one, q=np.zeros(1), v=np.array([n["v"]]), t_end=n["t_end"], contacts=contacts,
        extra=lambda t, q, v: np.array([given(t, q)]),
    )  # fmt: skip
    return Case(name="box", scene=fm.Scene("box", parts), problem=problem, signals=("b.x",))


def plate_case(n: dict[str, Any]) -> Case:
    """A plate that does not turn on contacts of one law: for the oracle one contact under all of their load."""
    mu_s, mu_k = n["mu"]
    law = fm.laws.Coulomb(mu_s=mu_s, mu_k=mu_k)
    body = fm.Body(
        "b", mass=n["mass"], axes="xy", position=dict(zip("xy", n["q"], strict=True)),
        velocity=dict(zip("xy", n["v"], strict=True)),
    )  # fmt: skip
    belt = fm.Driven("belt", velocity={"x": n["belt"]})
    parts = [body, belt]
    for axis, k, w in zip("xy", n["k"], n["waves"], strict=True):
        parts.append(fm.Spring(f"k{axis}", body, axis=axis, stiffness=k))
        parts.append(fm.Force(f"f{axis}", body, axis=axis, value=formula(w, fm.t)))
    names = tuple(f"c{i}" for i in range(len(n["N"])))
    parts += [
        fm.Contact(name, body, belt, law=law, normal_force=N, axes="xy") for name, N in zip(names, n["N"], strict=True)
    ]
    slide = np.array([n["belt"], 0.0])
    one = Contact(name="all", W=np.eye(2), N=constant(sum(n["N"])), slide=lambda t: slide, **parts_of(law, 2))
    problem = Problem(
        M=n["mass"] * np.eye(2), K=np.diag(n["k"]), C=np.zeros((2, 2)), q=np.array(n["q"]), v=np.array(n["v"]),
        load=lambda t: np.array([at(w, t) for w in n["waves"]]), t_end=n["t_end"], contacts=(one,),
    )  # fmt: skip
    return Case(
        name="plate", scene=fm.Scene("plate", parts), problem=problem, signals=("b.x", "b.y"), alike={"all": names}
    )


MAKERS = {"box": box_case, "plate": plate_case}
