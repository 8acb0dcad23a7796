"""Constant, prescribed and Hertzian normal forces."""

import numpy as np
import pytest
import sympy
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import fricmb as fm


def slider(normal_force, height=0.0, **velocity):
    block = fm.Body("block", mass=1.0, axes="xy", velocity=velocity, position={"y": height})
    law = fm.laws.Coulomb(mu_s=0.5)
    return fm.Scene("s", [block, fm.Contact("sole", block, law=law, normal_force=normal_force, axes="x")])


def test_given_forces_are_numbers_and_expressions():
    constant = slider(fm.normal.Constant(force=fm.parameter("N", 4.0)))
    assert constant.parameters["N"] == 4.0
    assert constant["sole"].normal_kind == "constant"
    timed = slider(fm.normal.Prescribed(force=2 + sympy.sin(fm.t)), x=1.0)
    sol = fm.simulate(timed, t_end=0.5, rtol=1e-10)
    assert sol.velocity("block.x")[-1] == pytest.approx(1.0 - 0.5 * (2 * 0.5 + 1 - np.cos(0.5)), rel=1e-9)
    with pytest.raises(fm.LawError, match="force must be a finite number >= 0, got -1"):
        fm.normal.Constant(force=-1.0)
    with pytest.raises(fm.LawError, match="force must be a SymPy expression"):
        fm.normal.Prescribed(force=3.0)


def test_hertz_swings_in_its_closed_form_time():
    """About its preload, without opening: the period is the integral of dy/v at constant energy."""
    k, N0, v = 1e4, 3.0, 0.02
    d0 = (N0 / k) ** (2.0 / 3.0)

    def energy(e):
        return 0.4 * k * ((d0 - e) ** 2.5 - d0**2.5) + N0 * e

    ends = [brentq(lambda e: energy(e) - 0.5 * v**2, *side) for side in ((-d0, 0.0), (0.0, d0))]
    middle, half = 0.5 * sum(ends), 0.5 * (ends[1] - ends[0])

    def slowness(a):
        return half * np.cos(a) / np.sqrt(v**2 - 2.0 * energy(middle + half * np.sin(a)))

    period = 2.0 * quad(slowness, -0.5 * np.pi, 0.5 * np.pi, epsrel=1e-11)[0]
    law = fm.normal.Hertz(axis="y", stiffness=k, preload=N0)
    sol = fm.simulate(slider(law, x=1.0, y=v), t_end=period, rtol=1e-10)
    assert sol.velocity("block.y")[-1] == pytest.approx(v, rel=1e-8)
    assert sol["block.y"][-1] == pytest.approx(0.0, abs=1e-8 * half)
    assert np.abs(sol.energy.residual).max() < 1e-8


def test_hertz_is_at_rest_under_its_preload():
    sol = fm.simulate(slider(fm.normal.Hertz(axis="y", stiffness=1e4, preload=3.0), x=1.0), t_end=0.2, rtol=1e-9)
    assert sol.normal_force("sole") == pytest.approx(3.0, rel=1e-12)
    assert np.abs(sol["block.y"]).max() < 1e-14


def test_friction_that_presses_itself_on_flutters():
    """Mode coupling (Hoffmann): the structure leads friction into its own normal force; unstable above mu_c = 0.75."""
    for mu, grows in ((0.7, False), (0.8, True)):
        x, y = np.linalg.solve([[2.0, 1.0 - mu * 4.0 / 3.0], [1.0, 2.0]], [-mu, 0.0])  # steady sliding
        block = fm.Body("block", mass=1.0, axes="xy", position={"x": x + 1e-4, "y": y})
        belt = fm.Driven("belt", velocity={"x": -10.0})
        parts = [
            fm.MatrixElement("k", ["block.x", "block.y"], K=[[2.0, 1.0], [1.0, 2.0 - 4.0 / 3.0]]),
            fm.Contact(
                "sole", block, belt, law=fm.laws.Coulomb(mu_s=mu), axes="x",
                normal_force=fm.normal.Spring(axis="y", stiffness=4.0 / 3.0, preload=1.0),
            ),
        ]  # fmt: skip
        sol = fm.simulate(fm.Scene("hoffmann", [block, belt, *parts]), t_end=60.0, rtol=1e-8)
        swing = np.abs(sol["block.y"] - y)
        late, early = swing[sol.t > 40].max(), swing[sol.t < 20].max()
        assert (late > 3.0 * early) == grows


