"""Chains of links on dry pins, in relative angles: Lagrange's equations, reactions by Newton's.

The load of a pin is the magnitude of its reaction, which depends on the friction it causes: both are found together.
"""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
import sympy

import fricmb as fm

from .judge import Case
from .problem import Contact, Problem

GRAVITY = 9.81


@dataclass
class Chain:
    """Links that hang on each other: angles from the vertical, pins of a radius and coefficients."""

    kind: str
    masses: list[float]
    inertias: list[float]
    lengths: list[float]
    angles: list[float]
    rates: list[float]
    radii: list[float]
    mu_s: list[float]
    mu_k: list[float]
    t_end: float
    torque: float = 0.0
    omega: float = 1.0
    """On the last link: torque sin(omega t)."""

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def case_of(chain: Chain) -> Case:
    """Both forms."""
    names = tuple(f"link{i}.angle" for i in range(len(chain.masses)))
    return Case(name=chain.kind, scene=scene(chain), problem=numbers(chain), signals=names)


def scene(chain: Chain, gravity: float = GRAVITY) -> Any:
    """As fricmb has it: bodies that turn, pins between."""
    parts: list[Any] = []
    x = y = vx = vy = 0.0
    before: Any = None
    for i, (m, inertia, length, angle, rate) in enumerate(
        zip(chain.masses, chain.inertias, chain.lengths, chain.angles, chain.rates, strict=True)
    ):
        s, c, half = math.sin(angle), math.cos(angle), 0.5 * length
        link = fm.RigidBody(
            f"link{i}", mass=m, inertia=inertia, position=(x + half * s, y - half * c), angle=angle,
            velocity=(vx + half * c * rate, vy + half * s * rate), angular_velocity=rate,
            points={"root": (0.0, half), "tip": (0.0, -half)},
        )  # fmt: skip
        law = fm.laws.Coulomb(mu_s=chain.mu_s[i], mu_k=chain.mu_k[i])
        end = (before.point("tip"),) if before is not None else ()
        parts += [link, fm.Revolute(f"pin{i}", link.point("root"), *end, radius=chain.radii[i], friction=law)]
        x, y, vx, vy = x + length * s, y - length * c, vx + length * c * rate, vy + length * s * rate
        before = link
    parts.append(fm.Gravity("gravity", acceleration={"y": -gravity}))
    if chain.torque:
        parts.append(fm.Torque("motor", before, value=chain.torque * sympy.sin(chain.omega * fm.t)))
    return fm.Scene(chain.kind, parts)


def numbers(chain: Chain) -> Problem:
    """As the oracle has it, in the links' angles from the vertical."""
    n = len(chain.masses)
    m, lengths, inertia = np.array(chain.masses), np.array(chain.lengths), np.array(chain.inertias)
    # arm[i, j]: how far link j's direction carries the centre of link i
    arm = np.array([[lengths[j] if j < i else 0.5 * lengths[j] if j == i else 0.0 for j in range(n)] for i in range(n)])
    coupled = arm.T @ np.diag(m) @ arm

    def mass(q: np.ndarray) -> np.ndarray:
        return coupled * np.cos(q[:, None] - q[None, :]) + np.diag(inertia)

    def extra(t: float, q: np.ndarray, v: np.ndarray) -> np.ndarray:
        turning = -(coupled * np.sin(q[:, None] - q[None, :])) @ v**2
        weight = -GRAVITY * (m @ arm) * np.sin(q)
        drive = np.zeros(n)
        drive[-1] = chain.torque * math.sin(chain.omega * t)
        return turning + weight + drive

    below = m[:, None] * arm  # of all links from i on, summed from the last up
    below = np.cumsum(below[::-1], axis=0)[::-1]
    weight_below = GRAVITY * np.cumsum(m[::-1])[::-1]
    last: list[Any] = [None, None, ()]

    def reactions(q: np.ndarray, v: np.ndarray, a: np.ndarray) -> Any:
        """Of all pins: mass times acceleration of all links from each on, less their weight."""
        if last[0] is not q or last[1] is not a:
            s, c, square = np.sin(q), np.cos(q), v * v
            last[:] = q, a, np.hypot(below @ (c * a - s * square), below @ (s * a + c * square) + weight_below).tolist()
        return last[2]

    def reaction(i: int) -> Any:
        return lambda t, q, v, a: reactions(q, v, a)[i]

    def pin(i: int) -> Contact:
        W = np.zeros((n, 1))
        W[i, 0] = chain.radii[i]
        if i:
            W[i - 1, 0] = -chain.radii[i]
        return Contact(
            name=f"pin{i}", W=W, N=lambda t, q, v: math.nan, reaction=reaction(i), mu=lambda r, N: chain.mu_k[i],
            mu_s=lambda N: chain.mu_s[i],
        )  # fmt: skip

    zero = np.zeros((n, n))
    return Problem(
        M=zero, K=zero, C=zero, q=np.array(chain.angles), v=np.array(chain.rates), mass=mass, extra=extra,
        contacts=tuple(pin(i) for i in range(n)), t_end=chain.t_end,
    )  # fmt: skip
