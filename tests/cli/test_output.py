"""What programs and shells meet: JSON that is JSON, closed and full outputs, files that are replaced together."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import fricmb as fm
from fricmb.cli import _files, main
from fricmb.cli._output import finite, replace_together

NOISY = """
import os
import subprocess
import sys

import fricmb as fm

print("a model that talks")
os.write(1, b"past Python\\n")
subprocess.run(["echo", "another process"])
block = fm.Body("block", mass=2.0, velocity={"x": 1.0})
scene = fm.Scene("noisy", [block, fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=4.0)])
t_end = 0.5
"""


def command(*arguments, **options):
    given = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, **options}
    return subprocess.run([sys.executable, "-m", "fricmb", *map(str, arguments)], **given)


@pytest.fixture
def noisy(tmp_path):
    path = tmp_path / "noisy.py"
    path.write_text(NOISY)
    return path


def test_json_is_json_whatever_a_model_prints(noisy, tmp_path):
    done = command("run", noisy, "--json", "--no-plots", "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["scene"] == "noisy"
    for line in ("a model that talks", "past Python", "another process"):
        assert line in done.stderr
    assert json.loads((tmp_path / "out" / "summary.json").read_text()) == json.loads(done.stdout)


def test_json_knows_no_nan():
    assert finite({"a": [1.0, float("nan")], "b": (float("inf"), 2)}) == {"a": [1.0, None], "b": [None, 2]}


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no /dev/full")
@pytest.mark.parametrize("arguments", [["list"], ["plan", "brake4dof"]])
def test_a_full_output_ends_with_one_line(arguments):
    with open("/dev/full", "w") as full:
        done = command(*arguments, stdout=full)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1, done.stderr
    assert "No space left on device" in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="needs a shell")
def test_a_closed_output_ends_with_one_line():
    text = f"'{sys.executable}' -m fricmb list >&-"
    done = subprocess.run(["sh", "-c", text], capture_output=True, text=True)
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1, done.stderr
    assert "standard output is closed" in done.stderr


def test_files_of_a_run_are_replaced_together_or_not_at_all(tmp_path, monkeypatch, capsys):
    arguments = ["run", "puck_on_belt", "--no-plots", "--out", str(tmp_path)]
    assert main([*arguments, "--t-end", "1"]) == 0
    (tmp_path / "own.txt").write_text("stays")
    (tmp_path / "energy.png").touch()
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def full(sol, path):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(_files, "write_events", full)
        assert main([*arguments, "--t-end", "2"]) == 2
    assert "No space left" in capsys.readouterr().err
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
    assert main([*arguments, "--t-end", "2"]) == 0
    assert fm.Solution.load(tmp_path / "solution.npz").t_end == 2.0
    assert np.loadtxt(tmp_path / "solution.csv", delimiter=",", skiprows=1)[-1, 0] == 2.0
    names = {"own.txt", "summary.json", "solution.npz", "solution.csv", "events.csv"}
    assert {path.name for path in tmp_path.iterdir()} == names


def test_what_was_moved_comes_back(tmp_path):
    (tmp_path / "a").write_text("old a")
    (tmp_path / "b").mkdir()  # what cannot be replaced by a file
    (tmp_path / "b" / "inside").touch()

    def write(new):
        (new / "a").write_text("new a")
        return ["a", "missing"]

    with pytest.raises(OSError, match="missing"):
        replace_together(tmp_path, write, ())
    assert (tmp_path / "a").read_text() == "old a"
    assert {path.name for path in tmp_path.iterdir()} == {"a", "b"}


def test_threads_are_set_before_libraries_look(noisy, tmp_path):
    noisy.write_text(NOISY + "print(os.environ['OMP_NUM_THREADS'], os.environ['NUMBA_NUM_THREADS'])\n")
    done = command("run", noisy, "--no-plots", "--threads", 1, "--out", tmp_path / "out")
    assert done.returncode == 0, done.stderr
    assert "1 1\n" in done.stdout
    assert command("run", noisy, "--threads", "none").returncode == 2


def test_a_quiet_run_prints_what_is_asked_for_alone(tmp_path):
    arguments = ("run", "puck_on_belt", "--no-plots", "--out", tmp_path, "--quiet")
    done = command(*arguments)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert (tmp_path / "solution.npz").exists()
    assert command(*arguments, "--audit").stdout.startswith("audit passes")


def test_quiet_says_nothing(monkeypatch, capsys):
    from fricmb.integrate.compile.cache_files import say

    monkeypatch.delenv("FRICMB_QUIET", raising=False)
    say("a notice")
    assert capsys.readouterr().err == "fricmb: a notice\n"
    monkeypatch.setenv("FRICMB_QUIET", "1")
    say("a notice")
    assert capsys.readouterr().err == ""


def test_colours_of_numba_leave_nothing_on_the_terminal(monkeypatch):
    """With colorama installed numba would write an escape sequence at the end of what compiles."""
    from fricmb.cli._main import _set_up, parser

    monkeypatch.setenv("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING", "")  # put back behind the test, set or not
    monkeypatch.delenv("NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING")
    _set_up(parser().parse_args(["list"]))
    assert os.environ["NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING"] == "1"


def test_an_out_that_can_be_no_folder_is_named(capsys, tmp_path):
    from fricmb.cli import main

    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        assert main(["run", "belt_oscillator", "--t-end", "1", "--out", str(out)]) == 2
        said = capsys.readouterr().err
        assert f"--out: got {str(out)!r}" in said
        assert "expected a folder" in said