def time_of_contact(law):
    """How long a mass of 1 at the speed 0.1 stays in contact: half a swing, or Hertz's integral."""
    if isinstance(law, fm.normal.Spring):
        return np.pi / 100.0
    deepest = (5.0 * 0.1**2 / (4.0 * 1e4)) ** 0.4
    # u = 1 - w^2 takes the root at u = 1 away
    whole = quad(lambda w: 2.0 * w / np.sqrt(1.0 - (1.0 - w * w) ** 2.5), 0.0, 1.0, epsrel=1e-12)[0]
    return 2.0 * deepest / 0.1 * whole


@pytest.mark.parametrize("method", ["bdf", "radau"])
@pytest.mark.parametrize("kind", [fm.normal.Hertz, fm.normal.Spring])
def test_contact_is_made_without_preload(kind, method):
    """From touching at 0.1: the speed turns round, and friction takes mu times the impulse of N."""
    law = kind(axis="y", stiffness=1e4)
    sol = fm.simulate(slider(law, x=1.0, y=-0.1), t_end=0.5, rtol=1e-9, method=method)
    assert [event.kind for event in sol.events] == ["close", "open"]
    assert sol.events[0].t == pytest.approx(0.0, abs=1e-12)
    assert sol.events[1].t == pytest.approx(time_of_contact(law), rel=1e-6)
    assert sol.velocity("block.y")[-1] == pytest.approx(0.1, rel=1e-7)
    assert sol.velocity("block.x")[-1] == pytest.approx(1.0 - 0.5 * 0.2, rel=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-8


@pytest.mark.parametrize("kind", [fm.normal.Hertz, fm.normal.Spring])
def test_a_bouncing_block_comes_to_rest_along_the_ground(kind):
    """It sticks while pressed, is open without a force at its foot, and lands at rest."""
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": 1.0, "y": 0.1})
    sole = fm.Contact(
        "sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=kind(axis="y", stiffness=1e4), axes="x"
    )
    weight = fm.Force("weight", block, axis="y", value=-9.81)
    sol = fm.simulate(fm.Scene("s", [block, sole, weight]), t_end=0.5, rtol=1e-8, method="radau")
    kinds = [event.kind for event in sol.events]
    stop = kinds.index("stick")
    assert kinds[stop + 1 : stop + 3] == ["open", "close"]
    assert np.abs(sol.velocity("block.x")[sol.t > sol.events[stop].t]).max() < 1e-12
    assert np.abs(sol.energy.residual).max() < 1e-7


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("t_end", [0.5, 5.0, 20.0])
def test_a_block_bounces_on_for_ever(t_end, method):
    """Touches and lift-offs in closed form: flights of 2 v/g, and (2/w) (pi - atan(v w/g)) on the ground."""
    v, g, w = 0.1, 9.81, 100.0
    block = fm.Body("block", mass=1.0, axes="xy", velocity={"x": 1.0, "y": v})
    law = fm.normal.Spring(axis="y", stiffness=w**2)
    sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=law, axes="x")
    scene = fm.Scene("s", [block, sole, fm.Force("weight", block, axis="y", value=-g)])
    sol = fm.simulate(scene, t_end=t_end, rtol=1e-8, method=method)
    flight, touch = 2.0 * v / g, 2.0 / w * (np.pi - np.arctan(v * w / g))
    for kind, first in (("close", flight), ("open", flight + touch)):
        found = np.array([event.t for event in sol.events if event.kind == kind])
        expected = np.arange(first, t_end, flight + touch)
        np.testing.assert_allclose(found, expected, atol=1e-7 * t_end)


def shaken(*, mass, stiffness, tie, aside, preload, position, velocity, belt, frequency, normal, law):
    """A block on a belt, held by a spring and by one at an angle, whose load a force takes away and gives back."""
    block = fm.Body("b", mass=mass, axes="xy", position={"x": position}, velocity={"x": velocity})
    drive = fm.Driven("belt", velocity={"x": belt})
    pressed = normal(axis="y", stiffness=stiffness, preload=preload)
    return fm.Scene("shaken", [
        block, drive, fm.Spring("k", block, axis="x", stiffness=tie),
        fm.Damper("c", block, axis="x", damping=0.02 * np.sqrt(tie * mass)),
        fm.Force("f", block, axis="y", value=preload * sympy.sin(frequency * fm.t)),
        fm.Spring("kc", block, axis=(0.6, 0.8), stiffness=aside),
        fm.Contact("c0", block, drive, law=law, normal_force=pressed),
    ])  # fmt: skip


