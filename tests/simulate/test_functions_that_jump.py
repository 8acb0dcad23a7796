"""Prescribed motions that jump or switch without end: against closed forms, and the same written piece by piece."""

import numpy as np
import pytest
import sympy

import fricmb as fm

time = fm.t
STEP = sympy.Heaviside(time - 1)
K, N, MU = 10.0, 4.0, 0.1


def pulled(base, *, end=fm.Spring, friction=True):
    """A block held by a spring, or what else, from a base that is moved; mass 1."""
    block = fm.Body("block", mass=1.0)
    given = {"axis": "x", "stiffness": K} if end is fm.Spring else {"axis": "x", "damping": 1.0}
    rub = [fm.Contact("floor", block, law=fm.laws.Coulomb(mu_s=MU), normal_force=N)] if friction else []
    return fm.Scene("pulled", [block, base, end("pull", block, base, **given), *rub])


def carried(velocity):
    """A block on a spring and a belt."""
    block, belt = fm.Body("block", mass=1.0), fm.Driven("belt", velocity={"x": velocity})
    return fm.Scene("carried", [
        block, belt, fm.Spring("spring", block, axis="x", stiffness=K),
        fm.Contact("lining", block, belt, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.3), normal_force=N),
    ])  # fmt: skip


@pytest.mark.parametrize("method", ["auto", "bdf"])
def test_a_base_that_jumps_brings_what_its_spring_stores(method):
    """Nothing of it was in the ledger, and a note blamed rtol."""
    sol = fm.simulate(pulled(fm.Driven("base", position={"x": STEP})), t_end=3.0, rtol=1e-6, method=method)
    np.testing.assert_allclose(sol["block.x"][-1], _dragged(3.0), atol=1e-5)
    np.testing.assert_allclose(sol.energy.input[-1], 0.5 * K, rtol=1e-6)
    for here in (sol, sol.at([0.5, 1.0, 1.5])):
        assert np.abs(here.energy.residual).max() < 1e-5
    assert not any("ledger" in note for note in sol.stats.notes)
    assert sol.audit().ok


def _dragged(t):
    """From rest towards 1, from reversal to reversal by half periods: amplitudes fall by twice mu N / k."""
    w, slack, x = np.sqrt(K), MU * N / K, 0.0
    t, sign = t - 1.0, 1.0
    while t > np.pi / w:
        middle = 1.0 - sign * slack
        x, t, sign = 2.0 * middle - x, t - np.pi / w, -sign
    middle = 1.0 - sign * slack
    return middle + (x - middle) * np.cos(w * t)


@pytest.mark.parametrize("between", [0.5, 1.0, 1.5])
def test_a_base_that_jumps_in_runs_that_go_on(between, tmp_path):
    """At the end of a run it has not jumped yet, at the start of the next it has."""
    scene = pulled(fm.Driven("base", position={"x": STEP}))
    first = fm.simulate(scene, t_end=between, rtol=1e-6)
    joined = fm.Solution.join([first, fm.simulate(scene, t_end=3.0, initial=first, rtol=1e-6)])
    joined.save(tmp_path / "run.npz")
    for sol in (joined, fm.Solution.load(tmp_path / "run.npz")):
        np.testing.assert_allclose(sol.energy.input[-1], 0.5 * K, rtol=1e-6)
        assert np.abs(sol.energy.residual).max() < 1e-6


def test_bases_that_jump_again_and_again():
    square = fm.Driven("base", position={"x": 0.1 * sympy.sign(sympy.sin(sympy.sqrt(7) * time))})
    sol = fm.simulate(pulled(square), t_end=10.0, rtol=1e-6)
    assert np.abs(sol.energy.residual).max() < 1e-6
    assert sol.energy.input[-1] > 1.0
    stairs = fm.Driven("base", position={"x": 0.1 * sympy.floor(3 * time)})
    steps = fm.Driven("base", position={"x": sum(0.1 * sympy.Heaviside(3 * time - k) for k in range(1, 13))})
    found = [fm.simulate(pulled(base), t_end=4.1, rtol=1e-8) for base in (stairs, steps)]
    np.testing.assert_allclose(*[sol["block.x"][-1] for sol in found], atol=1e-9)
    np.testing.assert_allclose(*[sol.energy.input[-1] for sol in found], atol=1e-9)
    assert all(sol.audit().ok for sol in found)


