"""How sure stability is: parameters drawn from distributions, by scrambled Sobol points."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import stats
from scipy.stats import qmc

from fricmb.analysis import AnalysisError
from fricmb.errors import shown
from fricmb.squeal._place import Floats
from fricmb.values import as_float

#: How many scramblings there are, each of the same number of points: their scatter is the error of what they say.
REPEATS = 8


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """Growth rates over distributions of parameters.

    Attributes
    ----------
    at : dict of str to float
        Values of the study's parameters.
    names : tuple of str
        Parameters that were drawn.
    values : (n, n_names)
    growth : (n,)
        Largest growth rate; nan where there was no steady sliding.
    frequency : (n,)
        Angular frequency of that mode.
    first, total : (n_names,) or None
        Sobol' indices of the largest growth rate: the share of its variance due to each parameter alone, and together
        with the others.
    """

    at: Mapping[str, float]
    names: tuple[str, ...]
    values: Floats
    growth: Floats
    frequency: Floats
    first: Floats | None = None
    total: Floats | None = None

    def _parts(self, of: Callable[[Floats], float]) -> tuple[float, float]:
        """Mean over the scramblings, and its standard error."""
        found = np.array([of(part[np.isfinite(part)]) for part in np.split(self.growth, REPEATS)])
        return float(found.mean()), float(found.std(ddof=1) / np.sqrt(REPEATS))

    @property
    def probability(self) -> float:
        """Probability that some mode grows."""
        return self._parts(lambda part: float((part > 0.0).mean()))[0]

    @property
    def probability_error(self) -> float:
        """Standard error of that, from the scatter of eight scramblings."""
        return self._parts(lambda part: float((part > 0.0).mean()))[1]

    def quantile(self, q: float) -> float:
        """Growth rate that a part ``q`` of the samples stays below."""
        return float(np.nanquantile(self.growth, q))

    def __str__(self) -> str:
        low, middle, high = (self.quantile(q) for q in (0.05, 0.5, 0.95))
        chance = f"{self.probability:.4g} +- {self.probability_error:.2g}"
        lines = [
            f"{self.growth.size} samples: unstable with probability {chance}",
            f"largest growth rate: 5 % below {low:.4g}, half below {middle:.4g}, 95 % below {high:.4g}",
        ]
        if self.first is not None and self.total is not None:
            lines += [
                f"  {name:28} first {one:6.3f}, total {whole:6.3f}"
                for name, one, whole in zip(self.names, self.first, self.total, strict=True)
            ]
        return "\n".join(lines)


def distribution(who: str, name: str, given: Any, value: float) -> Any:
    """A distribution of scipy: as given, even between two numbers, or normal with a relative standard deviation."""
    accepted = "(low, high), a relative standard deviation, or a distribution of scipy.stats with its numbers"
    if hasattr(given, "ppf") and hasattr(given, "rvs"):
        return given
    if isinstance(given, tuple | list) and len(given) == 2:
        low, high = map(as_float, given)
        if np.isfinite([low, high]).all() and low < high:
            return stats.uniform(low, high - low)
    spread = as_float(given)
    if not (np.isfinite(spread) and spread > 0.0 and value):
        raise AnalysisError(f"{who}: of {name} (now {value:g}) must be {accepted}; got {shown(given)}")
    return stats.norm(value, abs(value) * spread)


def draw(distributions: list[Any], samples: int, seed: int) -> Floats:
    """Points (REPEATS * samples, n), scrambling by scrambling."""
    parts = []
    for i in range(REPEATS):
        sampler = qmc.Sobol(len(distributions), scramble=True, seed=np.random.default_rng([seed, i]))
        unit = np.clip(sampler.random(samples), 1e-12, 1.0 - 1e-12)
        parts.append(np.column_stack([d.ppf(unit[:, k]) for k, d in enumerate(distributions)]))
    return np.vstack(parts)


def sobol_indices(
    distributions: list[Any], samples: int, seed: int, growth: Callable[[Floats], Floats]
) -> tuple[Floats, Floats]:
    """First and total indices (n,) of a function of points (m, n), by Saltelli's estimator in scipy."""

    def column(points: NDArray[np.float64]) -> Floats:
        return growth(np.asarray(points).T)

    found = stats.sobol_indices(func=column, n=samples, dists=distributions, random_state=seed)
    return np.asarray(found.first_order), np.asarray(found.total_order)
