"""BDF on the index-reduced system: against published digits and closed forms, and as a formula of its own."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench._andrews import END, angles
from fricmb.integrate.implicit import run

# Test Set for IVP Solvers (Mazzia, Magherini 2008), problem caraxis, t = 3
CAR_AXIS = [
    0.4934557842755629e-1, 0.4969894602303324, 0.1041742524885400e1, 0.3739110272652214, -0.7705836840321485e-1,
    0.7446866596327776e-2, 0.1755681574942899e-1, 0.7703410437794031,
]  # fmt: skip


@pytest.fixture
def alone(monkeypatch):
    """Never leave the run to the one-step method because that gets on faster."""
    monkeypatch.setattr(run, "COST", 1e9)


@pytest.mark.parametrize(("rtol", "tolerance"), [(1e-4, 1.5e-2), (1e-6, 1e-4), (1e-8, 1e-6)])
def test_andrews(alone, rtol, tolerance):
    """The median of several tolerances: what a single one errs by is chance.

    At 81 tolerances around 1e-4 errors were 0.0001 to 0.029, their median 0.01, and the same for equations whose
    round-off differs; a bound of 0.01 for one of them held or not by the last digit of the tolerance.
    """
    runs = [
        fm.simulate(fm.models.andrews(), t_end=0.03, rtol=near * rtol, method="bdf")
        for near in np.linspace(0.8, 1.2, 21)
    ]
    assert np.median([np.abs(angles(sol) / END - 1.0).max() for sol in runs]) < tolerance
    shares = []
    # whether BDF is handed back to the other method at some tight turn hangs on the last digit of the tolerance
    for near in (rtol, 1.1 * rtol, 1.3 * rtol):
        sol = fm.simulate(fm.models.andrews(), t_end=0.03, rtol=near, method="bdf")
        one_step = fm.simulate(fm.models.andrews(), t_end=0.03, rtol=near, method="radau")
        shares.append(sol.stats.n_rhs / sol.stats.n_steps * one_step.stats.n_steps / one_step.stats.n_rhs)
    # fewer evaluations a step than any formula of several stages needs: it is BDF that ran
    assert min(shares) < 0.4


@pytest.mark.parametrize(("rtol", "tolerance"), [(1e-4, 1e-3), (1e-8, 1e-6)])
def test_car_axis(alone, rtol, tolerance):
    sol = fm.simulate(fm.models.car_axis(), t_end=3.0, rtol=rtol, method="bdf")
    np.testing.assert_allclose(np.concatenate([sol.q[:, -1], sol.v[:, -1]]), CAR_AXIS, atol=tolerance)


def test_error_falls_with_the_tolerance_and_constraints_hold(alone):
    errors = []
    for rtol in (1e-4, 1e-6, 1e-8):
        sol = fm.simulate(fm.models.four_bar(), t_end=1.0, rtol=rtol, method="bdf")
        errors.append(np.abs(sol.energy.residual).max())
        np.testing.assert_allclose(sol["rocker.tip.x"], sol["coupler.tip.x"], atol=1e-14)
        between = sol.at(np.linspace(0.0, 1.0, 333))
        np.testing.assert_allclose(between["rocker.tip.y"], between["coupler.tip.y"], atol=1e-14)
    assert errors[2] < 0.1 * errors[1] < 0.01 * errors[0]


def test_transitions_and_friction_are_those_of_the_one_step_method():
    for scene, t_end in (
        (fm.models.dry_pendulum(), 8.0),
        (fm.models.slider_crank(friction=fm.laws.Coulomb(mu_s=0.2)), 1.0),
    ):
        one = fm.simulate(scene, t_end=t_end, rtol=1e-10, method="radau")
        sol = fm.simulate(scene, t_end=t_end, rtol=1e-6, method="bdf")
        assert [(e.kind, e.contact) for e in sol.events] == [(e.kind, e.contact) for e in one.events]
        np.testing.assert_allclose(sol.events.t, one.events.t, atol=1e-4)
        np.testing.assert_allclose(sol.q[:, -1], one.q[:, -1], atol=1e-4)
        assert np.abs(sol.energy.residual).max() < 1e-4


def test_positions_count_in_the_error_where_velocities_are_polynomials():
    """Velocity quadratic in time: a formula of order 2 sees no error in it, and one in the position."""
    body = fm.RigidBody("b", mass=1.0, inertia=1.0, position=(100.0, 0.0))
    scene = fm.Scene("s", [body, fm.RollerOnLine("rail", body), fm.Force("push", body, axis="x", value=6.0 * fm.t)])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-6, method="bdf")
    assert sol["b.x"][-1] == pytest.approx(108.0, abs=1e-4)


def test_friction_without_single_solution_ends_the_run_as_it_does_for_radau():
    law = fm.laws.Stribeck(mu_s=2.5, mu_k=1.0, v_s=3.0)
    scene = fm.models.painleve_rod(angle=1.0, speed=-3.6, law=law)
    with pytest.raises(fm.IntegrationError, match="'tip' has no single solution") as caught:
        fm.simulate(scene, t_end=2.0, rtol=1e-6, method="bdf")
    assert 1e-5 < caught.value.t < 1e-4
