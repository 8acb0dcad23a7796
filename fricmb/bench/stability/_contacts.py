"""Extremes of contact: loss of contact, starts at rest, marginal stick, grazing, chatter, close passes, long runs."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
import sympy

import fricmb as fm
from fricmb import models
from fricmb.bench._closed import free_oscillator
from fricmb.bench.stability._extreme import Extreme, same_times, scaled
from fricmb.bench.stability._structures import belt, belt_times
from fricmb.solution import Solution


def lifted() -> fm.Scene:
    """A sliding mass under the normal force max(0, cos t): contact is lost and comes back."""
    body = fm.Body("mass", mass=1.0, velocity={"x": 10.0})
    law = fm.laws.Coulomb(mu_s=0.5)
    return fm.Scene("lifted", [body, fm.Contact("sole", body, law=law, normal_force=sympy.cos(fm.t))])


def _lifts(sol: Solution) -> float:
    """V = 10 - 0.5 int max(0, cos): sin t until it opens, two more after every closed half period."""
    cycle, phase = np.divmod(np.asarray(sol.t) + math.pi / 2, 2.0 * math.pi)
    impulse = 2.0 * cycle + np.where(phase < math.pi, 1.0 - np.cos(phase), 2.0) - 1.0
    ends = math.pi / 2 + 2.0 * math.pi * np.arange(3)
    return max(
        scaled(sol.v[0], 10.0 - 0.5 * impulse),
        same_times(sol, ends, 20.0, "open"),
        same_times(sol, ends + math.pi, 20.0, "close"),
    )


def resting(x0: float, v0: float) -> fm.Scene:
    """The free oscillator with friction 0.1, from any start."""
    scene: fm.Scene = models.friction_oscillator(x0=x0, v0=v0, friction=0.1)
    return scene


def _stays(sol: Solution, x0: float) -> float:
    return scaled(sol.q[0], np.full(len(sol.t), x0))


def _goes(sol: Solution) -> float:
    reference = free_oscillator(x0=1.05, t_end=20.0)
    return scaled(sol(reference.t)[0], reference.q[0])


def pulled(part: float, angle: float) -> fm.Scene:
    """A sliding mass pulled with ``part`` of its friction (mu N = 1), at an angle to its velocity 1 along x."""
    body = fm.Body("mass", mass=1.0, axes="xy", velocity={"x": 1.0})
    return fm.Scene("pulled", [
        body,
        fm.Force("fx", body, axis="x", value=part * math.cos(angle)),
        fm.Force("fy", body, axis="y", value=part * math.sin(angle)),
        fm.Contact("sole", body, law=fm.laws.Coulomb(mu_s=1.0), normal_force=1.0),
    ])  # fmt: skip


def pull_time(part: float, angle: float) -> float:
    """Time of rest: d/dt [r (1 + P cos phi)] = P^2 - 1 for a slip speed r at the angle phi to a pull P."""
    return (1.0 + part * math.cos(angle)) / (1.0 - part**2)


def _stops(sol: Solution, true: float) -> float:
    return same_times(sol, np.array([true]), true, "stick")


def _grazes(sol: Solution) -> float:
    """mu_s = mu_k on the belt: 1 + 0.1 sin(t - 10), whose slip speed touches zero once a period."""
    t = np.asarray(sol.t)
    return scaled(sol.q[0], np.where(t < 10.0, 0.1 * t, 1.0 + 0.1 * np.sin(t - 10.0)))


_SHAKE, _HOLD = 1.5, 1.0


def shaken(frequency: float) -> fm.Scene:
    """A mass without a spring under 1.5 sin(w t) and friction 1: four transitions a period."""
    body = fm.Body("mass", mass=1.0)
    force = fm.Force("f", body, axis="x", value=_SHAKE * sympy.sin(frequency * fm.t))
    sole = fm.Contact("sole", body, law=fm.laws.Coulomb(mu_s=1.0), normal_force=_HOLD)
    return fm.Scene("shaken", [body, force, sole])


def shake_phases() -> tuple[float, float]:
    """Phases at which slip starts and ends in each half period (rest before the next one)."""
    from scipy.optimize import brentq

    start = math.asin(_HOLD / _SHAKE)

    def speed(phase: float) -> float:
        return _SHAKE * (math.cos(start) - math.cos(phase)) - _HOLD * (phase - start)

    return start, float(brentq(speed, start + 1.0, start + 4.0, xtol=1e-15))


def _shakes(sol: Solution, frequency: float, count: int) -> float:
    start, end = shake_phases()
    half = math.pi * np.arange(count)
    duration = float(sol.t[-1])
    return max(
        same_times(sol, (start + half) / frequency, duration, "slip"),
        same_times(sol, (end + half) / frequency, duration, "stick"),
    )


def _turns(sol: Solution) -> float:
    """Nearly straight motion on the plane: along x the oscillator in one dimension."""
    reference = free_oscillator(x0=2.05, t_end=20.0)
    return scaled(sol(reference.t)[0], reference.q[0])


def _long(sol: Solution) -> float:
    count = int((sol.t[-1] - 15.0) / belt_times(1.5, 1)[1]) + 1
    return same_times(sol, belt_times(1.5, count)[0], float(sol.t[-1]), "slip")


def _brake(sol: Solution) -> float:
    from fricmb.bench._reference import shipped

    reference = shipped("p1_2")
    return scaled(sol(reference.t)[0], reference.q[0])


def contacts() -> list[Extreme]:
    """The scenes."""
    found = [Extreme(group="normal force", value="through zero and back", build=lifted, t_end=18.0, error=_lifts)]
    found += [
        Extreme(group="start at rest", value=f"v = {v:g}, inside the cone", build=partial(resting, 0.05, v),
                t_end=10.0, error=partial(_stays, x0=0.05))
        for v in (0.0, 5e-324, 1e-310, 1e-200)
    ]  # fmt: skip
    found += [
        Extreme(group="start at rest", value=f"v = {v:g}, outside the cone", build=partial(resting, 1.05, v),
                t_end=20.0, error=_goes)
        for v in (0.0, 5e-324, 1e-310)
    ]  # fmt: skip
    found += [
        Extreme(group="start on the stick boundary", value=f"{x:g}", build=partial(resting, x, 0.0), t_end=10.0,
                error=partial(_stays, x0=x))
        for x in (0.1, -0.1)
    ]  # fmt: skip
    found += [
        Extreme(group="marginal stick", value=f"|a|/c = {part:g}, at {angle:g} rad", build=partial(pulled, part, angle),
                t_end=1.1 * pull_time(part, angle), error=partial(_stops, true=pull_time(part, angle)))
        for part in (0.99, 0.9999, 0.999999)
        for angle in (0.0, 0.5 * math.pi)
    ]  # fmt: skip
    found.append(Extreme(group="grazing", value="mu_s = mu_k", build=partial(belt, 1.0), t_end=60.0, error=_grazes))
    found += [
        Extreme(group="chatter", value=f"{4 * n} transitions in {2 * math.pi * n / w:.2g}", build=partial(shaken, w),
                t_end=(2 * math.pi * n + 0.5) / w, error=partial(_shakes, frequency=w, count=2 * n))
        for n, w in ((10, 1e2), (100, 1e4), (1000, 1e6))
    ]  # fmt: skip
    found += [
        Extreme(group="close passes", value=f"v across = {v:g}", t_end=20.0, error=_turns,
                build=partial(models.planar_oscillator, friction=0.1, position=(2.05, 0.0), velocity=(0.0, v)))
        for v in (1e-8, 1e-12, 1e-16)
    ]  # fmt: skip
    found += [
        Extreme(group="long run", value=f"{T:g} time units", build=models.belt_oscillator, t_end=T, error=_long,
                growth=T / 1e3)
        for T in (1e4, 1e6)
    ]  # fmt: skip
    found.append(
        Extreme(group="step too large", value="100 times, brake case 2", build=partial(models.brake4dof, "2"),
                t_end=700.0, error=_brake, growth=25.0, steps=(1.0,))
    )  # fmt: skip
    return found
