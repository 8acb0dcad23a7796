"""Heads that announce more than the files hold: one sentence, before anything is asked for."""

import contextlib
import io
import logging
import re
import struct
import tracemalloc

import numpy as np
import pytest
import scipy.io.wavfile

import fricmb as fm
from fricmb._files import op4_fits
from fricmb.errors import FileError
from tests.fe.make_files import chain
from tests.fe.op2 import write_matrices
from tests.fe.test_fuzz import KINDS, T, Y, outcome, prepared

#: What a reader may ask for while it reads some kilobytes.
ROOM = 64 << 20
BINARY = [(what, name) for what, name in KINDS if name.endswith((".wav", ".tdms", ".npz", ".h5", ".mat", ".op2"))]
BINARY += [("fe", "binary.op4"), ("measure", "binary.uff"), ("fe", "matrices.op2")]


def made(what, name, folder):
    if name != "matrices.op2":
        return prepared(what, name, folder)[:2]
    pytest.importorskip("pyyeti")
    M, K = chain()
    write_matrices(folder / name, maa=M, kaa=K)
    return folder / name, lambda path: fm.fe.read(path).K.toarray()


@pytest.mark.parametrize(("what", "name"), BINARY)
def test_a_size_that_no_file_has_anywhere_in_a_head(what, name, tmp_path):
    path, read = made(what, name, tmp_path)
    data = path.read_bytes()
    logging.getLogger("nptdms").setLevel(logging.CRITICAL)
    tracemalloc.start()
    for at in range(0, min(len(data), 400) - 4, 2):
        size = 0x0FFF0000 if at % 4 else 0x7FFFFFF0
        path.write_bytes(data[:at] + struct.pack("<I", size) + data[at + 4 :])
        outcome(path, read)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < ROOM


def test_samples_that_are_not_there(tmp_path):
    path = tmp_path / "a.wav"
    scipy.io.wavfile.write(path, 8000, np.column_stack([Y, -Y]).astype(np.float32))
    assert len(fm.measure.read(path).signals) == 2
    data = path.read_bytes()
    at = data.index(b"data") + 4
    for size in (2_000_000_000, 0xFFFFFFFF):
        path.write_bytes(data[:at] + struct.pack("<I", size) + data[at + 4 :])
        words = f"its head announces {size} bytes of samples, the file has {len(data) - at - 4}; .* write it anew"
        with pytest.raises(FileError, match=rf"a\.wav: {words}"):
            fm.measure.read(path)
    path.write_bytes(data[:16] + struct.pack("<I", 2_000_000_000) + data[20:])
    with pytest.raises(FileError, match=r"part 'fmt ' announces 2000000000 bytes, the file has \d+ more"):
        fm.measure.read(path)


def test_a_long_sound_file_says_its_size_elsewhere(tmp_path):
    path = tmp_path / "a.wav"
    scipy.io.wavfile.write(path, 8000, Y)
    data = path.read_bytes()
    at = data.index(b"data")
    long = b"ds64" + struct.pack("<IQQQI", 28, len(data) + 28, Y.nbytes, Y.size, 0)
    path.write_bytes(b"RF64" + b"\xff" * 4 + b"WAVE" + long + data[12:at] + b"data" + b"\xff" * 4 + data[at + 8 :])
    np.testing.assert_array_equal(fm.measure.read(path).signals[0].y, Y)


def test_an_array_of_numpy_that_is_not_there(tmp_path):
    import zipfile

    path = tmp_path / "a.npz"
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (40000, 50000)})
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("force.npy", head.getvalue() + bytes(800))
    with pytest.raises(FileError, match=r"force\.npy: 40000 x 50000 numbers of 8 .* announced, it has 800 bytes"):
        fm.measure.read(path)


def test_a_dataset_that_was_never_written(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["time"], file["force"] = T, Y
        file.create_dataset("never", (1 << 26,), chunks=(1 << 16,), dtype=float)
    with pytest.raises(FileError, match=r"a\.h5: never: it announces 536870912 bytes, the file holds 0 of them"):
        fm.measure.read(tmp_path / "a.h5")


def test_a_recording_that_is_cut_off(tmp_path):
    path, read = prepared("measure", "a.tdms", tmp_path)[:2]
    data = path.read_bytes()
    assert read(path).size == Y.size
    path.write_bytes(data[:-1000])
    found = fm.measure.read(path)
    assert found.notes == ("the last piece of the recording is cut off",)
    np.testing.assert_array_equal(found.signals[0].y, Y[: found.signals[0].y.size])


@pytest.mark.parametrize("form", ["dense", "bigmat", "nonbigmat"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_every_kind_of_binary_output4_fits(form, order, tmp_path):
    with np.printoptions():  # pyyeti changes how arrays print
        op4 = pytest.importorskip("pyyeti.nastran.op4")
    M, K = chain()
    path = tmp_path / "a.op4"
    op4.write(str(path), {"maa": M, "kaa": K}, binary=True, sparse=form, endian=order)
    np.testing.assert_array_equal(fm.fe.read(path).K.toarray(), K)
    data = path.read_bytes()
    for at in range(0, len(data), 7):
        path.write_bytes(data[:at])
        with contextlib.suppress(FileError):
            op4_fits(path)
    path.write_bytes(data[:36] + struct.pack(order + "i", 7) + data[40:44] + struct.pack(order + "i", 999) + data[48:])
    with pytest.raises(FileError, match=re.escape("byte 32: column 7 announces 999 words, its record has ")):
        fm.fe.read(path)


@pytest.mark.parametrize("factor", [1.0, 1.0 + 0.05j])
def test_matrices_of_an_op2(factor, tmp_path):
    pytest.importorskip("pyyeti")
    M, K = chain()
    write_matrices(tmp_path / "a.op2", mxx=M, kxx=factor * K)
    found = fm.fe.read(tmp_path / "a.op2")
    np.testing.assert_array_equal(found.M.toarray(), M)
    np.testing.assert_allclose(found.K.toarray(), K)


def test_an_op2_says_what_it_lacks(tmp_path):
    pytest.importorskip("pyyeti")
    M, K = chain()
    path = tmp_path / "a.op2"
    write_matrices(path, mxx=M, kxx=K)
    data = path.read_bytes()
    trailer = struct.pack("<7i", 101, 9, 9, 2, 2, 0, 0)
    path.write_bytes(data.replace(trailer, struct.pack("<7i", 101, 2**30, 2**30, 2, 2, 0, 0)))
    with pytest.raises(FileError, match=r"a\.op2: matrix MXX: expected 1073741824 columns .*, got 9 columns"):
        fm.fe.read(path)
    for cut in (len(data) // 3, len(data) // 2, len(data) - 20):
        path.write_bytes(data[:cut])
        with pytest.raises(FileError, match=r"a\.op2: (byte \d+: |expected the end of its last block)"):
            fm.fe.read(path)
