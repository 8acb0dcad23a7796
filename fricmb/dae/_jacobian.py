"""The two Jacobians dF/dy and dF/dyp: the user's, or finite differences by groups of columns."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fricmb.dae._function import Residual
from fricmb.dae._matrix import Matrix
from fricmb.errors import ArgumentError
from fricmb.integrate.problem import Floats

ROOT = float(np.sqrt(np.finfo(float).eps))
CUBE_ROOT = float(np.cbrt(np.finfo(float).eps))
CLEAR = 1e4 * float(np.finfo(float).eps)
ROUNDS = 5
#: How often, and by how much, derivatives are moved further at a start, and how far: from 1e-3 on.
FURTHER, WIDER, FURTHEST = 33, 2.0**30, 1e290


class Given:
    """``jac(t, y, yp, *args)`` that returns (dF/dy, dF/dyp)."""

    exact = True

    def __init__(self, jac: Callable[..., Any], args: tuple[Any, ...], matrix: Matrix) -> None:
        self.jac, self.args, self.matrix = jac, args, matrix
        self.central = False
        self.calls = 0

    def evaluate(self, t: float, y: Floats, yp: Floats, f: Floats, c: float, h: float) -> bool:
        """Put both Jacobians into the storage; False if they are not finite."""
        first, second = pair(self.jac(t, y.copy(), yp.copy(), *self.args))
        self.matrix.put(self.matrix.dy, first, "dF/dy")
        self.matrix.put(self.matrix.dyp, second, "dF/dyp")
        return bool(np.isfinite(self.matrix.dy.sum() + self.matrix.dyp.sum()))


def pair(value: Any) -> tuple[Any, Any]:
    """The two matrices that a user's ``jac`` returned."""
    if not isinstance(value, (tuple, list)) or len(value) != 2:
        raise ArgumentError("`jac` must return the pair (dF/dy, dF/dyp).")
    return value[0], value[1]


