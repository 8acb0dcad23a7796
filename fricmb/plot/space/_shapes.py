"""Solids that bodies are drawn as: as large as their inertia says, unless something on them says more."""

from __future__ import annotations

import numpy as np

from fricmb.plot._sketch import Floats
from fricmb.plot.space._sketch import Solid

#: Corners of what is round; meridians and parallels of a ball.
ROUND, MERIDIANS, PARALLELS = 32, 16, 8
#: Thickness of what is flat, as a share of its width.
FLAT = 0.06


def ball(name: str, radius: float) -> Solid:
    """A sphere in octants of two shades."""
    solid = Solid(name=name)
    east = np.linspace(0.0, 2 * np.pi, MERIDIANS + 1)
    north = np.linspace(-np.pi / 2, np.pi / 2, PARALLELS + 1)
    for j in range(PARALLELS):
        for i in range(MERIDIANS):
            a, b = east[[i, i + 1, i + 1, i]], north[[j, j, j + 1, j + 1]]
            solid.faces.append(radius * np.column_stack((np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b))))
            solid.shades.append((4 * i // MERIDIANS + 2 * j // PARALLELS) % 2)
    return solid


def cuboid(name: str, edges: Floats) -> Solid:
    """A box about the origin."""
    half = 0.5 * edges
    solid = Solid(name=name)
    for axis in range(3):
        u, w = (axis + 1) % 3, (axis + 2) % 3
        for side in (-1.0, 1.0):
            face = np.zeros((4, 3))
            face[:, axis] = side * half[axis]
            face[:, u] = side * np.array([-1, 1, 1, -1]) * half[u]
            face[:, w] = np.array([-1, -1, 1, 1]) * half[w]
            solid.faces.append(face)
            solid.shades.append(0)
            solid.edge(face[[0, 1, 2, 3, 0]], side * np.eye(3)[axis])
    return solid


def disc(name: str, radius: float, half: float) -> Solid:
    """A cylinder about the z axis, with spokes on both ends."""
    angle = np.linspace(0.0, 2 * np.pi, ROUND + 1)
    rim = radius * np.column_stack((np.cos(angle), np.sin(angle), 0 * angle))
    up = np.array([0.0, 0.0, half])
    solid = Solid(name=name, faces=[(rim + up)[:-1], (rim - up)[:-1][::-1]], shades=[0, 0])
    for i in range(ROUND):
        solid.faces.append(np.array([rim[i] - up, rim[i + 1] - up, rim[i + 1] + up, rim[i] + up]))
        solid.shades.append((4 * i // ROUND) % 2)
    for side in (up, -up):
        solid.edge(rim + side, side)
        for i in (0, ROUND // 3, 2 * ROUND // 3):
            solid.edge(np.array([side, rim[i] + side]), side)
    return solid


def cone(name: str, radius: float, base: float, tip: float) -> Solid:
    """From a circle at height ``base`` on the z axis to a tip on it."""
    angle = np.linspace(0.0, 2 * np.pi, ROUND + 1)
    rim = np.column_stack((radius * np.cos(angle), radius * np.sin(angle), np.full(angle.size, base)))
    end = np.array([0.0, 0.0, tip])
    order = [0, 1, 2] if tip > base else [1, 0, 2]
    faces = [np.array([rim[i], rim[i + 1], end])[order] for i in range(ROUND)]
    return Solid(name=name, faces=faces, shades=[(4 * i // ROUND) % 2 for i in range(ROUND)])


def axle(name: str, wheels: list[tuple[float, float]]) -> Solid:
    """Wheels on a bar along the z axis, each by its place and radius."""
    radius = max(radius for _, radius in wheels)
    bar = disc(name, 0.12 * radius, max(abs(place) for place, _ in wheels))
    for place, own in wheels:
        bar.joined(disc(name, own, FLAT * own), np.array([0.0, 0.0, place]))
    return bar


def edges_of(mass: float, inertia: Floats) -> Floats:
    """Edges (3,) of the cuboid that has a mass and principal moments: ``a_i^2 = 6 (sum J - 2 J_i)/m``."""
    edges = np.sqrt(np.maximum(0.0, 6.0 * (inertia.sum() - 2.0 * inertia) / mass))
    return np.asarray(np.maximum(edges, FLAT * edges.max()))


def cylinder_of(mass: float, across: float, axial: float) -> tuple[float, float]:
    """Radius and half length of the cylinder that has a mass and moments about and across its axis.

    ``C = m r^2/2`` and ``A = m (3 r^2 + l^2)/12``; it is flat where A is less than C/2.
    """
    radius = float(np.sqrt(2.0 * axial / mass))
    length = float(np.sqrt(max(0.0, 12.0 * across / mass - 3.0 * radius**2)))
    return radius, 0.5 * max(length, 2.0 * FLAT * radius)
