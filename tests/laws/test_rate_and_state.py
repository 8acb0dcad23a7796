"""Quakes of a slider under a plate: fault rock in metres and seconds, against an own quasi-dynamic program."""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm

YEAR = 3.156e7
N, A, B, L, V_0, MU_0, DAMPING, PLATE, START = 50e6, 0.01, 0.015, 8e-3, 1e-6, 0.6, 4.41e6, 1e-9, 1.2e-9
STIFFNESS = 0.3 * N * (B - A) / L
PSI = math.log(V_0 / START)
SHEAR = N * (MU_0 + A * math.log(START / V_0) + B * PSI) + DAMPING * START


@functools.cache
def quasi_dynamic(years):
    """Slip and the number of quakes without inertia: unknowns log of the slip speed, state and slip."""

    def rates(t, y):
        v = math.exp(y[0])
        psi = (V_0 * math.exp(-y[1]) - v) / L
        # d/dt of tau = N (mu_0 + a log(v/v_0) + b psi) + damping v
        return [(STIFFNESS * (PLATE - v) - N * B * psi) / (N * A + DAMPING * v), psi, v]

    def quake(t, y):
        return y[0] - math.log(1e-3)

    quake.direction = 1.0
    found = solve_ivp(
        rates, (0.0, years * YEAR), [math.log(START), PSI, 0.0], method="LSODA", rtol=1e-9, atol=1e-11, events=quake
    )
    return float(found.y[2, -1]), len(found.t_events[0])


def fault(mass, **given):
    law = fm.laws.RateAndState(mu_0=MU_0, a=A, b=B, L=L, v_0=V_0, viscous=DAMPING / N, **given)
    block = fm.Body("fault", mass=mass, velocity={"x": START})
    plate = fm.Driven("plate", velocity={"x": PLATE}, position={"x": SHEAR / STIFFNESS})
    spring = fm.Spring("k", block, plate, axis="x", stiffness=STIFFNESS)
    return fm.Scene("fault", [block, plate, spring, fm.Contact("c", block, law=law, normal_force=N)])


def quakes(sol):
    v = sol.velocity("fault.x")
    return int(((v[1:] > 1e-3) & (v[:-1] <= 1e-3)).sum())


@pytest.mark.parametrize("mass", [1e4, 1e3])
def test_quakes_of_300_years_by_the_default_speed_of_rest(mass):
    slip, count = quasi_dynamic(300.0)
    assert count == 13
    sol = fm.simulate(fault(mass), t_end=300.0 * YEAR, initial={"state": {"c": [PSI]}})
    assert quakes(sol) == count
    assert sol["fault.x"][-1] == pytest.approx(slip, abs=0.02)
    assert not any("cannot lock" in note for note in sol.stats.notes)


@pytest.mark.parametrize("rtol", [1e-6, 1e-8])
@pytest.mark.parametrize(("mass", "inertia"), [(1e4, 3e-4), (100.0, 3e-6), (0.0, 2e-8)])
def test_300_years_at_tight_tolerances_and_of_light_faults(mass, inertia, rtol):
    """Balances of 3e7 N know slip of 1e-14 m/s by the law alone; ``inertia``: how much later mass lets it slip."""
    slip, count = quasi_dynamic(300.0)
    sol = fm.simulate(
        fault(mass, v_rest=1e-20), t_end=300.0 * YEAR, rtol=rtol, initial={"state": {"c": [PSI]}}
    )
    assert quakes(sol) == count
    assert sol["fault.x"][-1] == pytest.approx(slip, rel=inertia + rtol)
    assert sol.audit().ok
    force = STIFFNESS * (PLATE * sol.t + SHEAR / STIFFNESS - sol["fault.x"])
    still = sol.velocity("fault.x") < 1e-3
    assert np.abs(force + sol.force("c")[0])[still].max() < 30.0 * rtol * force.max()


@pytest.mark.parametrize("v_rest", [1e-9, 1e-10, 1e-11])
def test_a_speed_of_rest_near_that_of_the_drive_is_noted(v_rest):
    sol = fm.simulate(fault(1e4, v_rest=v_rest), t_end=300.0 * YEAR, initial={"state": {"c": [PSI]}})
    assert quakes(sol) != 13
    (note,) = [note for note in sol.stats.notes if "cannot lock" in note]
    assert "contact 'c'" in note
    assert f"v_rest = {v_rest:.2g}" in note


def test_a_contact_that_is_held_has_no_note():
    block = fm.Body("b", mass=1.0)
    law = fm.laws.RateAndState.example()
    contact = fm.Contact("c", block, law=law, normal_force=1.0)
    sol = fm.simulate(fm.Scene("held", [block, fm.Force("F", block, axis="x", value=0.3), contact]), t_end=10.0)
    assert np.abs(sol.velocity("b.x")).max() < 2.0 * law.slowest()
    assert not any("cannot lock" in note for note in sol.stats.notes)
