"""Friction parameters from measurements, by least squares on exact derivatives."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, get_args

import numpy as np

from fricmb._calls import answers
from fricmb._fit._data import Measured, numbers, read
from fricmb._fit._model import Model
from fricmb._fit._offsets import checked_offsets
from fricmb._fit._result import Fit
from fricmb._fit._search import Loss, Search
from fricmb._fit._uncertainty import uncertainty
from fricmb._simulate import simulate
from fricmb._simulate._arguments import check_options, check_scene, number
from fricmb._simulate._progress import bar
from fricmb.errors import FricmbError, SceneError, shown, unknown_name
from fricmb.integrate.problem import Floats
from fricmb.scene import Scene

#: Parts of the data that are fitted one after the other where the window grows.
_WINDOWS = (0.06, 0.1, 0.16, 0.25, 0.4, 0.6, 0.8, 1.0)
#: A standard error of more than this part of the distance of the bounds says no more than they do.
_BLIND = 0.5


@answers
def fit(
    scene: Scene,
    data: Any,
    *,
    parameters: Mapping[str, tuple[float, ...]],
    signals: str | Iterable[str] | None = None,
    window: str | float = "grow",
    sigma: float | Mapping[str, Any] | None = None,
    priors: Mapping[str, tuple[float, float]] | None = None,
    offset: bool | str | Iterable[str] = False,
    loss: Loss = "linear",
    starts: int = 6,
    rtol: float = 1e-8,
    progress: bool = True,
    **options: Any,
) -> Fit:
    """Identify parameters of a scene from measured signals, transition times or periods.

    Parameters
    ----------
    scene : Scene
    data : dict, array (n_t, 1 + n_signals) or pandas.DataFrame
        Signals over times by their names in ``sol[name]``, ``{"t": t, "mass.x": x, "sole.force": F}``, an array whose
        first column is the time, or a table with the times as its index or a column "t"; nan: not measured.  In a dict
        also the times of transitions in their order from the start on, ``{"sole.stick": times}`` (kinds as in
        ``sol.events``), and ``"period"``, one or several measured periods of the limit cycle.
    parameters : dict
        Bounds by the names of ``scene.parameters``, ``{"sole.law.mu_s": (1.0, 2.0)}``, or (low, high, first guess);
        without a guess the scene's value if it lies within, else the middle.  Initial values are parameters as well.
    signals : names, optional
        Columns to use; for an array the names of its columns.  Default: all.
    window : "grow", "whole" or float
        A trial run soon gets out of step with the data, and the sum of squares has many minima; "grow" fits the first
        part of the data and goes on from there to all of them.  A number: use the data until that time.
    sigma : float or dict, optional
        Standard errors of the measurements, one for all, or by name a number or (n,).  Default: the same for all values
        of a quantity, found from the residuals; several quantities then count by their extents.
    priors : dict, optional
        Prior knowledge, ``{"sole.law.mu_k": (mean, standard deviation)}``; needs ``sigma``.
    offset : bool or names
        Signals whose zero is not known, True for all: a constant offset of each is found as well (``offsets`` of the
        result).  Load cells drift, and displacements are measured from an arbitrary zero.
    loss : str
        "linear", or one of those of :func:`scipy.optimize.least_squares` that let outliers count less, with ``sigma``.
    starts : int
        Largest number of starts within the bounds, after the first guess: another is tried while all of the data are
        fitted much worse than their first part, which is a false minimum.  Around the best of them further ones are
        tried until several have found nothing better; 1: none of this.
    rtol : float
        Accuracy of the runs.
    progress : bool
        Show a bar on the terminal.
    **options
        As :func:`fricmb.simulate`.

    Returns
    -------
    Fit

    Raises
    ------
    SceneError
        For data, names or bounds that are not accepted.
    IntegrationError
        If a run fails.

    Notes
    -----
    :func:`scipy.optimize.least_squares` within the bounds.  Where measured positions, velocities or accelerations
    determine the whole motion, the fit starts from a regression: the motion, put into the equations, gives masses,
    stiffnesses and friction without a run; the first guess is kept where it explains more.  Derivatives are exact
    through transitions, or finite differences where runs are so short that these are quicker; those of accelerations
    and forces are always finite differences.  The covariance is that of the linearised problem, ``s^2 (J^T J)^-1`` by
    exact derivatives; with ``sigma`` given s is 1.
    """
    check_scene(scene)
    _check_search(loss, starts)
    check_options("fit", options, simulate, "t_end", "t_eval", "parameters", "sensitivities", "rtol", call=fit)
    bounds, first = _bounds(scene, parameters)
    names = tuple(bounds)
    _check_first(scene, dict(zip(names, first.tolist(), strict=True)), bounds)
    measured = read(data, signals, sigma)
    _check(priors, sigma, names)
    model = Model(
        scene=scene, names=names, measured=measured, options={"rtol": rtol, **options},
        offset=checked_offsets(offset, measured), ranges=np.ptp(np.array(list(bounds.values())), axis=1),
    )
    stages = _stages(measured, window, len(names))
    with bar(len(stages), "window", "fit", progress) as stretch:
        search = Search(
            model=model, stages=stages, first=first, bounds=bounds, priors=priors or {}, loss=loss, shown=stretch
        )
        best = search.best(starts)
    result = _result(best.model, model.runs, best.p, best.J, bounds, sigma is not None)
    if best.plausible:
        return result
    return replace(result, notes=(*result.notes, search.doubt(best)))


def _bounds(scene: Scene, parameters: Any) -> tuple[dict[str, tuple[float, float]], Floats]:
    if not isinstance(parameters, Mapping) or not parameters:
        raise SceneError(f"parameters: got {shown(parameters)}; expected a dict of names and bounds (low, high)")
    known, bounds, first = scene.parameters, {}, []
    for name, given in parameters.items():
        if name not in known:
            raise unknown_name("parameter", name, known)
        try:
            low, high, *guess = (float(value) for value in given)
            if not low < high or not np.isfinite([low, high]).all() or len(guess) > 1:
                raise ValueError
        except (TypeError, ValueError, OverflowError):
            raise SceneError(
                f"parameters: {name} has {shown(given)}; expected (low, high) or (low, high, first guess), low < high"
            ) from None
        value = guess[0] if guess else float(known[name])
        inside = low < value < high
        if guess and not inside:
            raise SceneError(f"parameters: the first guess {value:g} of {name} lies outside {low:g} to {high:g}")
        bounds[name] = (low, high)
        first.append(value if inside else 0.5 * (low + high))
    return bounds, np.array(first)


def _check_first(scene: Scene, first: Mapping[str, float], bounds: Mapping[str, tuple[float, float]]) -> None:
    """The scene accepts the first guess; else the bounds are named that it follows from."""
    try:
        scene.with_parameters(dict(first))
    except FricmbError as error:
        # those without which the others are accepted
        guilty = [n for n in first if _accepts(scene, {m: v for m, v in first.items() if m != n})] or list(first)
        told = ", ".join(f"{n}: {bounds[n][0]:g} to {bounds[n][1]:g}, first guess {first[n]:g}" for n in guilty)
        raise SceneError(f"parameters: the scene does not accept the first guess ({told}): {error}") from error


def _accepts(scene: Scene, values: Mapping[str, float]) -> bool:
    try:
        scene.with_parameters(dict(values))
    except FricmbError:
        return False
    return True


def _check_search(loss: Any, starts: Any) -> None:
    if loss not in get_args(Loss):
        raise unknown_name("loss", loss, get_args(Loss))
    if isinstance(starts, bool) or not isinstance(starts, int) or starts < 1:
        raise SceneError(f"starts: got {shown(starts)}; expected a whole number of at least 1")


def _check(priors: Any, sigma: Any, names: tuple[str, ...]) -> None:
    if priors is not None and not isinstance(priors, Mapping):
        raise SceneError(f"priors: got {shown(priors)}; expected a dict of names and (mean, standard deviation > 0)")
    for name, given in (priors or {}).items():
        if name not in names:
            raise unknown_name("parameter in priors", name, names)
        pair = numbers("priors", given, "(mean, standard deviation > 0)")
        if pair.shape != (2,) or not np.isfinite(pair).all() or not pair[1] > 0.0:
            raise SceneError(f"priors: {name} has {shown(given)}; expected (mean, standard deviation > 0)")
    if priors and sigma is None:
        raise SceneError("priors: they can be weighed only against known errors of the data; give sigma=")


def _stages(measured: tuple[Measured, ...], window: Any, n_p: int) -> list[float]:
    """Ends of the windows."""
    t = np.sort(np.concatenate([m.t for m in measured if m.kind != "period"] + [np.zeros(0)]))
    if not t.size or window == "whole":
        return [np.inf]
    if window != "grow":
        return [number("window", window, f'"grow", "whole" or a time of at least {t[0]:g}', lambda end: end >= t[0])]
    begin, end = min(0.0, float(t[0])), float(t[-1])
    ends = [begin + share * (end - begin) for share in _WINDOWS]
    return [*(e for e in ends[:-1] if (t <= e).sum() > n_p), np.inf]


def _result(
    model: Model, runs: int, p: Floats, J: Floats, bounds: Mapping[str, tuple[float, float]], absolute: bool
) -> Fit:
    residuals = model.residuals(p)
    found = uncertainty(J, model.names)
    noise = model.noise(p)
    known = np.isfinite(found.covariance)  # what is not determined is so without noise as well
    covariance = np.where(known, np.where(known, found.covariance, 0.0) * (1.0 if absolute else noise**2), np.inf)
    notes = list(found.notes)
    for name, value, (low, high) in zip(model.names, p.tolist(), bounds.values(), strict=True):
        if min(value - low, high - value) < 1e-6 * (high - low):
            notes.append(f"{name} lies at its bound {low if value - low < high - value else high:g}")
    for name, std, (low, high) in zip(model.names, np.sqrt(np.diag(covariance)).tolist(), bounds.values(), strict=True):
        if _BLIND * (high - low) < std < np.inf:
            notes.append(
                f"{name} is not determined within its bounds: its standard error is {std:.2g}, and they are"
                f" {high - low:g} apart"
            )
    places = np.cumsum([0] + [m.x.size for m in model.measured])
    return Fit(
        values=dict(zip(model.names, p.tolist(), strict=True)),
        std=dict(zip(model.names, np.sqrt(np.diag(covariance)).tolist(), strict=True)),
        covariance=covariance, condition=found.condition, noise=noise, scene=model.with_values(p),
        solution=model.run(p), measured=model.measured, notes=tuple(notes), runs=runs, offsets=dict(model.offsets),
        residuals={
            m.name: residuals[a:b] * m.sigma
            for m, a, b in zip(model.measured, places[:-1], places[1:], strict=True)
        },
    )  # fmt: skip
