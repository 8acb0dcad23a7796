"""The program for impacts against closed forms, and scenes by every method that takes them against it."""

import math

import numpy as np
import pytest

import fricmb as fm
from tests.oracle.bounces import bounced
from tests.oracle.campaign import make
from tests.oracle.impacts import flat, pendulum, table
from tests.oracle.judge import judge
from tests.oracle.random_scenes import generate
from tests.oracle.struck import Struck, Surface

METHODS = ("auto", "radau", "bdf")

#: One of each situation that all methods get right.
SEEDS = {"blocks": 10, "table": 4, "thrown": 14, "pendulum": 11, "gears": 7}

#: Scenes that were wrong once, and what was wrong.
FOUND = {
    44: "a ball in flight was taken to rest with another that falls beside it, as nothing accelerates between them",
    60: "the same where both are thrown up",
    177: "the same on a table that moves on",
    12: "corners in turn: rest of one of them between two impacts of the other",
    810052: "a block that a stop and dry friction hold at once: their shares grew from step to step until it stopped",
    2044: "corners that come to rest in turn: one was pulled down, the other one fell through the floor",
}


def test_a_ball_rests_when_the_series_of_its_bounces_says_so():
    g, e, h = 9.81, 0.8, 1.0
    floor = flat("floor", np.ones(1), 0.0, e)
    ball = Struck(
        M=np.eye(1), force=lambda t, q, v: np.array([-g]), q=np.array([h]), v=np.zeros(1), t_end=5.0, surfaces=(floor,)
    )
    found = bounced(ball)
    t0 = math.sqrt(2 * h / g)
    first = [t0 * (1 + 2 * sum(e**j for j in range(1, k + 1))) for k in range(10)]
    assert np.allclose([hit.t for hit in found.impacts[:10]], first, rtol=0, atol=1e-12)
    ((t, name),) = found.rests
    assert name == "floor"
    assert abs(t - t0 * (1 + e) / (1 - e)) < 1e-10
    assert np.abs(found(np.array([4.9]))).max() < 1e-9


def test_a_ball_keeps_the_period_of_its_table():
    A, w, phase, v, period = 0.001, 100.0, 1.221290450550073, 0.3081902393171587, 0.06283185307179586

    def moves(t):
        s, c = math.sin(w * t + phase), math.cos(w * t + phase)
        return A * s, A * w * c, -A * w * w * s

    ball = Struck(
        M=np.eye(1), force=lambda t, q, v: np.array([-9.81]), q=np.array([A * math.sin(phase)]), v=np.array([v]),
        t_end=10.5 * period, surfaces=(flat("table", np.ones(1), 0.0, 0.8, moves=moves),), longest=0.003,
    )  # fmt: skip
    assert np.allclose([hit.t for hit in bounced(ball).impacts], period * np.arange(1, 11), rtol=0, atol=1e-9)


def test_backspin_is_taken_by_friction_in_impacts():
    m, R, mu = 0.2, 0.1, 0.08
    along = np.array([1.0, 0.0, R])
    floor = Surface(
        name="floor", gap=lambda q: q[1] - R, row=lambda q: np.array([0.0, 1.0, 0.0]), e=0.7, mu_s=mu, mu_k=mu,
        along=lambda q: along,
    )  # fmt: skip
    ball = Struck(
        M=np.diag([m, m, 0.4 * m * R * R]), force=lambda t, q, v: np.array([0.0, -9.81 * m, 0.0]),
        q=np.array([0.0, 1.0 + R, 0.0]), v=np.array([2.0, 0.0, -50.0]), t_end=3.0, surfaces=(floor,),
    )  # fmt: skip
    found = bounced(ball)
    vx, w = found(np.array([0.5]))[[3, 5], 0]
    assert abs(vx - 2.602404780857523) < 1e-11
    assert abs(w + 34.93988047856193) < 1e-10
    assert abs(found.rests[0][0] - 2.558633965585808) < 1e-10
    end = found(np.array([3.0]))[:, 0]
    assert abs(end[0] - 8.023379938543639) < 1e-9
    assert abs(end[5] + 28.57142857142857) < 1e-9


def test_a_pendulum_with_dry_friction_rests_on_its_stop():
    """Hops shrink by another ratio than e, since friction turns round in each; values by quadratures in 40 digits."""
    phs, at = 0.3, 1.4
    stop = Surface(name="s", gap=lambda q: q[0] - phs, row=lambda q: np.ones(1), e=0.7)
    n = {
        "mass": 1.0, "half": 1.0, "inertia": 0.5, "dry": [0.9, 0.9], "stops": [0.0], "e": 0.7, "angle": at, "rate": 0.0,
        "t_end": 4.0,
    }  # fmt: skip
    p = pendulum(n).problem
    swing = Struck(
        M=p.M, force=lambda t, q, v: np.array([-9.81 * 1.5 * math.sin(q[0])]), q=p.q, v=p.v, t_end=4.0,
        surfaces=(stop,), dries=p.dries, longest=0.05,
    )  # fmt: skip
    found = bounced(swing)
    times = [0.5134969787921993, 1.339220508362074, 2.01714059296383, 2.526883944505081]
    speeds = [3.753524553395337, 2.348779648637492, 1.422750589395917, 0.8360195141302381]
    assert np.allclose([hit.t for hit in found.impacts[:4]], times, rtol=0, atol=1e-11)
    assert np.allclose([hit.approach for hit in found.impacts[:4]], speeds, rtol=0, atol=1e-11)
    assert abs(found.rests[0][0] - 3.358532583895605) < 1e-9


#: The same by Poisson's law.
POISSON = (5, 10, 14)

#: On tables that swing, with friction: a disc by Newton's law, a box by Poisson's.
CARRIED = (4, 6)


def test_what_is_far_away_does_not_rest_with_others():
    """Dry friction holds all blocks behind the last impact: no acceleration says how long a hop is there."""
    case = make({}, generate("poisson", 24))
    sol = fm.simulate(case.scene, t_end=1.0)
    assert {event.side for event in sol.events.of(kind="rest")} <= {"lower"}
    assert np.abs(sol["b0.x"]).max() < case.problem.surfaces[0].gap(np.zeros(3)) + 1e-9


@pytest.mark.parametrize(
    ("kind", "seed"),
    [
        *(("impacts", n) for n in (*SEEDS.values(), *FOUND)), *(("poisson", n) for n in POISSON),
        *(("carried", n) for n in CARRIED),
    ],
)
def test_impacts_are_as_the_oracle_says(kind, seed):
    true = make({}, generate(kind, seed)).truth()
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in METHODS}
    assert {method: verdict.kind for method, verdict in verdicts.items()} == dict.fromkeys(METHODS, "right"), verdicts


def test_each_situation_has_its_seed():
    assert {name: generate("impacts", seed).n["situation"] for name, seed in SEEDS.items()} == {n: n for n in SEEDS}


@pytest.mark.parametrize("change", [{"e": [0.24, 0.6049]}, {"A": 0.32}])
def test_another_coefficient_or_table_is_seen(change):
    given = generate("impacts", 44).n
    true = table(given).truth()
    other = table(given | change)
    true.case = type(other)(
        name="other", scene=other.scene, problem=true.case.problem, signals=other.signals
    )
    verdict = judge(true, "radau")
    assert verdict.kind in ("wrong", "noted")
    assert verdict.ratio > 100.0
