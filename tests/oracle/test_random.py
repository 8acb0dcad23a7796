"""One scene of each kind from a seed, by every method that takes it; ``python -m tests.oracle`` tries many."""

import math
import os
import re
import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numba import njit
from numba.core import event

from tests.oracle.campaign import make
from tests.oracle.judge import CompileClock, Worker, attempt, judge, seen, truth
from tests.oracle.motion import Field
from tests.oracle.problem import SLIP
from tests.oracle.random_scenes import KINDS, generate
from tests.oracle.run import solve
from tests.oracle.shrink import BAD, smaller
from tests.oracle.space import Bodies, Link
from tests.oracle.spec import Spec, case_of, from_data
from tests.oracle.table import METHODS

#: Of each kind the seed of one scene that every method that takes it gets right today.
SEEDS = {
    "line": 0, "shaken": 0, "guided": 1, "plane": 0, "stack": 3, "modes": 0, "chain": 0, "tree": 8, "roller": 26,
    "inputs": 1,
}  # fmt: skip


#: Scenes that a longer run found wrong once, and what was wrong.
FOUND = {
    ("chain", 1001): "a pin that had stuck let go where another one's reversal did not ask for it",
    ("chain", 30079): "a pin that turns round and back within 5 ms, between the stages of a step",
    ("modes", 1001): "exact structure: slip and stick in turn within round-off of the time at a break-away",
    ("plane", 3001): "exact structure: slip that turns round beside rest was taken to end there",
    ("line", 3006): "exact structure: no step without a scale where springs alone are held by a varying normal force",
    ("inputs", 13): "Taylor steps: modes that stand still let go and stuck where a load bends, by round-off",
    ("inputs", 500094): "the place of ground that moves as a bell was summed to more digits than a sum has: a minute",
    ("line", 150502): "exact structure: slip that a step left between its nodes was taken for a belt that has jumped",
    ("modes", 31027): "slip that begins without a jump of its acceleration ended, and began again, 2e-12 later",
    ("modes", 31387): "the same where two contacts rub",
    ("roller", 206): "a load passed through 0, and round-off of its friction was taken for slip that turns round",
    ("roller", 120004): "slip that sets out under falling friction: growth that was over within one step",
    ("guided", 750013): "velocities no longer changed in Newton's method, but a force that tells its direction did",
    ("excursions", 750010): "slip that begins without acceleration was taken to end at once",
    ("feet", 770012): "two feet that let go together, and hold again, within a step: their shares passed for round-off",
    ("drives", 750044): "a lossy gear that holds did not let go where its load passes through 0 between stages",
    ("tree", 750018): "the oracle's own: slip without a load but round-off was told to turn round",
    ("stack", 3005): "Taylor steps: plates went with a belt whose velocity jumps",
}


@pytest.mark.parametrize(("kind", "seed"), [*SEEDS.items(), *FOUND])
def test_scene_moves_as_the_oracle_says(kind, seed):
    spec = generate(kind, seed)
    true = truth(make({}, spec))
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in METHODS}
    assert verdicts["auto"].kind == "right"
    assert {method: verdict for method, verdict in verdicts.items() if verdict.kind in BAD} == {}


@pytest.mark.parametrize(("kind", "seed"), [("stack", 10014), ("chain", 10003)])
def test_what_was_released_first_holds_where_it_can(kind, seed):
    """One comes to rest and cannot be held beside another that has rested; with that one gone it can."""
    spec = generate(kind, seed)
    true = truth(make({}, spec))
    assert not true.marginal
    verdicts = {method: judge(true, method) for method in METHODS}
    assert verdicts["auto"].kind == "right"
    assert {method: verdict for method, verdict in verdicts.items() if verdict.kind in BAD} == {}


def test_body_falls_from_rest_on_a_large_dry_ball():
    """The load of the joint is a third of what it was as soon as it slips."""
    start = {"start": [0.24, -0.3, 0.21], "rates": [0.0, 0.0, 0.0], "own": (-0.3, -0.27, 0.27)}
    law = {"law": "Coulomb", "fields": {"mu_s": 0.75}, "radius": 0.28}
    link = Link("spherical", 0.8, (0.04, 0.016, 0.042), **start, **law)
    true = truth(make({}, Bodies("tree", [link], 0.1)))
    assert {method: judge(true, method).kind for method in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}


def test_sleeve_slides_that_is_nearly_jammed_by_its_own_friction():
    """The load grows by 0.77 of what friction grows: iterations that know nothing of that do not get done."""
    sleeve = Link(
        "cylindrical", 0.7, (0.0643, 0.0874, 0.0449), [-0.44, -0.24, 0.52], [-0.85, 1.98], own=(0.3, -0.3, -0.02),
        axis=(0.0, 0.6, -0.8), law="Coulomb", fields={"mu_s": 0.39}, radius=0.09, length=0.31,
    )  # fmt: skip
    true = truth(make({}, Bodies("tree", [sleeve], 0.1)))
    assert {method: judge(true, method).kind for method in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}


def test_shares_of_a_load_that_jump_within_a_step_leave_no_cone():
    """Redundant contacts that hold a load share it anew once one of them is at its limit, before any of them gives."""
    true = truth(case_of(generate("loop", 31245)))
    assert not true.marginal
    assert {method: judge(true, method).kind for method in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}


