import json
import pickle

import numpy as np
import pytest

from fricmb.errors import FricmbError
from fricmb.solution import Solution
from fricmb.solution._stored import Stored


def test_a_file_is_read_by_numpy_alone(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    with np.load(tmp_path / "run.npz", allow_pickle=False) as data:
        arrays = dict(data)
    assert all(a.dtype != object for a in arrays.values())
    np.testing.assert_array_equal(arrays["q"], sol.q)
    assert arrays["dof_names"].tolist() == ["mass.x"]
    np.testing.assert_array_equal(arrays["event_t"], sol.events.t)
    assert arrays["event_kind"].tolist() == [e.kind for e in sol.events]
    np.testing.assert_array_equal(arrays["residual"], sol.energy.residual)


@pytest.mark.parametrize("times", [None, np.linspace(0.0, 20.0, 7)])
def test_a_loaded_solution_is_the_same(make, tmp_path, times):
    sol = make(times=times)
    sol.save(tmp_path / "run")
    back = Solution.load(tmp_path / "run")
    for name in ("t", "q", "v"):
        np.testing.assert_array_equal(getattr(back, name), getattr(sol, name))
    for what in ("force", "relative_velocity", "normal_force", "mode", "state"):
        np.testing.assert_array_equal(getattr(back, what)("floor"), getattr(sol, what)("floor"))
    assert back.events == sol.events
    assert back.stats == sol.stats
    assert (back.t_start, back.t_end) == (0.0, 20.0)
    np.testing.assert_array_equal(back.energy.residual, sol.energy.residual)
    np.testing.assert_array_equal(back["mass.tip.x"], sol["mass.tip.x"])
    assert isinstance(back._run, Stored), "the run is opened only when it is needed"
    np.testing.assert_array_equal(back(1.5), sol(1.5))
    assert back.scene == "a scene"


def test_a_scene_that_is_no_data_loses_the_dense_output_alone(make, tmp_path):
    sol = make()
    object.__setattr__(sol.run.pieces[0].origin, "scene", lambda: None)
    with pytest.warns(UserWarning, match="neither scene nor dense output"):
        sol.save(tmp_path / "run.npz")
    back = Solution.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(back.q, sol.q)
    with pytest.raises(FricmbError, match="function is no data"):
        back(1.0)


def test_a_foreign_file_is_refused(tmp_path):
    np.savez(tmp_path / "other.npz", x=np.zeros(3))
    with pytest.raises(FricmbError, match="no solution"):
        Solution.load(tmp_path / "other.npz")


def test_a_save_that_fails_leaves_nothing_behind(make, tmp_path, monkeypatch):
    def fail(*args, **kwargs):
        raise OSError("disk full")

    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(OSError, match="disk full"):
        make().save(tmp_path / "run.npz")
    assert list(tmp_path.iterdir()) == []


def test_a_file_has_the_permissions_of_any_other(sol, tmp_path):
    sol.save(tmp_path / "run.npz")
    (tmp_path / "other").touch()
    assert (tmp_path / "run.npz").stat().st_mode == (tmp_path / "other").stat().st_mode
    assert sorted(path.name for path in tmp_path.iterdir()) == ["other", "run.npz"]


def rewritten(path, **changes):
    """The file with other entries, made as a program with numpy alone would."""
    with np.load(path, allow_pickle=False) as data:
        entries = {**data, **changes}
    np.savez(path, **{name: value for name, value in entries.items() if value is not None})


def refused(path, text):
    with pytest.raises(FricmbError, match=text) as caught:
        Solution.load(path)
    assert str(path) in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"t": np.full(46, np.nan)}, "entry 't'"),
        ({"q": np.zeros((1, 3))}, "entry 'q'"),
        ({"mode": np.full((1, 46), 7, np.int8)}, "entry 'mode'"),
        ({"event_t": np.zeros(2)}, "entry 'event_"),
        ({"kinetic": None}, "no entry 'kinetic'"),
        ({"about": np.array("{")}, "entry 'about' is damaged"),
        ({"more": np.zeros(3)}, "entry 'more'"),
        ({"run": np.zeros(3, np.uint8)}, "entry 'run'"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_files_that_are_inconsistent_are_refused_by_entry(sol, tmp_path, changes, text):
    path = tmp_path / "run.npz"
    sol.save(path)
    rewritten(path, **changes)
    refused(path, text)


def test_a_change_that_fits_is_seen_by_its_digest(sol, tmp_path):
    path = tmp_path / "run.npz"
    sol.save(path)
    rewritten(path, q=1.0001 * sol.q)
    refused(path, "entry 'q' is not what was written")


@pytest.mark.parametrize("n", [0, 1, 100, 3000, -1])
def test_a_file_that_is_cut_off_is_refused(sol, tmp_path, n):
    path = tmp_path / "run.npz"
    sol.save(path)
    path.write_bytes(path.read_bytes()[:n])
    refused(path, "is empty" if n == 0 else "is damaged|no npz")


def test_no_file_and_a_folder_are_refused(tmp_path):
    refused(tmp_path / "none.npz", "there is no file")
    refused(tmp_path, "there is no file")


@pytest.mark.parametrize("path", [None, 3, b"run.npz", "a\0b"])
def test_what_is_no_path_is_said(sol, path):
    for use in (sol.save, Solution.load):
        with pytest.raises(FricmbError, match=r"path: got .*; expected the path of a file"):
            use(path)


def test_a_path_that_cannot_be_written_is_said(sol, tmp_path):
    (tmp_path / "file").write_text("")
    for path, said in (("", "folder"), (tmp_path, "folder"), (tmp_path / "none" / "run.npz", "No such file"),
                       (tmp_path / "file" / "run.npz", "Not a directory")):  # fmt: skip
        with pytest.raises(FricmbError, match=said) as error:
            sol.save(path)
        assert str(path) in str(error.value)


class Harm:
    """Makes a file when it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return open, (str(self.path), "w")


def test_a_file_of_format_1_gives_its_arrays_and_no_scene(sol, tmp_path):
    path = tmp_path / "run.npz"
    sol.save(path)
    with np.load(path) as data:
        about = json.loads(str(data["about"]))
    run = np.frombuffer(pickle.dumps(Harm(tmp_path / "harm")), np.uint8)
    rewritten(path, about=np.array(json.dumps({**about, "format": 1})), run=run, digest=None)
    back = Solution.load(path)
    np.testing.assert_array_equal(back.q, sol.q)
    assert back.events == sol.events
    for ask in (lambda: back.scene, lambda: back(1.0)):
        with pytest.raises(FricmbError, match=r"format is 1, where the scene was a pickle.*simulate again"):
            ask()
    assert not (tmp_path / "harm").exists()
    rewritten(path, about=np.array(json.dumps({**about, "format": 3, "fricmb": "9.9"})))
    refused(path, r"later fricmb \(9.9\)")
