"""Ropes whose spans stretch and whose ends are pulled, against closed forms and a program of its own."""

import math
import pickle

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import fricmb as fm

MU, PHI, R, J = 0.3, math.pi, 0.2, 0.5
RATIO = math.exp(MU * PHI)
K, SPRING = (400.0, 300.0), 40.0
AXES = {"axes": ("x", "x"), "angle": PHI, "friction": MU}


def weight(t):
    return 20.0 + 12.0 * math.sin(5.0 * t)


def scene(kind, **more):
    """A load on a span, a drum on a spring, and at the other end a weight on a span, one without, or a tension."""
    drum, load = fm.RigidBody("drum", mass=5.0, inertia=J), fm.Body("load", mass=2.0, position={"x": 0.05})
    b = fm.Body("b", mass=3.0)
    given = {
        "both": {"stiffness": K, "damping": (4.0, 4.0), "pretension": 20.0},
        "one": {"stiffness": (K[0], None), "pretension": 20.0},
        "pulled": {"stiffness": (K[0], None), "damping": (4.0, None)},
    }[kind]
    pulled = kind == "pulled"
    rope = fm.Rope("rope", (load, 20.0 if pulled else b), **AXES, drum=drum, radius=R, **given, **more)
    other = [] if pulled else [b, fm.Force("p", b, axis="x", value=20.0)]
    return fm.Scene(kind, [
        drum, fm.Revolute("hub", drum), load, *other, rope, fm.TorsionSpring("spring", drum, stiffness=SPRING),
        fm.Force("w", load, axis="x", value=20.0 + 12.0 * sympy.sin(5 * fm.t)),
    ])  # fmt: skip


class Own:
    """The same from transition to transition by scipy: y = [x1, x2, angle, their rates, way s of the rope].

    Where the rope slips, its rate follows from ``T1 = T2 e^(mu angle)`` and the like; on a side without a span it is
    the rate of the end.
    """

    def __init__(self, kind):
        self.kind, self.c = kind, 0.0 if kind == "one" else 4.0

    def tensions(self, y, rate):
        x1, x2, _, v1, v2, _, s = y
        first = K[0] * (x1 + s) + self.c * (v1 + rate)
        if self.kind == "pulled":
            return first, 20.0
        return first, K[1] * (x2 - s + 20.0 / K[1]) + self.c * (v2 - rate)

    def slip_rate(self, y, ratio):
        if self.kind == "one":
            return y[4]
        (a, b), (c, d) = self.tensions(y, 0.0), self.tensions(y, 1.0)
        return (ratio * b - a) / ((c - a) - ratio * (d - b))

    def rates(self, t, y, ratio):
        if self.kind == "one":
            return self.one(t, y, ratio)
        rate = R * y[5] if ratio is None else self.slip_rate(y, ratio)
        first, second = self.tensions(y, rate)
        held = 0.0 if self.kind == "pulled" else (20.0 - second) / 3.0
        turn = (-R * (first - second) - SPRING * y[2]) / J
        return [*y[3:6], (weight(t) - first) / 2.0, held, turn, rate]

    def one(self, t, y, ratio):
        """The second end is the rope itself: x2 = s."""
        first = K[0] * (y[0] + y[6])
        a1 = (weight(t) - first) / 2.0
        if ratio is None:
            # drum and b as one: (J/R^2 + m) a2 = p - T1 - spring
            a2 = (20.0 - first - SPRING * y[2] / R) / (J / R**2 + 3.0)
            return [*y[3:6], a1, a2, a2 / R, y[4]]
        second = first / ratio
        return [*y[3:6], a1, (20.0 - second) / 3.0, (-R * (first - second) - SPRING * y[2]) / J, y[4]]

    def spare(self, t, y):
        """How far within both limits the tensions are while it sticks."""
        first, second = self.tensions(y, R * y[5])
        if self.kind == "one":
            first = K[0] * (y[0] + y[6])
            second = 20.0 - 3.0 * self.one(t, y, None)[4]
        return min(RATIO * second - first, RATIO * first - second), first > second

    def slip(self, y, ratio):
        return self.slip_rate(y, ratio) - R * y[5]

    def run(self, t_end):
        t, y, ratio, events = 0.0, np.array([0.05, 0, 0, 0, 0, 0, 0.0]), None, []
        while t < t_end:
            def end(t, y, ratio=ratio):
                return self.spare(t, y)[0] if ratio is None else self.slip(y, ratio)

            out = solve_ivp(
                self.rates, (t, t_end), y, args=(ratio,), rtol=1e-11, atol=1e-13, dense_output=True, max_step=0.01,
            )  # fmt: skip
            values = np.array([end(*at) for at in zip(out.t, out.y.T, strict=True)])
            signs = np.sign(values[2:])
            change = np.flatnonzero(signs[:-1] != signs[1:]) + 2
            if not change.size:
                return out.y[:, -1], events
            i = change[0]
            t = brentq(lambda at, f=out.sol: end(at, f(at)), out.t[i], out.t[i + 1], xtol=1e-14)
            y = out.sol(t)
            ratio = (RATIO if self.spare(t, y)[1] else 1.0 / RATIO) if ratio is None else None
            events.append(t)
        return y, events


