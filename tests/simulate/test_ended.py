"""Runs that cannot go on, take too long or too much, or are interrupted: each ends, says why and keeps what it has."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
from contextlib import contextmanager

import numpy as np
import pytest
import sympy
from numba import njit
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb._simulate import _arguments
from fricmb.integrate.integrator import Integrator, Tolerance
from fricmb.integrate.methods.radau import Radau
from fricmb.integrate.problem import Start
from fricmb.integrate.run import memory, slices
from fricmb.integrate.run.stop import Watch, watching
from fricmb.system import build
from tests.ticking import ticking

METHODS = ("auto", "bdf", "radau", "collocation", "taylor", "bdf2-paper")
VALUES = {
    "log": (sympy.log(5 - fm.t), lambda t: np.log(5 - t)),
    "sqrt": (sympy.sqrt(5 - fm.t), lambda t: np.sqrt(5 - t)),
    "asin": (sympy.asin(fm.t / 5), lambda t: np.arcsin(t / 5)),
}


def step_of(method):
    return {"step": 0.01} if method == "bdf2-paper" else {}


def pushed(value, velocity=8.0, **contact):
    """A block that slips in one direction throughout, under a push."""
    block = fm.Body("block", mass=1.0, velocity={"x": velocity})
    contact = {"law": fm.laws.Coulomb(mu_s=0.2), "normal_force": 1.0, **contact}
    push = fm.Force("push", block, axis="x", value=value)
    return fm.Scene("pushed", [block, push, fm.Contact("floor", block, **contact)])


def endless(**belt):
    """A block on a belt that goes on for ever."""
    block = fm.Body("block", mass=1.0)
    belt = fm.Driven("belt", velocity={"x": 0.2})
    law = fm.laws.Coulomb(mu_s=0.8, mu_k=0.5)
    parts = [block, belt, fm.Spring("spring", block, axis="x", stiffness=1.0)]
    return fm.Scene("endless", [*parts, fm.Contact("rub", block, belt, law=law, normal_force=1.0)])


@pytest.mark.parametrize("value", VALUES)
@pytest.mark.parametrize("method", [m for m in METHODS if m != "collocation"])
def test_a_force_without_a_value_ends_the_run(method, value):
    formula, number = VALUES[value]
    with pytest.raises(fm.IntegrationError) as caught:
        fm.simulate(pushed(formula), t_end=10.0, method=method, t_eval=np.linspace(0, 10, 101), **step_of(method))
    error = caught.value
    assert error.t == pytest.approx(5.0, abs=1e-6)
    assert "push.value" in error.reason
    assert f"{formula} is nan" in error.reason
    partial = error.partial
    assert np.isfinite(partial.q).all()
    assert 4.89 < partial.t[-1] <= 5.0
    truth = solve_ivp(
        lambda t, y: (y[1], number(t) - 0.2), (0, 4.5), (0, 8.0), method="DOP853", rtol=1e-11, atol=1e-12
    )
    assert partial["block.x"][45] == pytest.approx(truth.y[0, -1], rel=1e-3 if method == "bdf2-paper" else 1e-5)


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_normal_force_without_a_value_is_no_open_contact(method):
    load = 1 + sympy.sqrt(3 - fm.t)
    with pytest.raises(fm.IntegrationError, match=r"floor.normal_force = sqrt\(3 - t\) \+ 1 is nan") as caught:
        fm.simulate(pushed(0.0, normal_force=load), t_end=6.0, method=method)
    assert caught.value.t == pytest.approx(3.0, abs=1e-6)
    assert (caught.value.partial.mode("floor") == 1).all()


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_mechanism_whose_drive_has_no_value_ends(method):
    rod = fm.RigidBody("rod", mass=1.0, inertia=0.1, position={"x": 0.5})
    pin = fm.Revolute("pin", rod.point("end", (-0.5, 0.0)))
    push = fm.Torque("push", rod, value=sympy.sqrt(0.3 - fm.t))
    with pytest.raises(fm.IntegrationError, match=r"push\.value") as caught:
        fm.simulate(fm.Scene("driven", [rod, pin, push]), t_end=1.0, method=method)
    assert caught.value.t == pytest.approx(0.3, abs=1e-6)
    assert caught.value.partial.t[-1] > 0.29


class Short(Integrator):
    """Stops half way and does not say so."""

    name = "short"
    order = "any"
    takes = Radau.takes

    def integrate(self, problem, start, t_end, **options):
        return Radau().integrate(problem, start, 0.5 * (start.t + t_end), **options)


def test_the_end_is_asserted():
    with pytest.raises(fm.IntegrationError, match="ended before its time") as caught:
        fm.simulate(endless(), t_end=10.0, method=Short())
    assert caught.value.partial.t[-1] == 5.0


@pytest.mark.parametrize("method", METHODS)
def test_a_time_limit_ends_a_run(method):
    scene = endless()
    fm.simulate(scene, t_end=1.0, method=method, **step_of(method))  # whatever has to be compiled is
    with pytest.raises(fm.IntegrationError, match=r"the time limit of 0\.4 s was reached") as caught:
        fm.simulate(scene, t_end=1e8, method=method, time_limit=0.4, **step_of(method))  # of days
    partial = caught.value.partial
    assert 1.0 < partial.t[-1] <= caught.value.t < 1e8
    assert np.isfinite(partial.q).all()


@pytest.mark.parametrize("kind", [fm.IntegrationError, fm.Interrupted])
def test_what_was_computed_is_put_together_when_it_is_asked_for(kind):
    made = []
    error = kind("why", t=1.0, reason="why", later=lambda: made.append(1) or "part")
    assert made == []
    other = error.passed_on(fm.Interrupted)
    assert made == []
    assert (other.partial, error.partial, other.partial) == ("part", "part", "part")
    assert made == [1]
    again = pickle.loads(pickle.dumps(other))
    assert (type(again), again.t, again.reason, again.partial) == (fm.Interrupted, 1.0, "why", "part")


@pytest.mark.parametrize("method", ["auto", "bdf", "taylor"])
def test_chunks_of_rows_are_put_together_once_and_pickle(method):
    sol = fm.simulate(endless(), t_end=3000.0, method=method)
    again = pickle.loads(pickle.dumps(sol))
    np.testing.assert_array_equal(again.q, sol.q)
    t = np.linspace(0.0, 3000.0, 7)
    np.testing.assert_array_equal(again(t), sol(t))
    assert (again.run.pieces[0].trajectory.ends, sol.run.pieces[0].trajectory.ends) == ((0.0, 3000.0),) * 2


#: A process of its own: what else a test process does with signals is not this test's.
INTERRUPTED = """
import pickle, signal, sys, time
import numpy as np
import fricmb as fm
from tests.simulate.test_ended import driven, endless
signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background may be told to ignore it
method, options, scene = sys.argv[1], eval(sys.argv[2]), {"driven": driven, "endless": endless}[sys.argv[3]]()
name = "rod.angle" if sys.argv[3] == "driven" else "block.x"
times = None if sys.argv[4] == "rows" else np.arange(0.0, 1e6, 100.0)
# what is compiled or read from the cache is, before the signal comes: long sticks have kernels of their own
fm.simulate(scene, t_end=2000.0, method=method, t_eval=np.arange(0.0, 2000.0, 100.0), **options)
print("ready", flush=True)
try:
    fm.simulate(scene, t_end=1e8, method=method, t_eval=times, **options)
