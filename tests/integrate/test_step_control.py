"""Steps of BDF at tolerances that no other test asks for: attempts are few, and errors stay below the tolerance."""

import numpy as np
import pytest

import fricmb as fm

#: Scene, length of the run, attempts that the dearest run may take, and error in units of ``rtol``.
RUNS = {
    "brake, case 1": (lambda: fm.models.brake4dof(case=1), 700.0, 2500, 20.0),
    "brake, Stribeck": (
        lambda: fm.models.brake4dof(case=2, law=fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1)), 300.0, 2500, 20.0,
    ),
    "planar": (fm.models.planar_oscillator, 20.0, 700, 20.0),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
def test_errors_and_attempts_of_bdf_at_every_tolerance(name):
    """Compared with steps of the other method that are held back, BDF crept through a run in ten thousand steps."""
    build, t_end, most, allowed = RUNS[name]
    scene, t = build(), np.linspace(0.0, t_end, 100)
    exact = fm.simulate(scene, t_end=t_end, rtol=1e-11, method="radau", t_eval=t).q
    size = np.abs(exact).max(axis=1)
    for rtol in (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        sol = fm.simulate(scene, t_end=t_end, rtol=rtol, method="bdf", t_eval=t)
        error = (np.abs(sol.q - exact).max(axis=1) / size).max()
        assert error < allowed * rtol, (rtol, error)
        assert sol.stats.n_steps + sol.stats.n_rejected < most, (rtol, sol.stats)