@pytest.mark.parametrize("kind", ["both", "one", "pulled"])
def test_elastic_spans_are_those_of_a_program_of_events(kind):
    y, events = Own(kind).run(3.0)
    for rtol, off in ((1e-6, 1e-8), (1e-9, 2e-9)):
        sol = fm.simulate(scene(kind), t_end=3.0, rtol=rtol)
        assert [event.kind for event in sol.events] == ["slip", "stick", "slip", "stick"]
        np.testing.assert_allclose(sol.events.t, events, atol=off)
        assert sol["load.x"][-1] == pytest.approx(y[0], abs=off)
        assert sol["drum.angle"][-1] == pytest.approx(y[2], abs=off)
        first, second = sol.tensions("rope")
        assert max((first / second).max(), (second / first).max()) <= RATIO * (1 + 1e-12)
        slips = sol.mode("rope") == 1
        np.testing.assert_allclose(np.abs(np.log(first / second))[slips], MU * PHI, rtol=1e-12)
        assert np.abs(sol.energy.residual).max() < 1e-9
        assert sol.audit().ok


@pytest.mark.parametrize("up", [True, False])
def test_a_hand_that_is_no_body(up):
    """m x'' = w - T2 e^(-+mu phi) from the instant at which the pull T2(t) reaches w e^(+-mu phi)."""
    ratio, w, m = RATIO if up else 1.0 / RATIO, 20.0, 2.0
    load, rate = fm.Body("load", mass=m), 20.0 * (ratio - 1.0)
    rope = fm.Rope("rope", (load, 20.0 + rate * fm.t), axes="x", angle=PHI, friction=MU)
    sol = fm.simulate(fm.Scene("s", [load, rope, fm.Force("w", load, axis="x", value=w)]), t_end=1.5, rtol=1e-9)
    assert [(event.kind, event.t) for event in sol.events] == [("slip", pytest.approx(1.0, rel=1e-12))]
    first, second = sol.tensions("rope")
    np.testing.assert_allclose(second, 20.0 + rate * sol.t, rtol=1e-9)
    assert second[-1] / first[-1] == pytest.approx(ratio, rel=1e-12)
    assert sol["load.x"][-1] == pytest.approx(-rate / ratio * 0.5**3 / 6.0 / m, rel=1e-8)
    assert sol.energy.friction_loss[-1] > 0.0
    assert np.abs(sol.energy.residual).max() < 1e-12


def test_a_load_swings_on_a_span_while_the_rope_holds():
    """Its own frequency sqrt(k/m), about the stretch of its weight."""
    m, k, w = 2.0, 300.0, 30.0
    load, b = fm.Body("load", mass=m, velocity={"x": 0.5}), fm.Body("b", mass=3.0)
    rope = fm.Rope("rope", (load, b), **AXES, stiffness=(k, None), pretension=w)
    pulls = [fm.Force(f"w{body.name}", body, axis="x", value=w) for body in (load, b)]
    sol = fm.simulate(fm.Scene("s", [load, b, rope, *pulls]), t_end=3.0, rtol=1e-10)
    assert not len(sol.events)
    omega = math.sqrt(k / m)
    np.testing.assert_allclose(sol["load.x"], 0.5 / omega * np.sin(omega * sol.t), atol=1e-9)
    np.testing.assert_allclose(sol.tensions("rope")[0], w + k * sol["load.x"], rtol=1e-8)


def test_a_tension_that_was_measured_and_a_law_with_more_at_break_away():
    load = fm.Body("load", mass=2.0)
    pull = fm.Signal([0.0, 1.0, 2.0], [20.0, 20.0, 200.0])
    law = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
    rope = fm.Rope("rope", (pull, load), axes=(None, "x"), angle=PHI, friction=law)
    sol = fm.simulate(fm.Scene("s", [load, rope, fm.Force("w", load, axis="x", value=20.0)]), t_end=2.0, rtol=1e-9)
    assert sol.events[0].t == pytest.approx(1.0 + 20.0 * (math.exp(0.5 * PHI) - 1.0) / 180.0, rel=1e-9)
    first, second = sol.tensions("rope")
    assert first[-1] / second[-1] == pytest.approx(math.exp(0.3 * PHI), rel=1e-10)


