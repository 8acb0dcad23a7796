"""References in closed form, or with published digits alone."""

from __future__ import annotations

import math

import numpy as np

from fricmb.bench._reference import Floats, Reference, Transitions


def puck(
    mu: float = 0.25, gravity: float = 9.81, belt: float = 1.0, across: float = 1.5, mass: float = 0.16
) -> Reference:
    """Puck on a belt: in the belt's frame a straight line at constant deceleration."""
    t = np.linspace(0.0, 1.0, 101)
    start = np.array([-belt, across])
    speed = float(np.linalg.norm(start))
    n, stop = start / speed, speed / (mu * gravity)
    way = np.where(t < stop, speed * t - mu * gravity * t**2 / 2, speed * stop / 2)
    left = np.maximum(speed - mu * gravity * t, 0.0)
    frame = np.array([belt, 0.0])
    q = n[:, None] * way + frame[:, None] * t
    v = n[:, None] * left + frame[:, None]
    F = np.where(t < stop, -mu * mass * gravity, 0.0) * n[:, None]
    return Reference(t=t, q=q, v=v, F=F, transitions=Transitions.of([(stop, 0, "stick")]))


def stack(gravity: float = 9.81, table: float = 1.0) -> Reference:
    """Three blocks: block k gains speed at 0.9 g, 0.4 g, 0.2 g until it moves with the table."""
    t = np.linspace(0.0, 0.7, 71)
    gain = np.array([0.9, 0.4, 0.2]) * gravity
    stop = table / gain
    v = np.minimum(gain[:, None] * t, table)
    q = np.where(t < stop[:, None], gain[:, None] * t**2 / 2, table * t - table * stop[:, None] / 2)
    return Reference(t=t, q=q, v=v, transitions=Transitions.of([(stop[k], k, "stick") for k in range(3)]))


def free_oscillator(x0: float = 2.7183, friction: float = 0.1, t_end: float = 50.0) -> Reference:
    """X'' + x + friction sign(x') = 0 from rest: half cosines about friction and -friction in turn."""
    t = np.linspace(0.0, t_end, 501)
    q, v, F = np.zeros((1, len(t))), np.zeros((1, len(t))), np.zeros((1, len(t)))
    x, k = x0, 0
    rows: list[tuple[float, int, str]] = []
    while abs(x) > friction:
        side = math.copysign(1.0, x)
        centre = friction * side
        here = (t >= k * math.pi) & (t <= (k + 1) * math.pi)
        phase = t[here] - k * math.pi
        q[0, here], v[0, here] = centre + (x - centre) * np.cos(phase), -(x - centre) * np.sin(phase)
        F[0, here] = friction * side
        x, k = 2.0 * centre - x, k + 1
        rows.append((k * math.pi, 0, "reversal" if abs(x) > friction else "stick"))
    rest = t > k * math.pi
    q[0, rest], v[0, rest], F[0, rest] = x, 0.0, x
    return Reference(t=t, q=q, v=v, F=F, transitions=Transitions.of(rows))


def _end(t: float, q: list[float], v: list[float], digits: float, size: list[list[float]]) -> Reference:
    def column(values: list[float]) -> Floats:
        return np.array(values, float)[:, None]

    return Reference(t=np.array([t]), q=column(q), v=column(v), digits=digits, size=np.array(size))


def stewart() -> Reference:
    """Stewart's blocks at rest, t = 12."""
    largest = [[1.12, 1.1, 1.0], [1.15, 1.32, 1.18]]
    return _end(12.0, [0.11308084, 0.18657982, 0.23411724], [0.0, 0.0, 0.0], 2e-8, largest)


def rabinowicz() -> Reference:
    """A mass with LuGre friction pulled through a spring, t = 25."""
    return _end(25.0, [1.9088391992256], [9.42415459e-6], 1e-9, [[1.909], [0.37]])
