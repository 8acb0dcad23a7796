"""Mistakes in declarations, fits and on the command line are named where they are made."""

import dataclasses

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.cli import main


def test_units_stand_in_their_order():
    for wrong, meant in ((("kg", "m", "s"), "time"), (("s", "N", "m"), "length"), (("s", "m", "kg"), "force")):
        with pytest.raises(fm.SceneError, match=rf"Units: {meant} must be a unit of {meant}"):
            fm.Units(*wrong)
    assert fm.Units("ms", "mm", "kN").velocity == "mm/ms"
    assert fm.Units("1", "1", "1").dimensionless
    assert fm.Units("spans", "rods", "stones").length == "rods"


def pendulum(off):
    arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, position={"x": off, "y": -0.5}, points={"top": (0.0, 0.5)})
    weight = fm.Gravity("weight", acceleration={"y": -9.81})
    return fm.Scene("pendulum", [arm, weight, fm.Revolute("pin", arm.point("top"))])


def test_a_joint_far_off_its_place_is_refused():
    with pytest.raises(fm.SceneError, match=r"not assembled: arm\.x would have to move by .* beyond half of its size"):
        fm.simulate(pendulum(5.0), t_end=0.1)
    sol = fm.simulate(pendulum(0.1), t_end=0.1)  # a rough start is corrected, and said
    assert any("were moved" in note for note in sol.stats.notes)


def test_mechanisms_count_as_mechanics_does():
    for name, freedom, coordinates in (("slider_crank", 1, 9), ("four_bar", 1, 9), ("dry_pendulum", 1, 3)):
        sol = fm.simulate(getattr(fm.models, name)(), t_end=1e-3)
        driven = name == "slider_crank" and "motor" in sol.scene and isinstance(sol.scene["motor"], fm.DrivenAngle)
        expected = freedom - driven
        words = f"{expected} degree{'' if expected == 1 else 's'} of freedom ({coordinates} coordinates)"
        assert words in sol.summary()
        assert words in repr(sol)
        assert f"{coordinates} coordinates" in repr(sol.scene)
    plain = fm.simulate(fm.models.belt_oscillator(), t_end=1.0)
    assert "1 degree of freedom" in plain.summary()
    assert "1 contact," in repr(plain)


def test_energies_have_units():
    sol = fm.simulate(fm.models.puck_on_belt(), t_end=0.1)
    assert " N m lost to friction" in sol.summary()
    assert "lost to friction" in fm.simulate(fm.models.belt_oscillator(), t_end=1.0).summary()


@dataclasses.dataclass(frozen=True, kw_only=True)
class Turning(fm.FrictionLaw):
    """Opposes slip up to a speed of 50 and drives it beyond."""

    mu: float

    def define_force(self, v, N, z):
        return (-self.mu * N * sympy.tanh(v[0]) * (1 - (v[0] / 50) ** 2),)


def test_a_law_that_drives_fast_slip_is_refused():
    block = fm.Body("block", mass=1.0, velocity={"x": 0.1})
    scene = fm.Scene("driving", [block, fm.Contact("sole", block, law=Turning(mu=0.5), normal_force=1.0)])
    with pytest.raises(fm.LawError, match="drives the slip"):
        fm.simulate(scene, t_end=0.1)


def test_a_fit_names_the_bounds_that_break_a_law():
    data = {"t": np.linspace(0.0, 5.0, 20), "mass.x": np.zeros(20)}
    bounds = {"sole.law.mu_s": (0.1, 0.4), "sole.law.mu_k": (0.5, 1.5), "spring.stiffness": (0.5, 2.0)}
    with pytest.raises(fm.SceneError, match=r"first guess \(sole.law.mu_s: 0.1 to 0.4, first guess 0.25\)") as caught:
        fm.fit(fm.models.belt_oscillator(), data, parameters=bounds, progress=False)
    assert "mu_k must be <= mu_s" in str(caught.value)
    assert "spring.stiffness" not in str(caught.value)


def test_a_law_on_the_command_line(tmp_path, capsys):
    out = ["--t-end", "2", "--no-plots", "--out", str(tmp_path / "run"), "--quiet"]
    law = "Stribeck(mu_s=1.4, mu_k=1.0, v_s=0.1)"
    assert main(["run", "belt_oscillator", "--set", f"sole.law={law}", *out]) == 0
    sol = fm.Solution.load(tmp_path / "run" / "solution.npz")
    assert sol.scene["sole"].law == fm.laws.Stribeck(mu_s=1.4, mu_k=1.0, v_s=0.1)
    assert main(["run", "belt_oscillator", "--set", f"law={law}", *out]) == 0
    assert main(["run", "belt_oscillator", "--set", "sole.law=Stribek(mu_s=1.4)", *out]) == 2
    assert "did you mean 'Stribeck'" in capsys.readouterr().err
    assert main(["run", "belt_oscillator", "--set", "sol.law=Coulomb(mu_s=1.4)", *out]) == 2
    assert "did you mean 'sole.law'" in capsys.readouterr().err
    assert main(["plot", str(tmp_path / "run" / "solution.npz"), "hysteresis", "--of", "sole"]) == 0
    assert (tmp_path / "run" / "hysteresis.png").stat().st_size > 5000


def test_help_of_plot_names_every_kind(capsys):
    with pytest.raises(SystemExit):
        main(["plot", "--help"])
    text = " ".join(capsys.readouterr().out.split())
    for kind in ("positions", "signals", "hysteresis", "sound", "view"):
        assert kind in text
