"""Impacts at one instant in turn: rows of balls by the exchange of two at a time, and scenes where bodies have air."""

import numpy as np
import pytest

import fricmb as fm


def row(masses, velocities, e, gap=0.0, **law):
    balls = [
        fm.Body(f"b{i}", mass=m, position={"x": (1.0 + gap) * i}, velocity={"x": v})
        for i, (m, v) in enumerate(zip(masses, velocities, strict=True))
    ]
    touch = [
        fm.Stop(f"t{i}", balls[i + 1], balls[i], axis="x", lower=1.0, restitution=e) for i in range(len(balls) - 1)
    ]
    return fm.Scene("row", [*balls, *touch, *([fm.ImpactLaw("impacts", several="in_turn", **law)] if law else [])])


def exchanged(masses, velocities, e):
    """Speeds behind impacts of two at a time, the fastest approach first."""
    m, v = np.array(masses, float), np.array(velocities, float)
    impulse = np.zeros(len(m) - 1)
    while (v[:-1] - v[1:]).max() > 1e-13:
        i = int(np.argmax(v[:-1] - v[1:]))
        p = (1 + e) * (v[i] - v[i + 1]) * m[i] * m[i + 1] / (m[i] + m[i + 1])
        v[i], v[i + 1], impulse[i] = v[i] - p / m[i], v[i + 1] + p / m[i + 1], impulse[i] + p
    return v, impulse


@pytest.mark.parametrize("law", ["newton", "poisson"])
@pytest.mark.parametrize(
    ("masses", "velocities", "e"),
    [
        ([1, 1, 1], [1, 0, 0], 1.0),  # certified: 0, 0, 1
        ([1, 1, 1, 1, 1], [1, 1, 0, 0, 0], 1.0),
        ([1, 1, 1], [1, 0, 0], 0.8),
        ([1, 2, 0.5, 3], [2, 0, 0, -1], 0.6),
        ([3, 0.1, 3], [1, 0, 0], 1.0),  # the small one goes to and fro
        ([1, 2, 1], [1, 0, -0.5], 0.0),
    ],
)
def test_a_row_of_balls_exchanges_speeds_two_at_a_time(masses, velocities, e, law):
    sol = fm.simulate(row(masses, velocities, e, law=law), t_end=1e-3)
    v, impulse = exchanged(masses, velocities, e)
    assert np.allclose(sol.v[:, -1], v, rtol=0, atol=1e-10)
    hits = sol.events.of(kind="impact")
    assert np.allclose([hit.impulse for hit in hits], impulse[impulse > 0], rtol=0, atol=1e-10)
    lost = np.dot(masses, np.square(velocities)) / 2 - np.dot(masses, v**2) / 2
    assert abs(sum(hit.loss for hit in hits) - lost) < 1e-10
    assert sol.audit().ok, sol.audit()


def test_balls_with_a_little_air_between_them_are_the_limit():
    with_air = fm.simulate(row([1, 2, 1.5], [1, 0, 0], 0.7, gap=1e-7), t_end=0.5)
    in_touch = fm.simulate(row([1, 2, 1.5], [1, 0, 0], 0.7, law="newton"), t_end=0.5)
    assert np.allclose(with_air.v[:, -1], in_touch.v[:, -1], rtol=0, atol=1e-9)


def test_a_box_on_two_corners_bounces_in_turn_with_friction_and_comes_to_rest():
    box = fm.RigidBody(
        "box", mass=1.0, inertia=0.02, position=(0.0, 0.11), velocity=(0.4, 0.0),
        points={"left": (-0.2, -0.05), "right": (0.2, -0.05)},
    )  # fmt: skip
    law = fm.laws.Coulomb(mu_s=0.3)
    corners = [
        fm.RollerOnLine(name, box.point(name), push_only=True, restitution=0.3, friction=law)
        for name in ("left", "right")
    ]
    parts = [box, *corners, fm.Gravity("g"), fm.ImpactLaw("impacts", several="in_turn")]
    sol = fm.simulate(fm.Scene("box", parts), t_end=2.0, rtol=1e-8)
    first = sol.events.of(kind="impact")[:2]
    # left first: J = 0.02 + 0.04, so that 2 v (1 + e)... and the right corner meets what that leaves; from their own
    m, J, arm, drop, e, mu = 1.0, 0.02, np.array([[-0.2, -0.05], [0.2, -0.05]]), np.sqrt(2 * 9.81 * 0.06), 0.3, 0.3
    v, w, sums = np.array([0.4, -drop]), 0.0, [0.0, 0.0]
    for _ in range(400):
        rate = [v[1] + w * a[0] for a in arm]
        i = int(np.argmin(rate))
        if rate[i] >= -1e-11 * drop:
            break
        n, t = np.array([0.0, 1.0, arm[i, 0]]), np.array([1.0, 0.0, -arm[i, 1]])
        inverse = np.diag([1 / m, 1 / m, 1 / J])
        D = np.array([[a @ inverse @ b for b in (n, t)] for a in (n, t)])
        slip = v[0] - w * arm[i, 1]
        p = np.linalg.solve(D, [-(1 + e) * rate[i], -slip])
        if abs(p[1]) > mu * p[0]:
            s = np.sign(slip)
            p = np.array([1.0, -s * mu]) * (-(1 + e) * rate[i] / (D[0, 0] - s * mu * D[0, 1]))
        change = inverse @ (n * p[0] + t * p[1])
        v, w, sums[i] = v + change[:2], w + change[2], sums[i] + p[0]
    assert np.allclose([hit.impulse for hit in first], sums, rtol=0, atol=1e-9)
    assert abs(sol["box.y"][-1] - 0.05) < 1e-9
    assert sol.audit().ok, sol.audit()


def test_what_is_not_accepted_is_refused():
    with pytest.raises(fm.SceneError, match="several must be 'together' or 'in_turn'"):
        fm.ImpactLaw("i", several="waves")
    with pytest.raises(fm.SceneError, match="bounces in turn with others"):
        fm.simulate(row([1, 1], [1, 0], 0.5, gap=0.1, law="newton"), t_end=1.0, sensitivities=("b0.mass",))
