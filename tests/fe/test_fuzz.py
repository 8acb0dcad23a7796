"""Files that are damaged: cut at each record, or with bytes changed.

Each is read, or refused in one sentence that names it; no other error, no crash, no warning, no hang, no memory without
bounds, and nothing of a file that is cut without a word.
"""

import shutil
import time
import tracemalloc
import warnings

import numpy as np
import pytest
import scipy.io
import scipy.io.wavfile

import fricmb as fm
from fricmb.errors import FileError, MissingExtraError
from tests.fe.make_files import DATA, chain
from tests.fe.op2 import write_modes
from tests.fe.test_modes import modes_of_chain

#: Bytes that a damaged file may make a reader ask for: what a size of 32 bits announces, which is never touched.
ROOM = 8 << 30
#: Places where a file is cut or changed at most.
PLACES = 60
T = np.arange(200) * 0.01
Y = np.sin(7.0 * T)


def containers(kind, path, arrays):
    if kind == "npz":
        np.savez(path, **arrays)
    elif kind == "mat":
        scipy.io.savemat(path, arrays)
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            for key, value in arrays.items():
                file[key] = value


def make_matrices(name, folder):
    """One file of a chain, and what belongs to it."""
    family = {"chain.sti": ["chain.mas", "chain.dof"], "chain.dof": ["chain.mas", "chain.sti"],
              "job_STIF2.mtx": ["job_MASS2.mtx"], "strip.sti.gz": ["strip.mas.gz", "strip.dof"]}  # fmt: skip
    path = folder / name
    M, K = chain()
    if name.startswith("strip"):
        for file in (name, *family[name]):
            shutil.copy(DATA / "strip" / file, folder)
    elif (DATA / name).exists():
        for file in (name, *family.get(name, [])):
            shutil.copy(DATA / file, folder)
    elif name == "binary.op4":
        with np.printoptions():  # pyyeti changes how arrays print
            op4 = pytest.importorskip("pyyeti.nastran.op4")
        op4.write(str(path), {"maa": M, "kaa": K}, binary=True)
    elif name == "k.mtx":
        scipy.io.mmwrite(folder / "m.mtx", scipy.sparse.csr_array(M))
        scipy.io.mmwrite(path, scipy.sparse.csr_array(K))
    else:
        containers(path.suffix[1:].replace("h5", "hdf5"), path, {"M": M, "K": K})
    return path


def make_measurements(name, folder):
    path = folder / name
    if name == "strip.frd":
        shutil.copy(DATA / "strip" / name, folder)
    elif name == "a.op2":
        omega, shapes = modes_of_chain()
        write_modes(path, omega, [11, 12, 13], shapes, np.ones(9))
    elif name.endswith(".uff"):
        write_uff(path, binary=name == "binary.uff")
    elif name == "a.csv":
        path.write_text("t [s],x [mm]\n" + "\n".join(f"{t:.5f},{y:.8f}" for t, y in zip(T, Y, strict=True)) + "\n")
    elif name == "a.wav":
        scipy.io.wavfile.write(path, 8000, Y)
    elif name == "a.tdms":
        nptdms = pytest.importorskip("nptdms")
        properties = {"wf_increment": 0.01, "wf_start_offset": 0.0}
        with nptdms.TdmsWriter(str(path)) as file:
            file.write_segment([nptdms.ChannelObject("rig", "force", Y, properties=properties)])
    else:
        containers(path.suffix[1:].replace("h5", "hdf5"), path, {"time": T, "force": Y})
    return path


def write_uff(path, binary):
    pyuff = pytest.importorskip("pyuff")
    file = pyuff.UFF(str(path))
    common = {"id1": "hammer", "rsp_node": 8, "ref_node": 8, "abscissa_spacing": 1, "abscissa_min": 0.0,
              "abscissa_spec_data_type": 18, "orddenom_spec_data_type": 13, "ordinate_spec_data_type": 12}  # fmt: skip
    file.write_sets(
        pyuff.prepare_58(func_type=1, rsp_dir=1, ref_dir=0, x=T, data=Y, binary=int(binary), **common), "add"
    )
    if not binary:
        file.write_sets(
            pyuff.prepare_15(node_nums=[3, 8], def_cs=[0, 0], disp_cs=[0, 0], color=[8, 8], x=[0.0, 1.0], y=[0.0, 2.0],
                             z=[0.0, 3.0]), "add",
        )  # fmt: skip


