"""Error over time of scenes with impacts, against event loops by hand: ``python tools/impact_error.py [out.json]``.

Both run scenes whose ends are certified by two ways (tests/impacts/test_certified.py).  The loops are what one writes
with SciPy: a system and its events for each mode, DOP853 between them, the law of impact in a line.
"""

from __future__ import annotations

import json
import math
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

TOLERANCES = [1e-4, 1e-6, 1e-8, 1e-10]
REPEATS = 5


def event(value: Any, direction: int = -1) -> Any:
    """A terminal event of solve_ivp."""
    value.terminal, value.direction = True, direction
    return value


def go(rate: Any, t: float, t_end: float, y: list[float], rtol: float, *events: Any) -> tuple[float, list[float], Any]:
    """To the next event or the end: time, state, and number of the event or None."""
    run = solve_ivp(rate, (t, t_end), y, "DOP853", rtol=max(rtol, 3e-14), atol=1e-2 * rtol, events=events)
    which = next((i for i, times in enumerate(run.t_events) if times.size), None)
    return float(run.t[-1]), run.y[:, -1].tolist(), which


@dataclass(frozen=True)
class Ball:
    """A ball that bounces nine times, its height at 3.5 s."""

    name = "bouncing ball"
    # V/g (1 + 2 (e + e^2 + ...)) and parabolas
    g, e, t_end = 9.81, 0.8, 3.5

    def exact(self) -> list[float]:
        """What is known."""
        v = math.sqrt(2 * self.g)
        t = v / self.g
        while t + 2 * self.e * v / self.g < self.t_end:
            v *= self.e
            t += 2 * v / self.g
        left = self.t_end - t
        return [self.e * v * left - self.g * left**2 / 2]

    def scene(self) -> fm.Scene:
        """Its parts."""
        ball = fm.Body("ball", mass=1.0, axes="y", position={"y": 1.0})
        floor = fm.Stop("floor", ball, axis="y", lower=0.0, restitution=self.e)
        return fm.Scene("ball", [ball, floor, fm.Gravity("g", acceleration={"y": -self.g})])

    def ours(self, sol: fm.Solution) -> list[float]:
        """The same of a run."""
        return [sol["ball.y"][-1]]

    def by_hand(self, rtol: float) -> list[float]:
        """The same by modes and their events."""
        t, y = 0.0, [1.0, 0.0]
        while True:
            t, y, hit = go(lambda t, y: [y[1], -self.g], t, self.t_end, y, rtol, event(lambda t, y: y[0]))
            if hit is None:
                return [y[0]]
            y = [0.0, -self.e * y[1]]


@dataclass(frozen=True)
class Table:
    """A ball in step with a table: certified phase and speed, its height half a period behind 20 impacts."""

    name = "oscillating table"
    A, w, e, g, phase, v = 1e-3, 100.0, 0.8, 9.81, 1.221290450550073, 0.3081902393171587
    t_end = 20.5 * 2 * math.pi / 100.0

    def exact(self) -> list[float]:
        """What is known."""
        left = math.pi / self.w
        return [self.A * math.sin(self.phase) + self.v * left - self.g * left**2 / 2]

    def scene(self) -> fm.Scene:
        """Its parts."""
        start = {"y": self.A * math.sin(self.phase)}
        ball = fm.Body("ball", mass=1.0, axes="y", position=start, velocity={"y": self.v})
        table = fm.Driven("table", position={"y": self.A * sympy.sin(self.w * fm.t + self.phase)}, axes="y")
        stop = fm.Stop("stop", ball, table, axis="y", lower=0.0, restitution=self.e)
        return fm.Scene("table", [ball, table, stop, fm.Gravity("g", acceleration={"y": -self.g})])

    def ours(self, sol: fm.Solution) -> list[float]:
        """The same of a run."""
        return [sol["ball.y"][-1]]

    def by_hand(self, rtol: float) -> list[float]:
        """The same by modes and their events."""
        t, y = 0.0, [self.A * math.sin(self.phase), self.v]
        while True:
            gap = event(lambda t, y: y[0] - self.A * math.sin(self.w * t + self.phase))
            t, y, hit = go(lambda t, y: [y[1], -self.g], t, self.t_end, y, rtol, gap)
            if hit is None:
                return [y[0]]
            table = self.A * self.w * math.cos(self.w * t + self.phase)
            y = [self.A * math.sin(self.w * t + self.phase), table + self.e * (table - y[1])]


