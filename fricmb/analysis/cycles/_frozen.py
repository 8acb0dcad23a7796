"""Orbits whose sequence of phases is given: smooth where it changes, so that a border of a branch is solved directly.

Between two transitions the modes are held (:class:`Field`), and how long each phase lasts is an unknown beside the
state at the start and the parameter; every transition is an equation.  The orbits of one sequence then depend smoothly
on the unknowns also where a phase has the length 0 or a slip speed touches 0; a run that finds its own transitions does
not.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.integrate import solve_ivp

from fricmb.analysis._errors import Floats
from fricmb.analysis.cycles._drive import DrivePeriod
from fricmb.analysis.cycles._field import Field
from fricmb.integrate import STICK
from fricmb.integrate.problem import Codes
from fricmb.system import System, build

if TYPE_CHECKING:
    from fricmb.scene import Scene

_RTOL = 1e-13
_MOST_STEPS = 25


@dataclass(frozen=True, kw_only=True)
class Condition:
    """What holds at an instant for one contact in one dimension.

    ``kind``: "stop" (relative velocity 0), "turn" (its rate 0 in slip), "arrival" (its rate 0 in the slip that ends the
    lap) or "release" (the force that keeps it stuck, in the direction ``sign``, is all that it can).
    """

    kind: str
    contact: int
    sign: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Phase:
    """A stretch with held modes (n_c,) and directions of slip (m,), and what ends it; None: the end of the lap."""

    mode: Codes
    direction: Floats
    end: Condition | None


@dataclass(frozen=True, kw_only=True)
class Frozen:
    """The equations of orbits of one sequence of phases over one parameter.

    Unknowns: state at the start, length of each phase, parameter, and the time of the start where the scene is driven;
    each in units of its ``scale``.
    """

    scene: Scene
    over: str
    phases: tuple[Phase, ...]
    start: tuple[Condition, ...]
    drive: DrivePeriod | None
    y_scale: Floats
    T_scale: float
    p_scale: float

    def pack(self, y: Floats, lengths: Floats, p: float, t_start: float) -> Floats:
        """Unknowns from their values."""
        last = [p / self.p_scale] if self.drive is None else [p / self.p_scale, t_start / self.T_scale]
        return np.concatenate([y / self.y_scale, np.asarray(lengths) / self.T_scale, np.array(last)])

    def unpack(self, u: Floats) -> tuple[Floats, Floats, float, float]:
        """State at the start, lengths of the phases, parameter and time of the start."""
        n, k = self.y_scale.size, len(self.phases)
        t = float(u[n + k + 1]) * self.T_scale if self.drive is not None else 0.0
        return u[:n] * self.y_scale, u[n : n + k] * self.T_scale, float(u[n + k]) * self.p_scale, t

    def system(self, p: float) -> System:
        """The arrays of the scene at a value of the parameter."""
        return build(self.scene.with_parameters({self.over: p}))

    def residual(self, u: Floats) -> Floats:
        """All equations: conditions at the start, at the end of each phase, closure, and the drive's period."""
        return self._residuals(u[:, None])[:, 0]

    def jacobian(self, u: Floats) -> Floats:
        """Central differences of the residual; neighbours with one value of the parameter are integrated together."""
        h, place = 1e-5, self.y_scale.size + len(self.phases)
        others = np.delete(np.eye(u.size), place, axis=0)
        found = self._residuals(u[:, None] + h * np.concatenate([others, -others]).T)
        J = np.empty((len(found), u.size))
        J[:, np.arange(u.size) != place] = (found[:, : len(others)] - found[:, len(others) :]) / (2.0 * h)
        e = np.eye(u.size)[place]
        J[:, place] = (self.residual(u + h * e) - self.residual(u - h * e)) / (2.0 * h)
        return J

    def _residuals(self, u: Floats) -> Floats:
        """Of many unknowns (n_u, k) with one value of the parameter."""
        n, count = self.y_scale.size, len(self.phases)
        p = float(u[n + count, 0]) * self.p_scale
        system = self.system(p)
        y, lengths = u[:n] * self.y_scale[:, None], u[n : n + count] * self.T_scale
        t = u[n + count + 1] * self.T_scale if self.drive is not None else np.zeros(u.shape[1])
        found = [self.value(system, condition, self.phases[0], t, y) for condition in self.start]
        end = y
        for phase, length in zip(self.phases, lengths, strict=True):
            end = self.advance(system, phase, t, end, length)
            t = t + length
            if phase.end is not None:
                found.append(self.value(system, phase.end, phase, t, end))
        found += list((end - y) / self.y_scale[:, None])
        if self.drive is not None:
            values = self.scene.with_parameters({self.over: p}).parameters
            found.append((lengths.sum(axis=0) - self.drive.value(values)) / self.T_scale)
        return np.array(found)

    def advance(self, system: System, phase: Phase, t: Floats, y: Floats, length: Floats) -> Floats:
        """States (n_y, k) after a phase of lengths (k,), each in its own time stretched to 0 to 1."""
        if not length.any():
            return y
        field, shape = Field(system=system, mode=phase.mode, direction=phase.direction), y.shape

        def rate(s: float, flat: Floats) -> Floats:
            return (length * field(t + s * length, flat.reshape(shape))).ravel()

        atol = np.repeat(1e-3 * _RTOL * self.y_scale, shape[1])
        run = solve_ivp(rate, (0.0, 1.0), y.ravel(), method="DOP853", rtol=_RTOL, atol=atol)
        return np.asarray(run.y[:, -1]).reshape(shape)

    def value(self, system: System, condition: Condition, phase: Phase, t: Floats, y: Floats) -> Floats:
        """By how much a condition is missed (k,), made comparable; for "release" negative while the contact holds."""
        k = condition.contact
        row, n = int(system.problem.contacts.row[k]), system.problem.n
        speed = float(np.abs(system.problem.contacts.W[:, row]) @ self.y_scale[n : 2 * n])
        if condition.kind == "arrival":
            phase = self.phases[-1]
        mode = phase.mode.copy()
        if condition.kind == "release":
            mode[k] = STICK
        field = Field(system=system, mode=mode, direction=phase.direction)
        if condition.kind == "stop":
            return np.asarray(field.slip(t, y)[row] / speed)
        if condition.kind in ("turn", "arrival"):
            return np.asarray(field.turning(t, y)[row] * self.T_scale / speed)
        most = field.break_away(t, y, k)
        return np.asarray((condition.sign * field.rate_and_force(t, y)[1][row] - most) / most)

    def missed(self, condition: Condition, u: Floats) -> float:
        """By how much a condition is missed at the start of an orbit."""
        y, _, p, t = self.unpack(u)
        return float(self.value(self.system(p), condition, self.phases[0], np.array([t]), y[:, None])[0])


