"""Errors of a run, each kind apart from the others."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricmb.bench._reference import Bools, Floats, Reference
from fricmb.bench._run import Run
from fricmb.bench._transitions import compare


@dataclass(frozen=True, kw_only=True)
class Metrics:
    """What is wrong with a run; None where the reference or the method cannot say.

    Attributes
    ----------
    state : float
        Largest error of a position or velocity over the grid, each signal scaled by its largest value.
    grown : float
        The same with the error at each time divided by the problem's own growth of errors until then.
    time : float or None
        Largest error of a transition's time, over the duration of the run.
    missed, false : int or None
        Transitions of the reference that the run lacks; of the run that the reference lacks.
    force : float or None
        Largest error of the contact force in the middle of stick, over the largest force.
    creep : float or None
        Largest relative velocity in the middle of stick, over the largest relative velocity.
    energy : float or None
        Largest residual of the energy balance, over its largest term.
    """

    state: float
    grown: float
    time: float | None = None
    missed: int | None = None
    false: int | None = None
    force: float | None = None
    creep: float | None = None
    energy: float | None = None


def measure(run: Run, reference: Reference, rows: tuple[int, ...]) -> Metrics:
    """All errors of a run.

    ``rows``: number of rows of each contact, in order.

    Raises
    ------
    ValueError
        For a run whose arrays have other shapes than the reference's.
    """
    state = _state(run, reference)
    stuck = np.repeat(reference.stuck(len(rows)), rows, axis=0)
    found = None
    if reference.transitions is not None and run.transitions is not None:
        found = compare(run.transitions, reference.transitions, float(reference.t[-1] - reference.t[0]))
    return Metrics(
        state=float(state.max()),
        grown=float((state / reference.growth).max()),
        time=None if found is None or found.late is None else found.late / float(reference.t[-1] - reference.t[0]),
        missed=None if found is None else found.missed,
        false=None if found is None else found.false,
        force=_force(run, reference, stuck),
        creep=_creep(run, stuck),
        energy=run.energy,
    )


def _state(run: Run, reference: Reference) -> Floats:
    """Largest scaled error at each time (n_t,); not-a-number in the run is an error without bound."""
    worst = np.zeros(len(reference.t))
    q_scale, v_scale = reference.scales
    for got, true, size in ((run.q, reference.q, q_scale), (run.v, reference.v, v_scale)):
        if got.shape != true.shape:
            raise ValueError(f"a run of shape {got.shape} beside a reference of shape {true.shape}")
        error = np.abs(got - true) / size[:, None]
        error[np.isnan(got)] = np.inf
        error[np.isnan(true)] = 0.0
        worst = np.maximum(worst, error.max(axis=0))
    return worst


def _force(run: Run, reference: Reference, stuck: Bools) -> float | None:
    if run.F is None or reference.F is None or not stuck.any():
        return None
    error = np.abs(run.F - reference.F)[stuck] / np.abs(reference.F).max()
    return float(np.where(np.isnan(error), np.inf, error).max())


def _creep(run: Run, stuck: Bools) -> float | None:
    if run.g is None or not stuck.any():
        return None
    speed = np.abs(run.g)
    largest = float(speed.max())
    return float(speed[stuck].max()) / largest if largest > 0.0 else 0.0
