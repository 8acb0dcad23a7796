"""The wheel on a slope against its three stages: it slides uphill, rolls up, rolls down or rests."""

import math

import pytest

import fricmb as fm


@pytest.mark.parametrize(("slope", "arm"), [(0.15, 0.002), (0.15, 0.02)])
def test_stages(slope, arm):
    m, R, mu, g, spin = 2.0, 0.1, 0.2, 9.81, 60.0
    a, J = math.atan(slope), m * R**2 / 2
    sol = fm.simulate(fm.models.wheel_on_slope(slope=slope, arm=arm, spin=spin), t_end=6.0, rtol=1e-9)
    up, torque = g * (mu * math.cos(a) - math.sin(a)), arm * m * g * math.cos(a)
    slower = (mu * m * g * math.cos(a) * R + torque) / J
    rolls = spin * R / (up + slower * R)
    v, whole = up * rolls, m + J / R**2
    turns = rolls + v * whole / (m * g * math.sin(a) + torque / R)
    kind = "stick" if arm >= slope * R else "reversal"
    found = [(e.contact, e.kind, e.t) for e in sol.events]
    assert found[0] == ("ground", "stick", pytest.approx(rolls, rel=1e-8))
    assert found[1] == ("resistance", kind, pytest.approx(turns, rel=1e-8))
    down = max(0.0, m * g * math.sin(a) - torque / R) / whole * (6.0 - turns)
    assert sol.velocity("disc.x")[-1] == pytest.approx(-down * math.cos(a), abs=1e-7)
