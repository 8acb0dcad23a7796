"""Pictures of a run are drawn by two processes; each is there in the end, whatever became of the other process."""

import multiprocessing
import os
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
