"""Kernels with arrays going in and arrays coming out, against a few lines of numpy: no scene, no laws, no run.

Where a whole run fails, these say which piece: modes at one instant, one step under given modes, its error.
"""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from numpy.polynomial import legendre
from scipy.integrate import solve_ivp

from fricmb.integrate.compile.kernel import entry
from fricmb.integrate.formulas.step_control import ONE_STEP_RUNGS, ladder
from fricmb.integrate.formulas.tableau import radau
from fricmb.integrate.implicit.run import _set_up
from fricmb.integrate.implicit.scene.control import Control
from fricmb.integrate.implicit.scene.moving import Moving
from fricmb.integrate.implicit.scene.problem_structs import Mech, mech_of
from fricmb.integrate.implicit.scene.state import Instant, State
from fricmb.integrate.implicit.stages.one_step import end_step, error_of, try_step
from fricmb.integrate.implicit.stages.stages import Stages
from fricmb.integrate.implicit.time_loop import begin
from fricmb.integrate.implicit.workspace import run_workspace
from fricmb.integrate.integrator import Tolerance
from fricmb.integrate.problem import SLIP, STICK, Contacts, Elements, Linear, Problem, Signals, Start, Templates


@entry
def one_try(mech: Mech, k: Moving, w: Instant, y: State, end: State, st: Stages, c: Control, h: float) -> float:
    """A step from y; its end in ``end``.  The error that it is given, -1 where it is not solved."""
    if not try_step(mech, k, y, st, c, h):
        return -1.0
    error = error_of(c, y, st, h)
    return error if end_step(mech, k, w, y, end, st, c, h) else -2.0


class Begun:
    """A run at its start, with modes, forces and accelerations there."""

    def __init__(self, problem, start, t_end, stages=5, rtol=1e-6):
        self.mech = mech_of(problem)
        self.lent = run_workspace(problem, radau(stages))
        self.rooms = self.lent.__enter__()
        k, w, self.y, self.end, _, self.st, out, c = self.rooms
        small, reach = _set_up(self.rooms, problem, start, t_end, Tolerance(rtol=rtol))
        self.part = np.zeros(problem.n_c, np.int8)
        self.code = begin(self.mech, k, w, self.y, c, out, self.part, start.mode is not None, small, reach)

    def step(self, h):
        k, w, y, end, _, st, _, c = self.rooms
        return one_try(self.mech, k, w, y, end, st, c, h)


@entry
def rung(h: float) -> float:
    """The step that is taken for one of h."""
    return ladder(h, ONE_STEP_RUNGS)


class Arrays:
    """``M v' + C v + K q = f + W F`` with contacts of one row each: |F| <= mu_s N in stick, mu_k N against slip."""

    def __init__(self, seed, n, m):
        rng = np.random.default_rng(seed)
        root = rng.normal(size=(n, n))
        self.M = root @ root.T + n * np.eye(n)
        stiff = rng.normal(size=(n, n))
        self.K, self.C = stiff @ stiff.T, 0.1 * np.eye(n)
        self.W = rng.normal(size=(n, m))
        self.f = 3.0 * rng.normal(size=n)
        self.N = rng.uniform(0.5, 2.0, size=m)
        self.mu = np.full(m, 0.7)
        self.n, self.m = n, m

    def problem(self):
        m = self.m
        contacts = Contacts(
            row=np.arange(m + 1), W=self.W, w=np.zeros(m), Wu=np.zeros((m, 0)), law=np.zeros(m, np.int8),
            law_table=Templates(
                address=np.zeros(m, np.int64), p_start=np.zeros(m + 1, np.int64), x_start=np.zeros(m + 1, np.int64)
            ),
            mu_s=self.mu, mu_0=self.mu, piecewise=np.zeros(m, bool), z_start=np.zeros(m + 1, np.int64),
            normal=np.zeros(m, np.int8), N=self.N, Wn=np.zeros((self.n, m)), N0=np.zeros(m),
            normal_table=Templates(
                address=np.zeros(m, np.int64), p_start=np.zeros(m + 1, np.int64), x_start=np.zeros(m + 1, np.int64)
            ),
        )  # fmt: skip
        linear = Linear(M=self.M, Kx=self.K, Cx=self.C, fx=self.f, B=np.zeros((self.n, 0)))
        names = tuple(f"b{i}.x" for i in range(self.n))
        return Problem(linear=linear, signals=Signals(), contacts=contacts, elements=Elements(), dof_names=names)

    def accelerations(self, q, v, F):
        return np.linalg.solve(self.M, self.f - self.K @ q - self.C @ v + self.W @ F)


