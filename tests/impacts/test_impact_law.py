"""Newton's law or Poisson's: what is refused, where they agree, and impacts that Newton's law has no right to."""

import math

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.implicit.impacts.impact_law import Hit, solve_by_poisson


def test_what_is_not_accepted_is_refused_by_name():
    body = fm.Body("b", mass=1.0, axes="xy", position={"y": 1.0})
    with pytest.raises(fm.SceneError, match="'i': law must be 'newton' or 'poisson'"):
        fm.ImpactLaw("i", law="hertz")
    with pytest.raises(fm.SceneError, match="two laws of impact, 'i' and 'j'"):
        fm.Scene("two", [body, fm.ImpactLaw("i"), fm.ImpactLaw("j")])
    floor = fm.RollerOnLine(
        "floor", body, push_only=True, restitution=0.5, friction=fm.laws.Coulomb(mu_s=0.3), tangential_restitution=0.5
    )
    with pytest.raises(fm.SceneError, match="'floor': tangential_restitution must be left out or 0 beside"):
        fm.Scene("along", [body, floor, fm.ImpactLaw("i", law="poisson")])
    fm.Scene("along", [body, floor, fm.ImpactLaw("i")])


def test_a_scene_without_impacts_may_have_a_law():
    block = fm.Body("k", mass=1.0, velocity={"x": 1.0})
    sol = fm.simulate(fm.Scene("free", [block, fm.ImpactLaw("i", law="poisson")]), t_end=1.0)
    assert abs(sol["k.x"][-1] - 1.0) < 1e-12


def test_derivatives_are_those_of_newtons_law():
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    spring = fm.Spring("spring", block, axis="x", stiffness=1.0)
    parts = [block, spring, fm.Stop("ends", block, axis="x", upper=0.5, restitution=0.4)]
    scene = fm.Scene("s", [*parts, fm.ImpactLaw("i", law="poisson")])
    with pytest.raises(fm.SceneError, match="bounces by Poisson's law"):
        fm.simulate(scene, t_end=1.0, sensitivities=("spring.stiffness",))


@pytest.mark.parametrize("e", [0.0, 0.4, 1.0])
def test_single_contacts_are_alike_by_both(e):
    block = fm.Body("block", mass=1.0, velocity={"x": 1.0})
    parts = [
        block,
        fm.Spring("spring", block, axis="x", stiffness=1.0),
        fm.Stop("ends", block, axis="x", lower=-0.8, upper=0.5, restitution=e),
    ]
    scenes = [fm.Scene("s", [*parts, fm.ImpactLaw("i", law=law)]) for law in ("newton", "poisson")]
    runs = [fm.simulate(scene, t_end=8.0) for scene in scenes]
    assert np.allclose(*(run.events.t for run in runs), rtol=0, atol=1e-14)
    assert np.allclose(*(run.impulse("ends").normal for run in runs), rtol=0, atol=1e-14)
    assert runs[1].audit().ok


def rod(law, angle=1.0, mu=0.6, e=0.9, slip=-1.5):
    """A uniform rod that falls on its tip."""
    l, s = 0.5, math.sin(angle)
    body = fm.RigidBody(
        "rod", mass=1.0, inertia=l * l / 3, position=(0.0, 0.01 + l * s), angle=angle, velocity=(slip, -1.0),
        points={"tip": (-l, 0.0)},
    )  # fmt: skip
    floor = fm.RollerOnLine(
        "floor", body.point("tip"), push_only=True, restitution=e, friction=fm.laws.Coulomb(mu_s=mu)
    )
    return fm.Scene("rod", [body, floor, fm.ImpactLaw("impacts", law=law)])


def two_phases(D, before, mu, e):
    """Impulses of one contact: both phases over normal and tangential rows, by trying stick and both ways of slip."""

    def phase(rate, least):
        for way in (0.0, 1.0, -1.0):
            for rises in (True, False):
                A, b = [], []
                A.append([D[0, 0], D[0, 1]] if rises else [1.0, 0.0])
                b.append(-rate[0] if rises else least)
                A.append([D[1, 0], D[1, 1]] if way == 0.0 else [way * mu, 1.0])
                b.append(-rate[1] if way == 0.0 else 0.0)
                push = np.linalg.solve(A, b)
                after = rate + D @ push
                holds = abs(push[1]) <= mu * push[0] + 1e-12 if way == 0.0 else way * after[1] >= -1e-12
                if holds and push[0] >= least - 1e-12 and after[0] >= -1e-12:
                    return push, after
        raise AssertionError("no phase fits")

    first, between = phase(before, 0.0)
    second, after = phase(between, e * first[0])
    return first + second, after


