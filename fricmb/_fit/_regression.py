"""A start by regression: the motion that was measured, put into the equations of motion, without a run.

Where every degree of freedom was measured, by place, speed or acceleration, the others of these are those of a
smoothing spline, and what the equations leave over, ``M a - f(q, v, t)``, is linear in masses, stiffnesses, dampings
and coefficients of friction; so is a measured force less that of the law.  Least squares on it take no run at all and
have hardly any false minima.  Times at which a contact hardly slips are left out: friction there follows from the
motion.  States of laws are those of steady slip.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.interpolate import BSpline, make_smoothing_spline
from scipy.optimize import least_squares

from fricmb._fit._data import Measured
from fricmb.analysis._forces import forces
from fricmb.analysis.cycles._flow import initial_slots
from fricmb.errors import FricmbError
from fricmb.integrate.problem import Floats, Ints
from fricmb.scene import Scene
from fricmb.system import System, build

#: Times at which the equations are asked, and most samples that a spline is laid through.
_TIMES, _MOST = 240, 1500
#: Slip slower than this part of the fastest counts as rest, either of two: where much is left out the equations hold
#: better, where little is they know of friction at slow slip.  Parts of the data at their ends that are left out.
_RESTS, _ENDS = (0.03, 0.003), 0.02
#: Residuals where the scene cannot have such values.
_FAR = 1e3
#: Starts of the least squares within the bounds.
_STARTS = 4


def regress(
    scene: Scene, names: tuple[str, ...], first: Floats, low: Floats, high: Floats, measured: tuple[Measured, ...],
    offset: frozenset[str],
) -> list[Floats]:  # fmt: skip
    """Values (n_p,) by which what was measured fits the equations best, some of them.

    None where it does not say the whole motion.
    """
    if scene.is_mechanism:
        return []
    try:
        motion = _motion(scene, measured)
        if motion is None:
            return []
        begin = _initial(scene, names, first, low, high, motion)
        problem = Regression(scene=scene, names=names, motion=motion, offsets=tuple(sorted(offset)))
        return [problem.solve(begin, low, high, rest) for rest in _RESTS]
    except (FricmbError, np.linalg.LinAlgError):
        return []


@dataclass(frozen=True, kw_only=True)
class Motion:
    """What was measured as curves: places, speeds and accelerations by degree of freedom, forces by contact.

    ``source``: which measured signal a degree of freedom comes from, and how often it has to be differentiated to give
    the acceleration.
    """

    t: Floats
    q: Mapping[str, Floats]
    v: Mapping[str, Floats]
    a: Mapping[str, Floats]
    forces: Mapping[str, Floats]
    source: Mapping[str, str]
    sizes: Mapping[str, float]


def _smooth(m: Measured) -> BSpline:
    """A curve through samples, as smooth as they say."""
    order = np.argsort(m.t, kind="stable")
    t, x = m.t[order], m.x[order]
    t, places = np.unique(t, return_index=True)
    x = x[places]
    if t.size > _MOST:  # means of as many neighbours
        count = -(-t.size // _MOST)
        n = t.size // count * count
        t, x = t[:n].reshape(-1, count).mean(axis=1), x[:n].reshape(-1, count).mean(axis=1)
    span = float(t[-1] - t[0])
    scaled = make_smoothing_spline((t - t[0]) / span * t.size, x)
    found: BSpline = BSpline(scaled.t / t.size * span + t[0], scaled.c, scaled.k)
    return found


def _motion(scene: Scene, measured: tuple[Measured, ...]) -> Motion | None:
    signals = {m.name: m for m in measured if m.kind == "signal" and m.x.size >= 12}
    kinds = {"": 2, ".velocity": 1, ".acceleration": 0}
    curves: dict[str, BSpline] = {}
    source: dict[str, str] = {}
    for dof in scene.dof_names:
        name = next((dof + kind for kind in kinds if dof + kind in signals), None)
        if name is None:
            return None
        source[dof], curves[dof] = name, _smooth(signals[name])
    used = [signals[name] for name in source.values()]
    forces = {
        name: m
        for name, m in signals.items()
        if name.endswith(".force") and name.removesuffix(".force") in build(scene).contact_names
    }
    used += list(forces.values())
    if not used:
        return None
    begin, end = max(float(m.t.min()) for m in used), min(float(m.t.max()) for m in used)
    t = np.linspace(begin + _ENDS * (end - begin), end - _ENDS * (end - begin), _TIMES)
    start = build(scene).start
    q, v, a = {}, {}, {}
    for i, dof in enumerate(scene.dof_names):
        curve, order = curves[dof], kinds[source[dof].removeprefix(dof)]
        a[dof] = curve.derivative(order)(t) if order else curve(t)
        speed = curve.derivative(order - 1) if order > 1 else curve if order == 1 else curve.antiderivative()
        v[dof] = speed(t) if order else float(start.v[i]) + speed(t) - speed(begin)
        place = curve if order == 2 else speed.antiderivative()
        q[dof] = place(t) if order == 2 else float(start.q[i]) + place(t) - place(begin)
    return Motion(
        t=t, q=q, v=v, a=a, forces={name: _smooth(m)(t) for name, m in forces.items()}, source=source,
        sizes={m.name: float(np.ptp(m.x)) or 1.0 for m in used},
    )  # fmt: skip


def _initial(
    scene: Scene, names: tuple[str, ...], first: Floats, low: Floats, high: Floats, motion: Motion
) -> Floats:
    """The first guess with initial values as they were measured."""
    slots = initial_slots(scene)
    found = first.copy()
    for i, name in enumerate(names):
        if name not in slots:
            continue
        body, _, rest = name.partition(".")
        kind, _, axis = rest.partition(".")
        values = (motion.q if kind == "position" else motion.v).get(f"{body}.{axis}")
        if values is not None and motion.t[0] <= 0.05 * motion.t[-1]:
            found[i] = np.clip(values[0], low[i], high[i])
    return found


@dataclass(frozen=True, kw_only=True)
class Regression:
    """Least squares on what the equations of motion leave over.

    Unknowns are the parameters and the offsets of measured signals.
    """

    scene: Scene
    names: tuple[str, ...]
    motion: Motion
    offsets: tuple[str, ...]

    def solve(self, first: Floats, low: Floats, high: Floats, rest: float) -> Floats:
        """The best of a few descents within the bounds (n_p,); ``rest``: slip, beside the fastest, that is none."""
        kept = self._slips(first, rest)
        n, rng = first.size, np.random.default_rng(0)
        sizes = np.array([self.motion.sizes.get(name, 1.0) for name in self.offsets])
        ends = np.concatenate([low, -10.0 * sizes]), np.concatenate([high, 10.0 * sizes])
        scale = np.concatenate([high - low, sizes])
        best: Any = None
        for i in range(_STARTS):
            p = first if i == 0 else low + (high - low) * rng.random(n)
            begin = np.concatenate([np.clip(p, low + 1e-9 * (high - low), high - 1e-9 * (high - low)), 0.0 * sizes])
            found = least_squares(
                self.residuals, begin, args=(kept,), bounds=ends, x_scale=scale, loss="soft_l1", f_scale=0.1,
                ftol=1e-6, xtol=1e-6, max_nfev=25,
            )  # fmt: skip
            if best is None or found.cost < best.cost:
                best = found
            if best.cost < 1e-4 * found.fun.size:  # the equations hold as well as data of this kind let them
                break
        # what the equations do not see stays as it was guessed
        seen = np.linalg.norm(best.jac, axis=0) * scale
        blind = seen[:n] < 1e-6 * seen.max(initial=0.0)
        return np.where(blind, first, best.x[:n])

    def _system(self, p: Floats) -> System:
        values = dict(zip(self.names, p[: len(self.names)].tolist(), strict=True))
        found: System = build(self.scene.with_parameters(values))
        return found

    def _slips(self, p: Floats, rest: float) -> Ints:
        """Times at which every contact slips, by their places."""
        g = self._forces(self._system(p), {})[2]
        every = np.arange(self.motion.t.size)
        if not g.size:
            return every
        good = (np.abs(g) > rest * np.abs(g).max(axis=1, keepdims=True)).any(axis=0)
        return np.flatnonzero(good) if good.sum() > 4 * p.size else every

    def residuals(self, x: Floats, kept: Ints) -> Floats:
        """What the equations and the measured forces leave over at the times kept, in parts of their size."""
        motion = self.motion
        try:
            system = self._system(x)
        except FricmbError:
            return np.full((len(motion.a) + len(motion.forces)) * len(kept), _FAR)
        offsets = dict(zip(self.offsets, x[len(self.names) :].tolist(), strict=True))
        force, F, _ = self._forces(system, offsets)
        a = self._rows(system, motion.a, offsets, ".acceleration")
        pull, force = (np.asarray(system.problem.linear.M) @ a)[:, kept], force[:, kept]
        # in parts of the forces that balance, whatever they are: else small masses and forces would fit best
        total = np.sqrt((pull**2).mean(axis=1)) + np.sqrt((force**2).mean(axis=1))
        left = [(pull - force) / np.where(total > 0.0, total, 1.0)[:, None]]
        for name, measured in motion.forces.items():
            row = int(system.problem.contacts.row[system.contact_names.index(name.removesuffix(".force"))])
            left.append((F[row, kept] - measured[kept] + offsets.get(name, 0.0))[None] / motion.sizes[name])
        return np.vstack(left).ravel()

    def _rows(self, system: System, curves: Mapping[str, Floats], offsets: Mapping[str, float], kind: str) -> Floats:
        """Curves (n, n_t) in the order of a system, less the offset of the signal that they come from."""
        rows = []
        for dof in system.dof_names:
            off = offsets.get(dof + kind, 0.0) if self.motion.source[dof] == dof + kind else 0.0
            rows.append(curves[dof] - off)
        return np.array(rows).reshape(len(rows), self.motion.t.size)

    def _forces(self, system: System, offsets: Mapping[str, float]) -> tuple[Floats, Floats, Floats]:
        motion = self.motion
        q = self._rows(system, motion.q, offsets, "")
        return forces(system, motion.t, q, self._rows(system, motion.v, offsets, ".velocity"))