@dataclass(frozen=True, kw_only=True)
class Found:
    """A solution of frozen equations: unknowns, Jacobian, and the largest equation's miss."""

    u: Floats
    jacobian: Floats
    residual: float


def newton(frozen: Frozen, u: Floats, *, goal: float = 1e-8) -> Found | None:
    """Newton's method, to round-off; for more unknowns than equations the solution nearest by.  None: not found."""
    residual, J, fresh = frozen.residual(u), frozen.jacobian(u), True
    for _ in range(_MOST_STEPS):
        step = np.asarray(-np.linalg.lstsq(J, residual, rcond=1e-12)[0])
        before = float(np.abs(residual).max())
        if not np.isfinite(step).all() or np.abs(step).max() > 1.0:
            return None
        tried = frozen.residual(u + step)
        size = float(np.abs(tried).max())
        if not np.isfinite(size) or size > 2.0 * before + 1e-11:
            return None
        if size > 0.5 * before and fresh:
            break  # as near as round-off lets it
        if size < before:
            u, residual = u + step, tried
        if size < 1e-14:
            break
        fresh = False
        if size > 0.1 * before and size > 1e-12:
            J, fresh = frozen.jacobian(u), True
        elif size > 0.1 * before:
            break
    size = float(np.abs(residual).max())
    return Found(u=u, jacobian=J, residual=size) if size < goal else None
