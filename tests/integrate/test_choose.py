"""Which integrator ``auto`` takes, and what it does where that one cannot go on."""

from __future__ import annotations

import re

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench._closed import free_oscillator
from fricmb.bench.stability._structures import stiff_pair
from fricmb.integrate.collocation import Collocation
from fricmb.integrate.select import Guarded
from fricmb.integrate.taylor import Taylor


def row(n, law, *, axes="x", contacts=None, **contact):
    """Masses in a row between springs, the last ``contacts`` of them on a belt."""
    belt = fm.Driven("belt", velocity={"x": 0.5})
    bodies = [fm.Body(f"b{i}", mass=1.0, axes=axes) for i in range(n)]
    springs = [fm.Spring(f"g{axis}", bodies[0], axis=axis, stiffness=4.0) for axis in axes]
    springs += [
        fm.Spring(f"s{i}{axis}", bodies[i], bodies[i + 1], axis=axis, stiffness=30.0)
        for i in range(n - 1)
        for axis in axes
    ]
    rubbing = bodies[n - (n if contacts is None else contacts) :]
    pads = [
        fm.Contact(f"c{i}", body, belt, law=law, **{"normal_force": 1.0, **contact}) for i, body in enumerate(rubbing)
    ]
    return fm.Scene("row", [*bodies, belt, *springs, *pads])


COULOMB = fm.laws.Coulomb(mu_s=1.2, mu_k=1.0)
STRIBECK = fm.laws.Stribeck(mu_s=1.2, mu_k=1.0, v_s=0.1)
#: Unlike along and across, which Taylor steps leave to others.
OVAL, OVAL_STRIBECK = fm.laws.Elliptic(law=COULOMB, ratio=0.5), fm.laws.Elliptic(law=STRIBECK, ratio=0.5)
STEEP = fm.laws.Stribeck(mu_s=1.2, mu_k=1.0, v_s=5e-4)


def one_of_two(stiffness, *, damping):
    """Two masses, one of them on a belt, on a soft spring and with a stiff one between them."""
    a, b = bodies = [fm.Body(f"b{i}", mass=1.0, position={"x": 0.1 + 0.1 * i}) for i in range(2)]
    belt = fm.Driven("belt", velocity={"x": 0.5})
    return fm.Scene("one of two", [
        *bodies, belt, fm.Spring("g", a, axis="x", stiffness=1.0),
        fm.Spring("tie", a, b, axis="x", stiffness=stiffness),
        fm.Damper("d", a, b, axis="x", damping=damping * stiffness**0.5),
        fm.Contact("c", b, belt, law=STRIBECK, normal_force=1.0),
    ])  # fmt: skip


@pytest.mark.parametrize(("damping", "method"), [(0.0, "taylor"), (0.3, "radau")])
def test_vibration_beside_a_law_of_slip_speed_costs_no_accuracy(damping, method):
    """Undamped at k = 1e4 exact structure, whose steps hold whole periods, erred by 5e-3 at rtol 1e-6."""
    scene, t = one_of_two(1e4, damping=damping), np.linspace(0.0, 10.0, 101)
    found = fm.simulate(scene, t_end=10.0, t_eval=t, rtol=1e-6)
    good = fm.simulate(scene, t_end=10.0, t_eval=t, rtol=1e-11, method="radau")
    assert found.stats.method == method
    for a, b in ((found.q, good.q), (found.v, good.v)):
        assert (np.abs(a - b).max(axis=1) < 1e-5 * np.abs(b).max(axis=1)).all()


def tied(stiffness):
    """Two masses on a belt that a stiff spring and a damper keep from ringing against each other."""
    bodies, belt = [fm.Body(f"b{i}", mass=1.0) for i in range(2)], fm.Driven("belt", velocity={"x": 0.1})
    parts = [fm.Spring(f"g{i}", body, axis="x", stiffness=1.0 + i) for i, body in enumerate(bodies)]
    parts += [fm.Contact(f"c{i}", body, belt, law=COULOMB, normal_force=1.0) for i, body in enumerate(bodies)]
    parts.append(fm.Spring("tie", *bodies, axis="x", stiffness=stiffness))
    parts.append(fm.Damper("calm", *bodies, axis="x", damping=0.5 * stiffness**0.5))
    return fm.Scene("tied", [*bodies, belt, *parts])


ONE, FEW, SERIES = "one contact under constant friction", "few contacts on modes", "Taylor steps"
STIFF, OTHER = "40 times as fast as the modes that ring", "needs a coefficient of friction and a constant normal force"