def modes_at_rest(arrays):
    """By trying every combination of stick and slip: forces and accelerations of the one that contradicts nothing."""
    D = arrays.W.T @ np.linalg.solve(arrays.M, arrays.W)
    free = arrays.W.T @ arrays.accelerations(np.zeros(arrays.n), np.zeros(arrays.n), np.zeros(arrays.m))
    limit, found = arrays.mu * arrays.N, []
    for signs in itertools.product((-1, 0, 1), repeat=arrays.m):
        sign = np.array(signs)
        F = -sign * limit
        stuck = sign == 0
        F[stuck] = np.linalg.solve(D[np.ix_(stuck, stuck)], -(free + D @ F)[stuck]) if stuck.any() else 0.0
        rate = free + D @ F
        if (np.abs(F[stuck]) <= limit[stuck]).all() and (sign * rate >= 0.0)[~stuck].all():
            found.append((F, rate))
    assert len(found) == 1
    return found[0]


@pytest.mark.parametrize("seed", range(12))
def test_which_contacts_hold_at_an_instant(seed):
    arrays = Arrays(seed, n=6, m=4)
    F, rate = modes_at_rest(arrays)
    rest = Start(t=0.0, q=np.zeros(6), v=np.zeros(6), z=np.zeros(0))
    run = Begun(arrays.problem(), rest, 1.0)
    np.testing.assert_allclose(run.y.F, F, atol=1e-9)
    assert ((run.y.mode == STICK) == (np.abs(F) < arrays.mu * arrays.N * (1 - 1e-12))).all()
    np.testing.assert_allclose(run.y.a, arrays.accelerations(np.zeros(6), np.zeros(6), F), atol=1e-9)
    np.testing.assert_allclose(arrays.W.T @ np.asarray(run.y.a), rate, atol=1e-9)


def test_instants_of_many_kinds_were_tried():
    """Sticking alone, slipping alone and both are among them."""
    kinds = set()
    for seed in range(12):
        _, rate = modes_at_rest(Arrays(seed, n=6, m=4))
        kinds.add(int((np.abs(rate) > 1e-9).sum()))
    assert len(kinds) > 2


def stages_by_hand(arrays, s, h, q, v, slipping, sign):
    """Radau stages of given modes as one dense system: velocities (s, n), forces (s, m)."""
    tab = radau(s)
    A, n = np.asarray(tab.A), arrays.n
    stuck = np.flatnonzero(~slipping)
    F_slip = np.where(slipping, -sign * arrays.mu * arrays.N, 0.0)
    # M V_i + h sum A_ij (C V_j + K Q_j - W F_j) = M v + h sum A_ij f, with Q_i = q + h sum A_ij V_j
    eye = np.eye(s)
    left = np.kron(eye, arrays.M) + h * np.kron(A, arrays.C) + h**2 * np.kron(A @ A, arrays.K)
    right = np.tile(arrays.M @ v, s) + h * np.kron(A @ np.ones((s, 1)), (arrays.f - arrays.K @ q)[:, None]).ravel()
    right += h * np.kron(A @ np.ones((s, 1)), (arrays.W @ F_slip)[:, None]).ravel()
    push = -h * np.kron(A, arrays.W[:, stuck])
    hold = np.kron(eye, arrays.W[:, stuck].T)
    whole = np.block([[left, push], [hold, np.zeros((hold.shape[0], push.shape[1]))]])
    x = np.linalg.solve(whole, np.concatenate([right, np.zeros(hold.shape[0])]))
    F = np.tile(F_slip, (s, 1))
    F[:, stuck] = x[s * n :].reshape(s, len(stuck))
    return x[: s * n].reshape(s, n), F


