"""Scenes in other units, or beside idle bodies of other scales: digits and transitions have to be the same."""

from __future__ import annotations

import math
from copy import deepcopy
from dataclasses import replace
from typing import Any

import fricmb as fm

from . import mechanisms, spec
from .drawn import Drawn, Generator, even, some
from .judge import Case
from .mechanisms import GRAVITY, Chain
from .spec import Spec

#: Fields of laws by the power of the speed that they are of.
SPEEDS = {"v_s": 1, "delta": -1, "viscous": -1}


def power(rng: Generator, low: int, high: int) -> float:
    """Ten to a whole number between."""
    return float(f"1e{int(rng.integers(low, high + 1))}")


def drawn(rng: Generator, kind: str, bases: dict[str, Any]) -> tuple[str, Any]:
    """A scene of another kind."""
    name = list(bases)[rng.integers(len(bases))]
    return name, bases[name](rng).data()


def units(rng: Generator, bases: dict[str, Any]) -> Drawn:
    """One whose units of length, time and mass are others."""
    of, data = drawn(rng, "units", bases)
    scales = {"length": power(rng, -9, 9), "time": power(rng, -6, 6), "mass": power(rng, -9, 15)}
    return Drawn("units", "units", {"of": of, "data": data, **scales})


def beside(rng: Generator, bases: dict[str, Any]) -> Drawn:
    """One with idle bodies beside: rotors, pendulums and blocks on springs of other scales."""
    of, data = drawn(rng, "beside", bases)
    idle = [
        {"kind": ("rotor", "pendulum", "block", "mover")[rng.integers(4)], "length": power(rng, -6, 6),
         "rate": some(rng, 1e-4, 1e4), "mass": power(rng, -9, 9), "angle": even(rng, -1.0, 1.0)}
        for _ in range(int(rng.integers(1, 4)))
    ]  # fmt: skip
    return Drawn("beside", "beside", {"of": of, "data": data, "idle": idle})


def plain(of: str, data: dict[str, Any]) -> Any:
    """The scene that was drawn, as its own kind has it."""
    return Chain(**data) if of == "chain" else spec.from_data(data)


def units_case(n: dict[str, Any]) -> Case:
    """The oracle goes by the units in which the scene was drawn."""
    made = plain(n["of"], n["data"])
    L, T, m = n["length"], n["time"], n["mass"]
    if isinstance(made, Chain):
        case = mechanisms.case_of(made)
        return replace(case, name="units", scene=mechanisms.scene(scaled_chain(made, L, T, m), GRAVITY * L / T**2),
                       time=T)  # fmt: skip
    case = spec.case_of(made)
    own = L * math.sqrt(m) if made.frequencies else L  # coordinates of modes are lengths by roots of masses
    return replace(case, name="units", scene=spec.scene(scaled(made, L, T, m)), length=own, time=T)


def scaled(made: Spec, L: float, T: float, m: float) -> Spec:
    """Blocks or modes in other units; the coordinate of a mode is a length times the root of a mass."""
    other, force = deepcopy(made), m * L / T**2
    # masses of modes stay 1: shapes are lengths over their coordinate
    modal = bool(made.frequencies)
    own = L * math.sqrt(m) if modal else L
    other.masses = [m * x for x in made.masses]
    other.t_end = T * made.t_end
    other.springs = [(a, b, axis, k * m / T**2) for a, b, axis, k in made.springs]
    other.dampers = [(a, b, axis, c * m / T) for a, b, axis, c in made.dampers]
    for pull in other.pulls:
        pull.constant, pull.amplitude, pull.omega = force * pull.constant, force * pull.amplitude, pull.omega / T
        pull.since, pull.bell = T * pull.since, T * pull.bell
        pull.phase = T * pull.phase if pull.bell else pull.phase
    for touch in other.touches:
        touch.N, touch.omega, touch.slope = force * touch.N, touch.omega / T, touch.slope / L
        touch.fields = {key: x * (L / T) ** SPEEDS.get(key, 0) for key, x in touch.fields.items()}
    other.belt, other.belt_later = L / T * made.belt, L / T * made.belt_later
    other.belt_change = T * made.belt_change
    if made.across:
        other.across = [L / T * made.across[0], L / T * made.across[1], made.across[2] / T]
    other.q = [[own * x for x in row] for row in made.q]
    other.v = [[own / T * x for x in row] for row in made.v]
    other.frequencies = [w / T for w in made.frequencies]
    other.shapes = [[L / own * x for x in row] for row in made.shapes]
    return other


def scaled_chain(made: Chain, L: float, T: float, m: float) -> Chain:
    """Links in other units."""
    return replace(
        made, masses=[m * x for x in made.masses], inertias=[m * L**2 * x for x in made.inertias],
        lengths=[L * x for x in made.lengths], rates=[x / T for x in made.rates], radii=[L * x for x in made.radii],
        t_end=T * made.t_end, torque=m * L**2 / T**2 * made.torque, omega=made.omega / T,
    )  # fmt: skip


def beside_case(n: dict[str, Any]) -> Case:
    """The oracle knows nothing of what is idle."""
    made = plain(n["of"], n["data"])
    case = mechanisms.case_of(made) if isinstance(made, Chain) else spec.case_of(made)
    parts = list(case.scene.parts)
    heavy = isinstance(made, Chain)
    for i, idle in enumerate(n["idle"]):
        parts += idle_parts(f"idle{i}", idle, heavy)
    return replace(case, name="beside", scene=fm.Scene("beside", parts))


def idle_parts(name: str, n: dict[str, Any], heavy: bool) -> list[Any]:
    """A rotor, a pendulum, a block on a spring, or one that goes on and on; its rates are those of its scale."""
    L, m, rate, angle = n["length"], n["mass"], n["rate"], n["angle"]
    if n["kind"] == "rotor":
        body = fm.RigidBody(name, mass=m, inertia=m * L**2, angular_velocity=rate)
        return [body, fm.Revolute(f"{name}_pin", body)]
    if n["kind"] == "pendulum":
        s, c = math.sin(angle), math.cos(angle)
        if heavy:  # in the gravity of the scene
            L = max(L, 1e-2)
        body = fm.RigidBody(
            name, mass=m, inertia=0.1 * m * L**2, angle=angle, position=(L * s, -L * c), points={"top": (0.0, L)}
        )
        pin = fm.Revolute(f"{name}_pin", body.point("top"))
        if heavy:
            return [body, pin]
        slow = min(rate, 10.0)
        return [body, pin, fm.TorsionSpring(f"{name}_k", body, stiffness=m * L**2 * slow**2)]
    if n["kind"] == "block":
        slow = min(rate, 10.0)
        body = fm.Body(name, mass=m, position={"x": L * angle})
        return [body, fm.Spring(f"{name}_k", body, axis="x", stiffness=m * slow**2)]
    return [fm.Body(name, mass=m, velocity={"x": L * angle})]


MAKERS = {"units": units_case, "beside": beside_case}
