"""The oracle itself, against certified references and closed forms."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ellipe

from tests.oracle.laws import disc
from tests.oracle.mechanisms import Chain, numbers
from tests.oracle.problem import Contact, OracleError, Problem
from tests.oracle.references import constant, problem
from tests.oracle.run import solve
from tests.reference import errors, load

#: Reference, how far it is run, and the largest error over a signal's largest value (growth of errors included).
CASES = [
    ("p1_1", 20.0, 2e-8), ("p2_a", 60.0, 1e-9), ("p2_sb", 40.0, 1e-9), ("p3_free_1.03", 20.0, 1e-10),
    ("p3_free_1", 20.0, 1e-10), ("p3_forced_w0.5_f0.2", 40.0, 1e-9), ("p3_forced_w1.5_f0.2", 40.0, 1e-9),
    ("p4_vdr0.1", 50.0, 3e-8), ("p5_a", 20.0, 1e-9), ("p5_d", 40.0, 1e-9), ("p5_e", 40.0, 1e-9), ("p6", 14.0, 1e-8),
]  # fmt: skip


@pytest.mark.parametrize(("name", "t_end", "most"), CASES)
def test_certified_reference(name, t_end, most):
    reference = load(name)
    kept = reference["t"] <= t_end
    reference = {**reference, **{key: reference[key][kept] for key in ("t", "q", "v")}}
    found = solve(problem(name, reference, float(reference["t"][-1])))
    d = reference["q"].shape[1]
    y = found(reference["t"])
    assert np.concatenate(errors(reference, y[:d], y[d:])).max() < most
    if "t_event" in reference:
        true = reference["t_event"][reference["t_event"] < reference["t"][-1]]
        np.testing.assert_allclose([event.t for event in found.events if event.t < reference["t"][-1]], true, atol=1e-6)


def loop(load=0.5, shares=(1.0, 1.0), mu=(0.6, 0.5)):
    """Two blocks on the ground that also rub on each other: three contacts, two degrees of freedom."""
    W = (np.array([[1.0], [0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0], [-1.0]]))
    contacts = tuple(
        Contact(name=f"c{i}", W=w, N=constant(1.0), mu=constant(mu[1]), mu_s=constant(mu[0])) for i, w in enumerate(W)
    )
    return Problem(
        M=np.eye(2), K=np.zeros((2, 2)), C=np.zeros((2, 2)), q=np.zeros(2), v=np.zeros(2), contacts=contacts,
        load=lambda t: np.array(shares) * load * t, t_end=4.0,
    )  # fmt: skip


def test_a_loop_of_contacts_holds_what_any_share_of_forces_holds():
    """A load on one block alone: its own ground and the neighbour hold it, as far as that one's ground holds."""
    found = solve(loop(load=1.0, shares=(1.0, 0.0)))
    first = found.events[0]
    # ground 0.6, and through the other block at most 0.6: together 1.2
    assert (first.t, first.kind) == (pytest.approx(1.2, abs=1e-9), "slip")


def test_both_blocks_of_a_loop_go_at_once():
    """Equal loads: both grounds let go at 0.6 together, then both slide without rubbing: v = int (0.5 t - 0.5)."""
    found = solve(loop(load=0.5))
    assert {event.contact for event in found.events} == {"c0", "c1"}
    assert all(event.t == pytest.approx(1.2, abs=1e-9) for event in found.events)
    end = found(np.array([4.0]))[:, 0]
    expected = 0.25 * (16.0 - 1.44) - 0.5 * 2.8
    np.testing.assert_allclose(end[2:], expected, atol=1e-9)


def test_breaks_of_a_load_are_met():
    """0.7 holds below 0.8; at 0.9 it slides with 0.3; without load it is braked with 0.6."""
    one = np.ones((1, 1))
    scene = Problem(
        M=one, K=0.0 * one, C=0.0 * one, q=np.zeros(1), v=np.zeros(1), t_end=5.0, breaks=(1.0, 2.0, 3.0),
        load=lambda t: 0.7 if t < 1.0 else 0.71 if t < 2.0 else 0.9 if t < 3.0 else 0.0,
        contacts=(Contact(name="c", W=one, N=constant(1.0), mu=constant(0.6), mu_s=constant(0.8)),),
    )  # fmt: skip
    found = solve(scene)
    assert [(e.kind, pytest.approx(e.t, abs=1e-10)) for e in found.events] == [("slip", 2.0), ("stick", 3.5)]
    assert found(np.array([5.0]))[0, 0] == pytest.approx(0.15 + 0.075, abs=1e-10)


def test_a_varying_load_opens_and_closes():
    """N = cos t: friction is gone while it is negative; the speed is that of the sum of impulses."""
    one = np.ones((1, 1))
    contact = Contact(
        name="c", W=one, N=lambda t, q, v: np.cos(t), mu=constant(0.5), mu_s=constant(0.5), constant=False
    )
    scene = Problem(M=one, K=0.0 * one, C=0.0 * one, q=np.zeros(1), v=np.array([5.0]), t_end=6.0, contacts=(contact,))
    found = solve(scene)
    np.testing.assert_allclose([e.t for e in found.events], [np.pi / 2, 3 * np.pi / 2], atol=1e-9)
    assert [e.kind for e in found.events] == ["open", "close"]
    assert found(np.array([6.0]))[1, 0] == pytest.approx(5.0 - 0.5 - 0.5 * (np.sin(6.0) + 1.0), abs=1e-10)


