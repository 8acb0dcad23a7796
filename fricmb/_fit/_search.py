"""Where a fit starts, and how it goes on: from the equations, from the first guess, from elsewhere, from around."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from fricmb._fit._data import Measured
from fricmb._fit._model import Model
from fricmb._fit._regression import regress
from fricmb._fit._uncertainty import uncertainty
from fricmb.errors import FricmbError, SceneError
from fricmb.integrate.problem import Floats

Loss = Literal["linear", "soft_l1", "huber", "cauchy", "arctan"]
#: Residuals below this part of the extent of the data are none.
_EXACT = 1e-4
#: Around a fit, others set out at these multiples of its standard errors, until so many have found nothing that is
#: better by more than this part; so many where the equations led to the fit.
_REACHES, _IDLE, _BETTER, _LED = (2.0, 5.0, 10.0), 6, 1e-4, 2
#: Residuals of a start below this part of the extent of the data: it is fitted to all of them at once.
_NEAR = 0.5
#: A start by regression whose fit explains this part of the data is no false minimum.
_ENOUGH = 0.99
#: Residuals of all the data that are larger than those of a part by what chance does this seldom are those of a false
#: minimum (3.5 standard deviations).
_CHANCE = 2.3e-4


@dataclass(frozen=True, kw_only=True)
class Found:
    """A fit through all windows; ``likely``: residuals of all the data that those of their first parts allow."""

    model: Model
    p: Floats
    J: Floats
    cost: float
    likely: float

    @property
    def plausible(self) -> bool:
        """Whether all the data are fitted as well as their first parts."""
        return self.cost <= self.likely


@dataclass(kw_only=True)
class Search:
    """Least squares over windows of the data, from several starts."""

    model: Model
    stages: list[float]
    first: Floats
    bounds: Mapping[str, tuple[float, float]]
    priors: Mapping[str, tuple[float, float]]
    loss: Loss
    shown: Any
    tried: int = 0
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))

    def __post_init__(self) -> None:
        self.low, self.high = np.array(list(self.bounds.values())).T

    def best(self, starts: int) -> Found:
        """The best fit from so many starts at most, and around it."""
        begin, near = self._begin()
        best = self._through(begin, whole=True) if near else None  # so near that the data need not grow
        self.tried = int(near)
        # data of a rig are never as good as their best part: what explains them and comes from the equations stays
        enough = best is not None and (best.plausible or self.explained(best) > _ENOUGH)
        for i in range(0 if enough else starts):
            other = self.first if i == 1 and begin is not self.first else None
            found = self._through(begin if i == 0 else self._another() if other is None else other)
            self.tried, self.shown = i + 1, None
            if best is None or found.cost < best.cost:
                best = found
            if found.plausible:
                break
        assert best is not None
        if starts > 1 and (best.plausible or not enough):
            best = self._around(best, _LED if enough else _IDLE)
        return best

    def explained(self, found: Found) -> float:
        """R^2: the part of what was measured that a fit explains."""
        return float(1.0 - (found.cost / extent(self.model.measured)) ** 2)

    def doubt(self, found: Found) -> str:
        """What there is to say about a fit that is not plausible."""
        tried = "1 start" if self.tried == 1 else f"{self.tried} starts"
        return (
            f"residuals of all the data ({found.cost:.3g}) are larger than a part of them allows ({found.likely:.3g}),"
            f" from {tried}: a false minimum, or the scene lacks something; R^2 is {self.explained(found):.6g} all the"
            " same"
        )

    def _begin(self) -> tuple[Floats, bool]:
        """Where to start, and whether that is near: the first guess, or a regression if it explains the data better."""
        model = self.model
        led = regress(model.scene, model.names, self.first, self.low, self.high, model.measured, model.offset)
        if not led:
            return self.first, False
        # the first guess first: a mistake in what was asked is said there
        noise = [model.noise(p) for p in (self.first, *led)]
        k = int(np.argmin(noise))
        return (led[k - 1], noise[k] < _NEAR * extent(model.measured)) if k else (self.first, False)

    def _through(self, p: Floats, *, whole: bool = False) -> Found:
        """From the first window to the last, each started where the one before has ended.

        ``whole``: all the data are fitted at once, and their parts only looked at afterwards.
        """
        from scipy.stats import f as f_distribution

        model, noise, freedom = self.model, list[float](), list[int]()
        if whole:
            part = model.until(self.stages[-1])
            p, _ = self._solve(part, p, last=False)
            model.runs += part.runs
        for i, t in enumerate(self.stages):
            part, last = model.until(t), i == len(self.stages) - 1
            if last or not whole:
                p, J = self._solve(part, p, last=last)
            noise.append(part.noise(p))
            freedom.append(part.freedom(p))
            model.runs += part.runs
            model.cycle = part.cycle
            if self.shown is not None:
                self.shown.update()
        # the variances of a part and of the whole, of errors that are alike, have Fisher's ratio: few data say little
        ratios = f_distribution.isf(_CHANCE, freedom[-1], np.array(freedom))
        allowed = max(float((np.array(noise) * np.sqrt(ratios)).min()), _EXACT * extent(model.measured))
        return Found(model=part, p=p, J=J, cost=noise[-1], likely=allowed)

    def _around(self, best: Found, most: int) -> Found:
        """The best of several fits that set out around one, as far as its errors and the bounds reach.

        Trial runs get out of step with the data little by little, and false minima lie side by side: some standard
        errors from one another, and hardly higher.
        """
        low, high = self.low, self.high
        idle = 0
        while idle < most:
            std = np.sqrt(np.diag(uncertainty(best.J, self.model.names).covariance))
            std = np.where(np.isfinite(std), std, 0.0) * best.cost + np.where(np.isfinite(std), 0.0, high - low)
            reach = np.minimum(_REACHES[idle % len(_REACHES)] * std, 0.5 * (high - low))
            idle += 1
            begin = np.clip(best.p + reach * self.rng.standard_normal(low.size), low, high)
            try:
                self.model.with_values(begin)
            except FricmbError:  # mu_k above mu_s, say
                continue
            p, J = self._solve(best.model, begin, last=False)
            if best.model.noise(p) < best.cost * (1.0 - _BETTER):
                p, J = self._solve(best.model, p, last=True)
                best, idle = replace(best, p=p, J=J, cost=best.model.noise(p)), 0
        return best

    def _another(self) -> Floats:
        """A start within the bounds that the scene accepts."""
        for _ in range(100):
            p = np.asarray(self.low + (self.high - self.low) * self.rng.random(self.low.size))
            try:
                self.model.with_values(p)
            except FricmbError:  # mu_k above mu_s, say
                continue
            return p
        raise SceneError("parameters: the scene accepts hardly any values within the bounds")

    def _solve(self, model: Model, p: Floats, *, last: bool) -> tuple[Floats, Floats]:
        """Least squares in one window: values, and the Jacobian there; by exact derivatives in the ``last`` one."""
        from scipy.optimize import least_squares

        low, high = self.low, self.high
        known = [(model.names.index(name), *given) for name, given in self.priors.items()]
        prior_J = np.array([np.eye(len(p))[i] / std for i, _, std in known]).reshape(len(known), len(p))

        def residuals(x: Floats) -> Floats:
            return np.concatenate([model.residuals(x), [(x[i] - mean) / std for i, mean, std in known]])

        def jacobian(x: Floats) -> Floats:
            return np.concatenate([model.jacobian(x), prior_J])

        tight = 1e-4
        if last:  # differences have no more digits
            tight = 1e-7 if model.differs else 1e-12
        found = least_squares(
            residuals, np.clip(p, low + 1e-9 * (high - low), high - 1e-9 * (high - low)), jac=jacobian,
            bounds=(low, high), x_scale=high - low, loss=self.loss, xtol=tight, ftol=tight, gtol=tight, max_nfev=200,
        )  # fmt: skip
        x = np.asarray(found.x)
        return x, np.concatenate([model.exact_jacobian(x), prior_J]) if last else jacobian(x)


def extent(measured: tuple[Measured, ...]) -> float:
    """Size of what was measured, in units of its errors."""
    parts = [(m.x - (m.x.mean() if m.kind == "signal" else 0.0)) / m.sigma for m in measured]
    values = np.concatenate(parts)
    return float(np.sqrt(values @ values / values.size))
