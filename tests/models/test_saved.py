"""What is saved comes back: the scene of every model and law, and the same values between the steps, bit by bit."""

import json
import sys
from dataclasses import dataclass

import numpy as np
import pytest
import scipy.sparse
import sympy

import fricmb as fm
from fricmb.models import catalogue
from fricmb.solution._data import Reader, Writer
from fricmb.solution._kinds import Kinds
from fricmb.solution._stored import Stored


def run(scene, tmp_path, **options):
    """A short run, saved and read again."""
    sol = fm.simulate(scene, rtol=1e-4, **options)
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as data:
        assert all(data[name].dtype != object for name in data.files)
        json.loads(data["run"].tobytes())
    back = fm.Solution.load(tmp_path / "run.npz")
    assert isinstance(back._run, Stored)
    assert back.scene == sol.scene
    assert hash(back.scene) == hash(sol.scene)
    assert list(back.scene.parameters) == list(sol.scene.parameters)
    times = np.linspace(sol.t_start, sol.t_end, 23)
    np.testing.assert_array_equal(back(times), sol(times))
    for contact in sol.contact_names:
        np.testing.assert_array_equal(back.at(times).force(contact), sol.at(times).force(contact))
    np.testing.assert_array_equal(back.end.q, sol.end.q)
    for name in sol.names.known_motions():
        np.testing.assert_array_equal(back[name], sol[name])
    assert back.stats == sol.stats
    assert back.events == sol.events
    return sol, back


@pytest.mark.parametrize("name", sorted(catalogue))
def test_the_scene_of_every_model(name, tmp_path):
    model = catalogue[name]
    run(model.build(), tmp_path, t_end=min(model.t_end, 1.0) / 20)


@pytest.mark.parametrize("method", ["bdf", "radau", "taylor", "bdf2-paper"])
def test_every_integrator(method, tmp_path):
    scene = fm.models.stick_slip_chain(n=3)
    step = {"step": 0.01} if method == "bdf2-paper" else {}
    run(scene, tmp_path, t_end=0.5, method=method, **step)


@pytest.mark.parametrize("name", fm.laws.names)
def test_every_law(name, tmp_path):
    law = getattr(fm.laws, name).example()
    there_and_back(contact_of(law))


def there_and_back(scene):
    """A scene as data and again."""
    writer = Writer()
    held = json.loads(json.dumps([writer.write(scene), writer.kinds, writer.objects], allow_nan=False))
    back = Reader(held[1], held[2], writer.arrays(), Kinds((), writer.sources)).read(held[0])
    assert back == scene
    assert hash(back) == hash(scene)
    assert list(back.parameters) == list(scene.parameters)
    return back


def test_formulas_parameters_points_and_matrices():
    p = fm.parameter("p", 3.0)
    x, v, t = fm.coordinate("a.x"), fm.speed("a.x"), fm.t
    a = fm.Body("a", mass=p, axes="xy", velocity={"x": p})
    plate = fm.ModalBody(
        "plate", frequencies=(0.0, 2.0 * p), damping_ratios=0.01, shapes={"tip": np.array([[1.0, 0.5], [0.25, 1 / 3]])},
        axes="xy", position={"mode1": 0.1},
    )  # fmt: skip
    ramp = sympy.Piecewise((t**2, t < 1), (2 * t - 1, (t >= 1) & (t < 3)), (5, True))
    drive = fm.Driven("drive", velocity={"x": ramp, "y": sympy.Heaviside(t - 2) * sympy.sin(3 * t + p)})
    load = p * sympy.exp(-v**2) + sympy.Rational(1, 3) * sympy.Abs(x) - sympy.Max(0, x) + sympy.Float("0.1", 30) * t
    pair = fm.Force("pull", a, axis=(1.0, 2.0), value=load + sympy.sqrt(1 + x**2) + sympy.pi + sympy.atan2(x, 1 + t**2))
    matrix = scipy.sparse.csr_array(np.array([[2.0, -1.0], [-1.0, 2.0]]))
    scene = fm.Scene("all kinds", [
        a, plate, drive, pair,
        fm.Spring("s", a, plate.point("tip"), axis="x", stiffness=2 * p, cubic=0.5),
        fm.PointSpring("ps", a, stiffness=1.0, anchor=(1.0, 2.0), length=0.3),
        fm.MatrixElement("m", ["a.x", "a.y"], M=matrix, K=np.array([[p, 0.0], [0.0, 1.0]], dtype=object)),
        fm.Contact(
            "c", a, drive, law=fm.laws.Stribeck(mu_s=p, mu_k=0.5, v_s=0.1), axes="x",
            normal_force=fm.normal.Spring(axis="y", stiffness=3.0, preload=p), slide=(0.1 * t,),
        ),
        fm.Contact("d", a, law=fm.laws.Tabulated(speed=(0.0, 1.0), mu=(0.5, 0.25)), normal_force=2 + sympy.cos(t)),
    ])  # fmt: skip
    back = there_and_back(scene)
    assert back["c"].a is back["a"], "what is shared stays shared"
    assert back["pull"].value.subs(fm.t, 0.3) == scene["pull"].value.subs(fm.t, 0.3)
    assert str(back["drive"].velocity["x"]) == str(ramp)
    assert type(back["m"].M) is type(scene["m"].M)


