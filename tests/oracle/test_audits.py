"""Audits: right runs pass, runs that are wrong by a known amount fail."""

import numpy as np
import pytest

import fricmb as fm
from tests.oracle.judge import Outcome, compare, truth
from tests.oracle.random_scenes import generate
from tests.oracle.spec import case_of
from tests.oracle.table import case, scaled
from tests.oracle.wrong import WAYS, against


@pytest.mark.parametrize("way", WAYS.values(), ids=lambda way: way.__name__)
def test_each_way_of_being_wrong_is_seen_and_right_runs_are_not_accused(way):
    assert way(1e-8).ok
    assert not way(3e-4).ok


@pytest.mark.parametrize(
    ("law", "situation"),
    [("Karnopp", "reversal"), ("Karnopp", "break-away"), ("Gonthier", "steady sliding under vibration")],
)
def test_states_that_fade_before_force_asks_for_them_are_no_fault(law, situation):
    """The state in slip is off by far more than the tolerance, and nothing comes of it."""
    true = truth(case(law, situation))
    sol = fm.simulate(true.case.scene, t_end=true.case.problem.t_end, rtol=1e-6, method="radau")
    assert judged(true, sol).kind == "right"
    assert sol.audit().ok, sol.audit().table()
    other = fm.simulate(scaled(law, situation, 1.003), t_end=sol.t_end, rtol=1e-6, method="radau")
    assert not against(other, sol).ok


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_belt_that_jumps_under_laws_of_speed(method):
    """Rows on both sides of the jump: the run is right without ``t_eval`` too, and its audit says so."""
    true = truth(case_of(generate("line", 21)))
    sol = fm.simulate(true.case.scene, t_end=true.case.problem.t_end, rtol=1e-6, method=method)
    assert judged(true, sol).kind == "right"
    assert sol.audit().ok, sol.audit().table()


def judged(true, sol):
    """What the oracle says of a run."""
    at, signals = sol.at(true.t), true.case.signals
    events = [(e.contact, e.kind) for e in sol.events]
    q, v = (np.array([f(name) for name in signals]) for f in (at.__getitem__, at.velocity))
    return compare(true, Outcome("done", "", sol.stats.method, q, v, events), 1e-6)
