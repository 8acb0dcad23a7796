"""A ball whose start slips a little comes to rest on its turntable at once, and rolls from there on."""

import numpy as np
import pytest

import fricmb as fm

STARTS = (-0.202, -0.2002, -0.2054784674928582, -0.19079146855055482)


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("y", STARTS)
def test_a_short_slip_ends_at_every_tolerance(method, y):
    """Steps on the way to rest get as short as round-off, and those behind it began as short: at 1e-11 none ended."""
    scene = fm.models.turntable().with_parameters({"ball.position.y": y})
    known = fm.simulate(scene, t_end=0.5, rtol=1e-7)
    # slip falls by 7/2 mu g and turns a little
    assert known.events[0].t == pytest.approx(4.0 * abs(y + 0.2) / (3.5 * 5.0 * 9.81), rel=1e-2)
    for rtol in (1e-9, 1e-10, 1e-11, 1e-12):
        sol = fm.simulate(scene, t_end=0.5, rtol=rtol, method=method, time_limit=60.0)
        assert [event.kind for event in sol.events] == ["stick"]
        assert sol.events[0].t == pytest.approx(known.events[0].t, rel=1e-7)
        np.testing.assert_allclose(sol.q[:3, -1], known.q[:3, -1], atol=1e-8)
        assert sol.stats.n_steps < 500


def test_two_short_slips_at_once_end_as_one_does():
    ends = []
    for names in (("one",), ("one", "other")):
        parts = []
        for name in names:
            ball = fm.space.Ball(
                name, mass=1.0, radius=0.05, position=(0.1, -0.202, 0.05), velocity=(0.3, 0.0, 0.0),
                angular_velocity=(8.0, -10.0, 0.0),
            )  # fmt: skip
            friction = fm.laws.Coulomb(mu_s=5.0)
            on = {"normal": (0, 0, 1), "turning": 4.0, "push_only": True, "friction": friction}
            parts += [ball, fm.space.OnPlane(f"{name} table", ball, **on)]
        scene = fm.Scene("balls", [*parts, fm.Gravity("g", acceleration={"z": -9.81})])
        for rtol in (1e-9, 1e-11):
            sol = fm.simulate(scene, t_end=0.2, rtol=rtol, time_limit=60.0)
            assert len(sol.events) == len(names)
            ends.append(sol.q[:3, -1])
    np.testing.assert_allclose(ends, np.tile(ends[0], (4, 1)), atol=1e-9)