@dataclass(frozen=True, kw_only=True)
class Own(fm.FrictionLaw):
    """A law of this file."""

    mu: float

    def define_coefficient(self, r):
        return self.mu / (1 + r)


def test_own_laws_are_handed_in_or_known(tmp_path, monkeypatch):
    sol, back = run(contact_of(Own(mu=0.5)), tmp_path, t_end=0.1)
    assert isinstance(back.scene["c"].law, Own)
    monkeypatch.delitem(sys.modules, Own.__module__)
    stranger = fm.Solution.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(stranger.q, sol.q)
    with pytest.raises(fm.FricmbError, match=r"class Own .* is not known here") as caught:
        _ = stranger.scene
    assert "return self.mu / (1 + r)" in str(caught.value), "its source is shown"
    for laws in (Own, [Own], {"Own": Own}):
        assert fm.Solution.load(tmp_path / "run.npz", laws=laws).scene == sol.scene
    with pytest.raises(fm.FricmbError, match="laws: got"):
        _ = fm.Solution.load(tmp_path / "run.npz", laws=[int]).scene


def test_a_module_is_imported_on_request_alone(tmp_path, monkeypatch):
    text = (
        "from dataclasses import dataclass\nimport fricmb as fm\nimport pathlib\n"
        "pathlib.Path(__file__).with_name('ran').touch()\n"
        "@dataclass(frozen=True, kw_only=True)\nclass Elsewhere(fm.laws.Coulomb):\n    pass\n"
    )
    (tmp_path / "elsewhere_law.py").write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    import elsewhere_law

    sol = fm.simulate(contact_of(elsewhere_law.Elsewhere(mu_s=0.5)), t_end=0.1)
    sol.save(tmp_path / "run.npz")
    monkeypatch.delitem(sys.modules, "elsewhere_law")
    (tmp_path / "ran").unlink()
    with pytest.raises(fm.FricmbError, match="is not known here"):
        _ = fm.Solution.load(tmp_path / "run.npz").scene
    assert not (tmp_path / "ran").exists()
    assert fm.Solution.load(tmp_path / "run.npz", laws="import").scene.name == sol.scene.name
    assert (tmp_path / "ran").exists()


def test_a_solution_that_was_not_opened_is_saved_as_it_is(tmp_path):
    sol = fm.simulate(contact_of(fm.laws.Coulomb(mu_s=0.5)), t_end=0.1)
    sol.save(tmp_path / "one.npz")
    fm.Solution.load(tmp_path / "one.npz").save(tmp_path / "two.npz")
    assert fm.Solution.load(tmp_path / "two.npz").scene == sol.scene


def test_joined_runs_and_long_ones(tmp_path):
    scene = contact_of(fm.laws.Coulomb(mu_s=0.5))
    first = fm.simulate(scene, t_end=0.5)
    second = fm.simulate(scene.with_parameters({"c.law.mu_s": 0.25}), t_end=1.0, initial=first)
    whole = fm.Solution.join([first, second])
    whole.save(tmp_path / "run.npz")
    back = fm.Solution.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(back([0.2, 0.7]), whole([0.2, 0.7]))
    np.testing.assert_array_equal(back.at([0.2, 0.7]).energy.total, whole.at([0.2, 0.7]).energy.total)
    again = fm.simulate(scene, t_end=1.5, initial=back)
    np.testing.assert_array_equal(again.q, fm.simulate(scene, t_end=1.5, initial=whole).q)


def contact_of(law, **options):
    """A puck on a belt under a law."""
    axes = "xyz" if 3 in law.dimensions else "xy" if 2 in law.dimensions else "x"
    puck = fm.Body("puck", mass=1.0, axes=axes)
    if axes == "xyz":
        options["axes"] = axes
    belt = fm.Driven("belt", velocity={"x": 1.0})
    return fm.Scene("one contact", [puck, belt, fm.Contact("c", puck, belt, law=law, normal_force=2.0, **options)])
