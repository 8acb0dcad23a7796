"""Branches of cycles: bifurcations of friction and smooth ones, each against something that shares no code."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, fsolve

import fricmb as fm
from fricmb.analysis import Flip, Fold, Grazing, NeimarkSacker, StickAppears, StickDisappears

LEINE = fm.laws.HyperbolicStribeck(mu_s=1.0, mu_k=0.0, delta=3.0)


def forced_belt(*, amplitude, omega, belt=0.2, damping=0.05, law=LEINE):
    """x'' + c x' + x = mu(|x' - V|) sign(V - x') + A cos(omega t)."""
    mass, moving = fm.Body("mass", mass=1.0, velocity={"x": belt}), fm.Driven("belt", velocity={"x": belt})
    w, a = fm.parameter("omega", omega), fm.parameter("A", amplitude)
    return fm.Scene(
        "forced belt",
        [
            mass,
            moving,
            fm.Spring("spring", mass, axis="x", stiffness=1.0),
            fm.Damper("damper", mass, axis="x", damping=damping),
            fm.Contact("sole", mass, moving, law=law, normal_force=1.0),
            fm.Force("drive", mass, axis="x", value=a * sympy.cos(w * fm.t)),
        ],
    )


def settled(scene, period, laps=100, **start):
    return fm.simulate(scene.with_parameters(start), t_end=laps * period, rtol=1e-9)


@pytest.fixture(scope="module")
def leine():
    scene = fm.models.belt_oscillator(belt=2.5, damping=0.1, law=LEINE)
    cycle = fm.analysis.limit_cycle(scene, start=fm.simulate(scene, t_end=100.0, rtol=1e-8))
    return fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=3.0, progress=False)


def test_discontinuous_fold(leine):
    """Where stick gets lost the branch turns round; value and period from a prototype in 30-digit arithmetic."""
    gone, fold = leine.special
    assert isinstance(gone, StickDisappears)
    assert isinstance(fold, Fold)
    for special in leine.special:
        assert special.value == pytest.approx(2.892345819430306719066581, abs=2e-12)
        assert special.cycle.period == pytest.approx(6.307696137255099848038571, abs=2e-12)
        assert special.residual < 1e-12
    stable, unstable = leine.stable[: leine.places[0]], leine.stable[leine.places[0] :]
    assert stable.all()
    assert not unstable.any()
    assert leine.values[-1] == 2.5
    assert "where it began" in leine.ended


def test_the_unstable_branch_parts_slip_from_stick_slip(leine):
    """A run that starts within the unstable cycle comes to rest in steady slip, one outside to stick and slip."""
    cycle = leine.cycles[-1]
    assert not cycle.stable
    lowest, rest = cycle.solution.at(np.linspace(0.0, cycle.period, 4001))["mass.x"].min(), 1.0 / (1.0 + 3.0 * 2.5)
    for part, sticks in ((0.97, False), (1.03, True)):
        scene = cycle.scene.with_parameters({"mass.position.x": rest + part * (lowest - rest), "mass.velocity.x": 0.0})
        run = fm.simulate(scene, t_end=80.0, rtol=1e-9)
        assert (len(run.events) > 0) == sticks


def test_stick_appears_on_the_way_back(leine):
    """The same border from the slipping side."""
    back = fm.analysis.continue_cycle(leine.cycles[-1], "belt.velocity.x", to=3.0, points=14, progress=False)
    appears, fold = back.special[:2]
    assert isinstance(appears, StickAppears)
    assert isinstance(fold, Fold)
    assert appears.value == pytest.approx(2.892345819430306719066581, abs=2e-12)
    assert [event.kind for event in back.cycles[-1].events] == ["stick", "slip"]


