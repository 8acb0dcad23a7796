"""Formulas without a value where a run starts: every method says soon which one it is."""

from __future__ import annotations

import pytest
import sympy

import fricmb as fm

X, T = fm.coordinate("b.x"), fm.t


def pulled(value: sympy.Expr) -> fm.Scene:
    """A block that rests on a spring, beside a force that has no value there."""
    block = fm.Body("b", mass=1.0)
    return fm.Scene("pulled", [block, fm.Spring("k", block, axis="x", stiffness=1.0),
                               fm.Force("f", block, axis="x", value=value)])  # fmt: skip


def rubbed(velocity: sympy.Expr | float, load: sympy.Expr | float) -> fm.Scene:
    """A block on a belt."""
    block, belt = fm.Body("b", mass=1.0), fm.Driven("d", velocity={"x": velocity})
    rubs = fm.Contact("c", block, belt, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.3), normal_force=load)
    return fm.Scene("rubbed", [block, belt, fm.Spring("k", block, axis="x", stiffness=1.0), rubs])


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize(("scene", "named"), [
    (pulled(1 / X), r"f.value = 1/b.x is inf at t = 0"),
    (pulled(sympy.sqrt(X - 1)), r"f.value = sqrt\(b.x - 1\) is nan at t = 0"),
    (pulled(1 / T), r"f.value = 1/t is inf at t = 0"),
    (rubbed(1 / T, 1.0), r"d.velocity.x = 1/t is inf at t = 0"),
    (rubbed(0.3, 1 / T), r"c.normal_force = 1/t is inf at t = 0"),
], ids=["1/x", "root of x - 1", "1/t", "belt 1/t", "load 1/t"])  # fmt: skip
def test_a_formula_without_a_value_at_the_start_is_named(scene: fm.Scene, named: str, method: str) -> None:
    with pytest.raises(fm.IntegrationError, match=named) as caught:
        fm.simulate(scene, t_end=3.0, method=method, time_limit=60.0)
    assert caught.value.t == 0.0


def test_a_stiffness_without_a_value_at_the_start_is_no_hindrance_for_bdf() -> None:
    """A root has a value at 0 and no slope."""
    block = fm.Body("b", mass=1.0, velocity={"x": 1.0})
    scene = fm.Scene("leaves", [block, fm.Force("f", block, axis="x", value=sympy.sqrt(X))])
    found, other = (fm.simulate(scene, t_end=1.0, method=method, rtol=1e-8) for method in ("bdf", "radau"))
    assert found.q[0, -1] == pytest.approx(other.q[0, -1], rel=1e-6)
