"""Random blocks on a spring with dry friction between rigid stops, against closed arcs from event to event."""

import math

import numpy as np
import pytest

import fricmb as fm

#: Impacts slower than this end the comparison: what follows is a matter of bounces that come to rest.
SLOW = 1e-3


def arcs(*, k, c, Ff, X, e, x, v, t_end):
    """Times, sides and speeds of impacts, and the end (t, x, v): it sticks at last, is slow, or its time is over."""
    w, t, hits = math.sqrt(k), 0.0, []
    while t < t_end:
        s = 1.0 if v > 0.0 else -1.0
        if v == 0.0:
            if abs(c - k * x) <= Ff:
                return hits, (t_end, x, 0.0)
            s = 1.0 if c - k * x > 0.0 else -1.0
        rest = (c - s * Ff) / k
        A, B = x - rest, v / w
        R, phase = math.hypot(A, B), math.atan2(B, A)
        # x = rest + R cos(w t - phase) moves on in the direction s until w t - phase is a multiple of pi
        turn = phase if s > 0.0 else phase + math.pi
        turn = turn % (2 * math.pi)
        turn = turn if turn > 1e-12 else 2 * math.pi
        dt, wall = turn / w, None
        level = (s * X - rest) / R
        if abs(level) <= 1.0:
            a = math.acos(level)
            meets = [(phase + sign * a) % (2 * math.pi) for sign in (-1.0, 1.0)]
            meets = [m for m in meets if m <= turn and m > 1e-11]
            if meets and min(meets) < turn:
                dt, wall = min(meets) / w, s
        dt = min(dt, t_end - t) if t + dt >= t_end else dt
        over = t + dt >= t_end
        angle = w * dt - phase
        x, v = rest + R * math.cos(angle), -w * R * math.sin(angle)
        t += dt
        if over:
            break
        if wall is None:
            v = 0.0
        else:
            hits.append((t, wall, abs(v)))
            x, v = wall * X, -e * v
            if abs(v) < SLOW:
                return hits, (t, x, v)
    return hits, (t, x, v)


@pytest.mark.parametrize("seed", range(40))
def test_impacts_are_those_of_closed_arcs(seed):
    rng = np.random.default_rng(seed)
    given = {
        "k": rng.uniform(0.5, 6.0), "c": rng.uniform(-1.0, 1.0), "Ff": rng.uniform(0.01, 0.3),
        "X": rng.uniform(0.3, 1.0), "e": rng.uniform(0.2, 0.95),
    }  # fmt: skip
    x, v, t_end = rng.uniform(-0.9, 0.9) * given["X"], rng.uniform(1.0, 4.0) * rng.choice((-1, 1)), 12.0
    hits, (t, x_end, v_end) = arcs(**given, x=x, v=v, t_end=t_end)
    block = fm.Body("block", mass=1.0, position={"x": x}, velocity={"x": v})
    parts = [
        block,
        fm.Spring("spring", block, axis="x", stiffness=given["k"]),
        fm.Force("push", block, axis="x", value=given["c"]),
        fm.DryFriction("dry", block, axis="x", static=given["Ff"]),
        fm.Stop("ends", block, axis="x", lower=-given["X"], upper=given["X"], restitution=given["e"]),
    ]
    sol = fm.simulate(fm.Scene("block", parts), t_end=t_end, rtol=1e-8)
    found = [event for event in sol.events.of(kind="impact") if event.t <= t * (1 + 1e-12) + 1e-9][: len(hits)]
    assert [event.side for event in found] == ["upper" if side > 0 else "lower" for _, side, _ in hits]
    assert np.allclose([event.t for event in found], [hit[0] for hit in hits], rtol=0, atol=1e-7)
    assert np.allclose([event.approach for event in found], [hit[2] for hit in hits], rtol=0, atol=1e-6)
    if t >= t_end:
        assert abs(sol["block.x"][-1] - x_end) < 1e-6
        assert abs(sol.velocity("block.x")[-1] - v_end) < 1e-6
        assert len(found) == len(sol.events.of(kind="impact"))
    assert np.abs(sol.energy.residual).max() < 1e-7
    if seed % 8 == 0:
        assert sol.audit().ok