except KeyboardInterrupt as error:
    spent = time.process_time()
    again = pickle.loads(pickle.dumps(error))
    np.testing.assert_array_equal(again.partial.q, error.partial.q)
    assert type(error) is fm.Interrupted
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
    assert again.t == error.t
    assert error.partial.t.size > 0
    assert np.isfinite(error.partial[name]).all()
    truth = fm.simulate(scene, t_end=1.0, method=method, **options)
    assert abs(error.partial[name][0] - truth[name][0]) == 0.0
    print(error.partial.t[-1], error.t, spent)
"""


def driven():
    """Two hinged rods, driven for ever."""
    rod = fm.RigidBody("rod", mass=1.0, inertia=0.1, position={"x": 0.5})
    arm = fm.RigidBody("arm", mass=1.0, inertia=0.1, position={"x": 1.5})
    pin = fm.Revolute("pin", rod.point("foot", (-0.5, 0.0)))
    elbow = fm.Revolute("elbow", rod.point("end", (0.5, 0.0)), arm.point("foot", (-0.5, 0.0)))
    push = fm.Torque("push", rod, value=sympy.sin(fm.t))
    return fm.Scene("driven", [rod, arm, pin, elbow, push])


def spent(process):
    """Seconds of the processor that a process has used: how loaded the machine is does not enter."""
    if not sys.platform.startswith("linux"):
        return time.monotonic()
    return time.clock_gettime((~process.pid << 3) | 2)


#: Method, scene, what is asked for, and seconds of the processor after which Ctrl-C comes: putting together all rows of
#: two seconds of Taylor steps takes longer than a second, and waits until somebody asks for it.
RUNS = [
    *((method, "endless", "times", 1.0) for method in METHODS),
    *((method, "driven", "times", 1.0) for method in ("auto", "bdf", "radau")),
    *((method, "endless", "rows", 1.0) for method in ("auto", "radau")),
    ("taylor", "endless", "rows", 2.0),
    ("auto", "driven", "rows", 1.0),
]


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize(("method", "scene", "asked", "seconds"), RUNS)
def test_ctrl_c_ends_a_run_within_a_second_and_keeps_it(method, scene, asked, seconds):
    command = [sys.executable, "-c", INTERRUPTED, method, repr(step_of(method)), scene, asked]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout.readline() == "ready\n", process.stderr.read()
            before = spent(process)
            while spent(process) < before + seconds:
                time.sleep(0.01)
            at_signal = spent(process)
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=120.0)  # the run would take days
        finally:
            process.kill()
    assert process.returncode == 0, err
    last, at, at_exception = map(float, out.split())
    assert 0.0 <= last <= at < 1e8
    if sys.platform.startswith("linux"):
        assert at_exception - at_signal < 1.0


def test_a_run_ends_at_its_limit():
    with pytest.raises(fm.IntegrationError, match=r"the time limit of 0\.2 s was reached") as caught:
        fm.simulate(endless(), t_end=1e12, t_eval=[0.0, 1e12], method="radau", time_limit=0.2)  # of years
    assert caught.value.t > 0.0


class Mine(Exception):
    """What a handler of the user's own raises."""


