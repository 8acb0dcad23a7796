"""Pad and rotor, the pair of modes of a disc, and mode coupling: against closed forms and the 4-dof brake."""

import numpy as np
import pytest
import scipy.linalg
from scipy.optimize import brentq
from scipy.special import jv, yv

import fricmb as fm
from fricmb.models.pad_rotor import PadRotorModes, stored_modes


def shapes(*rows):
    return np.array(rows, dtype=float).reshape(2, 1, 1, -1)


def test_with_one_mode_along_x_and_two_along_y_it_is_the_brake():
    O1, O2 = 10 * np.sqrt(np.pi / 2), np.sqrt(5 / 2) / 100
    modes = PadRotorModes(
        radii=np.array([1.0]), angles=np.array([0.0]),
        pad_frequencies=np.array([1.0, O1]), pad_shapes=shapes([1, 0], [0, 1]),
        rotor_frequencies=np.array([0.0, O2]), rotor_shapes=shapes([1, 0], [0, 1]),
        rotor_masses=np.array([1000.0, 1000.0]),
    )  # fmt: skip
    scene = fm.models.pad_rotor(
        2, 1, 1, modes=modes, normal_force=15.0, mu_s=1.0, mu_k=1.0, speed=10.0, rotor_velocity={"mode2": 0.01},
        pad_damping=0.0, rotor_damping=0.0,
    )  # fmt: skip
    grid = np.linspace(0, 50, 501)
    ours = fm.simulate(scene, t_end=50.0, rtol=1e-9, t_eval=grid)
    brake = fm.simulate(fm.models.brake4dof("2"), t_end=50.0, rtol=1e-9, t_eval=grid)
    assert len(brake.events) > 10
    np.testing.assert_allclose(ours.q, brake.q, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(ours.v, brake.v, rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(ours.events.t, brake.events.t, rtol=1e-13)


def test_the_rotation_and_the_torsion_of_the_rotor():
    """u(r) = A J1(k r) + B Y1(k r) along the circumference, free outside, on the turning hub inside."""
    a, b, h, rho, G, J = 0.075, 0.140, 0.020, 7200.0, 110e9 / (2 * 1.27), 0.30

    def ends(omega):
        k = omega * np.sqrt(rho / G)

        def shear(f, g, r):  # u' - u/r of u = f(k r), f' from the next lower order g
            return k * g(0, k * r) - 2 * f(1, k * r) / r

        inner = [2 * np.pi * a**2 * h * G * shear(f, f, a) + J * omega**2 * f(1, k * a) / a for f in (jv, yv)]
        outer = [shear(f, f, b) for f in (jv, yv)]
        return inner[0] * outer[1] - inner[1] * outer[0]

    torsion = brentq(ends, 2 * np.pi * 6500, 2 * np.pi * 7400)
    data = stored_modes()
    assert data.rotor_frequencies[0] == 0.0
    assert data.rotor_frequencies[1] == pytest.approx(torsion, rel=1e-4)
    # rotation: r over the root of the inertia about the axis, of hub and annulus
    inertia = J + np.pi / 2 * rho * h * (b**4 - a**4)
    np.testing.assert_allclose(data.rotor_shapes[0, :, 0, 0], data.radii / np.sqrt(inertia), rtol=1e-5)
    np.testing.assert_allclose(data.rotor_shapes[1, ..., 0], 0.0, atol=1e-6)


def test_the_rotor_has_pairs_of_equal_frequency():
    omega = stored_modes().rotor_frequencies[2:8]
    np.testing.assert_allclose(omega[::2], omega[1::2], rtol=1e-5)


def test_the_friction_of_all_contacts_slows_the_rotor():
    """Until vibrations matter, by mu N r over the inertia."""
    scene = fm.models.pad_rotor(3, 2, 4, mu_s=0.4, mu_k=0.4)
    assert sum(contact.normal_force for contact in scene.contacts) == pytest.approx(2000.0)
    sol = fm.simulate(scene, t_end=1e-3, rtol=1e-6)
    turning = stored_modes().rotor_shapes[0, 3, 7, 0]
    mean = sum(c.normal_force * scene["rotor"].shapes[f"p{i + 1}"][0, 0] for i, c in enumerate(scene.contacts))
    slowed = sol.velocity("rotor.mode1")[-1] - 1.0 / turning
    assert slowed == pytest.approx(-0.4 * mean * 1e-3, rel=1e-3)
    assert abs(sol.energy.residual).max() < 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("numbers", [(3, 4, 2), (3, 4, 3), (3, 4, 4), (6, 8, 6)])
@pytest.mark.parametrize("rtol", [9.5e-6, 1e-5, 1.1e-5])  # transitions meet otherwise at each
def test_braking_to_a_standstill(numbers, rtol):
    """Points of the pad land together, are nearly redundant, and release one another: the run goes through that."""
    scene = fm.models.pad_rotor(*numbers, speed=0.2, mu_s=0.5, mu_k=0.4)
    sol = fm.simulate(scene, t_end=0.025, rtol=rtol, method="radau")
    turning = sol.velocity("rotor.mode1")
    assert np.abs(sol.energy.residual).max() < 1e-7
    # a rigid brake stops after v J/(mu N r^2)
    pull = sum(c.normal_force * scene["rotor"].shapes[f"p{i + 1}"][0, 0] for i, c in enumerate(scene.contacts))
    assert sol.t[np.flatnonzero(turning <= 0.0)[0]] == pytest.approx(turning[0] / (0.4 * pull), rel=0.1)
    # and then hangs on the mounting of the pad
    assert np.abs(turning[sol.t > 0.015]).max() < 0.15 * turning[0]
    for contact in scene.contacts:
        force, mode = np.hypot(*sol.force(contact.name)) / contact.normal_force, sol.mode(contact.name)
        assert force[mode == 0].max() < 0.5 * (1 + 1e-7)
        np.testing.assert_allclose(force[mode == 1], 0.4, rtol=1e-9)
        assert np.hypot(*sol.relative_velocity(contact.name))[mode == 0].max() < 1e-11


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"n_pad_modes": 0}, "n_pad_modes"), ({"n_rotor_modes": 41}, "n_rotor_modes"),
        ({"n_contacts": 0}, "n_contacts"), ({"n_contacts": (2, "a")}, "n_contacts"),
        ({"pressure": lambda r, phi: -1.0}, "pressure"),
    ],
)  # fmt: skip
def test_wrong_arguments_of_pad_rotor(arguments, words):
    with pytest.raises(fm.SceneError, match=words):
        fm.models.pad_rotor(**arguments)