def read_matrices(path):
    fe = fm.fe.read({"M": path.with_name("m.mtx"), "K": path} if path.name == "k.mtx" else path)
    return np.concatenate([fe.M.toarray().ravel(), fe.K.toarray().ravel()])


def read_measurements(path):
    found = fm.measure.read(path)
    held = [x.y for x in found.signals] + [np.ravel(at) for at in found.points.values()]
    if found.modes is not None:
        held += [found.modes.frequencies, found.modes.shapes.ravel()]
    return np.concatenate(held)


MATRICES = ["chain.sti", "chain.dof", "chain.mtx", "job_STIF2.mtx", "chain.op4", "binary.op4", "chain.pch", "k.mtx",
            "a.npz", "a.mat", "a.h5", "strip.sti.gz"]  # fmt: skip
MEASUREMENTS = ["strip.frd", "a.op2", "a.uff", "binary.uff", "a.csv", "a.wav", "a.npz", "a.mat", "a.h5", "a.tdms"]
KINDS = [("fe", name) for name in MATRICES] + [("measure", name) for name in MEASUREMENTS]
#: A part of such a file is one of its own: nothing says how long it was meant to be.  DMIG entries: those of the mass
#: come last, and rows without mass are counted by `check`.
OF_ANY_LENGTH = ("a.csv", "a.tdms", "chain.pch")
#: Values in whole datasets.
DATASETS = {"a.uff": (200,)}


def prepared(what, name, folder):
    make, read = {"fe": (make_matrices, read_matrices), "measure": (make_measurements, read_measurements)}[what]
    path = make(name, folder)
    try:
        return path, read, read(path)
    except MissingExtraError as error:
        pytest.skip(str(error))


def outcome(path, read):
    """What a damaged file gives; None where it is refused."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            return read(path)
        except FileError as error:
            text = str(error)
            assert path.name.partition(".")[0] in text, text
            assert "\n" not in text, text
            assert len(text) < 500, text
            return None


def ends(data):
    """Ends of records: lines of text, and places of others."""
    found = [i + 1 for i, byte in enumerate(data) if byte == 10]
    if len(found) < 20 or b"\x00" in data:
        found = list(range(0, len(data), max(1, len(data) // PLACES)))
    step = max(1, len(found) // PLACES)
    return [at for at in found[::step] if at < len(data)]


@pytest.mark.parametrize(("what", "name"), KINDS)
def test_cut_at_each_record(what, name, tmp_path):
    path, read, whole = prepared(what, name, tmp_path)
    data = path.read_bytes()
    for at in ends(data):
        path.write_bytes(data[:at])
        found = outcome(path, read)
        if found is None or not data[at:].strip():
            continue
        if name in OF_ANY_LENGTH or found.size in DATASETS.get(name, ()):
            part = whole[: found.size]
            np.testing.assert_allclose(np.where(found == 0.0, part, found), part)
        else:
            assert found.shape == whole.shape, f"{name}, cut behind {at} of {len(data)} bytes, lost something"
            np.testing.assert_array_equal(found, whole)


@pytest.mark.parametrize(("what", "name"), KINDS)
def test_bytes_changed(what, name, tmp_path):
    path, read, _ = prepared(what, name, tmp_path)
    data = path.read_bytes()
    rng = np.random.default_rng(7)
    begin = time.process_time()
    tracemalloc.start()
    for trial in range(PLACES):
        changed = bytearray(data)
        # heads of binary files say sizes: half of the changes are there
        span = min(len(data), 400) if trial % 2 else len(data)
        for at in rng.integers(0, span, 1 + trial % 3):
            changed[at] = int(rng.integers(0, 256))
        path.write_bytes(bytes(changed))
        outcome(path, read)
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < ROOM
    assert time.process_time() - begin < 30.0
