"""A growing mode in a run: its rate and frequency beside those of the eigenvalue."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.linalg

from fricmb._simulate import simulate
from fricmb.analysis import SteadySliding
from fricmb.squeal._place import Complexes, Floats

if TYPE_CHECKING:
    from fricmb.solution import Solution

#: Speed of the vibration at the end of the run, in parts of the speed of slip: what is not linear stays that small.
_SMALL = 1e-5
#: By how much the mode grows, as a power of e, and how many of its periods that may take at least and at most.
_POWERS, _LEAST, _MOST = 3.0, 8, 80
#: Samples in a period.
_SAMPLES = 24


@dataclass(frozen=True, kw_only=True)
class Growth:
    """Growth of a mode in a run that starts with a small push along it.

    Attributes
    ----------
    at : dict of str to float
        Values of the parameters.
    eigenvalue : complex
        Predicted growth rate and angular frequency.
    measured : complex
        Those found in the run, which knows nothing of eigenvalues: slopes of the logarithm of the mode's share of the
        motion.
    solution : Solution
    t, share : (n_t,)
        Times, and the size of the mode's share, 1 at the start.
    """

    at: Mapping[str, float]
    eigenvalue: complex
    measured: complex
    solution: Solution
    t: Floats
    share: Floats

    @property
    def difference(self) -> float:
        """Difference of the growth rates, relative to that of the eigenvalue."""
        return abs(self.measured.real / self.eigenvalue.real - 1.0) if self.eigenvalue.real else np.inf

    def __str__(self) -> str:
        return (
            f"growth rate {self.measured.real:.6g} in the run, {self.eigenvalue.real:.6g} by the eigenvalue; angular"
            f" frequency {self.measured.imag:.8g} and {self.eigenvalue.imag:.8g}"
        )


def growth(steady: SteadySliding, at: Mapping[str, float], near: complex, options: Mapping[str, Any]) -> Growth:
    """Run a scene from steady sliding with a small push along the mode next to ``near``."""
    system: Any = scipy.linalg.eig(steady.matrix(), left=True, right=True)
    values, left, right = system
    k = int(np.argmin(np.abs(values - near)))
    value, x, y = complex(values[k]), right[:, k], left[:, k]
    times = _times(value)
    size = _SMALL * _room(steady, x) * float(np.exp(-max(value.real, 0.0) * times[-1]))
    sol = simulate(
        steady.scene, t_end=float(times[-1]), t_eval=times, initial=pushed(steady, size * x),
        **{"rtol": 1e-9, "atol": 1e-9 * size * float(np.abs(x).min(where=np.abs(x) > 0.0, initial=1.0)), **options},
    )  # fmt: skip
    part = y.conj() @ _off(steady, sol) / np.vdot(y, x) / size
    turns = np.unwrap(np.angle(part))
    measured = complex(np.polyfit(times, np.log(np.abs(part)), 1)[0], np.polyfit(times, turns, 1)[0])
    return Growth(at=dict(at), eigenvalue=value, measured=measured, solution=sol, t=times, share=np.abs(part))


def _times(value: complex) -> Floats:
    """Times of the run, from 0 on."""
    end = _POWERS / abs(value.real) if value.real else np.inf
    if not value.imag:
        return np.linspace(0.0, end, 200)
    period = 2.0 * np.pi / abs(value.imag)
    laps = float(np.clip(end / period, _LEAST, _MOST))
    return np.linspace(0.0, laps * period, int(np.ceil(laps * _SAMPLES)) + 1)


def _room(steady: SteadySliding, x: Complexes) -> float:
    """Size of a vector of the state at which the vibration is as fast as some contact slips."""
    free, contacts = steady.free, steady.system.problem.contacts
    speed = contacts.W[free].T @ x[free.size : 2 * free.size]
    rows = contacts.row
    swing = [float(np.linalg.norm(speed[rows[k] : rows[k + 1]])) for k in range(len(steady.at.r))]
    room = [r / s for r, s in zip(steady.at.r.tolist(), swing, strict=True) if s > 0.0 and r > 0.0]
    return min(room, default=1.0)


def pushed(steady: SteadySliding, y: Complexes) -> dict[str, dict[str, Any]]:
    """The state of steady sliding with the real part of a vector (q, v, z) of the free motions added."""
    state: dict[str, dict[str, Any]] = {**steady.initial()}
    free = steady.free
    names = [steady.system.dof_names[i] for i in free]
    for i, name in enumerate(names):
        state["position"][name] += float(y[i].real)
        state["velocity"][name] += float(y[free.size + i].real)
    if "state" in state:
        z, starts = y[2 * free.size :].real, steady.system.problem.contacts.z_start
        for k, name in enumerate(steady.system.contact_names):
            if name in state["state"]:
                state["state"][name] = state["state"][name] + z[starts[k] : starts[k + 1]]
    return state


def _off(steady: SteadySliding, sol: Solution) -> Floats:
    """How far the state (q, v, z) of the free motions is off steady sliding (n_y, n_t)."""
    names = [steady.system.dof_names[i] for i in steady.free]
    q = [sol[name] - steady.q[i] - steady.v[i] * sol.t for name, i in zip(names, steady.free, strict=True)]
    v = [sol.velocity(name) - steady.v[i] for name, i in zip(names, steady.free, strict=True)]
    starts = steady.system.problem.contacts.z_start
    z = [
        sol.state(name) - steady.z[starts[k] : starts[k + 1], None]
        for k, name in enumerate(steady.system.contact_names)
        if starts[k + 1] > starts[k]
    ]
    return np.vstack([*q, *v, *z])