@pytest.mark.parametrize("mu", [0.6, 0.74, 0.76, 0.9])
def test_flutter_begins_where_the_frequencies_merge(mu):
    """Steady sliding is linear: K gets mu k3 above the diagonal; poles +-i sqrt(2 -+ sqrt(1 - mu k3))."""
    scene = fm.models.minimal_flutter(mu)
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-10, t_eval=np.linspace(0, 12, 121))
    assert not sol.events
    k = 4.0 / 3.0
    poles = 1j * np.sqrt(2.0 + np.array([-1, 1]) * np.emath.sqrt(1.0 - mu * k))
    grows = np.abs(poles.real).max() > 1e-6
    assert grows == (mu > 0.75)
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.array([[2.0, mu * k - 1.0], [-1.0, 2.0]]), np.zeros((2, 2))]])
    kicked = np.array([0.0, 1e-3, 0.0, 0.0])
    steady = np.array([scene["block"].position["x"], scene["block"].position["y"] - 1e-3])
    exact = np.array([scipy.linalg.expm(A * t) @ kicked for t in sol.t]).T
    np.testing.assert_allclose(sol.q - steady[:, None], exact[:2], rtol=0, atol=2e-8)


def test_a_pad_that_sticks_splits_the_pair():
    """The cosine mode is loaded by mass and spring of the pad, the sine mode has a node there."""
    scene = fm.models.rotor_doublet(2, mu_s=50.0, mu_k=50.0, speed=0.0, pad_mass=0.1, pad_stiffness=0.3)
    start = {"position": {"disc.mode1": 1e-2, "pad1.x": 1e-2, "disc.mode2": 2e-2}}
    sol = fm.simulate(scene, t_end=20.0, rtol=1e-10, initial=start)
    assert not sol.mode("pad1 on disc").any()
    loaded = np.sqrt((1.0 + 0.3) / (1.0 + 0.1))
    np.testing.assert_allclose(sol["disc.mode1"], 1e-2 * np.cos(loaded * sol.t), atol=1e-10)
    np.testing.assert_allclose(sol["disc.mode2"], 2e-2 * np.cos(sol.t), atol=1e-10)


@pytest.mark.parametrize("arguments", [{"nodal_diameters": 0}, {"angles": ()}])
def test_wrong_arguments_of_rotor_doublet(arguments):
    with pytest.raises(fm.SceneError, match=next(iter(arguments))):
        fm.models.rotor_doublet(**arguments)


@pytest.mark.parametrize("wrong", [-1.0, 0.0, float("nan"), float("inf"), "a hundred", None])
def test_a_wrong_mass_ratio_is_named_as_given(wrong):
    with pytest.raises(fm.SceneError, match=rf"mass_ratio must be a finite number > 0, got {wrong!r}"):
        fm.models.brake4dof(mass_ratio=wrong)
