"""Taylor steps: chains against certified references and against radau, the ledger, dense output, limits."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.integrate import integrators
from fricmb.integrate.taylor import Taylor

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[2] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)


@pytest.mark.parametrize(("n", "events"), [(10, 34), (100, 340)])
@pytest.mark.parametrize("rtol", [1e-4, 1e-8, 1e-10])
def test_chains_against_certified_positions(n, events, rtol):
    ref = reference.load("chain")
    sol = fm.simulate(fm.models.stick_slip_chain(n), t_end=20.0, t_eval=ref["t"], rtol=rtol, method="taylor")
    true = ref[f"x{n}"].T
    assert len(sol.events) == events
    assert np.abs(sol.q - true).max() / np.abs(true).max() < max(rtol, 1e-11)
    assert np.abs(sol.energy.residual).max() < 1e-3 * rtol + 1e-13


def test_twenty_blocks_within_their_growth():
    ref = reference.load("p6")
    scene = fm.models.stick_slip_chain(20, mu_s=[1.2 + 0.02 * i for i in range(20)])
    sol = fm.simulate(scene, t_end=60.0, t_eval=ref["t"], rtol=1e-10, method="taylor")
    growth = np.maximum.accumulate(ref["growth"])
    error = np.abs(sol.q.T - ref["q"]).max(axis=1) / np.abs(ref["q"]).max()
    assert (error < 1e-10 * np.maximum(growth, 1.0)).all()
    assert [scene.contacts.index(scene[event.contact]) for event in sol.events] == ref["contact_event"].tolist()
    assert sol.events.t == pytest.approx(ref["t_event"], abs=1e-10 * growth[-1])
    assert sol.energy.friction_loss[-1] == pytest.approx(ref["Wd"][-1], abs=1e-10 * growth[-1])
    off_grid = ref["t"] != 12.0
    force = np.array([sol.force(f"sole{i + 1}")[0] for i in range(20)])
    assert np.abs(force.T - ref["F"])[off_grid][:100].max() < 1e-8


def chain(n, belt, push=None, damping=0.0, driven=None):
    """Blocks on a belt with what else there may be."""
    moving = fm.Driven("belt", velocity={"x": belt})
    blocks = [fm.Body(f"b{i}", mass=1 + 0.1 * i) for i in range(n)]
    parts = [*blocks, moving]
    parts += [fm.Spring(f"k{i}", blocks[i], blocks[i + 1], axis="x", stiffness=5.0) for i in range(n - 1)]
    parts += [fm.Spring(f"g{i}", block, axis="x", stiffness=1.0) for i, block in enumerate(blocks)]
    parts += [fm.Damper(f"c{i}", blocks[i], blocks[i + 1], axis="x", damping=damping) for i in range(n - 1)]
    if push is not None:
        parts.append(fm.Force("push", blocks[2], axis="x", value=push))
    if driven is not None:
        end = fm.Driven("end", position={"x": driven})
        parts += [end, fm.Spring("kd", blocks[0], end, axis="x", stiffness=3.0, length=0.2)]
        parts.append(fm.Damper("cd", blocks[0], end, axis="x", damping=0.4))
    parts += [
        fm.Contact(f"s{i}", block, moving, law=fm.laws.Coulomb(mu_s=1.3 + 0.03 * i, mu_k=0.8), normal_force=1.0)
        for i, block in enumerate(blocks)
    ]
    return fm.Scene("chain", parts)


def pairs(n):
    """Blocks that rub on blocks of a chain."""
    below = [fm.Body(f"a{i}", mass=1.0, velocity={"x": 0.5 * i}) for i in range(n)]
    above = [fm.Body(f"u{i}", mass=0.5) for i in range(n)]
    parts = [*below, *above]
    parts += [fm.Spring(f"k{i}", below[i], below[i + 1], axis="x", stiffness=4.0) for i in range(n - 1)]
    parts += [fm.Spring(f"g{i}", block, axis="x", stiffness=1.0) for i, block in enumerate(below)]
    parts += [fm.Spring(f"q{i}", block, axis="x", stiffness=0.3) for i, block in enumerate(above)]
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.4)
    parts += [fm.Contact(f"s{i}", above[i], below[i], law=law, normal_force=0.5) for i in range(n)]
    return fm.Scene("pairs", parts)


def grid_of_blocks(side):
    """Blocks in a square lattice, each on its own spot of a belt: more neighbours than a band holds."""
    belt = fm.Driven("belt", velocity={"x": 0.1})
    blocks = [[fm.Body(f"b{i}_{j}", mass=1.0, velocity={"x": 0.1}) for j in range(side)] for i in range(side)]
    parts = [belt]
    for i in range(side):
        for j in range(side):
            block, name = blocks[i][j], f"{i}_{j}"
            parts += [block, fm.Spring(f"g{name}", block, axis="x", stiffness=1.0)]
            if i:
                parts.append(fm.Spring(f"v{name}", block, blocks[i - 1][j], axis="x", stiffness=10.0))
            if j:
                parts.append(fm.Spring(f"h{name}", block, blocks[i][j - 1], axis="x", stiffness=10.0))
            law = fm.laws.Coulomb(mu_s=1.2 + 0.1 * np.sin(7.0 * i + 3.0 * j), mu_k=1.0)
            parts.append(fm.Contact(f"s{name}", block, belt, law=law, normal_force=1.0))
    return fm.Scene("lattice", parts)


SCENES = {
    "dampers between neighbours": (lambda: chain(5, 0.3, damping=0.4), 20.0),
    "smooth push": (lambda: chain(5, 0.0, push=3 * sympy.sin(1.3 * fm.t)), 15.0),
    "push that switches": (lambda: chain(5, 0.1, push=3 * sympy.sign(sympy.sin(0.5 * fm.t))), 15.0),
    "belt that swings": (lambda: chain(4, 1.5 * sympy.sin(0.7 * fm.t)), 12.0),
    "driven end": (lambda: chain(5, 0.1, damping=0.1, driven=2 * sympy.sin(0.5 * fm.t)), 15.0),
    "block on block": (lambda: pairs(4), 12.0),
    "lattice": (lambda: grid_of_blocks(4), 14.0),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_against_radau(name):
    make, t_end = SCENES[name]
    grid = np.linspace(0.0, t_end, 61)
    ours = fm.simulate(make(), t_end=t_end, t_eval=grid, rtol=1e-9, method="taylor")
    other = fm.simulate(make(), t_end=t_end, t_eval=grid, rtol=1e-9, method="radau")
    assert np.abs(ours.q - other.q).max() < 1e-8
    assert np.abs(ours.v - other.v).max() < 1e-7
    assert [(e.contact, e.kind) for e in ours.events] == [(e.contact, e.kind) for e in other.events]
    assert len(ours.events) > 5
    assert ours.events.t == pytest.approx(other.events.t, abs=1e-7)
    for part in ("friction_loss", "damping_loss", "input"):
        assert getattr(ours.energy, part) == pytest.approx(getattr(other.energy, part), abs=1e-5)
    assert np.abs(ours.energy.residual).max() < 1e-9


def test_dense_output_and_going_on():
    scene = fm.models.stick_slip_chain(7)
    whole = fm.simulate(scene, t_end=20.0, rtol=1e-9, method="taylor")
    times = np.random.default_rng(3).uniform(0.0, 20.0, 60)
    asked = fm.simulate(scene, t_end=20.0, t_eval=np.sort(times), rtol=1e-9, method="taylor")
    # the run is made again from a checkpoint: not a digit differs
    np.testing.assert_array_equal(whole(np.sort(times)), np.vstack([asked.q, asked.v]))
    np.testing.assert_array_equal(whole(times)[:, np.argsort(times)], whole(np.sort(times)))
    first = fm.simulate(scene, t_end=13.0, rtol=1e-9, method="taylor")
    rest = fm.simulate(scene, t_end=20.0, rtol=1e-9, method="taylor", initial=first)
    assert rest.end.q == pytest.approx(whole.end.q, abs=1e-8)
    assert len(first.events) + len(rest.events) == len(whole.events)


def test_rows_hold_both_sides_of_a_transition():
    sol = fm.simulate(fm.models.stick_slip_chain(3), t_end=20.0, rtol=1e-8, method="taylor")
    for event in sol.events:
        i = np.flatnonzero(sol.t == event.t)
        assert len(i) == 2
        before, after = sol.mode(event.contact)[i]
        assert (before, after) == ((1, 0) if event.kind == "stick" else (0, 1))
    assert (sol.mode("sole1")[0], sol.t[0], sol.t[-1]) == (0, 0.0, 20.0)


def test_auto_takes_it_and_says_why():
    sol = fm.simulate(fm.models.stick_slip_chain(12), t_end=20.0)
    assert sol.stats.method == "taylor"
    assert sol.stats.why.startswith("12 contacts whose friction follows formulas")


TABLE = fm.laws.Tabulated(speed=[0.0, 1.0], mu=[1.2, 1.0])


@pytest.mark.parametrize(
    ("scene", "why"),
    [
        (fm.models.block_stack(201, mu_s=0.5), "201 contacts hold each other"),
        (fm.models.stick_slip_chain(2, laws=[TABLE] * 2), "must be formulas"),
        (fm.models.stick_slip_chain(2, laws=[fm.laws.TanhRegularised(mu=1.0, v_reg=1e-2)] * 2), "a coefficient"),
    ],
)
def test_refuses_in_one_line(scene, why):
    with pytest.raises(fm.SceneError, match=why):
        fm.simulate(scene, t_end=1.0, method="taylor")


def test_a_crowd_of_transitions_is_an_error_that_says_so():
    # equal blocks break away together
    scene = fm.models.stick_slip_chain(1200, mu_s=1.2)
    with pytest.raises(fm.IntegrationError, match="too dense to be located") as caught:
        fm.simulate(scene, t_end=20.0, rtol=1e-6, method=Taylor(crowd=0))
    assert caught.value.partial.t_end > 10.0
    assert "taylor" in integrators


@pytest.mark.parametrize("rtol", [1e-5, 1e-6, 1e-8])
def test_stick_that_is_only_grazed_is_met(rtol):
    """With mu_s/mu_k = 1.001 slip ends 5e-6 past the speed of the belt: errors of a step's start would pass it by."""
    ratio, speed = 1.001, 0.1
    scene = fm.models.belt_oscillator(mu_s=ratio, mu_k=1.0, belt=speed)
    # a swing about x = 1 from x = 1.001 on, until its speed is the belt's again; then along with the belt
    slip = 2 * np.pi - 2 * np.arctan2(ratio - 1, speed)
    stick = 2 * (ratio - 1) / speed
    breaks = ratio / speed + (slip + stick) * np.arange(3)
    sol = fm.simulate(scene, t_end=breaks[-1] + 0.5, rtol=rtol, method="taylor")
    assert [event.kind for event in sol.events] == ["slip", "stick"] * 2 + ["slip"]
    assert sol.events.of(kind="slip").t == pytest.approx(breaks, abs=1e3 * rtol)


def test_a_break_away_from_rest_has_a_row_on_each_side():
    """The step before it ends there, but for round-off, and has no row of its own."""
    scene = fm.models.belt_oscillator(law=fm.laws.CoulombViscous(mu_s=1.5, mu_k=1.0, viscous=0.1))
    sol = fm.simulate(scene, t_end=60.0, rtol=1e-8, method="taylor")
    slips = [event.t for event in sol.events if event.kind == "slip"]
    assert len(slips) > 2
    contact = sol.contact_names[0]
    for t in slips:
        beside = np.abs(sol.t - t) < 1e-9
        np.testing.assert_array_equal(sol.mode(contact)[beside], [0, 1])
        # what it holds, and friction behind: mu_s and mu_k times the load of 1
        np.testing.assert_allclose(np.abs(sol.force(contact)[..., beside]).ravel(), [1.5, 1.0], rtol=1e-7)