@pytest.mark.parametrize("seed", [30176, 20012])
def test_equations_of_a_step_that_are_solved_to_the_last_digit_are_solved(seed):
    """A correction of exactly 0 says that the iteration is over: its rate, 0 / 0, once said that it never is."""
    true = truth(case_of(generate("stack", seed)))
    assert not true.marginal
    assert {method: judge(true, method).kind for method in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}


@pytest.mark.parametrize("kind", [kind for kind in KINDS if isinstance(generate(kind, 5), Spec)])
def test_a_seed_gives_one_scene_and_its_data_give_it_back(kind):
    spec = generate(kind, 5)
    assert spec == generate(kind, 5)
    assert spec != generate(kind, 6)
    assert from_data(spec.data()) == spec
    for other in smaller(spec):
        case_of(other)  # what shrinking tries can be built


def test_a_wrong_run_is_seen():
    """The same motion by a friction 1 % too large is not right."""
    spec = generate("line", 0)
    true = truth(case_of(spec))
    spec.touches[0].N *= 1.01
    verdict = judge(replace(true, case=case_of(spec)), "radau")
    assert verdict.kind in BAD
    assert verdict.ratio > 100.0


def test_what_a_run_compiles_is_not_counted_against_its_limit():
    worker = Worker()
    worker.process = SimpleNamespace(pid=os.getpid())
    worker.compiling = [0.0, 0.0]
    assert worker.spent() == 0.0  # what the process is loaded with
    clock = CompileClock(worker.compiling)
    before, begin = worker.spent(), time.process_time()
    event.register("numba:compiler_lock", clock)
    try:
        for i in range(1, 6):
            assert njit(lambda x: x + math.sin(x))(np.zeros(i)[0] + 0.0) == 0.0
    finally:
        event.unregister("numba:compiler_lock", clock)
    took = time.process_time() - begin
    assert took > 0.05
    assert worker.spent() - before < 0.5 * took + 0.02  # that clock has steps of 0.01


def test_friction_without_a_load_is_not_one_that_drives():
    """A sleeve along whose line all forces lie carries nothing, and its friction is round-off.

    The motion is compared alone: how often slip without a load turns round is nothing that a run looks for.
    """
    verdict = judge(truth(make({}, generate("tree", 61007))), "auto")
    assert verdict.kind != "stopped"
    assert verdict.ratio < 100.0


@pytest.mark.parametrize("seed", [106, 120, 203])
def test_sleeve_that_jams_says_how_much_friction_it_bears(seed):
    """Its load N = f(mu N) is convex: there is a solution for the largest x / f(x) of its friction, and for less."""
    case = make({}, generate("tree", seed))
    p = case.problem
    field = Field(p, [SLIP], [1.0], (0.0, p.t_end))
    state = np.concatenate([p.q, p.v])

    def share(x):
        return x / field.loads(0.0, p.q, p.v, field.under(0.0, state, [x])[0])[0]

    most = max(share(x) for x in np.geomspace(1e-3, 1e8, 4000))
    assert most < 0.9
    found = attempt(case.scene, "radau", 1e-6, np.array([0.0, 0.01]), 0.01, case.signals)
    assert found.kind == "stopped"
    said = re.search(r"friction of 'j0' has no solution.* up to some (0\.\d\d) of", found.why)
    assert float(said[1]) == pytest.approx(most, abs=0.01)


def test_jammed_whatever_a_contact_at_rest_does():
    """A dry hinge at rest on a guide that jams: held, or let go to either side, there is no solution."""
    case = make({}, generate("tree", 136))
    found = attempt(case.scene, "radau", 1e-6, np.array([0.0, 0.01]), 0.01, case.signals)
    assert "no combination of stick and slip" in found.why
    assert "(at rest: 'j1'); for 3 of them no forces of friction were found" in found.why


def test_what_sticks_slips_no_more_where_a_step_has_ended():
    """A dry hinge holds while what hangs on it swings: positions are moved onto joints, and velocities would slip."""
    spec = generate("tree", 213)
    spec.t_end = 0.32
    true = truth(make({}, spec))
    assert not true.marginal
    assert {method: judge(true, method).kind for method in ("bdf", "radau")} == {"bdf": "right", "radau": "right"}


def test_two_ball_joints_set_out_at_once():
    """Against friction that is almost the same for any slip: it comes nearer as the slip needed for all of it falls."""
    case = make({}, generate("tree", 168))
    t = np.array([0.05, 0.1])
    runs = [attempt(case.scene, method, 1e-9, t, 0.1, case.signals) for method in ("bdf", "radau")]

    def smooth(contact, least):
        def force(g, N, z):
            r = math.sqrt(g @ g + least**2)
            return -contact.mu(r, N) * N * g / r

        return replace(contact, force=force)

    for least in (1e-3, 1e-4):
        contacts = tuple(smooth(c, least) for c in case.problem.contacts)
        q, v = seen(case, t, solve(replace(case.problem, contacts=contacts, t_end=0.1), 1e-8)(t))
        for run in runs:
            assert np.abs(run.q - q).max() < 0.2 * least
            assert np.abs(run.v - v).max() < 2.0 * least


def test_margin_that_jumps_because_another_one_goes():
    """Of two joints that slip one alone loses its single solution: what has fallen to 0 is said, not 0.19."""
    case = make({}, generate("tree", 377))
    found = attempt(case.scene, "radau", 1e-6, np.array([0.0, 0.17]), 0.17, case.signals)
    words = r"friction of 'j0', 'j1' together has no single solution: a principal minor .* is (\S+), and"
    said = re.search(words, found.why)
    assert abs(float(said[1])) < 1e-6
