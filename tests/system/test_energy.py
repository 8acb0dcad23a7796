"""Energies of a system: their derivative is the force, and they add up in free motion."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.integrate.trajectory import Samples
from fricmb.system import build


def samples(t, q, v):
    t, q, v = np.atleast_1d(t), np.atleast_2d(q), np.atleast_2d(v)
    none = np.zeros((0, t.size))
    zero = np.zeros(t.size)
    return Samples(
        t=t, q=q, v=v, z=none, F=none, g=none, N=none, mode=none.astype(np.int8), friction_loss=none,
        damping_loss=zero, input=zero,
    )  # fmt: skip


def conservative():
    a = fm.Body("a", mass=2.0, axes="xy", position={"x": 0.9, "y": 0.1}, velocity={"y": 0.5})
    b = fm.Body("b", mass=1.0, axes="xy", position={"y": 1.1})
    return fm.Scene(
        "s",
        [
            a,
            b,
            fm.Spring("s1", a, axis="x", stiffness=3.0, cubic=2.0, length=0.1),
            fm.Spring("s2", a, b, axis=(1, 2), stiffness=1.5, length=0.2),
            fm.PointSpring("ps", a, b, stiffness=10.0, length=0.5),
            fm.PointSpring("anchor", b, stiffness=2.0, length=0.0, anchor=(0.3, 0.1)),
            fm.Force("weight", a, axis="y", value=-2.0),
            fm.Force("field", b, axis="y", value=-0.7 * fm.coordinate("b.y")),
            fm.MatrixElement("m", ["b.x", "a.y"], M=[[0.1, 0.05], [0.05, 0.2]], K=[[1.0, 0.2], [0.2, 1.0]]),
        ],
    )


def test_energy_is_conserved_in_free_motion():
    """Equations of motion from SymPy, energies from the arrays: neither knows the other; loads give."""
    scene = conservative()
    system, eq = build(scene), scene.equations()
    M, rhs = eq.with_numbers()
    force = sympy.lambdify([*eq.q, *eq.v], rhs)
    inverse = np.linalg.inv(np.array(M, dtype=float))
    n = len(scene.dof_names)

    def slope(t, y):
        return np.concatenate([y[n:], inverse @ np.ravel(force(*y))])

    start = np.concatenate([system.start.q, system.start.v])
    run = solve_ivp(slope, (0.0, 10.0), start, method="DOP853", rtol=1e-12, atol=1e-12, t_eval=np.linspace(0, 10, 200))
    record = samples(run.t, run.y[:n], run.y[n:])
    total, given = system.kinetic(record) + system.potential(record), system.delivered(record)
    assert np.ptp(system.kinetic(record)) > 1.0
    assert np.ptp(given) > 1.0
    np.testing.assert_allclose(total - given, total[0] - given[0], atol=1e-9)


def test_potentials_by_element():
    scene = conservative()
    system = build(scene)
    q = np.array([0.9, 0.1, 0.0, 1.1])
    found = system.potentials(samples(0.0, q[:, None], q[:, None] * 0.0))
    assert found["s1"] == pytest.approx(1.5 * 0.8**2 + 0.5 * 0.8**4)
    e = (0.9 + 2 * (0.1 - 1.1)) / np.sqrt(5) - 0.2
    assert found["s2"] == pytest.approx(0.75 * e**2)
    assert found["ps"] == pytest.approx(5.0 * (np.hypot(0.9, 1.0) - 0.5) ** 2)
    assert found["anchor"] == pytest.approx(0.3**2 + 1.0**2)
    assert "weight" not in found  # a force from outside stores nothing
    assert "field" not in found
    assert found["m"] == pytest.approx(0.5 * (0.01))


def test_potential_with_driven_ends_and_pressed_contacts():
    a = fm.Body("a", mass=1.0, axes="xy", position={"y": 0.02})
    shaker = fm.Driven("shaker", position={"x": sympy.cos(fm.t)}, axes="x")
    normal = fm.normal.Spring(axis="y", stiffness=100.0, preload=3.0)
    scene = fm.Scene(
        "s",
        [
            a,
            shaker,
            fm.Spring("k", a, shaker, axis="x", stiffness=2.0),
            fm.Contact("c", a, law=fm.laws.Coulomb(mu_s=0.3), normal_force=normal),
        ],
    )
    t = np.array([0.0, 1.0])
    q = np.array([[0.1, 0.2], [0.02, 0.05]])
    found = build(scene).potentials(samples(t, q, 0.0 * q))
    np.testing.assert_allclose(found["k"], (q[0] - np.cos(t)) ** 2)
    # closed at 0.02; open beyond 0.03, where a constant preload is left
    np.testing.assert_allclose(found["c"], [50 * 0.02**2, 50 * 0.03**2 + 3.0 * 0.02])


def test_kinetic_energy_with_a_full_mass_matrix():
    system = build(conservative())
    v = np.array([[0.3], [-0.2], [0.5], [1.0]])
    M = np.diag([2.0, 2.2, 1.1, 1.0])
    M[1, 2] = M[2, 1] = 0.05
    assert system.kinetic(samples(0.0, v, v))[0] == pytest.approx(float(0.5 * v[:, 0] @ M @ v[:, 0]))
