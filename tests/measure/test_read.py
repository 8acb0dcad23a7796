"""Files of measurements that the tests write themselves; files that are cut or of something else."""

import sys

import numpy as np
import pytest
import scipy.io
import scipy.io.wavfile

import fricmb as fm
from fricmb.errors import FileError, MissingExtraError

T = np.arange(400) * 0.01
Y = np.sin(7.0 * T)


def one(path, **options):
    found = fm.measure.read(path, **options)
    (signal,) = found.signals
    return signal


@pytest.mark.parametrize(
    ("text", "name", "unit"),
    [
        ("time,force [N]\n{rows}", "force", "N"),
        ("# rig 3\n# brake\nTime [s];pad;\n{rows}", "pad", ""),
        ("{rows}", "column 2", ""),
        ("t\tx (mm)\n{rows}", "x", "mm"),
    ],
)
def test_text_in_columns(text, name, unit, tmp_path):
    mark = ";" if ";" in text else "\t" if "\t" in text else ","
    rows = "\n".join(f"{t:.6f}{mark}{y:.9e}" for t, y in zip(T, Y, strict=True))
    if mark == ";":  # as programs write it where a comma is the decimal point
        rows = "\n".join(line.replace(".", ",") + ";" for line in rows.splitlines())
    path = tmp_path / "run.csv"
    path.write_text(text.format(rows=rows))
    signal = one(path)
    np.testing.assert_allclose(signal.t, T, atol=1e-9)
    np.testing.assert_allclose(signal.y, Y, atol=1e-8)
    assert (signal.name, signal.unit) == (name, unit)


def test_complex_columns_are_frequency_responses(tmp_path):
    values = 1.0 / (1.0 - (np.arange(50) / 20.3) ** 2 + 0.02j)
    path = tmp_path / "frf.txt"
    path.write_text("\n".join(map(str, values)) + "\n")
    with pytest.raises(FileError, match=r"expected a column of times or frequencies.*give step="):
        fm.measure.read(path)
    (frf,) = fm.measure.read(path, step=0.5, start=10.0).frfs
    np.testing.assert_allclose(frf.f, 10.0 + 0.5 * np.arange(50))
    np.testing.assert_allclose(frf.values, values)


def test_sound(tmp_path):
    scipy.io.wavfile.write(tmp_path / "a.wav", 8000, np.round(16384 * np.column_stack([Y, -Y])).astype(np.int16))
    left, right = fm.measure.read(tmp_path / "a.wav").signals
    np.testing.assert_allclose(left.y, 0.5 * Y, atol=2e-5)
    np.testing.assert_allclose(right.y, -0.5 * Y, atol=2e-5)
    assert left.t[1] == 1 / 8000


@pytest.mark.parametrize("kind", ["npz", "mat", "h5"])
def test_containers(kind, tmp_path):
    path = tmp_path / f"a.{kind}"
    if kind == "npz":
        np.savez(path, time=T, force=Y)
    elif kind == "mat":
        scipy.io.savemat(path, {"time": T, "force": Y, "note": "rig"})
    else:
        h5py = pytest.importorskip("h5py")
        with h5py.File(path, "w") as file:
            file["time"], file["force"] = T, Y[:, None]
    signal = one(path)
    assert signal.name == "force"
    np.testing.assert_allclose(signal.y, Y)
    np.testing.assert_allclose(signal.t, T)


def test_labview(tmp_path):
    nptdms = pytest.importorskip("nptdms")
    path = tmp_path / "a.tdms"
    properties = {"wf_increment": 0.01, "wf_start_offset": 0.0, "unit_string": "N"}
    with nptdms.TdmsWriter(str(path)) as file:
        file.write_segment([nptdms.ChannelObject("rig", "force", Y, properties=properties)])
    signal = one(path)
    np.testing.assert_allclose(signal.y, Y)
    np.testing.assert_allclose(signal.t, T)
    assert (signal.name, signal.unit) == ("force", "N")


