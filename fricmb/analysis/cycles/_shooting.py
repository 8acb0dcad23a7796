"""Cycles as fixed points: Newton's method on the state at a section and the period, with the flow's own derivatives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from fricmb.analysis._errors import AnalysisError, Floats
from fricmb.analysis.cycles._drive import DrivePeriod
from fricmb.analysis.cycles._field import Field, stuck_rows
from fricmb.analysis.cycles._flow import Arc, Flow
from fricmb.analysis.cycles._section import Section
from fricmb.system import System, build

if TYPE_CHECKING:
    from fricmb.solution import Names, Solution

_MOST_STEPS = 30
#: A step of Newton's method is halved this often before it is given up.
_HALVINGS = 6


@dataclass(frozen=True, kw_only=True)
class Shooting:
    """The equations of a cycle: ``end(y, T; p) = y``, and where no drive fixes the phase one condition on y.

    Attributes
    ----------
    flow : Flow
    names : Names
    phase : float
        Where in the drive's period the section is, 0 to 1; 0 where there is no drive.
    drive : DrivePeriod or None
    section : Section or None
        What fixes the phase; None: ``normal . (y - anchor) = 0``.
    anchor, normal : (n_y,)
    scale : (n_y,)
        Extent of each state over the cycle.
    """

    flow: Flow
    names: Names
    phase: float
    drive: DrivePeriod | None
    section: Section | None
    anchor: Floats
    normal: Floats
    scale: Floats

    @property
    def system(self) -> System:
        """The arrays of the scene, which keeps them."""
        return build(self.flow.scene)

    @property
    def t_start(self) -> float:
        """Time of the section."""
        return self.phase * self.period(0.0)

    def with_values(self, values: Mapping[str, float]) -> Shooting:
        """The same cycle's equations for other values of parameters."""
        return replace(self, flow=self.flow.with_values(values))

    def period(self, guess: float) -> float:
        """The period that a drive gives, else the guess."""
        return guess if self.drive is None else self.drive.value(self.flow.scene.parameters)

    def orbit(self, y: Floats, T: float, by: Sequence[str] = ()) -> Orbit:
        """One lap from a state."""
        arc = self.flow.arc(y, self.t_start, self.t_start + T, self.names, by)
        return Orbit(shooting=self, y=y, T=T, arc=arc)

    def anchored(self, y: Floats, sol: Solution) -> Shooting:
        """With the phase fixed at a state, across the motion there."""
        rate = rate_at(self.system, sol, self.t_start, y, start=True)
        return replace(self, anchor=y, normal=rate / self.scale**2)

    def phase_row(self) -> Floats:
        """Derivative (n_y,) of the condition on the phase."""
        if self.section is None:
            return self.normal / max(float(np.linalg.norm(self.normal * self.scale)), 1e-300)
        row = np.zeros(self.scale.size)
        row[self.section.index] = 1.0 / self.scale[self.section.index]
        return row

    def phase_residual(self, y: Floats) -> float:
        """How far a state is from the section."""
        if self.section is None:
            return float(self.phase_row() @ (y - self.anchor))
        return float((y[self.section.index] - self.section.value) / self.scale[self.section.index])

    def onto_belt(self, y: Floats, sticks: Sequence[int]) -> Floats:
        """A state moved so that rows which stick do so at the present values."""
        if not len(sticks):
            return y
        field = Field(system=self.system, mode=np.zeros(self.system.problem.n_c, np.int8), direction=np.zeros(0))
        moved = y.copy()
        n, W = self.system.problem.n, self.system.problem.contacts.W[:, sticks]
        moved[n : 2 * n] -= np.linalg.pinv(W.T) @ field.slip(np.array([self.t_start]), y[:, None])[sticks, 0]
        return moved


