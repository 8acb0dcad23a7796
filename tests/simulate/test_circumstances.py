"""What an error says where no step could be taken: which contacts, what is pushed, what to try."""

from types import SimpleNamespace

import numpy as np
import sympy

import fricmb as fm
from fricmb._simulate._circumstances import circumstances

REASON = "the step size fell below round-off: the equations of the step could not be solved to tolerance"


def said(scene, t_end, reason=REASON):
    """Of a run up to ``t_end``, as if it had stopped there."""
    sol = fm.simulate(scene, t_end=t_end, method="radau")
    (piece,) = sol.run.pieces
    return circumstances(piece.mechanics, piece.trajectory, reason)


def pair(law, belt=0.1):
    blocks = [fm.Body(f"b{i}", mass=1.0, velocity={"x": belt}) for i in (1, 2)]
    moving = fm.Driven("belt", velocity={"x": belt})
    springs = [fm.Spring(f"k{i}", b, axis="x", stiffness=1.0) for i, b in enumerate(blocks)]
    contacts = [fm.Contact(f"c{i + 1}", b, moving, law=law, normal_force=1.0) for i, b in enumerate(blocks)]
    return fm.Scene("pair", [*blocks, moving, *springs, *contacts])


def test_contacts_that_are_about_to_change_are_named():
    """Both blocks break away at x = 1, t = 10: just before that both hold all they can."""
    text = said(pair(fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)), 10.0 - 1e-6)
    assert "at the limit of sticking: 'c1', 'c2'" in text
    assert "set these contacts apart" in text
    assert "limit" not in said(pair(fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)), 5.0)


def test_the_advice_goes_with_the_scene():
    assert "softer law for 'c1', 'c2'" in said(pair(fm.laws.LinearRegularised(mu=1.0, v_reg=1e-3)), 1.0)
    b = fm.Body("b", mass=1.0, velocity={"x": 1.0})
    jump = fm.Force("F", b, axis="x", value=sympy.sign(fm.coordinate("b.x") - 5.0))
    contact = fm.Contact("c", b, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0)
    assert "smooth what jumps with the motion in 'F'" in said(fm.Scene("s", [b, jump, contact]), 0.5)


def test_other_reasons_are_left_as_they_are():
    assert said(pair(fm.laws.Coulomb(mu_s=1.0)), 1.0, "forces or accelerations became infinite") == ""


def test_rows_that_are_no_numbers_say_nothing():
    row = SimpleNamespace(q=np.array([[np.nan]]), v=np.array([[0.0]]))
    assert circumstances(None, SimpleNamespace(row_motion=lambda: row), REASON) == ""
