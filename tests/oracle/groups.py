"""Blocks that let go at one instant, blocks without friction, forces that jump where another body passes a place."""

from __future__ import annotations

import itertools
import math
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .drawn import Drawn, Generator, even, limits, some
from .judge import Case
from .problem import Problem
from .spec import Pull, Spec, Touch, from_data, numbers, scene, signals


def together(rng: Generator) -> Spec:
    """Equal blocks under equal loads, tied by springs that stay as they are; one in three times a pair rubs."""
    n = int(rng.integers(2, 6))
    mass, k, N = some(rng, 0.5, 2.0), some(rng, 0.3, 10.0), some(rng, 0.3, 3.0)
    mu_s, mu_k = limits(rng)
    spec = Spec("together", 1, [mass] * n, even(rng, 4.0, 8.0))
    spec.belt = some(rng, 0.05, 1.0)
    ground, mirror = -1 if rng.random() < 0.5 else -2, bool(rng.random() < 0.3)
    hold = N * mu_s
    load = (
        even(rng, -0.3, 0.3), round(hold * rng.uniform(0.8, 2.0), 4), some(rng, 0.3, 20.0), even(rng, 0.0, 6.28),
        even(rng, 0.5, 2.0) if rng.random() < 0.3 else 0.0,
    )  # fmt: skip
    for i in range(n):
        sign = -1.0 if mirror and i % 2 and ground == -1 else 1.0
        spec.touches.append(Touch(i, ground, "Coulomb", {"mu_s": mu_s, "mu_k": mu_k}, N))
        spec.pulls.append(Pull(i, 0, sign * load[0], sign * load[1], *load[2:]))
        spec.springs.append((i, -1, 0, k))
        if i:
            spec.springs.append((i - 1, i, 0, some(rng, 0.3, 10.0)))
        spec.q.append([0.0])
        spec.v.append([spec.belt if ground == -2 else 0.0])
    if rng.random() < 0.3 and not mirror:
        a, b = limits(rng)
        spec.touches.append(Touch(1, 0, "Coulomb", {"mu_s": a, "mu_k": b}, some(rng, 0.1, 1.0)))
    return spec


def bare(rng: Generator) -> Spec:
    """A line of blocks of which some contacts have no friction, or next to none."""
    n = int(rng.integers(1, 5))
    spec = Spec("bare", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 4.0, 8.0))
    spec.belt = some(rng, 0.05, 1.0)
    for i in range(n):
        choice = rng.random()
        mu_k = 0.0 if choice < 0.4 else float(f"{10.0 ** rng.uniform(-14.0, -2.0):.1e}") if choice < 0.7 else 0.4
        mu_s = mu_k if rng.random() < 0.5 else 1.5 * mu_k
        ground = int(rng.choice([-1, -2] if i == 0 else [-1, -2, i - 1]))
        spec.touches.append(Touch(i, ground, "Coulomb", {"mu_s": mu_s, "mu_k": mu_k}, some(rng, 0.3, 3.0)))
        if i == 0 or rng.random() < 0.7:
            spec.springs.append((i, -1 if i == 0 or rng.random() < 0.5 else i - 1, 0, some(rng, 0.3, 10.0)))
        if rng.random() < 0.6:
            spec.pulls.append(Pull(
                i, 0, even(rng, -1.0, 1.0), even(rng, 0.0, 2.0), some(rng, 0.3, 6.0), even(rng, 0.0, 6.28)
            ))  # fmt: skip
        spec.q.append([even(rng, -1.0, 1.0)])
        spec.v.append([(0.0, spec.belt, even(rng, -1.0, 1.0))[rng.integers(3)]])
    return spec


