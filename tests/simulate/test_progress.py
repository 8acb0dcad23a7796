"""Bars move while kernels work, and on terminals of any size."""

import os
from contextlib import contextmanager

import numpy as np
import pytest

import fricmb as fm
from fricmb._simulate import _progress
from tests.ticking import ticking


@pytest.mark.parametrize("method", ["bdf", "radau"])
def test_kernels_tell_how_far_they_are(method, monkeypatch):
    """Also before their space for rows is full, and the run is the same."""
    scene, told = fm.models.stick_slip_chain(n=4), []
    alone = fm.simulate(scene, t_end=8.0, method=method)

    @contextmanager
    def record(shown, t_start, t_end):
        yield told.append

    monkeypatch.setattr(_progress, "progress_bar", record)
    with ticking():
        seen = fm.simulate(scene, t_end=8.0, method=method)
    assert len(set(told)) > 5
    assert max(told) <= 8.0 * (1 + 1e-12)
    np.testing.assert_array_equal(seen.q, alone.q)


def test_a_mechanism_tells_too(monkeypatch):
    told = []

    @contextmanager
    def record(shown, t_start, t_end):
        yield told.append

    monkeypatch.setattr(_progress, "progress_bar", record)
    with ticking():
        fm.simulate(fm.models.dry_pendulum(), t_end=4.0)
    assert len(set(told)) > 5


@pytest.mark.parametrize(("size", "given"), [((0, 0), (80, 24)), ((100, 0), (100, 24)), ((100, 30), None)])
def test_a_bar_is_drawn_on_a_terminal_without_size(size, given, monkeypatch, capfd):
    monkeypatch.setattr(os, "get_terminal_size", lambda *_: os.terminal_size(size))
    found = _progress.bar_options()
    assert (found.get("ncols"), found.get("nrows")) == (given or (None, None))
    with _progress.progress_bar(True, 0.0, 1.0):
        pass
    assert "100%" in capfd.readouterr().err


def test_a_run_that_turns_slow_is_drawn_again(capsys, monkeypatch):
    now = [1.0]
    monkeypatch.setattr("time.time", lambda: now[0])
    monkeypatch.setattr("tqdm.std.time", lambda: now[0])
    with _progress.progress_bar(True, 0.0, 100.0) as forward:
        for t in (1.0, 40.0, 80.0, 80.5, 81.0):
            now[0] += 1.0
            forward(t)
        assert "t = 81 of" in capsys.readouterr().err
