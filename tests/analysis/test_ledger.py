"""The detailed ledger against that of the run, closed forms, and balances by mode."""

import numpy as np
import pytest

import fricmb as fm
from fricmb.analysis import _quadrature, energy_ledger, modal_energy, steady_sliding

from .test_steady_sliding import two_modes


@pytest.fixture(scope="module")
def brake():
    return fm.simulate(fm.models.brake4dof("5"), t_end=60.0, rtol=1e-9)


def test_sums_are_those_of_the_run(brake):
    ledger = energy_ledger(brake)
    energy = brake.at(ledger.t).energy
    assert ledger.friction["lining"].sum(axis=0) == pytest.approx(energy.friction_loss, rel=1e-9, abs=1e-9)
    assert sum(ledger.damping.values()) == pytest.approx(energy.damping_loss, rel=1e-9, abs=1e-9)
    assert sum(ledger.stored.values()) == pytest.approx(energy.potential, rel=1e-12, abs=1e-12)
    assert set(ledger.damping) == {"c1x", "c1y", "c2y"}
    assert "lining" in str(ledger)
    assert "c1x" in str(ledger)


@pytest.mark.parametrize("t_end", [2.0, 200.0])
def test_what_rings_out_within_one_long_step_is_followed(t_end):
    """The pad sticks after 0.03, and rings out a thousand times as fast as the rest of the run is long."""
    sol = fm.simulate(fm.models.pad_rotor(), t_end=t_end, rtol=1e-8)
    ledger = energy_ledger(sol)
    assert sum(loss[-1] for loss in ledger.damping.values()) == pytest.approx(sol.energy.damping_loss[-1], rel=1e-7)
    assert ledger.friction["c1"][:, -1].sum() == pytest.approx(sol.energy.friction_loss[-1], rel=1e-7)
    modes = modal_energy(sol)  # nothing is driven, and modes are coupled by friction and damping alone
    assert np.abs(modes.other).max() < 1e-7 * modes.energy.max()
    assert modes.damping[:, -1].sum() == pytest.approx(sol.energy.damping_loss[-1], rel=1e-7)


def test_more_than_can_be_followed_is_refused(monkeypatch):
    monkeypatch.setattr(_quadrature, "_NUMBERS", 1)
    sol = fm.simulate(fm.models.pad_rotor(), t_end=20.0, rtol=1e-8)
    with pytest.raises(fm.analysis.AnalysisError, match="energy_ledger: from t = 0 to 20 too much vibrates"):
        energy_ledger(sol)


def test_phases_add_up(brake):
    ledger = energy_ledger(brake)
    phases = ledger.phases("lining")
    assert [phase.mode for phase in phases] == [1, 0, 1]
    assert phases[1].begin == brake.events[0].t
    assert phases[1].loss == pytest.approx([0.0, 0.0], abs=1e-12)
    assert sum(phase.loss for phase in phases) == pytest.approx(ledger.friction["lining"][:, -1])
    with pytest.raises(fm.FricmbError, match="lining"):
        ledger.phases("linin")


def test_a_free_oscillator_in_closed_form():
    """Half swings of 2 (x0 - f), 2 (x0 - 3 f), ...: friction takes f times the way."""
    sol = fm.simulate(fm.models.friction_oscillator(friction=0.1), t_end=20.0, rtol=1e-10)
    ledger = energy_ledger(sol)
    ways = [2 * (1 - 0.1 * (2 * k + 1)) for k in range(5)]
    assert ledger.friction["sole"][0, -1] == pytest.approx(0.1 * sum(ways), rel=1e-8)
    assert ledger.damping == {}


def test_damping_of_every_kind_adds_up():
    a = fm.Body("a", mass=1.0, axes="xy", velocity={"x": 1.0, "y": 0.5})
    plate = fm.ModalBody(
        "plate", frequencies=[1.0, 2.5], damping_ratios=0.05, shapes={"tip": [[0.5, 0.2], [0.1, -0.4]]}, axes="xy"
    )
    scene = fm.Scene(
        "damped",
        [
            a,
            plate,
            fm.Spring("k", a, plate.point("tip"), axis="x", stiffness=2.0),
            fm.Damper("c", a, plate.point("tip"), axis="x", damping=0.3),
            fm.PointSpring("s", a, anchor=(1.0, 2.0), stiffness=2.0, length=0.5),
            fm.PointDamper("d", a, anchor=(1.0, 2.0), damping=0.3),
            fm.MatrixElement("m", ["a.x", "a.y"], C=[[0.2, 0.05], [0.05, 0.1]]),
            fm.Contact(
                "sole",
                a,
                law=fm.laws.Coulomb(mu_s=0.2),
                normal_force=fm.normal.Spring(axis="y", stiffness=1.0, damping=0.1, preload=3.0),
            ),
        ],
    )
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-9)
    ledger = energy_ledger(sol)
    assert set(ledger.damping) == {"plate", "c", "d", "m", "sole"}
    energy = sol.at(ledger.t).energy
    assert sum(ledger.damping.values()) == pytest.approx(energy.damping_loss, rel=1e-6, abs=1e-8)
    assert all(loss[-1] > 0 for loss in ledger.damping.values())
    assert ledger.friction["sole"].sum(axis=0) == pytest.approx(energy.friction_loss, rel=1e-6, abs=1e-8)