def test_a_cycle_that_shrinks_to_rest():
    """Steady slip gets unstable where the slope of friction is the damping: 3/(1 + 3V)^2 = c, V = (sqrt(30) - 1)/3."""
    scene = fm.models.belt_oscillator(belt=1.6, damping=0.1, law=LEINE)
    start = scene.with_parameters({"mass.position.x": 1.0 / 5.8 + 0.73, "mass.velocity.x": 0.0})
    cycle = fm.analysis.limit_cycle(scene, start=fm.simulate(start, t_end=13.0, rtol=1e-8), period=6.285)
    assert not cycle.stable
    branch = fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=1.2, progress=False)
    assert "rest" in branch.ended
    assert branch.values[-1] == pytest.approx((np.sqrt(30.0) - 1.0) / 3.0, abs=1e-5)
    assert branch.special == ()


def test_sticks_of_a_symmetric_cycle_go_together():
    """Below the border a run sticks, above it turns round without; two sticks vanish at once."""
    mass, w = fm.Body("mass", mass=1.0), fm.parameter("omega", 0.59)
    scene = fm.Scene("forced", [
        mass, fm.Spring("spring", mass, axis="x", stiffness=1.0), fm.Damper("damper", mass, axis="x", damping=0.1),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=1.25, mu_k=1.0), normal_force=0.4),
        fm.Force("drive", mass, axis="x", value=sympy.cos(w * fm.t)),
    ])  # fmt: skip
    there = fm.analysis.continue_cycle(fm.analysis.limit_cycle(scene), "omega", to=0.62, progress=False)
    (gone,) = there.special
    assert isinstance(gone, StickDisappears)
    for side, kinds in ((-1e-4, {"stick", "slip"}), (1e-4, {"reversal"})):
        omega = gone.value + side
        run = fm.simulate(scene.with_parameters({"omega": omega}), t_end=60.0 * 2.0 * np.pi / omega, rtol=1e-9)
        assert {event.kind for event in run.events if event.t > 0.9 * run.t_end} == kinds
    assert [event.kind for event in there.cycles[-1].events] == ["reversal", "reversal"]
    back = fm.analysis.continue_cycle(there.cycles[-1], "omega", to=0.59, progress=False)
    (appears,) = back.special
    assert isinstance(appears, StickAppears)
    assert appears.value == pytest.approx(gone.value, abs=1e-10)
    assert back.cycles[-1].period == pytest.approx(there.cycles[0].period, rel=1e-12)


def test_grazing_ends_a_branch():
    """Constant friction in slip: linear vibration touches the belt's speed at A = V |1 - w^2 + i c w|/w."""
    law = fm.laws.Coulomb(mu_s=1.5, mu_k=1.0)
    scene = forced_belt(amplitude=0.3, omega=1.3, belt=1.0, damping=0.2, law=law)
    branch = fm.analysis.continue_cycle(fm.analysis.limit_cycle(scene), "A", to=2.0, progress=False)
    (graze,) = branch.special
    assert isinstance(graze, Grazing)
    assert graze.value == pytest.approx(abs(1.0 - 1.69 + 0.26j) / 1.3, rel=1e-11)
    assert "touches" in branch.ended


def last_speed(k=1.3, d=0.12, mu_s=1.4, mu_k=1.0):
    """The belt's speed at which slip that has broken away just gets back to it: damped vibration, by hand."""
    w = np.sqrt(k - d * d / 4.0)

    def missing(V):
        A = (mu_s - d * V - mu_k) / k
        B = (V + d / 2.0 * A) / w

        def speed(t):
            along, across = B * w - d / 2.0 * A, A * w + d / 2.0 * B
            return np.exp(-d * t / 2.0) * (along * np.cos(w * t) - across * np.sin(w * t))

        def rate(t):
            place = np.exp(-d * t / 2.0) * (A * np.cos(w * t) + B * np.sin(w * t))
            return -d * speed(t) - k * place

        t = np.linspace(0.2, 2.3 * np.pi / w, 400)
        top = np.flatnonzero((rate(t[:-1]) > 0.0) & (rate(t[1:]) <= 0.0))[0]
        return speed(brentq(rate, t[top], t[top + 1], xtol=1e-15)) - V

    return brentq(missing, 0.3, 0.5, xtol=1e-15)