def test_jumps_that_would_be_infinite_speeds_are_refused():
    """A damper between them felt nothing, a joint's body was elsewhere at once."""
    base = fm.Driven("base", position={"x": STEP})
    message = r"Driven 'base': position\['x'\] jumps by 1 at t = 1, and Damper 'pull' would feel an infinite speed"
    with pytest.raises(fm.SceneError, match=message):
        fm.simulate(pulled(base, end=fm.Damper), t_end=3.0)
    fm.simulate(pulled(base, end=fm.Damper), t_end=0.9)
    block = fm.Body("block", mass=1.0)
    rubs = fm.Contact("lining", block, base, law=fm.laws.Coulomb(mu_s=MU), normal_force=N)
    with pytest.raises(fm.SceneError, match="Contact 'lining' would feel an infinite speed"):
        fm.simulate(fm.Scene("rubs", [block, base, rubs]), t_end=3.0)
    bar = fm.RigidBody("bar", mass=1.0, inertia=1.0)
    turn = sympy.Piecewise((time, time < 1), (2 * time, True))
    crank = fm.Scene("crank", [bar, fm.Revolute("pin", bar), fm.DrivenAngle("drive", bar, angle=turn)])
    with pytest.raises(fm.SceneError, match="DrivenAngle 'drive': angle jumps by 1 at t = 1"):
        fm.simulate(crank, t_end=3.0)
    moved = fm.Scene("moved", [bar, base, fm.Revolute("pin", bar, base)])
    with pytest.raises(fm.SceneError, match="Revolute 'pin' would feel an infinite speed"):
        fm.simulate(moved, t_end=3.0)


@pytest.mark.parametrize("velocity", [
    sympy.sign(sympy.sin(sympy.sqrt(7) * time)), sympy.Abs(sympy.sin(2 * time)) - 0.3,
    sympy.Max(0.2, sympy.cos(3 * time)),
])  # fmt: skip
def test_belts_that_switch_without_end(velocity):
    """The default method took steps as short as the tolerance, and hardly came to an end."""
    auto = fm.simulate(carried(velocity), t_end=5.0, rtol=1e-8)
    assert auto.stats.n_steps < 200
    other = fm.simulate(carried(velocity), t_end=5.0, rtol=1e-8, method="radau")
    np.testing.assert_allclose(auto.events.t, other.events.t, atol=1e-6)
    np.testing.assert_allclose(auto["block.x"][-1], other["block.x"][-1], atol=1e-7)
    assert auto.audit().ok


def test_a_belt_whose_way_is_not_known_is_not_made_up():
    """What SymPy finds for the integral of |sin| falls back wherever the sine changes its sign."""
    velocity = sympy.Abs(sympy.sin(2 * time))
    with pytest.raises(fm.SceneError, match="has no closed form and the scene depends on the position"):
        fm.simulate(pulled(fm.Driven("base", velocity={"x": velocity})), t_end=5.0)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_belt_that_jumps_as_a_run_ends(method):
    """What switches at the last instant was not seen as such, and the run's last power was that behind it."""
    pieces = [(0.3 * k - 0.5, time < sympy.Rational(k + 1, 2)) for k in range(10)]
    stairs, steps = carried(0.3 * sympy.floor(2 * time) - 0.5), carried(sympy.Piecewise(*pieces, (2.5, True)))
    one, other = (fm.simulate(scene, t_end=5.0, rtol=1e-7, method=method) for scene in (stairs, steps))
    np.testing.assert_allclose(one.energy.friction_loss[-1], other.energy.friction_loss[-1], rtol=1e-9)
