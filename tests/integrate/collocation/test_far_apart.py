"""Masses and damping that lie orders of magnitude apart, against the exponential of the whole system."""

import functools

import numpy as np
import pytest
import scipy.linalg
import sympy

import fricmb as fm

HEAVY, LIGHT, BELT, LOAD = 8e8, 2e-4, 0.2, 1.6e-5
#: Stiffness and damping of the heavy body to the ground, of the light one, and of what ties them.
TO_GROUND, ALONE, TIE, TIE_DAMPING = (0.44 * HEAVY, 0.0133 * HEAVY), 8.5e-5, 0.081, 0.00788


def shaken() -> fm.Scene:
    """A light body on a belt, tied to a heavy one that is shaken."""
    heavy, light = fm.Body("heavy", mass=HEAVY), fm.Body("light", mass=LIGHT, position={"x": 0.3}, velocity={"x": 0.1})
    belt = fm.Driven("belt", velocity={"x": BELT})
    return fm.Scene("shaken", [
        heavy, light, belt, fm.Spring("k", heavy, axis="x", stiffness=TO_GROUND[0]),
        fm.Damper("c", heavy, axis="x", damping=TO_GROUND[1]), fm.Spring("own", light, axis="x", stiffness=ALONE),
        fm.Spring("tie", light, heavy, axis="x", stiffness=TIE),
        fm.Damper("d", light, heavy, axis="x", damping=TIE_DAMPING),
        fm.Force("f", heavy, axis="x", value=2.0 * HEAVY * sympy.sin(2.0 * fm.t)),
        fm.Contact("c0", light, belt, law=fm.laws.Coulomb(mu_s=0.5, mu_k=0.3), normal_force=LOAD),
    ])  # fmt: skip


def exactly(t: float) -> np.ndarray:
    """Positions while the light body lags behind the belt: states, the load's sine and cosine, and 1."""
    A = np.zeros((7, 7))
    A[0, 2] = A[1, 3] = 1.0
    A[2, [0, 2]] = -TO_GROUND[0] / HEAVY, -TO_GROUND[1] / HEAVY
    A[2, 4] = 2.0
    tie = np.array([TIE, -TIE, TIE_DAMPING, -TIE_DAMPING])
    A[2, :4] -= tie / HEAVY
    A[3, :4] += tie / LIGHT
    A[3, 1] -= ALONE / LIGHT
    A[3, 6] = 0.3 * LOAD / LIGHT
    A[4, 5], A[5, 4] = 2.0, -2.0
    start = np.array([0.0, 0.3, 0.0, 0.1, 0.0, 1.0, 1.0])
    return (scipy.linalg.expm(A * t) @ start)[:2]


def test_what_a_light_body_feels_of_a_heavy_one_is_no_round_off():
    sol = fm.simulate(shaken(), t_end=0.2, rtol=1e-11, method="radau")
    assert not sol.events
    for t in (0.05, 0.1, 0.2):
        np.testing.assert_allclose(sol(t)[:2], exactly(t), rtol=1e-10)


def test_light_bodies_whose_poles_are_not_known_well_enough_are_left_to_others():
    """The light one erred by 1e-4 at every tolerance, without a word."""
    start = {"position": {"x": 0.3}, "velocity": {"x": 0.1}}
    heavy, light = fm.Body("heavy", mass=864668462.0, **start), fm.Body("light", mass=2.5458, **start)
    belt = fm.Driven("belt", velocity={"x": 0.012})
    law = fm.laws.Stribeck(mu_s=0.6, mu_k=0.3, v_s=0.018)
    scene = fm.Scene("apart", [
        heavy, light, belt, fm.Spring("k", heavy, axis="x", stiffness=13244614808.0),
        fm.Damper("c", heavy, axis="x", damping=6768220066.0), fm.Spring("own", light, axis="x", stiffness=8.1368),
        fm.Damper("slow", light, axis="x", damping=455.135),
        fm.Spring("tie", light, heavy, axis="x", stiffness=0.1136),
        fm.Damper("d", light, heavy, axis="x", damping=0.10755),
        fm.Force("f", heavy, axis="x", value=2356352172.6 * sympy.sin(1.1567 * fm.t)),
        fm.Contact("c0", heavy, belt, law=law, normal_force=1.652),
    ])  # fmt: skip
    fine = fm.simulate(scene, t_end=5.0, rtol=1e-11, method="radau")
    sol = fm.simulate(scene, t_end=5.0, rtol=1e-8)
    assert len(sol.events) == len(fine.events)
    np.testing.assert_allclose(sol(5.0)[:2], fine(5.0)[:2], rtol=1e-6)