def test_what_cannot_be_decided_is_refused():
    one = np.ones((1, 1))
    contact = Contact(name="c", W=one, N=constant(1.0), mu=constant(0.9), mu_s=constant(0.5))  # holds less than it rubs
    scene = Problem(
        M=one, K=0.0 * one, C=0.0 * one, q=np.zeros(1), v=np.zeros(1), load=lambda t: 0.7, t_end=1.0,
        contacts=(contact,),
    )  # fmt: skip
    with pytest.raises(OracleError):
        solve(scene)


SPEEDS = [(1.0, 0.0), (1.0, 5e-3), (1.0, 0.3), (1.0, 0.99), (0.7, 1.0), (0.02, 1.0), (5e-3, 1.0)]


@pytest.mark.parametrize(("v", "u"), SPEEDS)
def test_a_disc_that_slides_and_spins_is_braked_by_its_rings(v, u):
    """The gradient of the power, which is a sum over rings, each in closed form."""

    def power(v, u):
        def ring(rho):
            return 2.0 / np.pi * (v + u * rho) * ellipe(4.0 * v * u * rho / (v + u * rho) ** 2)

        points = [min(v / u, 1.0)] if u > 0.0 else None
        return quad(lambda rho: 2.0 * rho * ring(rho), 0.0, 1.0, points=points, epsabs=0.0, epsrel=1e-13)[0]

    force = disc(1.0, 1e-12)(np.array([0.6 * v, -0.8 * v, u]), 1.0, None)
    assert 0.8 * force[0] + 0.6 * force[1] == pytest.approx(0.0, abs=1e-15)
    assert -(0.6 * force[0] - 0.8 * force[1]) * v - force[2] * u == pytest.approx(power(v, u), rel=1e-11)
    slope = (power(v * (1.0 + 1e-4), u) - power(v * (1.0 - 1e-4), u)) / (2e-4 * v)
    assert -(0.6 * force[0] - 0.8 * force[1]) == pytest.approx(slope, rel=1e-5)


def test_a_dry_pin_is_loaded_by_its_own_reaction():
    """One link: inertia and weight against mu radius |reaction|, accelerations by differences of velocities."""
    link = Chain("chain", [1.3], [0.1], [1.2], [1.2], [0.0], [0.05], [0.6], [0.6], 3.0)
    found = solve(numbers(link))
    t, h = np.array([0.3, 0.9, 1.3, 2.1]), 1e-5
    (angle, rate), (_, after), (_, before) = found(t), found(t + h), found(t - h)
    a = (after - before) / (2.0 * h)
    half = 0.6
    x = 1.3 * half * (np.cos(angle) * a - np.sin(angle) * rate**2)
    y = 1.3 * half * (np.sin(angle) * a + np.cos(angle) * rate**2) + 1.3 * 9.81
    expected = -1.3 * 9.81 * half * np.sin(angle) - 0.6 * 0.05 * np.hypot(x, y) * np.sign(rate)
    np.testing.assert_allclose((0.1 + 1.3 * half**2) * a, expected, atol=1e-7)
    assert {event.kind for event in found.events} == {"reversal"}


def test_round_a_loop_none_slips_alone():
    """The first block on the ground (0.6, 0.4) and on the second (0.3 throughout), that one on the ground (0.5, 0.5).

    Load on the first: 0.9 holds (ground and neighbour at their limits), then it slides against 0.7, the second stays.
    """
    mu = ((0.6, 0.4), (0.5, 0.5), (0.3, 0.3))
    W = (np.array([[1.0], [0.0]]), np.array([[0.0], [1.0]]), np.array([[1.0], [-1.0]]))
    contacts = tuple(
        Contact(name=f"c{i}", W=w, N=constant(1.0), mu=constant(k), mu_s=constant(s))
        for i, (w, (s, k)) in enumerate(zip(W, mu, strict=True))
    )
    scene = Problem(
        M=np.eye(2), K=np.zeros((2, 2)), C=np.zeros((2, 2)), q=np.zeros(2), v=np.zeros(2), contacts=contacts,
        load=lambda t: np.array([t, 0.0]), t_end=2.0,
    )  # fmt: skip
    found = solve(scene)
    assert [(e.contact, e.kind, pytest.approx(e.t, abs=1e-9)) for e in found.events] == [
        ("c0", "slip", 0.9), ("c2", "slip", 0.9)
    ]  # fmt: skip
    end = found(np.array([2.0]))[:, 0]
    np.testing.assert_allclose(end[2:], [0.5 * (4.0 - 0.81) - 0.7 * 1.1, 0.0], atol=1e-9)