def test_branch_of_stick_slip_ends_where_slip_misses_its_stick():
    """Its stick is as long as ever there; the slip before comes to the belt's speed without deceleration."""
    V = 0.25
    b, belt = fm.Body("b", mass=1.0, velocity={"x": V}), fm.Driven("belt", velocity={"x": V})
    law = fm.laws.Coulomb(mu_s=1.4, mu_k=1.0)
    parts = [b, belt, fm.Spring("k", b, axis="x", stiffness=1.3), fm.Damper("d", b, axis="x", damping=0.12)]
    scene = fm.Scene("belt", [*parts, fm.Contact("c", b, belt, law=law, normal_force=1.0)])
    cycle = fm.analysis.limit_cycle(scene, start=fm.simulate(scene, t_end=100.0, rtol=1e-10))
    branch = fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=0.7, progress=False)
    (graze,) = branch.special
    assert isinstance(graze, Grazing)
    assert graze.value == pytest.approx(last_speed(), rel=1e-12)
    assert "touches" in branch.ended
    assert [event.kind for event in branch.cycles[-1].events] == ["stick", "slip"]
    assert branch.cycles[-1].residual < 1e-8


# ---- an independent program: smooth pieces of the forced belt by DOP853, turned round where the slip speed is 0


def lap(y, omega, amplitude, belt, damping, laps=1, delta=3.0):
    t, end = 0.0, laps * 2.0 * np.pi / omega
    sign = np.sign(y[1] - belt)

    def zero(t, y, s):
        return y[1] - belt

    zero.terminal = True
    while t < end:

        def rate(t, y, s):
            mu = 1.0 / (1.0 + delta * max(s * (y[1] - belt), 0.0))
            return [y[1], -y[0] - damping * y[1] - s * mu + amplitude * np.cos(omega * t)]

        zero.direction = -sign
        run = solve_ivp(rate, (t, end), y, method="DOP853", rtol=1e-13, atol=1e-14, args=(sign,), events=zero)
        t, y = run.t[-1], run.y[:, -1].copy()
        if t < end:
            y[1], sign = belt, -sign
    return y


def lap_slope(y, *args):
    h = 1e-4 * np.eye(2)

    def central(s):
        return np.array([(lap(y + s * e, *args) - lap(y - s * e, *args)) / (2e-4 * s) for e in h]).T

    return (4.0 * central(0.5) - central(1.0)) / 3.0


def test_flip_agrees_with_an_independent_program():
    scene = forced_belt(amplitude=1.0, omega=0.73)
    cycle = fm.analysis.limit_cycle(scene, start=settled(scene, 2.0 * np.pi / 0.73))
    branch = fm.analysis.continue_cycle(cycle, "omega", to=0.715, progress=False)
    (flip,) = branch.special
    assert isinstance(flip, Flip)
    assert branch.stable[0]
    assert not branch.stable[-1]

    def equations(u):
        y, omega = u[:2], u[2]
        args = (omega, 1.0, 0.2, 0.05)
        return [*(lap(y, *args) - y), np.linalg.det(lap_slope(y, *args) + np.eye(2))]

    T = flip.cycle.period
    section = flip.cycle.solution.t_start
    start = flip.cycle.solution.at([np.ceil(section / T) * T])
    found = fsolve(equations, [start["mass.x"][0], start.velocity("mass.x")[0], flip.value], xtol=1e-11)
    assert flip.value == pytest.approx(found[2], abs=1e-8)
    # second way: in plain runs a small deviation from the cycle dies out above and grows below
    for omega, grows in ((flip.value + 2e-3, False), (flip.value - 2e-3, True)):
        near = fm.analysis.limit_cycle(scene.with_parameters({"omega": omega}), start=flip.cycle).solution
        begin, lap_time = near.t_start, 2.0 * np.pi / omega
        initial = {"position": {"mass.x": near["mass.x"][0] + 1e-5}, "velocity": {"mass.x": near.velocity("mass.x")[0]}}
        run = fm.simulate(near.scene, t_start=begin, t_end=begin + 61 * lap_time, initial=initial, rtol=1e-11)
        off = run.at(begin + lap_time * np.arange(61))["mass.x"] - near["mass.x"][0]
        assert (np.abs(off[-4:]).max() > 3e-5) == grows
        assert (np.abs(off[-4:]).max() < 0.3e-5) != grows
        assert (off[20:39:2] * off[21:40:2] < 0.0).all()  # from side to side


