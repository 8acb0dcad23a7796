"""Runs that go on from the very instant of a transition tell of it once; runs that had to stop go on."""

import numpy as np
import pytest
import sympy
from scipy.integrate import solve_ivp

import fricmb as fm


@pytest.mark.parametrize(
    ("scene", "t_end", "method", "rtol"),
    [
        (fm.models.stick_slip_chain(3), 60.0, "taylor", 1e-8),
        (fm.models.stick_slip_chain(3), 60.0, "radau", 1e-9),
        (fm.models.belt_oscillator(mu_s=1.5, mu_k=1.0), 60.0, "collocation", 1e-8),
        (fm.models.dry_pendulum(), 8.0, "radau", 1e-9),
    ],
    ids=["taylor", "radau", "collocation", "joints"],
)
def test_a_run_cut_at_a_transition_joins_with_as_many(scene, t_end, method, rtol):
    """The first part may end just short of the transition, or just behind it."""
    one = fm.simulate(scene, t_end=t_end, rtol=rtol, method=method)
    told = [(e.contact, e.kind) for e in one.events]
    for e in list(one.events)[:26]:
        first = fm.simulate(scene, t_end=e.t, rtol=rtol, method=method)
        then = fm.simulate(scene, t_end=t_end, rtol=rtol, method=method, initial=first)
        assert [(x.contact, x.kind) for x in fm.Solution.join([first, then]).events] == told, e


def swung():
    """A dry pendulum that a torque swings: its pin turns round under load without a stick."""
    arm = fm.RigidBody("arm", mass=1.3, inertia=0.2, position=(0.7, 0.0), points={"pin": (-0.7, 0.0)})
    law = fm.laws.Coulomb(mu_s=0.6, mu_k=0.5)
    pin = fm.Revolute("pin", arm.point("pin"), radius=0.05, friction=law)
    torque = fm.Torque("torque", arm, value=3.0 * sympy.sin(2.0 * fm.t))
    return fm.Scene("swung", [arm, pin, fm.Gravity("g", acceleration={"y": -9.81}), torque])


@pytest.mark.parametrize("short", [1e-10, 1e-12, 0.0, -1e-12])
@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_run_cut_just_short_of_a_reversal_tells_of_it_once(method, short):
    """What slips on from what counts as rest begins there: it turned round three times before it had gone anywhere."""
    one = fm.simulate(swung(), t_end=15.0, rtol=1e-8, method=method)
    assert len(one.events) == 9
    for e in one.events:
        first = fm.simulate(swung(), t_end=e.t - short, rtol=1e-8, method=method)
        then = fm.simulate(swung(), t_end=15.0, rtol=1e-8, method=method, initial=first)
        both = fm.Solution.join([first, then])
        assert len(both.events) == 9, e
        assert both["arm.angle"][-1] == pytest.approx(one["arm.angle"][-1], rel=1e-7)


def gripped(grip):
    """A body of mass 1 that a belt carries which slows down and turns round at t = 2; it rubs on the ground by 0.5."""
    a, belt = fm.Body("a", mass=1.0, velocity={"x": 0.2}), fm.Driven("belt", velocity={"x": 0.2 - 0.1 * fm.t})
    sole = fm.Contact("grip", a, belt, law=fm.laws.Coulomb(mu_s=1.0), normal_force=grip)
    rub = fm.Contact("rub", a, law=fm.laws.Coulomb(mu_s=0.5), normal_force=1.0)
    return fm.Scene("gripped", [a, belt, sole, rub])


@pytest.mark.parametrize("method", ["auto", "bdf"])
@pytest.mark.parametrize(
    ("grip", "x", "told"),
    [
        (10.0, 1.0 - 1.25, [("rub", "reversal")]),
        (0.55, 0.2 - 0.05 * 9.0 / 2.0, [("grip", "slip"), ("rub", "reversal")]),
        (0.45, 0.2, [("grip", "slip"), ("rub", "stick")]),
    ],
)
def test_a_body_between_a_belt_that_turns_round_and_the_ground(grip, x, told, method):
    """It goes on with the belt, slips on both, or stays on the ground: no forces hold it on both."""
    sol = fm.simulate(gripped(grip), t_end=5.0, method=method, time_limit=60)
    np.testing.assert_allclose(sol["a.x"][-1], x, rtol=1e-10)
    assert [(e.contact, e.kind) for e in sol.events] == told
    np.testing.assert_allclose(sol.events.t, 2.0, rtol=1e-12)
    assert sol.audit().ok


