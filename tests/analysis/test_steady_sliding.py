"""Steady sliding and its stability against closed forms, Routh's criterion, differences, and runs in time."""

import numpy as np
import pytest
from scipy.optimize import brentq

import fricmb as fm
from fricmb.analysis import complex_eigenvalues, stability_map, steady_sliding
from fricmb.analysis._linearise import linearise
from fricmb.system import build

K3 = 4 / 3


def two_modes(mu=0.3, damping=(0.0, 0.0), load=10.0):
    """Hoffmann's model: K = [[2, 1], [1, 2]], of which k3 = 4/3 presses on a belt; flutter from mu = 0.75."""
    mass = fm.Body("mass", mass=1.0, axes="xy")
    belt = fm.Driven("belt", velocity={"x": -1.0})
    structure = fm.MatrixElement("structure", ["mass.x", "mass.y"], K=[[2, 1], [1, 2 - K3]], C=np.diag(damping))
    pressing = fm.normal.Spring(axis="y", stiffness=K3, preload=load)
    lining = fm.Contact("lining", mass, belt, law=fm.laws.Coulomb(mu_s=2.0, mu_k=mu), normal_force=pressing)
    return fm.Scene("two modes", [mass, belt, structure, lining])


def test_equilibrium_in_closed_form():
    steady = steady_sliding(two_modes(mu=0.3))
    q = np.linalg.solve([[2, 1 - 0.3 * K3], [1, 2]], [-0.3 * 10.0, 0.0])
    assert steady.q == pytest.approx(q, rel=1e-13)
    assert steady.normal_force("lining") == pytest.approx(10.0 - K3 * q[1], rel=1e-13)
    assert steady.force("lining") == pytest.approx([-0.3 * (10.0 - K3 * q[1])], rel=1e-13)
    assert steady.relative_velocity("lining") == pytest.approx([1.0])


@pytest.mark.parametrize(
    "values", [np.linspace(0, 1, 21), [0.0, 1.0], [0.7, 0.8], [0.5, 0.75, 1.0], np.linspace(1, 0, 6)]
)
def test_flutter_of_two_modes(values):
    (critical,) = complex_eigenvalues(two_modes(), over="lining.law.mu_k", values=values).critical
    assert critical.value == pytest.approx(0.75, abs=1e-12)
    assert critical.kind == "flutter"
    assert critical.frequency == pytest.approx(np.sqrt(2), rel=1e-9)
    assert critical.unstable_above == (values[-1] > values[0])


def test_eigenvalues_of_two_modes_are_followed():
    found = complex_eigenvalues(two_modes(), over="lining.law.mu_k", values=np.linspace(0, 0.7, 8))
    split = np.sqrt(1 - 4 * found.values / 3)
    assert found.frequency == pytest.approx(np.sqrt(np.stack([2 - split, 2 + split], axis=1)), rel=1e-12)
    assert np.abs(found.growth).max() < 1e-13
    assert np.abs(found.shapes).max(axis=2) == pytest.approx(1.0)


@pytest.mark.parametrize("c", [1e-6, 0.01, 0.1, 0.5])
def test_equal_damping_moves_the_flutter_as_it_must(c):
    """(lambda^2 + c lambda + kappa = 0 with kappa = 2 +- i s grows where s^2 > 2 c^2, s^2 = 4 mu/3 - 1.)"""
    (critical,) = complex_eigenvalues(two_modes(damping=(c, c)), over="lining.law.mu_k", values=[0.1, 1.6]).critical
    assert critical.value == pytest.approx(0.75 * (1 + 2 * c**2), abs=1e-10)


def test_unequal_damping_against_routh():
    c1, c2 = 0.03, 0.2

    def routh(mu):
        a3, a2, a1, a0 = c1 + c2, 4 + c1 * c2, 2 * (c1 + c2), 4 - (1 - mu * K3)
        return a3 * a2 * a1 - a1**2 - a3**2 * a0

    (critical,) = complex_eigenvalues(
        two_modes(damping=(c1, c2)), over="lining.law.mu_k", values=np.linspace(0, 1.5, 7)
    ).critical
    assert critical.value == pytest.approx(brentq(routh, 0, 1.5, xtol=1e-14), abs=1e-10)


