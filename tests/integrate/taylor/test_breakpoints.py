"""What sticks goes on sticking where a force has a corner: round-off between two bodies that move is no slip."""

from itertools import pairwise

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm

TIMES = np.linspace(0.0, 1.2, 61)
VALUES = np.random.default_rng(3).normal(size=61)


def record(size):
    slopes = np.diff(VALUES) / np.diff(TIMES)
    pieces = [
        (size * (float(a) + float(b) * (fm.t - float(at))), fm.t < float(end))
        for a, b, at, end in zip(VALUES, slopes, TIMES, TIMES[1:], strict=False)
    ]
    return sympy.Piecewise(*pieces, (0, True))


def one_body(masses, stiffness, damping, sizes):
    """Positions at the corners of a body that has the masses of all, from DOP853 piece by piece."""
    mass, size, y, found = sum(masses), sum(sizes), np.zeros(2), [0.0]
    for begin, end, a, b in zip(TIMES, TIMES[1:], VALUES, VALUES[1:], strict=False):
        def rate(t, y, begin=begin, end=end, a=a, b=b):
            push = size * (a + (b - a) * (t - begin) / (end - begin))
            return [y[1], (push - stiffness * y[0] - damping * y[1]) / mass]

        y = solve_ivp(rate, (begin, end), y, method="DOP853", rtol=1e-12, atol=1e-15).y[:, -1]
        found.append(y[0])
    return np.array(found)


@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
@pytest.mark.parametrize("scale", [1.0, 1e-6])
@pytest.mark.parametrize("masses", [(1.0, 0.7), (1.0, 0.7, 0.4), (3.0, 1e-3, 1.0)])
def test_a_pile_that_holds_is_one_body(masses, scale, rtol):
    sizes = scale * np.array([1.0, -0.3, 0.6])[: len(masses)]
    floors = [fm.Body(f"m{i}", mass=mass) for i, mass in enumerate(masses)]
    parts = [
        *floors,
        fm.Spring("spring", floors[0], axis="x", stiffness=400.0),
        fm.Damper("damper", floors[0], axis="x", damping=0.8),
        *(fm.Force(f"push{i}", floors[i], axis="x", value=record(float(size))) for i, size in enumerate(sizes)),
        *(
            fm.Contact(f"joint{i}", upper, lower, law=fm.laws.Coulomb(mu_s=1.0), normal_force=20.0 * scale)
            for i, (lower, upper) in enumerate(pairwise(floors))
        ),
        *(
            fm.Spring(f"tie{i}", upper, lower, axis="x", stiffness=100.0)
            for i, (lower, upper) in enumerate(pairwise(floors))
        ),
    ]
    sol = fm.simulate(fm.Scene("pile", parts), t_end=1.2, rtol=rtol, t_eval=TIMES, method="taylor")
    assert len(sol.events) == 0
    expected = one_body(masses, 400.0, 0.8, sizes)
    assert np.abs(sol.q - expected).max() < 10.0 * rtol * np.abs(expected).max()


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_modes_that_stand_still_stay_so_where_a_load_bends(rtol):
    """Forces that hold each other up leave speeds of the size of round-off, and these are no slip."""
    plate = fm.ModalBody(
        "plate", frequencies=(1.3, 2.9, 5.3), damping_ratios=0.02, axes="x", shapes={"foot": [(0.8, 0.5, -0.4)]}
    )
    foot = plate.point("foot")
    t, y = np.linspace(0.0, 4.0, 41), 0.68 * np.random.default_rng(3).uniform(-1.0, 1.0, 41)
    scene = fm.Scene("plate", [
        plate, fm.Spring("k", foot, axis="x", stiffness=3.4), fm.Force("f", foot, axis="x", value=(t, y)),
        fm.Contact("c", foot, law=fm.laws.Stribeck(mu_s=0.7, mu_k=0.5, v_s=0.1), normal_force=1.0, axes="x"),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=4.0, rtol=rtol, method="taylor")
    assert not list(sol.events)
    assert np.abs(sol.v).max() < 1e-14
