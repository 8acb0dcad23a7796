"""Pictures of signals, loops, measurements and frequency responses show numbers that closed forms give."""

import numpy as np
import pytest
import sympy

import fricmb as fm
from fricmb.analysis import AnalysisError
from fricmb.errors import UnknownNameError
from fricmb.scene import parameter_unit


@pytest.fixture(scope="module")
def belt():
    return fm.simulate(fm.models.belt_oscillator(), t_end=40.0, rtol=1e-8)


def rubbed(units=None):
    """A block that is dragged to and fro on the ground by a driven spring."""
    block = fm.Body("block", mass=0.01)
    hand = fm.Driven("hand", position={"x": 0.5 * sympy.sin(fm.t)})
    parts = [
        block, hand, fm.Spring("arm", block, hand, axis="x", stiffness=50.0),
        fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=4.0),
    ]  # fmt: skip
    return fm.Scene("rubbed", parts, **({"units": units} if units else {}))


def test_positions_and_other_signals(belt):
    (ax,) = belt.plot.positions().axes
    t, x = ax.lines[0].get_data()
    assert x == pytest.approx(belt.at(t)["mass.x"], abs=1e-12)
    forces, rates = belt.plot.signals(["sole.force", "mass.x.acceleration", "spring.force"]).axes
    assert [line.get_label() for line in forces.lines] == ["sole.force", "spring.force"]
    assert rates.lines[0].get_ydata() == pytest.approx(belt.at(rates.lines[0].get_xdata())["mass.x.acceleration"])
    (ax,) = belt.plot.positions(t_start=10.0, t_end=20.0).axes
    assert (ax.lines[0].get_xdata()[[0, -1]] == [10.0, 20.0]).all()
    with pytest.raises(UnknownNameError, match=r"did you mean 'mass.x'"):
        belt.plot.positions(["mas.x"])
    with pytest.raises(AnalysisError, match=r"ax must be left out for signals of several kinds"):
        belt.plot.signals(["sole.force", "mass.x"], ax=ax)


def test_the_loop_of_dry_friction_is_a_box():
    sol = fm.simulate(rubbed(fm.Units("s", "m", "N")), t_end=4 * np.pi, rtol=1e-9)
    figure = sol.plot.hysteresis("sole", t_start=2 * np.pi)
    (ax,) = figure.axes
    x, force = ax.lines[0].get_data()
    sliding = np.abs(np.gradient(x)) > 1e-6
    assert np.abs(force[sliding]) == pytest.approx(2.0, abs=1e-6)
    width = 2 * (0.5 - 2.0 / 50.0)  # the spring gives by F/k on either side
    assert np.ptp(x) == pytest.approx(width, rel=1e-2)
    lost = float(ax.get_title(loc="left").split()[1])
    assert lost == pytest.approx(2 * 2.0 * width, rel=1e-2)
    assert ax.get_xlabel() == "displacement at sole [m]"
    assert ax.get_title(loc="left").endswith("N m")
    (ax,) = sol.plot.hysteresis("arm").axes
    x, force = ax.lines[0].get_data()
    assert force == pytest.approx(50.0 * x, abs=1e-10)


def test_a_run_beside_a_measurement(belt):
    t = np.linspace(1.0, 30.0, 50)
    data = {"t": t, "mass.x": belt.at(t)["mass.x"] + 0.1, "sole.force": belt.at(t)["sole.force"]}
    place, force = belt.plot.compare(data).axes
    assert force.get_title(loc="left").startswith("root mean square difference")
    assert place.get_title(loc="left") == "root mean square difference 0.1"
    dots, curve = place.lines
    assert (dots.get_ydata() == data["mass.x"]).all()
    assert curve.get_ydata() == pytest.approx(belt.at(curve.get_xdata())["mass.x"], abs=1e-12)
    assert len(belt.plot.compare(data, signals="mass.x").axes) == 1
    with pytest.raises(fm.SceneError, match="data holds no signal over time"):
        belt.plot.compare({"sole.stick": [1.0]})


def driven(**extra):
    omega, mass = fm.parameter("omega", 1.0), fm.Body("mass", mass=1.0)
    load = fm.Force("load", mass, axis="x", value=0.5 * sympy.cos(omega * fm.t))
    spring = fm.Spring("spring", mass, axis="x", stiffness=1.0, **extra)
    return fm.Scene("driven", [mass, spring, fm.Damper("damper", mass, axis="x", damping=0.2), load])


def test_a_linear_response_is_the_closed_form():
    omega = np.array([0.5, 0.9, 1.1, 2.0])
    found = fm.analysis.frequency_response(
        driven(), over="omega", values=omega[::-1], measure="mass.x", progress=False, rtol=1e-8
    )
    closed = 0.5 / np.abs(1.0 - omega**2 + 0.2j * omega)
    assert (found.values == omega).all()
    assert found.up == pytest.approx(closed, rel=2e-3)
    assert found.down == pytest.approx(closed, rel=2e-3)
    assert found.peak[0] == 0.9
    rising, falling = found.plot.amplitude().axes[0].lines
    assert (rising.get_ydata() == found.up).all()
    assert (falling.get_ydata() == found.down).all()
    twice = fm.analysis.frequency_response(
        driven(), over="omega", values=[0.5], measure=lambda sol: 2.0, progress=False, periods=6
    )
    assert twice.up.tolist() == [2.0]


