"""Sweeps in threads: the results of one process, nothing sent anywhere, and Ctrl-C as with processes."""

import re
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass

import numpy as np
import pytest

import fricmb as fm
from tests.sweep.test_sweep import RUNS, swinging

QUIET = {"progress": False, "workers": "threads"}


def test_results_are_those_of_one_process():
    brake = fm.models.brake4dof(case=2)
    runs = [{"k1x.stiffness": k} for k in np.linspace(0.9, 1.1, 7)] + [{"lining.normal_force": 1.1}, {}]
    given = {"t_end": 80.0, "progress": False}
    threads, one = fm.sweep(brake, runs, workers="threads", **given), fm.sweep(brake, runs, workers=1, **given)
    for sol, other, run in zip(threads, one, runs, strict=True):
        np.testing.assert_array_equal(sol.q, other.q)
        assert [event.t for event in sol.events] == [event.t for event in other.events]
        assert all(sol.scene.parameters[name] == value for name, value in run.items())


def test_nothing_is_sent():
    @dataclass(frozen=True, kw_only=True)
    class Local(fm.FrictionLaw):
        mu: float

        def define_coefficient(self, r):
            return self.mu / (1 + r)

    lock, seen = threading.Lock(), []

    def reduce(sol):
        with lock:
            seen.append(sol)
        return lock

    parts = [*swinging().parts, fm.Contact("floor", swinging()["mass"], law=Local(mu=0.1), normal_force=1.0)]
    found = fm.sweep(fm.Scene("local", parts), RUNS, t_end=1.0, reduce=reduce, **QUIET)
    assert found == [lock] * len(RUNS)
    assert len(seen) == len(RUNS)


def test_an_error_of_reduce_costs_its_run_alone():
    before = threading.active_count()

    def reduce(sol):
        if sol.scene.parameters["spring.stiffness"] == 4.0:
            raise ValueError("none of these")
        return sol["mass.x"][-1]

    found = fm.sweep(swinging(), RUNS, t_end=2.0, reduce=reduce, **QUIET)
    assert found.failed == (1,)
    assert "none of these" in found[1].reason
    assert threading.active_count() == before


def test_threads_cannot_be_ended_by_a_limit_of_processes():
    with pytest.raises(fm.SceneError, match="run_limit: only processes"):
        fm.sweep(swinging(), RUNS, t_end=2.0, run_limit=1.0, **QUIET)
    limited = fm.sweep(swinging(), RUNS[:2], t_end=1e9, time_limit=0.2, method="radau", **QUIET)
    assert ["time limit" in error.reason for error in limited] == [True, True]


INTERRUPTED = """
import signal, sys, threading, time
import fricmb as fm
from tests.simulate.test_ended import endless
signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background may be told to ignore it
scene, far = endless(), float(sys.argv[1])
fm.simulate(scene, t_end=1.0, method="radau")
print("ready", flush=True)
runs = [{"spring.stiffness": 1.0 + 1e-3 * i} for i in range(2000)]
made = []
def reduce(sol):
    made.append(sol)
    if len(made) == 3:
        print("going", flush=True)
    return sol.t[-1]
def tell():
    while threading.active_count() < 4:  # this thread, the main one and two that run
        time.sleep(0.05)
    time.sleep(0.5)
    print("going", flush=True)
if far > 1e6:
    threading.Thread(target=tell).start()
try:
    fm.sweep(scene, runs, t_end=far, method="radau", reduce=reduce, workers="threads", progress=False)
except KeyboardInterrupt as stop:
    done = [result for result in stop.results if result is not None]
    assert len(done) == len(made) < 1900, (len(done), len(made))
    assert threading.active_count() <= 2
    print("kept", len(done), flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals as POSIX has them")
@pytest.mark.parametrize(("far", "signals"), [(20.0, 1), (1e9, 2)])
def test_ctrl_c_waits_for_runs_and_a_second_one_ends_them(far, signals):
    command = [sys.executable, "-c", INTERRUPTED, str(far)]
    pipe = subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True) as process:
        assert [process.stdout.readline(), process.stdout.readline()] == ["ready\n", "going\n"]
        process.send_signal(signal.SIGINT)
        if signals == 2:
            assert any(re.search(r"waiting for \d+ runs under way", line) for line in process.stderr)
            process.send_signal(signal.SIGINT)
        out, said = process.communicate(timeout=60)
    assert process.returncode == 0, said
    assert out.startswith("kept ")
    assert "Traceback" not in said
    assert f"{out.split()[1]} of 2000 runs are done" in said


AT_ANY_TIME = """
import os, signal, threading, time
from fricmb._sweep._threads import run_in_threads
signal.signal(signal.SIGINT, signal.default_int_handler)
runs = {i: {"i": i} for i in range(20_000)}
for k in range(60):
    begun, results = [], []
    def run(parameters):
        begun.append(parameters["i"])
        time.sleep(2e-5)
        return parameters["i"]
    def interrupt():
        while not begun:
            time.sleep(1e-5)
        time.sleep(2e-5 * k)
        os.kill(os.getpid(), signal.SIGINT)
    other = threading.Thread(target=interrupt)
    other.start()
    try:
        for number, result in run_in_threads(run, runs, 2):
            results.append(result)
    except KeyboardInterrupt:
        pass
    other.join()
    assert 0 < len(results) < 20_000 and sorted(results) == sorted(begun), (k, len(results), len(begun))
print("kept all")
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals as POSIX has them")
def test_ctrl_c_at_any_time_loses_no_result_and_ends():
    done = subprocess.run([sys.executable, "-c", AT_ANY_TIME], capture_output=True, text=True, timeout=120, check=False)
    assert done.stdout == "kept all\n", done.stderr
