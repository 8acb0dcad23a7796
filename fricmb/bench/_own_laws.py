"""What a law of a user's costs beside a built-in one: the same formula three times, the same steps, time by time."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

import fricmb as fm

#: Stick-slip on a belt, in the middle of the range of tolerances.
T_END, RTOL = 100.0, 1e-6


@dataclass(frozen=True, kw_only=True)
class OwnStribeck(fm.FrictionLaw):
    """Stribeck's curve as a user writes it."""

    mu_s: float
    mu_k: float
    v_s: float

    def define_coefficient(self, r: Any) -> Any:
        """Gaussian."""
        import sympy

        return self.mu_k + (self.mu_s - self.mu_k) * sympy.exp(-((r / self.v_s) ** 2))


def stribeck_function(x: Any, p: Any, out: Any) -> None:
    """``x = [r, N]``, ``p = [mu_s, mu_k, v_s]``, ``out = [mu, d mu/dr, d mu/dN]``."""
    share = x[0] / p[2]
    fall = (p[0] - p[1]) * math.exp(-share * share)
    out[0], out[1], out[2] = p[1] + fall, -2.0 * share / p[2] * fall, 0.0


@dataclass(frozen=True, kw_only=True)
class CompiledStribeck(OwnStribeck):
    """The same as a plain function that numba compiles."""

    def compiled_coefficient(self) -> Callable[..., None]:
        """In place of the formula, which serves figures alone."""
        return stribeck_function


@dataclass(frozen=True, kw_only=True)
class OwnDahl(fm.FrictionLaw):
    """Dahl's bristle as a user writes it."""

    sigma0: float
    mu: float
    states: ClassVar[tuple[str, ...]] = ("z",)

    def define_force(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Springs."""
        return tuple(-self.sigma0 * N * c for c in z)

    def define_rate(self, v: tuple[Any, ...], N: Any, z: tuple[Any, ...]) -> Any:
        """Springs that give way."""
        speed = fm.laws.norm(v)
        return tuple(a - self.sigma0 / self.mu * speed * b for a, b in zip(v, z, strict=True))


def dahl_function(x: Any, p: Any, out: Any) -> None:
    """One direction: ``x = [v, N, z]``, ``p = [sigma0, mu]``, ``out = [F, z', dF/dx (3), dz'/dx (3)]``."""
    v, N, z, k, mu = x[0], x[1], x[2], p[0], p[1]
    speed = max(abs(v), 1e-60)
    out[0], out[1] = -k * N * z, v - k / mu * speed * z
    out[2], out[3], out[4] = 0.0, -k * z, -k * N
    out[5], out[6], out[7] = 1.0 - k / mu * z * v / speed, 0.0, -k / mu * speed


@dataclass(frozen=True, kw_only=True)
class CompiledDahl(OwnDahl):
    """The same as a plain function that numba compiles."""

    dimensions: ClassVar[tuple[int, ...]] = (1,)

    def compiled_force(self, d: int) -> Callable[..., None]:
        """In place of the formulas."""
        return dahl_function


_CURVE = {"mu_s": 1.5, "mu_k": 1.0, "v_s": 0.3}
_BRISTLE = {"sigma0": 1e3, "mu": 1.0}
#: Built-in law, user's formula, user's compiled function.
FAMILIES: dict[str, tuple[Any, Any, Any]] = {
    "Stribeck": (fm.laws.Stribeck(**_CURVE), OwnStribeck(**_CURVE), CompiledStribeck(**_CURVE)),
    "Dahl": (fm.laws.Dahl(**_BRISTLE), OwnDahl(**_BRISTLE), CompiledDahl(**_BRISTLE)),
}


def law_costs(rounds: int = 15) -> dict[str, dict[str, float]]:
    """Time of a step with a user's law over that with a built-in one, in one process.

    The laws take turns, ``rounds`` times, and the least time of each counts.
    """
    found = {}
    for family, laws in FAMILIES.items():
        scenes = [fm.models.belt_oscillator(law=law) for law in laws]
        times = [math.inf] * len(laws)
        steps = [0] * len(laws)
        for turn in range(rounds + 1):
            for i, scene in enumerate(scenes):
                begin = time.process_time()
                sol = fm.simulate(scene, t_end=T_END, rtol=RTOL, method="bdf")
                if turn:  # the first compiles
                    times[i] = min(times[i], time.process_time() - begin)
                steps[i] = sol.stats.n_steps
        each = [seconds / n for seconds, n in zip(times, steps, strict=True)]
        found[family] = {
            "built in, microseconds a step": 1e6 * each[0],
            "formula": each[1] / each[0],
            "compiled function": each[2] / each[0],
        }
    return found
