"""Results that are kept: by content, in one file, as data where they are data; by several writers at once."""

import os
import pickle
import sqlite3
import subprocess
import sys

import numpy as np
import pytest

from fricmb._sweep import _store
from fricmb._sweep._plain import pack, unpack
from fricmb._sweep._store import Store
from fricmb.errors import SceneError

posix = pytest.mark.skipif(os.name == "nt", reason="owners and modes are asked on POSIX alone")


@pytest.fixture
def opened(tmp_path):
    """Opens stores in one folder; each that was opened before is closed first."""
    stores = []

    def again(shared=(), folder="runs"):
        for store in stores:
            store.close()
        stores.append(Store(tmp_path / folder, shared))
        return stores[-1]

    yield again
    for store in stores:
        store.close()


def test_a_result_is_kept_by_content(opened):
    store = opened(("scene", 1))
    assert store.get({"k": 1.0}) == (False, None)
    store.put({"k": 1.0}, np.arange(3))
    store.put({"k": 2.0}, None)
    assert store.get({"k": 2.0}) == (True, None)
    there, result = opened(("scene", 1)).get({"k": 1.0})
    assert there
    assert result.tolist() == [0, 1, 2]
    assert opened(("scene", 1)).get({"k": 2.0}) == (True, None)
    assert opened(("scene", 2)).get({"k": 1.0}) == (False, None)


class Held:
    """No plain data: kept as a pickle."""

    def __init__(self, path=None):
        self.path = path

    def __reduce__(self):
        return (Held, ()) if self.path is None else (open, (str(self.path), "w"))


def row(path, held=None, digest=None):
    """Read or overwrite the one result of a file."""
    with sqlite3.connect(path) as base:
        if held is not None:
            base.execute("UPDATE results SET held = ?", (held,))
        if digest is not None:
            base.execute("UPDATE results SET digest = ?", (digest,))
        return base.execute("SELECT form, held, digest FROM results").fetchone()


@pytest.mark.parametrize(("result", "form"), [([1, 2, 3], "plain"), (Held(), "pickle")])
def test_a_damaged_result_counts_as_none_and_is_told(opened, tmp_path, capsys, result, form):
    opened().put({}, result)
    store = opened()
    kind, whole, _ = row(store.file)
    assert kind == form
    flipped = bytearray(whole)
    flipped[-3] ^= 1
    for broken in (b"", whole[:-3], b"neither", pickle.dumps(Held(tmp_path / "harm")), bytes(flipped)):
        row(store.file, broken)
        capsys.readouterr()
        assert opened().get({}) == (False, None)
        assert capsys.readouterr().err.count("\n") == 1
    assert not (tmp_path / "harm").exists()
    row(store.file, whole)
    assert opened().get({})[0]


def test_a_file_that_is_no_store_is_put_aside(opened, capsys):
    opened().put({"k": 1.0}, 5)
    path = opened().file
    opened().close()
    for broken in (b"not a database, but longer than a header would be" * 100, path.read_bytes()[:3000] + b"x" * 9000):
        path.write_bytes(broken)
        store = opened()
        assert store.get({"k": 1.0}) == (False, None)
        assert "damaged" in capsys.readouterr().err
        store.put({"k": 1.0}, 5)
        assert opened().get({"k": 1.0}) == (True, 5)
        assert path.with_name("results.sqlite.damaged").read_bytes() == broken


def test_a_full_disk_is_told_once_and_what_came_in_is_kept_later(opened, monkeypatch, capsys):
    store = opened()
    base = store._base

    class Full:
        def __enter__(self):
            raise sqlite3.OperationalError("database or disk is full")

        def __exit__(self, *_):
            return False

    store._base = Full()
    for k in (1.0, 2.0):
        store.put({"k": k}, k)
        store.write()
    assert capsys.readouterr().err.count("disk is full") == 1
    store._base = base
    store.write()
    assert opened().get({"k": 1.0}) == (True, 1.0)


def test_what_cannot_be_pickled_leaves_nothing_behind(opened):
    store = opened()
    with pytest.raises((AttributeError, TypeError, pickle.PicklingError)):
        store.put({}, lambda: None)
    assert opened().get({}) == (False, None)


