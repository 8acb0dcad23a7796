"""Break-away that exceeds slip by different amounts forward and back, against a program of events of its own."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

STATIC, KINETIC, N, MASS, K = (0.3, 0.8), (0.2, 0.5), 10.0, 2.0, 30.0
LAW = fm.laws.Offset.by_sense(mu_s=STATIC, mu_k=KINETIC)
#: How far the program looks for an event at a time: what lies behind one is done again.
AHEAD = 0.5
#: Phases of the loads on blocks in a row.
PHASES = (0.0, 1.0, 2.5)


def load(t, phase, functions=math):
    return 9.0 * functions.sin(2.0 * t + phase) + 2.0 * functions.sin(5.3 * t)


@cache
def own_row(n, t_end):
    """Blocks on springs of their own and between neighbours; masses do not couple, so each decides alone."""
    stiff = (np.diag(np.full(n, K)) + 0.3 * K * (2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1))) if n > 1 else K
    t, y, modes, events = 0.0, np.zeros(2 * n), [0] * n, []

    def pulls(t, x):
        return np.array([load(t, p) for p in PHASES[:n]]) - (stiff @ x if n > 1 else K * x)

    def rates(t, y):
        v, a = np.zeros(n), np.zeros(n)
        for i, pull in enumerate(pulls(t, y[:n])):
            if modes[i]:
                v[i] = y[n + i]
                a[i] = (pull - (KINETIC[0] if modes[i] > 0 else -KINETIC[1]) * N) / MASS
        return [*v, *a]

    def spare(i, t, y):
        if modes[i]:
            return modes[i] * y[n + i]
        pull = pulls(t, y[:n])[i]
        return min(STATIC[0] * N - pull, STATIC[1] * N + pull)

    for i, pull in enumerate(pulls(0.0, y[:n])):
        if not -STATIC[1] * N <= pull <= STATIC[0] * N:
            modes[i] = 1 if pull > 0.0 else -1
    while True:
        until = min(t + AHEAD, t_end)
        out = solve_ivp(rates, (t, until), y, rtol=1e-12, atol=1e-14, dense_output=True, max_step=4e-3, method="DOP853")
        found = []
        for i in range(n):
            values = np.array([spare(i, *at) for at in zip(out.t, out.y.T, strict=True)])
            below = np.flatnonzero((values[:-1] > 0.0) & (values[1:] <= 0.0))
            if below.size:
                low, high = out.t[below[0]], out.t[below[0] + 1]
                found.append((brentq(lambda s, i=i, f=out.sol: spare(i, s, f(s)), low, high, xtol=1e-15), i))
        if not found:
            t, y = until, out.y[:, -1]
            if t == t_end:
                return y, events
            continue
        t, i = min(found)
        y = out.sol(t)
        y[n + i] = 0.0
        pull = pulls(t, y[:n])[i]
        kind = "slip"
        if modes[i] == 0:
            modes[i] = 1 if pull > 0.0 else -1
        elif -STATIC[1] * N <= pull <= STATIC[0] * N:
            modes[i], kind = 0, "stick"
        else:
            modes[i], kind = -modes[i], "reversal"
        events.append((kind, t))


def row(n):
    t, bodies = fm.t, [fm.Body(f"b{i}", mass=MASS) for i in range(n)]
    parts = []
    for i, body in enumerate(bodies):
        parts += [
            body, fm.Spring(f"k{i}", body, axis="x", stiffness=K), fm.Contact(f"c{i}", body, law=LAW, normal_force=N),
            fm.Force(f"f{i}", body, axis="x", value=load(t, PHASES[i], sympy)),
        ]  # fmt: skip
    ends = [fm.GROUND, *bodies, fm.GROUND] if n > 1 else []
    for i, (a, b) in enumerate(pairwise(ends)):
        first, second = (a, b) if a is not fm.GROUND else (b, a)
        parts.append(fm.Spring(f"tie{i}", first, second, axis="x", stiffness=0.3 * K))
    return fm.Scene("row", parts)


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize("n", [1, 3])
def test_break_away_is_located_in_both_senses(method, n):
    y, events = own_row(n, 12.0)
    assert {kind for kind, _ in events} == {"slip", "stick", "reversal"}
    sol = fm.simulate(row(n), t_end=12.0, rtol=1e-9, method=method)
    assert [event.kind for event in sol.events] == [kind for kind, _ in events]
    np.testing.assert_allclose(sol.events.t, [t for _, t in events], atol=1e-9)
    np.testing.assert_allclose([sol[f"b{i}.x"][-1] for i in range(n)], y[:n], atol=1e-9)
    force = sol.force("c0")[0]
    assert force.min() == pytest.approx(-STATIC[0] * N, rel=1e-9)
    assert force.max() == pytest.approx(STATIC[1] * N, rel=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-9
    assert sol.audit().ok


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_on_a_hinge(method):
    y, events = own_row(1, 12.0)
    arm = fm.RigidBody("arm", mass=1.0, inertia=MASS)
    pin = fm.Revolute("pin", arm)
    scene = fm.Scene("servo", [
        arm, pin, fm.TorsionSpring("k", arm, stiffness=K), fm.Torque("f", arm, value=load(fm.t, 0.0, sympy)),
        fm.DryFriction("dry", arm, axis=pin, law=LAW, normal_force=N),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-9, method=method)
    assert [event.kind for event in sol.events] == [kind for kind, _ in events]
    np.testing.assert_allclose(sol.events.t, [t for _, t in events], atol=1e-9)
    assert sol["arm.angle"][-1] == pytest.approx(y[0], abs=1e-9)
    assert sol.audit().ok


def test_the_audit_sees_a_limit_of_the_other_sense():
    """A run under the limits of one sense in both is not one of this law."""
    sol = fm.simulate(row(1), t_end=3.0, rtol=1e-8)
    other = fm.simulate(row(1).with_parameters({"c0.law.rest_offset": -0.2}), t_end=3.0, rtol=1e-8)
    assert sol.audit().ok
    assert abs(float(sol.events[0].t) - float(other.events[0].t)) > 1e-3


def test_a_varying_load_and_a_file(tmp_path):
    body = fm.Body("b", mass=1.0)
    normal = 10.0 * (1.0 + 0.5 * sympy.sin(3 * fm.t))
    scene = fm.Scene("s", [
        body, fm.Contact("c", body, law=LAW, normal_force=normal),
        fm.Force("f", body, axis="x", value=8.0 * sympy.sin(fm.t)),
    ])  # fmt: skip
    sol = fm.simulate(scene, t_end=12.0, rtol=1e-9)
    share = sol.force("c")[0] / sol.normal_force("c")
    assert -STATIC[0] - 1e-8 <= share.min() < -KINETIC[0]
    assert KINETIC[1] < share.max() <= STATIC[1] + 1e-8
    first = brentq(lambda t: 8 * math.sin(t) - STATIC[0] * 10 * (1 + 0.5 * math.sin(3 * t)), 0.1, 1.0, xtol=1e-14)
    assert float(sol.events[0].t) == pytest.approx(first, rel=1e-9)
    assert sol.audit().ok
    sol.save(tmp_path / "run.npz")
    assert fm.Solution.load(tmp_path / "run.npz").scene["c"].law == LAW


def test_who_does_not_know_it_refuses_it_by_name():
    for method, more in (("collocation", {}), ("taylor", {}), ("bdf2-paper", {"step": 1e-3})):
        with pytest.raises(fm.FricmbError, match="at rest"):
            fm.simulate(row(1), t_end=1.0, method=method, **more)
    with pytest.raises(fm.FricmbError, match="exceeds slip by another amount"):
        fm.simulate(row(1), t_end=1.0, sensitivities=("c0.normal_force",))
    block = row(1).parts
    twice = fm.Scene("twice", [*block, fm.Contact("again", block[0], law=LAW, normal_force=1.0)])
    arm = fm.RigidBody("arm", mass=1.0, inertia=MASS)
    pin = fm.Revolute("pin", arm, radius=0.1, friction=fm.laws.Coulomb(mu_s=0.1))
    both = fm.Scene("both", [arm, pin, fm.Gravity("g"), fm.DryFriction("dry", arm, axis=pin, law=LAW)])
    for scene in (twice, both):
        for method in ("auto", "radau", "bdf"):
            with pytest.raises(fm.FricmbError, match="redundant"):
                fm.simulate(scene, t_end=1.0, method=method)
    with pytest.raises(fm.LawError, match="at most mu_s forward and back"):
        fm.laws.Offset.by_sense(mu_s=(0.3, 0.6), mu_k=(0.2, 0.7))
    inner = fm.laws.Coulomb(mu_s=0.5, mu_k=0.4)
    with pytest.raises(fm.LawError, match=r"within 0\.1 of offset"):
        fm.laws.Offset(law=inner, offset=0.1, rest_offset=0.3)
    with pytest.raises(fm.LawError, match="left out in two directions"):
        fm.laws.Offset(law=inner, offset=(0.1, 0.0), rest_offset=0.1)


def test_pictures_show_the_limits_at_rest():
    import matplotlib.pyplot as plt

    (ax,) = fm.simulate(row(1), t_end=6.0).plot.force("c0").axes
    limits = sorted({round(float(line.get_ydata()[0]), 9) for line in ax.lines if np.ptp(line.get_ydata()) < 1e-9})
    assert limits == pytest.approx([-STATIC[0] * N, STATIC[1] * N])
    plt.close("all")
