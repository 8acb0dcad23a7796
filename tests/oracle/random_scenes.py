"""Scenes from seeds: lines, planes, stacks, loops, bodies of modes, chains of links, bodies in space."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from .drawn import Drawn, Generator, even, some
from .driven import driven
from .drives import drives
from .feet import feet
from .groups import bare, elsewhere, together
from .impacts import carried, impacts, poisson
from .inputs import excursion as excursions
from .inputs import shaken as inputs
from .machines import machines
from .mechanisms import Chain
from .space import Bodies, Link, Push, Triple, turned
from .spec import Pull, Spec, Touch
from .units import beside, units


def law(rng: Generator) -> tuple[str, dict[str, float]]:
    """A set-valued law: most with more friction at rest, some with as much in slip."""
    mu_k = even(rng, 0.3, 0.8)
    mu_s = round(mu_k * (1.0 if rng.random() < 0.3 else rng.uniform(1.05, 1.8)), 4)
    choice = rng.integers(6)
    if choice < 3:
        return "Coulomb", {"mu_s": mu_s, "mu_k": mu_k}
    if choice == 3:
        return "Stribeck", {"mu_s": round(1.3 * mu_k, 4), "mu_k": mu_k, "v_s": some(rng, 0.03, 0.5)}
    if choice == 4:
        return "HyperbolicStribeck", {"mu_s": mu_s, "mu_k": round(0.3 * mu_k, 4), "delta": some(rng, 0.5, 5.0)}
    return "CoulombViscous", {"mu_s": mu_s, "mu_k": mu_k, "viscous": even(rng, 0.01, 0.2)}


def touch(rng: Generator, a: int, b: int, vary: bool = True) -> Touch:
    """A contact."""
    name, fields = law(rng)
    found = Touch(a, b, name, fields, some(rng, 0.3, 3.0))
    if vary and rng.random() < 0.2:
        found.swing, found.omega = even(rng, 0.1, 0.6), some(rng, 0.3, 3.0)
    elif vary and rng.random() < 0.1:
        found.slope = even(rng, -0.2, 0.2)
    return found


def pull(rng: Generator, body: int, axis: int, t_end: float) -> Pull:
    """A load; one in four begins later, with a jump."""
    since = even(rng, 0.2, 0.8 * t_end) if rng.random() < 0.25 else 0.0
    return Pull(
        body, axis, even(rng, -1.0, 1.0), even(rng, 0.0, 2.0), some(rng, 0.3, 6.0), even(rng, 0.0, 6.28), since
    )


def belt(rng: Generator, spec: Spec) -> None:
    """A speed, and one in five times another later."""
    spec.belt = some(rng, 0.05, 1.0)
    if rng.random() < 0.2:
        spec.belt_change, spec.belt_later = even(rng, 0.2, 0.8 * spec.t_end), even(rng, -0.5, 1.0)


def starts(rng: Generator, spec: Spec) -> None:
    """At rest, with the belt, or moving; at a place of its own."""
    for _ in spec.masses:
        spec.q.append([even(rng, -1.0, 1.0) for _ in range(spec.d)])
        way = rng.integers(3)
        along = [spec.belt, 0.0][: spec.d]
        moving = [even(rng, -1.0, 1.0) for _ in range(spec.d)]
        spec.v.append(([0.0] * spec.d, along, moving)[way])


def line(rng: Generator) -> Spec:
    """Blocks in a row, springs between and to the ground, each on the ground or on the belt or free."""
    n = int(rng.integers(1, 6))
    spec = Spec("line", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 4.0, 10.0))
    belt(rng, spec)
    for i in range(n):
        if i:
            spec.springs.append((i - 1, i, 0, some(rng, 0.3, 30.0)))
        if rng.random() < 0.6:
            spec.springs.append((i, -1, 0, some(rng, 0.3, 10.0)))
        if rng.random() < 0.5:
            spec.dampers.append((i, -1, 0, some(rng, 0.01, 0.5)))
        if rng.random() < 0.5:
            spec.pulls.append(pull(rng, i, 0, spec.t_end))
        if i == 0 or rng.random() < 0.8:
            spec.touches.append(touch(rng, i, -2 if rng.random() < 0.5 else -1))
    starts(rng, spec)
    return spec


def shaken(rng: Generator) -> Spec:
    """Blocks whose loads, normal forces or belts move faster than they do: near the cone, in slip, in bells."""
    n = int(rng.integers(1, 4))
    spec = Spec("shaken", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 10.0, 25.0))
    spec.belt = some(rng, 0.05, 1.0)
    for i in range(n):
        if i:
            spec.springs.append((i - 1, i, 0, some(rng, 0.3, 10.0)))
        spec.touches.append(touch(rng, i, -2 if rng.random() < 0.4 else -1, vary=False))
        hold = spec.touches[i].N * spec.touches[i].fields["mu_s"]
        choice = rng.integers(4)
        if choice == 0:  # crests just over the cone and just below it
            share = even(rng, 0.3, 0.8)
            over = even(rng, -0.02, 0.1)
            load = round(share * hold, 4), round((1.0 - share + over) * hold, 4)
            spec.pulls.append(Pull(i, 0, *load, some(rng, 20.0, 80.0), even(rng, 0.0, 6.28)))
        elif choice == 1:  # the same of the normal force
            spec.touches[i].swing, spec.touches[i].omega = even(rng, 0.1, 0.6), some(rng, 20.0, 80.0)
            spec.pulls.append(Pull(i, 0, round(even(rng, 0.4, 0.95) * hold, 4), 0.0, 1.0, 0.0))
        elif choice == 2:
            width = some(rng, 1e-4, 1e-2)
            at = even(rng, 0.2 * spec.t_end, 0.8 * spec.t_end)
            push = round(hold * (1.0 + some(rng, 0.1, 1.0) / width), 2)
            spec.pulls.append(Pull(i, 0, 0.0, push, 1.0, at, 0.0, width))
    if rng.random() < 0.3:
        steady = some(rng, 0.2, 1.0)
        spec.across = [steady, round(0.9 * steady, 4), some(rng, 20.0, 80.0)]
    starts(rng, spec)
    return spec


def guided(rng: Generator) -> Spec:
    """Blocks in guides along x, some of them on a belt that moves across the guides as well."""
    spec = line(rng)
    spec.kind = "guided"
    size = some(rng, 0.05, 1.0)
    spec.across = [size, round_to(size * rng.uniform(0.0, 0.9)), some(rng, 0.3, 6.0)]
    spec.touches[0].b = -2
    return spec


def plane(rng: Generator) -> Spec:
    """One or two blocks on a plane."""
    n = int(rng.integers(1, 3))
    spec = Spec("plane", 2, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 3.0, 8.0))
    belt(rng, spec)
    for i in range(n):
        for axis in (0, 1):
            spec.springs.append((i, -1 if i == 0 else i - 1, axis, some(rng, 0.3, 10.0)))
            if rng.random() < 0.5:
                spec.pulls.append(pull(rng, i, axis, spec.t_end))
        if i == 0 or rng.random() < 0.5:
            spec.touches.append(touch(rng, i, -2 if rng.random() < 0.5 else -1))
    starts(rng, spec)
    return spec


def stack(rng: Generator) -> Spec:
    """Plates on each other, the lowest on the ground or the belt."""
    n = int(rng.integers(2, 5))
    spec = Spec("stack", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 4.0, 8.0))
    belt(rng, spec)
    for i in range(n):
        spec.touches.append(touch(rng, i, i - 1 if i else (-2 if rng.random() < 0.5 else -1)))
        if rng.random() < 0.6:
            spec.springs.append((i, -1, 0, some(rng, 0.3, 10.0)))
        if rng.random() < 0.6:
            spec.pulls.append(pull(rng, i, 0, spec.t_end))
    starts(rng, spec)
    return spec


def loop(rng: Generator) -> Spec:
    """Blocks on the ground or the belt that rub on each other as well: forces in stick are not determined."""
    n = int(rng.integers(2, 4))
    spec = Spec("loop", 1, [some(rng, 0.5, 2.0) for _ in range(n)], even(rng, 4.0, 8.0))
    belt(rng, spec)
    for i in range(n):
        spec.touches.append(touch(rng, i, -2 if i and rng.random() < 0.3 else -1, vary=False))
        if i:
            spec.touches.append(touch(rng, i, i - 1, vary=False))
        if rng.random() < 0.6:
            spec.springs.append((i, -1, 0, some(rng, 0.3, 10.0)))
        if rng.random() < 0.7:
            spec.pulls.append(pull(rng, i, 0, spec.t_end))
    starts(rng, spec)
    return spec


def modes(rng: Generator) -> Spec:
    """A body of modes with one or two points on the ground or the belt."""
    n, points = int(rng.integers(2, 6)), int(rng.integers(1, 3))
    d = 1 if rng.random() < 0.7 else 2
    points = 1 if d == 2 else points
    spec = Spec("modes", d, [], even(rng, 3.0, 8.0))
    belt(rng, spec)
    spec.frequencies = [0.0 if i == 0 and rng.random() < 0.3 else some(rng, 0.5, 8.0) for i in range(n)]
    spec.ratios = [some(rng, 1e-3, 0.1) for _ in range(n)]
    spec.shapes = [[even(rng, -1.0, 1.0) for _ in range(n * d)] for _ in range(points + 1)]
    spec.q, spec.v = [[even(rng, -0.5, 0.5) for _ in range(n)]], [[even(rng, -0.5, 0.5) for _ in range(n)]]
    for i in range(points):
        spec.touches.append(touch(rng, i, -2 if rng.random() < 0.7 else -1))
        spec.touches[-1].slope = 0.0
    spec.pulls.append(pull(rng, points, 0, spec.t_end))
    return spec


def chain(rng: Generator) -> Chain:
    """One to three links that hang on dry pins, swinging or at rest, some driven."""
    n = int(rng.integers(1, 4))
    mu_k = [even(rng, 0.1, 0.6) for _ in range(n)]
    still = rng.random() < 0.3
    return Chain(
        "chain", [some(rng, 0.5, 2.0) for _ in range(n)], [some(rng, 0.02, 0.2) for _ in range(n)],
        [some(rng, 0.4, 1.0) for _ in range(n)], [even(rng, -1.5, 1.5) for _ in range(n)],
        [0.0 if still else even(rng, -2.0, 2.0) for _ in range(n)], [even(rng, 0.01, 0.06) for _ in range(n)],
        [round(mu * (1.0 if rng.random() < 0.5 else 1.3), 4) for mu in mu_k], mu_k, even(rng, 1.5, 4.0),
        even(rng, 0.2, 1.0) if rng.random() < 0.4 else 0.0, some(rng, 1.0, 6.0),
    )  # fmt: skip


def triple(rng: Generator, size: float) -> Triple:
    """Three numbers of either sign."""
    return (even(rng, -size, size), even(rng, -size, size), even(rng, -size, size))


def box(rng: Generator, mass: float, *, round: bool) -> Triple:
    """Moments of inertia of a box, or of one with a square base."""
    a, b, c = (some(rng, 0.3, 1.0) for _ in range(3))
    b = a if round else b
    return tuple(round_to(mass / 12.0 * x) for x in (b * b + c * c, a * a + c * c, a * a + b * b))  # type: ignore[return-value]


def round_to(x: float) -> float:
    """Four digits."""
    return float(f"{x:.4g}")


def hanging(rng: Generator, before: Link | None, *, round: bool) -> Link:
    """A body on a ball joint, on a hinge, in a sleeve or in a guide, most of them dry."""
    mass = some(rng, 0.5, 2.0)
    joint = str(rng.choice(["spherical", "revolute", "cylindrical", "prismatic"], p=[0.4, 0.2, 0.2, 0.2]))
    if (before is not None and before.round) or (joint == "prismatic" and round):
        joint = "spherical"
    link = Link(joint, mass, box(rng, mass, round=round), [], [], round)
    link.own = (0.0, 0.0, some(rng, 0.3, 0.8)) if round else triple(rng, 0.5)
    if before is not None:
        link.there = (0.0, 0.0, round_to(-0.8 * before.own[2])) if before.round else triple(rng, 0.4)
    link.start = list(triple(rng, 0.7))
    if joint == "prismatic":
        x, y, z = turned(link).T[:, 2]
        link.axis = (float(x), float(y), float(z))
    elif joint != "spherical" and not round:
        axis = rng.normal(size=3)
        x, y, z = (float(c) for c in axis / np.linalg.norm(axis))
        link.axis = (x, y, z)
    speed = 0.0 if rng.random() < 0.3 else 3.0
    link.rates = list(triple(rng, speed))[: {"spherical": 3, "cylindrical": 2}.get(joint, 1)]
    if round and joint == "spherical" and rng.random() < 0.5:
        link.rates = [round_to(x) for x in np.array(link.rates) + turned(link)[:, 2] * even(rng, -25.0, 25.0)]
    if before is None or rng.random() < 0.8:
        link.law, link.fields = law(rng)
        link.radius = some(rng, 0.05, 0.4)
        if joint != "spherical":
            link.length = some(rng, 0.1, 0.5) if rng.random() < 0.7 else 0.0
        if joint == "revolute":
            link.thrust = some(rng, 0.03, 0.2) if rng.random() < 0.5 else 0.0
        if joint == "prismatic":
            link.width = some(rng, 0.1, 0.5) if rng.random() < 0.7 else 0.0
    return link


def tree(rng: Generator) -> Bodies:
    """One or two bodies in space that hang on dry joints."""
    spec = Bodies("tree", [], even(rng, 0.8, 2.0))
    for _ in range(int(rng.integers(1, 3))):
        before = spec.links[-1] if spec.links else None
        spec.links.append(hanging(rng, before, round=bool(rng.random() < 0.35)))
    disturbed(rng, spec)
    return spec


def disturbed(rng: Generator, spec: Bodies) -> None:
    """Springs, dampers and forces on centres of mass, a torque on the last."""
    for i, link in enumerate(spec.links):
        axes = (0, 1) if link.on_floor else (0, 1, 2)
        for _ in range(2 if link.joint in ("ball", "cylindrical", "prismatic") else rng.integers(2)):
            spec.springs.append((i, int(rng.choice(axes)), some(rng, 3.0, 60.0), even(rng, 0.0, 0.5)))
        if rng.random() < 0.4:
            shape = even(rng, -2.0, 2.0), even(rng, 0.0, 4.0), some(rng, 1.0, 8.0), even(rng, 0.0, 6.28)
            spec.pushes.append(Push(i, int(rng.choice(axes)), *shape))
    if rng.random() < 0.2:
        spec.torque = triple(rng, 1.0)


def roller(rng: Generator) -> Bodies:
    """A ball, a coin or a top on a floor, sliding at first; on one in four hangs another body."""
    mass, joint = some(rng, 0.5, 2.0), ("ball", "edge", "tip")[int(rng.integers(3))]
    radius = some(rng, 0.2, 0.6) if joint != "tip" else some(rng, 0.02, 0.1)
    m = mass * radius**2
    link = Link(joint, mass, (0.4 * m, 0.4 * m, 0.4 * m), [], [])
    link.radius, link.round = radius, joint != "ball"
    link.start = [*triple(rng, 1.0), even(rng, 0.7, 1.4), 0.0]
    link.rates = [even(rng, -most, most) for most in (1.5, 1.5, 1.0, 0.5, 4.0)]
    if joint == "edge":
        link.inertia = (0.25 * m, 0.25 * m, 0.5 * m)
    elif joint == "tip":
        link.reach, link.start[3] = some(rng, 0.1, 0.4), even(rng, 0.2, 1.0)
        link.inertia = box(rng, mass, round=True)
        link.rates[4] = even(rng, 20.0, 60.0)
    link.law, link.fields = law(rng)
    spec = Bodies("roller", [link], even(rng, 0.5, 1.5))
    if joint != "ball" and rng.random() < 0.25:
        spec.links.append(hanging(rng, link, round=bool(rng.random() < 0.5)))
        spec.links[1].there = (0.0, 0.0, even(rng, -0.2, 0.2))
    disturbed(rng, spec)
    return spec


def other_units(rng: Generator) -> Drawn:
    """A scene whose units are others."""
    return units(rng, {"line": line, "plane": plane, "stack": stack, "modes": modes, "chain": chain, "shaken": shaken})


def other_scales(rng: Generator) -> Drawn:
    """A scene beside idle bodies."""
    return beside(rng, {"line": line, "plane": plane, "stack": stack, "chain": chain, "shaken": shaken, "loop": loop})


KINDS: dict[str, Callable[[Generator], Any]] = {
    "line": line, "shaken": shaken, "guided": guided, "plane": plane, "stack": stack, "loop": loop, "modes": modes,
    "chain": chain, "tree": tree, "roller": roller, "inputs": inputs, "excursions": excursions, "feet": feet,
    "driven": driven, "drives": drives, "together": together, "bare": bare, "elsewhere": elsewhere,
    "units": other_units, "beside": other_scales, "impacts": impacts, "poisson": poisson, "carried": carried,
    "machines": machines,
}  # fmt: skip


def generate(kind: str, seed: int) -> Any:
    """The scene of that seed."""
    return KINDS[kind](np.random.default_rng([seed, *kind.encode()]))
