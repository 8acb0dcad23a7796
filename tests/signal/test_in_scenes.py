"""Measured series in scenes, beside a program of its own that solves from sample to sample, and beside formulas."""

import pickle
from functools import partial
from itertools import pairwise

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, make_interp_spline
from scipy.optimize import brentq

import fricmb as fm
from fricmb.integrate import implicit
from fricmb.integrate.methods.radau import Radau

DRY = fm.laws.Coulomb(mu_s=1.0, mu_k=0.8)
#: Spring of the block.
K = 4.0


def times(n=81):
    return np.linspace(0.0, 10.0, n)


def push(t):
    return 2.0 * np.sin(3.0 * t) + 0.5 * np.sin(17.0 * t)


FORMULA = 2 * sympy.sin(3 * fm.t) + sympy.sin(17 * fm.t) / 2


def block(load, law=DRY):
    """A block of mass 1 on a spring and on dry ground under a load."""
    body = fm.Body("b", mass=1.0)
    return fm.Scene("block", [
        body, fm.Spring("k", body, axis="x", stiffness=K), fm.Force("f", body, axis="x", value=load),
        fm.Contact("c", body, law=law, normal_force=1.0),
    ])  # fmt: skip


def roller(load):
    """A body on a line in the plane, with a joint."""
    body = fm.RigidBody("b", mass=1.0, inertia=0.1)
    return fm.Scene("roller", [
        body, fm.Gravity("g", acceleration={"y": -1.0}), fm.Force("f", body, axis="x", value=load),
        fm.RollerOnLine("c", body, friction=DRY),
    ])  # fmt: skip


def solved_from_sample_to_sample(edges, load, stiffness, mu_s=1.0, mu_k=0.8):
    """Position at the end and times of transitions of the block, by scipy on each stretch on which the load is smooth.

    ``load(t, i)``: on stretch i, its ends included.
    """
    state, events = (0.0, 0.0, 0), []
    for i, (t, end) in enumerate(pairwise(edges)):
        while t < end:
            t, state = one_phase(t, end, state, partial(load, i=i), stiffness, mu_s, mu_k, events)
    return state[0], events


def one_phase(t, end, state, load, stiffness, mu_s, mu_k, events):
    """On to the end of a stretch, or to the next transition, which is added to the list; ``state``: x, v, direction."""
    x, v, way = state
    if way == 0:
        grid = np.linspace(t, end, 60)
        pull = load(grid) - stiffness * x + 0.0 * grid
        over = np.flatnonzero(np.abs(pull) > mu_s)
        if not over.size:
            return end, state
        j, way = over[0], int(np.sign(pull[over[0]]))
        if j > 0:
            t = brentq(lambda s: way * (load(s) - stiffness * x) - mu_s, grid[j - 1], grid[j], xtol=1e-15)
        events.append(("slip", t))

    def turn(s, y):
        return way * y[1] if s > t + 1e-7 or abs(v) > 0.0 else 1.0

    turn.terminal, turn.direction = True, -1.0
    run = solve_ivp(
        lambda s, y: [y[1], load(s) - stiffness * y[0] - mu_k * way], (t, end), [x, v], method="DOP853", rtol=1e-12,
        atol=1e-14, events=turn,
    )  # fmt: skip
    t, (x, v) = run.t[-1], run.y[:, -1]
    if run.t_events[0].size:
        pull = load(t) - stiffness * x
        v, way = 0.0, -way if abs(pull) > mu_s and np.sign(pull) == -way else 0
        events.append(("reversal" if way else "stick", t))
    return t, (x, v, way)


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("kind", ["linear", "hold", "cubic"])
def test_as_a_program_of_its_own_between_the_samples(kind, method):
    t = times()
    y = push(t)
    spline = CubicSpline(t, y)
    between = {
        "linear": lambda s, i: y[i] + (y[i + 1] - y[i]) / (t[i + 1] - t[i]) * (s - t[i]),
        "hold": lambda s, i: y[i] + 0.0 * s,
        "cubic": lambda s, i: spline(s),
    }[kind]
    x, events = solved_from_sample_to_sample(t, between, K)
    sol = fm.simulate(block(fm.Signal(t, y, kind=kind)), t_end=10.0, rtol=1e-8, method=method)
    assert [e.kind for e in sol.events] == [kind for kind, _ in events]
    assert [e.t for e in sol.events] == pytest.approx([at for _, at in events], abs=2e-8)
    assert sol["b.x"][-1] == pytest.approx(x, abs=2e-8)
    assert sol.audit().ok


