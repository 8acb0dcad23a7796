"""Adapters of packages that are optional: tried where these are installed, and said to be missing where not."""

import os

import numpy as np
import pytest

from fricmb.bench import Setting, measure_cell
from fricmb.bench._scenes import SCENES
from fricmb.bench._siconos import Siconos, _matrices, siconos_methods
from fricmb.bench._suite import missing
from fricmb.system import build


def case_of(name):
    return next(case for case in SCENES if case.name == name)


def test_what_is_not_installed_is_shown(monkeypatch):
    monkeypatch.delenv("FRICMB_SICONOS", raising=False)
    monkeypatch.setattr("fricmb.bench._siconos.find_spec", lambda name: None)
    assert any(row["method"] == "siconos" and "not installed" in row["why"] for row in missing())
    monkeypatch.setenv("FRICMB_SICONOS", "/somewhere/python3")
    assert [method.python for method in siconos_methods()] == ["/somewhere/python3"]
    assert all(row["method"] != "siconos" for row in missing())


def test_numbalsoda():
    pytest.importorskip("numbalsoda")
    from fricmb.bench._numbalsoda import numbalsoda_methods

    for method in numbalsoda_methods():
        outcome = measure_cell(case_of("free"), method, Setting(rtol=1e-6, eps=1e-4))
        assert outcome.failure == ""
        assert 1e-5 < outcome.metrics.state < 2e-3  # the error of the smoothing


def test_exudyn():
    pytest.importorskip("exudyn")
    from fricmb.bench._exudyn import Exudyn

    case = case_of("free")
    outcome = measure_cell(case, Exudyn(), Exudyn().settings(case, False)[0])
    assert outcome.failure == ""
    assert 1e-3 < outcome.metrics.state < 5e-2


def test_siconos():
    methods = siconos_methods()
    if not methods:
        pytest.skip("neither siconos nor FRICMB_SICONOS, an interpreter that has it")
    case = case_of("free")
    errors = [measure_cell(case, methods[0], Setting(step=step)).metrics.state for step in (0.025, 0.00625)]
    assert errors[0] < 1e-2
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.parametrize("name", ["free", "forced0.8", "stewart", "stack"])
def test_the_matrices_given_to_siconos_are_those_of_the_scene(name):
    """Accelerations under known contact forces, from the matrices and from the equations of motion."""
    case = case_of(name)
    assert Siconos("python3").refuses(case) is None
    system = build(case.build())
    problem, contacts = system.problem, system.problem.contacts
    given = _matrices(system, 0.5, 4)
    rng = np.random.default_rng(7)
    q, v = rng.normal(size=(2, problem.n))
    part = rng.uniform(-1.0, 1.0, problem.n_c)
    t = np.array([1.25])  # the middle of the third step
    u = system.signals(t)[:, :, 0]
    linear, n = problem.linear, problem.n
    force = linear.fx[:n] + linear.B @ u[0] - linear.Kx[:n] @ np.r_[q, u[0]] - linear.Cx[:n] @ np.r_[v, u[1]]
    a = np.linalg.solve(linear.M, force + contacts.W @ (part * contacts.mu_0 * contacts.N))
    loads = given["loads"]
    rate = given["A"] @ np.r_[q, v] + given["B"] @ part + loads[2 if len(loads) > 1 else 0]
    assert rate == pytest.approx(np.r_[v, a], abs=1e-12)
    assert given["C"] @ np.r_[q, v] + given["e"] == pytest.approx(contacts.W.T @ v - contacts.w, abs=1e-12)


def test_siconos_refuses_what_a_relay_is_not():
    for name in ("belt", "brake2", "puck", "lugre"):
        assert Siconos("python3").refuses(case_of(name))


def test_an_interpreter_without_siconos_is_a_failure_with_its_message():
    outcome = measure_cell(case_of("free"), Siconos(os.devnull), Setting(step=0.025))
    assert outcome.metrics is None
    assert outcome.failure