def test_a_load_that_is_out_of_balance_at_the_start():
    """Speeds that light ends would reach without friction are no measure of slip: stick is found all the same."""
    sol = fm.simulate(
        scene("both").with_parameters({"rope_2.position.x": -0.05, "rope.length": -0.05}), t_end=3.0, rtol=1e-9
    )
    # by the program above, whose second span has 15 in place of 20 at the start
    own = Own("both")
    own.tensions = lambda y, rate, held=own.tensions: (held(y, rate)[0], held(y, rate)[1] - 5.0)
    y, events = own.run(3.0)
    np.testing.assert_allclose(sol.events.t, events, atol=2e-9)
    assert sol["load.x"][-1] == pytest.approx(y[0], abs=2e-9)


def test_sensitivities_know_spans_and_friction():
    def made(**values):
        return scene("both").with_parameters({name.replace("__", "."): v for name, v in values.items()})

    names = {"rope_1_span__stiffness": 400.0, "rope__mu": 0.3}
    sol = fm.simulate(made(), t_end=2.0, rtol=1e-10, sensitivities=tuple(n.replace("__", ".") for n in names))
    for name, at in names.items():
        d = 1e-5 * at
        high, low = (fm.simulate(made(**{name: at + s}), t_end=2.0, rtol=1e-11)["load.x"][-1] for s in (d, -d))
        found = sol.sensitivity("load.x", name.replace("__", "."))[-1]
        assert found == pytest.approx((high - low) / (2 * d), rel=1e-4)


def test_copies_and_files(tmp_path):
    declared = scene("pulled")
    changed = declared.with_parameters({"rope_1_span.stiffness": 500.0, "rope_2_pull.value": 25.0, "load.mass": 2.5})
    assert changed["rope_1_span"].a is changed["load"]
    assert changed["rope"].a is changed["rope_1"]
    again = fm.Scene("again", changed.parts)
    assert again.parameters == changed.parameters
    sol = fm.simulate(changed, t_end=0.5)
    sol.save(tmp_path / "run.npz")
    loaded = fm.Solution.load(tmp_path / "run.npz")
    assert loaded.scene.parameters == changed.parameters
    np.testing.assert_array_equal(loaded.tensions("rope"), sol.tensions("rope"))
    assert pickle.loads(pickle.dumps(changed)).parameters == changed.parameters
    # another rope of the same name brings its own
    other = [part for part in changed.parts if part.name != "rope"]
    new = fm.Rope("rope", (changed["load"], 20.0), axes="x", angle=PHI, friction=MU)
    assert "rope_1_span" not in fm.Scene("new", [*other, new])
    with pytest.raises(fm.FricmbError, match="rope"):
        sol.tensions("hub")


def test_what_cannot_be_is_refused_by_name():
    a, b = fm.Body("a", mass=1.0), fm.Body("b", mass=1.0)
    for match, ends, more in [
        ("one end and a tension", (10.0, 20.0), {}),
        ("ends must be", (a, -1.0), {}),
        ("ends must be", (a, "b"), {}),
        ("the direction of the end that is no tension", (a, 10.0), {"axes": ("x", "y", "z")}),
        ("stiffness must be two numbers", (a, b), {"stiffness": 100.0}),
        ("stiffness must be a finite number > 0", (a, b), {"stiffness": (0.0, None)}),
        ("None on the side of a tension", (a, 10.0), {"stiffness": (None, 10.0)}),
        ("left out where a span does not stretch", (a, b), {"damping": (1.0, None)}),
        ("damping must be > 0 where no end", (a, b), {"stiffness": (10.0, 10.0), "damping": (1.0, None)}),
        ("damping must be > 0 where no end", (a, 10.0), {"stiffness": (10.0, None)}),
        ("damping must be > 0 beside when_slack", (a, b), {"stiffness": (10.0, None), "when_slack": "open"}),
        ("drum must be one that turns", (a, fm.GROUND), {"stiffness": (10.0, None)}),
        ("pretension must be a finite number >= 0", (a, b), {"stiffness": (10.0, None), "pretension": -1.0}),
    ]:
        with pytest.raises(fm.SceneError, match=match):
            fm.Rope("rope", ends, **{**AXES, **more})