def test_many_values_on_lines_take_few_stages(monkeypatch):
    """Steps from value to value are so short that three stages do what six do; cubics and other loads keep theirs."""
    taken, general = [], implicit.stages_for
    monkeypatch.setattr(implicit, "stages_for", lambda *given: taken.append(general(*given)) or taken[-1])
    t = np.linspace(0.0, 2.5, 2001)
    y = push(t)
    line = lambda s, i: y[i] + (y[i + 1] - y[i]) / (t[i + 1] - t[i]) * (s - t[i])  # noqa: E731
    x, events = solved_from_sample_to_sample(t, line, K)
    scene, fine = block((t, y)), np.linspace(0.0, 2.5, 7001)
    for rtol in (1e-6, 1e-8):
        for method in ("radau", "bdf"):
            sol = fm.simulate(scene, t_end=2.5, rtol=rtol, method=method)
            assert [e.kind for e in sol.events] == [kind for kind, _ in events]
            assert [e.t for e in sol.events] == pytest.approx([at for _, at in events], abs=rtol)
            assert sol["b.x"][-1] == pytest.approx(x, abs=0.1 * rtol)
            assert sol.audit().ok
            # between the nodes, too
            how = {"t_end": 2.5, "t_eval": fine, "rtol": rtol}
            few, more = fm.simulate(scene, method=method, **how), fm.simulate(scene, method=Radau(stages=7), **how)
            assert np.abs(few.velocity("b.x") - more.velocity("b.x")).max() < rtol
    for load, stages in ((fm.Signal(t, y), 3), (fm.Signal(t, y, kind="cubic"), 7), (fm.Signal(t, y) + FORMULA, 7)):
        taken.clear()
        fm.simulate(block(load), t_end=2.5, rtol=1e-6, method="radau")
        assert taken == [stages]


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_the_same_with_a_joint(method):
    t = times()
    y = push(t)
    line = lambda s, i: y[i] + (y[i + 1] - y[i]) / (t[i + 1] - t[i]) * (s - t[i])  # noqa: E731
    x, events = solved_from_sample_to_sample(t, line, 0.0)
    sol = fm.simulate(roller((t, y)), t_end=10.0, rtol=1e-8, method=method)
    assert [e.t for e in sol.events] == pytest.approx([at for _, at in events], abs=1e-7)
    assert sol["b.x"][-1] == pytest.approx(x, rel=1e-7)


def on(field, value):
    """A block on a spring that a series reaches in another way than by a force."""
    body = fm.Body("b", mass=1.0, velocity={"x": 1.0 if field == "normal_force" else 0.0})
    belt = fm.Driven("belt", **{field: {"x": value}}) if field in ("velocity", "position") else None
    spring = fm.Spring("k", body, *([belt] if field == "position" else []), axis="x", stiffness=K)
    ends = [body, belt] if field == "velocity" else [body]
    given = {"normal_force": 1.0, **({field: value} if field in ("normal_force", "slide") else {})}
    parts = [body, *([belt] if belt else []), spring, fm.Contact("c", *ends, law=DRY, **given)]
    if field == "normal_force":
        parts.append(fm.Force("f", body, axis="x", value=1.2 * sympy.sin(2 * fm.t)))
    return fm.Scene(field, parts)


@pytest.mark.parametrize("field", ["velocity", "position", "slide", "normal_force"])
def test_wherever_an_expression_may_stand(field):
    t = times(2001)
    value, formula = (
        (push(t), FORMULA) if field != "normal_force" else (1 + 0.5 * np.sin(5 * t), 1 + sympy.sin(5 * fm.t) / 2)
    )
    sol = fm.simulate(on(field, fm.Signal(t, value, kind="cubic")), t_end=10.0, rtol=1e-8)
    ref = fm.simulate(on(field, formula), t_end=10.0, rtol=1e-8)
    assert [e.kind for e in sol.events] == [e.kind for e in ref.events]
    assert sol["b.x"][-1] == pytest.approx(ref["b.x"][-1], abs=1e-7)  # the spline is off by 1e-8
    assert sol.audit().ok