LAWS = {
    "coulomb": fm.laws.Coulomb(mu_s=1.0),
    "falls": fm.laws.Coulomb(mu_s=1.0, mu_k=0.7),
    "table": fm.laws.Tabulated(speed=(0.0, 0.1, 1.0), mu=(1.0, 0.8, 0.7)),
}


@pytest.mark.parametrize("law", LAWS.values(), ids=LAWS)
@pytest.mark.parametrize("heavier", [1.0, 1.0 + 1e-9, 1.1])
def test_two_blocks_that_are_let_go_at_once_do_what_one_does(law, heavier):
    """On a shaken belt, tied by a spring that they never stretch."""
    A, w = 1.2, 5.0
    belt = fm.Driven("belt", velocity={"x": -(A / w) * sympy.cos(w * fm.t)})

    def run(masses):
        blocks = [fm.Body(f"b{i}", mass=m, velocity={"x": -A / w}) for i, m in enumerate(masses)]
        pairs = enumerate(zip(blocks, masses, strict=True))
        soles = [fm.Contact(f"c{i}", b, belt, law=law, normal_force=m) for i, (b, m) in pairs]
        ties = [fm.Spring("k", *blocks, axis="x", stiffness=0.5)] if len(blocks) > 1 else []
        return fm.simulate(fm.Scene("shaken", [*blocks, belt, *ties, *soles]), t_end=20.0, rtol=1e-8, time_limit=60)

    one, two = run([1.0]), run([1.0, heavier])
    np.testing.assert_allclose([two["b0.x"][-1], two["b1.x"][-1]], one["b0.x"][-1], atol=3e-9)
    kinds = [e.kind for e in one.events]
    assert [[e.kind for e in two.events.of(contact=f"c{i}")] for i in (0, 1)] == [kinds, kinds]
    assert two.audit().ok


GAP, STIFF, VISCOUS, DRY = 0.05, 2000.0, 1.0, 0.3


def backlash(t_end):
    """Motor and load with play, by solve_ivp from touch to touch: positions, and transitions of the dry load."""
    t, y, s, side, told = 0.0, np.zeros(4), 0, 0, []

    def mesh(z, side):
        return (STIFF * (z[0] - z[1] - side * GAP) + VISCOUS * (z[2] - z[3])) if side else 0.0

    while t < t_end - 1e-13:

        def rate(u, z, s=s, side=side):
            F = mesh(z, side)
            return [z[2], 0.0 if s == 0 else z[3], (np.sin(2 * np.pi * u) - F) / 0.01, s and (F - DRY * s) / 0.05]

        def touch(u, z, side=side):
            return side * (z[0] - z[1]) - GAP if side else abs(z[0] - z[1]) - GAP

        def turn(u, z, s=s, side=side):
            return DRY - abs(mesh(z, side)) if s == 0 else z[3] * s

        touch.terminal, turn.terminal, touch.direction, turn.direction = True, True, -1 if side else 1, -1
        o = solve_ivp(rate, (t, t_end), y, method="DOP853", rtol=1e-12, atol=1e-14, events=[touch, turn], max_step=0.01)
        t, y = o.t[-1], o.y[:, -1].copy()
        if len(o.t_events[0]):
            was, side = side, 0 if side else int(np.sign(y[0] - y[1]))
            y[0] = y[1] + (was or side) * GAP * (1 + (1e-12 if side else -1e-12))
            if s == 0 and abs(mesh(y, side)) > DRY:
                s = int(np.sign(mesh(y, side)))
                told.append("slip")
        elif len(o.t_events[1]):
            F, before = mesh(y, side), s
            y[3], s = 0.0, int(np.sign(F)) if abs(F) > DRY or before == 0 else 0
            told.append("slip" if before == 0 else "reversal" if s else "stick")
    return y[:2], told


