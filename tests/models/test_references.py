"""Each built-in model against a certified reference or a closed form.

Error: largest over the reference's grid, scaled by each signal's own largest value, allowed to grow as the problem's
own growth of errors does.
"""

import importlib.util
import math
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench._reference import KINDS, shipped

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)


def worst(values):
    return float(np.abs(values).max())


def run_on_grid(scene, ref, rtol, **options):
    return fm.simulate(scene, t_end=float(ref["t"][-1]), rtol=rtol, t_eval=ref["t"], **options)


@pytest.mark.parametrize(("rtol", "bound"), [(1e-4, 1e-1), (1e-6, 1e-3), (1e-8, 1e-5)])
@pytest.mark.parametrize(("case", "transitions"), [("1", 213), ("2", 213), ("5", 11)])
def test_brake(case, transitions, rtol, bound):
    ref = reference.load(f"p1_{case}")
    sol = run_on_grid(fm.models.brake4dof(case), ref, rtol)
    q, v = reference.errors(ref, sol.q, sol.v)
    x1, y1, _, y2 = q
    assert max(x1, y1, y2, v[0]) < bound
    if rtol <= 1e-6:
        assert len(sol.events) == transitions
    if rtol <= 1e-8:
        assert worst(sol.events.t - ref["t_event"]) < 1e-4
        assert worst(sol.energy.residual) < 1e-6
    assert np.diff(sol.energy.friction_loss).min() > -1e-9


STATIC = {"mu_s_N": 20.0}
FALLING = {"law": fm.laws.Stribeck(mu_s=18 / 15, mu_k=12 / 15, v_s=1.0)}


@pytest.mark.parametrize("method", ["bdf", "radau"])
@pytest.mark.parametrize(("name", "arguments"), [("brake2_static", STATIC), ("brake2_stribeck", FALLING)])
def test_brake_with_more_friction_at_rest(name, arguments, method):
    """Case 2 with break-away at 20 over slip at 15, and with friction that falls from 18 to 12."""
    ref = shipped(name)
    sol = fm.simulate(fm.models.brake4dof("2", **arguments), t_end=700.0, rtol=1e-8, t_eval=ref.t, method=method)
    for got, true, size in zip((sol.q, sol.v), (ref.q, ref.v), ref.scales, strict=True):
        assert (np.abs(got - true).max(axis=1) / size).max() < 1e-5
    assert [event.kind for event in sol.events] == [KINDS[k] for k in ref.transitions.kind]
    assert worst(sol.events.t - ref.transitions.t) < 1e-4
    assert worst(sol.energy.residual) < 1e-6


RINGING = {"mode3": 2.0, "mode5": 1.0}


@pytest.mark.parametrize("method", ["auto", "radau"])
@pytest.mark.parametrize(
    ("name", "counts", "speed"), [("pad_rotor_slides", (4, 6, 3), 1.0), ("pad_rotor_stops", (3, 4, 1), 0.5)]
)
def test_pad_and_rotor(name, counts, speed, method):
    """Contacts in two directions: three that slide; one that sticks and slips eleven times before the rotor stands."""
    ref = shipped(name)
    scene = fm.models.pad_rotor(*counts, speed=speed, rotor_velocity=RINGING)
    sol = fm.simulate(scene, t_end=float(ref.t[-1]), rtol=1e-8, t_eval=ref.t, method=method)
    for got, true, size in zip((sol.q, sol.v), (ref.q, ref.v), ref.scales, strict=True):
        assert (np.abs(got - true).max(axis=1) / size).max() < 1e-6
    assert [event.kind for event in sol.events] == [KINDS[k] for k in ref.transitions.kind]
    assert worst(sol.events.t - ref.transitions.t) < 1e-8 * ref.t[-1] if len(sol.events) else name.endswith("slides")
    assert worst(sol.energy.residual) < 1e-6


STRIBECK = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05, exponent=1.0)


@pytest.mark.parametrize(
    ("name", "arguments"),
    [("a", {}), ("b", {"damping": 0.05}), ("s", {"law": STRIBECK}), ("sb", {"law": STRIBECK, "damping": 0.05})],
)
def test_belt(name, arguments):
    ref = reference.load(f"p2_{name}")
    sol = run_on_grid(fm.models.belt_oscillator(**arguments), ref, 1e-9)
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-6
    kinds = {0: "stick", 1: "slip"}
    assert [event.kind for event in sol.events] == [kinds[code] for code in ref["type_event"].tolist()]
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-6)
    assert worst(sol.energy.residual) < 1e-6


def test_belt_period_in_closed_form():
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=100.0, rtol=1e-10)
    slips = sol.events.of(kind="slip").t
    period = 10 + math.pi + 2 * math.atan(1 / 5)
    assert (slips[-1] - slips[0]) / (len(slips) - 1) == pytest.approx(period, rel=1e-8)