def universal(path, mass=0.5):
    """Points, one mode by each of two datasets, a driving point and a signal."""
    pyuff = pytest.importorskip("pyuff")
    file = pyuff.UFF(str(path))
    file.write_sets(
        pyuff.prepare_15(
            node_nums=[3, 8], def_cs=[0, 0], disp_cs=[0, 0], color=[8, 8], x=[0.0, 1.0], y=[0.0, 2.0], z=[0.0, 3.0]
        ),
        "add",
    )
    shape = {"r1": np.array([0.1, 0.2]), "r2": np.array([0.0, 0.0]), "r3": np.array([1.0, -2.0])}
    file.write_sets(
        pyuff.prepare_55(
            model_type=1, id1="NONE", id2="NONE", id3="NONE", id4="NONE", id5="NONE", analysis_type=2, data_ch=2,
            spec_data_type=8, data_type=2, n_data_per_node=3, load_case=1, mode_n=1, freq=12.5, modal_m=mass,
            modal_damp_vis=0.01, modal_damp_his=0.0, node_nums=[3, 8], **shape,
        ),
        "add",
    )  # fmt: skip
    common = {
        "binary": 0, "id1": "hammer", "rsp_node": 8, "ref_node": 8, "abscissa_spacing": 1, "abscissa_min": 0.0,
        "abscissa_spec_data_type": 18, "orddenom_spec_data_type": 13,
    }  # fmt: skip
    f = np.arange(1.0, 41.0)
    values = 1.0 / (12.5**2 - f**2 + 0.1j * f)
    file.write_sets(
        pyuff.prepare_58(func_type=4, rsp_dir=3, ref_dir=-3, x=f, data=values, ordinate_spec_data_type=12, **common),
        "add",
    )
    file.write_sets(
        pyuff.prepare_58(func_type=1, rsp_dir=1, ref_dir=0, x=T, data=Y, ordinate_spec_data_type=12, **common), "add"
    )
    return values


def test_universal_files(tmp_path):
    values = universal(tmp_path / "a.uff")
    found = fm.measure.read(tmp_path / "a.uff")
    np.testing.assert_allclose(found.points[8], [1, 2, 3])
    assert found.modes.hertz[0] == pytest.approx(12.5)
    assert found.modes.masses[0] == pytest.approx(0.5)
    assert found.modes.damping_ratios[0] == pytest.approx(0.01)
    np.testing.assert_allclose(found.modes.at(8)[:, 0], [0.2, 0.0, -2.0])
    (frf,) = found.frfs
    np.testing.assert_allclose(frf.values, values, rtol=1e-4)
    assert (frf.node, frf.axis, frf.reference, frf.reference_axis, frf.kind) == (8, "z", 8, "-z", "accelerance")
    assert frf.is_driving_point
    (signal,) = found.signals
    assert (signal.name, signal.axis) == ("hammer", "x")
    universal(tmp_path / "b.uff", mass=0.0)
    assert np.isnan(fm.measure.read(tmp_path / "b.uff").modes.masses[0])


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7])
@pytest.mark.parametrize("name", ["a.uff", "a.npz", "a.mat", "a.wav"])
def test_files_that_are_cut(name, share, tmp_path):
    path = tmp_path / name
    if name == "a.uff":
        universal(path)
    elif name == "a.npz":
        np.savez(path, time=T, force=Y)
    elif name == "a.mat":
        scipy.io.savemat(path, {"time": T, "force": Y})
    else:
        scipy.io.wavfile.write(path, 8000, Y)
    if name == "a.uff":  # in the middle of a dataset
        text = path.read_text().splitlines(keepends=True)
        path.write_text("".join(text[: int(share * 40)]))
    else:
        path.write_bytes(path.read_bytes()[: int(share * path.stat().st_size)])
    with pytest.raises(FileError, match=name.replace(".", r"\.")) as caught:
        fm.measure.read(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["a.uff", "a.csv", "a.npz", "a.mat", "a.wav", "a.h5", "a.tdms"])
