"""The values of many runs are checked before the first, by their ranges, and nothing wrong slips through."""

import itertools
from dataclasses import dataclass

import numpy as np
import pytest

import fricmb as fm
from fricmb._sweep import _check, _sweep
from fricmb._sweep._check import check_runs


@dataclass(frozen=True, kw_only=True)
class NotBetween(fm.FrictionLaw):
    """A law of one's own that refuses what lies between values that it accepts."""

    mu: float

    def define_coefficient(self, r):
        return self.mu

    def validate(self):
        if 0.4 < self.mu < 0.6:
            raise fm.LawError("NotBetween: mu must not lie between 0.4 and 0.6")


def rubbing(law=None, stiffness=1.0):
    mass = fm.Body("mass", mass=1.0)
    belt = fm.Driven("belt", velocity={"x": 0.1})
    law = law or fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    contact = fm.Contact("floor", mass, belt, law=law, normal_force=1.0)
    return fm.Scene("s", [mass, belt, fm.Spring("k", mass, axis="x", stiffness=stiffness), contact])


def varied(name, low, high, n=1000, **others):
    return [{name: float(x), **others} for x in np.linspace(low, high, n)]


@pytest.fixture
def checks(monkeypatch):
    """How many runs are checked one by one."""
    made = []
    whole = _check.check_values
    monkeypatch.setattr(_check, "check_values", lambda scene, run: made.append(run) or whole(scene, run))
    return made


def test_ranges_are_checked_at_their_corners(checks):
    runs = [
        {"k.stiffness": float(k), "belt.velocity.x": np.float64(k - 5.0), "mass.mass": 1 + i, "floor.law.mu_s": 0.5 + k}
        for i, k in enumerate(np.linspace(1.0, 9.0, 1000))
    ]
    check_runs(rubbing(), runs, False)
    assert checks == []


@pytest.mark.parametrize(
    ("runs", "match"),
    [
        (varied("mass.mass", -1.0, 3.0), "mass.*mass must be"),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stiffness": float("nan")}], "stiffness must be"),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stiffness": float("inf")}], "stiffness must be"),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stiffness": "soft"}], "stiffness must be"),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stifness": 1.0}], "did you mean .k.stiffness."),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stiffness": None}], "stiffness must be"),
        ([*varied("k.stiffness", 1.0, 3.0), {7: 1.0}], "unknown parameter"),
        (varied("N0", 1.0, 3.0), "unknown parameter"),
        (varied("floor.law.mu_k", 0.1, 0.9), "mu_k"),
        (varied("k.stiffness", 1.0, 3.0, axis=1.0), "unknown parameter"),
        ([*varied("k.stiffness", 1.0, 3.0), {"k.stiffness": 10**400}], "stiffness must be"),
    ],
)
def test_what_is_wrong_in_one_run_is_told(runs, match):
    with pytest.raises(fm.FricmbError, match=match):
        check_runs(rubbing(), runs, False)


def test_values_that_fit_only_together_are_checked_run_by_run(checks):
    """The corners of the range are not all accepted, each of the runs is."""
    runs = [{"floor.law.mu_s": float(m), "floor.law.mu_k": float(0.9 * m)} for m in np.linspace(0.1, 0.9, 500)]
    check_runs(rubbing(), runs, False)
    assert len(checks) == 500
    with pytest.raises(fm.FricmbError, match="mu_k"):
        check_runs(rubbing(), [*runs, {"floor.law.mu_s": 0.2, "floor.law.mu_k": 0.4}], False)


def test_laws_of_ones_own_are_checked_run_by_run():
    with pytest.raises(fm.LawError, match="must not lie between"):
        check_runs(rubbing(NotBetween(mu=0.1)), varied("floor.law.mu", 0.1, 0.9), False)


def test_named_parameters_are_checked_once_for_each_value(checks):
    scene = rubbing(stiffness=fm.parameter("k0", 1.0))
    runs = [{"k0": float(i % 7), "belt.velocity.x": 0.1 * i} for i in range(700)]
    check_runs(scene, runs, False)
    assert len(checks) == 7


def test_a_hundred_thousand_runs_are_checked_without_a_scene_for_each(monkeypatch):
    """386 s passed before the first of a million runs."""
    monkeypatch.setattr(_sweep, "outcomes", lambda *_: iter(()))
    monkeypatch.setattr(fm.Scene, "_with_parts", lambda *_: pytest.fail("a scene was made"))
    found = fm.sweep(rubbing(), varied("belt.velocity.x", 0.1, 1.0, 100_000), t_end=1.0, progress=False)
    assert len(found) == 100_000


def test_a_bar_is_shown_where_they_are_checked_one_by_one(monkeypatch, capsys):
    monkeypatch.setattr(_check, "MANY", 500)
    check_runs(rubbing(NotBetween(mu=0.1)), varied("floor.law.mu", 0.1, 0.3), True)
    assert "checks" in capsys.readouterr().err


def accepted(law, values):
    try:
        law.with_slots(values)
    except fm.FricmbError:
        return False
    return True


@pytest.mark.parametrize("name", fm.laws.names)
def test_what_laws_accept_is_convex(name):
    """Of ranges whose corners are accepted all is: else a wrong value would be found by the run that has it."""
    rng = np.random.default_rng(len(name))
    law = getattr(fm.laws, name).example()
    slots = {path: value for path, value in law.slots().items() if type(value) is float}
    for _ in range(40):
        names = list(rng.permutation(list(slots))[: rng.integers(1, 4)])
        ends = [np.sort(rng.uniform(-1.0, 4.0, 2)) * (slots[path] or 1.0) for path in names]
        corners = itertools.product(*[_check._levels(tuple(map(float, sorted(pair)))) for pair in ends])
        if all(accepted(law, dict(zip(names, corner, strict=True))) for corner in corners):
            for share in rng.uniform(size=(10, len(names))):
                inside = {path: float(a + s * (b - a)) for path, (a, b), s in zip(names, ends, share, strict=True)}
                assert accepted(law, inside), (names, ends, inside)


MODELS = (
    "brake4dof", "stick_slip_chain", "pad_rotor", "slider_crank", "four_bar", "drive_train", "dry_pendulum",
    "heavy_top", "wheelset", "wobbling_disc_brake", "car_axis",
)  # fmt: skip


@pytest.mark.parametrize("name", MODELS)
def test_what_parts_accept_is_convex(name):
    rng = np.random.default_rng(len(name))
    scene = fm.models.catalogue[name].build()
    for path, value in scene.parameters.items():
        if type(value) is not float or "." not in path:
            continue
        for _ in range(3):
            low, high = map(float, np.sort(rng.uniform(-1.0, 4.0, 2) * (value or 1.0)))
            runs = [{path: x} for x in (low, high, *map(float, rng.uniform(low, high, 4)))]
            if _check._is_good_range(scene, runs, [path]):
                for run in runs:
                    scene.with_parameters(run)