@pytest.mark.parametrize("damping", [0.0, 0.05])
def test_divergence_in_closed_form(damping):
    """A force p x against a spring of stiffness 1."""
    scene = fm.models.belt_oscillator(damping=damping, mu_s=0.5, mu_k=0.5)
    push = fm.Force("push", scene["mass"], axis="x", value=fm.parameter("p", 0.5) * fm.coordinate("mass.x"))
    scene = fm.Scene("diverging", [*scene.parts, push])
    (critical,) = complex_eigenvalues(scene, over="p", values=[0.2, 0.55, 0.9, 1.25]).critical
    assert critical.kind == "divergence"
    assert critical.frequency == 0.0
    assert critical.value == pytest.approx(1.0, abs=1e-10)


def test_falling_friction_in_closed_form():
    """mu'(v) N = -c with mu = mu_k + (mu_s - mu_k) exp(-v/v_s): v = v_s ln((mu_s - mu_k) N/(v_s c))."""
    law = fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.2, exponent=1.0)
    scene = fm.models.belt_oscillator(damping=0.05, law=law)
    (critical,) = complex_eigenvalues(scene, over="belt.velocity.x", values=np.linspace(0.1, 1, 10)).critical
    assert critical.value == pytest.approx(0.2 * np.log(0.2 / (0.2 * 0.05)), abs=1e-10)
    assert not critical.unstable_above


def test_friction_across_slip_is_a_dashpot():
    """mu N/r across the direction of slip, mu' N along it."""
    mu, N, r, m, k = 0.4, 2.0, 0.5, 1.5, 3.0
    puck, belt = fm.Body("puck", mass=m, axes="xy"), fm.Driven("belt", velocity={"x": r})
    law = fm.laws.HyperbolicStribeck(mu_s=mu * (1 + r), mu_k=0.0, delta=1.0)
    springs = [fm.Spring(f"k{c}", puck, axis=c, stiffness=k) for c in "xy"]
    scene = fm.Scene("puck", [puck, belt, *springs, fm.Contact("sole", puck, belt, law=law, normal_force=N)])
    found = complex_eigenvalues(scene, over="belt.velocity.x", values=[r]).eigenvalues[0]
    across = np.roots([m, mu * N / r, k])
    along = np.roots([m, float(law.derivative(r)) * N, k])
    expected = [root for root in (*across, *along) if root.imag > 0]
    assert np.sort_complex(found) == pytest.approx(np.sort_complex(np.array(expected)), rel=1e-12)


@pytest.mark.parametrize("count", [7, 8, 40])
def test_modes_keep_their_identity_where_frequencies_cross(count):
    """Springs along and across the slip: the one along passes the frequency of the other."""
    puck, belt = fm.Body("puck", mass=1.0, axes="xy"), fm.Driven("belt", velocity={"x": 1.0})
    springs = [fm.Spring(f"k{c}", puck, axis=c, stiffness=4.0) for c in "xy"]
    sole = fm.Contact("sole", puck, belt, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0)
    scene = fm.Scene("puck", [puck, belt, *springs, sole])
    found = complex_eigenvalues(scene, over="kx.stiffness", values=np.linspace(1.0, 9.1, count))
    along = int(np.argmax(np.abs(found.shapes[0, :, 0])))
    assert found.frequency[:, along] == pytest.approx(np.sqrt(found.values))
    assert found.frequency[:, 1 - along] == pytest.approx(np.sqrt(4 - 0.05**2))
    assert np.abs(found.shapes[:, along, 1]).max() < 1e-9


