"""Starts by regression: forces against those one at a time, values against the truth, a rig made elsewhere."""

from pathlib import Path

import numpy as np
import pytest
import scipy.signal

import fricmb as fm
from fricmb._fit._data import read
from fricmb._fit._model import Model
from fricmb._fit._regression import regress
from fricmb.analysis._forces import forces
from fricmb.analysis._linearise import linearise
from fricmb.system import build

DATA = Path(__file__).parents[2] / "docs" / "data"
BOUNDS = {
    "sole.law.mu_k": (0.5, 1.2), "damper.damping": (0.0, 0.5), "spring.stiffness": (0.5, 2.0), "mass.mass": (0.2, 5.0),
}  # fmt: skip


def of(data, bounds, scene, first=None, offset=()):
    low, high = np.array(list(bounds.values())).T
    begin = 0.5 * (low + high) if first is None else np.array(first)
    found = regress(scene, tuple(bounds), begin, low, high, read(data, None, None), frozenset(offset))
    return dict(zip(bounds, found[0], strict=True)) if found else None


@pytest.mark.parametrize("name", ["belt_oscillator", "brake4dof", "planar_oscillator", "minimal_flutter"])
def test_forces_at_many_states_are_those_at_each(name):
    system = build(getattr(fm.models, name)())
    n, rng, t = system.problem.n, np.random.default_rng(0), np.linspace(0.0, 1.0, 5)
    q, v = 0.1 * rng.normal(size=(2, n, 5))
    force, F, g = forces(system, t, q, v)
    for i in range(5):
        at = linearise(system, q[:, i], v[:, i], np.zeros(system.problem.n_z), t[i])
        np.testing.assert_allclose(force[:, i], at.force, atol=1e-13)
        np.testing.assert_allclose(F[:, i], at.F, atol=1e-13)
        np.testing.assert_allclose(g[:, i], at.g, atol=1e-13)


def test_states_of_laws_are_those_of_steady_slip():
    law = fm.laws.LuGre(sigma0=1e3, sigma1=1.0, sigma2=0.1, mu_s=0.6, mu_k=0.4, v_s=0.1)
    scene = fm.models.belt_oscillator(law=law)
    v = np.linspace(-0.5, 0.5, 7)[None]
    F, g = forces(build(scene), np.zeros(7), 0.0 * v, v)[1:]
    steady = 0.4 + 0.2 * np.exp(-((g / 0.1) ** 2)) + 0.1 * np.abs(g)
    np.testing.assert_allclose(F, -np.sign(g) * steady * scene.parameters["sole.normal_force"], rtol=1e-6)


def sliding(**values):
    """A mass on a spring that slides to and fro under a load, without stick."""
    mass = fm.Body("mass", mass=values.get("mass", 1.0))
    t = np.linspace(0.0, 20.0, 401)
    load = fm.Force("load", mass, axis="x", value=fm.Signal(t, 4.0 * np.sin(t)))
    return fm.Scene("slider", [
        mass, load,
        fm.Spring("spring", mass, axis="x", stiffness=values.get("stiffness", 1.0)),
        fm.Damper("damper", mass, axis="x", damping=values.get("damping", 0.1)),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.9, mu_k=values.get("mu", 0.5)), normal_force=1.0),
    ])  # fmt: skip


TRUE = {"mass.mass": 1.7, "spring.stiffness": 1.3, "damper.damping": 0.2, "sole.law.mu_k": 0.8}
WIDE = {
    "mass.mass": (0.1, 20.0), "spring.stiffness": (0.1, 20.0), "damper.damping": (0.0, 5.0),
    "sole.law.mu_k": (0.0, 0.9),
}  # fmt: skip


@pytest.fixture(scope="module")
def motion():
    t = np.linspace(0.0, 20.0, 801)
    return fm.simulate(sliding().with_parameters(TRUE), t_end=20.0, t_eval=t, rtol=1e-9)


@pytest.mark.parametrize("kind", ["", ".velocity", ".acceleration"])
def test_values_from_places_speeds_and_accelerations(motion, kind):
    noise = 1e-3 * np.random.default_rng(3).standard_normal(motion.t.size)
    data = {"t": motion.t, f"mass.x{kind}": motion[f"mass.x{kind}"] + noise * np.ptp(motion[f"mass.x{kind}"])}
    found = of(data, WIDE, sliding())
    for name, value in TRUE.items():
        assert found[name] == pytest.approx(value, rel=0.1, abs=0.05)


def test_a_force_by_itself_gives_the_law():
    """The motion is prescribed: nothing is left to find but friction."""
    t = np.linspace(0.0, 6.0, 500)
    slide = fm.Driven("rack", velocity={"x": fm.Signal(t, np.sin(2 * t) + 0.3 * np.sin(5 * t))})
    law = fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.2, viscous=0.1)
    mass = fm.Body("block", mass=1.0)
    held = fm.Spring("cell", mass, axis="x", stiffness=1e4)
    scene = fm.Scene("rig", [slide, mass, held, fm.Damper("loss", mass, axis="x", damping=100.0),
                             fm.Contact("pad", mass, slide, law=law, normal_force=2.0)])  # fmt: skip
    sol = fm.simulate(scene, t_end=6.0, t_eval=t, rtol=1e-8)
    data = {"t": t, "pad.force": sol["pad.force"] + 0.2, "block.x": sol["block.x"]}
    bounds = {"pad.law.mu_s": (0.31, 1.0), "pad.law.mu_k": (0.05, 0.3001), "pad.law.viscous": (0.0, 1.0)}
    found = of(data, bounds, scene, offset=["pad.force"])
    assert found["pad.law.mu_k"] == pytest.approx(0.3, abs=0.02)
    assert found["pad.law.viscous"] == pytest.approx(0.1, abs=0.02)


