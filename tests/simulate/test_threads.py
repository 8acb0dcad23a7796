"""Runs in several threads: at the same time, each with arrays and limits of its own, and the results of one alone."""

from __future__ import annotations

import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.once_per import Kept, lent_per
from tests.simulate.test_ended import endless

M, L = fm.models, fm.laws
STRIBECK = L.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.1)
SCENES = {
    "brake": (M.brake4dof(case=2), "k1x.stiffness", 60.0, ("auto", "radau", "bdf")),
    "steep": (M.brake4dof(case=2, law=STRIBECK), "lining.law.mu_k", 20.0, ("auto", "radau")),
    "chain": (M.stick_slip_chain(6), "coupling1.stiffness", 10.0, ("taylor", "radau")),
    "plane": (M.puck_on_belt(), "puck.mass", 4.0, ("auto", "radau")),
    "stack": (M.block_stack(), "block2.mass", 4.0, ("auto", "bdf")),
    "crank": (M.slider_crank(friction=L.Coulomb(mu_s=0.2)), "rod.mass", 2.0, ("radau", "bdf")),
}


@pytest.fixture
def _quick_turns():
    """Threads take turns a hundred times as often as usual: what they could spoil for one another, they do."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(5e-5)
    yield
    sys.setswitchinterval(before)


def solution(scene, name, factor, t_end, method):
    """All that a run gives, between its rows, too."""
    scene = scene.with_parameters({name: scene.parameters[name] * factor})
    sol = fm.simulate(scene, t_end=t_end, rtol=1e-4, method=method)
    between = sol(np.linspace(0.0, t_end, 17))
    return sol.t, sol.q, sol.v, np.asarray(between), np.array([event.t for event in sol.events])


@pytest.mark.usefixtures("_quick_turns")
@pytest.mark.parametrize(("scene", "method"), [(name, m) for name, made in SCENES.items() for m in made[3]])
def test_threads_find_what_one_alone_finds(scene, method):
    scene, name, t_end, _ = SCENES[scene]
    factors = [1.0, 1.0, 1.001, 1.002, 1.001, 1.0]
    alone = [solution(scene, name, factor, t_end, method) for factor in factors]
    with ThreadPoolExecutor(3) as pool:
        together = list(pool.map(lambda factor: solution(scene, name, factor, t_end, method), factors))
    for one, other in zip(alone, together, strict=True):
        for a, b in zip(one, other, strict=True):
            np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("method", ["auto", "bdf", "collocation", "taylor"])
def test_python_goes_on_while_a_run_works(method):
    scene = endless()
    fm.simulate(scene, t_end=1.0, method=method)  # compiled
    begun, failed = threading.Event(), []

    def run():
        begun.set()
        try:
            fm.simulate(scene, t_end=1e9, method=method, time_limit=0.5)
        except fm.IntegrationError as error:
            failed.append(error.reason)

    thread = threading.Thread(target=run)
    thread.start()
    begun.wait()
    turns = 0
    while thread.is_alive():
        time.sleep(1e-3)
        turns += 1
    assert "time limit" in failed[0]
    assert turns > 50  # under the lock one turn in 50 ms: ten in all


def test_a_limit_ends_the_run_of_its_thread_alone():
    scene = endless()
    fm.simulate(scene, t_end=1.0, method="radau")
    ends = {}

    def run(limit):
        try:
            fm.simulate(scene, t_end=1e9, method="radau", time_limit=limit)
        except fm.IntegrationError as error:
            ends[limit] = error.reason

    threads = [threading.Thread(target=run, args=(limit,)) for limit in (0.1, 0.5)]
    for thread in threads:
        thread.start()
    sol = fm.simulate(scene, t_end=50.0, method="radau")  # without a limit, beside both
    for thread in threads:
        thread.join()
    assert sol.t[-1] == 50.0
    assert ends == {limit: f"the time limit of {limit} s was reached" for limit in (0.1, 0.5)}


def test_what_is_lent_belongs_to_one_at_a_time():
    kept = Kept()
    with lent_per(kept, "rows", list) as one:
        with lent_per(kept, "rows", list) as other:
            assert one is not other
        with lent_per(kept, "rows", list) as again:
            assert again is other
    with pytest.raises(ZeroDivisionError), lent_per(kept, "rows", list) as spoilt:
        raise ZeroDivisionError
    with lent_per(kept, "rows", list) as first, lent_per(kept, "rows", list) as second:
        assert spoilt is not first
        assert spoilt is not second


LEAVES = """
import threading, time
import fricmb as fm
from tests.simulate.test_ended import endless
fm.simulate(endless(), t_end=1.0, method="radau")
threading.Thread(target=lambda: fm.simulate(endless(), t_end=1e9, method="radau"), daemon=True).start()
time.sleep(0.3)
"""


def test_a_program_ends_while_a_thread_of_it_is_in_a_run():
    done = subprocess.run([sys.executable, "-c", LEAVES], capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