@pytest.mark.parametrize("given", ["angle", "speed"])
def test_a_driven_joint(given):
    t = times(2001)

    def arm(value):
        body = fm.RigidBody("b", mass=1.0, inertia=0.1)
        weight = fm.Gravity("g", acceleration={"y": -1.0})
        return fm.Scene(
            "arm", [body, weight, fm.Revolute("pin", body), fm.DrivenAngle("drive", body, **{given: value})]
        )

    sol = fm.simulate(arm(fm.Signal(t, push(t), kind="cubic")), t_end=10.0, rtol=1e-8)
    ref = fm.simulate(arm(FORMULA), t_end=10.0, rtol=1e-8)
    assert sol["b.angle"][-1] == pytest.approx(ref["b.angle"][-1], abs=1e-7)
    assert sol.audit().ok


def test_an_integral_moves_what_is_driven_by_a_velocity():
    t = times(301)
    y = push(t)
    for kind, way in (("linear", np.trapezoid(y, t)), ("hold", (y[:-1] * np.diff(t)).sum())):
        sol = fm.simulate(on("velocity", fm.Signal(t, y, kind=kind)), t_end=10.0)
        assert sol["belt.x"][-1] == pytest.approx(way, abs=1e-12)
    begun = fm.simulate(on("velocity", (t, y)), t_end=4.321, rtol=1e-8)
    rest = fm.simulate(on("velocity", (t, y)), t_start=4.321, t_end=10.0, initial=begun, rtol=1e-8)
    whole = fm.simulate(on("velocity", (t, y)), t_end=10.0, rtol=1e-8)
    assert rest["b.x"][-1] == pytest.approx(whole["b.x"][-1], abs=1e-9)
    assert rest["belt.x"][-1] == pytest.approx(np.trapezoid(y, t), abs=1e-12)


def test_a_pulse_between_two_samples_of_a_long_run_is_not_missed():
    t = np.array([0.0, 499.999, 500.0, 500.001, 1000.0])
    sol = fm.simulate(block((t, [0.0, 0.0, 3.0, 0.0, 0.0])), t_end=1000.0)
    over = 500.0 - 0.001 * 2.0 / 3.0  # where the line up to 3 passes the cone
    assert sol.events[0].kind == "slip"
    assert sol.events[0].t == pytest.approx(over, abs=1e-9)


def test_nothing_is_derived_or_compiled_for_another_series():
    from fricmb.equations import derivations

    t = times()
    fm.simulate(block((t, push(t))), t_end=1.0)
    before = len(derivations)
    sol = fm.simulate(block((t, push(t + 1.0))), t_end=1.0)
    assert len(derivations) == before
    assert sol.stats.compile_s == 0.0


def test_files_pickles_and_sweeps_keep_it(tmp_path):
    t = times()
    sol = fm.simulate(block(fm.Signal(t, push(t), name="hammer")), t_end=10.0)
    sol.save(tmp_path / "run.npz")
    for again in (fm.Solution.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol))):
        assert again.scene == sol.scene
        assert str(again.scene["f"].value) == "hammer(t)"
        assert again(5.123) == pytest.approx(sol(5.123), abs=0.0)
    found = fm.sweep(
        block((t, push(t))), [{"f.value": fm.Signal(t, s * push(t))} for s in (0.5, 1.0)], t_end=10.0, workers=1,
        progress=False, reduce=lambda run: run["b.x"][-1],
    )  # fmt: skip
    assert found[1] == pytest.approx(sol["b.x"][-1], abs=1e-12)
    assert found[0] != found[1]


@pytest.mark.parametrize("kind", ["linear", "hold"])
def test_derivatives_by_a_factor_of_a_series(kind):
    t = times()
    factor = fm.parameter("A", 1.0)
    scene = block(factor * fm.Signal(t, push(t), kind=kind))
    sol = fm.simulate(scene, t_end=10.0, rtol=1e-10, sensitivities=("A",))
    ends = [fm.simulate(scene, parameters={"A": 1.0 + h}, t_end=10.0, rtol=1e-11)["b.x"][-1] for h in (1e-5, -1e-5)]
    assert sol.sensitivity("b.x", "A")[-1] == pytest.approx((ends[0] - ends[1]) / 2e-5, rel=1e-6)


def test_bends_of_what_is_made_of_series_are_stepped_to():
    t = times(401)
    y = push(t)
    sol = fm.simulate(block(abs(fm.Signal(t, y))), t_end=10.0, rtol=1e-8)
    zero = np.flatnonzero(y[:-1] * y[1:] < 0.0)
    crossings = t[zero] - y[zero] * (t[zero + 1] - t[zero]) / (y[zero + 1] - y[zero])
    both = np.unique(np.concatenate([t, crossings]))
    line = np.abs(np.interp(both, t, y))
    as_pieces = fm.simulate(block((both, line)), t_end=10.0, rtol=1e-8)
    assert sol["b.x"][-1] == pytest.approx(as_pieces["b.x"][-1], abs=1e-9)


