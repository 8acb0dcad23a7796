"""Files that are not what their names say: empty, of another kind, pictures, text, objects that run when unpickled."""

import pickle
import re
import tracemalloc

import numpy as np
import pytest
import scipy.io

import fricmb as fm
from fricmb.errors import FileError
from tests.fe.test_fuzz import KINDS, MATRICES, outcome, prepared

#: What a reader may ask for beyond what it is given: as much as an empty file costs, and some.
ROOM = 64 << 20


def others():
    rng = np.random.default_rng(3)
    return {
        "empty": b"",
        "one byte": b"\n",
        "zeros": bytes(4096),
        "ones": b"\xff" * 4096,
        "noise": rng.integers(0, 256, 4096, dtype=np.uint8).tobytes(),
        "picture": b"\x89PNG\r\n\x1a\n" + bytes(64),
        "letter": "Grüße, the file you asked for is at home.\n".encode() * 40,
        "utf-16": "1, 2, 3\n".encode("utf-16") * 40,
        "page": b"<!DOCTYPE html>\n<html><body>404 Not Found</body></html>\n",
        "one line": b"1" * 400_000,
        "minus": b"-1\n" * 400,
        "numbers of 400 digits": b"9" * 400 + b" " + b"9" * 400 + b"\n",
        "infinite": b"nan inf -inf 1e999\n" * 20,
        "pointer": b"version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12\n",
    }


@pytest.mark.parametrize(("what", "name"), KINDS)
def test_what_is_no_such_file(what, name, tmp_path):
    path, read, _ = prepared(what, name, tmp_path)
    tracemalloc.start()
    for content in others().values():
        path.write_bytes(content)
        assert outcome(path, read) is None
    _, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert most < ROOM


@pytest.mark.parametrize(("what", "name"), KINDS)
def test_files_of_other_kinds(what, name, tmp_path):
    """Each of the others under this name: refused, or read as what it is."""
    path, read, _ = prepared(what, name, tmp_path)
    for i, (other, its_name) in enumerate(KINDS):
        if its_name == name:
            continue
        folder = tmp_path / str(i)
        folder.mkdir()
        content = prepared(other, its_name, folder)[0].read_bytes()
        path.write_bytes(content)
        found = outcome(path, read)
        alike = {path.suffix, (folder / its_name).suffix} <= {".mat", ".h5"}  # a MAT-file of version 7.3 is HDF5
        alike = alike or path.suffix == (folder / its_name).suffix
        assert found is None or alike, f"{its_name} was read as {name}"


class Bomb:
    """What unpickles it writes a file."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return (open, (self.mark, "w"))


def test_a_bomb_goes_off_elsewhere(tmp_path):
    mark = tmp_path / "gone_off"
    pickle.loads(pickle.dumps(Bomb(str(mark)))).close()
    assert mark.exists()


@pytest.mark.parametrize("kind", ["npz", "npy", "mat", "bare"])
@pytest.mark.parametrize("read", [fm.fe.read, fm.measure.read])
def test_nothing_is_executed(read, kind, tmp_path):
    mark = tmp_path / "gone_off"
    bombs = np.array([Bomb(str(mark))] * 4, dtype=object).reshape(2, 2)
    path = tmp_path / f"a.{'npz' if kind == 'bare' else kind}"
    if kind == "npz":
        np.savez(path, M=bombs, K=bombs, time=bombs, force=bombs)
    elif kind == "npy":
        np.save(path, bombs, allow_pickle=True)
    elif kind == "mat":
        scipy.io.savemat(path, {"M": np.eye(2), "K": np.frombuffer(pickle.dumps(bombs), np.uint8)})
    else:
        path.write_bytes(pickle.dumps(bombs))
    with pytest.raises(FileError, match=r"a\.np|a\.mat"):
        read(path)
    assert not mark.exists()


@pytest.mark.parametrize("name", MATRICES)
def test_a_folder_under_its_name(name, tmp_path):
    path, read, _ = prepared("fe", name, tmp_path)
    path.unlink()
    path.mkdir()
    assert outcome(path, read) is None


@pytest.mark.parametrize(("what", "name"), KINDS)
def test_a_file_that_is_not_there(what, name, tmp_path):
    path, read, _ = prepared(what, name, tmp_path)
    path.unlink()
    with pytest.raises(FileError, match=path.name.partition(".")[0]):
        read(path)


SIZES = ["1000000 1000000 4000000000000", "99999999999 99999999999 1", "1000000000 1000000000 1"]


@pytest.mark.parametrize("sizes", SIZES)
def test_sizes_that_no_matrix_has(sizes, tmp_path):
    path = tmp_path / "k.mtx"
    path.write_text(f"%%MatrixMarket matrix coordinate real general\n{sizes}\n1 1 1.0\n")
    tracemalloc.start()
    with pytest.raises(FileError, match=r"k\.mtx: .*expected (\d+ lines|3 sizes, rows from 1 to \d+)"):
        fm.fe.read({"M": path, "K": path})
    assert tracemalloc.get_traced_memory()[1] < ROOM
    tracemalloc.stop()


@pytest.mark.parametrize("name", ["strip.sti.gz", "a.csv.gz"])
def test_a_packed_file_that_grows_a_thousandfold(name, monkeypatch, tmp_path):
    import gzip

    from fricmb._files import _text

    monkeypatch.setattr(_text, "FREE", 1 << 20)
    read = fm.measure.read if name.startswith("a") else fm.fe.read
    path = prepared("fe", name, tmp_path)[0] if name.startswith("strip") else tmp_path / name
    path.write_bytes(gzip.compress(b"1.0 2.0\n" * (6 << 20)))
    tracemalloc.start()
    with pytest.raises(FileError, match=rf"{re.escape(name)}: expected at most \d+ MB in this packed file"):
        read(path)
    assert tracemalloc.get_traced_memory()[1] < ROOM
    tracemalloc.stop()


def test_a_function_of_fewer_values_than_it_announces(tmp_path):
    path = prepared("measure", "a.uff", tmp_path)[0]
    text = path.read_text()
    assert text.count("       200") == 1
    path.write_text(text.replace("       200", "1999999999"))
    with pytest.raises(FileError, match=r"a\.uff: function 1: it announces 1999999999 values, got 200"):
        fm.measure.read(path)


def test_a_function_with_a_line_taken_out(tmp_path):
    path = prepared("measure", "a.uff", tmp_path)[0]
    lines = path.read_text().splitlines(keepends=True)
    del lines[20]
    path.write_text("".join(lines))
    with pytest.raises(FileError, match=r"announces 200 values, got 19[0-9]"):
        fm.measure.read(path)
