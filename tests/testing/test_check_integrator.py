"""The kit passes our integrators and one of another formula, and finds what is wrong with those that are."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate import Integrator, OneStepMethod, integrators
from fricmb.testing import ConformanceError, check_integrator

Radau = integrators["radau"]


@dataclass(frozen=True, kw_only=True)
class Even(OneStepMethod):
    name: ClassVar[str] = "even"
    order: ClassVar[str] = "s"

    stages: int = 5

    def nodes(self, problem, rtol):
        return [(k + 1) / self.stages for k in range(self.stages)]


@pytest.mark.parametrize("name", ["bdf", "collocation", "radau", "taylor"])
def test_ours_keep_the_rules(name):
    check_integrator(integrators[name]())


@pytest.mark.parametrize("stages", [2, 4, 7])
def test_a_formula_by_its_nodes(stages):
    check_integrator(Even(stages=stages), rtol=1e-5)


def test_a_formula_by_its_nodes_on_a_certified_run():
    """213 transitions of the brake, all where another method has them."""
    scene = fm.models.brake4dof("2")
    even = fm.simulate(scene, t_end=50.0, rtol=1e-9, method=Even())
    bdf = fm.simulate(scene, t_end=50.0, rtol=1e-9, method="bdf")
    assert len(even.events) == len(bdf.events) > 10
    np.testing.assert_allclose(even.events.t, bdf.events.t, atol=1e-6)
    assert even.stats.method == "even"


def test_the_order_of_a_formula():
    """Three even nodes: the length of a step goes with the cube root of the tolerance."""
    block = fm.Body("block", mass=1.0, position={"x": 1.0})
    scene = fm.Scene("oscillator", [block, fm.Spring("spring", block, axis="x", stiffness=1.0)])
    steps = [fm.simulate(scene, t_end=50.0, rtol=r, method=Even(stages=3)).stats.n_steps for r in (1e-5, 1e-8)]
    assert 7.0 < steps[1] / steps[0] < 13.0


@pytest.mark.parametrize("nodes", [(), (0.0, 1.0), (0.5, 0.9), (0.7, 0.3, 1.0), (float("nan"), 1.0)])
def test_nodes_that_cannot_be(nodes):
    @dataclass(frozen=True, kw_only=True)
    class Wrong(Even):
        def nodes(self, problem, rtol):
            return nodes

    with pytest.raises(ValueError, match="nodes must rise within"):
        fm.simulate(fm.models.puck_on_belt(), t_end=0.1, method=Wrong())


class Heavy(Radau):
    """Moves other masses."""

    name = "heavy"

    def integrate(self, problem, *args, **options):
        heavier = replace(problem, linear=replace(problem.linear, M=1.01 * problem.linear.M))
        return super().integrate(heavier, *args, **options)


class Early(Radau):
    """Ends before its end."""

    name = "early"

    def integrate(self, problem, start, t_end, **options):
        return super().integrate(problem, start, start.t + 0.5 * (t_end - start.t), **options)


class Leaky(Radau):
    """Loses what friction takes."""

    name = "leaky"

    def integrate(self, *args, **options):
        run = super().integrate(*args, **options)
        rows = run.rows
        run.rows = lambda: replace(rows(), friction_loss=0.0 * rows().friction_loss)
        return run


class Silent(Radau):
    """Refuses without a word on who does."""

    name = "silent"

    def refuses(self, problem):
        return "this one cannot be done"


class Vague(Radau):
    """Takes what nobody knows."""

    name = "vague"
    takes = frozenset({"all"})


class Loose(Integrator):
    """No dataclass."""

    name = "loose"
    order = "1"
    takes = frozenset({"linear"})

    def integrate(self, *args, **options):
        raise NotImplementedError


@pytest.mark.parametrize(
    ("integrator", "words"),
    [
        (Heavy(), "the closed form"),
        (Early(), "the run ended before its time"),
        (Leaky(), "the energy ledger misses"),
        (Silent(), "a refusal must name the integrator"),
        (Vague(), "takes must be a frozenset of"),
        (Loose(), "must be a frozen dataclass"),
        (Radau, "takes an instance of"),
    ],
)
def test_what_is_wrong_is_named(integrator, words):
    with pytest.raises(ConformanceError, match=words):
        check_integrator(integrator)