def test_switching_to_twice_the_period():
    scene = forced_belt(amplitude=1.0, omega=0.73)
    cycle = fm.analysis.limit_cycle(scene, start=settled(scene, 2.0 * np.pi / 0.73))
    branch = fm.analysis.continue_cycle(cycle, "omega", to=0.715, progress=False)
    doubled = branch.switch(branch.special[0], points=5, progress=False)
    last = doubled.cycles[-1]
    assert last.period == pytest.approx(4.0 * np.pi / doubled.values[-1], rel=1e-12)
    half = last.solution.at(last.solution.t_start + np.array([0.0, 0.5]) * last.period * (1.0 - 1e-14))
    assert abs(np.diff(half["mass.x"])[0]) > 1e-3
    with pytest.raises(fm.analysis.AnalysisError, match="Flip"):
        branch.switch(Fold(value=0.0, cycle=cycle, residual=0.0))


def test_neimark_sacker_agrees_with_an_independent_program():
    scene = forced_belt(amplitude=0.1, omega=0.6, belt=1.52, damping=0.1)
    still = {"mass.position.x": 0.17, "mass.velocity.x": 0.0}
    cycle = fm.analysis.limit_cycle(scene, start=settled(scene, 2.0 * np.pi / 0.6, laps=300, **still))
    branch = fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=1.48, progress=False)
    (torus,) = branch.special
    assert isinstance(torus, NeimarkSacker)
    assert np.abs(torus.cycle.multipliers) == pytest.approx([1.0, 1.0], abs=1e-9)

    def equations(u):
        args = (0.6, 0.1, u[2], 0.1)
        return [*(lap(u[:2], *args) - u[:2]), np.linalg.det(lap_slope(u[:2], *args)) - 1.0]

    T, section = torus.cycle.period, torus.cycle.solution.t_start
    start = torus.cycle.solution.at([np.ceil(section / T) * T])
    found = fsolve(equations, [start["mass.x"][0], start.velocity("mass.x")[0], torus.value], xtol=1e-11)
    assert torus.value == pytest.approx(found[2], abs=1e-8)
    # second way: a small deviation from the cycle dies out above and grows below
    for belt, grows in ((torus.value + 0.02, False), (torus.value - 0.02, True)):
        values = {"belt.velocity.x": belt, "mass.position.x": start["mass.x"][0] + 1e-2}
        values["mass.velocity.x"] = start.velocity("mass.x")[0]
        run = fm.simulate(scene.with_parameters(values), t_end=60 * T, rtol=1e-9)
        x = fm.analysis.poincare_section(run, period=T, discard=0.0)["mass.x"]
        assert (np.ptp(x[-10:]) > np.ptp(x[:10])) == grows
    with pytest.raises(fm.analysis.AnalysisError, match="torus"):
        branch.switch(torus)


def test_ends_and_errors(leine):
    cycle = leine.cycles[0]
    with pytest.raises(fm.SceneError, match="belt"):
        fm.analysis.continue_cycle(cycle, "belt.velocity.y", to=3.0)
    with pytest.raises(fm.analysis.AnalysisError, match="to"):
        fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=2.5)
    short = fm.analysis.continue_cycle(cycle, "belt.velocity.x", to=2.55, progress=False)
    assert short.values[-1] == pytest.approx(2.55, rel=1e-14)
    assert short.periods[-1] == short.cycles[-1].period
    assert "2.55" in short.ended


@pytest.mark.parametrize("name", ["mass.x", "period"])
def test_pictures(leine, name):
    figure = leine.plot.diagram(name)
    labels = figure.axes[0].get_legend_handles_labels()[1]
    assert {"stable", "unstable", "stick disappears", "fold"} <= set(labels)
    styles = {line.get_linestyle() for line in figure.axes[0].get_lines() if line.get_label() in ("stable", "unstable")}
    assert len(styles) == 2
    assert len(leine.plot.multipliers().axes) == 3