def everything():
    """A scene with every kind of element, law and normal force, and a state at which all contacts slide."""
    a, b = fm.Body("a", mass=1.0, axes="xy"), fm.Body("b", mass=2.0, axes="xyz")
    plate = fm.ModalBody(
        "plate", frequencies=[1.0, 2.5], damping_ratios=0.02, shapes={"tip": [[0.5, 0.2], [0.1, -0.4]]}, axes="xy"
    )
    belt = fm.Driven("belt", velocity={"x": 0.7, "y": -0.2})
    bristle = fm.laws.LuGre(sigma0=50.0, sigma1=0.5, sigma2=0.1, mu_s=0.6, mu_k=0.4, v_s=0.1)
    load = 2.0 + 0.3 * fm.coordinate("a.x") ** 2 + 0.1 * fm.speed("b.z")
    return fm.Scene(
        "everything",
        [
            a,
            b,
            plate,
            belt,
            fm.Spring("k1", a, b, axis="x", stiffness=3.0, cubic=0.4),
            fm.PointSpring("k2", a, anchor=(1.0, 2.0), stiffness=2.0, length=0.5),
            fm.PointDamper("c2", a, anchor=(1.0, 2.0), damping=0.3),
            fm.Damper("c1", b, axis="y", damping=0.2),
            fm.Spring("kz", b, axis="z", stiffness=5.0),
            fm.Spring("kt", plate.point("tip"), b, axis="y", stiffness=1.0),
            fm.Contact("one", a, belt, law=fm.laws.Stribeck(mu_s=0.5, mu_k=0.3, v_s=0.3), normal_force=load, axes="xy"),
            fm.Contact("two", b, belt, law=bristle, normal_force=3.0, axes="xy"),
            fm.Contact(
                "three",
                b,
                law=fm.laws.Coulomb(mu_s=0.3),
                normal_force=fm.normal.Spring(axis="z", stiffness=4.0, damping=0.2, preload=6.0),
                slide=(0.4, 0.1),
                axes="xy",
            ),
        ],
    )


def test_derivatives_are_those_of_the_forces():
    system = build(everything())
    rng = np.random.default_rng(4)
    n, n_z = system.problem.n, system.problem.n_z
    y = np.concatenate([0.2 * rng.standard_normal(n), 0.2 * rng.standard_normal(n), 0.005 * rng.standard_normal(n_z)])

    def at(y):
        return linearise(system, y[:n], y[n : 2 * n], y[2 * n :])

    here = at(y)
    for i in range(y.size):
        h = 1e-6 if i < 2 * n else 1e-8
        up, down = at(y + h * np.eye(y.size)[i]), at(y - h * np.eye(y.size)[i])
        assert here.force_y[:, i] == pytest.approx((up.force - down.force) / (2 * h), rel=1e-6, abs=1e-6)
        assert here.rate_y[:, i] == pytest.approx((up.rate - down.rate) / (2 * h), rel=1e-6, abs=1e-6)


def test_equilibrium_of_everything_balances():
    steady = steady_sliding(everything())
    system = build(everything())
    at = linearise(system, steady.q, steady.v, steady.z)
    assert np.abs(at.force).max() < 1e-12
    assert np.abs(at.rate).max() < 1e-12
    assert (at.N > 1).all()
    start = steady.initial(push={"a.x": 0.25})
    assert start["velocity"]["a.x"] == 0.25
    assert start["state"]["two"] == pytest.approx(steady.z)


def test_a_run_grows_as_the_eigenvalue_says():
    scene = two_modes(mu=0.9, damping=(0.02, 0.05))
    steady = steady_sliding(scene)
    found = complex_eigenvalues(scene, over="lining.law.mu_k", values=[0.9])
    k = int(np.argmax(found.growth[0]))
    sol = fm.simulate(scene, t_end=60.0, rtol=1e-11, initial=steady.initial(push={"mass.x": 1e-7}))
    period = 2 * np.pi / found.frequency[0, k]
    t = 30.0 + period * np.arange(5)
    off = sol.at(t)["mass.x"] - steady.position("mass.x")
    assert np.diff(np.log(np.abs(off))) == pytest.approx(found.growth[0, k] * period, rel=1e-3)


def test_map_over_two_parameters():
    loads = np.linspace(0.5, 2.0, 4)
    found = stability_map(
        two_modes(), over=("lining.law.mu_k", "lining.normal_force.preload"), values=(np.linspace(0.6, 0.9, 4), loads)
    )
    assert found.growth.shape == (4, 4)
    assert (found.unstable == (found.values[0] > 0.75)[:, None]).all()
    s = np.sqrt(np.maximum(4 * found.values[0] / 3 - 1, 0))
    assert found.growth == pytest.approx(np.sqrt(2 + 1j * s).imag[:, None] * np.ones(4), abs=1e-7)
    assert found.frequency[-1] == pytest.approx(np.sqrt(2 + 1j * s[-1]).real)


