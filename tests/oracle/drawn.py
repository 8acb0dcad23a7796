"""Scenes that are drawn as a few numbers: one function draws them, another makes both forms of them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

Generator = np.random.Generator


@dataclass
class Drawn:
    """Numbers of one scene; ``maker`` names the function that makes it of them."""

    kind: str
    maker: str
    n: dict[str, Any]

    def data(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


def some(rng: Generator, low: float, high: float) -> float:
    """A number of four digits between, evenly over its logarithm."""
    return float(f"{np.exp(rng.uniform(np.log(low), np.log(high))):.3e}")


def even(rng: Generator, low: float, high: float) -> float:
    """A number of four digits between."""
    return round(float(rng.uniform(low, high)), 4)


def limits(rng: Generator, low: float = 0.3, high: float = 0.8) -> tuple[float, float]:
    """Coefficients at rest and in slip, equal in one of four."""
    mu_k = even(rng, low, high)
    return round(mu_k * (1.0 if rng.random() < 0.25 else rng.uniform(1.05, 1.8)), 4), mu_k


def wave(rng: Generator, size: float, fast: float = 6.0) -> list[float]:
    """Constant, amplitude, angular frequency, phase."""
    return [even(rng, -size, size), even(rng, 0.0, 2.0 * size), some(rng, 0.3, fast), even(rng, 0.0, 6.28)]


def formula(w: list[float], t: Any) -> Any:
    """Of a wave, in SymPy."""
    import sympy

    return w[0] + w[1] * sympy.sin(w[2] * t + w[3])


def at(w: list[float], t: float) -> float:
    """The value of a wave."""
    import math

    return w[0] + w[1] * math.sin(w[2] * t + w[3])
