"""Steps of mechanisms at tolerances that no other test asks for: errors stay below them, and attempts are few."""

import numpy as np
import pytest

import fricmb as fm

#: Scene, length of the run, and attempts that the dearest run may take.
SCENES = {
    "slider_crank": (1.0, 400),
    "andrews": (0.03, 300),
    "dry_pendulum": (10.0, 350),
    "four_bar": (2.0, 400),
    "car_axis": (3.0, 800),
    "sprag_slip": (2.0, 400),
    "rising_top": (0.5, 400),
    "rolling_coin": (2.0, 300),
    "dry_ball_joint": (2.0, 200),
}
#: What is left out of a scene: stick and slip of a guide are looked at elsewhere.
PLAIN = {"slider_crank": {"friction": None}}


@pytest.mark.slow
@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("name", SCENES)
def test_errors_and_attempts_at_every_tolerance(name, method):
    """A rule of steps that takes a turn of the motion for a danger shows in attempts, and only here and there."""
    t_end, most = SCENES[name]
    scene, t = getattr(fm.models, name)(**PLAIN.get(name, {})), np.linspace(0.0, t_end, 50)
    exact = fm.simulate(scene, t_end=t_end, rtol=1e-12, method="radau", t_eval=t).q
    size = np.maximum(np.abs(exact).max(axis=1), 1e-6)
    for rtol in (1e-1, 1e-2, 2e-3, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        sol = fm.simulate(scene, t_end=t_end, rtol=rtol, method=method, t_eval=t)
        error = (np.abs(sol.q - exact).max(axis=1) / size).max()
        assert error < 5.0 * rtol, (rtol, error)
        assert sol.stats.n_steps + sol.stats.n_rejected < most, (rtol, sol.stats)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_small_vibrations_about_the_origin(method):
    """Round-off of constraints is that of arms, of length 3: corrections never get small beside the coordinates."""
    rng = np.random.default_rng(0)
    for amplitude in (1e-8, 1e-7, 1e-6, 1e-5):
        x, y = rng.uniform(-3.0, 3.0, 2)
        body = fm.RigidBody(
            "body", mass=1.0, inertia=0.1, position=(0.0, 0.0), velocity=(amplitude * y, -amplitude * x),
            angular_velocity=amplitude, points={"pin": (x, y)},
        )  # fmt: skip
        joint = fm.Revolute("pin", body.point("pin"), fm.ground_point(x, y))
        scene = fm.Scene("rocker", [body, joint, fm.TorsionSpring("spring", body, stiffness=30.0)])
        omega = np.sqrt(30.0 / (0.1 + x * x + y * y))
        sol = fm.simulate(scene, t_end=5.0, rtol=1e-6, method=method)
        expected = amplitude / omega * np.sin(omega * 5.0)
        assert sol["body.angle"][-1] == pytest.approx(expected, abs=1e-4 * amplitude / omega)
        assert sol.stats.n_steps + sol.stats.n_rejected < 400


def test_a_transition_takes_few_steps_to_find():
    """The polynomial of a step says where it is: beside attempts, some three solutions of other lengths."""
    sol = fm.simulate(fm.models.dry_pendulum(), t_end=10.0, rtol=1e-6, method="radau")
    located = sol.stats.n_lu - sol.stats.n_steps - sol.stats.n_rejected
    assert len(sol.events) == 10
    assert located <= 3 * len(sol.events), located
