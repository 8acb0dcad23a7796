"""Blocks of a structure with rows held, from its free modes, against the exponential of its state matrix."""

import numpy as np
import pytest
import scipy.linalg

import fricmb as fm
from fricmb.integrate.collocation.held_modes import HeldModes, held_modes
from fricmb.integrate.collocation.structure_blocks import MANY

RANDOM = np.random.default_rng(7)


def from_blocks(made: HeldModes, push: np.ndarray, t: float) -> np.ndarray:
    """Positions and velocities of the modes a time t after an impulse, each block by the exponential of its 2 x 2."""
    u, v = made.force_0 @ push, made.force_1 @ push
    states = [
        scipy.linalg.expm(t * np.array([[0.0, 1.0], [-w2, -d]])) @ start
        for w2, d, start in zip(made.w2, made.d, np.stack([u, v], axis=1), strict=True)
    ]
    u, v = np.array(states).T
    return np.concatenate([made.q_u @ u + made.q_v @ v, made.v_u @ u + made.v_v @ v])


def exactly(w2: np.ndarray, d: np.ndarray, c: np.ndarray, push: np.ndarray, t: float) -> np.ndarray:
    """The same by the exponential of the whole, on a basis of the motions that are left."""
    N = scipy.linalg.null_space(c.T)
    K, C = N.T @ (w2[:, None] * N), N.T @ (d[:, None] * N)
    A = np.block([[np.zeros_like(K), np.eye(len(K))], [-K, -C]])
    q, v = np.split(scipy.linalg.expm(t * A) @ np.concatenate([np.zeros(len(K)), N.T @ push]), 2)
    return np.concatenate([N @ q, N @ v])


def modes(n: int, damping: float) -> tuple[np.ndarray, np.ndarray]:
    w = np.sort(RANDOM.uniform(1.0, 10.0 * np.sqrt(n), n))
    return w * w, 2.0 * damping * RANDOM.uniform(0.1, 2.0, n) * w


def check(w2: np.ndarray, d: np.ndarray, c: np.ndarray) -> None:
    made = held_modes(w2, d, c)
    assert made is not None
    assert len(made.w2) == len(w2) - c.shape[1]
    push = RANDOM.standard_normal(len(w2))
    for t in (0.1, 1.0, 5.0):
        right = exactly(w2, d, c, push, t / np.sqrt(w2.max()))
        size = np.abs(right).reshape(2, -1).max(axis=1).repeat(len(w2))
        off = np.abs(from_blocks(made, push, t / np.sqrt(w2.max())) - right) / size
        assert off.max() < 1e-10


@pytest.mark.parametrize("rows", [1, 2])
@pytest.mark.parametrize("damping", [0.0, 0.002, 0.05, 0.3])
@pytest.mark.parametrize("n", [3, 12, 60])
def test_held_structure_moves_as_its_state_matrix_says(n, damping, rows):
    check(*modes(n, damping), RANDOM.standard_normal((n, rows)))


@pytest.mark.parametrize("rows", [1, 2])
def test_modes_that_the_rows_hardly_feel_or_not_at_all(rows):
    w2, d = modes(30, 0.02)
    c = RANDOM.standard_normal((30, rows))
    c[4], c[7], c[9], c[11] = 0.0, 1e-17 * c[7], 1e-9 * c[9], 1e-5 * c[11]
    check(w2, d, c)


@pytest.mark.parametrize("rows", [1, 2])
def test_modes_with_the_same_frequency_or_nearly_the_same(rows):
    w2, d = modes(30, 0.02)
    for one, other, factor in ((3, 4, 1.0), (3, 5, 1.0), (12, 13, 1.0 + 1e-10), (20, 21, 1.0 + 1e-6)):
        w2[other], d[other] = w2[one] * factor, d[one] * factor
    check(w2, d, RANDOM.standard_normal((30, rows)))


@pytest.mark.parametrize("rows", [1, 2])
def test_rigid_motions_that_the_rows_take_part_in(rows):
    w2, d = modes(20, 0.01)
    w2[:rows] = d[:rows] = 0.0
    check(w2, d, RANDOM.standard_normal((20, rows)))