@dataclass(frozen=True)
class Block:
    """A driven block with dry friction between stops: 9 impacts, 8 sticks; place and speed at 40."""

    name = "dry block between stops"
    F, X, e, P, w, t_end = 0.3, 0.8, 0.6, 0.9, 0.7, 40.0

    def exact(self) -> list[float]:
        """What is known."""
        return [-0.2947692746566221, -0.8596699513236375]

    def scene(self) -> fm.Scene:
        """Its parts."""
        block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
        return fm.Scene("block", [
            block,
            fm.Spring("spring", block, axis="x", stiffness=1.0),
            fm.Stop("ends", block, axis="x", lower=-self.X, upper=self.X, restitution=self.e),
            fm.DryFriction("dry", block, axis="x", static=1.2 * self.F, kinetic=self.F),
            fm.Force("push", block, axis="x", value=self.P * sympy.cos(self.w * fm.t)),
        ])  # fmt: skip

    def ours(self, sol: fm.Solution) -> list[float]:
        """The same of a run."""
        return [sol["block.x"][-1], sol.velocity("block.x")[-1]]

    def by_hand(self, rtol: float) -> list[float]:
        """The same by modes and their events."""
        t, y, s = 0.0, [0.0, 1.0], 1

        def push(t: float, y: Any) -> float:
            return self.P * math.cos(self.w * t) - y[0]

        while t < self.t_end:
            if s == 0:
                slips = event(lambda t, y: 1.2 * self.F - abs(push(t, y)))
                t, y, which = go(lambda t, y: [0.0, 0.0], t, self.t_end, y, rtol, slips)
                s = int(math.copysign(1, push(t, y)))
                continue
            ends = event(lambda t, y, s=s: self.X - s * y[0])
            turns = event(lambda t, y, s=s: s * y[1])
            slide = lambda t, y, s=s: [y[1], push(t, y) - s * self.F]  # noqa: E731
            t, y, which = go(slide, t, self.t_end, y, rtol, ends, turns)
            if which == 0:
                y, s = [s * self.X, -self.e * y[1]], -s
            elif which == 1:
                y[1] = 0.0
                s = 0 if abs(push(t, y)) < 1.2 * self.F else int(math.copysign(1, push(t, y)))
        return y


@dataclass(frozen=True)
class Pendulum:
    """A pendulum with a dry pin on its stop: time and speed of the fourth impact."""

    name = "pendulum on a stop, dry pin"
    g, tau, stop, e, t_end = 9.81, 0.6, 0.3, 0.7, 2.6

    def exact(self) -> list[float]:
        """What is known."""
        return [2.526883944505081, 0.8360195141302381]

    def scene(self) -> fm.Scene:
        """Its parts."""
        at = 1.4
        bob = fm.RigidBody(
            "bob", mass=1.0, inertia=0.5, position=(math.sin(at), -math.cos(at)), angle=at, points={"pin": (0.0, 1.0)}
        )
        return fm.Scene("pendulum", [
            bob,
            fm.Revolute("pin", bob.point("pin"), fm.GROUND),
            fm.DryFriction("dry", bob, axis="angle", static=1.5 * self.tau),
            fm.Stop("stop", bob, axis="angle", lower=self.stop, restitution=self.e),
            fm.Gravity("g", acceleration={"y": -1.5 * self.g}),
        ])  # fmt: skip

    def ours(self, sol: fm.Solution) -> list[float]:
        """The same of a run."""
        hit = list(sol.events.of(kind="impact"))[3]
        return [hit.t, hit.approach]

    def by_hand(self, rtol: float) -> list[float]:
        """The same by modes and their events."""
        t, y, s, hits = 0.0, [1.4, 0.0], -1, []
        while len(hits) < 4:
            ends = event(lambda t, y: y[0] - self.stop)
            turns = event(lambda t, y: y[1])
            swing = lambda t, y, s=s: [y[1], -self.g * math.sin(y[0]) - s * self.tau]  # noqa: E731
            t, y, _ = go(swing, t, 9.0, y, rtol, turns if s > 0 else ends)
            if s < 0:
                hits.append([t, -y[1]])
                y = [self.stop, -self.e * y[1]]
            s = -s
        return hits[-1]


SCENES = (Ball(), Table(), Block(), Pendulum())


def best(run: Any) -> tuple[Any, float]:
    """The result, and the least processor time of some runs."""
    found, times = run(), []
    for _ in range(REPEATS):
        start = time.process_time()
        found = run()
        times.append(time.process_time() - start)
    return found, min(times)


def error(found: list[float], exact: list[float]) -> float:
    """The largest, beside 1 or the size of each."""
    return max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(found, exact, strict=True))


def main() -> None:
    """Print and write errors and times."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parents[1] / "docs/benchmark/impact_error.json"
    rows = []
    for case in SCENES:
        scene = case.scene()
        for rtol in TOLERANCES:
            ways = {
                "fricmb": lambda: case.ours(fm.simulate(scene, t_end=case.t_end, rtol=rtol)),  # noqa: B023
                "by hand": lambda: case.by_hand(rtol),  # noqa: B023
            }
            for way, run in ways.items():
                found, took = best(run)
                row = {"scene": case.name, "way": way, "rtol": rtol}
                row |= {"error": float(f"{error(found, case.exact()):.1e}"), "ms": float(f"{1e3 * took:.3g}")}
                rows.append(row)
                print(row, flush=True)
    out.write_text("[\n" + ",\n".join(json.dumps(row) for row in rows) + "\n]\n")


if __name__ == "__main__":
    main()
