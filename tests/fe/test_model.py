"""Matrices as they come, what is said of them, and models that are joined: against closed forms."""

import numpy as np
import pytest
import scipy.linalg
import scipy.sparse

import fricmb as fm
from tests.fe.make_files import LABELS, chain, frequencies

TIE = np.array([[1.0, -1.0], [-1.0, 1.0]])


def test_triangles_are_completed():
    M, K = chain()
    G = np.tril(np.ones((9, 9)), -1)
    for part in (np.tril, np.triu):
        fe = fm.fe.FEModel(M=M, K=part(K), parts={"DG": part(G + G.T), "KR": part(G)})
        np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-12)
    np.testing.assert_array_equal(fe.parts["DG"].toarray(), np.triu(G.T) - np.triu(G.T).T)
    with_word = fm.fe.FEModel(M=M, K=K, parts={"DG": G}, triangles={"DG": "symmetric"})
    np.testing.assert_array_equal(with_word.parts["DG"].toarray(), G + G.T)
    assert fm.fe.FEModel(M=M, K=K, parts={"DG": G}, triangles={"DG": "full"}).parts["DG"].nnz == 36


def test_massless_degrees_of_freedom():
    # two masses and a massless joint between them: springs 2 and 3 in line are one of 6/5
    M = np.diag([1.0, 0.0, 2.0])
    K = np.array([[2.0, -2.0, 0.0], [-2.0, 5.0, -3.0], [0.0, -3.0, 3.0]])
    fe = fm.fe.FEModel(M=M, K=K)
    np.testing.assert_allclose(fe.frequencies(3), [0.0, np.sqrt(1.2 * 1.5)], atol=1e-12)
    found = fe.check()
    assert (found.massless, found.rigid) == (1, 1)
    assert "1 motions without mass" in str(found)
    # a mass that is semidefinite without an empty row
    T = np.array([[1.0, 0.3, 0.0], [0.0, 1.0, 0.2], [0.1, 0.0, 1.0]])
    turned = fm.fe.FEModel(M=T.T @ M @ T, K=T.T @ K @ T)
    np.testing.assert_allclose(turned.frequencies(3), [0.0, np.sqrt(1.8)], atol=1e-7)
    assert turned.check().massless == 1


def test_many_massless_degrees_of_freedom_by_the_sparse_solver():
    # a bar of 700 masses with a massless point in the middle of each spring: k/2 stays in between
    n = 1400
    K = scipy.sparse.diags_array([np.r_[np.full(n - 1, 4.0), 2.0], np.full(n - 1, -2.0), np.full(n - 1, -2.0)],
                                 offsets=[0, 1, -1]).tocsr()  # fmt: skip
    M = scipy.sparse.diags_array(np.arange(n) % 2.0).tocsr()
    j = np.arange(1, 7)
    expected = 2.0 * np.sin((2 * j - 1) * np.pi / (2 * (n + 1)))
    np.testing.assert_allclose(fm.fe.FEModel(M=M, K=K).frequencies(6), expected, rtol=1e-8)


def test_motions_that_nothing_holds_are_refused():
    fe = fm.fe.FEModel(M=np.diag([1.0, 0.0, 0.0]), K=np.array([[1.0, 0, 0], [0, 1, -1], [0, -1, 1]]))
    with pytest.raises(fm.SceneError, match="neither mass nor stiffness"):
        fe.frequencies(2)


def test_empty_and_fixed_rows_are_taken_out_and_counted():
    M, K = chain()
    wide = np.zeros((10, 10))
    stiff = wide.copy()
    wide[:9, :9], stiff[:9, :9] = M, K
    labels = np.vstack([LABELS, [99, 4]])
    fe = fm.fe.FEModel(M=wide, K=stiff, labels=labels, fixed=[(13, 1), (13, 2), (13, 3)])
    assert fe.n == 6
    assert fe.notes == (
        "3 fixed degrees of freedom taken out",
        "1 degrees of freedom without mass and stiffness taken out",
    )
    # between two walls: 2 sqrt(k/m) sin(j pi/6)
    assert fe.frequencies(1)[0] == pytest.approx(2.0 * np.sqrt(200.0 / 2e-3) * 0.5, rel=1e-12)
    by_place = fm.fe.FEModel(M=M, K=K, fixed=[6, 7, 8])
    np.testing.assert_allclose(by_place.frequencies(6), fe.frequencies(6))


