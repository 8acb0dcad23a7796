"""Extremes of structure and of scale: stiffness, mass, damping, time, friction."""

from __future__ import annotations

import math
from functools import partial

import numpy as np

import fricmb as fm
from fricmb import models
from fricmb.bench._closed import free_oscillator
from fricmb.bench.stability._extreme import Extreme, same_times, scaled
from fricmb.solution import Solution

GRAVITY = 9.81


def stiff_pair(stiffness: float) -> fm.Scene:
    """Two halves of a mass, tied by a stiff damped spring; the second rubs: in the limit the free oscillator."""
    one = fm.Body("one", mass=0.5, position={"x": 2.7183})
    two = fm.Body("two", mass=0.5, position={"x": 2.7183})
    soft, tie = (
        fm.Spring("soft", one, axis="x", stiffness=1.0),
        fm.Spring("tie", one, two, axis="x", stiffness=stiffness),
    )
    calm = fm.Damper("calm", one, two, axis="x", damping=0.5 * math.sqrt(stiffness))
    sole = fm.Contact("sole", two, law=fm.laws.Coulomb(mu_s=1.0), normal_force=0.1)
    return fm.Scene("stiff pair", [one, two, soft, tie, calm, sole])


def _follows(sol: Solution, scale: float = 1.0) -> float:
    """Positions beside the free oscillator's, at its own scale of time."""
    reference = free_oscillator(t_end=float(sol.t[-1]) / scale)
    t = np.minimum(reference.t * scale, sol.t[-1])
    state = sol(t)
    return max(scaled(x, reference.q[0]) for x in state[: len(state) // 2])


def _rests(sol: Solution, scale: float = 1.0) -> float:
    """The same, and the time at which it comes to rest."""
    stops = [event.t for event in sol.events if event.kind == "stick"]
    if not stops:
        return float("inf")
    return max(_follows(sol, scale), abs(stops[-1] / scale - 14 * math.pi) / 50.0)


def riding(ratio: float) -> fm.Scene:
    """A light mass stuck on a heavy one that swings."""
    heavy = fm.Body("heavy", mass=1.0, position={"x": 1.0})
    light = fm.Body("light", mass=1.0 / ratio, position={"x": 1.0})
    rub = fm.laws.Coulomb(mu_s=2.0)
    return fm.Scene("riding", [
        heavy, light, fm.Spring("spring", heavy, axis="x", stiffness=1.0),
        fm.Contact("joint", light, heavy, law=rub, normal_force=1.0 / ratio),
    ])  # fmt: skip


def _rides(sol: Solution, ratio: float) -> float:
    w = 1.0 / math.sqrt(1.0 + 1.0 / ratio)
    return float(max(scaled(q, np.cos(w * sol.t)) for q in sol.q))


def caught(ratio: float) -> fm.Scene:
    """A light mass put on a heavy moving one."""
    heavy, light = fm.Body("heavy", mass=ratio, velocity={"x": 1.0}), fm.Body("light", mass=1.0)
    rub = fm.laws.Coulomb(mu_s=0.5)
    return fm.Scene("caught", [heavy, light, fm.Contact("joint", light, heavy, law=rub, normal_force=GRAVITY)])


def _catches(sol: Solution, ratio: float) -> float:
    stop = 1.0 / (0.5 * GRAVITY * (1.0 + 1.0 / ratio))
    speed = ratio / (1.0 + ratio)
    ends = float(np.abs(sol.v[:, -1] - speed).max())
    return max(ends, same_times(sol, np.array([stop]), 1.0, "stick"))


def damped(damping: float) -> fm.Scene:
    """An overdamped mass that creeps back and never sticks: its friction is negligible."""
    body = fm.Body("mass", mass=1.0, position={"x": 1.0})
    return fm.Scene("damped", [
        body, fm.Spring("spring", body, axis="x", stiffness=1.0), fm.Damper("damper", body, axis="x", damping=damping),
    ])  # fmt: skip


def _creeps(sol: Solution, damping: float) -> float:
    root = math.sqrt(damping**2 / 4.0 - 1.0)
    slow = 1.0 / (damping / 2.0 + root)
    fast = damping / 2.0 + root
    x = (fast * np.exp(-slow * sol.t) - slow * np.exp(-fast * sol.t)) / (fast - slow)
    return scaled(sol.q[0], x)


def paced(scale: float) -> fm.Scene:
    """The free oscillator with its time stretched by ``scale``."""
    k = 1.0 / scale**2
    law = fm.laws.Coulomb(mu_s=1.0)
    body = fm.Body("mass", mass=1.0, position={"x": 2.7183})
    spring = fm.Spring("spring", body, axis="x", stiffness=k)
    return fm.Scene("paced", [body, spring, fm.Contact("sole", body, law=law, normal_force=0.1 * k)])


def _slides(sol: Solution, mu: float) -> float:
    """The puck across the belt, at any coefficient."""
    speed = math.hypot(1.0, 1.5)
    stop = speed / (mu * GRAVITY)
    t = np.asarray(sol.t)
    way = np.where(t < stop, speed * t - mu * GRAVITY * t**2 / 2, speed * stop / 2)
    return max(scaled(sol.q[1], way * 1.5 / speed), same_times(sol, np.array([stop]), stop, "stick"))


def belt(ratio: float) -> fm.Scene:
    """Mass on a belt, mu_s = ratio, mu_k = 1."""
    scene: fm.Scene = models.belt_oscillator(mu_s=ratio, mu_k=1.0)
    return scene


def belt_times(ratio: float, count: int, speed: float = 0.1) -> tuple[np.ndarray, float]:
    """Times at which the belt's mass breaks away, and the period."""
    D = ratio - 1.0
    slip = 2.0 * (math.pi - math.atan(D / speed))
    period = 2.0 * D / speed + slip
    return ratio / speed + period * np.arange(count), period


def _releases(sol: Solution, ratio: float) -> float:
    _, period = belt_times(ratio, 1)
    count = int((sol.t[-1] - ratio / 0.1) / period) + 1
    return same_times(sol, belt_times(ratio, count)[0], float(sol.t[-1]), "slip")


def structures() -> list[Extreme]:
    """The scenes."""
    found = [
        Extreme(group="stiffness ratio", value=f"{K:g}", build=partial(stiff_pair, K), t_end=50.0, error=_follows,
                steps=(1e-3,))
        for K in (1e8, 1e10, 1e12)
    ]  # fmt: skip
    for ratio in (1e3, 1e6, 1e9):
        found += [
            Extreme(group="mass ratio, stuck", value=f"{ratio:g}", build=partial(riding, ratio), t_end=50.0,
                    error=partial(_rides, ratio=ratio)),
            Extreme(group="mass ratio, caught", value=f"{ratio:g}", build=partial(caught, ratio), t_end=1.0,
                    error=partial(_catches, ratio=ratio)),
        ]  # fmt: skip
    found += [
        Extreme(group="damping over critical", value=f"{c:g}", build=partial(damped, 2.0 * c), t_end=c,
                error=partial(_creeps, damping=2.0 * c))
        for c in (1e3, 1e6, 1e9)
    ]  # fmt: skip
    found += [
        Extreme(group="time scale", value=f"{s:g}", build=partial(paced, s), t_end=50.0 * s,
                error=partial(_rests, scale=s))
        for s in (1e-9, 1e-6, 1e-3, 1e3, 1e6, 1e9)
    ]  # fmt: skip
    found += [
        Extreme(group="mu", value=f"{mu:g}", build=partial(models.puck_on_belt, mu=mu),
                t_end=1.25 * math.hypot(1.0, 1.5) / (mu * GRAVITY), error=partial(_slides, mu=mu))
        for mu in (1e-4, 1e-8, 1e2, 1e4)
    ]  # fmt: skip
    found += [
        Extreme(group="mu_s / mu_k", value=f"{r:g}", build=partial(belt, r),
                t_end=r / 0.1 + 3.3 * belt_times(r, 1)[1], error=partial(_releases, ratio=r))
        for r in (1.001, 1.1, 10.0, 100.0)
    ]  # fmt: skip
    return found
