"""One chain in the formats of several programs, against its closed form; files that are cut, foreign or too large."""

import sys

import numpy as np
import pytest
import scipy.io
import scipy.sparse

import fricmb as fm
from fricmb.errors import FileError, MissingExtraError
from tests.fe.make_files import DATA, LABELS, chain, frequencies

FILES = {"chain.sti": None, "chain.mtx": None, "job_STIF2.mtx": None, "chain.op4": "pyyeti", "chain.pch": "pyyeti"}


def needed(name):
    if FILES[name]:
        pytest.importorskip(FILES[name])


@pytest.mark.parametrize("name", FILES)
def test_the_formats_of_programs(name):
    needed(name)
    fe = fm.fe.read(DATA / name)
    np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-9)
    if name == "chain.op4":  # has no names of rows
        assert fe.labels is None
    else:
        np.testing.assert_array_equal(fe.labels, LABELS)
        np.testing.assert_allclose(fe.check().mass, 6e-3)


def test_single_matrices_in_files_of_their_own(tmp_path):
    M, K = chain()
    scipy.io.mmwrite(tmp_path / "m.mtx", scipy.sparse.csr_array(M))
    scipy.sparse.save_npz(tmp_path / "k.npz", scipy.sparse.csr_array(np.triu(K)))
    np.save(tmp_path / "g.npy", np.eye(9))
    fe = fm.fe.read({"M": tmp_path / "m.mtx", "K": tmp_path / "k.npz", "DG": tmp_path / "g.npy"})
    np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-9)
    assert "K: upper triangle of a symmetric matrix completed" in fe.notes
    assert fe.matrix("DG").nnz == 9


@pytest.mark.parametrize("kind", ["npz", "mat", "h5"])
def test_containers(kind, tmp_path):
    M, K = chain()
    G = scipy.sparse.coo_array(np.diag(np.arange(1.0, 9.0), -1))
    entries = {"G_r": G.coords[0].astype(np.int16), "G_c": G.coords[1].astype(np.int16), "G_v": G.data}
    path = tmp_path / f"model.{kind}"
    if kind == "npz":
        np.savez(path, mass=M, stiff=K, **entries)
    elif kind == "mat":
        scipy.io.savemat(path, {"mass": M, "stiff": scipy.sparse.csc_matrix(K), "G": G.tocsc()})
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            for key, value in {"mass": M, "stiff": K, **entries}.items():
                file[key] = value
    fe = fm.fe.read(path, names={"M": "mass", "K": "stiff", "DG": "G"})
    np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-9)
    np.testing.assert_array_equal(fe.matrix("DG").toarray(), G.toarray() - G.toarray().T)  # a triangle without diagonal
    by_words = fm.fe.read(path)
    np.testing.assert_allclose(by_words.frequencies(9), frequencies(), rtol=1e-9)
    assert "M is mass, K is stiff, G is G, by their names" in by_words.notes
    with pytest.raises(FileError, match=r"expected M and K, found .*stiff.*names="):
        fm.fe.read(path, names={"M": "mass"})
    with pytest.raises(FileError, match=r"unknown matrix 'stif'.*'stiff'"):
        fm.fe.read(path, names={"M": "mass", "K": "stif"})


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (("BMLL", "BKLL", "BDLL", "BKQLL"), {"M": "BMLL", "K": "BKLL", "C": "BDLL", "KQ": "BKQLL"}),
        (("m_red", "k_red"), {"M": "m_red", "K": "k_red"}),
        (("K", "M", "KR"), {"M": "M", "K": "K", "KR": "KR"}),
        (("Stiffness", "mass"), {"M": "mass", "K": "Stiffness"}),
        (("A", "B"), {}),
    ],
)
def test_matrices_by_what_tells_their_names_apart(names, found):
    from fricmb.fe._named import recognised

    assert recognised(names) == found


def test_a_folder_of_one_matrix_a_file(tmp_path):
    M, K = chain()
    scipy.io.mmwrite(tmp_path / "BMLL00.mtx", scipy.sparse.csr_array(M))
    scipy.io.savemat(tmp_path / "BKLL00.mat", {"anything": scipy.sparse.csc_matrix(np.tril(K))})
    np.save(tmp_path / "BKQLL00.npy", np.eye(9))
    (tmp_path / "mesh.inp").write_bytes((DATA / "chain.inp").read_bytes())
    fe = fm.fe.read(tmp_path)
    np.testing.assert_allclose(fe.frequencies(9), frequencies(), rtol=1e-9)
    assert list(fe.parts) == ["KQ"]
    assert fe.nodes("TIP").tolist() == [13]


def test_nodes_from_an_input_file():
    fe = fm.fe.read(DATA / "chain.sti", mesh=DATA / "chain.inp", units="t-mm-s")
    assert fe.nodes("TIP").tolist() == [13]
    assert fe.nodes("TWO").tolist() == [11, 12]
    assert fe.nodes(where=lambda x: x[0] > 1.5).tolist() == [12, 13]
    assert fe.nodes(near=(1.1, 0, 0)).tolist() == [11]
    with pytest.raises(fm.FricmbError, match=r"unknown set of nodes.*'TIPP'.*'TIP'"):
        fe.nodes("TIPP")


