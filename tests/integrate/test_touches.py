"""A touch is not a stick: slip whose speed only comes down to the belt's, against closed forms."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.integrate.event_kinds import EVENT_REVERSAL, EVENT_SLIP, EVENT_STICK
from fricmb.integrate.run.told_once import told_once
from fricmb.integrate.trajectory import Transitions


@pytest.mark.parametrize("mu", [1e-7, 1e-5, 1e-2, 0.1, 1.0])
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_a_block_that_touches_the_speed_of_its_belt_slips_on(mu, rtol, method):
    """Started on the belt: x = V t up to mu/V, then mu + V sin(t - mu/V) for ever, which touches V once a period."""
    V = 0.1
    sol = fm.simulate(fm.models.belt_oscillator(mu_s=mu, mu_k=mu), t_end=40.0, rtol=rtol, method=method)
    t = np.linspace(0.0, 40.0, 4001)
    exact = np.where(t < mu / V, V * t, mu + V * np.sin(t - mu / V))
    assert np.abs(sol.at(t)["mass.x"] - exact).max() <= rtol * max(mu, V)
    assert [e.kind for e in sol.events] == ["slip"]
    assert sol.audit().ok, sol.audit()


def grazing():
    block = fm.Body("b", mass=1.1, position={"x": -0.5}, velocity={"x": 0.64})
    belt = fm.Driven("belt", velocity={"x": 0.1})
    sole = fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=0.47), normal_force=1.9)
    return fm.Scene("grazing", [block, belt, fm.Spring("k", block, axis="x", stiffness=7.7), sole])


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_nothing_happens_after_the_last_stick(rtol, method, tmp_path):
    """Twelve touches in thirty seconds, in the run, in its modes, out of a file and gone on with."""
    sol = fm.simulate(grazing(), t_end=30.0, rtol=rtol, method=method)
    assert [e.kind for e in sol.events] == ["reversal", "stick", "slip"]
    assert not ((sol.mode("c") == 0) & (sol.t > sol.events.t[2])).any()
    sol.save(tmp_path / "run.fricmb")
    again = fm.Solution.load(tmp_path / "run.fricmb")
    assert [e.kind for e in again.events] == ["reversal", "stick", "slip"]
    further = fm.simulate(grazing(), t_end=60.0, rtol=rtol, method=method, initial=sol)
    assert [e.kind for e in fm.Solution.join([sol, further]).events] == ["reversal", "stick", "slip"]


@pytest.mark.parametrize("rtol", [1e-8, 1e-10])
@pytest.mark.parametrize("method", ["auto", "radau", "taylor"])
def test_a_short_stick_that_is_one_stays(rtol, method):
    """Slip ends at t = 1 a ten thousandth short of where friction lets go: stick for a thousandth of a second."""
    V, mu, short = 0.1, 0.1, 1e-4
    block = fm.Body(
        "b", mass=1.0, position={"x": mu - short * np.cos(1.0) - V * np.sin(1.0)},
        velocity={"x": V * np.cos(1.0) - short * np.sin(1.0)},
    )  # fmt: skip
    belt = fm.Driven("belt", velocity={"x": V})
    sole = fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=mu), normal_force=1.0)
    scene = fm.Scene("s", [block, belt, fm.Spring("k", block, axis="x", stiffness=1.0), sole])
    sol = fm.simulate(scene, t_end=5.0, rtol=rtol, method=method)
    assert [e.kind for e in sol.events] == ["stick", "slip"]
    np.testing.assert_allclose(sol.events.t, [1.0, 1.0 + short / V], atol=1e-5 if rtol > 1e-9 else 1e-6)


def thrown(start, omega, push, back, stiffness):
    """A block that is thrown back as another body passes -0.1, and when that is (5,): times are those of a cosine."""
    block = fm.Body("b", mass=1.0)
    far = fm.Body("far", mass=1.0, position={"x": start}, velocity={"x": 1.0})
    jump = sympy.Piecewise((push, fm.coordinate("far.x") > -0.1), (back, True))
    parts = [
        block,
        far,
        fm.Force("jump", block, axis="x", value=jump),
        fm.Spring("swing", far, axis="x", stiffness=omega**2),
        fm.Spring("k", block, axis="x", stiffness=stiffness),
        fm.Contact("c", block, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.4), normal_force=1.0),
    ]
    size, phase = np.hypot(start, 1.0 / omega), np.arctan2(1.0 / omega, start)
    return fm.Scene("thrown", parts), (np.arccos(-0.1 / size) + phase + 2.0 * np.pi * np.arange(5)) / omega


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_release_by_a_force_that_jumps_is_told_once(method):
    """Let go by the force before the jump it set out to the other side, and turned round 3e-15 later."""
    scene, passing = thrown(0.235, 18.276, 0.336, -1.26, 1.982)
    sol = fm.simulate(scene, t_end=1.6, method=method)
    assert [e.kind for e in sol.events] == ["slip", "stick"] * 4 + ["slip"]
    np.testing.assert_allclose([e.t for e in sol.events if e.kind == "slip"], passing, rtol=1e-6)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_step_that_ends_a_rounding_before_a_jump_goes_on(method):
    """A step from there was cut at its own start, and tried again for ever."""
    numbers = 0.3263040762290802, 6.733372708884099, 0.45064509371519856, -1.258579714902157, 1.6160096248055127
    scene, passing = thrown(*numbers)
    sol = fm.simulate(scene, t_end=6.0, method=method, time_limit=60)
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(passing[0], rel=1e-7)


def test_what_happens_at_one_instant_is_told_once():
    """Of each contact by itself; what lasts is kept however short it is beside the run."""
    slip, stick, reversal = EVENT_SLIP, EVENT_STICK, EVENT_REVERSAL

    def told(*events):
        t, contact, kind = (np.array(column) for column in zip(*events, strict=True))
        found = told_once(Transitions(t=t, contact=contact, kind=kind), (0.0, 10.0))
        return list(zip(found.t.tolist(), found.contact.tolist(), found.kind.tolist(), strict=True))

    near = 1.0 + 1e-15
    assert told((1.0, 0, slip), (near, 0, reversal), (2.0, 0, stick)) == [(1.0, 0, slip), (2.0, 0, stick)]
    assert told((1.0, 0, reversal), (near, 0, stick)) == [(1.0, 0, stick)]
    assert told((1.0, 0, reversal), (near, 0, reversal), (3.0, 0, stick)) == [(3.0, 0, stick)]
    assert told((1.0, 0, slip), (1.0, 0, reversal), (near, 0, reversal)) == [(1.0, 0, slip)]
    for events in (
        [(1.0, 0, slip), (1.0, 1, reversal)],
        [(1.0, 0, stick), (near, 0, slip)],
        [(1.0, 0, slip), (1.0 + 1e-9, 0, reversal)],
        [(1.0, 0, slip), (1.0 + 1e-12, 0, reversal), (1.0 + 1e-7, 0, stick)],
    ):
        assert told(*events) == events