@dataclass(frozen=True, kw_only=True)
class Orbit:
    """One lap: from a state at the section, for a period."""

    shooting: Shooting
    y: Floats
    T: float
    arc: Arc

    @cached_property
    def residual(self) -> Floats:
        """How far the lap misses its start, in units of the cycle's extent; the phase last where it is free."""
        off = (self.arc.end - self.y) / self.shooting.scale
        return off if self.shooting.drive is not None else np.append(off, self.shooting.phase_residual(self.y))

    @cached_property
    def miss(self) -> float:
        """The largest of these."""
        return float(np.abs(self.residual).max())

    @cached_property
    def sticks(self) -> tuple[int, ...]:
        """Rows of contacts that stick at the section."""
        mode = self.arc.solution.at([self.arc.solution.t_start]).record.samples.mode[:, 0]
        return tuple(stuck_rows(self.shooting.system, mode).tolist())

    @cached_property
    def tangent(self) -> Floats:
        """Directions (n_y, k) in which the start may be varied: all, less those in which stuck contacts would slip."""
        s, n = self.shooting.scale, self.shooting.system.problem.n
        if not self.sticks:
            return np.diag(s)
        held = np.zeros((len(self.sticks), s.size))
        held[:, n : 2 * n] = self.shooting.system.problem.contacts.W[:, list(self.sticks)].T
        _, size, right = np.linalg.svd(held * s)
        rank = int((size > 1e-12 * size[0]).sum())
        return np.asarray(s[:, None] * right[rank:].T)

    @cached_property
    def rate(self) -> Floats:
        """Rate of the state at the end of the lap."""
        end = self.shooting.t_start + self.T
        return rate_at(self.shooting.system, self.arc.solution, end, self.arc.end, start=False)

    @cached_property
    def first_rate(self) -> Floats:
        """Rate of the state at the section."""
        return rate_at(self.shooting.system, self.arc.solution, self.shooting.t_start, self.y, start=True)

    @cached_property
    def matrix(self) -> Floats:
        """Derivative of the residual by the start along its tangent directions, and by the period where it is free."""
        shooting, s = self.shooting, self.shooting.scale[:, None]
        by_start = (self.arc.by_state @ self.tangent - self.tangent) / s
        if shooting.drive is not None:
            return by_start
        rows = np.vstack([by_start, shooting.phase_row() @ self.tangent])
        return np.hstack([rows, np.append(self.rate / shooting.scale, 0.0)[:, None]])

    def column(self, name: str) -> Floats:
        """Derivative of the residual by a parameter."""
        shooting, s = self.shooting, self.shooting.scale
        shift = self.belt_shift(name)
        d = self.arc.by[name] + self.arc.by_state @ shift - shift
        if shooting.drive is None:
            return np.append(d / s, shooting.phase_row() @ shift)
        slope = shooting.drive.slope(name, shooting.flow.scene.parameters)
        if slope:  # the section moves with the period, and so does its end
            d = d + slope * ((1.0 + shooting.phase) * self.rate - shooting.phase * self.arc.by_state @ self.first_rate)
        return np.asarray(d / s)

    def belt_shift(self, name: str) -> Floats:
        """How a start whose contacts stick moves with a parameter that moves what they stick to."""
        y = np.zeros(self.y.size)
        if not self.sticks:
            return y
        shooting = self.shooting
        value = float(shooting.flow.scene.parameters[name])
        h = 1e-4 * max(abs(value), 1e-2)
        there = [shooting.with_values({name: value + side * h}).onto_belt(self.y, self.sticks) for side in (1.0, -1.0)]
        return np.asarray((there[0] - there[1]) / (2.0 * h))

    def after_step(self, step: Floats) -> tuple[Floats, float]:
        """Start and period after a step along the columns of ``matrix``."""
        k = self.tangent.shape[1]
        return self.y + self.tangent @ step[:k], self.T + (float(step[k]) if step.size > k else 0.0)

    @cached_property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers, the one of the free phase left out, largest first; complex."""
        B = self.tangent
        reduced = np.linalg.lstsq(B, self.arc.by_state @ B, rcond=None)[0]
        if self.shooting.drive is None:
            along = np.linalg.lstsq(B, self.rate, rcond=None)[0]
            along /= np.linalg.norm(along)
            across = np.linalg.svd(along[None])[2][1:].T
            reduced = across.T @ reduced @ across
        found = np.linalg.eigvals(reduced).astype(np.complex128)
        return found[np.argsort(-np.abs(found), kind="stable")]


def rate_at(system: System, sol: Solution, t: float, y: Floats, *, start: bool) -> Floats:
    """Rate of the state at an end of a run, in the modes that its contacts have there."""
    at = sol.at([sol.t_start if start else sol.t_end]).record.samples
    return Field(system=system, mode=at.mode[:, 0], direction=np.sign(at.g[:, 0]))(np.array([t]), y[:, None])[:, 0]


def solve(first: Orbit, rtol: float, who: str) -> Orbit:
    """Newton's method from an orbit that nearly closes.

    Raises
    ------
    AnalysisError
        If it does not converge; says how far it came.
    """
    orbit, goal = first, max(1e-13, 1e-3 * rtol)
    for _ in range(_MOST_STEPS):
        if orbit.miss <= goal:
            return orbit
        step = np.asarray(-np.linalg.lstsq(orbit.matrix, orbit.residual, rcond=None)[0])
        better = _damped(orbit, step)
        if better is None or (better.miss > 0.5 * orbit.miss and better.miss < 1e3 * rtol):
            break
        orbit = better
    if better is not None and better.miss < orbit.miss:
        orbit = better
    if orbit.miss < 1e3 * rtol:
        return orbit  # as far as the accuracy of the runs goes
    raise AnalysisError(
        f"{who}: no cycle found; the best lap misses its start by {orbit.miss:.2g} of the motion's extent after a"
        f" period of {orbit.T:.10g}; start from a run that is nearer to the cycle"
    )


def _damped(orbit: Orbit, step: Floats) -> Orbit | None:
    """The orbit after a step, or after a part of it that misses less than before."""
    for halving in range(_HALVINGS):
        y, T = orbit.after_step(step * 0.5**halving)
        if T <= 0.0 or not np.isfinite(y).all():
            continue
        tried = orbit.shooting.orbit(y, T)
        if tried.miss < orbit.miss or (halving == 0 and tried.miss < 1e-9):
            return tried
    return None
