"""Parts with restitution: what is refused by name, what goes into files and on, and an audit that can fail."""

from dataclasses import replace

import numpy as np
import pytest

import fricmb as fm


def scene(e=0.6):
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    return fm.Scene("block", [block, spring, fm.Stop("ends", block, axis="x", lower=-0.8, upper=0.8, restitution=e)])


def body(**given):
    return fm.Body("body", mass=1.0, axes="xy", **given)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: fm.Stop("s", body(), axis="x", lower=0.0, restitution=1.2), "restitution must be a number from 0"),
        (lambda: fm.Stop("s", body(), axis="x", restitution=0.2), "'s': lower or upper must be given"),
        (lambda: fm.Stop("s", body(), axis="x", lower=1.0, upper=0.0, restitution=0.2), "upper must be above lower"),
        (lambda: fm.Stop("s", body(), axis="x", lower=0.0, restitution=0.2, stiffness=1.0), "must be left out beside"),
        (lambda: fm.Backlash("s", body(), axis="x", gap=0.0, restitution=0.2), "gap must be a finite number > 0"),
        (lambda: fm.RollerOnLine("s", body(), restitution=0.2), "without push_only=True"),
        (lambda: fm.RollerOnLine("s", body(), push_only=True, mu_impact=0.2), "mu_impact must be left out without"),
        (
            lambda: fm.RollerOnLine(
                "s", body(), push_only=True, restitution=0.2,
                friction=fm.laws.Stribeck(mu_s=0.3, mu_k=0.2, v_s=0.1),
            ),
            "mu_impact must be given",
        ),
        (
            lambda: fm.space.OnPlane(
                "s", fm.space.Ball("b", mass=1.0, radius=0.1), normal=(0, 0, 1), push_only=True, restitution=0.2
            ),
            "left out in space",
        ),
    ],
)  # fmt: skip
def test_what_is_not_accepted_is_refused_by_name(make, words):
    with pytest.raises(fm.SceneError, match=words):
        make()


def test_a_start_inside_is_refused():
    inside = body(position={"y": -0.1})
    floor = fm.RollerOnLine("floor", inside, push_only=True, restitution=0.2)
    with pytest.raises(fm.SceneError, match=r"'floor' is rigid, and the run starts 0\.1 inside of it"):
        fm.simulate(fm.Scene("inside", [inside, floor]), t_end=1.0)


def test_methods_that_cannot_are_refused():
    for method in ("collocation", "taylor", "bdf2-paper"):
        with pytest.raises(fm.SceneError, match="joints"):
            fm.simulate(scene(), t_end=2.0, method=method)


def test_bdf_finds_the_same_impacts():
    times = [fm.simulate(scene(), t_end=20.0, rtol=1e-8, method=method).events.t for method in ("radau", "bdf")]
    assert len(times[0]) == len(times[1]) == 7
    assert np.allclose(*times, rtol=0, atol=1e-5)


def test_files_keep_impacts(tmp_path):
    sol = fm.simulate(scene(), t_end=10.0)
    sol.save(tmp_path / "run.npz")
    back = fm.Solution.load(tmp_path / "run.npz")
    assert back.events == sol.events
    assert [event.impulse for event in back.events] == [event.impulse for event in sol.events]
    assert back.impulse("ends").side == sol.impulse("ends").side
    assert back.energy.impact_loss[-1] == sol.energy.impact_loss[-1]


def test_a_run_goes_on_between_two_impacts():
    whole = fm.simulate(scene(), t_end=10.0, rtol=1e-9)
    first = fm.simulate(scene(), t_end=3.0, rtol=1e-9)
    joined = fm.Solution.join([first, fm.simulate(scene(), t_end=10.0, rtol=1e-9, initial=first)])
    assert [event.side for event in joined.events] == [event.side for event in whole.events]
    assert np.allclose(joined.events.t, whole.events.t, rtol=0, atol=1e-8)
    assert abs(joined.energy.impact_loss[-1] - whole.energy.impact_loss[-1]) < 1e-8


def test_equations_show_what_does_not_give():
    text = str(scene().equations())
    assert "0 <= -limit_ends.lower + x_block, 0 <= lambda_ends.lower, one of them 0" in text


def test_a_value_of_restitution_is_a_parameter():
    runs = fm.sweep(scene(), [{"ends.restitution": e} for e in (0.1, 0.9)], t_end=6.0, progress=False, workers=1)
    assert runs[0].energy.impact_loss[-1] > runs[1].energy.impact_loss[-1]


def test_an_unknown_name_of_an_impulse_lists_those_there_are():
    with pytest.raises(fm.FricmbError, match="ends"):
        fm.simulate(scene(), t_end=1.0).impulse("end")


def test_what_leaves_at_once_is_not_pulled():
    """Without restitution the block stands at the stop for an instant, and the spring takes it away."""
    sol = fm.simulate(scene(0.0), t_end=3.0)
    assert sol.reaction("ends").min() >= 0.0
    assert np.abs(sol.reaction("ends")).max() == 0.0
    assert sol.audit().ok


@pytest.mark.parametrize(
    ("column", "check"), [("normal", "momentum in impacts"), ("loss", "loss of impacts")]
)  # fmt: skip
def test_the_audit_sees_a_wrong_impulse_and_a_wrong_loss(column, check):
    from fricmb.integrate.trajectory import IMPACT_COLUMNS

    sol = fm.simulate(scene(), t_end=5.0)
    assert sol.audit().ok
    trajectory = sol.run.pieces[0].trajectory
    impacts = trajectory.transitions.impacts.copy()
    impacts[:, IMPACT_COLUMNS.index(column)] *= 1.0 + 1e-6
    trajectory.transitions = replace(trajectory.transitions, impacts=impacts)
    sol.__dict__.pop("events", None)
    sol._events = None
    assert check in [failed.name for failed in sol.audit().failed]


def test_the_audit_sees_another_coefficient():
    sol = fm.simulate(scene(), t_end=5.0)
    other = sol.run.pieces[0].mechanics.placed["ends"]
    object.__setattr__(other, "restitution", 0.5)
    try:
        assert "law of impact" in [failed.name for failed in sol.audit().failed]
    finally:
        object.__setattr__(other, "restitution", 0.6)


def test_touches_of_what_is_rigid_points_to_its_impulses():
    with pytest.raises(fm.SceneError, match=r"touches: 'ends' is rigid, with restitution; sol.impulse\('ends'\)"):
        fm.simulate(scene(), t_end=1.0).touches("ends")


@pytest.mark.parametrize("restitution", [None, 0.6])
def test_what_only_pushes_takes_no_degree_of_freedom(restitution):
    assert "1 degree of freedom (1 coordinate)" in repr(fm.simulate(scene(), t_end=1.0))
    ball = fm.RigidBody("ball", mass=1.0, inertia=1.0)
    lets_go = {"when_lost": "open"} if restitution is None else {"restitution": restitution}
    parts = [ball, fm.RollerOnLine("floor", ball, push_only=True, **lets_go), fm.DrivenAngle("turn", ball, angle=0.0)]
    sol = fm.simulate(fm.Scene("ball", [*parts, fm.Gravity("g")]), t_end=0.1)
    assert "2 degrees of freedom (3 coordinates)" in sol.summary()