@pytest.mark.parametrize("angle", [0.6, 1.0, 1.3])
@pytest.mark.parametrize("slip", [-1.5, -0.3, 0.4, 2.0])
def test_impulses_of_a_rod_are_those_of_two_phases(angle, slip):
    sol = fm.simulate(rod("poisson", angle=angle, slip=slip), t_end=0.02)
    impulse = sol.impulse("floor")
    l, c, s = 0.5, math.cos(angle), math.sin(angle)
    rows = np.array([[0.0, 1.0, -l * c], [1.0, 0.0, l * s]])
    D = rows @ np.diag([1.0, 1.0, 3.0 / l**2]) @ rows.T
    wanted, after = two_phases(D, np.array([-1.0, slip]), 0.6, 0.9)
    assert np.allclose([impulse.normal[0], impulse.tangential[0]], wanted, rtol=0, atol=1e-11)
    assert np.allclose(rows @ sol.v[:, -1], after, rtol=0, atol=1e-10)
    assert sol.energy.impact_loss[-1] > 0.0
    assert sol.audit().ok


def test_a_rod_that_would_gain_energy_by_newtons_law_is_told_of_poissons():
    with pytest.raises(fm.IntegrationError, match=r"would gain the energy.*ImpactLaw with law='poisson'"):
        fm.simulate(rod("newton", angle=GAINS[0], mu=GAINS[1], e=GAINS[2], slip=GAINS[3]), t_end=0.02)
    sol = fm.simulate(rod("poisson", angle=GAINS[0], mu=GAINS[1], e=GAINS[2], slip=GAINS[3]), t_end=0.02)
    assert sol.energy.impact_loss[-1] > 0.0


#: Angle, friction, restitution and slip of a rod whose impact gains energy by Newton's law.
GAINS = (0.66, 1.06, 0.9, 0.25)


def test_what_is_held_gives_back_its_impulse_as_well():
    """A ball on another one meets a floor: 0, 1 by hand (both phases of both contacts)."""
    a = fm.Body("a", mass=1.0, position={"y": 1.0}, velocity={"y": -1.0}, axes="y")
    b = fm.Body("b", mass=2.0, position={"y": 2.0}, velocity={"y": -1.0}, axes="y")
    floor = fm.Stop("floor", a, axis="y", lower=0.0, restitution=0.5)
    touch = fm.Stop("touch", b, a, axis="y", lower=1.0, restitution=1.0)
    sol = fm.simulate(fm.Scene("balls", [a, b, floor, touch, fm.ImpactLaw("i", law="poisson")]), t_end=1.5)
    assert np.allclose(sol.v[:, -1], [0.0, 1.0], rtol=0, atol=1e-14)
    assert np.allclose(sol.impulse("floor").normal, [5.0], rtol=0, atol=1e-14)
    assert np.allclose(sol.impulse("touch").normal, [4.0], rtol=0, atol=1e-14)
    assert sol.audit().ok


@pytest.mark.parametrize("seed", range(20))
def test_poissons_law_never_gains_energy(seed):
    rng = np.random.default_rng(seed)
    for _ in range(20):
        k = int(rng.integers(1, 3))
        W = rng.normal(size=(2 * k, 4))
        rate = rng.normal(size=2 * k)
        rate[:k] = -np.abs(rate[:k])
        hit = Hit(
            D=W @ W.T, rate=rate, normal=np.arange(k), tangential=np.arange(k, 2 * k), e=rng.uniform(0, 1, k),
            e_t=np.zeros(k), mu=rng.uniform(0.0, 0.8, k), forced=np.zeros(k, bool), given=np.zeros(k),
        )  # fmt: skip
        answer = solve_by_poisson(hit)
        if answer is not None:
            assert answer.impulse @ (answer.rate + rate) <= 1e-12
            assert answer.rate[:k].min() >= -1e-9
            assert (np.abs(answer.impulse[k:]) <= hit.mu * answer.impulse[:k] + 1e-9).all()
