"""Contacts that hold more than there is to hold, in scenes with a joint: as in scenes without, in closed form."""

import numpy as np
import pytest

import fricmb as fm

MU_S, MU_K, SHARES = 0.8, 0.5, (1.0, 3.0)


def beside_a_joint(parts):
    bar = fm.RigidBody("bar", mass=1.0, inertia=0.1, position=(0.0, -0.5), points={"top": (0.0, 0.5)})
    return fm.Scene("s", [*parts, bar, fm.Revolute("pin", bar.point("top"))])


def between_pads(axes, law, pull):
    body = fm.Body("a", mass=1.0, axes=axes)
    pads = [fm.Contact(f"p{i}", body, law=law, normal_force=N) for i, N in enumerate(SHARES)]
    parts = {"x": 0.6, "y": 0.8} if len(axes) == 2 else {"x": 1.0}
    return [body, *pads, *(fm.Force(f"f{c}", body, axis=c, value=part * pull) for c, part in parts.items())]


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("axes", ["x", "xy"])
def test_pads_that_hold_a_body_let_go_as_one(axes, method):
    """A pull that rises as t is held up to mu_s (N1 + N2) = 3.2, though one pad alone is at its limit at 1.6."""
    law = fm.laws.Coulomb(mu_s=MU_S, mu_k=MU_K)
    sol = fm.simulate(beside_a_joint(between_pads(axes, law, fm.t)), t_end=4.0, rtol=1e-8, method=method)
    hold, slide, late = MU_S * sum(SHARES), MU_K * sum(SHARES), 4.0 - MU_S * sum(SHARES)
    assert [(event.contact, event.kind) for event in sol.events] == [("p0", "slip"), ("p1", "slip")]
    np.testing.assert_allclose(sol.events.t, hold, rtol=1e-9)
    for i, N in enumerate(SHARES):
        assert np.linalg.norm(sol.force(f"p{i}"), axis=0).max() <= MU_S * N * (1 + 1e-9)
    way = np.linalg.norm([sol[f"a.{c}"][-1] for c in axes])
    assert way == pytest.approx((hold - slide) * late**2 / 2 + late**3 / 6, rel=1e-8)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_pads_that_stop_a_body_hold_it(method):
    """It comes to rest under a push of 2.4 and both pads stick: neither counts as slipping, and friction is 2.4."""
    law, push = fm.laws.Coulomb(mu_s=MU_S, mu_k=MU_K), 2.4
    body = fm.Body("a", mass=1.0, velocity={"x": -2.2})
    pads = [fm.Contact(f"p{i}", body, law=law, normal_force=N) for i, N in enumerate(SHARES)]
    scene = beside_a_joint([body, *pads, fm.Force("f", body, axis="x", value=push)])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-8, method=method)
    stop = 2.2 / (push + MU_K * sum(SHARES))
    assert [(e.contact, e.kind) for e in sol.events] == [("p0", "stick"), ("p1", "stick")]
    np.testing.assert_allclose(sol.events.t, stop, rtol=1e-9)
    assert sol["a.x"][-1] == pytest.approx(-2.2 * stop / 2, rel=1e-8)
    assert sol.force("p0")[0, -1] + sol.force("p1")[0, -1] == pytest.approx(-push, rel=1e-9)
    assert all(abs(sol.force(f"p{i}")[0, -1]) <= MU_S * N for i, N in enumerate(SHARES))


def test_contacts_in_a_row_of_two_let_go_where_no_shares_hold():
    """Blocks a and b on the ground rub on each other; b is pulled: it goes where a, at its limit, helps no more."""
    law = fm.laws.Coulomb(mu_s=MU_S, mu_k=MU_K)
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=2.0)
    contacts = [
        fm.Contact("ga", a, law=law, normal_force=0.5), fm.Contact("gb", b, law=law, normal_force=2.0),
        fm.Contact("ab", b, a, law=law, normal_force=3.0),
    ]  # fmt: skip
    sol = fm.simulate(beside_a_joint([a, b, *contacts, fm.Force("f", b, axis="x", value=fm.t)]), t_end=2.5, rtol=1e-8)
    assert [(e.contact, e.kind) for e in sol.events] == [("ga", "slip"), ("gb", "slip")]
    hold, slide, late = MU_S * 2.5, MU_K * 2.5, 2.5 - MU_S * 2.5  # both grounds; ab could bear 2.4
    np.testing.assert_allclose(sol.events.t, hold, rtol=1e-9)
    assert sol["a.x"][-1] == pytest.approx(((hold - slide) * late**2 / 2 + late**3 / 6) / 3.0, rel=1e-8)
