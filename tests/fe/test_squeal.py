"""Bodies from finite element models: eigenvalues of the reduced against those of all degrees of freedom."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import fricmb as fm
from tests.real import GROWING, industrial_brake, needs_real


def rows_of(n):
    """A bar of n unit masses and springs of 1e4, held at one end."""
    K = scipy.sparse.diags_array([np.r_[np.full(n - 1, 2.0), 1.0], np.full(n - 1, -1.0), np.full(n - 1, -1.0)],
                                 offsets=[0, 1, -1])  # fmt: skip
    return 1e4 * K.tocsr()


def squealer(n=150):
    """Two bars that rub on each other along a third of their length: tangential forces are mu times normal ones."""
    zero = scipy.sparse.csr_array((n, n))
    pressed = np.zeros(n)
    pressed[n // 3 : 2 * n // 3] = 300.0
    N = scipy.sparse.diags_array(pressed)
    K = scipy.sparse.block_array([[rows_of(n), zero], [zero, 1.02 * rows_of(n) + N]])
    KR = scipy.sparse.block_array([[zero, -1.0 * N], [0.6 * N, zero]])
    G = scipy.sparse.block_array([[zero, 0.05 * N / 300.0], [-0.05 * N / 300.0, zero]])
    labels = [(i + 1, d) for d in (1, 2) for i in range(n)]
    coordinates = {i + 1: (float(i), 0.0, 0.0) for i in range(n)}
    C = 1e-5 * K
    return fm.fe.FEModel(
        M=scipy.sparse.eye_array(2 * n), K=K, C=C, parts={"KR": KR, "DG": G}, labels=labels, coordinates=coordinates,
        triangles={"KR": "full", "DG": "full"}, name="bars",
    )  # fmt: skip


def exact(fe, mu, omega):
    """Oscillations of the whole model, by a dense solver."""
    M, C, K = (x.toarray() for x in (fe.M, fe.C + omega * fe.parts["DG"], fe.K + mu * fe.parts["KR"]))
    n = len(M)
    values = np.linalg.eigvals(np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]]))
    return values[values.imag > 0.0]


def distances(found, expected):
    """Of each of the expected eigenvalues from the next one found, relative."""
    return np.array([np.abs(found - value).min() / abs(value) for value in expected])


mu, omega = fm.parameter("mu", 0.4), fm.parameter("omega", 2.0)
SCALES = {"KR": mu, "DG": omega}


def scene_of(body):
    return fm.Scene("bars", [body, body.matrix("KR", K="KR", scale=mu), body.matrix("DG", C="DG", scale=omega)])


def eigenvalues(body, **values):
    scene = scene_of(body).with_parameters(values)
    return fm.analysis.steady_sliding(scene).eigenpairs()[0]


def test_growth_rates_need_complex_modes():
    fe = squealer()
    top = 12.0
    plain = fm.ModalBody.from_fe("bars", fe, points={"tip": 150}, axes="xy", up_to=top / (2 * np.pi))
    rich = fm.ModalBody.from_fe(
        "bars", fe, points={"tip": 150}, axes="xy", up_to=top / (2 * np.pi), scales=SCALES,
        enrich=[{"mu": 0.4, "omega": 2.0}],
    )  # fmt: skip
    expected = exact(fe, 0.4, 2.0)
    expected = expected[expected.imag < top]
    assert expected.real.max() > 0.01  # it squeals
    errors = distances(eigenvalues(rich), expected)
    assert errors.max() < 1e-5
    assert distances(eigenvalues(plain), expected).max() > 100 * errors.max()
    assert rich.errors[0] < 1e-5
    assert rich.n_modes < 100
    # near the sample, too
    near = exact(fe, 0.36, 1.5)
    assert distances(eigenvalues(rich, mu=0.36, omega=1.5), near[near.imag < top]).max() < 1e-3


def test_modes_that_are_none_of_the_structure_are_left_out():
    fe = squealer()
    top = 12.0
    body = fm.ModalBody.from_fe(
        "bars", fe, points={"tip": 150}, axes="xy", up_to=top / (2 * np.pi), scales=SCALES, enrich=[{"mu": 0.4}],
    )  # fmt: skip
    grid = [0.1, 0.4]
    found = fm.analysis.complex_eigenvalues(scene_of(body), over="mu", values=grid, highest=top)
    assert found.frequency.max() <= 1.01 * top
    assert all(c.frequency <= top for c in found.critical)
    whole = exact(fe, 0.4, 2.0)
    assert found.eigenvalues.shape[1] == np.count_nonzero(whole.imag <= top)
    maps = fm.analysis.stability_map(scene_of(body), over=("mu", "omega"), values=[grid, [2.0]], highest=top)
    assert maps.growth[1, 0] == pytest.approx(whole[whole.imag <= top].real.max(), rel=1e-3)
    assert maps.frequency.max() <= top
    with pytest.raises(fm.FricmbError, match="highest"):
        fm.analysis.complex_eigenvalues(scene_of(body), over="mu", values=grid, highest=-1.0)


def test_estimated_errors_are_those_of_eigenvalues():
    from fricmb.reduction import lowest_modes
    from fricmb.reduction._enrich import Pencil, pairs
    from fricmb.reduction._factor import factor

    fe = squealer()
    V = lowest_modes("bars", fe.M, fe.K, count=30).shapes
    pencil = Pencil(M=fe.M, C=fe.C + fe.parts["DG"], K=fe.K + 0.2 * fe.parts["KR"])
    found = pairs(pencil, V, factor(fe.K.tocsc()), 10.0)
    whole = exact(fe, 0.2, 1.0)
    true = np.array([np.abs(whole - value).min() / abs(value) for value in found.values])
    seen = true > 1e-9
    assert seen.sum() > 4
    np.testing.assert_allclose(found.errors[seen], true[seen], rtol=0.5)


def test_without_a_sample_modes_are_those_of_the_structure():
    fe = squealer()
    body = fm.ModalBody.from_fe(
        "bars", fe, points={"face": fe.nodes(where=lambda x: x[0] > 146.5)}, axes="y", n_modes=9
    )
    np.testing.assert_allclose(body.frequencies[:9], fe.frequencies(9), rtol=1e-9)
    assert list(body.shapes) == ["face_148", "face_149", "face_150"]
    # static flexibility at the points is whole
    rows = np.vstack([fe.rows(node, "y") for node in (148, 149, 150)])
    expected = rows @ np.linalg.solve(fe.K.toarray(), rows.T)
    shapes = np.vstack([body.shapes[name] for name in body.shapes])
    np.testing.assert_allclose(shapes / np.square(body.frequencies) @ shapes.T, expected, rtol=1e-7)


def test_normals_of_a_surface():
    # a cube's corner masses; the face x = 1 has the normal (1, 0, 0), turned by a rotation
    turn = scipy.linalg.expm(np.cross(np.eye(3), [0.3, 0.1, -0.7]))
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float) @ turn.T
    labels = [(i + 1, d) for i in range(8) for d in (1, 2, 3)]
    fe = fm.fe.FEModel(
        M=np.eye(24), K=np.diag(np.arange(1.0, 25.0)), labels=labels,
        coordinates={i + 1: at for i, at in enumerate(corners)}, sets={"FACE": [5, 6, 7, 8]},
    )  # fmt: skip
    body = fm.ModalBody.from_fe("cube", fe, points={"pad": fe.nodes("FACE")}, normals="surface", n_modes=24)
    shapes = body.shapes["pad_7"]
    along = np.zeros((3, 24))
    along[:, 18:21] = np.eye(3)  # modes are the degrees of freedom, in their order
    local = np.abs(shapes) @ np.abs(along).T
    np.testing.assert_allclose(local[2], np.abs(turn @ [1.0, 0.0, 0.0]), atol=1e-12)
    named = fm.ModalBody.from_fe("cube", fe, points={"pad": 7}, normals={"pad": turn @ [1, 0, 0]}, n_modes=24)
    np.testing.assert_allclose(np.abs(named.shapes["pad"][2]), np.abs(shapes[2]), atol=1e-12)
    with pytest.raises(fm.SceneError, match="at least three nodes that are not on one line"):
        fm.ModalBody.from_fe("cube", fe, points={"pad": [1, 2]}, normals="surface", n_modes=3)


def test_structural_damping_becomes_that_of_each_mode():
    fe = squealer()
    lossy = fm.fe.FEModel(M=fe.M, K=fe.K, H=0.03 * fe.K)
    body = fm.ModalBody.from_fe("b", lossy, points={"p": 0}, axes="x", n_modes=6, residual=False)
    np.testing.assert_allclose(body.damping_ratios, 0.015, rtol=1e-9)
    at = fm.ModalBody.from_fe("b", lossy, points={"p": 0}, axes="x", n_modes=6, residual=False, structural_at=0.5)
    np.testing.assert_allclose(at.damping_ratios, 0.015 * np.array(at.frequencies) / np.pi, rtol=1e-9)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"up_to": None}, "give up_to, a frequency, or n_modes"),
        ({"up_to": -1.0}, "up_to must be a finite number > 0, got -1.0"),
        ({"up_to": 1e-9}, "no mode up to the given frequency"),
        (
            {"enrich": [{"nu": 0.4}]},
            r"'nu' in enrich is neither a part of the model \(KR, DG\) nor a parameter in scales",
        ),
        ({"enrich": {"mu": 0.4}}, "enrich must be a list of dicts"),
        ({"scales": {"KX": 1.0}}, "unknown part in scales.*'KX'"),
        ({"points": {"p": 999}}, "there is no node 999"),
        ({"points": {"p": 3}, "axes": "xyz"}, "node 3 has no displacement along 'z'"),
        ({"normals": "out"}, "normals must be 'surface', a dict"),
        ({"damping_ratios": 0.1}, "damping of its own"),
        ({"n_modes": 0}, "n_modes must be an integer from 1 to 300"),
    ],
)
def test_what_cannot_be_is_refused(changes, words):
    given = {"points": {"p": 3}, "axes": "xy", "up_to": 1.0} | changes
    with pytest.raises(fm.FricmbError, match=words):
        fm.ModalBody.from_fe("bars", squealer(), **given)


def test_friction_in_the_stiffness_is_refused_with_the_remedy():
    fe = squealer()
    rubbing = fm.fe.FEModel(M=fe.M, K=fe.K + 0.4 * fe.parts["KR"], labels=fe.labels)
    with pytest.raises(fm.SceneError, match=r"K of the model must be symmetric.*symmetrised\(\)"):
        fm.ModalBody.from_fe("bars", rubbing, points={"p": 3}, axes="x", n_modes=5)
    split = rubbing.symmetrised("K_mu")
    body = fm.ModalBody.from_fe("bars", split, points={"p": 3}, axes="x", up_to=2.0, enrich=[{"K_mu": 1.0}])
    scene = fm.Scene("bars", [body, body.matrix("K_mu", K="K_mu")])
    # damping of the whole is C = 0 here
    M, K = fe.M.toarray(), (fe.K + 0.4 * fe.parts["KR"]).toarray()
    expected = np.sqrt(-scipy.linalg.eigvals(K, M).astype(complex))
    expected = np.where(expected.imag > 0, expected, -expected)
    found = fm.analysis.steady_sliding(scene).eigenpairs()[0]
    assert distances(found, expected[np.abs(expected) < 12.0]).max() < 1e-5
    with pytest.raises(fm.FricmbError, match=r"unknown part.*'KX'.*'K_mu'"):
        body.matrix("m", K="KX")


@needs_real
@pytest.mark.slow
def test_industrial_brake():
    """4669 degrees of freedom; eigenvalues and the critical value are those of the whole."""
    scene = industrial_brake()
    assert scene["brake"].n_modes <= 300
    found = fm.analysis.steady_sliding(scene).eigenpairs()[0]
    growing = np.sort_complex(found[(found.real > 0.0) & (found.imag > 0.0)])
    np.testing.assert_allclose(growing.real, np.real(GROWING), rtol=1e-3)
    np.testing.assert_allclose(growing.imag, np.imag(GROWING), rtol=1e-6)
    modes = fm.analysis.complex_eigenvalues(scene, over="kappa", values=[0.35, 0.45])
    (first,) = modes.critical
    assert first.value == pytest.approx(0.404563081, rel=1e-5)
    assert first.frequency / (2 * np.pi) == pytest.approx(2781.626564, rel=1e-6)


def test_models_and_bodies_go_into_files(tmp_path):
    import pickle

    fe = pickle.loads(pickle.dumps(squealer(20)))
    body = fm.ModalBody.from_fe(
        "bars", fe, points={"tip": 20}, axes="xy", n_modes=4, scales=SCALES, enrich=[{"mu": 0.4, "omega": 2.0}]
    )
    sol = fm.simulate(scene_of(body), t_end=0.2, initial={"velocity": {"bars.mode1": 1.0}})
    sol.save(tmp_path / "run.npz")
    again = fm.Solution.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(again.q, sol.q)
    kept = again.scene["bars"]
    np.testing.assert_array_equal(kept.parts["KR"], body.parts["KR"])
    assert kept.errors == body.errors
    assert again.scene.parameters["mu"] == 0.4