def test_a_speed_that_is_held():
    scene = fm.models.brake4dof("2")
    steady = steady_sliding(scene, speeds={"rotor.x": 10.0})
    assert steady.position("pad.x") == pytest.approx(15.0)
    assert steady.acceleration == pytest.approx({"rotor.x": -0.015})
    found = complex_eigenvalues(scene, over="rotor.x", values=[5.0, 10.0], speeds={"rotor.x": 10.0})
    pad_y = np.argmax(np.abs(found.shapes[-1, :, found.dofs.index("pad.y")]))
    # friction across is a dashpot of mu N/v: 1.5 on a pad of mass 1
    assert found.growth[-1, pad_y] == pytest.approx(-0.75, rel=1e-3)
    assert not found.critical


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: steady_sliding(fm.models.brake4dof("2")), "contact 'lining' does not slide"),
        (lambda: steady_sliding(fm.models.brake4dof("2"), speeds={"rotor.z": 1.0}), "rotor.x"),
        (lambda: steady_sliding(fm.models.puck_on_belt()), "no equilibrium; puck.x is left with a force"),
        (lambda: steady_sliding(driven_in_time()), "the force on mass.x depends on time"),
        (lambda: complex_eigenvalues(two_modes(), over="lining.law.mu", values=[0, 1]), "lining.law.mu_k"),
        (lambda: complex_eigenvalues(two_modes(), over="lining.law.mu_k", values=[0, 0]), "rising or falling"),
        (
            lambda: complex_eigenvalues(fm.models.brake4dof(), over="rotor.x", values=[1, 0], speeds={"rotor.x": 1.0}),
            "does not slide; .*at rotor.x = 0",
        ),
        (lambda: stability_map(two_modes(), over=("a",), values=([1],)), "two each"),
    ],
)
def test_what_cannot_be_is_said(call, named):
    with pytest.raises(fm.FricmbError, match=named):
        call()


def driven_in_time():
    scene = fm.models.belt_oscillator()
    import sympy

    return fm.Scene("driven", [*scene.parts, fm.Force("push", scene["mass"], axis="x", value=sympy.sin(fm.t))])


@pytest.mark.parametrize("n", [7, 8])
def test_a_critical_value_on_the_grid_is_found_as_well_as_one_between(n):
    """The slope of friction over a slow belt falls to 0 at 0.1: a value of the first grid, not of the second."""
    law = fm.laws.Cubic(mu_s=0.6, mu_m=0.4, v_m=0.1)
    scene = fm.models.belt_oscillator(law=law)
    found = fm.analysis.complex_eigenvalues(scene, over="belt.velocity.x", values=np.linspace(0.05, 0.2, n))
    (critical,) = found.critical
    assert critical.value == pytest.approx(0.1, rel=1e-12)
    assert critical.frequency == pytest.approx(1.0, rel=1e-12)
    assert not critical.unstable_above


def test_printed_is_a_table_of_motion_and_contacts():
    steady = fm.analysis.steady_sliding(fm.models.minimal_flutter())
    lines = str(steady).splitlines()
    assert len(lines) == 6
    assert lines[1].split()[0] == "block.x"
    assert float(lines[1].split()[1]) == pytest.approx(steady.position("block.x"), rel=1e-5)
    assert lines[-1].split()[0] == "sole"
    assert len(repr(steady)) < 100


def _two_masses():
    """Two masses on a disc, each with its own contact, and the damping matrix of steady sliding at a speed."""
    law = fm.laws.Stribeck(mu_s=0.6, mu_k=0.4, v_s=0.05)
    disc = fm.Driven("disc", velocity={"x": 1.0})
    a, b = (fm.Body(name, mass=1.0) for name in "ab")
    return fm.Scene("two masses", [
        disc, a, b,
        fm.Spring("ka", a, axis="x", stiffness=100.0),
        fm.Spring("kb", b, axis="x", stiffness=400.0),
        fm.Spring("k", a, b, axis="x", stiffness=50.0),
        fm.Damper("ca", a, axis="x", damping=0.2),
        fm.Damper("cb", b, axis="x", damping=0.3),
        fm.Contact("fa", a, disc, law=law, normal_force=20.0),
        fm.Contact("fb", b, disc, law=law, normal_force=20.0),
    ])  # fmt: skip