@contextmanager
def alarm(seconds):
    """A signal after so many seconds, whose handler raises."""

    def handler(number, frame):
        raise Mine("it is time")

    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
@pytest.mark.parametrize("method", ["radau", "collocation", "taylor"])
def test_what_a_handler_raises_comes_out_of_a_run(method):
    fm.simulate(endless(), t_end=1.0, t_eval=[0.0, 1.0], method=method)  # compiles
    with alarm(0.2), pytest.raises(Mine, match="it is time"):
        fm.simulate(endless(), t_end=1e12, t_eval=[0.0, 1e12], method=method)
    assert fm.simulate(endless(), t_end=1.0, method=method).t[-1] == 1.0


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_what_a_handler_raises_comes_out_of_solve_dae():
    driven = njit(lambda t, y, yp: np.array([yp[0] - np.cos(t), y[1] - y[0]]))
    fm.solve_dae(driven, (0.0, 1.0), [0.0, 0.0])  # compiles
    with alarm(0.2), pytest.raises(Mine, match="it is time"):
        fm.solve_dae(driven, (0.0, 1e9), [0.0, 0.0], t_eval=[1e9])


def test_threads_have_limits_of_their_own():
    found = {}

    def run(limit):
        with pytest.raises(fm.IntegrationError) as caught:
            fm.simulate(endless(), t_end=1e12, t_eval=[0.0, 1e12], method="radau", time_limit=limit)
        found[limit] = caught.value.reason

    fm.simulate(endless(), t_end=1.0, t_eval=[0.0, 1.0], method="radau")  # compiles
    threads = [threading.Thread(target=run, args=(limit,)) for limit in (0.1, 0.3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == {limit: f"the time limit of {limit:g} s was reached" for limit in (0.1, 0.3)}


#: A scene that each method takes, with stick and slip, and how far.
SLICED = {
    "radau": (lambda: fm.models.belt_oscillator(), 40.0),
    "bdf": (lambda: fm.models.belt_oscillator(), 40.0),
    "collocation": (lambda: fm.models.brake4dof("2"), 60.0),
    "taylor": (lambda: fm.models.stick_slip_chain(6), 10.0),
    "bdf2-paper": (lambda: fm.models.belt_oscillator(), 10.0),
    "mechanism": (lambda: fm.models.slider_crank(), 0.2),
}


@pytest.mark.parametrize("method", SLICED)
def test_results_do_not_depend_on_where_slices_end(method):
    """A number that changes at every look ends each slice as soon as it may end."""
    make, t_end = SLICED[method]
    asked = {"t_end": t_end, "method": "radau" if method == "mechanism" else method, **step_of(method)}
    whole = fm.simulate(make(), **asked)
    with ticking():
        cut = fm.simulate(make(), **asked)
    np.testing.assert_array_equal(cut.t, whole.t)
    np.testing.assert_array_equal(cut.q, whole.q)
    np.testing.assert_array_equal(cut.v, whole.v)
    assert [(e.t, e.contact, e.kind) for e in cut.events] == [(e.t, e.contact, e.kind) for e in whole.events]


@pytest.mark.skipif(not hasattr(os, "fork"), reason="processes that are forked")
def test_a_forked_process_ends_runs_too():
    fm.simulate(endless(), t_end=1.0, t_eval=[0.0, 1.0], method="radau")
    with slices.slicing():
        process = multiprocessing.get_context("fork").Process(target=limited)
        process.start()
    process.join(60.0)
    assert process.exitcode == 0


def limited():
    with pytest.raises(fm.IntegrationError, match="time limit"):
        fm.simulate(endless(), t_end=1e12, t_eval=[0.0, 1e12], method="radau", time_limit=0.2)


def test_a_result_that_finds_no_room_ends_the_run(monkeypatch):
    held = iter(np.arange(0.0, 1e12, 1e9))
    monkeypatch.setattr(memory, "EVERY", 0.0)
    monkeypatch.setattr(memory, "taken", lambda: next(held))
    monkeypatch.setattr(memory.Footprint, "_seen", (-1e9, None))  # nobody has looked
    monkeypatch.setattr(memory, "available", lambda: 3e9)
    said = r"taken .* GB and assembling it needs more than the 3 GB left"
    with pytest.raises(fm.IntegrationError, match=said) as caught:
        fm.simulate(endless(), t_end=1e8, method="radau")
    assert caught.value.partial.t[-1] > 0.0


def test_values_that_find_no_room_are_refused_before_the_run(monkeypatch):
    monkeypatch.setattr(_arguments, "available", lambda: 1e3)
    monkeypatch.setattr(_arguments, "LITTLE", 1e4)
    with pytest.raises(fm.SceneError, match=r"t_eval: 1001 times of 6 numbers take .* GB"):
        fm.simulate(endless(), t_end=10.0, t_eval=np.linspace(0, 10, 1001))


def test_a_time_limit_is_a_positive_number():
    for wrong in (0.0, -1.0, np.nan, "soon", True):
        with pytest.raises(fm.SceneError, match="time_limit"):
            fm.simulate(endless(), t_end=1.0, time_limit=wrong)
    assert fm.simulate(endless(), t_end=1.0, time_limit=100.0).t[-1] == 1.0


@pytest.mark.parametrize("method", ["bdf", "radau", "collocation", "taylor"])
def test_a_run_that_is_ended_before_its_first_step_has_its_start(method):
    problem = build(fm.models.stick_slip_chain(3)).problem
    start = Start(t=0.0, q=np.zeros(problem.n), v=np.zeros(problem.n), z=np.zeros(0))
    watch = Watch()
    watch.interrupt(KeyboardInterrupt())
    with watching(watch):
        run = fm.integrators[method]().integrate(problem, start, 10.0, tolerance=Tolerance(rtol=1e-4))
    assert run.failure == watch.reason
    assert run.ends == (0.0, 0.0)
    assert not run.rows().q.any()
