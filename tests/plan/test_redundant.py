"""Contacts that hold the same motion twice: found, said, and given the forces of least norm."""

import numpy as np
import pytest

import fricmb as fm

LAW = fm.laws.Coulomb(mu_s=0.5)


def pulled(**loads):
    """A block held by several contacts and pulled by less than they can hold."""
    block = fm.Body("block", mass=1.0, axes="xy")
    contacts = [fm.Contact(name, block, law=LAW, normal_force=load) for name, load in loads.items()]
    return fm.Scene("held", [block, fm.Force("pull", block, axis="x", value=1.2 * fm.t), *contacts])


@pytest.mark.parametrize("method", ["auto", "bdf", "radau"])
def test_redundant_contacts_share_the_load(method):
    scene = pulled(left=4.0, right=6.0)
    sol = fm.simulate(scene, t_end=1.0, rtol=1e-8, method=method)
    assert not sol.mode("left").any()
    for name in ("left", "right"):
        np.testing.assert_allclose(sol.force(name)[0], -0.6 * sol.t, atol=1e-6)
    assert any("left, right are redundant" in note for note in sol.stats.notes)
    assert "redundant" in str(scene.plan())


def test_a_single_contact_is_not_redundant():
    assert fm.simulate(pulled(left=4.0), t_end=0.5).stats.notes == ()


def test_only_those_that_take_part_are_named():
    a, b, c = (fm.Body(name, mass=1.0) for name in "abc")
    contacts = [
        fm.Contact("ab", a, b, law=LAW, normal_force=1.0),
        fm.Contact("bg", b, law=LAW, normal_force=1.0),
        fm.Contact("ag", a, law=LAW, normal_force=1.0),
        fm.Contact("cb", c, b, law=LAW, normal_force=1.0),
    ]
    (caution,) = fm.Scene("ring", [a, b, c, *contacts]).plan().cautions
    assert "contacts ab, bg, ag are redundant" in caution
