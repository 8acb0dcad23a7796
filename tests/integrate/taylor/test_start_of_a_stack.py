"""Who sticks at the start of a stack, where more than one set of contacts could."""

import numpy as np
import pytest

import fricmb as fm


@pytest.mark.parametrize("method", ["taylor", "radau", "auto"])
def test_what_was_let_go_before_others_is_held_again(method):
    """Alone the lower contact would let go first; once the upper one has, it holds 0.325 of 0.333 and need not slip."""
    lower, upper = (fm.Body(name, mass=1.0, axes="x") for name in ("lower", "upper"))
    scene = fm.Scene("stack", [
        lower, upper,
        fm.Force("back", lower, axis="x", value=-0.07), fm.Force("pull", upper, axis="x", value=5.0),
        fm.Contact("ground", lower, law=fm.laws.Coulomb(mu_s=0.333, mu_k=0.256), normal_force=1.0),
        fm.Contact("between", upper, lower, law=fm.laws.Coulomb(mu_s=0.395, mu_k=0.395), normal_force=1.0),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=1.0, t_eval=np.linspace(0.0, 1.0, 11), method=method)
    assert abs(sol["lower.x"]).max() < 1e-20
    np.testing.assert_allclose(sol["upper.x"], 0.5 * (5.0 - 0.395) * sol.t**2, rtol=1e-12)
    assert sol.audit().ok