def test_real_poles_are_left_to_others():
    w2, d = modes(10, 3.0)
    assert held_modes(w2, d, RANDOM.standard_normal((10, 1))) is None


def bar(n: int, *, axes: str) -> fm.Scene:
    """A bar by its modes, its end on a belt, sideways too where there are two axes."""
    k = np.arange(1, n + 1)
    w = (2 * k - 1) * np.pi / 2 * (1.0 + 0.1 * np.sin(k))
    shapes = np.stack([np.sqrt(2.0) * (-1.0) ** k, np.cos(3.0 * k)])[: len(axes)]
    damping = 0.005 + 0.003 * np.cos(k)
    body = fm.ModalBody("bar", frequencies=w, damping_ratios=damping, shapes={"tip": shapes}, axes=axes)
    belt = fm.Driven("belt", velocity=dict(zip(axes, (0.1, 0.03), strict=False)))
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.6)
    return fm.Scene("bar", [body, belt, fm.Contact("sole", body.point("tip"), belt, law=law, normal_force=1.0)])


@pytest.mark.parametrize("axes", ["x", "xy"])
def test_a_body_of_many_modes_sticks_and_slips_as_by_other_methods(axes):
    scene = bar(MANY + 6, axes=axes)
    own = fm.simulate(scene, t_end=14.0, rtol=1e-8)
    other = fm.simulate(scene, t_end=14.0, rtol=1e-9, method="bdf")
    assert own.stats.method == "collocation"
    assert [(e.kind, e.contact) for e in own.events] == [(e.kind, e.contact) for e in other.events]
    assert len(own.events) >= 3
    np.testing.assert_allclose([e.t for e in own.events], [e.t for e in other.events], rtol=0.0, atol=2e-7)
    t = np.linspace(0.0, 14.0, 57)
    there, here = other.at(t), own.at(t)
    np.testing.assert_allclose(here.q, there.q, rtol=0.0, atol=1e-7 * np.abs(there.q).max())
    np.testing.assert_allclose(here.force("sole"), there.force("sole"), rtol=0.0, atol=1e-5)


def test_energies_over_a_stick_of_many_modes_close():
    """Damping over a stick is found from many instants at once; the balance with the motion's own energies is not."""
    sol = fm.simulate(bar(MANY + 6, axes="x"), t_end=9.0, rtol=1e-9, t_eval=np.linspace(0.0, 9.0, 46))
    assert (sol.mode("sole") == 0).sum() > 30
    assert sol.energy.damping_loss[-1] > 1e-5 * sol.energy.friction_loss[-1]
    assert np.abs(sol.energy.residual).max() < 1e-7


@pytest.mark.parametrize("modes", [4, MANY + 6])
@pytest.mark.parametrize("across", [0.0, 0.5])
def test_a_contact_whose_directions_move_as_one_is_left_to_others(modes, across):
    """It ended in an error of linear algebra."""
    k = np.arange(1.0, modes + 1.0)
    shapes = {"tip": np.stack([np.cos(k), across * np.cos(k)])}
    body = fm.ModalBody("bar", frequencies=k, damping_ratios=0.01, shapes=shapes, axes="xy")
    belt = fm.Driven("belt", velocity={"x": 0.1})
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.6)
    scene = fm.Scene("bar", [body, belt, fm.Contact("sole", body.point("tip"), belt, law=law, normal_force=1.0)])
    with pytest.raises(fm.SceneError, match="directions are redundant"):
        fm.simulate(scene, t_end=0.1, method="collocation")
    if across:
        assert fm.simulate(scene, t_end=0.1).stats.method == "radau"
    else:  # nothing moves across: the motion is that of a contact in one direction
        one = scene.replace("sole", axes="x")
        both, along = (fm.simulate(each, t_end=3.0, rtol=1e-9) for each in (scene, one))
        assert [e.kind for e in both.events] == [e.kind for e in along.events]
        assert len(both.events) > 0
        np.testing.assert_allclose(both.q[:, -1], along.q[:, -1], rtol=0.0, atol=1e-8)
