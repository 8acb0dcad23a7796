"""Lyapunov exponents and Poincaré sections against closed forms and multipliers."""

import numpy as np
import pytest
import sympy

import fricmb as fm


def test_landing_cuts_a_direction():
    """Belt: along the cycle 0, across it gone for good at each landing."""
    found = fm.analysis.lyapunov(fm.models.belt_oscillator(), t_end=150.0, intervals=50, progress=False)
    assert abs(found.exponents[0]) < 0.02
    assert found.exponents[1] == -np.inf
    assert found.dimension == 1.0


def test_linear_vibration_has_the_real_parts_of_its_eigenvalues():
    scene = fm.models.friction_oscillator(friction=0.0, damping=0.2, amplitude=1.0, frequency=0.7)
    found = fm.analysis.lyapunov(scene, t_end=40.0 * np.pi / np.sqrt(0.99), intervals=40, progress=False)
    assert found.exponents == pytest.approx([-0.1, -0.1], abs=1e-6)


def test_exponents_are_the_multipliers_of_a_cycle():
    mass = fm.Body("mass", mass=1.0)
    scene = fm.Scene("forced", [
        mass, fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.1),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=1.25, mu_k=1.0), normal_force=0.4),
        fm.Force("drive", mass, axis="x", value=sympy.cos(0.4 * fm.t)),
    ])  # fmt: skip
    start = fm.analysis.limit_cycle(scene).solution
    found = fm.analysis.lyapunov(scene, start=start, t_end=100.0 * np.pi, intervals=60, discard=1.0, progress=False)
    assert found.exponents[0] == pytest.approx(np.log(0.21431492140652879) / (5.0 * np.pi), rel=2e-2)
    assert found.exponents[1] == -np.inf
    assert found.running.shape == (60, 2)


@pytest.mark.parametrize("bad", [{"t_end": 0.0}, {"t_end": 1.0, "intervals": 0}, {"t_end": 1.0, "discard": -1.0}])
def test_arguments(bad):
    with pytest.raises(fm.analysis.AnalysisError):
        fm.analysis.lyapunov(fm.models.belt_oscillator(), **bad)


def test_passes_of_the_belt_oscillator():
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=150.0, rtol=1e-10)
    found = fm.analysis.poincare_section(sol, ("mass.x.velocity", 0.0), rising=True, discard=0.3)
    assert np.diff(found.t) == pytest.approx(13.53638377328955, rel=1e-9)
    assert found["mass.x"] == pytest.approx(1.0 - np.sqrt(0.26), rel=1e-9)  # the lowest point
    both = fm.analysis.poincare_section(sol, ("mass.x.velocity", 0.0), rising=None, discard=0.3)
    assert abs(len(both.t) - 2 * len(found.t)) <= 1
    strobed = fm.analysis.poincare_section(sol, period=50.0, discard=0.3)
    assert strobed.t == pytest.approx([50.0, 100.0, 150.0])
    for wrong in ({}, {"section": ("mass.x", 0.0), "period": 1.0}, {"period": 1.0, "discard": 1.0}):
        with pytest.raises(fm.analysis.AnalysisError):
            fm.analysis.poincare_section(sol, **wrong)
    with pytest.raises(fm.SceneError):
        found["mass.y"]


@pytest.mark.parametrize("follow", [False, True])
def test_diagram_counts_the_points_of_settled_motion(follow):
    """Half the belt's cycle has one lowest point; a section at x = 1 is met once rising."""
    found = fm.analysis.bifurcation_diagram(
        fm.models.belt_oscillator(), "belt.velocity.x", [0.1, 0.2, 0.4], t_end=120.0, signal="mass.x",
        section=("mass.x.velocity", 0.0), follow=follow, progress=False, workers=1, rtol=1e-8,
    )  # fmt: skip
    assert found.count().tolist() == [1, 1, 1]
    for V, points in zip(found.values, found.points, strict=True):
        assert points == pytest.approx(1.0 - np.sqrt(0.25 + V**2), rel=1e-7)
    assert found.failed == ()
    assert found.plot.diagram().axes
