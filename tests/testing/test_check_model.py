"""Built-in models conform; each thing that authors get wrong is found and named."""

import itertools

import pytest

import fricmb as fm
from fricmb.models import catalogue
from fricmb.testing import ConformanceError, check_model
from fricmb.testing._model_run import Trip, run_findings


@pytest.mark.parametrize("name", catalogue)
def test_built_in_models_conform(name):
    check_model(catalogue[name].build, run=False)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "t_end"), [("belt_oscillator", 20.0), ("brake4dof", 70.0), ("puck_on_belt", 0.5)])
def test_built_in_models_run(name, t_end):
    check_model(catalogue[name].build, t_end=t_end)


def spring_and_block(*, mass=1.0, stiffness=2.0, x0=0.5, parts=()):
    block = fm.Body("block", mass=mass, position={"x": x0})
    return fm.Scene("own", [block, fm.Spring("spring", block, axis="x", stiffness=stiffness), *parts])


def needs(*, mass):
    return spring_and_block(mass=mass)


def parts_alone():
    return [fm.Body("block", mass=1.0)]


def twice():
    return spring_and_block(parts=[fm.Body("block", mass=1.0)])


calls = itertools.count(1)


def differs():
    return spring_and_block(mass=float(next(calls)))


def unused(*, mass=1.0, colour=0.5):
    return spring_and_block(mass=mass)


def plain_error(*, mass=1.0):
    if mass != mass:
        raise RuntimeError("no")
    return spring_and_block(mass=mass)


def anonymous(*, width=1.0):
    if width != width:
        raise fm.SceneError("that cannot be")
    return spring_and_block()


class Unfriendly(fm.Spring):
    """Stores what it likes."""

    def __post_init__(self):
        super().__post_init__()
        self._set("stiffness", 2.0)


def stubborn():
    block = fm.Body("block", mass=1.0)
    return fm.Scene("own", [block, Unfriendly("spring", block, axis="x", stiffness=2.0)])


class Underivable(fm.Spring):
    def define_potential(self, x):
        raise RuntimeError("no idea")


def underivable():
    block = fm.Body("block", mass=1.0)
    return fm.Scene("own", [block, Underivable("spring", block, axis="x", stiffness=2.0)])


def unpicklable():
    class Local(fm.Spring):
        pass

    block = fm.Body("block", mass=1.0)
    return fm.Scene("own", [block, Local("spring", block, axis="x", stiffness=2.0)])


@pytest.mark.parametrize(
    ("model", "named"),
    [
        (needs, "default arguments fail: TypeError"),
        (parts_alone, "must return a Scene"),
        (twice, "the name 'block' is used twice"),
        (differs, "two calls give two scenes, which differ in block"),
        (unused, "colour = nan is accepted"),
        (plain_error, "mass = nan is refused by RuntimeError, which is no SceneError"),
        (anonymous, "width = nan is refused, but neither it nor a part is named"),
        (stubborn, "the parameter spring.stiffness is set to 2.001953125, but is 2.0"),
        (underivable, "plan() fails: RuntimeError: no idea"),
        (underivable, "equations() fails: RuntimeError: no idea"),
        (unpicklable, "cannot be pickled"),
    ],
)
def test_wrong_models_are_named(model, named):
    with pytest.raises(ConformanceError) as caught:
        check_model(model, run=False)
    assert named in str(caught.value)
    assert str(caught.value).startswith(f"{model.__name__}: ")


def test_a_model_of_ones_own_conforms():
    check_model(spring_and_block, run=False)


class Broken:
    """Runs of a sound model, one of whose facts is changed."""

    def __init__(self, monkeypatch, change):
        from fricmb.testing import _model_run

        self.real, self.change, self.count = _model_run.simulate, change, 0
        monkeypatch.setattr(_model_run, "simulate", self)

    def __call__(self, scene, **arguments):
        self.count += 1
        return self.change(self.count, self.real, scene, arguments)


def heavier(run, real, scene, k, arguments):
    """The given run of several is one of a heavier block."""
    return real(scene.with_parameters({"block.mass": 1.1}) if k == run else scene, **arguments)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda k, real, s, a: real(s, **{**a, "t_end": 0.5 * a["t_end"]}), "a run to t_end = 3 ends at 1.5"),
        (lambda k, real, s, a: heavier(2, real, s, k, a), "again has other digits"),
        (lambda k, real, s, a: heavier(3, real, s, k, a), "in two halves it ends with block.x"),
    ],
)
def test_wrong_runs_are_named(monkeypatch, change, named):
    Broken(monkeypatch, change)
    with pytest.raises(ConformanceError) as caught:
        check_model(spring_and_block, t_end=3.0)
    assert named in str(caught.value)


@pytest.mark.slow
def test_the_bound_bites_and_failures_are_told():
    scene = spring_and_block()
    strict = Trip(t_end=3.0, method="auto", rtol=1e-6, bound=1e-30)
    assert "the energy ledger misses" in " ".join(run_findings(scene, strict))
    assert list(run_findings(scene, Trip(t_end=3.0, method="auto", rtol=1e-8, bound=1e-4))) == []
    unknown = Trip(t_end=3.0, method="nonsense", rtol=1e-8, bound=1e-4)
    assert "a run to t_end = 3 fails: " in " ".join(run_findings(scene, unknown))
