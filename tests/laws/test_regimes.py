"""One law as set-valued, regularised and bristle; creep; published laws."""

import numpy as np
import pytest

import fricmb as fm
from fricmb import laws
from fricmb.testing import check_law


def test_regularised_and_bristle_follow_the_law_in_slip():
    law = laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1)
    r = np.array([0.05, 0.2, 1.0])
    np.testing.assert_allclose(law.regularised(1e-4).coefficient(r), law.coefficient(r), rtol=1e-12)
    np.testing.assert_allclose(law.bristle(1e5).coefficient(r), law.coefficient(r), rtol=1e-15)
    assert law.regularised(1e-4).numeric_slots()["law.mu_s"] == 0.6
    assert law.regularised(1e-4).with_slots({"law.mu_k": 0.5}).coefficient(3.0) == pytest.approx(0.5, rel=1e-12)


def test_creep_in_closed_form():
    assert laws.TanhRegularised(mu=0.5, v_reg=1e-3).creep(0.5).velocity == pytest.approx(
        1e-3 * np.arctanh(0.5), rel=2e-2
    )
    elastic = laws.Jenkins(stiffness=1e4, mu=0.3).creep(0.5)
    assert elastic.displacement == pytest.approx(0.15 / 1e4, rel=1e-6)
    assert elastic.velocity == 0.0
    held = laws.Coulomb(mu_s=0.5).creep(0.5)
    assert (held.velocity, held.displacement, held.break_away) == (0.0, 0.0, 0.5)
    with pytest.raises(fm.LawError, match="load must be between 0 and 1"):
        laws.Coulomb(mu_s=0.5).creep(1.5)


def test_a_law_that_jumps_needs_a_speed_for_its_bristle():
    law = laws.Coulomb(mu_s=0.6, mu_k=0.4)
    with pytest.raises(fm.LawError, match=r"v_s must be a speed: the law breaks away at 0\.6 and slips at 0\.4"):
        law.bristle(1e5)
    assert law.bristle(1e5, v_s=0.01).coefficient(0.0) == pytest.approx(0.6, rel=1e-15)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: laws.Regularised(law=laws.Dahl.example(), v_reg=1.0), "law must be a set-valued law"),
        (lambda: laws.Tabulated.example().regularised(1e-3), "law must be stated in SymPy"),
        (lambda: laws.Elliptic(law=laws.Elliptic.example(), ratio=2.0), "law must be an isotropic set-valued law"),
        (lambda: laws.Iwan(stiffness=(1.0, 2.0), limits=(1.0,)), "limits must be as many numbers"),
        (lambda: laws.RateAndState.example().with_slots({"evolution": "old"}), "evolution must be 'aging' or 'slip'"),
    ],
)
def test_bad_combinations_are_refused_by_name(make, words):
    with pytest.raises(fm.LawError, match=words):
        make()


def test_three_regimes_of_one_scene():
    scene = fm.models.belt_oscillator(law=laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=0.05))
    held, smooth, bristle = fm.analysis.compare_regimes(scene, "sole", v_reg=1e-4, stiffness=1e4, t_end=15.0, rtol=1e-7)
    assert held.crept < 1e-9
    assert 1e-6 < smooth.crept < 1e-4 * 15.0  # slower than v_reg
    assert smooth.creep_speed < 1e-4
    assert 1e-5 < bristle.crept < 1e-3
    assert smooth.deviation < 1e-2
    assert bristle.deviation < 1e-2
    assert "creeps" in str(smooth)


def publish(folder, group, lines):
    (folder / "thirdparty.py").write_text(
        "from dataclasses import dataclass\nimport fricmb as fm\n\n"
        '@dataclass(frozen=True, kw_only=True)\nclass Mine(fm.FrictionLaw):\n    """My law."""\n'
        "    mu: float\n    def define_coefficient(self, r):\n        return self.mu\n"
    )
    info = folder / "thirdparty-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: thirdparty\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[{group}]\n{lines}\n")


def test_published_laws_are_found_and_broken_ones_named(tmp_path, monkeypatch):
    publish(tmp_path, "fricmb.friction_laws", "Mine = thirdparty:Mine\nGone = thirdparty:Gone\nOdd = thirdparty:fm")
    monkeypatch.syspath_prepend(str(tmp_path))
    found, broken = laws.published("fricmb.friction_laws")
    assert found["Mine"].example().coefficient(1.0) == 0.5
    assert set(broken) == {"Gone", "Odd"}
    assert "thirdparty:Gone of thirdparty: AttributeError" in broken["Gone"]
    assert "expected a subclass of fricmb.FrictionLaw" in broken["Odd"]


def test_command_lists_published_laws_and_skips_broken_ones(tmp_path, monkeypatch, capsys):
    from fricmb.cli import main

    publish(tmp_path, "fricmb.friction_laws", "Mine = thirdparty:Mine\nGone = thirdparty:Gone")
    monkeypatch.syspath_prepend(str(tmp_path))
    assert main(["list", "laws"]) == 0
    shown = capsys.readouterr()
    assert "Mine (set-valued)" in shown.out
    assert "RateAndState" in shown.out
    assert "'Gone' is left out" in shown.err


def test_command_draws_a_law(tmp_path, capsys):
    from fricmb.cli import main

    assert main(["law", "Dahl", "--set", "mu=0.25", "--out", str(tmp_path)]) == 0
    assert "break-away 0.25" in capsys.readouterr().out
    assert (tmp_path / "Dahl.png").stat().st_size > 10_000
    assert main(["law", "Dahll"]) == 2
    assert "Dahl" in capsys.readouterr().err
    assert main(["law", "Dahl", "--set", "mu=-1"]) == 2


@pytest.mark.parametrize("made", [lambda law: law.regularised(1e-5), lambda law: law.bristle(1e5)])
def test_regimes_keep_what_the_load_does_to_the_coefficient(made):
    law = laws.LoadDependent.example()
    other = made(law)
    for N in (0.5, 5.0, 50.0):
        assert other.coefficient(0.1, N) == pytest.approx(law.coefficient(0.1, N), rel=1e-12)
    check_law(other)