def elsewhere(rng: Generator) -> Drawn:
    """Blocks with friction, pushed by a force that jumps where a free oscillator passes a place or turns round."""
    n = int(rng.integers(1, 4))
    spec = Spec("elsewhere", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 4.0, 10.0))
    spec.belt = some(rng, 0.05, 1.0)
    for i in range(n):
        mu_s, mu_k = limits(rng)
        ground = -1 if rng.random() < 0.6 else -2
        spec.touches.append(Touch(i, ground, "Coulomb", {"mu_s": mu_s, "mu_k": mu_k}, some(rng, 0.3, 2.0)))
        spec.springs.append((i, -1 if i == 0 else i - 1, 0, some(rng, 0.3, 10.0)))
        spec.q.append([0.0 if rng.random() < 0.5 else even(rng, -0.5, 0.5)])
        spec.v.append([0.0 if rng.random() < 0.6 else even(rng, -1.0, 1.0)])
    hold = spec.touches[0].N * spec.touches[0].fields["mu_s"]
    return Drawn("elsewhere", "elsewhere", {
        "spec": spec.data(), "form": ("sign", "step", "pieces", "rate")[rng.integers(4)],
        "omega": some(rng, 1.0, 20.0), "phase": even(rng, 0.0, 6.28), "reach": some(rng, 1e-3, 10.0),
        "place": even(rng, -0.8, 0.8), "mass": some(rng, 0.1, 10.0), "size": round(hold * rng.uniform(0.5, 2.5), 4),
    })  # fmt: skip


def elsewhere_case(n: dict[str, Any]) -> Case:
    """The oscillator moves as ``reach cos(omega t + phase)``, so that the jumps are known."""
    spec = from_data(n["spec"])
    reach, omega, phase, place = n["reach"], n["omega"], n["phase"], n["place"] * n["reach"]
    own = scene(spec)
    block = next(part for part in own.parts if part.name == "b0")
    far = fm.Body(
        "far", mass=n["mass"], position={"x": reach * math.cos(phase)},
        velocity={"x": -reach * omega * math.sin(phase)},
    )  # fmt: skip
    x, rate = fm.coordinate("far.x"), fm.speed("far.x")
    value = {
        "sign": sympy.sign(x - place), "step": sympy.Heaviside(x - place),
        "pieces": sympy.Piecewise((1, x > place), (sympy.Rational(-1, 2), True)), "rate": sympy.sign(rate),
    }[n["form"]]  # fmt: skip
    parts = [
        far, fm.Spring("swing", far, axis="x", stiffness=n["mass"] * omega**2),
        fm.Force("jump", block, axis="x", value=n["size"] * value),
    ]  # fmt: skip
    high, low = {"sign": (1.0, -1.0), "step": (1.0, 0.0), "pieces": (1.0, -0.5), "rate": (1.0, -1.0)}[n["form"]]
    # where the cosine is above the place, or the sine below 0
    angle = math.acos(n["place"]) if n["form"] != "rate" else 0.0
    p = numbers(spec)

    def above(t: float) -> bool:
        if n["form"] == "rate":
            return (omega * t + phase) % (2 * math.pi) >= math.pi
        turned = (omega * t + phase) % (2 * math.pi)
        return turned < angle or turned >= 2 * math.pi - angle

    edges = (math.pi, 2 * math.pi) if n["form"] == "rate" else (angle, 2 * math.pi - angle)
    turns = int((omega * p.t_end + phase) / (2 * math.pi)) + 2
    breaks = [(edge + 2 * math.pi * k - phase) / omega for k in range(turns) for edge in edges]
    breaks = sorted(b for b in breaks if 0.0 < b < p.t_end)
    between = np.array([0.0, *breaks, p.t_end])
    values = [high if above(0.5 * (a + b)) else low for a, b in itertools.pairwise(between)]
    W = np.eye(len(spec.masses))[0]

    def load(t: float) -> np.ndarray:
        k = min(max(int(np.searchsorted(between, t, side="right")) - 1, 0), len(values) - 1)
        return p.load(t) + n["size"] * values[k] * W

    problem = Problem(
        M=p.M, C=p.C, K=p.K, q=p.q, v=p.v, contacts=p.contacts, t_end=p.t_end, load=load,
        breaks=(*p.breaks, *breaks), max_step=p.max_step,
    )  # fmt: skip
    return Case(name="elsewhere", scene=fm.Scene("elsewhere", [*own.parts, *parts]), problem=problem,
                signals=signals(spec))  # fmt: skip


MAKERS = {"elsewhere": elsewhere_case}
