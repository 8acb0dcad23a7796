"""Files of other programs, against numbers that were found from them by independent ones."""

import gzip

import numpy as np
import pytest

import fricmb as fm
from tests.real import needs_real, real

pytestmark = needs_real
BRAKE = {"M": "BMLL", "K": "BKLL", "C": "BDLL", "H": "BHLL", "KR": "BKQLL", "DG": "BYLL", "DR": "BDIWLL"}


def hertz(fe, n):
    return fe.frequencies(n) / (2 * np.pi)


def unpacked(name, tmp_path):
    (tmp_path / name).write_bytes(gzip.decompress(real(f"{name}.gz").read_bytes()))
    return tmp_path / name


@pytest.mark.parametrize("order", [("outboard", "inboard"), ("inboard", "outboard")])
def test_superelements_of_nastran_joined(order):
    pytest.importorskip("pyyeti")
    fe = fm.fe.join(*(fm.fe.read(real(f"{name}.op4")) for name in order))
    found = hertz(fe, 11)
    assert (found[:6] == 0.0).all()
    # the program's table has single precision
    np.testing.assert_allclose(found[6:], [1.6988002, 1.7674873, 1.8577204, 3.4196122, 7.0242105], rtol=2e-7)


def test_beam_of_calculix():
    fe = fm.fe.read(real("simplebeampipe3_m.sti.gz"))
    # bending in pairs
    np.testing.assert_allclose(hertz(fe, 6)[::2], [15002.37, 93766.50, 261586.8], rtol=4e-7)
    assert fe.check().massless == 36


def test_plate_of_calculix():
    table = [line.split() for line in real("shellf_e.dat").read_text().splitlines()]
    cycles = [float(row[3]) for row in table if len(row) == 5 and row[0].isdecimal()]
    # 14 digits of a stiffness of 1e6 are 1e-5 of the 7e-4 that the lowest mode has
    np.testing.assert_allclose(hertz(fm.fe.read(real("shellf_m.mas.gz")), 10), cycles[:10], rtol=1e-5)


def test_element_of_abaqus():
    found = fm.fe.read(real("abaqus_total.mtx")).check()
    assert found.rigid == 6
    assert found.lowest[0] / (2 * np.pi) == pytest.approx(28387.910, abs=1e-3)


def test_substructure_of_abaqus():
    fe = fm.fe.read(real("abaqus_interface-beam-sub.mtx.gz"))
    assert fe.n == 150  # 47 nodes with three degrees of freedom, one with six, three more
    assert fe.check().symmetric


def test_beam_of_ansys(tmp_path):
    pytest.importorskip("ansys.mapdl.reader")
    fe = fm.fe.read(unpacked("ansys_hexbeam.full", tmp_path))
    found = hertz(fe, 3)
    np.testing.assert_allclose(found[[0, 2]], [1283.20037, 5781.97486], rtol=2e-9)
    assert "63 fixed degrees of freedom taken out" in fe.notes
    assert fm.fe.read(unpacked("ansys_sparse.full", tmp_path)).check().rigid == 6


def test_brake_has_its_parts():
    fe = fm.fe.read(real("brake_5koref1.npz"), names=BRAKE, units="t-mm-s")
    assert fe.n == 4669
    found = fe.check()
    assert found.symmetric
    assert found.asymmetry["DG"] == pytest.approx(2.0)
    assert 0.1 < found.asymmetry["KR"] < 2.0
    # the same structure in newtons and metres
    np.testing.assert_allclose(fe.in_units("SI").frequencies(3), fe.frequencies(3), rtol=1e-9)
