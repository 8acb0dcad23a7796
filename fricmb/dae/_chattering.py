"""Chattering: a run that crosses a jump of its equations at every step, and gets no further."""

from __future__ import annotations

import numpy as np

from fricmb.dae._engine import Record
from fricmb.integrate.problem import Floats

#: Steps that are looked at together, and the share of them at which a derivative turns round.
STEPS, SHARE = 300, 0.05
#: Tolerances within which the component stays meanwhile: what moves further is a motion that steps resolve.
STAYS = 10.0
#: Steps to the end, at their present size, that nobody waits for.
TOO_MANY = 1e6
#: Part of the largest derivative of the run by which it has to change to have jumped.
LARGE = 0.5


class Chattering:
    """Looks at accepted steps for components whose derivatives jump to and fro while time stands still.

    Beyond such a point the equations have no solution but one that slides along the jump, which they do not state: no
    error estimate fails, and steps of 1e-9 go on for ever.  How often a derivative turns there depends on how steps
    grow between their rejections (9 to 60 % of steps turned); that the component stays within its tolerance does not.
    """

    def __init__(self, n: int, t0: float, t_end: float) -> None:
        self.t0, self.t_end = t0, t_end
        self.largest = np.zeros(n)
        self._begin(t0)

    def _begin(self, t: float) -> None:
        self.since, self.steps, self.turns = t, 0, np.zeros(self.largest.size, dtype=np.int64)
        self.low, self.high = np.full(self.largest.size, np.inf), np.full(self.largest.size, -np.inf)

    def look(self, record: Record, first: int, atol: Floats, rtol: Floats) -> str:
        """What is wrong, a sentence, by the points from ``first`` on; "" where nothing is."""
        last = record.size - 1
        if last < 1 or first > last:
            return ""
        yp = record.yp[max(first - 1, 0) : record.size]
        self.largest = np.maximum(self.largest, np.abs(yp).max(axis=0))
        turned = (yp[1:] * yp[:-1] < 0.0) & (np.abs(np.diff(yp, axis=0)) > LARGE * self.largest)
        self.turns += turned.sum(axis=0)
        y = record.y[max(first - 1, 0) : record.size]
        self.low, self.high = np.minimum(self.low, y.min(axis=0)), np.maximum(self.high, y.max(axis=0))
        self.steps += last - first + 1
        if self.steps < STEPS:
            return ""
        t, way = float(record.t[last]), abs(float(record.t[last]) - self.since)
        tolerance = atol + rtol * np.abs(record.y[last])
        # what has hardly moved within its tolerance turns round by round-off
        moves = self.largest * abs(t - self.t0) > tolerance
        stays = self.high - self.low <= STAYS * tolerance
        share = np.where(moves & stays, self.turns / self.steps, 0.0)
        worst, steps = int(np.argmax(share)), self.steps
        self._begin(t)
        if share[worst] < SHARE or abs(self.t_end - t) < TOO_MANY * way / steps:
            return ""
        return (
            f"Chattering at t = {t:.10g}: the derivative of y[{worst}] jumps to and fro in {share[worst]:.0%} of"
            f" {steps} steps, which advance by {way:.2g} in all. fun jumps there, from both sides towards y[{worst}] ="
            f" {record.y[last, worst]:.6g}, and no solution goes on but one that stays on the jump: state it there"
            " (an algebraic equation of its own), or smooth the jump."
        )
