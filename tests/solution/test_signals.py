"""One name for each signal: against closed forms, and wherever names of signals are taken."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.errors import UnknownNameError

K, M, N, MU, BELT = 4.0, 2.0, 3.0, 0.5, 0.2


@pytest.fixture(scope="module")
def sol():
    """A block between spring and damper on a belt, its tip a point of a second body on a slanted spring."""
    block, belt = fm.Body("block", mass=M, position={"x": 1.0}), fm.Driven("belt", velocity={"x": BELT})
    ball = fm.Body("ball", mass=1.0, axes="xy", position={"x": 3.0, "y": 4.0})
    shaker = fm.Driven("shaker", position={"y": 0.1 * sympy.sin(3.0 * fm.t)})
    scene = fm.Scene("signals", [
        block, belt, ball, shaker, fm.Spring("spring", block, axis="x", stiffness=K),
        fm.Damper("damper", block, axis="x", damping=0.3), fm.PointSpring("cord", ball, stiffness=2.0, length=1.0),
        fm.Spring("shaken", ball, shaker, axis="y", stiffness=1.0),
        fm.Force("load", block, axis="x", value=0.2 * sympy.cos(fm.t)),
        fm.Contact("sole", block, belt, law=fm.laws.Coulomb(mu_s=MU), normal_force=N),
    ])  # fmt: skip
    return fm.simulate(scene, t_end=6.0, rtol=1e-10)


def test_signals_are_what_the_equations_say(sol):
    x, v, t = sol["block.x"], sol["block.x.velocity"], sol.t
    assert (v == sol.velocity("block.x")).all()
    assert sol["spring.force"] == pytest.approx(-K * x, abs=1e-14)
    assert sol["damper.force.x"] == pytest.approx(-0.3 * v, abs=1e-14)
    assert sol["load.force"] == pytest.approx(0.2 * np.cos(t), abs=1e-14)
    total = -K * x - 0.3 * v + 0.2 * np.cos(t) + sol.force("sole")[0]
    assert sol["block.x.acceleration"] == pytest.approx(total / M, abs=1e-12)
    assert (sol["sole.force"] == sol.force("sole")[0]).all()
    assert (sol["sole.force.x"] == sol["sole.force"]).all()
    assert (sol["sole.mode"] == sol.mode("sole")).all()
    slips = (sol["sole.mode"] == 1) & (np.abs(v - BELT) > 1e-9)
    assert sol["sole.force"][slips] == pytest.approx(-MU * N * np.sign(v - BELT)[slips], abs=1e-9)
    assert sol["shaker.y.acceleration"] == pytest.approx(-0.9 * np.sin(3.0 * t), abs=1e-14)
    assert sol["belt.x.acceleration"] == pytest.approx(0.0 * t)


def test_a_spring_between_points_has_components(sol):
    place = np.array([sol["ball.x"], sol["ball.y"]])
    length = np.hypot(*place)
    force = -2.0 * (length - 1.0) * place / length
    assert sol["cord.force"] == pytest.approx(force, abs=1e-12)
    assert sol["cord.force.y"] == pytest.approx(force[1], abs=1e-12)
    assert sol["ball.x.acceleration"] == pytest.approx(force[0], abs=1e-12)
    with pytest.raises(fm.SceneError, match=r"'cord.force' has 2 components; expected one of them: 'cord.force.x'"):
        sol.columns(["cord.force"])


def test_accelerations_are_slopes_of_velocities():
    sol = fm.simulate(fm.models.slider_crank(), t_end=0.05, rtol=1e-10)
    t, h = np.linspace(0.01, 0.04, 7), 1e-6
    for name in ("rod.angle", "rod.root.y", "slider.x"):
        slope = (sol.at(t + h).velocity(name) - sol.at(t - h).velocity(name)) / (2 * h)
        assert sol.at(t)[f"{name}.acceleration"] == pytest.approx(slope, rel=1e-4, abs=1e-4 * np.abs(slope).max())


def test_coupled_masses_have_accelerations():
    a, b = fm.Body("a", mass=1.0, position={"x": 1.0}), fm.Body("b", mass=2.0)
    coupled = fm.MatrixElement("coupling", ["a.x", "b.x"], M=[[1.0, 0.5], [0.5, 0.0]], K=[[3.0, 0.0], [0.0, 1.0]])
    sol = fm.simulate(fm.Scene("coupled", [a, b, coupled]), t_end=3.0, rtol=1e-8)
    found = np.array([sol["a.x.acceleration"], sol["b.x.acceleration"]])
    assert np.array([[2.0, 0.5], [0.5, 2.0]]) @ found == pytest.approx(-np.diag([3.0, 1.0]) @ sol.q, abs=1e-12)


def test_joined_runs_take_each_part_by_its_scene(sol):
    other = fm.simulate(sol.scene.with_parameters({"spring.stiffness": 9.0}), t_end=8.0, initial=sol)
    both = fm.Solution.join([sol, other]).at([3.0, 7.0])
    assert both["spring.force"] == pytest.approx([-K * both["block.x"][0], -9.0 * both["block.x"][1]])
    assert both["block.x.acceleration"][1] == pytest.approx(other.at([7.0])["block.x.acceleration"][0])


@pytest.mark.parametrize(
    ("name", "meant"),
    [
        ("sole.friction", "sole.force"), ("block.x.vel", "block.x.velocity"), ("spring.frce", "spring.force"),
        ("sole.force.z", "sole.force.x"), ("sole.normal", "sole.normal_force"), ("blok.x", "block.x"),
        ("block.x.accel", "block.x.acceleration"),
    ],
)  # fmt: skip
def test_wrong_names_suggest_the_right_one(sol, name, meant):
    for ask in (sol.__getitem__, sol.plot.spectrum, lambda name: fm.analysis.poincare_section(sol, (name, 0.0))):
        with pytest.raises(UnknownNameError, match=f"unknown signal {name!r}; .*{meant!r}"):
            ask(name)


def test_all_names_are_signals(sol):
    table = sol.columns(sol.signal_names())
    assert all(values.shape == sol.t.shape for values in table.values())
    assert {"block.x.acceleration", "sole.force", "cord.force.x", "shaker.y.velocity"} <= set(table)
    assert set(sol.columns()) <= {*table}
    assert set(sol.to_pandas(["sole.force"]).columns) == {"sole.force"}


def test_a_file_that_was_read_has_them_too(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    again = fm.Solution.load(tmp_path / "run.npz")
    for name in ("block.x.acceleration", "spring.force", "sole.force"):
        assert (again[name] == sol[name]).all()


def test_they_are_known_wherever_signals_are(sol):
    scene = sol.scene
    assert fm.analysis.uniform(sol, "ball.x.acceleration", dt=0.05).name == "ball.x.acceleration"
    passes = fm.analysis.poincare_section(sol, ("spring.force", 0.0), discard=0.0, rising=None)
    assert passes["block.x"] == pytest.approx(0.0, abs=1e-10)
    assert passes["sole.mode"].shape == passes.t.shape
    observed = fm.simulate(scene, t_end=1.0, observe=["sole.force", "block.x.acceleration"])
    assert observed.dof_names == ("block.x",)
    with pytest.raises(UnknownNameError, match=r"unknown name to observe 'sle.force'"):
        fm.simulate(scene, t_end=1.0, observe=["sle.force"])
    options = {"t_end": 1.0, "t_eval": [0.5, 1.0], "workers": 1, "progress": False}
    one = fm.sweep(scene, [{}], reduce="sole.force", **options)[0]
    several = fm.sweep(scene, [{}], reduce=["sole.force", "block.x.velocity"], **options)[0]
    assert (several["sole.force"] == one).all()
    with pytest.raises(fm.SceneError, match="reduce: got 3"):
        fm.sweep(scene, [{}], reduce=3, **options)


def test_fits_take_accelerations_and_forces():
    scene = fm.models.belt_oscillator(mu_s=1.5, mu_k=1.0, belt=0.2)
    t = np.linspace(0.05, 15.0, 120)
    truth = {"spring.stiffness": 1.3, "sole.law.mu_k": 0.9}
    run = fm.simulate(scene.with_parameters(truth), t_end=15.0, t_eval=t, rtol=1e-9)
    data = {"t": t, "mass.x.acceleration": run["mass.x.acceleration"], "sole.force": run["sole.force"]}
    bounds = {"spring.stiffness": (1.0, 1.6), "sole.law.mu_k": (0.7, 1.1)}
    found = fm.fit(scene, data, parameters=bounds, progress=False)
    for name, value in truth.items():
        assert found.values[name] == pytest.approx(value, rel=1e-5)
    with pytest.raises(UnknownNameError, match=r"unknown signal 'sole.friction'"):
        fm.fit(scene, {"t": t, "sole.friction": t}, parameters=bounds, progress=False)


def test_hertz():
    modes = fm.ModalBody("plate", frequencies=[100.0, 250.0] * fm.Hz, damping_ratios=0.01, shapes={"tip": [1.0, 1.0]})
    assert modes.frequencies == pytest.approx([200.0 * np.pi, 500.0 * np.pi])
    assert 50 * fm.Hz == pytest.approx(100.0 * np.pi)
    assert np.array([1.0, 2.0]) * fm.Hz == pytest.approx([2 * np.pi, 4 * np.pi])
    assert (fm.Hz * fm.t).subs(fm.t, 1.0) == pytest.approx(2 * np.pi)
