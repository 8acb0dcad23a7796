"""A scene of blocks or modes as plain data, from which both fricmb's scene and the oracle's numbers are made."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .judge import Case
from .laws import parts_of
from .problem import Contact, Problem, nothing

AXES = "xy"
Vector = tuple[float, ...]
#: A coefficient that stands for none.
NOTHING = 1e-8
#: Part of the inverse of a frequency that a step takes at most; where within a bell steps begin anew, in widths.
SEEN, WITHIN = 0.25, (-6.0, -4.0, -2.0, -1.0, 0.0, 1.0, 2.0, 4.0, 6.0)


@dataclass
class Pull:
    """A force on a body: constant + amplitude sin(omega t + phase), from ``since`` on.

    With a ``bell`` the amplitude times exp(-((t - phase)/bell)^2) stands in place of the sine.
    """

    body: int
    axis: int
    constant: float
    amplitude: float
    omega: float
    phase: float
    since: float = 0.0
    bell: float = 0.0

    def value(self, t: float) -> float:
        """At a time from ``since`` on."""
        if self.bell:
            return self.constant + self.amplitude * math.exp(-(((t - self.phase) / self.bell) ** 2))
        return self.constant + self.amplitude * math.sin(self.omega * t + self.phase)


@dataclass
class Touch:
    """A contact of body ``a`` with body ``b`` (-1: the ground, -2: the belt)."""

    a: int
    b: int
    law: str
    fields: dict[str, float]
    N: float
    swing: float = 0.0
    omega: float = 1.0
    slope: float = 0.0
    """N (1 + swing sin(omega t) + slope x) with x the first coordinate of a."""


@dataclass
class Spec:
    """Blocks along d directions, or one body of modes (``shapes``: one row of modes for each point)."""

    kind: str
    d: int
    masses: list[float]
    t_end: float
    springs: list[tuple[int, int, int, float]] = field(default_factory=list)
    dampers: list[tuple[int, int, int, float]] = field(default_factory=list)
    pulls: list[Pull] = field(default_factory=list)
    touches: list[Touch] = field(default_factory=list)
    belt: float = 0.0
    belt_later: float = 0.0
    belt_change: float = 0.0
    """The belt's speed, another one, and when it jumps (0: never)."""
    across: list[float] = field(default_factory=list)
    """The belt's speed across the blocks' guides: constant, amplitude, omega; none: it has none."""
    q: list[list[float]] = field(default_factory=list)
    v: list[list[float]] = field(default_factory=list)
    frequencies: list[float] = field(default_factory=list)
    ratios: list[float] = field(default_factory=list)
    shapes: list[list[float]] = field(default_factory=list)

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def from_data(data: dict[str, Any]) -> Spec:
    """Back from JSON."""
    known = dict(data)
    known["pulls"] = [Pull(**pull) for pull in data["pulls"]]
    known["touches"] = [Touch(**touch) for touch in data["touches"]]
    return Spec(**known)


def case_of(spec: Spec) -> Case:
    """Both forms."""
    silent = frozenset(f"c{i}" for i, t in enumerate(spec.touches) if t.fields.get("mu_s", 1.0) < NOTHING)
    return Case(name=spec.kind, scene=scene(spec), problem=numbers(spec), signals=signals(spec), silent=silent)


def signals(spec: Spec) -> tuple[str, ...]:
    """Names of degrees of freedom in the oracle's order."""
    if spec.frequencies:
        return tuple(f"plate.mode{i + 1}" for i in range(len(spec.frequencies)))
    return tuple(f"b{i}.{AXES[k]}" for i in range(len(spec.masses)) for k in range(spec.d))


# -- fricmb ---------------------------------------------------------------------------------------------------------
def scene(spec: Spec) -> Any:
    """As fricmb has it."""
    axes = AXES[: spec.d]
    bodies, parts = modal(spec) if spec.frequencies else blocks(spec)
    speed: Any = spec.belt
    if spec.belt_change:
        speed = sympy.Piecewise((spec.belt, fm.t < spec.belt_change), (spec.belt_later, True))
    velocity = {"x": speed}
    if spec.across:
        velocity["y"] = spec.across[0] + spec.across[1] * sympy.sin(spec.across[2] * fm.t)
    ends = {-1: fm.GROUND, -2: fm.Driven("belt", velocity=velocity)}
    ends |= dict(enumerate(bodies))
    if any(touch.b == -2 for touch in spec.touches):
        parts.append(ends[-2])
    for number, (a, b, axis, k) in enumerate(spec.springs):
        parts.append(fm.Spring(f"k{number}", ends[a], ends[b], axis=AXES[axis], stiffness=k))
    for number, (a, b, axis, c) in enumerate(spec.dampers):
        parts.append(fm.Damper(f"d{number}", ends[a], ends[b], axis=AXES[axis], damping=c))
    for number, pull in enumerate(spec.pulls):
        form = sympy.exp(-(((fm.t - pull.phase) / pull.bell) ** 2)) if pull.bell else None
        value = pull.constant + pull.amplitude * (form or sympy.sin(pull.omega * fm.t + pull.phase))
        if pull.since:
            value = sympy.Piecewise((0, fm.t < pull.since), (value, True))
        parts.append(fm.Force(f"f{number}", ends[pull.body], axis=AXES[pull.axis], value=value))
    for number, touch in enumerate(spec.touches):
        law = getattr(fm.laws, touch.law)(**touch.fields)
        N: Any = touch.N
        if touch.swing or touch.slope:
            x = fm.coordinate(f"b{touch.a}.x") if touch.slope else 0
            N = touch.N * (1 + touch.swing * sympy.sin(touch.omega * fm.t) + touch.slope * x)
        along = axes + "y" if spec.across and touch.b == -2 else axes
        parts.append(fm.Contact(f"c{number}", ends[touch.a], ends[touch.b], law=law, normal_force=N, axes=along))
    return fm.Scene(spec.kind, parts)