@pytest.mark.parametrize(
    ("scene", "method", "why"),
    [
        (row(3, COULOMB, contacts=1), "collocation", ONE),
        (row(40, COULOMB, contacts=1), "collocation", ONE),
        (row(120, COULOMB, contacts=1), "taylor", SERIES),
        (row(2, COULOMB, axes="xy"), "taylor", SERIES),
        (row(7, STRIBECK, axes="xy"), "taylor", SERIES),
        (row(1, STRIBECK), "taylor", SERIES),
        (row(4, STRIBECK, contacts=1), "taylor", SERIES),
        (row(2, STEEP), "taylor", SERIES),
        (row(20, STRIBECK, contacts=4), "taylor", SERIES),
        (row(40, STRIBECK, contacts=1), "taylor", SERIES),
        (row(6, COULOMB), "taylor", SERIES),
        (fm.models.brake4dof("2", law=STRIBECK), "taylor", SERIES),
        (tied(1e3), "radau", STIFF),
        (tied(1e6), "radau", STIFF),
        (one_of_two(1e4, damping=0.0), "taylor", SERIES),
        (one_of_two(1e8, damping=0.0), "radau", STIFF),
        (row(2, OVAL, axes="xy"), "radau", "alike in all directions"),
        (row(1, fm.laws.TanhRegularised(mu=1.0, v_reg=1e-2)), "radau", OTHER),
        (row(1, fm.laws.Dahl(mu=1.0, sigma0=100.0)), "radau", OTHER),
        (row(1, COULOMB, normal_force=1.0 + 0.2 * fm.t), "radau", OTHER),
        (row(1, fm.laws.Tabulated(speed=[0.0, 0.5, 2.0], mu=[1.2, 1.0, 1.0])), "radau", "must be formulas"),
    ],
)
def test_the_choice_and_why(scene, method, why):
    sol = fm.simulate(scene, t_end=0.1, rtol=1e-6)
    assert sol.stats.method == method
    assert re.search(why, sol.stats.why)


def test_a_row_that_dampers_calm_is_left_to_implicit_steps():
    """Pulled slowly, twenty blocks took 92 000 Taylor steps."""
    blocks, hand = [fm.Body(f"p{i}", mass=0.01) for i in range(20)], fm.Driven("hand", velocity={"x": 1e-3})
    parts = [*blocks, hand, fm.Spring("h", blocks[0], hand, axis="x", stiffness=1e4)]
    for i in range(19):
        pair = blocks[i], blocks[i + 1]
        parts += [fm.Spring(f"s{i}", *pair, axis="x", stiffness=1e4), fm.Damper(f"d{i}", *pair, axis="x", damping=20.0)]
    law = fm.laws.Coulomb(mu_s=1.0)
    parts += [fm.Contact(f"c{i}", block, law=law, normal_force=1.0) for i, block in enumerate(blocks)]
    sol = fm.simulate(fm.Scene("peel", parts), t_end=21.42)
    assert sol.stats.method == "radau"
    assert sol.stats.n_steps < 2000
    # what holds the block behind adds up: the front has come to block k when the hand is at k (k + 1) / 2 / 1e4
    first = {e.contact: e.t for e in reversed(sol.events) if e.kind == "slip"}
    for k in range(1, 20):
        assert first[f"c{k}"] == pytest.approx((k * (k + 1) / 2 + k + 1) / 1e4 / 1e-3, rel=0.02)


def test_redundant_contacts_go_to_the_general_method():
    held = fm.Body("held", mass=1.0, axes="xy")
    law = fm.laws.Coulomb(mu_s=0.5)
    pinched = fm.Scene("pinched", [held, *(fm.Contact(f"pad{i}", held, law=law, normal_force=1.0) for i in range(2))])
    sol = fm.simulate(pinched, t_end=0.1)
    assert sol.stats.method == "radau"
    assert "share their forces" in sol.stats.why


def test_a_run_that_stops_is_done_by_the_general_method_and_says_so(monkeypatch):
    scene = plate(40, 1)
    good = fm.simulate(scene, t_end=5.0, method="radau")
    whole = Collocation.integrate

    def stops(self, *args, **options):
        run = whole(self, *args, **options)
        run.failure = "the step fell to nothing"
        return run

    monkeypatch.setattr(Collocation, "integrate", stops)
    sol = fm.simulate(scene, t_end=5.0)
    assert sol.stats.method == "radau"
    assert sol.stats.why.startswith("collocation stopped at t = 5: the step fell to nothing")
    assert any("radau did the run" in note for note in sol.stats.notes)
    np.testing.assert_allclose(sol.q[:, -1], good.q[:, -1], rtol=1e-12)
    with pytest.raises(fm.IntegrationError, match="fell to nothing"):
        fm.simulate(scene, t_end=5.0, method="collocation")
    assert Guarded().name == "collocation"


def plate(modes, contacts, law=COULOMB):
    shapes = {f"p{i}": np.sin(np.arange(1, modes + 1) * (i + 1)) for i in range(contacts)}
    body = fm.ModalBody("plate", frequencies=np.arange(1.0, modes + 1), damping_ratios=0.01, shapes=shapes)
    belt = fm.Driven("belt", velocity={"x": 0.1})
    pads = [fm.Contact(f"c{i}", body.point(f"p{i}"), belt, law=law, normal_force=1.0) for i in range(contacts)]
    return fm.Scene("plate", [body, belt, *pads])


TABLE = fm.laws.Tabulated(speed=[0.0, 0.5, 2.0], mu=[1.2, 1.0, 1.0])


