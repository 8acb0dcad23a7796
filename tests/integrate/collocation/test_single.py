"""One contact under constant friction: the brake, a belt, free decay and near-planar motion against references."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fricmb as fm
from fricmb.errors import SceneError
from fricmb.integrate import SLIP, STICK, Contacts, Elements, Linear, Problem, Signals, Start, Templates, Tolerance
from fricmb.integrate.collocation import Collocation

_spec = importlib.util.spec_from_file_location("reference", Path(__file__).parents[2] / "reference.py")
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

ROOT_PI = 10.0 * np.sqrt(np.pi / 2.0)
CASES = {"1": (1.0, 1.0, 0.0), "2": (ROOT_PI, np.sqrt(2.5) / 100.0, 0.0), "5": (ROOT_PI, np.sqrt(2.5) / 100.0, 0.01)}


def problem(M, K, C, W, w=0.0, *, mu_s=1.0, mu_k=1.0, N=1.0):
    """One contact on rows W (n, m) of a structure M, K, C."""
    M, K, C, W = (np.array(x, dtype=float) for x in (M, K, C, W))
    n, m = W.shape
    one = Templates(address=np.zeros(1, np.int64), p_start=np.zeros(2, np.int64), x_start=np.zeros(2, np.int64))
    contacts = Contacts(
        row=np.array([0, m]), W=W, w=np.full(m, float(w)), Wu=np.zeros((m, 0)), law=np.zeros(1, np.int8),
        law_table=one, mu_s=np.array([mu_s]), mu_0=np.array([mu_k]), z_start=np.zeros(2, np.int64),
        normal=np.zeros(1, np.int8), N=np.array([N]), normal_table=one, Wn=np.zeros((n, 1)), N0=np.zeros(1),
    )  # fmt: skip
    linear = Linear(M=M, Kx=K, Cx=C, fx=np.zeros(n), B=np.zeros((n, 0)))
    return Problem(linear=linear, signals=Signals(), contacts=contacts, elements=Elements())


def brake(case):
    """The 4-dof brake with mass ratio 1000."""
    omega_1, omega_2, d = CASES[case]
    R = 1000.0
    W = [[1, 0], [0, 1], [-1, 0], [0, -1]]
    return problem(
        np.diag([1, 1, R, R]), np.diag([1, omega_1**2, 0, R * omega_2**2]), np.diag([d, d, 0, R * d]), W, N=15.0
    )


def run(p, q, v, t_end, rtol, **options):
    """A run from rest positions q, velocities v at t = 0."""
    start = Start(t=0.0, q=np.array(q, float), v=np.array(v, float), z=np.zeros(0))
    return Collocation(**options).integrate(p, start, t_end, tolerance=Tolerance(rtol=rtol))


def run_brake(case, rtol, t_end=700.0, **options):
    """The brake from its published start."""
    return run(brake(case), [0, 0, 0, 0], [0, 0, 10, 0.01], t_end, rtol, **options)


def worst_error(ref, samples):
    """Largest error of all signals, each scaled by its maximum."""
    q, v = reference.errors(ref, samples.q, samples.v)
    return max(q.max(), v.max())


def energy(p, samples):
    """Kinetic and potential energy with what was lost and brought in: constant."""
    kinetic = 0.5 * np.sum(samples.v * (p.linear.M @ samples.v), axis=0)
    potential = 0.5 * np.sum(samples.q * (p.linear.Kx @ samples.q), axis=0)
    return kinetic + potential + samples.friction_loss.sum(axis=0) + samples.damping_loss - samples.input, kinetic


@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-11])
@pytest.mark.parametrize("case", ["1", "2", "5"])
def test_tolerance_means_error(case, rtol):
    ref = reference.load("p1_" + case)
    trajectory = run_brake(case, rtol)
    assert trajectory.failure is None
    assert len(trajectory.transitions.t) == len(ref["t_event"])
    assert np.abs(trajectory.transitions.t - ref["t_event"]).max() <= 1000.0 * rtol
    assert np.array_equal(trajectory.transitions.kind, ref["type_event"])
    assert worst_error(ref, trajectory.sample(ref["t"])) <= 100.0 * rtol


def test_tolerance_is_not_undercut():
    # most runs use the accuracy that was asked for: the geometric mean of error over rtol
    ratios = [
        worst_error(ref := reference.load("p1_" + case), run_brake(case, rtol).sample(ref["t"])) / rtol
        for case in ("2", "5")
        for rtol in (1e-4, 1e-6, 1e-8, 1e-10)
    ]
    assert np.exp(np.mean(np.log(ratios))) >= 0.01


def test_forces_and_relative_velocity():
    ref = reference.load("p1_2")
    samples = run_brake("2", 1e-8).sample(ref["t"])
    away = np.min(np.abs(ref["t"][:, None] - ref["t_event"]), axis=1) > 1e-3
    assert np.abs(samples.F.T - ref["F"])[away].max() <= 1e-6 * 15.0
    assert np.array_equal(samples.mode[0][away] == SLIP, ref["slip"][away] != 0)
    stuck = samples.mode[0] == STICK
    assert not samples.g[:, stuck].any()
    assert np.linalg.norm(samples.F, axis=0).max() <= 15.0 * (1.0 + 1e-9)
    assert np.abs(samples.friction_loss[0] - ref["Wd"]).max() <= 1e-6 * ref["Wd"].max()


@pytest.mark.parametrize("case", ["2", "5"])
def test_energy_ledger_closes(case):
    p = brake(case)
    samples = run_brake(case, 1e-8, t_end=100.0).sample(np.linspace(0.0, 100.0, 777))
    total, kinetic = energy(p, samples)
    assert np.ptp(total) <= 1e-6 * kinetic.max()
    assert np.all(np.diff(samples.friction_loss[0]) >= -1e-9)
    assert np.all(np.diff(samples.damping_loss) >= 0.0)


@pytest.mark.parametrize(("name", "c"), [("p2_a", 0.0), ("p2_b", 0.05)])
def test_belt_with_larger_break_away(name, c):
    ref = reference.load(name)
    p = problem([[1]], [[1]], [[c]], [[1]], 0.1, mu_s=1.5)
    trajectory = run(p, ref["q"][0], ref["v"][0], ref["t"][-1], 1e-9)
    assert np.abs(trajectory.transitions.t - ref["t_event"]).max() <= 1e-8
    samples = trajectory.sample(ref["t"])
    assert worst_error(ref, samples) <= 1e-8
    total, _ = energy(p, samples)
    assert np.ptp(total) <= 1e-6 * np.abs(samples.input).max()


def test_belt_period_in_closed_form():
    D, v0 = 0.5, 0.2
    p = problem([[1]], [[1]], [[0]], [[1]], v0, mu_k=0.5)
    releases = run(p, [1.0], [v0], 100.0, 1e-10)
    t = releases.transitions.t[releases.transitions.kind == 1]
    assert np.diff(t) == pytest.approx(2.0 * (np.pi - np.arctan(D / v0)) + 2.0 * D / v0, abs=1e-9)


@pytest.mark.parametrize("x0", [0.95, 1.03, 2.7183])
def test_free_decay_rests_where_it_must(x0):
    f = 0.1
    trajectory = run(problem([[1]], [[1]], [[0]], [[1]], mu_s=f, mu_k=f), [x0], [0.0], 60.0, 1e-8)
    half_cycles = int(np.ceil((x0 - f) / (2.0 * f)))
    assert trajectory.transitions.t[-1] == pytest.approx(half_cycles * np.pi, abs=1e-10)
    assert trajectory.end.q[0] == pytest.approx((-1) ** half_cycles * (x0 - 2.0 * f * half_cycles), abs=1e-12)
    assert [int(k) for k in trajectory.transitions.kind] == [4] * (half_cycles - 1) + [0]


@pytest.mark.parametrize(("name", "N"), [("p5_a", 0.3), ("p5_b", 0.1), ("p5_d", 0.05), ("p5_e", 0.1)])
@pytest.mark.parametrize("rtol", [1e-3, 1e-4, 1e-6, 1e-8, 1e-10])
def test_passes_close_to_zero(name, N, rtol):
    # the direction swings round while r falls to as little as 3e-8, and slip goes on
    ref = reference.load(name)
    p = problem(np.eye(2), np.diag([1, 2.3]), np.zeros((2, 2)), np.eye(2), N=N)
    trajectory = run(p, ref["q"][0], ref["v"][0], ref["t"][-1], rtol)
    assert len(trajectory.transitions.t) == 1
    assert worst_error(ref, trajectory.sample(ref["t"])) <= 100.0 * rtol


def test_general_damping_equals_fine_steps():
    # one damper between two masses: no modes; the same motion through a modal detour must come out
    M, K, C = np.diag([1.0, 2.0]), np.array([[3.0, -1.0], [-1.0, 2.0]]), np.array([[0.4, 0.0], [0.0, 0.0]])
    p = problem(M, K, C, [[1], [0]], 0.3, mu_s=0.9, mu_k=0.4)
    coarse, fine = (run(p, [0.5, -1.0], [0.0, 0.2], 40.0, rtol, nodes=s) for rtol, s in ((1e-8, 7), (1e-11, 9)))
    t = np.linspace(0.0, 40.0, 333)
    a, b = coarse.sample(t), fine.sample(t)
    assert len(fine.transitions.t) == 3
    assert coarse.transitions.t == pytest.approx(fine.transitions.t, abs=1e-7)
    assert np.abs(a.q - b.q).max() <= 1e-7
    total, kinetic = energy(p, b)
    assert np.ptp(total) <= 1e-8 * kinetic.max()
    # accelerations by differences satisfy the equations of motion
    h = 1e-4
    x = fine.sample(np.array([10.0 - h, 10.0, 10.0 + h]))
    a = (x.v[:, 2] - x.v[:, 0]) / (2.0 * h)
    assert M @ a + C @ x.v[:, 1] + K @ x.q[:, 1] == pytest.approx([x.F[0, 1], 0.0], abs=1e-5)


def test_goes_on_from_its_end():
    whole = run_brake("2", 1e-9, t_end=60.0)
    first = run_brake("2", 1e-9, t_end=33.3)
    second = Collocation().integrate(first.problem, first.end, 60.0, tolerance=Tolerance(rtol=1e-9))
    assert second.end.q == pytest.approx(whole.end.q, abs=1e-7)
    joined = np.concatenate([first.transitions.t, second.transitions.t])
    assert joined == pytest.approx(whole.transitions.t, abs=1e-7)


def test_rows_hold_both_sides_of_transitions():
    trajectory = run_brake("2", 1e-8, t_end=20.0)
    t = trajectory.t
    assert t[0] == 0.0
    assert t[-1] == 20.0
    assert np.all(np.diff(t) >= 0.0)
    rows = trajectory.rows()
    for event in trajectory.transitions.t:
        (at,) = np.nonzero(t == event)
        assert len(at) == 2
        assert rows.mode[0, at[0]] != rows.mode[0, at[1]]
        assert rows.q[:, at[0]] == pytest.approx(rows.q[:, at[1]], abs=1e-9)


def test_refuses_what_it_cannot_run():
    p = brake("2")
    assert Collocation().refuses(p) is None
    # a critically damped pair, coupled: a double pole with one vector
    C, K = [[2.0, 1.0], [0.0, 2.0]], [[1.0, 0.0], [0.0, 1.0]]
    assert "multiple poles" in Collocation().refuses(problem(np.eye(2), K, C, [[1], [0]]))


@pytest.mark.parametrize("seed", range(24))
def test_any_structure_at_two_tolerances(seed):
    # undamped, modal, general and strong damping; D not a multiple of I; mu_s > mu_k; belts
    rng = np.random.default_rng(seed)
    n = int(rng.integers(2, 5))
    m = int(rng.integers(1, 3))
    A, B, c = rng.normal(size=(n, n)), rng.normal(size=(n, n)), rng.normal(size=(n, 1))
    M, K = A @ A.T / n + 0.5 * np.eye(n), B @ B.T * rng.choice([0.3, 3.0, 30.0])
    C = [np.zeros((n, n)), 0.02 * K, 0.3 * c @ c.T, 30.0 * c @ c.T][seed % 4]
    p = problem(M, K, C, rng.normal(size=(n, m)), rng.choice([0.0, 0.1, 1.0]), mu_s=rng.choice([1.0, 1.4]), N=1.0)
    assert Collocation().refuses(p) is None
    q, v = rng.normal(size=n), rng.normal(size=n)
    loose, tight = (run(p, q, v, 30.0, rtol) for rtol in (1e-6, 1e-10))
    t = np.linspace(0.0, 30.0, 301)
    a, b = loose.sample(t), tight.sample(t)
    assert loose.failure is None
    assert tight.failure is None
    assert len(loose.transitions.t) == len(tight.transitions.t)
    assert np.abs(a.v - b.v).max() <= 1e-4 * np.abs(b.v).max()
    assert np.abs(a.q - b.q).max() <= 1e-4 * np.abs(b.q).max()
    total, kinetic = energy(p, b)
    assert np.ptp(total) <= 1e-7 * max(kinetic.max(), np.abs(b.input).max())


def test_run_pickles_without_its_problem():
    import pickle

    trajectory = run_brake("2", 1e-7, t_end=10.0)
    t = np.linspace(0.0, 10.0, 21)
    before = trajectory.sample(t)
    again = pickle.loads(pickle.dumps(trajectory))
    again.attach(brake("2"))
    assert np.array_equal(again.sample(t).q, before.q)


@pytest.mark.parametrize("nodes", [4, 5, 6, 7, 8, 9])
def test_any_number_of_nodes(nodes):
    ref = reference.load("p1_2")
    trajectory = run_brake("2", 1e-7, nodes=nodes)
    assert len(trajectory.transitions.t) == len(ref["t_event"])
    assert worst_error(ref, trajectory.sample(ref["t"])) <= 1e-5


def by_phases(M, K, C, w, N, mu_s, q, v, t_end):
    """The first mass on a belt of speed w, phase by phase with SciPy: state at the end, times of transitions."""
    n = len(q)
    y, t, times = np.concatenate([q, v]), 0.0, []
    stuck, side = False, np.sign(v[0] - w)

    def free(y):
        return -(K @ y[:n] + C @ y[n:])

    def rate(t, y):
        force = free(y)
        force[0] = 0.0 if stuck else force[0] - side * N
        return np.concatenate([y[n:], force / M])

    def changes(t, y):
        return mu_s * N - abs(free(y)[0]) if stuck else (y[n] - w) * side

    changes.terminal, changes.direction = True, -1.0
    while t < t_end:
        found = solve_ivp(rate, (t, t_end), y, method="DOP853", rtol=1e-12, atol=1e-13, events=changes)
        t, y = found.t[-1], found.y[:, -1].copy()
        if found.status == 0:
            break
        times.append(t)
        if stuck:
            side, stuck = np.sign(free(y)[0]), False
        else:
            y[n] = w
            stuck = abs(free(y)[0]) <= mu_s * N
            side = np.sign(free(y)[0])
    return y, np.array(times)


@pytest.mark.parametrize("nodes", [4, 5, 6, 7, 8, 9])
@pytest.mark.parametrize("n", [3, 8, 9, 17])
def test_a_contact_on_many_masses_moves_as_by_another_method(n, nodes):
    # numbers of masses and of nodes that do and do not fill the rows of tables
    rng = np.random.default_rng(100 * n + nodes)
    M, w, N, mu_s, t_end = rng.uniform(0.5, 2.0, n), 0.5, 1.0, 1.4, 20.0
    k = rng.uniform(1.0, 3.0, n)
    K = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    C = 0.001 * K
    q, v = rng.normal(0.0, 0.5, n), rng.normal(0.0, 0.5, n)
    W = np.zeros((n, 1))
    W[0] = 1.0
    y, times = by_phases(M, K, C, w, N, mu_s, q, v, t_end)
    assert len(times) >= 2
    made = run(problem(np.diag(M), K, C, W, w=w, mu_s=mu_s, mu_k=1.0, N=N), q, v, t_end, 1e-8, nodes=nodes)
    assert made.failure is None
    assert len(made.transitions.t) == len(times)
    assert np.abs(made.transitions.t - times).max() <= 1e-6
    end = made.sample([t_end])
    assert np.abs(end.q[:, 0] - y[:n]).max() <= 1e-7
    assert np.abs(end.v[:, 0] - y[n:]).max() <= 1e-7


@pytest.mark.parametrize("options", [{"nodes": 3}, {"nodes": 10}, {"safety": 0.0}])
def test_options_that_cannot_be(options):
    with pytest.raises(SceneError, match=next(iter(options))):
        Collocation(**options)


@pytest.mark.parametrize("scale", [1e-9, 1e-3, 1.0, 1e4, 1e9])
def test_without_springs_steps_know_no_unit_of_time(scale):
    # a puck on the plane under friction alone: straight to rest at t = |v|/(mu g), whatever a second is
    p = problem(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), np.eye(2), N=1.0)
    trajectory = run(p, [0.0, 0.0], [3.0 * scale, 4.0 * scale], 6.0 * scale, 1e-6)
    assert trajectory.transitions.t == pytest.approx([5.0 * scale], rel=1e-12)
    assert trajectory.counters.n_steps < 10
    samples = trajectory.sample(np.array([2.0 * scale, 6.0 * scale]))
    assert samples.q / scale**2 == pytest.approx(np.array([[4.8, 7.5], [6.4, 10.0]]), rel=1e-12)


@pytest.mark.parametrize("scale", [1e-9, 1e-4, 1e9])
def test_the_belt_in_any_unit_of_time(scale):
    # x'' + x/scale^2: the same motion, stretched
    start, speed = [1.0], 0.2 / scale
    p = problem([[1]], [[1 / scale**2]], [[0]], [[1]], speed, mu_k=0.5, N=1 / scale**2)
    trajectory = run(p, start, [speed], 100.0 * scale, 1e-10)
    t = trajectory.transitions.t[trajectory.transitions.kind == 1]
    period = 2.0 * (np.pi - np.arctan(0.5 / 0.2)) + 2.0 * 0.5 / 0.2
    assert len(t) == 12
    assert np.diff(t) / scale == pytest.approx(period, rel=1e-9)
    assert trajectory.counters.n_steps < 200


def test_a_load_that_rises_slowly_breaks_a_free_body_loose_in_any_unit():
    # no spring, no mode: the load alone knows the time
    for scale in (1e-9, 1.0, 1e9):
        body = fm.Body("m", mass=1.0)
        force = fm.Force("f", body, axis="x", value=fm.t / scale**3)
        sole = fm.Contact("c", body, law=fm.laws.Coulomb(mu_s=2.0, mu_k=1.0), normal_force=1.0 / scale**2)
        sol = fm.simulate(fm.Scene("pulled", [body, force, sole]), t_end=3.0 * scale)
        assert [event.kind for event in sol.events] == ["slip"]
        assert sol.events[0].t == pytest.approx(2.0 * scale, rel=1e-9)
        # x'' = t - 1 from t = 2
        assert sol["m.x"][-1] == pytest.approx(1.0 / 2 + 1.0 / 6, rel=1e-9)
        assert sol.stats.n_steps < 100


def test_steps_do_not_follow_a_stiff_mode_that_is_damped_out():
    # two halves of a mass tied by a stiff damped spring: the free oscillator, at rest after 14 half cycles, but for
    # what the tie does at every turn of the friction (1.8446/sqrt(K) in all: Radau at 1e-10 where K = 1e8)
    one, two = (fm.Body(name, mass=0.5, position={"x": 2.7183}) for name in ("one", "two"))
    soft = fm.Spring("soft", one, axis="x", stiffness=1.0)
    tie = fm.Spring("tie", one, two, axis="x", stiffness=1e10)
    calm = fm.Damper("calm", one, two, axis="x", damping=0.5e5)
    sole = fm.Contact("sole", two, law=fm.laws.Coulomb(mu_s=1.0), normal_force=0.1)
    scene = fm.Scene("stiff pair", [one, two, soft, tie, calm, sole])
    sol = fm.simulate(scene, t_end=50.0, rtol=1e-8)
    assert sol.stats.method == "radau"
    assert sol.stats.n_steps < 300
    assert sol.events[-1].t == pytest.approx(14 * np.pi - 1.8446e-5, abs=1e-5)
    assert sol.q[:, -1] == pytest.approx(2.7183 - 2.8, abs=1e-5)


def test_samples_anywhere_know_the_energies():
    # of many times within one long stick, in any order, as of each alone
    trajectory = run_brake("5", 1e-8, t_end=100.0)
    t = np.linspace(0.0, 100.0, 501)
    shuffled = np.random.default_rng(1).permutation(t)
    together, alone = trajectory.sample(shuffled), [trajectory.sample(t[i : i + 1]) for i in range(0, 501, 25)]
    order = np.argsort(shuffled)
    for name in ("damping_loss", "input"):
        values = getattr(together, name)[order]
        assert values[::25] == pytest.approx([getattr(x, name)[0] for x in alone], rel=1e-12)
    assert np.diff(together.damping_loss[order]).min() >= 0.0
