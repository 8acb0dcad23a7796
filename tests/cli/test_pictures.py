"""Pictures of a run are drawn by two processes; each is there in the end, whatever became of the other process."""

import os

import matplotlib.pyplot as plt
import pytest

from fricmb.cli import _files


def picture():
    figure, ax = plt.subplots()
    ax.plot([0.0, 1.0])
    return figure


def only_in(process):
    """A picture that fails in every other process."""

    def draw():
        if os.getpid() != process:
            os._exit(3)
        return picture()

    return draw


def test_what_the_other_process_did_not_draw_is_drawn_here(tmp_path):
    pictures = {tmp_path / f"{i}.png": only_in(os.getpid()) for i in range(4)}
    _files._draw_by_two(pictures)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["0.png", "1.png", "2.png", "3.png"]


def test_both_draw_each_picture_once(tmp_path):
    drawn = tmp_path / "drawn"

    def draw():
        with drawn.open("a") as file:
            file.write(f"{os.getpid()}\n")
        return picture()

    _files._draw_by_two({tmp_path / f"{i}.png": draw for i in range(6)})
    assert len(drawn.read_text().split()) == 6


def test_an_error_in_a_picture_is_told(tmp_path):
    def broken():
        raise ZeroDivisionError("no picture")

    with pytest.raises(ZeroDivisionError, match="no picture"):
        _files._draw_by_two({tmp_path / "a.png": broken, tmp_path / "b.png": picture})
    assert not (tmp_path / "a.png").exists()
