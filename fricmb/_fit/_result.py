"""The result of a fit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from fricmb._facade import facade
from fricmb._fit._data import Measured
from fricmb.integrate.problem import Floats

if TYPE_CHECKING:
    from fricmb.plot._fits import FitPlots
    from fricmb.scene import Scene
    from fricmb.solution import Solution


@dataclass(frozen=True, kw_only=True)
class Fit:
    """Parameters identified from measurements; made by :func:`fricmb.fit`.

    Attributes
    ----------
    values, std : dict of str to float
        Parameters and their standard errors; inf for one that the data do not determine.
    covariance : (n_p, n_p)
        Of the parameters in the order of ``values``.
    condition : float
        Condition of the Jacobian with its columns scaled to length 1; inf where parameters cannot be told apart.
    noise : float
        Standard deviation of the residuals, in units of the errors given (of the quantity, where one was measured and
        no error was given).
    scene : Scene
        With the values found.
    solution : Solution or None
        The run with them at the measured times; None where only periods were measured.
    measured : tuple of Measured
    residuals : dict of str to (n,)
        Prediction less measurement, by name of the quantity.
    notes : tuple of str
        Warnings: parameters at a bound, or that the data cannot tell apart.
    runs : int
        Number of runs made.
    offsets : dict of str to float
        Zero of each signal (measured less true), found beside the parameters.
    """

    values: Mapping[str, float]
    std: Mapping[str, float]
    covariance: Floats
    condition: float
    noise: float
    scene: Scene
    solution: Solution | None
    measured: tuple[Measured, ...]
    residuals: Mapping[str, Floats]
    notes: tuple[str, ...]
    runs: int
    offsets: Mapping[str, float] = field(default_factory=dict)

    @property
    def correlation(self) -> Floats:
        """Correlations (n_p, n_p) of the parameters."""
        size = np.sqrt(np.diag(self.covariance))
        found: Floats = self.covariance / np.outer(size, size)
        return found

    @property
    @facade
    def plot(self) -> FitPlots:
        """Pictures: ``found.plot.residuals()``."""
    def __str__(self) -> str:
        width = max(map(len, self.values))
        lines = [f"{name:{width}s}  {value:.8g} +- {self.std[name]:.2g}" for name, value in self.values.items()]
        lines += [f"{name}: zero of the measurement {value:+.6g}" for name, value in self.offsets.items()]
        lines.append(f"residuals {self.noise:.3g}, condition {self.condition:.3g}, {self.runs} runs")
        return "\n".join([*lines, *self.notes])