def test_what_does_not_say_the_motion_gives_no_start(motion):
    assert of({"sole.stick": [1.0, 2.0]}, BOUNDS, sliding()) is None
    assert of({"t": motion.t, "sole.force": motion["sole.force"]}, BOUNDS, sliding()) is None
    assert of({"t": motion.t, "arm.x": motion.t}, {"arm.mass": (0.5, 2.0)}, fm.models.dry_pendulum()) is None


def test_what_the_equations_do_not_see_stays_as_it_was(motion):
    bounds = {**WIDE, "sole.law.mu_s": (0.9, 3.0), "mass.velocity.x": (-5.0, 5.0)}
    first = [1.0, 1.0, 0.1, 0.5, 1.234, 0.0]
    found = of({"t": motion.t, "mass.x": motion["mass.x"]}, bounds, sliding(), first=first)
    assert found["sole.law.mu_s"] == 1.234  # nothing is said about break-away while all slips
    assert found["spring.stiffness"] == pytest.approx(1.3, rel=0.05)


def test_differences_agree_with_exact_derivatives(motion):
    scene, names = sliding(), tuple(TRUE)
    data = read({"t": motion.t, "mass.x": motion["mass.x"]}, None, None)
    model = Model(scene=scene, names=names, measured=data, options={"rtol": 1e-9}, ranges=np.ones(4))
    p = np.array(list(TRUE.values())) * 1.01
    exact = model.exact_jacobian(p)
    model.costs.plain, model.costs.exact = 1e-3, 1.0
    model._kept.clear()
    assert model.differs
    np.testing.assert_allclose(model.jacobian(p), exact, atol=2e-3 * np.abs(exact).max())
    model.costs.plain = 1.0
    assert not model.differs


def rig():
    """What the two loggers of ``docs/data/rig.py`` wrote: torque, angle."""
    t, torque = np.loadtxt(DATA / "rig_drive.csv", delimiter=",", skiprows=1).T
    clock, steps = np.loadtxt(DATA / "rig_encoder.csv", delimiter=",", skiprows=1).T
    steps = np.where(np.abs(steps - scipy.signal.medfilt(steps, 5)) > 200, np.nan, steps)
    clock = clock - 0.18
    kept = np.flatnonzero((clock > 0.0) & (clock < t[-1] - 0.2))[::4]
    return fm.Signal(t, torque), clock[kept], steps[kept] * 2 * np.pi / 4096


def motor(torque):
    rotor = fm.Body("rotor", mass=0.1)
    drive = fm.Force("drive", rotor, axis="x", value=torque)
    zero = fm.Force("zero", rotor, axis="x", value=fm.parameter("bias", 0.0) + fm.parameter("drift", 0.0) * fm.t)
    law = fm.laws.Stribeck(mu_s=1.0, mu_k=0.5, v_s=1.0, viscous=0.1)
    return fm.Scene("motor", [rotor, drive, zero, fm.Contact("bearing", rotor, law=law, normal_force=1.0)])


RIG = {
    "rotor.mass": (0.001, 1.0), "bearing.law.mu_s": (0.01, 3.0), "bearing.law.mu_k": (0.01, 2.0),
    "bearing.law.v_s": (0.05, 5.0), "bearing.law.viscous": (0.0, 1.0), "bias": (-0.5, 0.5), "drift": (-0.02, 0.02),
}  # fmt: skip


@pytest.mark.slow
def test_a_rig_from_a_plain_first_guess():
    """Inertia eightfold, friction double: right without a word about starts."""
    torque, t, angle = rig()
    found = fm.fit(motor(torque), {"t": t, "rotor.x": angle}, parameters=RIG, offset=True, rtol=1e-7, progress=False)
    values = list(found.values.values())
    off = np.array(values[:5]) / [0.013, 0.44, 0.31, 0.6, 0.021] - 1.0
    assert (np.abs(off) < [0.005, 0.01, 0.01, 0.05, 0.005]).all()
    assert values[5:] == pytest.approx([0.06 - 0.08, -0.004], abs=1e-3)
    assert not any("false minimum" in note for note in found.notes)
    good = np.isfinite(angle)
    assert 1 - np.var(found.residuals["rotor.x"]) / np.var(angle[good]) > 0.99999


@pytest.mark.slow
def test_a_scene_that_lacks_something_is_told_once():
    """Without the drift no values are right, and other starts would not help."""
    torque, t, angle = rig()
    bounds = {name: given for name, given in RIG.items() if name != "drift"}
    found = fm.fit(motor(torque), {"t": t, "rotor.x": angle}, parameters=bounds, offset=True, rtol=1e-7, progress=False)
    assert any("from 1 start" in note and "the scene lacks something" in note for note in found.notes)
    assert found.values["rotor.mass"] == pytest.approx(0.013, rel=0.02)
    assert any("bearing.law.v_s is not determined within its bounds" in note for note in found.notes)