def test_a_file_is_no_store(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(SceneError, match=r"store: got .*expected a folder"):
        Store(tmp_path / "file", ())
    with pytest.raises(SceneError, match=r"store: got .*cannot be made a folder: Not a directory"):
        Store(tmp_path / "file" / "runs", ())
    with pytest.raises(SceneError, match=r"store: got 3; expected a folder"):
        Store(3, ())


def test_ten_thousand_numbers_take_less_than_a_hundred_bytes_each(opened):
    """A file a result took 4096: 40 MB for 10 000 numbers."""
    store = opened()
    for k in range(10_000):
        store.put({"k": float(k)}, k**0.5)
    store.close()
    assert sum(path.stat().st_size for path in store.path.iterdir()) < 100 * 10_000
    again = opened()
    assert [again.get({"k": float(k)}) for k in (0, 1234, 9999)] == [(True, k**0.5) for k in (0, 1234, 9999)]


def test_it_is_on_disk_soon_without_being_closed(opened, monkeypatch):
    """As when the process is killed: a second store sees what the first has not closed yet."""
    monkeypatch.setattr(_store, "_EVERY", 0.05)
    store = opened()
    store.put({"k": 1.0}, 7)
    store._timer.join()
    other = Store(store.path, ())
    assert other.get({"k": 1.0}) == (True, 7)
    other.close()


WRITER = """
import sys, time
from fricmb._sweep import _store
_store._EVERY = 0.01
store = _store.Store(sys.argv[1], ())
for k in range(200):
    store.put({"k": float(k), "who": float(sys.argv[2])}, k)
    time.sleep(0.002)
store.close()
"""


def test_several_may_write_at_once(opened, tmp_path):
    command = [sys.executable, "-c", WRITER, str(tmp_path / "runs")]
    writers = [subprocess.Popen([*command, f"{who}"], stderr=subprocess.PIPE, text=True) for who in range(3)]
    assert [writer.communicate(timeout=120)[1] for writer in writers] == ["", "", ""]
    store = opened()
    assert all(store.get({"k": float(k), "who": float(who)}) == (True, k) for who in range(3) for k in range(200))


PLAIN = [
    None, True, 3, -(10**30), 0.1, float("inf"), -0.0, "a \"word\" \u00e4\n", [], {}, (), 1 + 2j, [1, [2, (3.5, None)]],
    {"reach": 0.1, "events": 3, "t": np.linspace(0.0, 1.0, 5)}, {"": 1}, {1: 2}, np.float64(0.1), np.int32(3),
    np.bool_(True), np.zeros((0, 3)), np.arange(6).reshape(2, 3), np.asfortranarray(np.eye(3)), np.array(["a", "bc"]),
    np.array(1.5), [np.arange(2), {"x": np.arange(3.0), "y": (np.float32(1.5),)}],
]  # fmt: skip


@pytest.mark.parametrize("value", PLAIN, ids=lambda value: repr(value)[:40])
def test_data_come_back_as_they_were(value):
    packed = pack(value)
    if isinstance(value, dict) and (set(value) & {"", 1}):
        assert packed is None, "no plain data: a pickle"
        return
    again = unpack(packed)
    assert type(again) is type(value)
    assert pickle.dumps(_listed(again)) == pickle.dumps(_listed(value))


def _listed(value):
    """A value that can be compared, with the types that are in it."""
    if isinstance(value, np.ndarray):
        return "array", value.dtype.str, value.shape, value.tolist()
    if isinstance(value, np.generic):
        return "scalar", value.dtype.str, value.item()
    if isinstance(value, dict):
        return [(key, _listed(one)) for key, one in value.items()]
    return type(value).__name__, [_listed(one) for one in value] if isinstance(value, list | tuple) else repr(value)


def test_what_is_no_data_is_left_to_pickle():
    nan = unpack(pack(float("nan")))
    assert nan != nan
    for value in (Held(), [Held()], {"a": {1, 2}}, np.array([None]), np.ma.array([1]), b"bytes", lambda: None):
        assert pack(value) is None


@posix
def test_pickles_are_not_read_where_others_can_write(opened, tmp_path, capsys):
    store = opened()
    store.put({"k": 1.0}, Held())
    store.put({"k": 2.0}, 0.5)
    opened()
    for place in (tmp_path / "runs", store.file):
        mode = place.stat().st_mode
        place.chmod(0o777)
        capsys.readouterr()
        again = opened()
        assert again.get({"k": 1.0}) == (False, None)
        assert f"not used, since {place} can be written by everybody" in capsys.readouterr().err
        assert again.get({"k": 2.0}) == (True, 0.5), "numbers hold nothing to run"
        place.chmod(mode)
    assert isinstance(opened().get({"k": 1.0})[1], Held)