def test_complex_stiffness_is_taken_apart():
    M, K = chain()
    fe = fm.fe.FEModel(M=M, K=K * (1 + 0.02j))
    np.testing.assert_allclose(fe.H.toarray(), 0.02 * K)
    np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-12)
    with pytest.raises(fm.SceneError, match="C must be real"):
        fm.fe.FEModel(M=M, K=K, C=K * 1j)


def test_precision_and_asymmetry_are_told():
    M, K = chain()
    rough = (K + np.pi * 1e-3).astype(np.float32).astype(float)
    fe = fm.fe.FEModel(M=M, K=rough)
    assert fe.precision == "single"
    assert fm.fe.FEModel(M=M, K=K + np.pi * 1e-3).precision == "double"
    push = np.zeros((9, 9))
    push[0, 1] = 80.0
    uneven = fm.fe.FEModel(M=M, K=K + push)
    found = uneven.check()
    assert not found.symmetric
    assert found.asymmetry["K"] == pytest.approx(80.0 / 3600.0)
    split = uneven.symmetrised("KF")
    np.testing.assert_allclose((split.K + split.parts["KF"]).toarray(), K + push)
    assert split.check().symmetric


def test_mass_in_local_frames():
    M, K = chain()
    turn = scipy.linalg.expm(np.cross(np.eye(3), [0.3, -0.5, 1.1]))
    frames = dict.fromkeys((11, 12, 13), turn)
    T = np.kron(np.eye(3), turn.T)  # global = T local
    fe = fm.fe.FEModel(M=T.T @ M @ T, K=T.T @ K @ T, labels=LABELS, frames=frames)
    np.testing.assert_allclose(fe.check().mass, 6e-3)
    np.testing.assert_allclose(fe.rows(12, "xz") @ T.T, np.eye(9)[[3, 5]], atol=1e-14)


def test_units():
    M, K = chain()
    fe = fm.fe.FEModel(
        M=M, K=K, C=0.1 * K, parts={"KR": K, "DG": np.eye(9)}, units="t-mm-s", coordinates={1: (1, 2, 3)}
    )
    si = fe.in_units("SI")
    # t to kg 1e3, N/mm to N/m 1e3, N s/mm to N s/m 1e3
    for name in ("M", "K", "C", "KR", "DG"):
        np.testing.assert_allclose(si.matrix(name).toarray(), 1e3 * fe.matrix(name).toarray())
    np.testing.assert_allclose(si.coordinates[1], [1e-3, 2e-3, 3e-3])
    milli = fe.in_units("kg-mm-ms")
    np.testing.assert_allclose(milli.frequencies(9), 1e-3 * frequencies(), rtol=1e-12)
    # a rotation has no length: its inertia in t mm^2 is 1e-3 of that in kg m^2
    turning = fm.fe.FEModel(M=np.diag([1.0, 1.0]), K=np.eye(2), labels=[(1, 3), (1, 4)], units="t-mm-s").in_units("SI")
    np.testing.assert_allclose(turning.M.toarray().diagonal(), [1e3, 1e-3])
    with pytest.raises(fm.SceneError, match="its units are not known"):
        fm.fe.FEModel(M=M, K=K).in_units("SI")


def test_modes_that_do_not_belong_are_refused_with_the_number():
    M, K = chain()
    fe = fm.fe.FEModel(M=M, K=K, name="chain")
    w2, shapes = scipy.linalg.eigh(K, M)
    assert fe.check((np.sqrt(w2), shapes)).defect < 1e-10
    # |K phi - 1.1 K phi| / |K phi|
    with pytest.raises(fm.SceneError, match=r"do not belong to these matrices.* is 0\.1 of \|K phi\| for mode \d at"):
        fe.check((np.sqrt(1.1 * w2), shapes))
    with pytest.raises(fm.SceneError, match=r"shapes \(9, k\), got \(9,\) and \(3, 9\)"):
        fe.check((np.sqrt(w2), shapes[:3]))


