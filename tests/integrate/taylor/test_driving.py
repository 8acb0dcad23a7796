"""A coefficient of friction that turns negative ends a run by Taylor steps there, whatever times are asked for."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm


@dataclass(frozen=True, kw_only=True)
class Falling(fm.FrictionLaw):
    """Falls in a straight line, through 0 at r = mu_0/slope."""

    mu_0: float
    slope: float

    def define_coefficient(self, r):
        return self.mu_0 - self.slope * r


LAW = Falling(mu_0=0.5, slope=0.25)


def moment(x0):
    """When x'' = -x + N mu(-v) from (x0, 0) reaches v = -2; None where it does not in the first swing."""

    def reached(t, y):
        return y[1] + 2.0

    reached.terminal = True
    found = solve_ivp(
        lambda t, y: [y[1], -y[0] + 0.1 * (0.5 + 0.25 * y[1])], (0.0, 3.0), [x0, 0.0], method="DOP853", rtol=1e-12,
        atol=1e-13, events=reached,
    )  # fmt: skip
    return found.t_events[0][0] if found.t_events[0].size else None


@pytest.mark.parametrize("x0", [2.06, 2.4, 6.0])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-10])
@pytest.mark.parametrize("method", ["taylor", "auto"])
@pytest.mark.parametrize("t_eval", [None, [0.0, np.pi, 2 * np.pi, 10.0], np.linspace(0.0, 10.0, 101)])
def test_the_run_ends_where_the_law_does(x0, rtol, method, t_eval):
    scene = fm.models.friction_oscillator(law=LAW, x0=x0)
    with pytest.raises(fm.IntegrationError, match="the friction coefficient of contact 'sole' is negative") as raised:
        fm.simulate(scene, t_end=10.0, rtol=rtol, method=method, t_eval=t_eval)
    error, t = raised.value, moment(x0)
    assert error.t == pytest.approx(t, abs=10 * rtol + 1e-9)
    part = error.partial
    assert part.t_end == pytest.approx(error.t, rel=1e-12)
    assert part(part.t_end)[1] == pytest.approx(-2.0, abs=10 * rtol + 1e-9)
    if t_eval is None:
        assert part.t[-1] == part.t_end
        assert part.energy.friction_loss[-1] == pytest.approx(np.ptp(part.energy.kinetic + part.energy.potential))
    else:
        assert part.t[-1] == max(time for time in t_eval if time <= error.t)


def test_slip_that_stays_within_the_law_goes_on():
    scene = fm.models.friction_oscillator(law=LAW, x0=2.0)
    assert moment(2.0) is None
    sol = fm.simulate(scene, t_end=30.0, method="taylor")
    assert sol.t_end == 30.0
    assert abs(sol.at(np.linspace(0.0, 30.0, 3001)).relative_velocity("sole")).max() < 2.0


def test_the_island_that_drives_is_named():
    bodies = [fm.Body(name, mass=1.0, position={"x": x0}) for name, x0 in (("calm", 1.0), ("fast", 2.4))]
    parts = [
        part
        for body in bodies
        for part in (
            body,
            fm.Spring(f"{body.name}_spring", body, axis="x", stiffness=1.0),
            fm.Contact(f"{body.name}_sole", body, law=LAW, normal_force=0.1),
        )
    ]
    with pytest.raises(fm.IntegrationError, match="contact 'fast_sole' is negative") as raised:
        fm.simulate(fm.Scene("two", parts), t_end=10.0, rtol=1e-8)
    assert raised.value.t == pytest.approx(moment(2.4), abs=1e-7)
    assert raised.value.partial.t[-1] == pytest.approx(moment(2.4), abs=1e-7)