def test_a_hardening_spring_jumps_at_different_places():
    """One harmonic: amplitude a where ((1 + 3/4 b a^2 - w^2) a)^2 + (c w a)^2 = F^2."""
    found = fm.analysis.frequency_response(
        driven(cubic=0.3), over="omega", values=np.linspace(1.0, 2.0, 11), measure="mass.x", progress=False, periods=40
    )
    apart = found.up > 1.5 * found.down
    assert apart.any()
    assert "rising and falling differ between" in str(found)
    for amplitude, omega in zip(found.up[apart], found.values[apart], strict=True):
        left = (1.0 + 0.225 * amplitude**2 - omega**2) ** 2 + (0.2 * omega) ** 2
        assert 0.5 / np.sqrt(left) == pytest.approx(amplitude, rel=0.15)


def test_sticking_and_cycles_of_a_response():
    omega, mass = fm.parameter("omega", 1.0), fm.Body("mass", mass=1.0)
    scene = fm.Scene("rubbing", [
        mass, fm.Spring("spring", mass, axis="x", stiffness=1.0),
        fm.Force("load", mass, axis="x", value=0.5 * sympy.cos(omega * fm.t)),
        fm.Contact("sole", mass, law=fm.laws.Coulomb(mu_s=0.3), normal_force=1.0),
        fm.Damper("damper", mass, axis="x", damping=0.1),
    ])  # fmt: skip
    found = fm.analysis.frequency_response(
        scene, over="omega", values=[0.3, 0.4, 0.5], measure="mass.x", progress=False, cycles=True, periods=12
    )
    assert (found.stick_up[0] > 0.1).all()
    assert (found.stick_up[0] < 0.9).all()
    assert found.branch.cycles[0].amplitude("mass.x") == pytest.approx(found.up[0], rel=1e-3)
    figure = found.plot.amplitude()
    assert len(figure.axes) == 2
    assert figure.axes[1].get_ylabel() == "stick, sole"
    with pytest.raises(UnknownNameError, match="unknown parameter 'omga'"):
        fm.analysis.frequency_response(scene, over="omga", values=[1.0], measure="mass.x")
    with pytest.raises(AnalysisError, match="contact must be one of sole"):
        found.plot.amplitude("load")


def test_what_is_round_off_is_drawn_as_zero():
    sol = fm.simulate(fm.models.wheelset(), t_end=0.3, rtol=1e-6)
    ax = next(ax for ax in sol.plot.velocities().axes if ax.lines[0].get_label() == "axle.z")
    assert ax.get_ylim()[1] > 0.1
    assert ax.get_title(loc="left") == "0 to round-off"


def test_phases_that_the_run_cuts_are_marked(belt):
    axes = belt.plot.transitions().axes[1]
    cut = {x for line in axes.lines if line.get_marker() == "^" for x in line.get_xdata()}
    whole = {x for line in axes.lines if line.get_marker() in ("o", "x") for x in line.get_xdata()}
    assert 0.0 in cut
    assert max(cut) == belt.events[-1].t
    assert whole == set(belt.events.t[:-1])


def test_a_sweep_over_one_key_is_a_curve_whatever_the_others_hold():
    runs = [{"spring.stiffness": k, "belt.velocity.x": 0.1} for k in (0.5, 1.0, 2.0)]
    scene = fm.models.belt_oscillator().with_units(fm.Units("s", "m", "N"))
    found = fm.sweep(scene, runs, t_end=5.0, reduce=lambda sol: sol["mass.x"].max(), workers=1, progress=False)
    (ax,) = found.plot().axes
    assert ax.lines[0].get_xdata().tolist() == [0.5, 1.0, 2.0]
    assert ax.get_xlabel() == "spring.stiffness [N/m]"
    assert ax.get_title(loc="right") == "belt.velocity.x = 0.1"
    scene = rubbed(fm.Units("s", "m", "N"))
    assert [parameter_unit(scene, name) for name in ("block.mass", "sole.normal_force", "sole.law.mu_s")] == [
        "kg", "N", "",
    ]  # fmt: skip


def test_units_of_spectra_and_none_that_say_nothing(belt):
    assert belt.plot.spectrum("mass.x").axes[0].get_ylabel() == "power density of mass.x"
    sol = fm.simulate(rubbed(fm.Units("s", "m", "N")), t_end=20.0)
    assert sol.plot.spectrum("block.x").axes[0].get_ylabel() == "power density of block.x [m²/(rad/s)]"
    hertz = sol.plot.spectrum("block.x.velocity", hz=True).axes[0]
    assert hertz.get_ylabel() == "power density of block.x.velocity [(m/s)²/Hz]"
    assert belt.plot.velocities().axes[0].get_ylabel() == "velocity"
