import pickle

import numpy as np
import pytest
import sympy

import fricmb as fm


def test_the_integrator_gets_what_was_asked_for(scene, exact, exact_steps):
    times = np.linspace(1.0, 5.0, 9)
    method = exact()
    sol = fm.simulate(scene, t_end=5.0, t_start=1.0, rtol=1e-7, atol=1e-9, t_eval=times, method=method)
    ((problem, start, t_end, given),) = method.calls
    assert problem.n == 2
    assert (start.t, t_end) == (1.0, 5.0)
    assert start.v.tolist() == [0.0, 1.0]
    assert given["tolerance"].rtol == 1e-7
    assert given["tolerance"].atol_q.tolist() == [1e-9, 1e-9]
    assert given["step"] is None
    assert given["progress"] is None
    np.testing.assert_array_equal(given["t_eval"], times)
    np.testing.assert_array_equal(sol.t, times)
    steps = exact_steps()
    fm.simulate(scene, t_end=5.0, step=0.25, method=steps)
    assert steps.calls[0][3]["step"] == 0.25


def test_the_solution_is_that_of_the_scene(scene, exact):
    sol = fm.simulate(scene, t_end=5.0, method=exact())
    omega, shapes = np.linalg.eigh(np.diag([1, 2**-0.5]) @ np.array([[5.0, -2.0], [-2.0, 3.0]]) @ np.diag([1, 2**-0.5]))
    modal = shapes.T @ [0.0, 2**0.5]
    omega = np.sqrt(omega)
    x = np.diag([1, 2**-0.5]) @ shapes @ (modal[:, None] / omega[:, None] * np.sin(omega[:, None] * sol.t))
    np.testing.assert_allclose(sol.q, x, atol=1e-13)
    np.testing.assert_array_equal(sol["b.x"], sol.q[1])
    assert sol.dof_names == ("a.x", "b.x")
    assert sol.scene is scene
    assert np.abs(sol.energy.residual).max() < 1e-12
    assert sol.energy.kinetic[0] == 1.0


def test_stats_tell_what_the_integrator_counted(scene, exact):
    stats = fm.simulate(scene, t_end=5.0, method=exact()).stats
    assert (stats.method, stats.why) == ("exact", "given by method=")
    assert (stats.n_steps, stats.n_rejected, stats.n_rhs, stats.n_jac, stats.n_lu) == (10, 1, 20, 2, 3)
    assert stats.notes == ("exact",)
    assert 0 <= stats.compile_s <= stats.wall_s


def test_parameters_of_a_run(scene, exact):
    sol = fm.simulate(scene, t_end=5.0, method=exact(), parameters={"k": 4.0, "left.stiffness": 0.0})
    assert sol.scene.parameters["k"] == 4.0
    assert scene.parameters["k"] == 2.0
    np.testing.assert_array_equal(
        sol.q, fm.simulate(scene.with_parameters({"k": 4.0, "left.stiffness": 0.0}), t_end=5.0, method=exact()).q
    )


def test_a_run_starts_from_given_values(scene, exact):
    initial = {"position": {"a.x": 0.5}, "velocity": {"b.x": -1}}
    sol = fm.simulate(scene, t_end=5.0, method=exact(), initial=initial)
    assert sol.q[:, 0].tolist() == [0.5, 0.0]
    assert sol.v[:, 0].tolist() == [0.0, -1.0]


def test_a_run_goes_on_from_another(scene, exact):
    first = fm.simulate(scene, t_end=2.0, method=exact())
    second = fm.simulate(scene, t_end=5.0, method=exact(), initial=first)
    whole = fm.simulate(scene, t_end=5.0, method=exact())
    assert second.t_start == 2.0
    np.testing.assert_allclose(second(4.0), whole(4.0), atol=1e-14)
    joined = fm.Solution.join([first, second])
    np.testing.assert_allclose(joined([1.0, 2.0, 3.0]), whole([1.0, 2.0, 3.0]), atol=1e-14)
    heavier = scene.with_parameters({"b.mass": 3.0})
    assert fm.simulate(heavier, t_end=5.0, method=exact(), initial=first).q[0, 0] == first.q[0, -1]
    with pytest.raises(fm.SceneError, match=r"t_start: got 1.0, but the run goes on from"):
        fm.simulate(scene, t_end=5.0, t_start=1.0, method=exact(), initial=first)
    other = fm.Scene("other", [fm.Body("c", mass=1.0)])
    with pytest.raises(fm.SceneError, match=r"no degree of freedom 'c.x'; it has a.x, b.x"):
        fm.simulate(other, t_end=5.0, method=exact(), initial=first)