def test_friction_feeds_the_mode_that_squeals():
    scene = two_modes(mu=0.9, damping=(0.02, 0.05))
    steady = steady_sliding(scene)
    sol = fm.simulate(scene, t_end=40.0, rtol=1e-10, initial=steady.initial(push={"mass.x": 1e-4}))
    flows = modal_energy(sol, around=steady)
    assert flows.omega == pytest.approx([1.0, np.sqrt(3)])
    assert (flows.friction[flows.squealing] > 0).any()
    # nothing else acts: what friction brings and damping takes is what is stored
    assert np.abs(flows.other).max() < 1e-6 * flows.energy.max()
    growth = np.log(flows.energy.sum(axis=0)[-1] / flows.energy.sum(axis=0)[0])
    assert growth > 2
    assert flows.friction.sum(axis=0)[-1] > flows.damping.sum(axis=0)[-1] > 0
    assert "moves most" in str(flows)


def test_modes_of_the_brake(brake):
    flows = modal_energy(brake)
    assert flows.omega == pytest.approx([0.0, np.sqrt(2.5) / 100, 1.0, 10 * np.sqrt(np.pi / 2)])
    assert [flows.name(k) for k in range(4)] == ["rotor.x", "rotor.y", "pad.x", "pad.y"]
    assert flows.squealing == 2
    assert np.abs(flows.other).max() < 1e-8 * flows.energy.max()
    assert flows.power(2).shape == (len(flows.t) - 1,)
    total = brake.at(flows.t).energy
    assert flows.energy.sum(axis=0) == pytest.approx(total.kinetic + total.potential, rel=1e-10)


def test_islands_and_what_was_left_out():
    """Two scenes side by side are run apart; the ledger sees both, and refuses modes of what was not run."""
    parts = []
    for name, damping in (("one", 0.1), ("two", 0.3)):
        body = fm.Body(name, mass=1.0, position={"x": 1.0})
        parts += [body, fm.Spring(f"k{name}", body, axis="x", stiffness=2.0)]
        parts += [fm.Damper(f"c{name}", body, axis="x", damping=damping)]
        parts += [fm.Contact(f"s{name}", body, law=fm.laws.Coulomb(mu_s=0.05), normal_force=1.0)]
    scene = fm.Scene("side by side", parts)
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-9)
    ledger = energy_ledger(sol)
    energy = sol.at(ledger.t).energy
    assert set(ledger.damping) == {"cone", "ctwo"}
    assert sum(ledger.damping.values()) == pytest.approx(energy.damping_loss, rel=1e-8, abs=1e-10)
    assert sum(ledger.stored.values()) == pytest.approx(energy.potential, rel=1e-10, abs=1e-12)
    flows = modal_energy(sol)
    assert np.abs(flows.other).max() < 1e-9
    part = fm.simulate(scene, t_end=10.0, rtol=1e-9, observe=["one.x"])
    with pytest.raises(fm.FricmbError, match=r"left two\.x out"):
        modal_energy(part)
    assert set(energy_ledger(part).damping) == {"cone"}


def test_a_spring_on_a_body_with_a_damping_matrix_loses_nothing():
    """The matrix is the body's own; what is tied to the body does not pay for it."""
    plate = fm.ModalBody(
        "plate", frequencies=[3.0, 5.0], damping_ratios=0.0, damping=[[0.1, 0.03], [0.03, 0.2]],
        shapes={"tip": [[1.0, 0.5]]}, velocity={"mode1": 1.0},
    )  # fmt: skip
    scene = fm.Scene("plate", [plate, fm.Spring("k", plate.point("tip"), axis="x", stiffness=2.0)])
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-9)
    ledger = energy_ledger(sol)
    assert set(ledger.damping) == {"plate"}
    # by hand: the integral of the rates over the matrix
    t = np.linspace(0.0, 10.0, 20001)
    v = sol(t)[2:]
    power = np.einsum("it,ij,jt->t", v, np.array([[0.1, 0.03], [0.03, 0.2]]), v)
    assert ledger.damping["plate"][-1] == pytest.approx(np.trapezoid(power, t), rel=1e-6)
