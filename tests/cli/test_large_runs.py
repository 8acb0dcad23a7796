"""Runs that are large or late: what is written of them, what is asked before, what the end of a job leaves."""

import json
import signal
import subprocess
import sys
import time

import pytest

import fricmb as fm
from fricmb.cli import _files, _run, main

RUN = ["run", "friction_oscillator", "--t-end", "5"]


def names(folder):
    return {path.name for path in folder.iterdir()}


def test_the_time_limit_covers_what_is_written(monkeypatch, tmp_path, capsys):
    """Run and energies are there; the table and the pictures are not begun, or not finished, once it is too late."""
    monkeypatch.setattr(_run, "LEAST", -60.0)
    monkeypatch.setattr(_run, "LONGER", -10.0)
    assert main([*RUN, "--time-limit", "30", "--out", str(tmp_path)]) == 0
    assert names(tmp_path) == {"summary.json", "solution.npz", "events.csv"}
    assert "were not written in time" in capsys.readouterr().err
    assert fm.Solution.load(tmp_path / "solution.npz").t_end == 5.0


def test_a_table_that_is_late_is_left_out_and_that_of_before_goes(monkeypatch, tmp_path):
    sol = fm.simulate(fm.models.friction_oscillator(), t_end=5.0)
    _files.write_all(sol, tmp_path, "{}", plots=None)
    assert "solution.csv" in names(tmp_path)
    late = time.monotonic() - 1.0
    written = _files.write_all(sol, tmp_path, "{}", plots="png", until=late)
    assert written == ["summary.json", "solution.npz", "events.csv"]
    assert names(tmp_path) == {"summary.json", "solution.npz", "events.csv"}


def test_pictures_that_are_late_are_left_out(tmp_path):

    def slow():
        from matplotlib.figure import Figure

        time.sleep(0.2)
        return Figure()

    pictures = {tmp_path / f"{i}.png": slow for i in range(50)}
    _files._draw_by_two(pictures, until=time.monotonic() + 2.0)
    assert len(names(tmp_path)) < 50


@pytest.mark.parametrize(("answer", "written"), [("y\n", True), ("n\n", False), ("\n", False), ("", False)])
def test_a_run_of_gigabytes_is_asked_for_on_a_terminal(monkeypatch, tmp_path, capsys, answer, written):
    class Terminal:
        def isatty(self):
            return True

        def readline(self):
            return answer

    monkeypatch.setattr(_run, "LARGE", 1.0)
    monkeypatch.setattr(sys, "stdin", Terminal())
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    assert main([*RUN, "--no-plots", "--out", str(tmp_path)]) == 0
    assert ({"solution.npz", "solution.csv"} <= names(tmp_path)) == written
    assert {"summary.json", "events.csv"} <= names(tmp_path)
    assert "Write them? [y/N]" in capsys.readouterr().err


@pytest.mark.parametrize("asked", [[], ["--yes"]])
def test_elsewhere_the_run_is_kept_and_its_table_only_if_it_was_asked_for(monkeypatch, tmp_path, capsys, asked):
    monkeypatch.setattr(_run, "LARGE", 1.0)
    assert main([*RUN, "--no-plots", "--json", *asked, "--out", str(tmp_path)]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out)["scene"]
    assert ("solution.csv" in names(tmp_path)) == bool(asked)
    assert "solution.npz" in names(tmp_path)
    assert ("left out: solution.csv of about" in err) == (not asked)


def test_what_is_said_of_sizes_is_about_right(tmp_path):
    sol = fm.simulate(fm.models.brake4dof(), t_end=30.0)
    _files.write_all(sol, tmp_path, "{}", plots=None)
    assert (tmp_path / "solution.csv").stat().st_size == pytest.approx(_files.sizes(sol)["solution.csv"], rel=0.3)


@pytest.mark.skipif(sys.platform == "win32", reason="signals as POSIX has them")
@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGHUP])
def test_the_end_of_a_job_keeps_what_was_computed(tmp_path, how):
    command = [sys.executable, "-c", ENDED, str(tmp_path), str(int(how))]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 130, done.stderr
    assert "what was computed until then is in" in done.stderr
    assert 0.0 < fm.Solution.load(tmp_path / "solution.npz").t_end < 1e9


ENDED = """
import os, pathlib, signal, sys, threading, time
signal.signal(signal.SIGHUP, signal.SIG_DFL)  # what is started by nohup is told to ignore it
import fricmb as fm
from fricmb.cli import main
folder = pathlib.Path(sys.argv[1])
scene = folder / "scene.py"
scene.write_text("from tests.simulate.test_ended import endless; scene = endless()")
def end():
    time.sleep(1.0)
    os.kill(os.getpid(), int(sys.argv[2]))
simulate = fm.simulate
def begun(scene, **given):
    simulate(scene, **{**given, "t_end": 1.0, "t_eval": None})  # all is compiled and loaded
    threading.Thread(target=end).start()
    return simulate(scene, **given)
fm.simulate = begun
arguments = ["--t-end", "1e9", "--method", "radau", "--no-plots", "--quiet", "--points", "1000"]
sys.exit(main(["run", str(scene), *arguments, "--out", sys.argv[1]]))
"""