def test_a_run_that_fails_leaves_its_part(scene, exact):
    with pytest.raises(fm.IntegrationError, match=r"exact stopped at t = 2\.5: it broke") as caught:
        fm.simulate(scene, t_end=5.0, method=exact(failure="it broke"), t_eval=np.linspace(0, 5, 11))
    error = caught.value
    assert (error.t, error.reason) == (2.5, "it broke")
    assert error.partial.t.tolist() == np.linspace(0, 2.5, 6).tolist()
    assert error.partial.t_end == 2.5
    assert error.partial.stats.n_steps == 10
    again = pickle.loads(pickle.dumps(error))
    assert again.reason == "it broke"
    np.testing.assert_array_equal(again.partial(1.0), error.partial(1.0))


@pytest.mark.parametrize("t_eval", [None, np.linspace(0.0, 5.0, 21)])
def test_what_is_not_finite_is_an_error_with_the_sound_part(scene, exact, t_eval):
    with pytest.raises(fm.IntegrationError, match=r"exact stopped at t = .*: a value is not finite") as caught:
        fm.simulate(scene, t_end=5.0, method=exact(not_finite_after=3.1), t_eval=t_eval)
    partial = caught.value.partial
    assert caught.value.t > 3.1
    assert partial.t_end == 3.0
    assert np.isfinite(partial.q).all()
    assert np.isfinite(partial.energy.kinetic).all()
    with pytest.raises(fm.SceneError, match="outside the run"):
        partial(3.2)


def test_nothing_sound_leaves_no_part(scene, exact):
    with pytest.raises(fm.IntegrationError, match=r"exact stopped at t = .*: a value is not finite") as caught:
        fm.simulate(scene, t_end=5.0, method=exact(not_finite_after=-1.0))
    assert caught.value.partial is None


def test_a_bar_shows_the_progress(scene, exact, capsys):
    fm.simulate(scene, t_end=5.0, method=exact(), progress=True)
    said = capsys.readouterr()
    assert said.out == ""
    assert "100%" in said.err
    fm.simulate(scene, t_end=5.0, method=exact())
    assert capsys.readouterr().err == ""


def test_a_bar_ends_full_and_a_notice_has_its_own_line(scene, exact, capsys):
    from fricmb._simulate._progress import progress_bar
    from fricmb.integrate.compile.cache_files import say

    with progress_bar(True, 2.0, 12.0) as forward:
        say("a notice")
        forward(4.0)
        forward(11.0)  # the last that is told lies before the end
    said = capsys.readouterr().err
    assert any(line.strip() == "fricmb: a notice" for part in said.split("\n") for line in part.split("\r"))
    assert "100%" in said.split("\r")[-1]
    with pytest.raises(TypeError), progress_bar(True, 2.0, 12.0) as forward:
        forward("no time")
    assert "100%" not in capsys.readouterr().err


def test_the_time_to_load_kernels_does_not_count_in_the_estimate(capsys, monkeypatch):
    from fricmb._simulate import _progress

    now = [0.0]
    monkeypatch.setattr("time.time", lambda: now[0])
    monkeypatch.setattr("tqdm.std.time", lambda: now[0])
    with _progress.progress_bar(True, 0.0, 100.0) as forward:
        for now[0], t in ((60.0, 1.0), (61.0, 11.0), (62.0, 21.0)):  # a minute of loading, then ten a second
            forward(t)
    assert "00:08]" in capsys.readouterr().err  # 79 of 100 are left