RUNS_OF_PLAY = [("auto", 1e-5), ("auto", 1e-6), ("bdf", 1e-7), ("bdf", 1e-8), ("auto", 1e-9)]


@pytest.mark.parametrize(("method", "rtol"), RUNS_OF_PLAY)
def test_play_whose_damping_sets_in_at_once(method, rtol):
    """The force of the mesh jumps as it touches, and lets go of a load that rests; functions that say where differ."""
    motor, load = fm.Body("m", mass=0.01), fm.Body("l", mass=0.05)
    apart = fm.coordinate("m.x") - fm.coordinate("l.x")
    rate = fm.speed("m.x") - fm.speed("l.x")
    spring = STIFF * (sympy.Max(apart - GAP, 0) - sympy.Max(-apart - GAP, 0))
    F = spring + VISCOUS * rate * sympy.Piecewise((1, sympy.Abs(apart) > GAP), (0, True))
    scene = fm.Scene("play", [
        motor, load, fm.Force("motor", motor, axis="x", value=sympy.sin(2 * sympy.pi * fm.t)),
        fm.Force("to_motor", motor, axis="x", value=-F), fm.Force("to_load", load, axis="x", value=F),
        fm.Contact("dry", load, law=fm.laws.Coulomb(mu_s=DRY), normal_force=1.0),
    ])  # fmt: skip
    exact, told = backlash(3.0)
    sol = fm.simulate(scene, t_end=3.0, rtol=rtol, method=method, time_limit=60)
    np.testing.assert_allclose([sol["m.x"][-1], sol["l.x"][-1]], exact, atol=4.0 * rtol + 1e-8)
    assert [e.kind for e in sol.events] == told
    assert sol.audit().ok, sol.audit()


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_play_beside_a_pin_whose_damping_sets_in_at_once(method):
    """With joints modes behind a jump are decided at once, too."""
    motor, load = fm.Body("m", mass=0.01), fm.Body("l", mass=0.05)
    apart = fm.coordinate("m.x") - fm.coordinate("l.x")
    rate = fm.speed("m.x") - fm.speed("l.x")
    spring = STIFF * (sympy.Max(apart - GAP, 0) - sympy.Max(-apart - GAP, 0))
    F = spring + VISCOUS * rate * sympy.Piecewise((1, sympy.Abs(apart) > GAP), (0, True))
    arm = fm.RigidBody("arm", mass=1.0, inertia=1.0, position={"y": -1.0}, points={"top": (0.0, 1.0)})
    scene = fm.Scene("play", [
        motor, load, arm, fm.Revolute("pin", arm.point("top")),
        fm.Force("motor", motor, axis="x", value=sympy.sin(2 * sympy.pi * fm.t)),
        fm.Force("to_motor", motor, axis="x", value=-F), fm.Force("to_load", load, axis="x", value=F),
        fm.Spring("beside", arm, motor, axis="x", stiffness=1e-12),
        fm.Contact("dry", load, law=fm.laws.Coulomb(mu_s=DRY), normal_force=1.0),
    ])  # fmt: skip
    exact, told = backlash(3.0)
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-7, method=method, time_limit=60)
    np.testing.assert_allclose([sol["m.x"][-1], sol["l.x"][-1]], exact, atol=1e-6)
    assert [e.kind for e in sol.events] == told


@pytest.mark.parametrize("method", ["radau", "bdf"])
def test_a_run_that_ends_on_its_way_into_rest_goes_on_at_rest(method):
    """Slip that a located transition leaves off 0 by round-off, to either side, once turned round before it stuck."""
    scene = fm.models.band_brake()
    whole = fm.simulate(scene, t_end=1.6, rtol=1e-6, method=method)
    for event in (e for e in whole.events if e.kind == "stick"):
        for off in (-1e-12, 0.0, 1e-12):
            first = fm.simulate(scene, t_end=event.t + off, rtol=1e-6, method=method)
            then = fm.simulate(scene, t_end=1.6, rtol=1e-6, method=method, initial=first)
            told = [e.kind for sol in (first, then) for e in sol.events]
            assert told == [e.kind for e in whole.events]
