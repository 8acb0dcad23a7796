"""Python's look for unreachable objects is put off while something loads, and not longer."""

import gc
import threading

import fricmb as fm
from fricmb.integrate.compile.few_collections import SELDOM, few_collections


def test_what_was_set_is_set_again_when_the_last_is_done():
    before = gc.get_threshold()
    entered, leave = threading.Event(), threading.Event()

    def other():
        with few_collections():
            entered.set()
            leave.wait()

    thread = threading.Thread(target=other)
    with few_collections():
        assert gc.get_threshold() == SELDOM
        thread.start()
        entered.wait()
    assert gc.get_threshold() == SELDOM
    leave.set()
    thread.join()
    assert gc.get_threshold() == before


def test_a_run_leaves_what_the_user_has_set():
    before = gc.get_threshold()
    gc.set_threshold(123, 7, 5)
    try:
        fm.simulate(fm.models.belt_oscillator(), t_end=0.01)
        assert gc.get_threshold() == (123, 7, 5)
    finally:
        gc.set_threshold(*before)
