"""A spring that leaves no digit in the stiffness matrix beside a far stiffer one is refused, not dropped."""

import numpy as np
import pytest

import fricmb as fm


def pair(soft, tie, *more):
    a, b = (fm.Body(name, mass=1.0, position={"x": 1.0}) for name in "ab")
    law = fm.laws.Coulomb(mu_s=0.01)
    held = fm.Spring("soft", a, axis="x", stiffness=soft)
    return fm.Scene("pair", [
        a, b, held, fm.Spring("tie", a, b, axis="x", stiffness=tie),
        fm.Contact("c", b, law=law, normal_force=1.0), *(make(a, b) for make in more),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["auto", "radau"])
def test_a_soft_spring_beside_a_tie_that_takes_its_last_digit_is_refused(method):
    with pytest.raises(fm.SceneError, match=r"soft: stiffness: 1 leaves no digit at 'a\.x'.*1e\+17"):
        fm.simulate(pair(1.0, 1e17), t_end=2.0, method=method)


def test_just_below_it_moves():
    sol = fm.simulate(pair(1.0, 3e15), t_end=2.0, method="radau", rtol=1e-6)
    assert sol["a.x"] == pytest.approx(0.01 + 0.99 * np.cos(np.sqrt(0.5) * sol.t), abs=1e-5)


def test_one_beside_a_stiffer_one_between_the_same_places_is_no_loss():
    def beside(a, b):
        return fm.Spring("beside", a, b, axis="x", stiffness=1e-3)

    scene = pair(1e3, 1e15, beside)
    assert fm.simulate(scene, t_end=0.1, method="radau").stats.method == "radau"