def test_a_folder_with_one_model(tmp_path):
    for ending in ("sti", "mas", "dof"):
        (tmp_path / f"chain.{ending}").write_bytes((DATA / f"chain.{ending}").read_bytes())
    assert fm.fe.read(tmp_path).n == 9
    (tmp_path / "other.mtx").write_bytes((DATA / "chain.mtx").read_bytes())
    with pytest.raises(FileError, match=r"files of one model, found .*other\.mtx"):
        fm.fe.read(tmp_path)
    assert fm.fe.read(tmp_path, format="abaqus").n == 9
    (tmp_path / "empty").mkdir()
    with pytest.raises(FileError, match="found none"):
        fm.fe.read(tmp_path / "empty")


def copies(tmp_path, name, content):
    """The files of a model in a folder, one of them with other content."""
    family = {"chain.sti": ["chain.mas", "chain.dof"], "job_STIF2.mtx": ["job_MASS2.mtx"]}.get(name, [])
    for other in family:
        (tmp_path / other).write_bytes((DATA / other).read_bytes())
    (tmp_path / name).write_bytes(content)
    return tmp_path / name


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("share", [0.0, 0.2, 0.45, 0.7, 0.93])
def test_files_that_are_cut(name, share, tmp_path):
    needed(name)
    whole = (DATA / name).read_bytes()
    path = copies(tmp_path, name, whole[: int(share * len(whole))])
    with pytest.raises(FileError, match=name.replace(".", r"\.")) as caught:
        fm.fe.read(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", [*FILES, "a.npz", "a.mat", "a.h5", "a.full", "a.op2"])
@pytest.mark.parametrize(
    "content", [b"\x00\xff\x7fELF" * 300, b"once upon a time, 3.0, 4\n" * 50, b"%PDF-1.7\n1 0 obj\n"]
)
def test_files_of_something_else(name, content, tmp_path):
    for library, ending in (("pyyeti", (".op4", ".pch", ".op2")), ("ansys.mapdl.reader", ".full"), ("h5py", ".h5")):
        if name.endswith(ending):
            pytest.importorskip(library)
    with pytest.raises(FileError) as caught:
        fm.fe.read(copies(tmp_path, name, content))
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("name", "old", "new", "words"),
    [
        ("chain.sti", "1 1 ", "1 99999999999 ", "line 1: rows and columns must be from 1 to 9.*got 1 1e\\+11"),
        ("chain.sti", "9 9 ", "9 8 ", "row 9 of 9 has no diagonal entry"),
        ("chain.mtx", "NODES=         3", "NODES=         4", "line 2: expected 4 numbers of nodes, got 3"),
        ("chain.mtx", "*MATRIX,TYPE=MASS", "*MATRIX,TYPE=MESS", "expected \\*MATRIX, TYPE="),
        (
            "chain.mtx",
            "1,          2,          3",
            "1,          2",
            "expected 21 numbers, the lower triangle of 6 rows",
        ),
        ("job_STIF2.mtx", "11,1, 11,1", "11,1, 11.5,1", "entry 1: expected whole numbers"),
    ],
)
def test_the_record_is_named(name, old, new, words, tmp_path):
    text = (DATA / name).read_text()
    assert old in text
    with pytest.raises(FileError, match=words):
        fm.fe.read(copies(tmp_path, name, text.replace(old, new, 1).encode()))


def test_nothing_in_a_file_is_executed(tmp_path):
    np.savez(tmp_path / "a.npz", M=np.array([{"x": 1}], dtype=object), K=np.eye(1))
    with pytest.raises(FileError, match=r"a\.npz: expected an npz file of numbers"):
        fm.fe.read(tmp_path / "a.npz")


def test_sizes_that_no_model_has(tmp_path):
    np.savez(tmp_path / "a.npz", M_r=[0], M_c=[10**12], M_v=[1.0], K=np.eye(1))
    with pytest.raises(FileError, match="M: rows and columns must be from 0 to"):
        fm.fe.read(tmp_path / "a.npz")
    np.savez(tmp_path / "b.npz", M=np.eye(2), K=np.eye(3))
    with pytest.raises(FileError, match=r"b\.npz: .*K must have the shape of M, \(2, 2\); got \(3, 3\)"):
        fm.fe.read(tmp_path / "b.npz")


def test_a_library_that_is_missing_is_named_with_its_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyyeti", None)
    with pytest.raises(MissingExtraError, match=r'pyyeti: pip install "fricmb\[nastran\]"') as caught:
        fm.fe.read(DATA / "chain.op4")
    assert isinstance(caught.value, ImportError)
    assert isinstance(caught.value, fm.FricmbError)


def test_arguments():
    with pytest.raises(FileError, match="there is no such file"):
        fm.fe.read("nowhere.op4")
    with pytest.raises(fm.SceneError, match="format must be one of npz"):
        fm.fe.read(DATA / "chain.sti", format="abacus")
    with pytest.raises(FileError, match="its ending names no format"):
        fm.fe.read(DATA / "chain.inp")
    with pytest.raises(FileError, match="units must be 'SI' or"):
        fm.fe.read(DATA / "chain.sti", units="stone-furlong-fortnight")