FALLING = fm.laws.Coulomb(mu_s=0.5, mu_k=0.3)
#: Scene, method, tolerances at which slip was ended as it began (tens of thousands of transitions, or none any more).
#: The number of transitions is that of a loop over events of SciPy's DOP853.
LOADS_THAT_GO = {
    "power": (
        {"mass": 0.7714085958502765, "stiffness": 34715.136305057524, "tie": 5.0754385707593475,
         "aside": 1.023343315168908, "preload": 0.1195005658785288, "position": 0.08611772388886596,
         "velocity": -0.5958310843548427, "belt": 0.5403000210386928, "frequency": 4.31082532561575,
         "normal": fm.normal.Hertz, "law": FALLING},
        [("radau", 1e-3), ("bdf", 1e-5), ("bdf", 1e-4), ("radau", 1e-4)], 17,
    ),
    "spring": (
        {"mass": 0.22975564067543952, "stiffness": 29455.202843127525, "tie": 1.5657062392129069,
         "aside": 1.0827263669084366, "preload": 0.34138367214595244, "position": 0.7507089136405813,
         "velocity": -0.507896110775552, "belt": 0.1850399047763806, "frequency": 2.009739783578,
         "normal": fm.normal.Spring, "law": FALLING},
        [("bdf", 1e-4), ("radau", 1e-6), ("radau", 1e-10)], 47,
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("name", "method", "rtol"), [(name, *run) for name, (_, runs, _) in LOADS_THAT_GO.items() for run in runs]
)
def test_slip_that_begins_as_its_load_goes_is_not_ended_at_once(name, method, rtol):
    values, _, events = LOADS_THAT_GO[name]
    sol = fm.simulate(shaken(**values), t_end=10.0, rtol=rtol, method=method, time_limit=60)
    assert len(sol.events) == events
    assert sol.stats.n_steps + sol.stats.n_rejected < 2000


@pytest.mark.parametrize("height", [0.0, 1.0])
def test_hertz_with_damping_pushes_nothing_that_has_parted(height):
    """Bodies apart, or pulled apart, faster than 1/damping fly on evenly, and N stays 0."""
    law = fm.normal.Hertz(axis="y", stiffness=1e4, damping=2.0)
    sol = fm.simulate(slider(law, height=height, x=1.0, y=5.0), t_end=1.0, rtol=1e-9)
    assert sol["block.y"] == pytest.approx(height + 5.0 * sol.t, rel=1e-12)
    assert sol.velocity("block.x") == pytest.approx(1.0, rel=1e-12)
    assert not sol.normal_force("sole").any()


def test_hertz_with_damping_lets_go_what_is_torn_off():
    """A block is pulled up through the opening faster than 1/damping: scipy, with N cut at both of its zeros."""
    k, c, pull = 100.0, 1.0, 60.0

    def motion(_, y):
        approach = max(-y[0], 0.0)
        return [y[1], pull + k * approach**1.5 * max(0.0, 1.0 - c * y[1])]

    block = fm.Body("block", mass=1.0, axes="xy", position={"y": -0.5})
    law = fm.normal.Hertz(axis="y", stiffness=k, damping=c)
    sole = fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.5), normal_force=law, axes="x")
    sol = fm.simulate(fm.Scene("s", [block, sole, fm.Force("pull", block, axis="y", value=pull)]), t_end=0.3, rtol=1e-9)
    known = solve_ivp(motion, (0.0, 0.3), [-0.5, 0.0], method="DOP853", rtol=1e-12, atol=1e-12, max_step=1e-3).y[:, -1]
    assert known[0] > 1.0
    assert sol["block.y"][-1] == pytest.approx(known[0], rel=1e-8)
    assert sol.velocity("block.y")[-1] == pytest.approx(known[1], rel=1e-8)
    assert [event.kind for event in sol.events] == ["open"]


@pytest.mark.parametrize("method", ["radau"])
def test_a_block_that_is_thrown_off_loses_nothing_without_dampers(method):
    """Steps of collocation that end at a lift-off counted powers beyond it: up to a quarter of what was exchanged."""
    block = fm.Body("b", mass=1.0, axes="xy", velocity={"x": 1.0, "y": 2.0})
    law = fm.normal.Spring(axis="y", stiffness=2e4, preload=1.0)
    sole = fm.Contact("c", block, law=fm.laws.Coulomb(mu_s=0.3), normal_force=law)
    scene = fm.Scene("s", [block, fm.Force("g", block, axis="y", value=0.0 * fm.t), sole])
    sol = fm.simulate(scene, t_end=6.0, t_eval=np.linspace(0.0, 6.0, 601), rtol=1e-8, method=method)
    assert any(event.kind == "open" for event in sol.events)
    assert np.abs(sol.energy.damping_loss).max() < 1e-7
    assert np.abs(sol.energy.residual).max() < 1e-6
