"""Derivatives of a run with respect to parameters and initial values, at the times of a solution."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from fricmb.errors import FricmbError, SceneError, unknown_name
from fricmb.integrate.problem import Floats
from fricmb.solution._names import Motion, Names

#: What a motion's name ends in where its velocity is meant, as in the columns of a table.
VELOCITY = ".velocity"


@dataclass(frozen=True, kw_only=True)
class Derivatives:
    """Derivatives of a run.

    Attributes
    ----------
    asked : tuple of str
        What ``simulate(sensitivities=...)`` was given.
    columns : tuple of str
        What derivatives are with respect to: all initial values first, where "state" was asked for.
    n_states : int
        Number of those.
    S : (n_t, n_y, n_columns)
        Derivatives of the state y = (q, v, z) at the times of the solution, these times held fixed.
    end : (n_y, n_columns)
        The same at the end of the run.
    event_times : (n_events, n_columns)
        Derivatives of the times of events; ``transversality`` (n_events,).
    unsafe : tuple of int
        Numbers of the events after which derivatives are not sound.
    """

    asked: tuple[str, ...]
    columns: tuple[str, ...]
    n_states: int
    S: Floats
    end: Floats
    event_times: Floats
    transversality: Floats
    unsafe: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        count = len(self.columns)
        fits = self.S.ndim == 3 and self.S.shape[1:] == self.end.shape and self.end.shape[1] == count
        times = self.event_times.shape
        if not fits or times != (self.transversality.size, count) or not 0 <= self.n_states <= count:
            raise FricmbError(f"derivatives of shapes {self.S.shape}, {self.end.shape}, {times} do not fit")
        if not all(type(i) is int and 0 <= i < self.transversality.size for i in self.unsafe):
            raise FricmbError(f"derivatives: unsafe events {self.unsafe} of {self.transversality.size}")

    def column(self, name: str) -> int:
        """Number of a column; UnknownNameError lists those near."""
        if not isinstance(name, str) or name not in self.columns:
            raise unknown_name("sensitivity", name, self.columns)
        return self.columns.index(name)

    @staticmethod
    def known(names: Names) -> list[str]:
        """Names of the signals that have derivatives: motions, their velocities, states of laws."""
        motions = [*names.dofs, *names.motions]
        return [*motions, *(f"{x}{VELOCITY}" for x in motions), *_states(names)]

    def signal(self, names: Names, signal: str, name: str, samples: Any) -> Floats:
        """Derivative (n_t,) of a named signal."""
        S = self.S[:, :, self.column(name)].T
        n = len(names.dofs)
        rate = isinstance(signal, str) and signal.endswith(VELOCITY)
        motion = signal[: -len(VELOCITY)] if rate else signal if isinstance(signal, str) else ""
        if motion in names.dof_index:
            found: Floats = S[names.dof_index[motion] + (n if rate else 0)].copy()
            return found
        if motion in names.motions:
            return _point(names.motions[motion], S, n, rate, samples)
        states = _states(names)
        if isinstance(signal, str) and signal in states:
            return np.array(S[2 * n + states.index(signal)])
        raise unknown_name("signal with derivatives", signal, self.known(names))

    @property
    def monodromy(self) -> Floats:
        """Derivative of the state at the end with respect to that at the start (n_y, n_y)."""
        if not self.n_states:
            raise SceneError('monodromy: simulate with sensitivities="state"')
        return self.end[:, : self.n_states].copy()


def _states(names: Names) -> list[str]:
    return [f"{c}.state.{s}" for c, held in zip(names.contacts, names.states, strict=True) for s in held]


def _point(motion: Motion, S: Floats, n: int, rate: bool, samples: Any) -> Floats:
    """Derivative of a motion that is a function of the degrees of freedom."""
    q, v = S[:n], S[n : 2 * n]
    if not rate:
        found: Floats = motion.coefficient @ q[motion.index]
        if motion.angle >= 0:
            found = found + _turn(motion, samples) * q[motion.angle]
        return found
    found = motion.coefficient @ v[motion.index]
    if motion.angle >= 0:
        angle = samples.q[motion.angle]
        bend = -motion.arm[0] * np.cos(angle) - motion.arm[1] * np.sin(angle)
        found = found + _turn(motion, samples) * v[motion.angle] + bend * samples.v[motion.angle] * q[motion.angle]
    return found


def _turn(motion: Motion, samples: Any) -> Floats:
    """Derivative of a point's place with respect to the angle of its body."""
    angle = samples.q[motion.angle]
    found: Floats = motion.arm[1] * np.cos(angle) - motion.arm[0] * np.sin(angle)
    return found
