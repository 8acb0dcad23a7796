"""Rigid ends of a way along a guide that turns, against an own program in the way and the angle."""

import math
import pickle

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

M, INERTIA, D, LEAN = 1.5, 0.2, 0.05, 0.3
LOWER, UPPER, E = 0.06, 0.4, 0.5
R, RATE, SPIN = 0.1, -0.5, 3.0


def scene(**given):
    """A block on a rail of a table that turns freely about its middle; the rail passes the middle at D."""
    e, n = np.array([math.cos(LEAN), math.sin(LEAN)]), np.array([-math.sin(LEAN), math.cos(LEAN)])
    table = fm.RigidBody(
        "table", mass=4.0, inertia=0.15, angular_velocity=SPIN, points={"rail": tuple(map(float, D * n))}
    )
    block = fm.RigidBody(
        "block", mass=M, inertia=INERTIA - 0.15, position=tuple(map(float, R * e + D * n)),
        velocity=tuple(map(float, (RATE - D * SPIN) * e + R * SPIN * n)), angular_velocity=SPIN,
    )  # fmt: skip
    guide = fm.Prismatic("guide", block, table.point("rail"), angle=LEAN)
    stop = fm.Stop("stop", block, axis=guide, **{"lower": LOWER, "upper": UPPER, "restitution": E, **given})
    return fm.Scene("table", [table, block, fm.Revolute("pin", table), guide, stop])


def mass(r):
    """Of the way and the angle."""
    return np.array([[M, -M * D], [-M * D, INERTIA + M * (r**2 + D**2)]])


def rates(t, y):
    """Lagrange's equations, without forces."""
    r, _, u, w = y
    return [u, w, *np.linalg.solve(mass(r), [M * r * w**2, -2 * M * r * u * w])]


def own(t_end):
    """From impact to impact; times, sides and impulses of all, and the state at the end."""
    t, y, hits = 0.0, np.array([R, 0.0, RATE, SPIN]), []
    ends = [lambda t, y: y[0] - LOWER, lambda t, y: UPPER - y[0]]
    for end in ends:
        end.terminal, end.direction = True, -1
    while True:
        run = solve_ivp(rates, (t, t_end), y, method="DOP853", rtol=1e-12, atol=1e-13, events=ends)
        t, y = run.t[-1], run.y[:, -1]
        if run.status != 1:
            return hits, y
        answer = np.linalg.solve(mass(y[0]), [1.0, 0.0])
        push = -(1 + E) * y[2] / answer[0]
        y[2:] += push * answer
        hits.append((t, "lower" if len(run.t_events[0]) else "upper", abs(push)))


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_impacts_at_the_ends_of_a_rail_that_turns(method):
    hits, y = own(2.2)
    assert [side for _, side, _ in hits[:2]] == ["lower", "upper"]
    assert len(hits) > 2
    sol = fm.simulate(scene(), t_end=2.2, rtol=1e-9, method=method)
    found = sol.events.of(kind="impact")
    assert [hit.side for hit in found] == [side for _, side, _ in hits]
    np.testing.assert_allclose([hit.t for hit in found], [t for t, _, _ in hits], rtol=1e-8)
    np.testing.assert_allclose([hit.impulse for hit in found], [push for _, _, push in hits], rtol=1e-7)
    assert sol["table.angle"][-1] == pytest.approx(y[1], rel=1e-8)
    assert sol["table.angle.velocity"][-1] == pytest.approx(y[3], rel=1e-8)
    assert sol.audit().ok


def test_it_comes_to_rest_at_the_end_and_is_held_there():
    """Momentum about the pin is kept: as the block rests at the end, the rate is that over the inertia there."""
    sol = fm.simulate(scene(), t_end=6.0, rtol=1e-9)
    momentum = mass(R)[1] @ [RATE, SPIN]
    rate = momentum / (INERTIA + M * (UPPER**2 + D**2))
    assert sol["table.angle.velocity"][-1] == pytest.approx(rate, rel=1e-8)
    assert sol.reaction("stop.upper")[0][-1] == pytest.approx(M * UPPER * rate**2, rel=1e-7)


def test_the_angle_of_the_guide_is_that_of_the_stop():
    turned = scene().with_parameters({"guide.angle": LEAN + 0.1})
    assert turned["stop"].angle == LEAN + 0.1
    assert pickle.loads(pickle.dumps(turned))["stop"].angle == LEAN + 0.1
    with pytest.raises(fm.SceneError, match="left out: a guide brings it"):
        fm.Stop("stop", fm.Body("b", mass=1.0), axis="x", angle=0.1, upper=1.0, restitution=0.5)


def test_play_along_a_guide_that_turns_is_rigid_as_well():
    """Within its gap the block is where stops half the gap away hold it."""
    first = scene()
    play = fm.Backlash("stop", first["block"], axis=first["guide"], gap=0.7, restitution=E)
    other = fm.simulate(fm.Scene("play", [*first.parts[:-1], play]), t_end=1.2, rtol=1e-9)
    stopped = fm.simulate(scene(lower=-0.35, upper=0.35), t_end=1.2, rtol=1e-9)
    assert other.events.of(kind="impact").t == pytest.approx(stopped.events.of(kind="impact").t, rel=1e-9)
    assert len(other.events.of(kind="impact")) > 0