WRONG = [
    ({"t_end": -1.0}, "t_end: got -1.0; expected a finite time after t_start = 0"),
    ({"t_start": 5.0}, "t_end: got 5.0; expected a finite time after t_start = 5"),
    ({"t_start": None}, "t_start: got None; expected a finite time"),
    ({"rtol": 2.0}, "rtol: got 2.0; expected a number from 1e-14 to 0.1"),
    ({"t_eval": [0.0, 6.0]}, "t_eval: the time 6.0 is outside the run"),
    ({"t_eval": [1.0, 0.5]}, "expected times in rising order"),
    ({"method": 3}, "method: got 3; expected one of 'auto', "),
    ({"step": 0.1}, "step: got 0.1, but the method 'exact' chooses its steps itself"),
    ({"parameters": ["k"]}, "parameters: got .* expected a dict"),
    ({"parameters": {"kk": 1.0}}, "unknown parameter .*'kk'; did you mean 'k'"),
    ({"parameters": {"left.stiffness": "stiff"}}, "Spring 'left': stiffness must be"),
    ({"observe": "a.x"}, "observe: got 'a.x'; expected a list"),
    ({"observe": ["a.y"]}, "unknown name to observe 'a.y'; did you mean 'a.x'"),
    (
        {"initial": 0.5},
        "initial: got 0.5; expected a Solution or a dict with any of the keys position, velocity, state",
    ),
    ({"initial": {"positions": {}}}, "unknown key of initial 'positions'; did you mean 'position'"),
    ({"initial": {"position": 1.0}}, "expected a dict of names and values"),
    ({"initial": {"position": {"a.y": 1.0}}}, "unknown degree of freedom .*'a.y'; did you mean 'a.x'"),
    ({"initial": {"velocity": {"a.x": np.nan}}}, "got nan; expected a finite number"),
    ({"initial": {"state": {"lining": 1.0}}}, "unknown contact 'lining'; there are none"),
]


@pytest.mark.parametrize(("given", "message"), WRONG, ids=lambda value: str(value)[:40])
def test_a_wrong_argument_is_told_on_one_line(scene, exact, given, message):
    with pytest.raises(fm.SceneError, match=message) as caught:
        fm.simulate(scene, **{"t_end": 5.0, "method": exact(), **given})
    assert "\n" not in str(caught.value)


def test_a_wrong_scene_or_method_is_told(scene):
    with pytest.raises(fm.SceneError, match="scene: got 'brake'; expected a Scene"):
        fm.simulate("brake", t_end=1.0)
    with pytest.raises(KeyError, match=r"unknown method 'autto'; did you mean 'auto'"):
        fm.simulate(scene, t_end=1.0, method="autto")


def test_an_integrator_may_refuse(exact):
    a = fm.Body("a", mass=1.0, axes="xy", position={"x": 2.0})
    scene = fm.Scene("pendulum", [a, fm.PointSpring("rod", a, stiffness=1.0, length=1.0)])
    with pytest.raises(fm.SceneError, match="method: exact takes linear structures"):
        fm.simulate(scene, t_end=1.0, method=exact())


def test_instants_that_have_to_be_searched_are_stepped_to():
    t = fm.t
    body = fm.Body("body", mass=1.0)
    scene = fm.Scene("square wave", [body, fm.Force("f", body, axis="x", value=sympy.sign(sympy.sin(2 * t)))])
    sol = fm.simulate(scene, t_end=7.0, rtol=1e-9)
    switches = np.arange(1, 5) * np.pi / 2
    assert np.abs(sol.t[:, None] - switches).min(axis=0) == pytest.approx(0.0, abs=1e-12)
    assert sol.velocity("body.x")[-1] == pytest.approx(7.0 - 4 * np.pi / 2, abs=1e-9)


def test_slip_at_round_off_is_no_negative_friction():
    laws = [fm.laws.HyperbolicStribeck(mu_s=1.0 + 0.3 * i, delta=3.0) for i in range(2)]
    scene = fm.models.stick_slip_chain(2, coupling=1.2, laws=laws)
    sol = fm.simulate(scene, t_end=100.0, rtol=1e-8)
    assert sol.t_end == 100.0
    assert np.diff(sol.energy.friction_loss).min() > -1e-9


@pytest.mark.parametrize("value", [1 / fm.coordinate("block.x"), 1 / fm.t], ids=str)
def test_a_force_without_a_value_at_the_start_is_named(value):
    block = fm.Body("block", mass=1.0)
    scene = fm.Scene("no value", [block, fm.Force("pull", block, axis="x", value=value)])
    with pytest.raises(fm.IntegrationError, match=r"pull\.value = .* is inf at t = 0$") as error:
        fm.simulate(scene, t_end=1.0, method="radau")
    assert (error.value.t, error.value.partial) == (0.0, None)
    assert "pull.value" in error.value.reason
