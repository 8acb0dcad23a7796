"""The stability report: regions against known numbers, and verdicts that can be bad."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import fricmb as fm
from fricmb.bench.stability import judge, scenes
from fricmb.bench.stability._axis import FAST, measure_axis, modes
from fricmb.bench.stability._contacts import pull_time, pulled, shake_phases
from fricmb.bench.stability._extreme import Extreme, same_times
from fricmb.bench.stability._grid import quick_scenes
from fricmb.bench.stability._regions import angle, axis_table, bdf_growth, radau_growth
from fricmb.bench.stability._report import grid_table
from fricmb.bench.stability._structures import belt_times


@pytest.mark.parametrize(("k", "alpha"), [(1, 90.0), (2, 90.0), (3, 86.03), (4, 73.35), (5, 51.84)])
def test_angles_of_bdf(k, alpha):
    """Hairer and Wanner, Solving ODEs II, table V.2.1."""
    assert angle(k) == pytest.approx(alpha, abs=0.006)


def test_radau_is_the_pade_approximation():
    """Two stages: R(z) = (1 + z/3) / (1 - 2 z/3 + z^2/6)."""
    z = np.array([0.3j, -2.0 + 1.0j, 5.0 + 0.0j])
    assert radau_growth(2, z) == pytest.approx(np.abs((1 + z / 3) / (1 - 2 * z / 3 + z * z / 6)), rel=1e-12)
    # L-stable whatever the number of stages
    assert all(radau_growth(s, np.array([-1e9 + 0j]))[0] < 1e-6 for s in range(2, 10))


def test_bdf_one_is_the_implicit_euler_method():
    z = np.array([0.5j, -3.0 + 0j, 4.0 + 1j])
    assert bdf_growth(1, z) == pytest.approx(np.abs(1 / (1 - z)), rel=1e-12)


def test_the_axis_shows_what_is_unstable():
    rows = {row["formula"]: row for row in axis_table()}
    stable = [name for name in rows if "Radau" in name or name in ("BDF 1", "BDF 2")]
    assert all(math.isnan(rows[name]["unstable from"]) for name in stable)
    # the regions of orders 3 to 5 cut the imaginary axis
    assert rows["BDF 3"]["to"] == pytest.approx(1.94, abs=0.03)
    assert rows["BDF 5"]["unstable from"] == pytest.approx(0.71, abs=0.03)


def test_closed_forms():
    """Each against its own equation."""
    start, end = shake_phases()
    assert 1.5 * math.sin(start) == pytest.approx(1.0)
    assert 1.5 * (math.cos(start) - math.cos(end)) == pytest.approx(end - start)
    assert start < end < start + math.pi
    # pulled at a right angle with half of the friction: by the equations of motion in polar form, in small steps
    r, phi, h, t = 1.0, 0.5 * math.pi, 1e-4, 0.0
    while r > 1e-6:
        half_r, half_phi = r + 0.5 * h * (0.5 * math.cos(phi) - 1.0), phi - 0.5 * h * 0.5 * math.sin(phi) / r
        r, phi = r + h * (0.5 * math.cos(half_phi) - 1.0), phi - h * 0.5 * math.sin(half_phi) / half_r
        t, h = t + h, min(1e-4, 0.05 * r)
    assert t == pytest.approx(pull_time(0.5, 0.5 * math.pi), abs=1e-3)
    assert belt_times(1.5, 2)[0] == pytest.approx([15.0, 28.536383773289554], abs=1e-12)


def test_names_are_unique():
    names = [scene.name for scene in scenes()]
    assert len(set(names)) == len(names) > 40


@pytest.mark.parametrize("scene", quick_scenes(), ids=lambda scene: scene.name)
def test_general_integrators_are_right_or_say_no(scene):
    for method in ("radau", "auto"):
        found = judge(scene, method)
        assert found["verdict"] in ("correct", "refused"), found


#: Scenes on which one of these was wrong without a word, or never came to an end: stiff springs beside large positions
#: and soft motion, a start far off stiff motion, a load of which a whole period lay within the first step.
MENDED = (
    "stiffness ratio: 1e+08", "stiffness ratio: 1e+10", "stiffness ratio: 1e+12", "damping over critical: 1e+09",
    "chatter: 400 transitions in 0.063",
)  # fmt: skip


@pytest.mark.parametrize("name", MENDED)
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_what_was_wrong_is_right(name, method):
    found = judge(next(scene for scene in scenes() if scene.name == name), method)
    assert found["verdict"] == "correct", found
    # steps follow the soft motion and the transitions, not round-off
    assert found["steps"] < 3000


def test_a_step_too_large_is_noted():
    scene = next(scene for scene in scenes() if scene.group == "step too large")
    found = judge(scene, "bdf2-paper")
    assert found["verdict"] == "noted", found
    assert "energy ledger" in found["why"]


SHORT = Extreme(
    group="pulled", value="half", build=partial(pulled, 0.5, 0.0), t_end=3.0,
    error=lambda sol: same_times(sol, np.array([2.0]), 2.0, "stick"), steps=(0.3,),
)  # fmt: skip


def test_verdicts_can_be_bad():
    assert judge(SHORT, "radau")["verdict"] == "correct"
    late = replace(SHORT, error=lambda sol: same_times(sol, np.array([2.1]), 2.0, "stick"))
    assert judge(late, "radau")["verdict"] == "wrong"
    assert judge(late, "radau")["error"] == pytest.approx(0.05)
    two = replace(SHORT, error=lambda sol: same_times(sol, np.array([1.0, 2.0]), 2.0, "stick"))
    assert (judge(two, "radau")["verdict"], judge(two, "radau")["error"]) == ("wrong", None)
    unknown = replace(SHORT, error=lambda sol: float("nan"))
    assert judge(unknown, "radau")["verdict"] == "wrong"


def test_refusals_are_no_faults():
    """A law that collocation does not take."""
    case = next(scene for scene in scenes() if scene.group == "chatter")
    methods = [name for name in fm.integrators if not fm.integrators[name].adaptive]
    assert judge(case, methods[0])["verdict"] == "refused"
    too_large = next(scene for scene in scenes() if scene.group == "step too large")
    assert judge(too_large, "radau")["verdict"] == "refused"


@pytest.mark.parametrize("stuck", [False, True])
def test_unresolved_vibration_does_not_grow(stuck):
    row = measure_axis("radau", stuck)
    assert "failure" not in row
    assert set(row["amplitude"]) == set(FAST)
    # what each had of its own, 1e-8, beside what follows the slow mass over ties of 1e-9
    assert all(amplitude < 1.5e-8 for amplitude in row["amplitude"].values())
    assert len(modes(stuck).dof_names) == len(FAST) + (2 if stuck else 1)


def test_the_table_shows_every_verdict():
    rows = [judge(SHORT, "radau"), {**judge(SHORT, "radau"), "method": "bdf", "verdict": "wrong"}]
    text = grid_table(rows)
    assert '<td class="bad">wrong</td>' in text
    assert '<td class="good">correct</td>' in text
