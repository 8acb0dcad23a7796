"""What comes after a run has a bar of its own, which tells what is under way, gets full, and ends with Ctrl-C."""

import os
import sys

import pytest

from fricmb.cli import _run
from fricmb.cli._main import main

RUN = ("run", "friction_oscillator", "--t-end", "5")


def on_a_terminal(monkeypatch):
    """Let what stderr is within this test be a terminal."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)


def bar_of(err):
    """All states of the bar, in order."""
    return [part for part in err.replace("\n", "\r").split("\r") if part.startswith("results:")]


def test_it_names_each_piece_and_gets_full(capsys, monkeypatch, tmp_path):
    on_a_terminal(monkeypatch)
    assert main([*RUN, "--audit", "--out", str(tmp_path)]) == 0
    drawn = bar_of(capsys.readouterr().err)
    names = ["energies", "audit", "summary.json", "solution.npz", "solution.csv", "events.csv"]
    told = list(dict.fromkeys(state.rpartition("], ")[2].strip() for state in drawn if "], " in state))
    assert told[: len(names)] == names
    assert told[len(names)].endswith(".png")
    assert "100%" in drawn[-1]
    assert "11/11" in drawn[-1]


@pytest.mark.parametrize(("model", "pieces"), [("friction_oscillator", 5), ("car_axis", 5)])
def test_without_pictures_it_gets_full_too(capsys, monkeypatch, tmp_path, model, pieces):
    on_a_terminal(monkeypatch)
    assert main(["run", model, "--t-end", "0.1", "--no-plots", "--out", str(tmp_path)]) == 0
    assert f"{pieces}/{pieces}" in bar_of(capsys.readouterr().err)[-1]


def test_a_scene_without_contacts_has_fewer_pictures(capsys, monkeypatch, tmp_path):
    on_a_terminal(monkeypatch)
    assert main(["run", "car_axis", "--t-end", "0.1", "--out", str(tmp_path)]) == 0
    assert "8/8" in bar_of(capsys.readouterr().err)[-1]


@pytest.mark.parametrize("option", ["--quiet", "--json"])
def test_it_can_be_silenced(capsys, monkeypatch, tmp_path, option):
    monkeypatch.delenv("FRICMB_QUIET", raising=False)
    on_a_terminal(monkeypatch)
    assert main([*RUN, option, "--no-plots", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""
    assert "FRICMB_QUIET" not in os.environ, "a program that calls the command goes on with its own notices"


def test_it_is_for_terminals_alone(capsys, tmp_path):
    assert main([*RUN, "--no-plots", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == ""


def test_it_is_there_before_energies_are_integrated_and_ends_with_them(capsys, monkeypatch, tmp_path):
    on_a_terminal(monkeypatch)
    def interrupted(sol, failure):
        assert "energies" in bar_of(capsys.readouterr().err)[-1]
        raise KeyboardInterrupt

    monkeypatch.setattr(_run, "as_json", interrupted)
    assert main([*RUN, "--out", str(tmp_path)]) == 130
    *bar, last = capsys.readouterr().err.strip().split("\n")
    assert last == "fricmb: interrupted"
    assert len(bar) <= 1  # the bar as it stood
    assert not list(tmp_path.iterdir())


def test_ctrl_c_while_files_are_written_leaves_those_of_before(capsys, monkeypatch, tmp_path):
    on_a_terminal(monkeypatch)
    assert main([*RUN, "--no-plots", "--out", str(tmp_path)]) == 0
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def interrupted(sol, path, until):
        raise KeyboardInterrupt

    monkeypatch.setattr("fricmb.cli._files.write_csv", interrupted)
    assert main(["run", "friction_oscillator", "--t-end", "6", "--no-plots", "--out", str(tmp_path)]) == 130
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before
