"""Runs that find no room in memory: each ends with an error that says what is needed, what there is and what to do."""

from __future__ import annotations

import gc
import os
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench.stability._structures import stiff_pair
from fricmb.integrate.collocation.one_contact import workspace
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.problem import Start
from fricmb.integrate.run import memory
from fricmb.system import build

resource = pytest.importorskip("resource")

SHORT = r"stopped at t = .*: memory: {method} has made \d+ steps and needs .* GB .*; .*on_chunk=.*'auto'"


@contextmanager
def limited(more):
    """Let this process take so many bytes more, and no others."""
    gc.collect()
    had = resource.getrlimit(resource.RLIMIT_AS)
    held = int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")
    resource.setrlimit(resource.RLIMIT_AS, (int(held + more), had[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, had)


def scarce(monkeypatch, left):
    monkeypatch.setattr(workspace, "_store", {})  # rows of an earlier run may be long already
    monkeypatch.setattr(memory, "FEW", 1e5)
    monkeypatch.setattr(memory, "available", lambda: left)


@pytest.mark.parametrize("method", ["collocation", "taylor"])
def test_rows_that_cannot_be_doubled_end_the_run(method, monkeypatch):
    whole = fm.simulate(stiff_pair(1e8), t_end=0.1, method=method)
    scarce(monkeypatch, 3e5)
    with pytest.raises(fm.IntegrationError, match=SHORT.format(method=method)) as caught:
        fm.simulate(stiff_pair(1e12), t_end=50.0, method=method)
    error = caught.value
    assert "0.0003 GB are left" in error.reason
    assert 0.0 < error.t < 50.0
    part = error.partial
    assert part.t[-1] == error.t
    # what is kept is the motion: both pairs follow one mass on the soft spring
    t = np.linspace(0.0, error.t, 20)
    np.testing.assert_allclose(part(t)[0], whole(t)[0], rtol=1e-6)


ADDRESSES = pytest.mark.skipif(not sys.platform.startswith("linux"), reason="limits of addresses")


@ADDRESSES
@pytest.mark.parametrize("stiffness", [1e12, 1e14])
@pytest.mark.parametrize("method", ["collocation", "taylor"])
def test_short_steps_end_at_a_limit_of_the_process(method, stiffness):
    """The system refuses what is asked for, whatever the run has counted on."""
    fm.simulate(stiff_pair(stiffness), t_end=1e-4, method=method)  # what is loaded once is there
    with limited(1e8), pytest.raises(fm.IntegrationError, match=SHORT.format(method=method)) as caught:
        fm.simulate(stiff_pair(stiffness), t_end=50.0, method=method)
    assert 0.0 < caught.value.t < 50.0


@ADDRESSES
@pytest.mark.parametrize("stiffness", [1e12, 1e14])
@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
def test_long_steps_do_with_little(method, stiffness):
    fm.simulate(stiff_pair(stiffness), t_end=1e-4, method=method)
    with limited(1e8):
        assert fm.simulate(stiff_pair(stiffness), t_end=50.0, method=method).t[-1] == 50.0


@ADDRESSES
def test_a_limit_of_the_process_counts():
    before = memory.available()
    with limited(1e8):
        assert memory.available() < 1.1e8 < before


def test_what_the_system_refuses_is_said(monkeypatch):
    """Also where nobody asks beforehand: here one array on the way to a result."""

    def refuse(*arguments, **options):
        np.empty((1 << 45,))

    monkeypatch.setattr("fricmb._simulate._keep._run", refuse)
    said = r"radau stopped: memory: the system gave no more: Unable .*on_chunk="
    with pytest.raises(fm.IntegrationError, match=said):
        fm.simulate(stiff_pair(1e8), t_end=1.0, method="radau")


def test_auto_does_by_radau_what_finds_no_room(monkeypatch):
    whole = fm.simulate(fm.models.brake4dof("2"), t_end=300.0, method="radau")
    scarce(monkeypatch, 2e5)
    sol = fm.simulate(fm.models.brake4dof("2"), t_end=300.0)
    assert sol.stats.method == "radau"
    assert "memory: collocation has made" in sol.stats.why
    np.testing.assert_array_equal(sol.q, whole.q)


@pytest.mark.parametrize("method", ["collocation", "taylor", "radau", "bdf"])
def test_a_run_that_may_keep_next_to_nothing_gets_somewhere(method):
    problem = build(stiff_pair(1e12)).problem
    start = Start(t=0.0, q=np.full(2, 2.7183), v=np.zeros(2), z=np.zeros(0))
    kind = fm.integrators[method]
    run = kind().integrate(problem, start, 1e-3, tolerance=Tolerance(rtol=1e-6), memory=1.0)
    assert run.failure is None or not kind.pauses
    assert run.end.t > 0.0
    if run.end.t < 1e-3:
        assert kind().integrate(problem, run.end, 1e-3, tolerance=Tolerance(rtol=1e-6), memory=1.0).end.t > run.end.t
