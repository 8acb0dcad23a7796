"""Matrices with one number in front."""

import numpy as np
import pytest
import scipy.linalg

import fricmb as fm

M, K = np.diag([1.0, 2.0]), np.array([[5.0, -2.0], [1.0, 3.0]])


def scene(scale, **matrices):
    a, b = fm.Body("a", mass=1.0, velocity={"x": 1.0}), fm.Body("b", mass=2.0)
    return fm.Scene("two", [a, b, fm.MatrixElement("tie", ["a.x", "b.x"], **matrices, scale=scale)])


def moved(K, t):
    """Exact positions at t of the two bodies under a stiffness, from the initial velocity (1, 0)."""
    A = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.linalg.solve(M, K), np.zeros((2, 2))]])
    return (scipy.linalg.expm(A * t) @ [0.0, 0.0, 1.0, 0.0])[:2]


def test_motion_and_its_derivative_by_the_number():
    k = fm.parameter("k", 0.5)
    sol = fm.simulate(scene(k**2 * 3.0, K=K), t_end=2.0, rtol=1e-10, sensitivities=("k",))
    assert sol.q[:, -1] == pytest.approx(moved(0.75 * K, 2.0), rel=1e-8)
    h = 1e-5
    slope = (moved(3 * (0.5 + h) ** 2 * K, 2.0) - moved(3 * (0.5 - h) ** 2 * K, 2.0)) / (2 * h)
    found = [sol.sensitivity("a.x", "k")[-1], sol.sensitivity("b.x", "k")[-1]]
    assert found == pytest.approx(slope, rel=1e-6)


def test_from_nothing_to_something_by_another_value():
    none = scene(fm.parameter("k", 0.0), K=K)
    assert none.parameters["k"] == 0.0
    sol = fm.simulate(none.with_parameters({"k": 2.0}), t_end=1.0, rtol=1e-10)
    assert sol.q[:, -1] == pytest.approx(moved(2.0 * K, 1.0), rel=1e-8)
    free = fm.simulate(none, t_end=1.0)
    assert free.q[:, -1] == pytest.approx([1.0, 0.0], abs=1e-12)


def test_own_name_and_mass_and_damping():
    sol = fm.simulate(scene(0.5, C=np.diag([2.0, 0.0]), M=np.diag([2.0, 0.0])), t_end=1.0, rtol=1e-10)
    # mass 1 + 1, damping 1: x = 2 (1 - exp(-t/2))
    assert sol["a.x"][-1] == pytest.approx(2.0 * (1.0 - np.exp(-0.5)), rel=1e-8)
    assert sol.energy.damping_loss[-1] == pytest.approx(1.0 - np.exp(-1.0), rel=1e-7)
    assert sol.audit().ok
    assert scene(0.5, K=K).parameters["tie.scale"] == 0.5


def test_equations_have_the_number_once():
    import sympy

    k = fm.parameter("k", 0.5)
    equations = scene(k, K=np.diag([4.0, 0.0])).equations()
    symbol = next(s for s in equations.values if str(s) == "k")
    assert sympy.diff(equations.rhs[0], symbol).has(equations.q[0])
    assert equations.with_numbers()[1][0] == pytest.approx(-2.0 * equations.q[0])


def test_refused():
    with pytest.raises(fm.SceneError, match=r"'tie'.*scale must be a finite number, got 'x'"):
        scene("x", K=K)
    with pytest.raises(fm.SceneError, match=r"scale must be.*expression of parameters"):
        scene(fm.t, K=K)


@pytest.mark.parametrize("mechanism", [False, True])
def test_matrices_over_many_degrees_of_freedom(mechanism):
    n = 12
    rng = np.random.default_rng(3)
    A = rng.standard_normal((n, n))
    M, K, C = 0.1 * A @ A.T, A.T @ A + np.eye(n), 0.05 * rng.standard_normal((n, n))
    bodies = [fm.Body(f"b{i}", mass=1.0, velocity={"x": float(i == 3)}) for i in range(n)]
    names = [f"b{i}.x" for i in range(n)]
    parts = [*bodies, fm.MatrixElement("tie", names, M=M, C=C, K=K, scale=fm.parameter("s", 0.5))]
    if mechanism:
        arm = fm.RigidBody("arm", mass=1.0, inertia=1.0, points={"end": (-1.0, 0.0)}, position=(1.0, 0.0))
        parts += [arm, fm.Revolute("pin", arm.point("end"), fm.ground_point(0.0, 0.0))]
    sol = fm.simulate(fm.Scene("many", parts), t_end=0.7, rtol=1e-9)
    whole = np.eye(n) + 0.5 * M
    inverse = np.linalg.inv(whole)
    state = np.block([[np.zeros((n, n)), np.eye(n)], [-0.5 * inverse @ K, -0.5 * inverse @ C]])
    expected = (scipy.linalg.expm(0.7 * state) @ np.r_[np.zeros(n), np.eye(n)[3]])[:n]
    assert [sol[name][-1] for name in names] == pytest.approx(expected, rel=1e-7, abs=1e-9)
    assert sol.audit().ok