@functools.cache
def calm(ratio):
    """Three bodies, one tie of 1e5 rad/s that is damped out at once; and its run to many digits."""
    bodies = [fm.Body(f"b{i}", mass=m, position={"x": 0.3 * i}) for i, m in enumerate((2.0, 0.05, 1.0))]
    belt = fm.Driven("belt", velocity={"x": 0.1})
    ties = [
        part for i, (w, zeta) in enumerate(((1e5, ratio), (20.0, 1.0)))
        for part in (
            fm.Spring(f"t{i}", bodies[i + 1], bodies[i], axis="x", stiffness=0.05 * w * w),
            fm.Damper(f"d{i}", bodies[i + 1], bodies[i], axis="x", damping=2.0 * zeta * 0.05 * w),
        )
    ]  # fmt: skip
    own = [fm.Spring(f"g{i}", body, axis="x", stiffness=5.0) for i, body in enumerate(bodies)]
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    scene = fm.Scene("calm", [*bodies, belt, *ties, *own, fm.Contact("c", bodies[2], belt, law=law, normal_force=2.0)])
    return scene, fm.simulate(scene, t_end=5.0, rtol=1e-11, method="radau")


@pytest.mark.parametrize("rtol", [1e-4, 1e-7, 1e-10])
@pytest.mark.parametrize("ratio", [1.0, 50.0])
def test_what_has_long_come_to_rest_sets_no_steps_under_auto(ratio, rtol):
    """1000 to 75 000 steps were taken."""
    scene, fine = calm(ratio)
    sol = fm.simulate(scene, t_end=5.0, rtol=rtol)
    assert sol.stats.n_steps + sol.stats.n_rejected < 1000
    assert [e.kind for e in sol.events] == [e.kind for e in fine.events]
    size = np.abs(fine.q).max(axis=1)
    assert (np.abs(sol(5.0)[:3] - fine(5.0)[:3]) / size).max() < 20.0 * rtol + 1e-9


@functools.cache
def stiff_pair():
    """Two halves of a mass, a stiff damped tie between them; and its run to many digits."""
    one, two = (fm.Body(name, mass=0.5, position={"x": 2.7183}) for name in ("one", "two"))
    scene = fm.Scene("stiff pair", [
        one, two, fm.Spring("soft", one, axis="x", stiffness=1.0), fm.Spring("tie", one, two, axis="x", stiffness=1e10),
        fm.Damper("calm", one, two, axis="x", damping=0.5e5),
        fm.Contact("sole", two, law=fm.laws.Coulomb(mu_s=1.0), normal_force=0.1),
    ])  # fmt: skip
    return scene, fm.simulate(scene, t_end=50.0, rtol=1e-12, method="radau")


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_what_friction_leaves_in_a_stiff_tie_is_in_the_tolerance_under_auto(rtol):
    """Exact structure erred by 80 rtol at 1e-8, 1e4 at 1e-10."""
    scene, fine = stiff_pair()
    sol = fm.simulate(scene, t_end=50.0, rtol=rtol)
    t = np.linspace(0.0, 50.0, 101)
    assert np.abs(sol(t)[:2] - fine(t)[:2]).max() < 2.7183 * 30.0 * rtol
    assert sol.stats.n_steps + sol.stats.n_rejected < 1000