@pytest.mark.parametrize("stages", [3, 5])
@pytest.mark.parametrize("seed", range(4))
def test_a_step_of_given_modes(seed, stages):
    """Two contacts stick, two slip: stages, forces and error of one step, against one dense system."""
    arrays = Arrays(seed, n=6, m=4)
    rng = np.random.default_rng(100 + seed)
    slipping = np.array([True, False, True, False])
    sign = rng.choice([-1.0, 1.0], size=4)
    arrays.N[~slipping] = 1e3  # they hold whatever comes
    g = np.where(slipping, 2.0 * sign, 0.0)
    v = np.linalg.lstsq(arrays.W.T, g, rcond=None)[0]
    q, h, rtol = 0.1 * rng.normal(size=6), {3: 0.02, 5: 0.2}[stages], 1e-6
    mode = np.where(slipping, SLIP, STICK).astype(np.int8)
    start = Start(t=0.0, q=q, v=v, z=np.zeros(0), mode=mode, direction=sign * slipping)
    run = Begun(arrays.problem(), start, 1.0, stages, rtol)
    assert (np.asarray(run.y.mode) == mode).all()
    error = run.step(h)
    V, F = stages_by_hand(arrays, stages, h, q, v, slipping, sign)
    np.testing.assert_allclose(run.st.V, V, atol=1e-11)
    np.testing.assert_allclose(run.st.F, F, atol=1e-8)
    np.testing.assert_allclose(run.end.v, V[-1], atol=1e-11)
    np.testing.assert_allclose(run.end.q, q + h * np.asarray(radau(stages).A)[-1] @ V, atol=1e-12)
    # the last Legendre coefficients of the polynomials through the start and the stages, in units of the tolerance
    c = np.concatenate([[0.0], radau(stages).c])
    rows = np.vstack([v, V])
    places = np.vstack([q, q + h * np.asarray(radau(stages).A) @ V])
    top_v, top_q = (np.linalg.solve(legendre.legvander(2.0 * c - 1.0, stages), x)[-1] for x in (rows, places))
    size = np.abs(v) + h * np.abs(np.asarray(run.y.a))  # what a velocity is known to reach
    size_q = np.maximum(np.abs(places).max(axis=0), h * size)
    expected = max(np.abs(top_v / size).max(), np.abs(top_q / size_q).max()) / rtol
    assert error == pytest.approx(expected, rel=1e-6, abs=1e-8)  # its round-off


def test_a_step_is_as_accurate_as_its_order():
    """Without contacts: the end of steps of h and h/2 against scipy, five stages, order nine."""
    arrays = Arrays(5, n=4, m=0)
    q, v = np.ones(4), np.zeros(4)

    def rates(t, y):
        return np.concatenate([y[4:], arrays.accelerations(y[:4], y[4:], np.zeros(0))])

    problem, errors = arrays.problem(), []
    for h in (1.6, 0.8):
        run = Begun(problem, Start(t=0.0, q=q, v=v, z=np.zeros(0)), 10.0, 5, 1e-3)
        assert run.step(h) > 0.0
        exact = solve_ivp(rates, (0.0, h), np.concatenate([q, v]), method="DOP853", rtol=1e-13, atol=1e-15).y[:, -1]
        errors.append(np.abs(np.asarray(run.end.v) - exact[4:]).max())
    assert 8.0 < np.log2(errors[0] / errors[1]) < 11.0


def test_steps_stand_on_a_ladder():
    for h in (1e-9, 0.3, 1.0, 7.7):
        assert rung(h) <= h < rung(h) * 2**0.125 * (1 + 1e-9)
        assert rung(rung(h)) == rung(h)