def blocks(spec: Spec) -> tuple[list[Any], list[Any]]:
    """Bodies, and the parts so far."""
    axes = AXES[: spec.d]
    made = [
        fm.Body(
            f"b{i}", mass=m, axes=axes, position=dict(zip(axes, spec.q[i], strict=True)),
            velocity=dict(zip(axes, spec.v[i], strict=True)),
        )
        for i, m in enumerate(spec.masses)
    ]  # fmt: skip
    return made, list(made)


def modal(spec: Spec) -> tuple[list[Any], list[Any]]:
    """Points of a body of modes, and the parts so far."""
    n, d = len(spec.frequencies), spec.d
    shapes = {f"p{i}": np.array(row).reshape(d, n) for i, row in enumerate(spec.shapes)}
    names = [f"mode{i + 1}" for i in range(n)]
    body = fm.ModalBody(
        "plate", frequencies=tuple(spec.frequencies), damping_ratios=tuple(spec.ratios), axes=AXES[:d], shapes=shapes,
        position=dict(zip(names, spec.q[0], strict=True)), velocity=dict(zip(names, spec.v[0], strict=True)),
    )  # fmt: skip
    return [body.point(name) for name in shapes], [body]


# -- the oracle -----------------------------------------------------------------------------------------------------
def numbers(spec: Spec) -> Problem:
    """As the oracle has it."""
    d = spec.d
    ways = directions(spec)
    n = ways[0].shape[0]
    if spec.frequencies:
        w, ratio = np.array(spec.frequencies), np.array(spec.ratios)
        M, K, C = np.eye(n), np.diag(w**2), np.diag(2.0 * ratio * w)
    else:
        M, K, C = np.diag(np.repeat(spec.masses, d)), np.zeros((n, n)), np.zeros((n, n))
    for matrix, links in ((K, spec.springs), (C, spec.dampers)):
        for a, b, axis, value in links:
            way = ways[a][:, axis] - (ways[b][:, axis] if b >= 0 else 0.0)
            matrix += value * np.outer(way, way)
    loads = [(ways[p.body][:, p.axis], p) for p in spec.pulls]
    breaks = [p.since for p in spec.pulls if p.since] + ([spec.belt_change] if spec.belt_change else [])
    # explicit steps see a bell where they begin anew within it, and what swings fast where they are short
    breaks += [p.phase + k * p.bell for p in spec.pulls if p.bell for k in WITHIN]
    swings = [p.omega for p in spec.pulls if p.amplitude and not p.bell] + [t.omega for t in spec.touches if t.swing]
    fastest = max([*swings, *spec.across[2:]], default=0.0)
    longest = min(spec.t_end / 100.0, SEEN / fastest) if fastest else None
    return Problem(
        M=M, K=K, C=C, q=np.concatenate(spec.q), v=np.concatenate(spec.v), load=load_of(n, loads), t_end=spec.t_end,
        contacts=tuple(contact(spec, i, ways) for i in range(len(spec.touches))), breaks=tuple(breaks),
        max_step=longest,
    )  # fmt: skip


def directions(spec: Spec) -> list[np.ndarray]:
    """How each end moves: (n, d)."""
    d = spec.d
    if spec.frequencies:
        return [np.array(row).reshape(d, len(spec.frequencies)).T for row in spec.shapes]
    n = d * len(spec.masses)
    return [np.eye(n)[:, d * i : d * i + d] for i in range(len(spec.masses))]


def load_of(n: int, loads: list[tuple[np.ndarray, Pull]]) -> Callable[[float], np.ndarray]:
    """All pulls together."""

    def load(t: float) -> np.ndarray:
        total = np.zeros(n)
        for way, p in loads:
            if t >= p.since:
                total += way * p.value(t)
        return total

    return load


def contact(spec: Spec, number: int, ways: list[np.ndarray]) -> Contact:
    """One contact."""
    touch = spec.touches[number]
    W = ways[touch.a] - (ways[touch.b] if touch.b >= 0 else 0.0)
    first = ways[touch.a][:, 0]

    def normal(t: float, q: np.ndarray, v: np.ndarray) -> float:
        return float(touch.N * (1.0 + touch.swing * math.sin(touch.omega * t) + touch.slope * (first @ q)))

    guided = bool(spec.across) and touch.b == -2
    d = spec.d + guided
    along = np.eye(d)[0]
    early, late = spec.belt * along, spec.belt_later * along
    if guided:
        W = np.column_stack([W, np.zeros(len(W))])

    def slide(t: float) -> np.ndarray:
        now = late if spec.belt_change and t >= spec.belt_change else early
        if guided:
            steady, swing, omega = spec.across
            return now + np.array([0.0, steady + swing * math.sin(omega * t)])
        return now

    return Contact(
        name=f"c{number}", W=W, N=normal, slide=slide if touch.b == -2 else nothing,
        constant=not (touch.swing or touch.slope),
        **parts_of(getattr(fm.laws, touch.law)(**touch.fields), d),
    )  # fmt: skip
