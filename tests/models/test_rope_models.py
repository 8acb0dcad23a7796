"""Band brake and belt drive against their closed forms."""

import math

import numpy as np
import pytest

import fricmb as fm


@pytest.mark.parametrize("speed", [40.0, -40.0])
def test_band_brake_slows_its_drum_as_its_moment_says(speed):
    """With a stiff, well damped holder; while the band slips its tensions are in Euler's ratio."""
    sol = fm.simulate(fm.models.band_brake(speed=speed, damping=200.0), t_end=0.5, rtol=1e-8)
    assert len(sol.events) == 0
    mean, difference = sol.reaction("band")[0], sol.force("band")[0]
    ratio = (mean + difference / 2) / (mean - difference / 2)
    np.testing.assert_allclose(ratio, math.exp(math.copysign(0.3 * 1.5 * math.pi, speed)), rtol=1e-10)
    held = 0.2 * 60.0 * (math.exp(0.3 * 1.5 * math.pi) - 1.0 if speed > 0 else 1.0 - math.exp(-0.3 * 1.5 * math.pi))
    late = sol.at(np.linspace(0.3, 0.5, 3))
    slowed = -np.diff(np.abs(late.velocity("drum.angle"))) / 0.1
    np.testing.assert_allclose(slowed, held / 0.9, rtol=1e-4)


def test_belt_slips_at_its_torque():
    sol = fm.simulate(fm.models.belt_drive(), t_end=3.5, rtol=1e-8)
    limit = 2.0 * 200.0 * 0.1 * math.tanh(0.35 * math.pi / 2.0)
    assert {e.contact for e in sol.events} <= {"on_drive", "on_driven"}
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(limit / 12.0, rel=1e-4)
    mean = sol.reaction("on_drive")[0]
    np.testing.assert_allclose(mean[sol.t < 1.6], 200.0, rtol=1e-4)


def test_belt_takes_a_steady_load_along():
    sol = fm.simulate(fm.models.belt_drive(load=-10.0), t_end=3.0)
    assert all(e.kind != "slip" for e in sol.events)
    assert sol.velocity("driven.angle")[-1] == pytest.approx(20.0, rel=1e-3)