def test_models_that_share_nodes():
    # a row of 40 equal springs and masses, in two parts that share a node
    n = 20
    K = np.zeros((n + 1, n + 1))
    for i in range(n):
        K[i : i + 2, i : i + 2] += TIE
    M = np.diag(np.r_[0.5, np.ones(n - 1), 0.5])
    left = fm.fe.FEModel(M=M, K=K, labels=[(i, 1) for i in range(n + 1)], fixed=[(0, 1)], sets={"A": [1]}, name="left")
    right = fm.fe.FEModel(M=M, K=K, labels=[(n + i, 1) for i in range(n + 1)], sets={"B": [40]}, name="right")
    whole = fm.fe.join(left, right, name="row")
    j = np.arange(1, 6)
    np.testing.assert_allclose(whole.frequencies(5), 2.0 * np.sin((2 * j - 1) * np.pi / 160), rtol=1e-12)
    assert whole.nodes("B").tolist() == [40]
    assert whole.name == "row"
    with pytest.raises(fm.SceneError, match="share no degree of freedom"):
        fm.fe.join(left, fm.fe.FEModel(M=np.eye(1), K=np.eye(1), labels=[(77, 1)]))


def test_axes_of_shared_nodes_are_turned():
    turn = scipy.linalg.expm(np.cross(np.eye(3), [0.2, 0.9, -0.4]))
    M, K = np.diag([1.0, 2.0, 3.0]), np.diag([5.0, 7.0, 11.0])
    labels, place = [(1, 1), (1, 2), (1, 3)], {1: (0.0, 0.0, 0.0)}
    plain = fm.fe.FEModel(M=M, K=K, labels=labels, coordinates=place)
    local = fm.fe.FEModel(M=turn @ M @ turn.T, K=turn @ K @ turn.T, labels=labels, coordinates=place, frames={1: turn})
    for pair in ((plain, local), (local, plain)):
        np.testing.assert_allclose(fm.fe.join(*pair).frequencies(3), np.sort(np.sqrt([5.0, 3.5, 11 / 3])), rtol=1e-12)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"M": np.eye(8)}, r"K must have the shape of M, \(8, 8\); got \(9, 9\)"),
        ({"M": np.ones(9)}, "M must be a square matrix"),
        ({"M": "a"}, "M must be a matrix of numbers, got 'a'"),
        ({"K": np.full((9, 9), np.nan)}, r"K must hold finite numbers; K\[0, 0\] = nan"),
        ({"labels": LABELS[:8]}, r"labels must be \(9, 2\) integers"),
        ({"labels": np.ones((9, 2), dtype=int)}, "dof 1 of node 1 stands 9 times"),
        ({"labels": LABELS + np.array([0, 6])}, "degrees of freedom from 0 to 6; got 9"),
        ({"fixed": [(11, 5)], "labels": LABELS}, "dof 5 of node 11, which no label names"),
        ({"fixed": [10]}, "fixed must be places from 0 to 8"),
        ({"parts": {"K": np.eye(9)}}, "names other than M, K, C, H"),
        ({"triangles": {"KX": "skew"}}, "unknown matrix in triangles.*'KX'"),
        ({"triangles": {"K": "odd"}}, "must be 'symmetric', 'skew' or 'full'"),
        ({"coordinates": {1: (1, 2)}}, "coordinates of node 1 must be 3 numbers"),
        ({"frames": {1: np.ones((3, 3))}}, "three axes at right angles"),
        ({"units": "t-mm"}, "units must be 'SI' or mass-length-time"),
        ({"sets": {"A": [0.5]}}, r"sets\['A'\] must be numbers of nodes"),
    ],
)
def test_what_cannot_be_is_refused(changes, words):
    M, K = chain()
    with pytest.raises(fm.SceneError, match=words):
        fm.fe.FEModel(**({"M": M, "K": K} | changes))
