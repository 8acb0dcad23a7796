"""Impulses of one instant: all sets of contacts that press, stick or slip are tried.

By Newton's law in Moreau's form ``gamma+ + e gamma-`` is complementary to impulses; by Poisson's that is solved twice,
first with e = 0, then with e times the normal impulses of the first phase as the least.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from .problem import OracleError
from .struck import Modes

#: Which way friction points in slip.
SIGNS = {"on": 1.0, "back": -1.0}


@dataclass(frozen=True, kw_only=True)
class Instant:
    """What takes part (k contacts, n coordinates): rows, speeds along them, friction, the inverse of the masses."""

    normals: np.ndarray
    alongs: np.ndarray
    rates: np.ndarray
    mu: np.ndarray
    inverse: np.ndarray

    def behind(self, jump: np.ndarray) -> np.ndarray:
        """Speeds (k, 2) with this jump of velocities."""
        return self.rates + np.stack([self.normals @ jump, self.alongs @ jump], axis=1)

    def newton(self, e: np.ndarray, e_t: np.ndarray) -> np.ndarray:
        """The jump of velocities; an error where the law gains energy, as seen from the surfaces."""
        aim = np.stack([-e * np.minimum(self.rates[:, 0], 0.0), -e_t * self.rates[:, 1]], axis=1)
        jump, push = self.phase(self.rates, aim, np.zeros(len(e)))
        gains = 0.5 * push * (self.rates + self.behind(jump))
        if gains.sum() > 1e-9 * np.abs(gains).sum():
            raise OracleError("an impact gains energy")
        return jump

    def poisson(self, e: np.ndarray) -> np.ndarray:
        """The same in two phases."""
        none = np.zeros_like(self.rates)
        first, push = self.phase(self.rates, none, np.zeros(len(e)))
        return first + self.phase(self.behind(first), none, e * push[:, 0])[0]

    def phase(self, rates: np.ndarray, aim: np.ndarray, given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The only jump, and impulses (k, 2), that nothing contradicts; normal ones of at least ``given``."""
        found: list[tuple[np.ndarray, np.ndarray]] = []
        size = float(np.abs(self.rates).max()) + 1e-300
        for doing in product(*(choices(m > 0.0, g > 0.0) for m, g in zip(self.mu, given, strict=True))):
            answer = self.tried(doing, rates, aim, given, size)
            if answer is not None and all(np.abs(answer[0] - other).max() > 1e-6 * size for other, _ in found):
                found.append(answer)
        if len(found) != 1:
            raise OracleError(f"{len(found)} solutions of the law of impact")
        return found[0]

    def tried(
        self, doing: tuple[tuple[bool, str], ...], rates: np.ndarray, aim: np.ndarray, given: np.ndarray, size: float
    ) -> tuple[np.ndarray, np.ndarray] | None:
        """Jump and impulses of one set."""
        columns, rows, wanted, owners = [], [], [], []
        start = given @ self.normals
        for k, (presses, how) in enumerate(doing):
            sign = SIGNS.get(how, 0.0)
            start = start - sign * self.mu[k] * given[k] * self.alongs[k]
            if presses:
                columns.append(self.normals[k] - sign * self.mu[k] * self.alongs[k])
                rows.append(self.normals[k])
                wanted.append(aim[k, 0] - rates[k, 0])
                owners.append((k, 0))
            if how == "stick":
                columns.append(self.alongs[k])
                rows.append(self.alongs[k])
                wanted.append(aim[k, 1] - rates[k, 1])
                owners.append((k, 1))
        push, jump = np.stack([given, np.zeros(len(given))], axis=1), self.inverse @ start
        if rows:
            A, B = np.array(rows), np.array(columns).T
            try:
                impulse = Modes.solved(A @ self.inverse @ B, np.array(wanted) - A @ jump)
            except np.linalg.LinAlgError:
                return None
            jump = jump + self.inverse @ (B @ impulse)
            for owner, value in zip(owners, impulse, strict=True):
                push[owner] += value
        after = rates + np.stack([self.normals @ jump, self.alongs @ jump], axis=1) - aim
        return (jump, push) if self.fits(doing, after, push, given, size) else None

    def fits(
        self, doing: tuple[tuple[bool, str], ...], xi: np.ndarray, push: np.ndarray, given: np.ndarray, size: float
    ) -> bool:
        """Whether nothing contradicts it."""
        small, little = 1e-11 * size, 1e-11 * (np.abs(push).max() + 1e-300)
        stuck = [k for k, (_, how) in enumerate(doing) if how == "stick"]
        if abs(push[stuck, 1].sum()) > (self.mu * push[:, 0])[stuck].sum() + little:  # on one floor: together
            return False
        for k, (presses, how) in enumerate(doing):
            if (push[k, 0] < given[k] - little) if presses else (xi[k, 0] < -small):
                return False
            if how in SIGNS and SIGNS[how] * xi[k, 1] < -small:
                return False
        return True


def choices(rubs: bool, pushed: bool) -> list[tuple[bool, str]]:
    """What a contact may do: whether it presses of itself, and how it slips."""
    ways = ["stick", "on", "back"] if rubs else [""]
    return [(True, how) for how in ways] + ([(False, how) for how in ways] if pushed else [(False, "")])
