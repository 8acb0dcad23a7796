"""Which of many parameters matter: elementary effects, by SALib (extra ``salib``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import MissingExtraError
from fricmb.squeal._place import Floats

#: Levels of each parameter that walks go between.
LEVELS = 4


@dataclass(frozen=True, kw_only=True)
class Screening:
    """Elementary effects of parameters on the largest growth rate.

    An effect is the change of the growth rate over the change of one parameter, counted in shares of its distribution.

    Attributes
    ----------
    at : dict of str to float
        Values of the study's parameters.
    names : tuple of str
    effects : (n_names,)
        Mean of the effects' sizes: how much a parameter matters.
    errors : (n_names,)
        Standard errors of these.
    scatter : (n_names,)
        Standard deviation of the effects: large where a parameter acts together with others, or not in proportion.

    References
    ----------
    M. D. Morris, Factorial sampling plans for preliminary computational experiments, Technometrics 33 (1991) 161-174;
    F. Campolongo, J. Cariboni, A. Saltelli, Environmental Modelling & Software 22 (2007) 1509-1518.
    """

    at: Mapping[str, float]
    names: tuple[str, ...]
    effects: Floats
    errors: Floats
    scatter: Floats

    def __str__(self) -> str:
        order = np.argsort(self.effects)[::-1]
        rows = [f"{'parameter':28} {'effect':>10} {'error':>9} {'scatter':>9}"]
        for i in order:
            rows.append(f"{self.names[i]:28} {self.effects[i]:10.4g} {self.errors[i]:9.2g} {self.scatter[i]:9.2g}")
        return "\n".join(rows)


def screening(
    distributions: Mapping[str, Any],
    at: Mapping[str, float],
    walks: int,
    seed: int,
    growth: Callable[[Floats], Floats],
) -> Screening:
    """Effects of each parameter, by its distribution of scipy, on a function of points (m, n)."""
    try:
        from SALib.analyze import morris as effects
        from SALib.sample import morris as sample
    except ImportError:
        raise MissingExtraError("screening", "SALib", "salib") from None
    # the ends of a distribution may be infinite: walks go between the middles of its parts
    half = 0.5 / LEVELS
    names = tuple(distributions)
    problem = {"num_vars": len(names), "names": list(names), "bounds": [[half, 1.0 - half]] * len(names)}
    unit = sample.sample(problem, walks, num_levels=LEVELS, seed=seed)
    points = np.column_stack([d.ppf(unit[:, k]) for k, d in enumerate(distributions.values())])
    walked = 1.0 - 2.0 * half
    found = effects.analyze(problem, unit, growth(points), num_levels=LEVELS, seed=seed)
    return Screening(
        at=at,
        names=names,
        effects=np.asarray(found["mu_star"], dtype=float) / walked,
        errors=np.asarray(found["mu_star_conf"], dtype=float) / (1.96 * walked),
        scatter=np.asarray(found["sigma"], dtype=float) / walked,
    )
