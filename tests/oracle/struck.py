"""What is hit, as numbers: surfaces, dry friction of given limits, and forces and accelerations while no mode changes.

A surface is a distance ``gap(q) - s(t) >= 0`` with a slip velocity; what is held has accelerations 0 there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from .problem import OPEN, SLIP, STICK, Motion

#: Speeds and accelerations that are none; distances that are none of what is not held already.
NONE, TOUCH = 1e-9, 3e-13

Row = Callable[[np.ndarray], np.ndarray]
Drift = Callable[[np.ndarray, np.ndarray], float]


def still(t: float) -> tuple[float, float, float]:
    """What does not move: place, speed, acceleration."""
    return 0.0, 0.0, 0.0


def straight(q: np.ndarray, v: np.ndarray) -> float:
    """No acceleration of its own."""
    return 0.0


@dataclass(frozen=True, kw_only=True)
class Surface:
    """A distance and, with friction, a slip velocity.

    ``gap(q) - moves(t)[0]`` is the distance, ``row(q) v`` its rate but for the surface's own, ``bend(q, v)`` what its
    second derivative is without accelerations; ``along``, ``along_bend`` and ``slides`` (speed, acceleration) the same
    of slip.
    """

    name: str
    gap: Callable[[np.ndarray], float]
    row: Row
    bend: Drift = straight
    moves: Callable[[float], tuple[float, float, float]] = still
    e: float = 0.0
    e_t: float = 0.0
    mu_s: float = 0.0
    mu_k: float = 0.0
    along: Row | None = None
    along_bend: Drift = straight
    slides: Callable[[float], tuple[float, float]] = lambda t: (0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Dry:
    """Dry friction of given limits on ``row v``."""

    name: str
    row: np.ndarray
    static: float
    kinetic: float


@dataclass(frozen=True, kw_only=True)
class Struck:
    """M q'' = force(t, q, v) + friction + what surfaces push."""

    M: np.ndarray
    force: Callable[[float, np.ndarray, np.ndarray], np.ndarray]
    q: np.ndarray
    v: np.ndarray
    t_end: float
    surfaces: tuple[Surface, ...]
    dries: tuple[Dry, ...] = ()
    longest: float = np.inf
    scale: float = 1.0
    poisson: bool = False
    """Whether impulses are given back in place of speeds."""


@dataclass(frozen=True)
class Impact:
    """One surface is hit; ``approach``: with which speed."""

    t: float
    surface: str
    approach: float


@dataclass
class Bouncing(Motion):
    """A motion with impacts; ``rests``: when and which surface has come to rest, and is pressed on.

    ``ends``: when series of impacts are over.
    """

    impacts: list[Impact] = field(default_factory=list)
    rests: list[tuple[float, str]] = field(default_factory=list)
    ends: list[float] = field(default_factory=list)


class Modes:
    """Forces and accelerations of a problem while no mode changes."""

    def __init__(self, problem: Struck) -> None:
        self.p = problem
        self.n, self.k = problem.q.size, len(problem.surfaces)
        self.inverse = np.linalg.inv(problem.M)
        self.t, self.y = 0.0, np.concatenate([problem.q, problem.v]).astype(float)
        self.modes = [OPEN] * self.k + [SLIP] * len(problem.dries)
        self.signs = [0.0] * len(self.modes)
        self.zero = np.zeros(self.k)

    # -- while no mode changes ----------------------------------------------------------------------------------
    def rows(self, q: np.ndarray, v: np.ndarray, t: float, i: int) -> tuple[np.ndarray, float, np.ndarray, float]:
        """Normal and tangential rows of part i and what accelerations along them are without those of q."""
        if i >= self.k:
            return self.p.dries[i - self.k].row, 0.0, self.p.dries[i - self.k].row, 0.0
        s = self.p.surfaces[i]
        along = np.zeros(self.n) if s.along is None else s.along(q)
        return s.row(q), s.bend(q, v) - s.moves(t)[2], along, s.along_bend(q, v) - s.slides(t)[1]

    def accelerations(
        self, t: float, y: np.ndarray, modes: list[int], signs: list[float]
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Accelerations, normal forces and friction (part by part) under these modes."""
        q, v = y[: self.n], y[self.n :]
        f = self.p.force(t, q, v)
        columns, rows, wanted, owners = [], [], [], []
        for i, (mode, sign) in enumerate(zip(modes, signs, strict=True)):
            if mode == OPEN:
                continue
            normal, bend, along, turn = self.rows(q, v, t, i)
            if i >= self.k:
                if mode == SLIP:
                    f = f - sign * self.p.dries[i - self.k].kinetic * along
                    continue
            else:
                mu = self.p.surfaces[i].mu_k
                columns.append(normal - sign * mu * along if mode == SLIP and mu > 0.0 else normal)
                rows.append(normal)
                wanted.append(-bend)
                owners.append((i, 0))
            if mode == STICK:
                columns.append(along)
                rows.append(along)
                wanted.append(-turn)
                owners.append((i, 1))
        N, T = np.zeros(len(modes)), np.zeros(len(modes))
        a = self.inverse @ f
        if rows:
            A, B = np.array(rows), np.array(columns).T
            D, b = A @ self.inverse @ B, np.array(wanted) - A @ a
            if any(i >= self.k for i, _ in owners) and np.linalg.cond(D) > 1e10:
                raise np.linalg.LinAlgError("what dry friction holds presses on no surface")
            force = self.solved(D, b)
            a = a + self.inverse @ (B @ force)
            for (i, which), value in zip(owners, force, strict=True):
                (T if which else N)[i] = value
        return a, N, T

    @staticmethod
    def solved(D: np.ndarray, b: np.ndarray) -> np.ndarray:
        """Of least norm where several fit."""
        if np.linalg.cond(D) < 1e10:
            return np.asarray(np.linalg.solve(D, b))
        found = np.linalg.lstsq(D, b, rcond=1e-11)[0]
        if np.abs(D @ found - b).max() > 1e-8 * (1.0 + np.abs(b).max()):
            raise np.linalg.LinAlgError("contradicts")
        return np.asarray(found)

    def __call__(self, t: float, y: np.ndarray) -> np.ndarray:
        """For scipy."""
        return np.concatenate([y[self.n :], self.accelerations(t, y, self.modes, self.signs)[0]])

    def speeds(self, t: float, y: np.ndarray, i: int) -> tuple[float, float, float]:
        """Distance, its rate, slip velocity."""
        q, v = y[: self.n], y[self.n :]
        if i >= self.k:
            return 0.0, 0.0, float(self.p.dries[i - self.k].row @ v)
        s = self.p.surfaces[i]
        place, speed, _ = s.moves(t)
        slip = 0.0 if s.along is None else float(s.along(q) @ v) - s.slides(t)[0]
        return s.gap(q) - place, float(s.row(q) @ v) - speed, slip

    def limit(self, i: int, N: float) -> float:
        """Friction at which part i breaks away."""
        return self.p.dries[i - self.k].static if i >= self.k else self.p.surfaces[i].mu_s * N

    def margins(self, t: float, y: np.ndarray) -> np.ndarray:
        """What stays above 0 while modes do: (2, parts), distance or normal force, and friction or slip."""
        out = np.full((2, len(self.modes)), np.inf)
        _, N, T = self.accelerations(t, y, self.modes, self.signs)
        stuck = [i for i in range(self.k) if self.modes[i] == STICK]
        for i, mode in enumerate(self.modes):
            gap, _, slip = self.speeds(t, y, i)
            if i < self.k:
                out[0, i] = gap - self.zero[i] if mode == OPEN else N[i]
            if mode == STICK:
                out[1, i] = self.limit(i, N[i]) - abs(T[i])
            elif mode == SLIP and (i >= self.k or self.p.surfaces[i].mu_k > 0.0):
                out[1, i] = self.signs[i] * slip
        if len(stuck) > 1:  # on one floor: together
            out[1, stuck] = sum(self.limit(i, N[i]) for i in stuck) - abs(T[stuck].sum())
        return out

    def rests(self, i: int) -> bool:
        """Whether surface i is touched and neither met nor left."""
        gap, rate, _ = self.speeds(self.t, self.y, i)
        return (self.modes[i] != OPEN or abs(gap) <= TOUCH) and abs(rate) <= NONE