@pytest.mark.parametrize("content", [b"\x00\xff\x7fELF" * 300, b"once upon a time\n" * 50, b""])
def test_files_of_something_else(name, content, tmp_path):
    for library, ending in (("pyuff", ".uff"), ("h5py", ".h5"), ("nptdms", ".tdms")):
        if name.endswith(ending):
            pytest.importorskip(library)
    (tmp_path / name).write_bytes(content)
    with pytest.raises(FileError) as caught:
        fm.measure.read(tmp_path / name)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,x\n0,1\n1,2\n2,\n", "line 4: expected a number in column 2, got ''"),
        ("t,x\n0,1\n1,2,3\n", "line 3: expected 2 columns, got 3"),
        ("t,x\n0,1\n1,2\n1,3\n", "t: expected rising values; they do not rise at place 3"),
        ("t,x\n0,1\n", "at least two lines"),
        ("a,b\n0,1\n1,2\n", "expected a column of times or frequencies among a, b"),
    ],
)
def test_the_record_is_named(text, words, tmp_path):
    (tmp_path / "a.csv").write_text(text)
    with pytest.raises(FileError, match=words):
        fm.measure.read(tmp_path / "a.csv")


def test_arguments_and_missing_libraries(tmp_path, monkeypatch):
    with pytest.raises(FileError, match="there is no such file"):
        fm.measure.read(tmp_path / "a.uff")
    (tmp_path / "a.uff").write_text("    -1\n")
    with pytest.raises(fm.SceneError, match="format must be one of uff"):
        fm.measure.read(tmp_path / "a.uff", format="ufo")
    with pytest.raises(fm.SceneError, match="step must be a number > 0"):
        fm.measure.read(tmp_path / "a.uff", step=-1.0)
    monkeypatch.setitem(sys.modules, "pyuff", None)
    with pytest.raises(MissingExtraError, match=r'pyuff: pip install "fricmb\[uff\]"'):
        fm.measure.read(tmp_path / "a.uff")


def test_a_name_over_two_columns_is_an_error(tmp_path):
    path = tmp_path / "twice.csv"
    path.write_text("time,F,F\n0,1,3\n1,2,4\n")
    with pytest.raises(FileError, match="another name for each column, found 'F' over columns 2 and 3"):
        fm.measure.read(path)
    path.write_text("time,F,,\n0,1,3,5\n1,2,4,6\n")
    assert [s.name for s in fm.measure.read(path).signals] == ["F", "column 3", "column 4"]


def test_universal_files_state_their_units(tmp_path):
    pyuff = pytest.importorskip("pyuff")
    values = universal(tmp_path / "a.uff")
    found = fm.measure.read(tmp_path / "a.uff")
    with pytest.raises(fm.SceneError, match="does not state its units"):
        found.in_units("SI")
    pyuff.UFF(str(tmp_path / "a.uff")).write_sets(
        pyuff.prepare_164(units_code=5, units_description="mm", temp_mode=1, length=1000.0, force=1000.0,
                          temp=1.0, temp_offset=273.15), "add",
    )  # fmt: skip
    si = fm.measure.read(tmp_path / "a.uff").in_units("SI")  # from mm, mN
    np.testing.assert_allclose(si.points[8], [1e-3, 2e-3, 3e-3])
    np.testing.assert_allclose(si.frfs[0].values, values, rtol=1e-4)  # mm/s2/mN is m/s2/N
    np.testing.assert_allclose(si.signals[0].y, 1e-3 * found.signals[0].y)
    assert si.signals[0].quantity == "acceleration"
    np.testing.assert_allclose(si.modes.masses, found.modes.masses)  # mN s2/mm is kg
    tonnes = si.in_units("t-mm-s")
    np.testing.assert_allclose(tonnes.modes.masses, 1e-3 * si.modes.masses)
    np.testing.assert_allclose(tonnes.frfs[0].values, 1e3 * si.frfs[0].values)  # mm/s2/N
    np.testing.assert_allclose(tonnes.in_units("SI").points[8], si.points[8])
    with pytest.raises(fm.SceneError, match="must have seconds"):
        si.in_units("kg-m-ms")


def test_packed_files(tmp_path):
    import gzip

    universal(tmp_path / "a.uff")
    (tmp_path / "a.uff.gz").write_bytes(gzip.compress((tmp_path / "a.uff").read_bytes()))
    assert fm.measure.read(tmp_path / "a.uff.gz").modes.hertz[0] == pytest.approx(12.5)
    (tmp_path / "a.uff.gz").write_bytes((tmp_path / "a.uff.gz").read_bytes()[:200])
    with pytest.raises(FileError, match=r"a\.uff\.gz: expected a whole packed file"):
        fm.measure.read(tmp_path / "a.uff.gz")