def test_a_formula_of_a_thousand_pieces_is_a_series():
    t = times(401)
    y = push(t)
    slope = np.diff(y) / np.diff(t)
    pieces = [(float(y[i]) + float(slope[i]) * (fm.t - float(t[i])), fm.t < float(t[i + 1])) for i in range(399)]
    last = float(y[399]) + float(slope[399]) * (fm.t - float(t[399]))
    scene = block(sympy.Piecewise(*pieces, (last, True)))
    assert str(scene["f"].value) == "pieces(t)"
    found, ref = (fm.simulate(one, t_end=10.0, rtol=1e-8) for one in (scene, block((t, y))))
    assert found["b.x"][-1] == pytest.approx(ref["b.x"][-1], abs=1e-10)


def test_a_run_that_leaves_the_series_is_refused():
    t = times()
    with pytest.raises(fm.SceneError, match=r"Force 'f': value = signal\(t\) is known from t = 0 to 10, the run goes"):
        fm.simulate(block((t, push(t))), t_end=11.0)
    for outside, value in (("hold", push(10.0)), ("zero", 0.0)):
        scene = block(fm.Signal(t, push(t), outside=outside))
        assert float(fm.simulate(scene, t_end=11.0).scene["f"].value.subs(fm.t, 10.5)) == pytest.approx(value)
    fm.simulate(block(fm.Signal(t, push(t))(fm.t - 5.0)), t_start=5.0, t_end=15.0)


def test_a_series_of_anything_but_a_line_in_time_is_refused():
    t = times()
    with pytest.raises(fm.SceneError, match=r"a series at fm\.t, or at a line in it with numbers"):
        block(fm.Signal(t, push(t))(fm.t**2))


def test_a_table_shaken_by_a_measured_acceleration():
    """Its velocity is the integral, its position the integral of that; a series begins at 1.0."""
    t = np.linspace(1.0, 6.0, 201)
    a = np.sin(7.0 * t) * np.exp(-0.3 * t)
    for kind in ("linear", "cubic"):
        signal = fm.Signal(t, a, kind)
        table = fm.Driven("table", velocity={"x": signal.integral})
        box = fm.Body("box", mass=1.0)
        scene = fm.Scene("table", [table, box, fm.Contact("c", box, table, law=DRY, normal_force=0.3)])
        sol = fm.simulate(scene, t_start=1.0, t_end=6.0, rtol=1e-8)
        exact = CubicSpline(t, a) if kind == "cubic" else make_interp_spline(t, a, k=1)
        assert sol.velocity("table.x")[-1] == pytest.approx(float(exact.antiderivative(1)(6.0)), abs=1e-12)
        assert sol["table.x"][-1] == pytest.approx(float(exact.antiderivative(2)(6.0)), abs=1e-12)
        assert len(sol.events) > 4
        assert sol.audit().ok


@pytest.mark.parametrize("kind", ["linear", "hold", "cubic"])
def test_files_give_back_the_same_series(kind, tmp_path):
    t = times()
    scene = block(fm.Signal(t, push(t) / 3.0, kind=kind))
    fm.simulate(scene, t_end=1.0).save(tmp_path / "run.npz")
    assert fm.Solution.load(tmp_path / "run.npz").scene == scene


@pytest.mark.parametrize("samples", [41, 401])
def test_three_stages_on_a_cubic_series_do_what_seven_do(samples):
    """Asked for by name, where a cubic would get seven: many more steps, and the same motion."""
    t = np.linspace(0.0, 10.0, samples)
    scene = block(fm.Signal(t, push(t), kind="cubic"), fm.laws.Stribeck(mu_s=1.0, mu_k=0.8, v_s=0.1))
    few, more = (fm.simulate(scene, t_end=10.0, rtol=1e-6, method=Radau(stages=s)) for s in (3, 7))
    assert [e.kind for e in few.events] == [e.kind for e in more.events]
    assert [e.t for e in few.events] == pytest.approx([e.t for e in more.events], abs=1e-5)
    assert few["b.x"][-1] == pytest.approx(more["b.x"][-1], abs=1e-5)
