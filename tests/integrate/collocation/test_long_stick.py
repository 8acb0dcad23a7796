"""Energies over long stretches of stick: neither their time nor their memory grows with the length of a run."""

import tracemalloc

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.collocation.one_contact import held, trajectory


def scene(axes="x", *, belt=0.2, hand=0.03, damping=0.4, follows=False):
    """Three masses, the first of which rests on a belt; the last, a light one, is drawn by a hand.

    ``follows``: a force that follows the motion, so that stiffness is not symmetric, and one that rises with time.
    """

    def all_axes(value):
        return dict.fromkeys(axes, value)

    a = fm.Body("a", mass=1.3, axes=axes, position=all_axes(0.1), velocity=all_axes(belt))
    b = fm.Body("b", mass=0.7, axes=axes, position=all_axes(-0.2), velocity=all_axes(0.3))
    c = fm.Body("c", mass=0.01, axes=axes, position=all_axes(0.05), velocity=all_axes(-0.1))
    moving, drawn = fm.Driven("belt", velocity=all_axes(belt)), fm.Driven("hand", velocity=all_axes(hand))
    parts = [a, b, c, moving, drawn]
    for i, axis in enumerate(axes):
        parts += [
            fm.Spring(f"soft {axis}", a, b, axis=axis, stiffness=3.0),
            fm.Spring(f"hard {axis}", b, c, axis=axis, stiffness=400.0),
            fm.Spring(f"string {axis}", c, drawn, axis=axis, stiffness=1.0 + i),
            fm.Damper(f"within {axis}", b, c, axis=axis, damping=0.02 * damping),
            fm.Damper(f"to hand {axis}", b, drawn, axis=axis, damping=0.01 * damping),
            fm.Damper(f"to ground {axis}", a, axis=axis, damping=0.1 * damping),
        ]
    if follows:
        K, C = [[1.0, 0.1], [-0.05, 2.0]], [[0.01, 0.002], [0.001, 0.01]]
        parts += [fm.MatrixElement("flow", ["b.x", "c.x"], K=K, C=C)]
        parts += [fm.Force("load", b, axis="x", value=0.1 + 0.02 * fm.t)]
    law = fm.laws.Coulomb(mu_s=1e7, mu_k=1e7)
    return fm.Scene("held", [*parts, fm.Contact("sole", a, moving, law=law, normal_force=1.0)])


def energies(scene, t_end):
    """What a run of nothing but stick says of damping and input, at its end and between."""
    sol = fm.simulate(scene, t_end=t_end)
    assert sol.stats.method == "collocation"
    assert not len(sol.events)
    seen = sol.at(np.linspace(0.0, t_end, 41)).energy
    return seen, np.stack([seen.damping_loss, seen.input]) / seen.reference.largest


def asked_for(monkeypatch):
    """Notes down at how many times states are asked for, call by call."""
    counts = []
    whole = trajectory.SingleRun._power_states

    def count(run, row, tau):
        counts.append(len(row))
        return whole(run, row, tau)

    monkeypatch.setattr(trajectory.SingleRun, "_power_states", count)
    return counts


@pytest.mark.parametrize(
    "given",
    [{}, {"axes": "xy"}, {"damping": 0.0}, {"belt": 0.0, "hand": 0.0}, {"hand": 0.0}, {"follows": True}],
    ids=["driven", "planar", "undamped", "at rest", "belt", "circulatory"],
)
def test_doubled_stretches_say_what_gauss_says_of_all_periods(given, monkeypatch):
    _, doubled = energies(scene(**given), 700.0)
    counts = asked_for(monkeypatch)
    monkeypatch.setattr(held, "FEW", 10**9)
    _, all_periods = energies(scene(**given), 700.0)
    assert max(counts) > 10_000
    np.testing.assert_allclose(doubled, all_periods, atol=1e-13)


def test_the_ledger_of_a_long_rest_closes():
    found, _ = energies(scene(), 1e6)
    assert np.abs(found.residual).max() <= 1e-12
    # in the end all move evenly: damper to the ground, and between hand and body, which the spring drags with the belt
    assert np.diff(found.damping_loss)[-1] == pytest.approx(found.damping_loss[-1] / 40.0, rel=0.01)


def test_a_long_rest_asks_for_few_states(monkeypatch):
    counts = asked_for(monkeypatch)
    sol = fm.simulate(fm.models.pad_rotor(), t_end=2000.0)  # some 2e7 periods of the fastest mode
    assert sol.energy.damping_loss[-1] > 0.0
    assert sum(counts) < 10_000
    assert np.abs(sol.energy.residual).max() <= 1e-12


def test_memory_of_a_quadrature_does_not_grow(monkeypatch):
    monkeypatch.setattr(held, "FEW", 10**9)
    monkeypatch.setattr(trajectory, "NUMBERS", 30_000)
    sol = fm.simulate(scene(), t_end=4000.0)
    counts = asked_for(monkeypatch)
    tracemalloc.start()
    try:
        assert sol.energy.damping_loss[-1] > 0.0
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert sum(counts) > 100_000
    assert max(counts) <= 10_000
    assert peak < 20e6
