"""Modes from matrices: against closed forms; bad matrices are refused by name."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import fricmb as fm


def bar(n, length=1.0):
    """A bar of unit stiffness and density in n linear elements, fixed at the left: consistent mass."""
    h = length / n
    K = scipy.sparse.diags([2.0 / h, -1.0 / h, -1.0 / h], [0, 1, -1], shape=(n, n)).tolil()
    M = scipy.sparse.diags([4.0 * h / 6, h / 6, h / 6], [0, 1, -1], shape=(n, n)).tolil()
    K[n - 1, n - 1], M[n - 1, n - 1] = 1.0 / h, 2.0 * h / 6
    return M.tocsr(), K.tocsr()


def bar_frequencies(n, count, length=1.0):
    """Of that discrete bar, in closed form: w^2 = (6/h^2)(1 - cos a)/(2 + cos a), a = (j - 1/2) pi/n."""
    a = (np.arange(1, count + 1) - 0.5) * np.pi / n
    return np.sqrt(6.0 * (1 - np.cos(a)) / (2 + np.cos(a))) * n / length


@pytest.mark.parametrize("form", ["dense", "sparse"])
@pytest.mark.parametrize("n", [40, 900])
def test_frequencies_and_shapes_of_a_bar(form, n):
    M, K = bar(n)
    if form == "dense":
        M, K = M.toarray(), K.toarray()
    body = fm.ModalBody.from_matrices("bar", M=M, K=K, points={"tip": n - 1}, n_modes=8, residual=False)
    np.testing.assert_allclose(body.frequencies, bar_frequencies(n, 8), rtol=1e-8)
    # modes are sin(a k), of unit modal mass
    a = (np.arange(1, 9) - 0.5) * np.pi / n
    k = np.arange(1, n + 1)
    shapes = np.sin(a[:, None] * k)
    mass = np.einsum("ik,ik->i", shapes, (bar(n)[0] @ shapes.T).T)
    np.testing.assert_allclose(np.abs(body.shapes["tip"][0]), 1.0 / np.sqrt(mass), rtol=1e-7)
    assert body.dof_names == tuple(f"bar.mode{i}" for i in range(1, 9))


def test_rigid_modes_are_exact():
    n = 700
    M, K = bar(n)
    K = K.tolil()
    K[0, 0] = K[0, 0] / 2  # free at the left, too
    body = fm.ModalBody.from_matrices("bar", M=M, K=K.tocsr(), points={"tip": n - 1}, n_modes=4)
    assert body.frequencies[0] == 0.0
    assert body.frequencies[1] > 1.0


def test_residual_modes_keep_the_static_flexibility():
    n = 300
    M, K = bar(n)
    points = {"tip": n - 1, "middle": n // 2 - 1}
    body = fm.ModalBody.from_matrices("bar", M=M, K=K, points=points, n_modes=5)
    assert body.residual == 2
    assert body.dof_names[-1] == "bar.residual2"
    rows = np.vstack([body.shapes["tip"], body.shapes["middle"]])
    flexibility = rows @ (rows / np.square(body.frequencies)).T
    exact = np.array([[1.0, 0.5], [0.5, 0.5]])  # a force at the tip stretches x by x
    np.testing.assert_allclose(flexibility, exact, atol=1e-9)
    assert min(body.frequencies[5:]) > body.frequencies[4]
    # what five modes of the bar leave of its flexibility at the tip: sum of 2/w^2 over the others
    left = 1.0 - np.sum(2.0 / ((np.arange(1, 6) - 0.5) * np.pi) ** 2)
    assert body.neglected == pytest.approx(left, rel=1e-3)  # the same part at the middle
    assert "residual" in str(fm.Scene("s", [body]).plan())


def test_damping_that_is_not_proportional_is_kept_whole():
    M, K = np.diag([1.0, 2.0, 1.5]), np.array([[3.0, -1, 0], [-1, 3, -2], [0, -2, 2.5]])
    C = np.diag([0.3, 0.0, 0.0])
    body = fm.ModalBody.from_matrices("b", M=M, K=K, C=C, points={"p": 0, "q": 2})
    assert body.damping.shape == (3, 3)
    poles, shapes = body.complex_modes()
    A = np.block([[np.zeros((3, 3)), np.eye(3)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    exact, vectors = np.linalg.eig(A)
    above = exact.imag > 0
    order = np.argsort(abs(exact[above]))
    np.testing.assert_allclose(poles, exact[above][order], rtol=1e-10)
    ratio = (vectors[2] / vectors[0])[above][order]
    np.testing.assert_allclose(shapes["q"][0] / shapes["p"][0], ratio, rtol=1e-8)
    # and a run is that of the matrices themselves
    start = scipy.linalg.expm(A * 4.0) @ np.array([1.0, 0, 0, 0, 0, 0])
    eta = np.linalg.solve(np.vstack([body.shapes["p"], _row(M, K, 1), body.shapes["q"]]), [1.0, 0, 0])
    given = {"position": {f"b.mode{i + 1}": eta[i] for i in range(3)}}
    sol = fm.simulate(fm.Scene("s", [body]), t_end=4.0, rtol=1e-10, initial=given)
    np.testing.assert_allclose([sol["b.p.x"][-1], sol["b.q.x"][-1]], start[[0, 2]], atol=1e-8)
    assert sol.energy.damping_loss[-1] > 0.0


def _row(M, K, i):
    return fm.ModalBody.from_matrices("x", M=M, K=K, points={"i": i}).shapes["i"]


def test_proportional_damping_becomes_ratios():
    M, K = bar(30)
    body = fm.ModalBody.from_matrices("bar", M=M, K=K, C=0.1 * M + 0.002 * K, points={"tip": 29}, n_modes=6)
    omega = np.array(body.frequencies)
    assert body.damping is None
    np.testing.assert_allclose(body.damping_ratios[:6], (0.1 / omega + 0.002 * omega)[:6] / 2, rtol=1e-9)


def test_damping_that_drives_is_not_lost():
    """A negative C cannot be given by ratios, and is kept as a matrix: growth exp(t/2) of a mode of unit mass."""
    body = fm.ModalBody.from_matrices("b", M=np.eye(1), K=4.0 * np.eye(1), C=-np.eye(1), points={"p": 0})
    assert body.damping is not None
    start = {"position": {"b.mode1": 1e-3}}
    sol = fm.simulate(fm.Scene("s", [body]), t_end=5.0, rtol=1e-9, initial=start)
    omega = np.sqrt(4.0 - 0.25)
    exact = 1e-3 * np.exp(2.5) * (np.cos(5 * omega) - 0.5 / omega * np.sin(5 * omega))
    assert sol["b.mode1"][-1] == pytest.approx(exact, abs=1e-9)


def test_numbers_of_numpy_count():
    body = fm.ModalBody.from_matrices(
        "b", M=np.eye(2), K=np.eye(2), points={"p": 0}, n_modes=np.int64(1), residual=False
    )
    assert body.n_modes == 1


GOOD = np.diag([1.0, 2.0]), np.array([[2.0, -1.0], [-1.0, 2.0]])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"M": np.array([[1.0, 0.5], [0.0, 2.0]])}, "M must be symmetric"),
        ({"M": np.diag([1.0, -2.0])}, "M must be positive definite"),
        ({"M": np.array([[1.0, 2.0], [2.0, 1.0]])}, "M must be positive definite"),
        ({"M": np.array([[1.0, 1.0], [1.0, 1.0]])}, "singular or indefinite"),
        ({"M": scipy.sparse.csr_array([[1.0, 2.0], [2.0, 1.0]])}, "singular or indefinite"),
        ({"M": np.eye(3)}, "K must have the shape of M"),
        ({"M": np.ones(2)}, "M must be a square matrix"),
        ({"M": [["a", 1], [2, 3]]}, "M must be a matrix of real numbers"),
        ({"K": np.array([[2.0, 1.0], [-1.0, 2.0]])}, "K must be symmetric"),
        ({"K": np.diag([1.0, -1.0])}, "K must be positive semidefinite"),
        ({"K": np.diag([1.0, np.nan])}, r"K must hold finite numbers; K\[1, 1\] = nan"),
        ({"C": scipy.sparse.csr_array([[0.0, np.inf], [0.0, 0.0]])}, r"C\[0, 1\] = inf"),
        ({"M": np.eye(2) * (1 + 1j)}, "M must be a matrix of real numbers, got complex"),
        ({"K": scipy.sparse.csr_array(np.eye(2) * 1j)}, "K must be a matrix of real numbers, got complex"),
        ({"C": "a"}, "C must be a matrix of real numbers, got 'a'"),
        ({"M": np.zeros((0, 0)), "K": np.zeros((0, 0))}, "M must be a square matrix"),
        ({"residual": "yes"}, "residual must be True or False, got 'yes'"),
        ({"points": {"p": 0.5}}, "got 0.5"),
        ({"points": {"p": -1}}, "got -1"),
        ({"points": {"a.b": 0}}, "without dots"),
        ({"axes": "xx", "points": {"p": [0, 1]}}, "axes must be"),
        ({"damping_ratios": -0.1}, "damping_ratios must be a finite number >= 0"),
        ({"damping_ratios": [0.1, 0.1, 0.1]}, "sequence of 2 numbers"),
        ({"C": np.eye(3)}, "C must have the shape of M"),
        ({"points": {}}, "at least one"),
        ({"points": {"p": 2}}, "points\\['p'\\] must be 1 degree"),
        ({"points": {"p": [0, 1, 1]}}, "points\\['p'\\] must be"),
        ({"points": {"p": np.ones((1, 3))}}, "points\\['p'\\] must be"),
        ({"n_modes": 0}, "n_modes must be an integer from 1 to 2"),
        ({"n_modes": 3}, "n_modes must be an integer from 1 to 2"),
        ({"C": np.eye(2), "damping_ratios": 0.1}, "not both"),
    ],
)
def test_bad_matrices_are_refused(changes, words):
    given = {"M": GOOD[0], "K": GOOD[1], "points": {"p": 0}} | changes
    with pytest.raises(fm.SceneError, match=words):
        fm.ModalBody.from_matrices("b", **given)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"frequencies": [1.0, -2.0]}, r"frequencies\[1\] must be a finite number >= 0, got -2"),
        ({"frequencies": [1.0, np.nan]}, "frequencies"),
        ({"frequencies": []}, "frequencies"),
        ({"frequencies": [1.0, 2.0j]}, "frequencies"),
        ({"shapes": {"p": np.ones((1, 2)) * 1j}}, r"shapes\['p'\] must be an array of numbers"),
        ({"shapes": {"p": [[1.0, np.nan]]}}, "finite"),
        ({"position": {"mode9": 1.0}}, "mode9"),
        ({"shapes": {"p": np.ones((1, 3))}}, "shapes"),
        ({"shapes": {}}, "at least one point"),
        ({"masses": [1.0, 0.0]}, "masses"),
        ({"damping": np.eye(3), "damping_ratios": 0.0}, "damping must be"),
        ({"damping": np.eye(2)}, "damping_ratios"),
        ({"truncation": 0.0}, "truncation"),
        ({"residual": 3}, "residual"),
    ],
)
def test_bad_modes_are_refused(changes, words):
    given = {"frequencies": [1.0, 2.0], "damping_ratios": 0.1, "shapes": {"p": np.ones((1, 2))}} | changes
    with pytest.raises(fm.SceneError, match=words):
        fm.ModalBody("b", **given)


def test_a_missing_point_is_named_with_those_there():
    body = fm.ModalBody("plate", frequencies=[1.0], damping_ratios=0.0, shapes={"tip": [1.0]})
    with pytest.raises(fm.FricmbError, match="tip"):
        body.point("tp")
