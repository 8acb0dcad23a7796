"""Plans: islands, omissions with their reasons, counts, order."""

import pytest

import fricmb as fm
from fricmb.models import brake4dof, stick_slip_chain
from fricmb.plan import make_plan


def two_islands():
    a, b, c = (fm.Body(name, mass=1.0, axes="xy") for name in "abc")
    return fm.Scene(
        "islands",
        [
            a,
            b,
            c,
            fm.Spring("ab", a, b, axis="x", stiffness=1.0),
            fm.Spring("ground", c, axis="x", stiffness=1.0),
            fm.Force("push", a, axis="x", value=1.0),
            fm.Contact("rub", b, c, law=fm.laws.Coulomb(mu_s=0.3), normal_force=1.0, axes="y"),
        ],
    )


def test_brake():
    plan = brake4dof("2").plan()
    assert plan.counts["degrees of freedom"] == 4
    assert plan.counts["linear elements"] == 3
    assert plan.counts["nonlinear elements"] == 0
    assert plan.counts["contact rows"] == 2
    (omission,) = plan.left_out
    assert omission.names == ("c1x", "c1y", "c2y")
    assert omission.why == "damping = 0"
    assert len(plan.islands) == 1
    assert plan.storage == "diagonal"


def test_nothing_is_left_out_of_the_damped_brake():
    plan = brake4dof("5").plan()
    assert plan.left_out == ()
    assert plan.counts["linear elements"] == 6
    assert "left out: nothing" in str(plan)


def test_nonlinear_elements_are_those_whose_numbers_make_them_so():
    scene = brake4dof("2").with_parameters({"k1x.cubic": 0.5, "k1y.stiffness": 0.0})
    plan = scene.plan()
    assert plan.counts["nonlinear elements"] == 1
    assert plan.counts["linear elements"] == 1
    assert any(item.names == ("k1y",) and "stiffness = 0" in item.why for item in plan.left_out)


def test_islands():
    plan = make_plan(two_islands())
    groups = {island.dofs for island in plan.islands}
    assert groups == {("a.x", "b.x"), ("a.y",), ("b.y", "c.y"), ("c.x",)}
    assert {island.parts for island in plan.islands} == {("ab", "push"), (), ("rub",), ("ground",)}


def test_what_rests_is_named_with_a_reason():
    plan = make_plan(two_islands())
    assert {item.names for item in plan.resting} == {("a.y",), ("c.x", "ground"), ("b.y", "c.y", "rub")}
    assert all("at rest throughout" in item.why for item in plan.resting)
    assert "c.x with ground: at rest throughout" in str(plan)
    assert plan.counts["islands at rest"] == 3


@pytest.mark.parametrize(
    ("observe", "dofs", "parts"),
    [
        (["a.x"], ("a.x", "b.x"), {"a", "b", "ab", "push"}),
        (["rub"], ("b.y", "c.y"), {"b", "c", "rub"}),
        (["c"], ("b.y", "c.x", "c.y"), {"b", "c", "rub", "ground"}),
        (["a.x", "c.x"], ("a.x", "b.x", "c.x"), {"a", "b", "c", "ab", "push", "ground"}),
    ],
)
def test_only_whole_islands_are_left_out(observe, dofs, parts):
    plan = make_plan(two_islands(), observe)
    assert plan.dofs == dofs
    assert set(plan.parts) == parts
    assert all("observed" in item.why for item in plan.left_out)


def test_an_expression_ties_islands_together():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    pressed = fm.Contact("c", a, law=fm.laws.Coulomb(mu_s=0.3), normal_force=1 + fm.coordinate("b.x"))
    plan = make_plan(fm.Scene("s", [a, b, pressed]), ["a.x"])
    assert plan.dofs == ("a.x", "b.x")


def test_unknown_names_are_answered_with_those_near():
    with pytest.raises(fm.FricmbError, match=r"a\.x"):
        make_plan(two_islands(), ["a.xx"])


def test_bandwidth_is_reduced():
    """A ring numbered badly has half-bandwidth n - 1; in the found order 2."""
    n = 100
    bodies = [fm.Body(f"b{i}", mass=1.0) for i in range(n)]
    springs = [fm.Spring(f"s{i}", bodies[i], bodies[(i + 1) % n], axis="x", stiffness=1.0) for i in range(n)]
    plan = make_plan(fm.Scene("ring", [*bodies, *springs]))
    assert plan.bandwidth == 2
    assert plan.storage == "banded"
    assert sorted(plan.order) == sorted(plan.dofs)


def test_a_long_chain_prints_on_a_page():
    text = str(stick_slip_chain(n=80).plan())
    assert len(text.splitlines()) < 25
    assert "and 74 more: damping = 0" in text
