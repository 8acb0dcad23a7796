"""Modes that programs write beside their matrices: they belong together, or are refused with the number."""

import numpy as np
import pytest
import scipy.linalg

import fricmb as fm
from fricmb.errors import FileError
from tests.fe.make_files import DATA, LABELS, MASS, chain, frequencies
from tests.fe.op2 import write_complex_modes, write_matrices, write_modes
from tests.real import needs_real, real

STRIP = DATA / "strip"
#: From the table that CalculiX prints, seven digits.
HERTZ = [957.0435, 1888.495, 6367.949]


def modes_of_chain():
    M, K = chain()
    w2, V = scipy.linalg.eigh(K, M)
    shapes = np.zeros((9, 3, 6))
    shapes[:, :, :3] = V.T.reshape(9, 3, 3)
    return np.sqrt(w2), shapes


def test_strip_of_calculix():
    found = fm.measure.read(STRIP / "strip.frd")
    np.testing.assert_allclose(found.modes.hertz, HERTZ, rtol=1e-7)
    np.testing.assert_array_equal(found.modes.masses, 1.0)
    np.testing.assert_allclose(found.points[20], [60.0, 8.0, 4.0])
    fe = fm.fe.read(STRIP, units="t-mm-s")
    np.testing.assert_allclose(fe.frequencies(3) / (2 * np.pi), HERTZ, rtol=1e-7)
    assert sorted(fe.nodes("TIP").tolist()) == [5, 10, 15, 20]
    # six digits of a shape, and elements with coordinates of their own inside
    assert fe.check(modes=STRIP / "strip.frd").defect < 1e-3
    stiffer = fm.fe.FEModel(M=fe.M, K=1.02 * fe.K, labels=fe.labels)
    with pytest.raises(fm.SceneError, match=r"do not belong to these matrices.* is 0\.0\d+ of \|K phi\|"):
        stiffer.check(modes=STRIP / "strip.frd")


def test_modes_of_nastran(tmp_path):
    pytest.importorskip("pyyeti")
    omega, shapes = modes_of_chain()
    path = tmp_path / "chain.op2"
    write_modes(path, omega, [11, 12, 13], shapes, np.ones(9))
    found = fm.measure.read(path).modes
    np.testing.assert_allclose(found.frequencies, frequencies(), rtol=1e-6)
    np.testing.assert_allclose(found.at(12), shapes[:, 1, :3].T, rtol=1e-6)
    np.testing.assert_array_equal(found.masses, 1.0)
    M, K = chain()
    assert fm.fe.FEModel(M=M, K=K, labels=LABELS).check(modes=path).defect < 1e-5
    body = fm.ModalBody.from_test("chain", found, points={"end": 13})
    assert body.shapes["end"].shape == (3, 9)
    assert np.abs(body.shapes["end"]).max() < 1.0 / np.sqrt(MASS)


@pytest.mark.parametrize("polar", [False, True])
def test_complex_modes_of_nastran(polar, tmp_path):
    """Of each pair of conjugate ones the one that turns forward; one of them stands in the file turning backward."""
    pytest.importorskip("pyyeti")
    rng = np.random.default_rng(2)
    poles = np.array([-3 + 40j, -3 - 40j, 1 - 70j, -5 + 0j])
    shapes = rng.normal(size=(4, 3, 6)) + 1j * rng.normal(size=(4, 3, 6))
    shapes[1] = shapes[0].conj()
    write_complex_modes(tmp_path / "a.op2", poles, [13, 11, 12], shapes, polar=polar)
    measured = fm.measure.read(tmp_path / "a.op2")
    found = measured.modes
    assert measured.notes == ("1 modes are conjugate to others and left out",)
    np.testing.assert_allclose(found.frequencies, [5.0, np.hypot(3, 40), np.hypot(1, 70)], rtol=1e-6)
    np.testing.assert_allclose(found.damping_ratios, [1.0, 3 / np.hypot(3, 40), -1 / np.hypot(1, 70)], rtol=1e-6)
    assert found.nodes.tolist() == [11, 12, 13]
    expected = [shapes[3, 1, :3], shapes[0, 1, :3], shapes[2, 1, :3].conj()]
    np.testing.assert_allclose(found.at(11), np.array(expected).T, atol=1e-6)
    M, K = chain()
    with pytest.raises(fm.SceneError, match=r"are complex; give real ones \(SOL 103, say\)"):
        fm.fe.FEModel(M=M, K=K, labels=LABELS).check(modes=found)


@needs_real
def test_complex_modes_of_a_file_of_nastran():
    """Masses of 10 and 20, springs of 1e6 to the ground and 1e9 between, with structural damping of 0.23 and 0.15."""
    pytest.importorskip("pyyeti")
    measured = fm.measure.read(real("units_mass_spring_damper.op2"))
    found = measured.modes
    K = 1e6 * (1 + 0.23j) * np.diag([1, 0]) + 1e9 * (1 + 0.15j) * np.array([[1, -1], [-1, 1]])
    w2, V = np.linalg.eig(np.linalg.solve(np.diag([10.0, 20.0]), K))
    poles, ratios = 1j * np.sqrt(w2)[::-1], (V[0] / V[1])[::-1]
    np.testing.assert_allclose(found.frequencies, np.abs(poles), rtol=1e-6)
    np.testing.assert_allclose(found.damping_ratios, -poles.real / np.abs(poles), rtol=1e-5)
    np.testing.assert_allclose(found.at(2)[0] / found.at(3)[0], ratios, rtol=1e-6)
    assert sorted(measured.points) == [1, 2, 3]


def test_what_holds_no_modes_is_said(tmp_path):
    pytest.importorskip("pyyeti")
    write_matrices(tmp_path / "a.op2", mxx=np.eye(2), kxx=np.eye(2))
    with pytest.raises(FileError, match=r"a\.op2: expected modes \(OUG of SOL 103, 107 or 110, by .*found MXX, KXX"):
        fm.measure.read(tmp_path / "a.op2")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (" 9999\n", "", r"line \d+: expected '9999', the end of a \.frd file"),
        ("    2C                            20                                     1", "    2C" + " " * 70 + "2",
         "line 12: expected numbers in text; this file is binary"),
        (" -1        20 6.0", " -1        20 6.x", r"line \d+: expected the number of a node and three numbers"),
        ("1MODAL", "0     ", "expected displacements .* of a .FREQUENCY step, found none"),
    ],
)  # fmt: skip
def test_the_record_of_a_result_file_is_named(old, new, words, tmp_path):
    text = (STRIP / "strip.frd").read_text()
    assert old in text
    for k in "123":
        text = text.replace(f"{k}MODAL", "0     ") if old == "1MODAL" else text
    (tmp_path / "a.frd").write_text(text.replace(old, new, 1))
    with pytest.raises(FileError, match=words):
        fm.measure.read(tmp_path / "a.frd")
