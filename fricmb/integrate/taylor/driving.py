"""Where friction under a law of slip speed drives instead of braking: its coefficient has become negative.

Steps are as long as the structure bears, up to half a swing.  Slip may be too fast for a law's formula between their
ends alone, so that the motion is looked at between them; but only where the law was negative at any speed for which a
curve was made of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate.problem import LAW_COEFFICIENT, Floats, Problem, Start
from fricmb.integrate.trajectory import MotionSamples, Trajectory

#: Places in a step that are looked at: of half a swing, the fastest slip is missed by 0.2 % at most.
PLACES = 24
#: Numbers that are sampled at a time.
NUMBERS = 1_000_000
#: What counts as round-off: power of friction beside the largest of its contact, and speed beside the largest.
POWER, SPEED = 1e-9, 1e-12


@dataclass(frozen=True)
class Driving:
    """``end``: the run where friction of contact ``contact`` ceases to brake."""

    contact: int
    end: Start


def find_driving(problem: Problem, run: Trajectory, steps: Floats, rtol: float) -> Driving | None:
    """Where friction drives for the first time in a run of steps (time, length), or None."""
    block = max(1, NUMBERS // (PLACES * (2 * problem.n + 4 * problem.m)))
    largest = np.zeros(problem.n_c)
    before = run.ends[0]
    for first in range(0, len(steps), block):
        begin, length = steps[first : first + block].T
        t = (begin[:, None] + length[:, None] * np.arange(1, PLACES + 1) / PLACES).ravel().clip(max=run.ends[1])
        samples = run.motion(t)
        power = _power(problem, samples)
        largest = np.maximum(largest, np.abs(power).max(axis=1))
        noise = SPEED * np.abs(samples.v).max(initial=0.0) * np.abs(samples.F).max(initial=0.0)
        wrong = power > (max(POWER, rtol) * largest + noise)[:, None]
        if wrong.any():
            i = int(np.argmax(wrong.any(axis=0)))
            contact = int(np.argmax(wrong[:, i]))
            return Driving(contact, _last(problem, run, contact, t[i - 1] if i else before, float(t[i])))
        before = float(t[-1])
    return None


def _power(problem: Problem, samples: MotionSamples) -> NDArray[np.float64]:
    """Power of friction (n_c, n_t) of contacts under laws of slip speed; 0 of others."""
    row = problem.contacts.row[:-1]
    power = np.asarray(np.add.reduceat(samples.F * samples.g, row, axis=0), dtype=float)
    power[problem.contacts.law != LAW_COEFFICIENT] = 0.0
    return power


def _last(problem: Problem, run: Trajectory, contact: int, good: float, bad: float) -> Start:
    """The state at the last time between two at which friction brakes."""
    while good < (middle := 0.5 * (good + bad)) < bad:
        if _power(problem, run.motion(np.array([middle])))[contact, 0] > 0.0:
            bad = middle
        else:
            good = middle
    found = run.motion(np.array([good]))
    return Start(
        t=good, q=found.q[:, 0].copy(), v=found.v[:, 0].copy(), z=np.zeros(0), mode=found.mode[:, 0].copy(),
        direction=np.sign(found.g[:, 0]),
    )  # fmt: skip