@pytest.mark.parametrize(
    ("modes", "law", "method"),
    [
        (20, COULOMB, "taylor"), (40, COULOMB, "taylor"), (500, COULOMB, "taylor"),
        (120, STRIBECK, "taylor"), (120, TABLE, "radau"), (600, TABLE, "radau"),
    ],
)  # fmt: skip
def test_many_modes_under_few_contacts(modes, law, method):
    sol = fm.simulate(plate(modes, 3, law), t_end=0.5)
    assert sol.stats.method == method


@pytest.mark.parametrize(("stiffness", "method"), [(1e10, "radau"), (1e12, "radau")])
def test_modes_whose_eigenproblem_leaves_no_digits_are_left_to_steps(stiffness, method):
    scene = stiff_pair(stiffness)
    sol = fm.simulate(scene, t_end=50.0, rtol=1e-6)
    assert sol.stats.method == method
    assert not sol.stats.notes
    true = free_oscillator(t_end=50.0)
    assert np.abs(sol(true.t)[:2] - true.q).max() < 1e-4


@pytest.mark.parametrize("count", [2, 4])
def test_steep_laws_are_run_as_accurately_as_asked_for(count):
    law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=1e-3, exponent=1.0)
    scene = row(count, law)
    t = np.linspace(0.0, 20.0, 101)
    found, good = (fm.simulate(scene, t_end=20.0, t_eval=t, rtol=1e-8, method=m) for m in ("auto", "radau"))
    assert found.stats.method == "taylor"
    assert np.abs(found.q - good.q).max() < 1e-6 * np.abs(good.q).max()


def test_few_contacts_that_taylor_steps_cannot_finish_keep_their_accuracy(monkeypatch):
    scene = row(2, STRIBECK)
    whole = Taylor.integrate

    def stops(self, *args, **options):
        run = whole(self, *args, **options)
        run.failure = "transitions crowd"
        return run

    good = fm.simulate(scene, t_end=5.0, method="radau")
    monkeypatch.setattr(Taylor, "integrate", stops)
    sol = fm.simulate(scene, t_end=5.0)
    assert sol.stats.method == "radau"
    np.testing.assert_allclose(sol.q[:, -1], good.q[:, -1], rtol=1e-12)


def full(n):
    """As many masses as that, each tied to each other one, one of them on a belt."""
    shapes = np.linalg.qr(np.random.default_rng(0).standard_normal((n, n)))[0]
    K = shapes @ np.diag(np.linspace(1.0, n / 2, n) ** 2) @ shapes.T
    bodies = [fm.Body(f"b{i}", mass=1.0) for i in range(n)]
    belt = fm.Driven("belt", velocity={"x": 0.1})
    ties = fm.MatrixElement("ties", [f"b{i}.x" for i in range(n)], K=0.5 * (K + K.T))
    return fm.Scene("full", [*bodies, belt, ties, fm.Contact("c", bodies[0], belt, law=COULOMB, normal_force=1.0)])


def bar(n):
    """A bar by its modes, its end on a belt."""
    body = fm.ModalBody(
        "bar", frequencies=np.arange(1.0, n + 1.0), damping_ratios=0.002, shapes={"tip": np.ones((1, n))}, axes="x"
    )
    belt = fm.Driven("belt", velocity={"x": 0.1})
    return fm.Scene("bar", [body, belt, fm.Contact("c", body.point("tip"), belt, law=COULOMB, normal_force=1.0)])


@pytest.mark.parametrize(
    ("scene", "method"),
    [
        pytest.param(bar(200), "collocation", id="modes: Taylor steps took 30 times as long"),
        pytest.param(full(120), "collocation", id="all coupled: Taylor steps took 80 times as long"),
        pytest.param(row(150, COULOMB, contacts=1), "taylor", id="a narrow band, whose modes take longer to find"),
    ],
)
def test_one_contact_on_many_degrees_of_freedom(scene, method):
    assert fm.simulate(scene, t_end=0.1).stats.method == method


@pytest.mark.parametrize(("values", "n", "method"), [
    (2000, 1, "radau"), (2000, 2, "radau"), (50, 1, "taylor"), (2000, 4, "taylor"),
])  # fmt: skip
def test_a_long_series_is_left_to_steps_of_one_sample(values, n, method):
    """Taylor steps end before and behind each bend of a load: for few contacts they take twice as long."""
    t = np.linspace(0.0, 20.0, values)
    scene = row(n, COULOMB)
    force = fm.Force("f", scene["b0"], axis="x", value=fm.Signal(t, np.sin(t) + 0.1 * np.cos(7 * t)))
    scene = fm.Scene("series", [*scene.parts, force])
    found = {name: fm.simulate(scene, t_end=20.0, method=name)["b0.x"][-1] for name in ("auto", "radau", "taylor")}
    assert fm.simulate(scene, t_end=20.0).stats.method == method
    assert found["auto"] == pytest.approx(found["taylor"], abs=1e-6)
    assert found["auto"] == pytest.approx(found["radau"], abs=1e-6)