@pytest.mark.parametrize("x0", ["0.95", "1", "1.03", "2.7183"])
def test_free_oscillator_rests_where_it_should(x0):
    ref = reference.load(f"p3_free_{x0}")
    sol = run_on_grid(fm.models.friction_oscillator(x0=float(x0)), ref, 1e-9)
    q, _ = reference.errors(ref, sol.q, sol.v)
    assert q[0] < 1e-6
    if sol.t[-1] > ref["info"]["half_cycles"] * math.pi:
        stop = sol.events[-1]
        assert stop.kind == "stick"
        assert stop.t == pytest.approx(float(ref["info"]["rest_time"]), abs=1e-6)


@pytest.mark.parametrize("frequency", [0.5, 0.8, 1.5])
def test_driven_oscillator(frequency):
    ref = reference.load(f"p3_forced_w{frequency}_f0.2")
    scene = fm.models.friction_oscillator(friction=0.2, amplitude=0.5, frequency=frequency)
    sol = run_on_grid(scene, ref, 1e-9)
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-6
    assert len(sol.events) == len(ref["t_event"])
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-6)
    assert worst(sol.energy.residual) < 1e-6


def test_two_blocks():
    ref = reference.load("p4_vdr0.1")
    laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
    sol = run_on_grid(fm.models.stick_slip_chain(2, coupling=1.2, laws=laws), ref, 1e-9)
    growth = ref["growth"].max()
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-6 * growth
    assert [event.contact for event in sol.events] == [f"sole{k + 1}" for k in ref["contact_event"].tolist()]
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-6 * growth)


@pytest.mark.parametrize(
    ("name", "friction", "position", "velocity"),
    [
        ("a", 0.3, (2.0, 0.0), (0.0, 1.7)),
        ("b", 0.1, (2.0, 0.0), (0.0, 1e-2)),
        ("d", 0.05, (2.0, 0.3), (0.0, 1e-4)),
        ("e", 0.1, (2.0, 1.0), (0.0, 0.0)),
    ],
)
def test_planar(name, friction, position, velocity):
    ref = reference.load(f"p5_{name}")
    scene = fm.models.planar_oscillator(friction=friction, position=position, velocity=velocity)
    sol = run_on_grid(scene, ref, 1e-8)
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-5
    assert [event.kind for event in sol.events] == ["stick"]
    assert sol.events[0].t == pytest.approx(ref["t_event"][0], abs=1e-4)
    assert worst(sol.energy.residual) < 1e-6


def test_puck_in_closed_form():
    mu, gravity, belt, across = 0.25, 9.81, 1.0, 1.5
    sol = fm.simulate(fm.models.puck_on_belt(), t_end=1.0, rtol=1e-9, t_eval=np.linspace(0, 1, 101))
    speed = math.hypot(belt, across)
    stop = speed / (mu * gravity)
    assert [event.kind for event in sol.events] == ["stick"]
    assert sol.events[0].t == pytest.approx(stop, abs=1e-8)
    way = np.where(sol.t < stop, speed * sol.t - mu * gravity * sol.t**2 / 2, speed * stop / 2)
    assert sol["puck.y"] == pytest.approx(way * across / speed, abs=1e-8)
    assert sol["puck.x"] == pytest.approx(belt * sol.t - way * belt / speed, abs=1e-8)


def test_stack_in_closed_form():
    gravity = 9.81
    sol = fm.simulate(fm.models.block_stack(), t_end=0.7, rtol=1e-9, t_eval=np.linspace(0, 0.7, 71))
    gains = np.array([0.9, 0.4, 0.2]) * gravity
    assert [(event.contact, event.kind) for event in sol.events] == [(f"joint{i}", "stick") for i in (1, 2, 3)]
    assert sol.events.t == pytest.approx(1 / gains, abs=1e-8)
    assert sol.v == pytest.approx(np.minimum(gains[:, None] * sol.t, 1.0), abs=1e-8)


def test_chain_of_ten():
    ref = reference.load("chain")
    sol = run_on_grid(fm.models.stick_slip_chain(10), ref, 1e-9)
    assert len(sol.events) == 34
    assert pytest.approx(ref["x10"], abs=1e-5) == sol.q.T


@pytest.mark.slow
def test_chain_of_twenty():
    ref = reference.load("p6")
    mu_s = [1.2 + 0.02 * i for i in range(20)]
    sol = run_on_grid(fm.models.stick_slip_chain(20, mu_s=mu_s), ref, 1e-10)
    growth = np.maximum.accumulate(ref["growth"])
    error = np.abs(sol.q.T - ref["q"]).max(axis=1) / np.abs(ref["q"]).max()
    assert (error < 1e-8 * np.maximum(growth, 1.0)).all()
    early = ref["t_event"] < 40
    got = sol.events.t[: early.sum()]
    assert got == pytest.approx(ref["t_event"][early], abs=1e-3)
