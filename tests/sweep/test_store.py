import pickle

import numpy as np
import pytest

from fricmb._sweep._store import Store
from fricmb.errors import SceneError


def test_a_result_is_kept_by_content(tmp_path):
    store = Store(tmp_path / "runs", ("scene", 1))
    assert store.get({"k": 1.0}) == (False, None)
    store.put({"k": 1.0}, np.arange(3))
    store.put({"k": 2.0}, None)
    there, result = Store(tmp_path / "runs", ("scene", 1)).get({"k": 1.0})
    assert there
    assert result.tolist() == [0, 1, 2]
    assert store.get({"k": 2.0}) == (True, None)
    assert Store(tmp_path / "runs", ("scene", 2)).get({"k": 1.0}) == (False, None)


def test_a_broken_file_counts_as_none_and_is_told(tmp_path, capsys):
    store = Store(tmp_path, ())
    store.put({}, [1, 2, 3])
    whole = store.file({}).read_bytes()
    flipped = bytearray(whole)
    flipped[-3] ^= 1
    for broken in (b"", whole[:-3], b"not a pickle", pickle.dumps(Harm(tmp_path / "harm")), bytes(flipped)):
        store.file({}).write_bytes(broken)
        capsys.readouterr()
        assert store.get({}) == (False, None)
        assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "harm").exists()


class Harm:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return open, (str(self.path), "w")


def test_a_full_disk_is_told_once(tmp_path, monkeypatch, capsys):
    def full(*args):
        raise OSError(28, "No space left on device")

    store = Store(tmp_path, ())
    monkeypatch.setattr("os.replace", full)
    store.put({"a": 1.0}, 1)
    store.put({"a": 2.0}, 1)
    assert capsys.readouterr().err.count("No space left") == 1
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_pickled_leaves_nothing_behind(tmp_path):
    store = Store(tmp_path, ())
    with pytest.raises((AttributeError, TypeError)):
        store.put({}, lambda: None)
    assert list(tmp_path.iterdir()) == []


def test_a_file_is_no_store(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(SceneError, match=r"store: got .*expected a folder"):
        Store(tmp_path / "file", ())
    with pytest.raises(SceneError, match=r"store: got .*cannot be made a folder: Not a directory"):
        Store(tmp_path / "file" / "runs", ())
    with pytest.raises(SceneError, match=r"store: got 3; expected a folder"):
        Store(3, ())
