"""The oracle finds excursions by itself: inputs over the cone for a moment, against closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from tests.oracle.inputs import FORMS, HOLD, LAWS, Input, Shaken, case_of, numbers, shaken
from tests.oracle.judge import judge, truth
from tests.oracle.run import solve

MU = LAWS["Coulomb"]["mu_k"]


def on(form, values, *, t_end=20.0, constant=0.5, size=0.0, samples=()):
    """A block at rest on dry ground under a load."""
    given = Input(form, list(values), list(samples))
    return Shaken("block", "Coulomb", "load", given, t_end, constant, size, [0.0])


def by_hand(spec, starts):
    """Transitions of the block: it lets go where the load passes what holds, and stops where its impulse is used up."""
    value, _ = spec.input.numeric()
    load = lambda t: spec.constant * HOLD + spec.size * value(t)  # noqa: E731
    events = []
    for low, high, until in starts:
        t = brentq(lambda s: load(s) - HOLD, low, high, xtol=1e-15)
        speed = lambda s, t=t, high=high: quad(lambda x: load(x) - MU, t, s, points=[min(high, s)], epsabs=1e-13)[0]  # noqa: E731
        stop = brentq(speed, high, until, xtol=1e-13)
        events += [("slip", t), ("stick", stop)]
    return events


def test_crests_over_hundreds_of_periods():
    omega, share = 50.0, 0.4
    spec = on("fast", [omega, 0.0], constant=1.0 - share, size=round(1.02 * share * HOLD, 6))
    period = 2.0 * np.pi / omega
    crests = [(k + 0.25) * period for k in range(int(20.0 / period))]
    found = solve(numbers(spec)).events
    expected = by_hand(spec, [(c - 0.2 * period, c, c + 0.9 * period) for c in crests])
    assert len(expected) == 2 * 159
    assert [e.kind for e in found] == [kind for kind, _ in expected]
    assert [e.t for e in found] == pytest.approx([t for _, t in expected], abs=1e-8)


@pytest.mark.parametrize("over", [-1e-4, 1e-4])
def test_crests_just_below_and_just_over_the_cone(over):
    spec = on("fast", [50.0, 0.0], constant=0.6, size=round((0.4 + over) * HOLD, 9))
    assert (len(solve(numbers(spec)).events) > 0) == (over > 0.0)


def test_crests_that_pass_the_cone_late():
    """A drift of 0.1 brings crests of 0.9 over the cone after more than a hundred periods."""
    t_end, omega = 60.0, 20.0
    spec = on("drift", [omega, 0.0, t_end, 0.1], t_end=t_end, constant=0.5, size=round(0.51 * HOLD, 6))
    period = 2.0 * np.pi / omega
    load = lambda t: 0.5 * HOLD + spec.size * spec.input.numeric()[0](t)  # noqa: E731
    crests = [c for c in (np.arange(191) + 0.25) * period if load(c) > HOLD]
    found = solve(numbers(spec)).events
    assert crests[0] > 45.0
    expected = by_hand(spec, [(c - 0.2 * period, c, c + 0.9 * period) for c in crests])
    assert [e.kind for e in found] == [kind for kind, _ in expected]
    assert [e.t for e in found] == pytest.approx([t for _, t in expected], abs=1e-7)


@pytest.mark.parametrize("width", [1e-1, 1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("form", ["bell", "triangle"])
def test_a_pulse_of_a_part_of_the_run(form, width):
    spec = on(form, [10.0, 20.0 * width], size=round(HOLD * 0.4 / width, 6))
    far = min(5.0 * 20.0 * width, 9.0)
    expected = by_hand(spec, [(10.0 - far, 10.0, 1e3)])
    found = [(e.kind, e.t) for e in solve(numbers(spec)).events]
    expected = [(kind, t) for kind, t in expected if t < 20.0]
    assert [kind for kind, _ in found] == [kind for kind, _ in expected]
    assert [t for _, t in found] == pytest.approx([t for _, t in expected], abs=1e-6)


def test_seeds_hold_every_input_place_body_and_law():
    made = [shaken(np.random.default_rng([seed, 1])) for seed in range(300)]
    assert {spec.input.form for spec in made} == set(FORMS)
    assert {spec.law for spec in made} == set(LAWS)
    assert len({(spec.place, spec.body) for spec in made}) == 16


@pytest.mark.parametrize("form", ["fast", "bell", "noise"])
def test_what_the_oracle_finds_fricmb_finds(form):
    rng = np.random.default_rng(8)
    samples = rng.uniform(-1.0, 1.0, 60).round(4).tolist() if form == "noise" else ()
    values = {"fast": [50.0, 0.3], "bell": [9.0, 0.01], "noise": [20.0]}[form]
    spec = on(form, values, size=20.0 if form == "bell" else 0.36, samples=samples)
    true = truth(case_of(spec))
    assert not true.marginal
    assert judge(true, "auto").kind == "right"
