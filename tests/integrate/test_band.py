"""Implicit steps with banded factors: the same digits as with dense inverses, and structures too wide for those."""

import importlib.util
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.csr import Csr
from fricmb.integrate.model import band_ordering
from fricmb.integrate.model.band_ordering import band_order

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[1] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)


@pytest.fixture
def bands(monkeypatch):
    """Every structure is kept as a band, however small."""
    monkeypatch.setattr(band_ordering, "SMALL", 1)
    monkeypatch.setattr(band_ordering, "NARROW", 1e9)


def pattern(n, pairs):
    rows, columns = np.array([(i, i) for i in range(n)] + [*pairs, *((j, i) for i, j in pairs)]).T
    matrix = Csr.of_entries(rows, columns, np.ones(len(rows)), (n, n))
    return matrix.start, matrix.index


def test_uncoupled_modes_are_a_band_of_one_diagonal():
    assert band_order(*pattern(100, []))[1] == 0


def test_a_chain_in_any_order_is_a_band_of_three():
    order = np.random.default_rng(1).permutation(200)
    place, half = band_order(*pattern(200, list(pairwise(order))))
    assert half == 1
    assert np.all(np.abs(np.diff(place[order])) == 1)


def test_a_full_matrix_is_no_band():
    n = 40
    assert band_order(*pattern(n, [(i, j) for i in range(n) for j in range(i)]))[1] == -1


@pytest.mark.usefixtures("bands")
@pytest.mark.parametrize("method", ["bdf", "radau"])
@pytest.mark.parametrize(
    ("name", "model"),
    [
        ("p1_2", lambda: fm.models.brake4dof("2")),
        ("p2_b", lambda: fm.models.belt_oscillator(damping=0.05)),
        ("p3_forced_w0.8_f0.2", lambda: fm.models.friction_oscillator(friction=0.2, amplitude=0.5, frequency=0.8)),
    ],
)
def test_references_hold_with_bands(name, model, method):
    ref = reference.load(name)
    sol = fm.simulate(model(), t_end=float(ref["t"][-1]), rtol=1e-8, t_eval=ref["t"], method=method)
    q, v = reference.errors(ref, sol.q, sol.v)
    assert max(*q, *v) < 1e-5
    assert len(sol.events) == len(ref["t_event"])


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_nonlinear_elements_and_dampers_find_their_places_in_the_band(method, monkeypatch):
    n = 40
    belt = fm.Driven("belt", velocity={"x": 0.1})
    blocks = [fm.Body(f"b{i}", mass=1.0 + 0.01 * i, velocity={"x": 0.1 * (i % 3)}) for i in range(n)]
    parts = [fm.Spring(f"g{i}", b, axis="x", stiffness=1.0, cubic=0.5) for i, b in enumerate(blocks)]
    pairs = list(pairwise(blocks))
    parts += [fm.Spring(f"k{i}", a, b, axis="x", stiffness=9.0, cubic=2.0) for i, (a, b) in enumerate(pairs)]
    parts += [fm.Damper(f"d{i}", a, b, axis="x", damping=0.1) for i, (a, b) in enumerate(pairs)]
    parts += [fm.Contact("sole", blocks[7], belt, law=fm.laws.Coulomb(mu_s=0.4, mu_k=0.3), normal_force=1.0)]
    scene = fm.Scene("cubic chain", [*blocks, belt, *parts])
    wide = fm.simulate(scene, t_end=20.0, rtol=1e-9, method=method)
    monkeypatch.setattr(band_ordering, "SMALL", n + 1)
    dense = fm.simulate(fm.Scene("again", scene.parts), t_end=20.0, rtol=1e-9, t_eval=wide.t, method=method)
    assert len(wide.events) == len(dense.events) > 2
    assert wide.q == pytest.approx(dense.q, abs=1e-7)


def test_two_thousand_modes_in_closed_form():
    n, push = 2000, 0.5
    rng = np.random.default_rng(3)
    frequencies, shape = np.sort(rng.uniform(1.0, 40.0, n)), rng.normal(size=n) / n
    plate = fm.ModalBody("plate", frequencies=frequencies, damping_ratios=0.0, shapes={"tip": shape})
    belt = fm.Driven("belt", velocity={"x": 100.0})  # so fast that the plate never catches up
    law = fm.laws.Coulomb(mu_s=push, mu_k=push)
    contact = fm.Contact("pad", plate.point("tip"), belt, law=law, normal_force=1.0)
    sol = fm.simulate(fm.Scene("plate", [plate, belt, contact]), t_end=2.0, rtol=1e-8, method="radau")
    exact = (push * shape / frequencies**2)[:, None] * (1 - np.cos(frequencies[:, None] * sol.t))
    assert np.abs(sol.q - exact).max() < 1e-7 * np.abs(exact).max()
    assert abs(sol.energy.residual).max() < 1e-8
