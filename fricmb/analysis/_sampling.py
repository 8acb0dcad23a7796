"""Signals of a solution on uniform times, without aliasing surprises."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from fricmb._calls import answers
from fricmb.analysis._errors import (
    AliasingWarning,
    AnalysisError,
    Floats,
    checked_interval,
    checked_number,
    checked_solution,
)
from fricmb.errors import shown

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: The share of a signal's power above pi/dt from which a warning is given, and that which an automatic dt goes below.
WARNED, ACCEPTED = 1e-3, 1e-5
#: An automatic interval never makes more samples than this.
MOST_SAMPLES = 2**20
_WHO = "uniform"


@dataclass(frozen=True, kw_only=True)
class Samples:
    """A signal on uniform times.

    Attributes
    ----------
    name : str
    t : (n,)
    x : (n,)
    dt : float
    folded : float
        Share of the signal's power, without its mean, that lies above pi/dt and is folded to lower frequencies.
    short : float
        Share of the phases between transitions that are shorter than two samples.
    """

    name: str
    t: Floats
    x: Floats
    dt: float
    folded: float
    short: float


@answers
def uniform(
    sol: Solution, name: str, dt: float | None = None, *, t_start: float | None = None, t_end: float | None = None
) -> Samples:
    """A signal of a solution on uniform times, from its dense output.

    Parameters
    ----------
    sol : Solution
    name : str
        As in ``sol[name]``: "pad.y", "pad.y.acceleration", "lining.force.x", ...
    dt : float, optional
        Sampling interval.  Default: halved until less than 1e-5 of the power lies above pi/dt.
    t_start, t_end : float, optional
        Part of the run; default: all of it.

    Returns
    -------
    Samples

    Warns
    -----
    AliasingWarning
        If more than 1e-3 of the power lies above pi/dt, or half of the phases between transitions are shorter than two
        samples while the signal is one of a contact.

    Raises
    ------
    AnalysisError
        Times outside the run, an interval that leaves fewer than 16 samples.
    UnknownNameError
        For a signal that is not there.
    """
    checked_solution(_WHO, sol)
    begin = sol.t_start if t_start is None else _time("t_start", t_start)
    end = sol.t_end if t_end is None else _time("t_end", t_end)
    if not sol.t_start - 1e-9 <= begin < end <= sol.t_end * (1 + 1e-12) + 1e-9:
        raise AnalysisError(f"{_WHO}: t_start, t_end must lie in {sol.t_start:g} to {sol.t_end:g}; got {begin}, {end}")
    given = dt is not None
    step = _first_interval(sol, begin, end) if dt is None else checked_interval(_WHO, dt)
    if (end - begin) / step < 15:
        raise AnalysisError(f"{_WHO}: dt must leave 16 samples or more in {end - begin:g}; got {shown(dt)}")
    t, x, folded = _sampled(sol, name, begin, end, step)
    while not given and folded > ACCEPTED and 2 * len(t) <= MOST_SAMPLES:
        step /= 2
        t, x, folded = _sampled(sol, name, begin, end, step)
    found = Samples(name=name, t=t, x=x, dt=step, folded=folded, short=_short_phases(sol, begin, end, step))
    _warn(found, name.partition(".")[0] in sol.contact_names)
    return found


def _time(name: str, value: Any) -> float:
    return checked_number(_WHO, name, value, "a finite time", np.isfinite)


def _first_interval(sol: Solution, begin: float, end: float) -> float:
    """Four samples in the shortest period of the structure, at least 1000 in all."""
    omega = max((p.mechanics.fastest() for p in sol.run.pieces), default=0.0)
    step = (end - begin) / 1000
    return min(step, np.pi / (2 * omega)) if omega > 0.0 else step


def _sampled(sol: Solution, name: str, begin: float, end: float, dt: float) -> tuple[Floats, Floats, float]:
    """Times, values and the share of power above pi/dt, which four times as many samples show."""
    count = int((end - begin) / dt * (1 + 1e-12)) + 1
    t = begin + dt * np.arange(count)
    fine = begin + 0.25 * dt * np.arange(4 * (count - 1) + 1)
    values = signal_of(sol, name, np.minimum(fine, end))
    return np.minimum(t, end), values[::4].copy(), _share_above(values)


def _share_above(fine: Floats) -> float:
    """Share of the power at frequencies above a quarter of the largest, under a window."""
    centred = fine - fine.mean()
    power = np.abs(np.fft.rfft(centred * np.hanning(len(fine)))) ** 2
    total = float(power.sum())
    return float(power[len(power) // 4 + 1 :].sum()) / total if total > 0.0 else 0.0


def signal_of(sol: Solution, name: str, t: Floats) -> Floats:
    """A signal at given times."""
    return np.asarray(sol.at(t).scalar(name, _WHO), dtype=float)


def _short_phases(sol: Solution, begin: float, end: float, dt: float) -> float:
    """Share of the phases of all contacts between two transitions that are shorter than two samples."""
    lengths = []
    for contact in sol.contact_names:
        times = sol.events.of(contact=contact).t
        lengths.append(np.diff(times[(times >= begin) & (times <= end)]))
    spans = np.concatenate(lengths) if lengths else np.zeros(0)
    return float(np.mean(spans < 2 * dt)) if spans.size else 0.0


def _warn(found: Samples, of_contact: bool) -> None:
    """Say what the samples cannot show."""
    if found.folded > WARNED:
        warnings.warn(
            f"{found.name}: {100 * found.folded:.2g} % of its power lies above pi/dt = {np.pi / found.dt:.4g} and"
            " appears at lower frequencies; take a smaller dt",
            AliasingWarning,
            stacklevel=4,
        )
    elif of_contact and found.short > 0.5:
        warnings.warn(
            f"{found.name}: {100 * found.short:.0f} % of the phases between transitions are shorter than two samples"
            f" (dt = {found.dt:.4g}); take a smaller dt",
            AliasingWarning,
            stacklevel=4,
        )
