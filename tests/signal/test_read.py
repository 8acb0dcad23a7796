"""fm.Signal.read: columns of files, and what is said of those that are not right."""

import numpy as np
import pytest
import scipy.io

import fricmb as fm
from fricmb.errors import FileError

T = np.linspace(0.0, 1.0, 101)
F = np.cos(7.0 * T)


def text(path, head, *, mark=",", comma=False, encoding="utf-8"):
    rows = [mark.join(f"{v:.10g}" for v in row) for row in zip(T, F, 2.0 * F, strict=True)]
    body = "\n".join([*head, *rows]) + "\n"
    path.write_text(body.replace(".", ",") if comma else body, encoding=encoding)
    return path


def test_columns_by_name(tmp_path):
    path = text(tmp_path / "run.csv", ["t,F,G"])
    signal = fm.Signal.read(path, time="t", value="F", units=(1e-3, 2.0))
    assert signal.t == pytest.approx(1e-3 * T)
    assert signal.y == pytest.approx(2.0 * F)
    assert signal.name == "F"
    with pytest.raises(FileError, match="expected one series, found F, G; say value="):
        fm.Signal.read(path)
    with pytest.raises(fm.FricmbError, match=r"unknown series of .*run.csv 'H'; "):
        fm.Signal.read(path, value="H")
    with pytest.raises(fm.FricmbError, match=r"unknown column of .*run.csv 'zeit'"):
        fm.Signal.read(path, time="zeit", value="F")


def test_marks_two_lines_of_names_and_decimal_commas(tmp_path):
    path = text(tmp_path / "a.csv", ["zeit;F;G", "s;N;N"], mark=";", comma=True, encoding="utf-8-sig")
    assert fm.Signal.read(path, value="F").y == pytest.approx(F)


def test_values_that_are_missing_are_named(tmp_path):
    path = tmp_path / "b.csv"
    path.write_text("t,F\n0.0,1.0\n0.1,nan\n0.2,1.0\n")
    with pytest.raises(fm.SceneError, match=r"Signal 'F': y holds nan at place 1 \(t = 0.1\)"):
        fm.Signal.read(path)
    path.write_text("t,F\n0.0,1.0\n0.1,\n0.2,1.0\n")
    with pytest.raises(FileError, match="line 3"):
        fm.Signal.read(path)
    path.write_text("t,F\n0.0,1.0\n0.1,2.0\n0.1,1.0\n")
    with pytest.raises(FileError, match="they do not rise at place 3"):
        fm.Signal.read(path)


def test_gaps_are_warned_of(tmp_path):
    path = tmp_path / "c.csv"
    path.write_text("t,F\n" + "\n".join(f"{t},{t}" for t in [0.0, 0.1, 0.2, 0.3, 1.3, 1.4]))
    with pytest.warns(UserWarning, match=r"F: 1 gap\(s\) in the times, the widest from 0.3 to 1.3"):
        fm.Signal.read(path)


def test_containers(tmp_path):
    np.savez(tmp_path / "a.npz", t=T, F=F)
    scipy.io.savemat(tmp_path / "a.mat", {"t": T, "F": F})
    for name in ("a.npz", "a.mat"):
        assert fm.Signal.read(tmp_path / name).y == pytest.approx(F)
    scipy.io.wavfile.write(tmp_path / "a.wav", 8000, (2.0**14 * F).astype(np.int16))
    sound = fm.Signal.read(tmp_path / "a.wav", units=2.0)
    assert sound.t == pytest.approx(np.arange(101) / 8000)
    assert sound.y == pytest.approx(F, abs=1e-4)


def test_hdf5(tmp_path):
    h5py = pytest.importorskip("h5py")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["t"], file["F"] = T, F
    assert fm.Signal.read(tmp_path / "a.h5").y == pytest.approx(F)