def _two_masses_by_hand(speed):
    slope = -20.0 * 0.2 * 2.0 * speed / 0.05**2 * np.exp(-((speed / 0.05) ** 2))
    C = np.diag([0.2 + slope, 0.3 + slope])
    K = np.array([[150.0, -50.0], [-50.0, 450.0]])
    return np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-K, -C]]))


def _critical_by_hand():
    """Speeds at which the number of growing eigenvalues changes, by bisection, and the frequency there."""
    speeds = np.linspace(0.02, 3.0, 20001)
    counts = [int((_two_masses_by_hand(v).real > 0.0).sum()) for v in speeds]
    found = []
    for i in np.flatnonzero(np.diff(counts)):
        low, high = speeds[i], speeds[i + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            if (_two_masses_by_hand(middle).real > 0.0).sum() == counts[i]:
                low = middle
            else:
                high = middle
        there = _two_masses_by_hand(low)
        found.append((low, abs(there[np.argmin(np.abs(there.real))].imag)))
    return found


@pytest.mark.parametrize("count", [3, 7])
def test_no_crossing_is_missed_over_a_coarse_grid(count):
    """At low speed both pairs are overdamped and grow: no mode can be followed from there."""
    found = fm.analysis.complex_eigenvalues(
        _two_masses(), over="disc.velocity.x", values=np.linspace(0.02, 3.0, count)
    )
    wanted = _critical_by_hand()
    assert len(wanted) == 2
    assert [(c.value, c.frequency) for c in found.critical] == [pytest.approx(pair, rel=1e-9) for pair in wanted]
    assert {c.kind for c in found.critical} == {"flutter"}
    assert not any(c.unstable_above for c in found.critical)


def test_one_degree_of_freedom_does_not_flutter():
    scene = _two_masses()
    kept = ("disc", "a", "ka", "ca", "fa")
    alone = fm.Scene("one mass", [part for part in scene.parts if part.name in kept])
    (critical,) = fm.analysis.complex_eigenvalues(alone, over="disc.velocity.x", values=[0.05, 1.0]).critical
    assert critical.kind == "self-excitation"
    assert critical.frequency == pytest.approx(10.0, rel=1e-9)


def test_undamped_modes_are_not_unstable_by_round_off():
    """Friction that does not couple: all growth rates are 0 but for the last digits of the highest frequency."""
    k = np.arange(30.0)
    body = fm.ModalBody(
        "b", frequencies=np.linspace(1e3, 3e4, 30), damping_ratios=0.0, axes="xz",
        shapes={"p": np.vstack([np.cos(k), np.sin(3.0 * k)])},
    )  # fmt: skip
    belt, mu = fm.Driven("d", velocity={"x": 5.0}), fm.parameter("mu", 0.1)
    pressed = fm.normal.Spring(axis="z", stiffness=1e3, preload=10.0)
    law = fm.laws.Coulomb(mu_s=mu, mu_k=mu)
    scene = fm.Scene("s", [body, belt, fm.Contact("k", body.point("p"), belt, law=law, normal_force=pressed, axes="x")])
    found = complex_eigenvalues(scene, over="mu", values=np.linspace(0.0, 0.5, 4))
    assert 0.0 < np.abs(found.growth).max() < 1e-8
    assert "no change of stability" in str(found)
    # slow growth beside high frequencies is growth all the same
    slow = scene.replace("k", law=fm.laws.Stribeck(mu_s=0.3, mu_k=mu, v_s=5.0, exponent=1.0))
    grows = complex_eigenvalues(slow, over="mu", values=[0.1, 0.11])
    assert grows.growth.max() < 1e-3 * grows.frequency.max()
    assert "unstable throughout" in str(grows)
