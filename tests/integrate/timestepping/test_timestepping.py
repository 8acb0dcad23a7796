"""Time stepping: order through transitions against certified references, cones, ledger, step control, storage."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.integrate.timestepping import TimeStepping

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[2] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)


def two_blocks():
    laws = [fm.laws.HyperbolicStribeck(mu_s=mu_s, delta=3.0) for mu_s in (1.0, 1.3)]
    return fm.models.stick_slip_chain(2, coupling=1.2, laws=laws)


def planar(friction, position, velocity):
    return fm.models.planar_oscillator(friction=friction, position=position, velocity=velocity)


def error(scene, ref, t_end, **options):
    """Largest error of a position, over the largest position."""
    t = ref["t"][ref["t"] <= t_end]
    true = ref["q"][: len(t)].T
    sol = fm.simulate(scene, t_end=t_end, t_eval=t, **options)
    return np.abs(sol.q - true).max() / np.abs(true).max(), sol


def forced(frequency):
    return fm.models.friction_oscillator(friction=0.2, amplitude=0.5, frequency=frequency)


CASES = {
    # break-away with mu_s > mu_k, release outside the cone, reversals, falling laws, directions that turn
    "p2_a": (lambda: fm.models.belt_oscillator(), 40.0),
    "p3_forced_w0.5_f0.2": (lambda: forced(0.5), 40.0),
    "p3_forced_w1.5_f0.2": (lambda: forced(1.5), 40.0),
    "p4_vdr0.1": (two_blocks, 30.0),
    "p5_a": (lambda: planar(0.3, (2.0, 0.0), (0.0, 1.7)), 10.0),
    "p5_e": (lambda: planar(0.1, (2.0, 1.0), (0.0, 0.0)), 10.0),
    "p1_2": (lambda: fm.models.brake4dof("2"), 40.0),
}


@pytest.mark.parametrize("name", CASES)
def test_second_order_through_transitions(name):
    make, t_end = CASES[name]
    ref = reference.load(name)
    coarse, _ = error(make(), ref, t_end, method=TimeStepping(fixed_step=0.04))
    fine, sol = error(make(), ref, t_end, method=TimeStepping(fixed_step=0.005))
    # 64 for an order of exactly 2
    assert coarse / fine > 40.0
    assert fine < 2e-4
    assert len(sol.events) == (ref["t_event"] <= t_end).sum()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("rtol", [1e-3, 1e-5])
def test_the_error_follows_the_tolerance(name, rtol):
    make, t_end = CASES[name]
    found, sol = error(make(), reference.load(name), t_end, rtol=rtol, method="timestepping")
    assert found < 10 * rtol
    told = ("changes its mode", "velocities are straight lines")  # true of it, and no matter at rows
    assert [note for note in sol.stats.notes if not any(words in note for words in told)] == []


@pytest.mark.parametrize(("n", "events"), [(10, 34), (100, 340)])
def test_chains_against_certified_positions(n, events):
    ref = reference.load("chain")
    sol = fm.simulate(fm.models.stick_slip_chain(n), t_end=20.0, t_eval=ref["t"], rtol=1e-4, method="timestepping")
    true = ref[f"x{n}"].T
    assert np.abs(sol.q - true).max() / np.abs(true).max() < 1e-3
    # close to the limit a contact may slip for one step more or less
    assert abs(len(sol.events) - events) <= 0.02 * events


def test_twenty_blocks_within_their_growth():
    ref = reference.load("p6")
    scene = fm.models.stick_slip_chain(20, mu_s=[1.2 + 0.02 * i for i in range(20)])
    sol = fm.simulate(scene, t_end=float(ref["t"][-1]), t_eval=ref["t"], rtol=1e-5, method="timestepping")
    growth = np.maximum(np.maximum.accumulate(ref["growth"]), 1.0)
    worst = np.abs(sol.q.T - ref["q"]).max(axis=1) / np.abs(ref["q"]).max()
    assert (worst < 1e-5 * growth)[growth < 1e4].all()


def test_a_puck_stops_on_a_straight_line():
    # one cone in two dimensions: |V|/(mu g) of time, V|V|/(2 mu g) of way, whatever the direction
    puck = fm.Body("puck", mass=1.0, axes="xy", velocity={"x": 0.6, "y": 0.8})
    pad = fm.Contact("pad", puck, law=fm.laws.Coulomb(mu_s=0.3), normal_force=1.0)
    sol = fm.simulate(fm.Scene("puck", [puck, pad]), t_end=5.0, rtol=1e-4, method="timestepping")
    assert sol.q[:, -1] == pytest.approx([0.6 / 0.6, 0.8 / 0.6], rel=1e-3)
    assert sol.events[0].t == pytest.approx(1 / 0.3, rel=1e-3)
    assert sol.force("pad")[:, 0] == pytest.approx([-0.18, -0.24], abs=1e-12)


def driven():
    """Blocks of two directions with dampers, a driven end, a force in time and a normal force that varies."""
    blocks = [fm.Body(f"b{i}", mass=1.0 + 0.2 * i, axes="xy", velocity={"x": 0.5, "y": 0.1 * i}) for i in range(3)]
    end = fm.Driven("end", position={"x": 0.3 * sympy.sin(1.3 * fm.t), "y": 0.0})
    parts = [*blocks, end]
    for axis in "xy":
        parts += [fm.Spring(f"g{axis}{i}", b, axis=axis, stiffness=2.0 + i) for i, b in enumerate(blocks)]
        parts += [fm.Damper(f"d{axis}{i}", b, axis=axis, damping=0.1) for i, b in enumerate(blocks)]
        parts += [fm.Spring(f"k{axis}{i}", blocks[i], blocks[i + 1], axis=axis, stiffness=3.0) for i in range(2)]
    parts += [
        fm.Spring("kd", blocks[0], end, axis="x", stiffness=4.0),
        fm.Damper("cd", blocks[0], end, axis="x", damping=0.3),
    ]
    parts.append(fm.Force("push", blocks[2], axis="y", value=0.4 * sympy.cos(0.9 * fm.t)))
    loads = [1.0, 1.0 + 0.5 * sympy.sin(fm.t), 0.8]
    law = fm.laws.Coulomb(mu_s=0.35, mu_k=0.25)
    parts += [
        fm.Contact(f"s{i}", b, law=law, normal_force=N) for (i, b), N in zip(enumerate(blocks), loads, strict=True)
    ]
    return fm.Scene("driven", parts)


def test_everything_at_once_against_radau_and_the_ledger():
    scene = driven()
    t = np.linspace(0, 10, 41)
    true = fm.simulate(scene, t_end=10.0, t_eval=t, rtol=1e-9, method="radau")
    errors = []
    for h in (0.04, 0.01):
        sol = fm.simulate(scene, t_end=10.0, t_eval=t, method=TimeStepping(fixed_step=h))
        errors.append(np.abs(sol.q - true.q).max() / np.abs(true.q).max())
    assert errors[0] / errors[1] > 10.0
    assert errors[1] < 1e-3
    steps = fm.simulate(scene, t_end=10.0, rtol=1e-3, method="timestepping")
    assert np.abs(steps.energy.residual).max() < 1e-12


def test_contacts_in_the_band_and_condensed_are_the_same():
    scene = driven()
    runs = [
        fm.simulate(scene, t_end=5.0, method=TimeStepping(fixed_step=0.02, contacts=how))
        for how in ("band", "condensed")
    ]
    assert np.abs(runs[0].q - runs[1].q).max() < 1e-8
    assert np.abs(runs[0].v - runs[1].v).max() < 1e-7


def test_a_belt_that_jumps_leaves_a_row_before_and_one_behind():
    velocity = sympy.Piecewise((0.1, fm.t < 5), (-0.3, True))
    belt, mass = fm.Driven("belt", velocity={"x": velocity}), fm.Body("mass", mass=1.0)
    law = fm.laws.Coulomb(mu_s=1.5, mu_k=1.0)
    contact = fm.Contact("sole", mass, belt, law=law, normal_force=1.0)
    scene = fm.Scene("jump", [belt, mass, fm.Spring("k", mass, axis="x", stiffness=1.0), contact])
    sol = fm.simulate(scene, t_end=7.0, method="timestepping")
    before, behind = np.flatnonzero(sol.t == 5.0)
    # held at the belt's velocity until then, at 0.4 against the new one and under mu_k N from then on
    assert sol.mode("sole")[[before, behind]].tolist() == [0, 1]
    assert np.abs(sol.relative_velocity("sole")[0, [before, behind]] - [0.0, 0.4]).max() < 1e-9
    assert sol.force("sole")[0, behind] == -1.0
    assert sol.at([5.0]).mode("sole").tolist() == [1]
    assert sol.audit().ok


def test_break_away_follows_the_load_where_the_coefficient_does():
    """mu(N) N = P at N = (P^2 + sqrt(P^4 + 4 P^2)) / 2 for mu = 1/sqrt(1 + N)."""
    law, pull = fm.laws.LoadDependent(mu_0=1.0, N_0=1.0, exponent=0.5), 2.0
    block = fm.Body("block", mass=1.0)
    lighter = fm.Contact("pad", block, law=law, normal_force=20.0 - fm.t)
    scene = fm.Scene("lighter", [block, fm.Force("pull", block, axis="x", value=pull), lighter])
    sol = fm.simulate(scene, t_end=17.0, rtol=1e-5, method="timestepping")
    expected = 20.0 - 0.5 * (pull**2 + np.sqrt(pull**4 + 4.0 * pull**2))
    assert [event.kind for event in sol.events] == ["slip"]
    assert sol.events[0].t == pytest.approx(expected, abs=1e-4)


def test_redundant_contacts_share_the_load():
    held = fm.Body("held", mass=1.0, axes="xy")
    force = [fm.Force("fx", held, axis="x", value=0.15 * fm.t), fm.Force("fy", held, axis="y", value=0.2 * fm.t)]
    pads = [fm.Contact(f"pad{i}", held, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0) for i in range(2)]
    sol = fm.simulate(fm.Scene("pinched", [held, *force, *pads]), t_end=5.0, rtol=1e-5, method="timestepping")
    # held up to t = 4; then v' = t/4 - 1
    assert sol.events.t == pytest.approx([4.0, 4.0], abs=1e-2)
    assert np.hypot(*sol.v[:, -1]) == pytest.approx(1 / 8, rel=1e-3)


def test_a_long_run_keeps_what_was_asked_for():
    scene = fm.models.stick_slip_chain(100)
    t = np.linspace(0, 20, 81)
    whole = fm.simulate(scene, t_end=20.0, t_eval=t, rtol=1e-3, method="timestepping", dense=True)
    kept = fm.simulate(scene, t_end=20.0, t_eval=t, rtol=1e-3, method=TimeStepping(), dense=False)
    assert np.abs(whole.q - kept.q).max() < 2e-3 * np.abs(whole.q).max()
    assert np.abs(kept.energy.residual).max() < 1e-3 * kept.energy.friction_loss[-1].max()


def test_what_it_does_not_take():
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    law = fm.laws.LuGre(mu_s=0.4, mu_k=0.3, v_s=0.1, sigma0=1e3, sigma1=10.0, sigma2=0.0)
    scene = fm.Scene("smooth", [block, fm.Contact("pad", block, law=law, normal_force=1.0)])
    with pytest.raises(fm.SceneError, match="timestepping: smooth laws"):
        fm.simulate(scene, t_end=1.0, method="timestepping")
    for options in ({"fixed_step": -1.0}, {"residual": 1.0}, {"contacts": "both"}):
        with pytest.raises(fm.SceneError, match=next(iter(options))):
            TimeStepping(**options)


def test_auto_takes_it_for_large_scenes_that_taylor_does_not_take():
    speed = [0.0, 0.25, 0.5, 1.0, 2.0]
    laws = [
        fm.laws.Tabulated(speed=speed, mu=[1.2 + 0.1 * np.sin(7 * i), 1.15, 1.07, 1.003, 1.0]) for i in range(300)
    ]
    scene = fm.models.stick_slip_chain(300, laws=laws, belt=1.0)
    t = np.linspace(0, 3, 7)
    sol = fm.simulate(scene, t_end=3.0, t_eval=t, rtol=1e-3)
    assert sol.stats.method == "timestepping"
    assert "taylor takes chains" in sol.stats.why
    finer = fm.simulate(scene, t_end=3.0, t_eval=t, method=TimeStepping(fixed_step=1e-3))
    assert len(sol.events) >= 300
    assert np.abs(sol.q - finer.q).max() < 1e-2 * np.abs(finer.q).max()


def test_thousands_of_modes_under_several_contacts():
    # untruncated: the cost of a step goes with the number of modes, and nothing is dense
    order = np.arange(1, 3001)
    where = {f"p{i}": np.sqrt(2) * np.sin(order * np.pi * x) for i, x in enumerate((0.2, 0.45, 0.8))}
    bar = fm.ModalBody("bar", frequencies=20.0 * order, damping_ratios=0.02, shapes=where)
    belt = fm.Driven("belt", velocity={"x": 0.5})
    law = fm.laws.Coulomb(mu_s=0.4, mu_k=0.3)
    pads = [fm.Contact(f"c{i}", bar.point(f"p{i}"), belt, law=law, normal_force=100.0) for i in range(3)]
    sol = fm.simulate(fm.Scene("bar", [bar, belt, *pads]), t_end=0.02, rtol=1e-2, method="timestepping")
    # to the residual of the contact problem, 1e-10 in each of 700 steps
    assert np.abs(sol.energy.residual).max() < 1e-8 * np.abs(sol.energy.input).max()
    # 40 friction forces of 30 N cannot push a bar of unit modal masses further than statics allow, twice
    flexibility = sum(np.abs(where["p1"] * shape / (40.0 * np.pi * order) ** 2).sum() for shape in where.values())
    assert np.abs(sol["bar.p1.x"]).max() < 2 * 40.0 * flexibility


def test_where_transitions_crowd_auto_goes_over_to_it(monkeypatch):
    from fricmb.integrate.taylor import Taylor

    whole = Taylor.integrate

    def crowded(self, *args, **options):
        run = whole(self, *args, **options)
        run.failure = "more than 1200 transitions in one step"
        return run

    monkeypatch.setattr(Taylor, "integrate", crowded)
    scene = fm.models.stick_slip_chain(10)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-4)
    assert sol.stats.method == "timestepping"
    assert sol.stats.why.startswith("taylor stopped at t = 3: more than 1200 transitions")


def test_velocities_between_rows_are_told_where_they_miss_a_kink():
    """What the note says is how far the straight line is off, beside a method that locates the turn."""
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0)
    scene = fm.Scene("swing", [block, fm.Spring("spring", block, axis="x", stiffness=1.0), sole])
    coarse, fine = (fm.simulate(scene, t_end=6.0, rtol=r, method="timestepping") for r in (1e-3, 1e-5))
    assert coarse.stats.notes == ()  # a tenth of what is told
    (note,) = fine.stats.notes
    told = float(note.split("up to ")[1].split()[0])
    exact = fm.simulate(scene, t_end=6.0, rtol=1e-10, method="radau")
    near = np.linspace(1.05, 1.15, 20001)
    off = np.abs(fine.at(near).velocity("block.x") - exact.at(near).velocity("block.x")).max()
    assert 0.6 * told < off / np.abs(exact.v).max() < 1.4 * told
    fixed = fm.simulate(scene, t_end=6.0, method=fm.integrators["timestepping"](fixed_step=0.05))
    assert fixed.stats.notes == ()  # nothing was promised
