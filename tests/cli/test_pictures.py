"""Pictures of a run are drawn by two processes; each is there in the end, whatever became of the other process."""

import multiprocessing
import os
import signal
import sys
import time

import matplotlib.pyplot as plt
import pytest

from fricmb.cli import _files

by_two = pytest.mark.skipif(sys.platform != "linux" or (os.cpu_count() or 1) < 2, reason="drawn by one process here")


def picture():
    figure, ax = plt.subplots()
    ax.plot([0.0, 1.0])
    return figure


def noted(file):
    """A picture that takes its time, and tells which process drew it."""

    def draw():
        time.sleep(0.2)
        with file.open("a") as out:
            out.write(f"{os.getpid()}\n")
        return picture()

    return draw


@by_two
def test_two_processes_draw_each_picture_once(tmp_path):
    drawn = tmp_path / "drawn"
    _files._draw_by_two({tmp_path / f"{i}.png": noted(drawn) for i in range(6)})
    processes = drawn.read_text().split()
    assert len(processes) == 6
    assert len(set(processes)) == 2


@by_two
def test_what_the_other_process_did_not_draw_is_drawn_here(tmp_path):
    here, died = os.getpid(), tmp_path / "died"

    def only_here():
        if os.getpid() != here:
            died.touch()
            os._exit(3)
        time.sleep(0.2)
        return picture()

    pictures = {tmp_path / f"{i}.png": only_here for i in range(4)}
    _files._draw_by_two(pictures)
    assert died.exists()
    assert all(path.exists() for path in pictures)


def test_an_error_in_a_picture_is_told_once(tmp_path, capfd):
    def broken():
        raise ZeroDivisionError("no picture")

    with pytest.raises(ZeroDivisionError, match="no picture"):
        _files._draw_by_two({tmp_path / "a.png": broken, tmp_path / "b.png": noted(tmp_path / "drawn")})
    assert not (tmp_path / "a.png").exists()
    assert capfd.readouterr().err == ""
    assert not multiprocessing.active_children()


def test_without_a_second_process_all_are_drawn_here(tmp_path, monkeypatch):
    def refuse(method):
        raise OSError("no semaphores")

    monkeypatch.setattr("multiprocessing.context.BaseContext.Value", lambda *_: refuse(""))
    pictures = {tmp_path / f"{i}.png": picture for i in range(3)}
    _files._draw_by_two(pictures)
    assert all(path.exists() for path in pictures)


@by_two
def test_ctrl_c_does_not_reach_the_other_process(tmp_path, capfd):
    """All processes of a terminal get the signal; the one that waits tells of it and ends the other."""
    here = os.getpid()

    def struck():
        time.sleep(0.2)
        if os.getpid() != here:
            os.kill(os.getpid(), signal.SIGINT)
            (tmp_path / "struck").touch()
        return picture()

    _files._draw_by_two({tmp_path / f"{i}.png": struck for i in range(4)})
    assert (tmp_path / "struck").exists()
    assert capfd.readouterr().err == ""


@by_two
def test_ctrl_c_here_ends_the_other_process_too(tmp_path, capfd):
    here = os.getpid()

    def interrupted():
        if os.getpid() == here:
            raise KeyboardInterrupt
        time.sleep(60.0)

    with pytest.raises(KeyboardInterrupt):
        _files._draw_by_two({tmp_path / f"{i}.png": interrupted for i in range(3)})
    assert not multiprocessing.active_children()
    assert capfd.readouterr().err == ""


@by_two
def test_the_other_process_is_given_time_by_how_long_drawing_takes(tmp_path, monkeypatch):
    """What it was still drawing was thrown away and drawn again, where a picture took longer than one waited."""
    monkeypatch.setattr(_files, "PATIENCE", 0.0)
    monkeypatch.setattr(_files, "PATIENCE_EACH", 100.0)
    here, drawn = os.getpid(), tmp_path / "drawn"

    def slow():
        time.sleep(0.2 if os.getpid() == here else 0.7)
        with drawn.open("a") as out:
            out.write(f"{os.getpid()}\n")
        return picture()

    _files._draw_by_two({tmp_path / f"{i}.png": slow for i in range(4)})
    processes = drawn.read_text().split()
    assert len(processes) == 4
    assert len(set(processes)) == 2


@by_two
def test_it_is_told_how_many_pictures_are_there(tmp_path):
    told = []
    pictures = {tmp_path / f"{i}.png": noted(tmp_path / "drawn") for i in range(5)}
    _files._draw_by_two(pictures, lambda done, name: told.append((done, name)))
    counts = [done for done, _ in told]
    assert counts == sorted(counts)
    assert counts[0] == 0
    assert counts[-1] <= 5
    assert all(set(name.split(", ")) <= {path.name for path in pictures} for _, name in told if name)