class Differences:
    """Forward differences; columns of one group cost one evaluation.

    An increment that drowns in the round-off of the equations is made larger, and stays so (``floor``).  dF/dyp is
    constant in most problems: once known, it is evaluated anew only if one evaluation along a direction in which every
    component moves contradicts it.
    """

    exact = False

    def __init__(self, residual: Residual, matrix: Matrix, rtol: Floats, atol: Floats) -> None:
        self.residual, self.matrix = residual, matrix
        self.rtol, self.atol = rtol, atol
        self.floor = np.zeros(residual.n)
        self.entries = [self._entries(columns) for columns in matrix.pattern.groups]
        generator = np.random.default_rng(1)
        self.direction = generator.uniform(0.5, 1.0, residual.n) * generator.choice([-1.0, 1.0], residual.n)
        self.known = False
        self.central = False  # set when Newton's method fails with fresh forward differences
        self.both = False
        self.calls = 0

    def _entries(self, columns: Any) -> tuple[Any, Any, Any, Any]:
        p = self.matrix.pattern
        at = np.concatenate([np.arange(p.start[j], p.start[j + 1]) for j in columns])
        return columns, p.rows[at], self.matrix.columns[at], p.place[at]

    def evaluate(self, t: float, y: Floats, yp: Floats, f: Floats, c: float, h: float) -> bool:
        """Put both Jacobians into the storage; ``f``: the residual; ``c``, ``h``: of the step (0: no step yet)."""
        tolerance = self.atol + self.rtol * np.abs(y)
        self.both = self.central or c == 0.0  # at the start the last digits decide what is algebraic
        root = CUBE_ROOT if self.both else ROOT
        least = np.maximum(root * np.maximum(np.abs(y), np.abs(h * yp)), (1e-1 if self.both else 1e-2) * tolerance)
        side = np.where(h * yp < 0.0, -1.0, 1.0)
        again = c != 0.0 and self.known and self._confirmed(t, y, yp, f, np.abs(c) * tolerance)
        self.known = c != 0.0
        entries = self.entries
        for _ in range(ROUNDS):
            size = np.maximum(least, self.floor)
            if not self._columns(self.matrix.dy, t, y, yp, f, (y + side * size) - y, True, entries):
                return False
            if not again:
                rate = np.maximum(root * np.abs(yp), np.abs(c) * np.maximum(size, tolerance))
                if c == 0.0:
                    rate = 2.0**-10 * np.maximum(np.abs(yp), 1.0)
                if not self._columns(self.matrix.dyp, t, y, yp, f, (yp + rate) - yp, False, entries):
                    return False
                if c == 0.0:
                    self._look_further(t, y, yp, f, rate)
            drowned = self._drowned(y, yp, f, size, c)
            if not len(drowned):
                break
            self.floor[drowned] = 1e3 * size[drowned]
            entries = [self._entries(drowned[k : k + 1]) for k in range(len(drowned))]
        return True

    def _look_further(self, t: float, y: Floats, yp: Floats, f: Floats, rate: Floats) -> None:
        """Move derivatives by more and more where nothing is seen of them: beside terms of 1e15 one of 1 is none.

        What then has no effect at all is algebraic; no unit of its own tells how large a derivative will be.
        """
        m, p = self.matrix, self.matrix.pattern
        left = np.flatnonzero(~self._without_effect(t, y, yp, f))
        for _ in range(FURTHER):
            effect = np.zeros(p.n)
            np.maximum.at(effect, m.columns, np.abs(m.dyp[p.place]) * rate[m.columns] / self._level(y, yp, f)[p.rows])
            left = left[(effect[left] < CLEAR) & (rate[left] < FURTHEST)]
            if not left.size:
                return
            rate = rate.copy()
            rate[left] *= WIDER
            groups = [np.intersect1d(columns, left) for columns in p.groups]
            for columns in (columns for columns in groups if columns.size):
                entries = self._entries(columns)
                before = m.dyp[entries[3]].copy()
                fine = self._columns(m.dyp, t, y, yp, f, rate, False, [entries])
                if not (fine and np.isfinite(m.dyp[entries[3]]).all()):
                    m.dyp[entries[3]] = before
                    left = np.setdiff1d(left, columns)

    def _without_effect(self, t: float, y: Floats, yp: Floats, f: Floats) -> Any:
        """Which derivatives (n,) change no digit of the residual however far they are moved, one group at a time."""
        none, out = np.zeros(len(y), dtype=bool), np.empty_like(f)
        for columns in self.matrix.pattern.groups:
            there = yp.copy()
            there[columns] += FURTHEST
            self.calls += 1
            none[columns] = self.residual(t, y, there, out) and bool((out == f).all())
        return none

    def _drowned(self, y: Floats, yp: Floats, f: Floats, size: Floats, c: float) -> Any:
        """Columns whose largest effect is not well above the round-off of the equations it is in."""
        m, p = self.matrix, self.matrix.pattern
        dy, dyp = m.dy[p.place], m.dyp[p.place]
        level = self._level(y, yp, f)
        effect = np.zeros(p.n)
        np.maximum.at(effect, m.columns, np.abs(dy + c * dyp) * size[m.columns] / level[p.rows])
        self.floor[effect > 1e4 * CLEAR] *= 1e-3
        return np.flatnonzero((effect < CLEAR) & (1e3 * size <= ROOT * np.abs(y).max()))

    def _level(self, y: Floats, yp: Floats, f: Floats) -> Floats:
        """Size of the terms that every equation consists of, as far as the Jacobians show it."""
        m, p = self.matrix, self.matrix.pattern
        terms = np.abs(m.dy[p.place] * y[m.columns]) + np.abs(m.dyp[p.place] * yp[m.columns])
        return np.asarray(np.bincount(p.rows, weights=terms, minlength=p.n) + np.abs(f) + 1e-300)

    def _columns(
        self, values: Floats, t: float, y: Floats, yp: Floats, f: Floats, step: Floats, of_y: bool, entries: Any
    ) -> bool:
        there, out = (y if of_y else yp).copy(), np.empty_like(f)
        for columns, rows, of, place in entries:
            for sign in (1.0, -1.0):  # the other side, if this one is outside the domain
                keep = there[columns]
                there[columns] = keep + sign * step[columns]
                self.calls += 1
                fine = self.residual(t, there, yp, out) if of_y else self.residual(t, y, there, out)
                there[columns] = keep
                if fine:
                    break
            else:
                return False
            values[place] = (out[rows] - f[rows]) / (sign * step[of])
            if self.both:
                self._other_side(values, t, y, yp, out, -sign * step, of_y, (columns, rows, of, place))
        return True

    def _other_side(
        self, values: Floats, t: float, y: Floats, yp: Floats, out: Floats, step: Floats, of_y: bool, entries: Any
    ) -> None:
        """Make the differences of a group central; leave them if the other side is outside the domain."""
        columns, rows, of, place = entries
        there, other = (y if of_y else yp).copy(), np.empty_like(out)
        there[columns] += step[columns]
        self.calls += 1
        if self.residual(t, there, yp, other) if of_y else self.residual(t, y, there, other):
            values[place] = (other[rows] - out[rows]) / (2.0 * step[of])

    def _confirmed(self, t: float, y: Floats, yp: Floats, f: Floats, scale: Floats) -> bool:
        move = self.direction * 1e-2 * np.maximum(np.abs(yp), scale)
        out = np.empty_like(f)
        self.calls += 1
        if not self.residual(t, y, yp + move, out):
            return False
        p, dyp = self.matrix.pattern, self.matrix.dyp
        terms = dyp[p.place] * move[self.matrix.columns]
        expected = np.bincount(p.rows, weights=terms, minlength=p.n)
        scales = np.bincount(p.rows, weights=np.abs(terms), minlength=p.n)
        return bool(np.all(np.abs(out - f - expected) <= 1e-5 * scales + 4e-15 * self._level(y, yp, f)))
