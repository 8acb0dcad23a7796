"""Joints, points, assembly and errors."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import fricmb as fm

G = 9.81


def test_physical_pendulum():
    body = fm.RigidBody("bar", mass=2.0, inertia=2.0 / 3.0, position=(1.0, 0.0), points={"end": (-1.0, 0.0)})
    scene = fm.Scene("pendulum", [body, fm.Revolute("pin", body.point("end")), fm.Gravity("g")])
    sol = fm.simulate(scene, t_end=5.0, rtol=1e-10)
    exact = solve_ivp(
        lambda t, y: [y[1], -0.75 * G * np.cos(y[0])], (0.0, 5.0), [0.0, 0.0], method="DOP853", rtol=1e-13, atol=1e-13
    )
    assert sol["bar.angle"][-1] == pytest.approx(exact.y[0, -1], abs=1e-9)
    np.testing.assert_allclose(sol["bar.end.x"], 0.0, atol=1e-14)
    np.testing.assert_allclose(sol.velocity("bar.end.y"), 0.0, atol=1e-13)
    rate, angle = sol.velocity("pin.angle"), sol["pin.angle"]
    # reaction across the bar: the quarter of its weight that the centre of percussion leaves
    across = sol.reaction("pin")[1] * np.cos(angle) - sol.reaction("pin")[0] * np.sin(angle)
    np.testing.assert_allclose(across, 2.0 * G * np.cos(angle) / 4, atol=1e-10)
    along = sol.reaction("pin")[0] * np.cos(angle) + sol.reaction("pin")[1] * np.sin(angle)
    np.testing.assert_allclose(along, 2.0 * (G * np.sin(angle) - rate**2), atol=1e-10)


def test_slider_crank_is_a_quadrature():
    crank, rod = 0.1, 0.3
    m1, m2, m3 = masses = (1.0, 0.6, 0.8)
    scene = fm.models.slider_crank(
        crank=crank, rod=rod, masses=masses, angle=0.3, speed=30.0, friction=None
    )

    def inertia(angle):
        lean = np.arcsin(crank * np.sin(angle) / rod)
        turn = -crank * np.cos(angle) / (rod * np.cos(lean))
        tip = np.array([-crank * np.sin(angle), crank * np.cos(angle)])
        middle = tip + turn * rod / 2 * np.array([np.sin(lean), np.cos(lean)])
        slide = tip[0] + turn * rod * np.sin(lean)
        return m1 * crank**2 / 3 + m2 * (middle @ middle) + m2 * rod**2 / 12 * turn**2 + m3 * slide**2

    energy = inertia(0.3) * 30.0**2
    sol = fm.simulate(scene, t_end=0.5, rtol=1e-8)
    end = sol["crank.angle"][-1]
    knots = np.append(np.arange(0.3, end, 1.0), end)
    total = sum(
        quad(lambda a: np.sqrt(inertia(a) / energy), low, high, epsabs=1e-13)[0] for low, high in pairwise(knots)
    )
    assert total == pytest.approx(0.5, abs=1e-8)


def test_slider_crank_with_friction_closes_its_ledger():
    sol = fm.simulate(fm.models.slider_crank(friction=fm.laws.Coulomb(mu_s=0.2)), t_end=1.0, rtol=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-6
    assert sol.energy.friction_loss[-1] > 1.0


def test_four_bar_keeps_energy_and_closes():
    sol = fm.simulate(fm.models.four_bar(), t_end=2.0, rtol=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-8
    np.testing.assert_allclose(sol["rocker.tip.x"], sol["coupler.tip.x"], atol=1e-14)


@pytest.mark.slow
def test_constraints_hold_over_ten_thousand_periods():
    body = fm.RigidBody("bar", mass=1.0, inertia=1e-9, position=(1.0, 0.0), angle=0.0)
    pin = fm.Revolute("pin", body.point("end", (-1.0, 0.0)))
    spring = fm.TorsionSpring("spring", body, stiffness=1.0, angle=-0.5)
    sol = fm.simulate(fm.Scene("rotor", [body, pin, spring]), t_end=2 * np.pi * 10_000, rtol=1e-5)
    assert len(sol.t) > 40_000  # several steps a period
    assert np.abs(np.hypot(sol["bar.x"], sol["bar.y"]) - 1.0).max() < 1e-14
    radial = sol["bar.x"] * sol.velocity("bar.x") + sol["bar.y"] * sol.velocity("bar.y")
    assert np.abs(radial).max() < 1e-13
    between = sol.at(np.linspace(0.0, sol.t_end, 777))
    assert np.abs(np.hypot(between["bar.x"], between["bar.y"]) - 1.0).max() < 1e-14


def test_gear_drive_rod_roller_circle_and_driven_joints():
    a = fm.RigidBody("a", mass=1.0, inertia=1.0)
    b = fm.RigidBody("b", mass=1.0, inertia=2.0, position=(3.0, 0.0))
    scene = fm.Scene(
        "gears",
        [
            a, b, fm.Revolute("A", a), fm.Revolute("B", b, fm.ground_point(3.0, 0.0)),
            fm.Gear("teeth", a, b, ratio=2.0),
            fm.Torque("motor", a, value=3.0),
        ],
    )  # fmt: skip
    sol = fm.simulate(scene, t_end=2.0)
    # (1 + 2/4) a'' = 3
    assert sol["a.angle"][-1] == pytest.approx(4.0, rel=1e-9)
    assert sol["b.angle"][-1] == pytest.approx(-2.0, rel=1e-9)
    assert sol.reaction("teeth")[0, -1] == pytest.approx(-1.0, rel=1e-9)
    bead = fm.Body("bead", mass=1.0, axes="xy", position={"x": 2.0}, velocity={"y": 3.0})
    round_ = fm.simulate(fm.Scene("circle", [bead, fm.RollerOnCircle("wire", bead, radius=2.0)]), t_end=1.0)
    assert np.arctan2(round_["bead.y"][-1], round_["bead.x"][-1]) == pytest.approx(1.5, rel=1e-9)
    assert round_.reaction("wire")[0, -1] == pytest.approx(-4.5, rel=1e-7)
    arm = fm.RigidBody("arm", mass=1.0, inertia=1.0, velocity=(0.0, 0.0), angular_velocity=1.0)
    driven = fm.Scene("arm", [arm, fm.Revolute("O", arm), fm.DrivenAngle("drive", arm, angle=fm.t + fm.t**2)])
    sol = fm.simulate(driven, t_end=2.0)
    assert sol["arm.angle"][-1] == pytest.approx(6.0, rel=1e-12)
    assert sol.reaction("drive")[0, -1] == pytest.approx(2.0, rel=1e-9)
    assert np.abs(sol.energy.residual).max() < 1e-9


def test_springs_dampers_and_forces_act_on_points():
    body = fm.RigidBody("plate", mass=2.0, inertia=0.5, points={"corner": (0.5, 0.2)}, angle=0.3)
    corner = body.point("corner")
    scene = fm.Scene(
        "plate",
        [
            body,
            fm.Spring("kx", corner, axis="x", stiffness=30.0),
            fm.PointSpring("line", body, stiffness=20.0, length=0.5, anchor=(1.0, 1.0)),
            fm.Damper("c", corner, axis="y", damping=0.4),
            fm.Force("push", corner, axis="y", value=2.0),
            fm.TorsionDamper("t", body, damping=0.1),
        ],
    )
    sol = fm.simulate(scene, t_end=3.0, rtol=1e-9)

    def rate(t, y):
        x, yy, a, vx, vy, w = y
        r = np.array([np.cos(a) * 0.5 - np.sin(a) * 0.2, np.sin(a) * 0.5 + np.cos(a) * 0.2])
        v = np.array([vx, vy]) + w * np.array([-r[1], r[0]])
        f = np.array([-30.0 * (x + r[0]), 2.0 - 0.4 * v[1]])
        d = np.array([x - 1.0, yy - 1.0])
        g = -20.0 * (np.linalg.norm(d) - 0.5) * d / np.linalg.norm(d)
        return [vx, vy, w, *((f + g) / 2.0), (r[0] * f[1] - r[1] * f[0] - 0.1 * w) / 0.5]

    exact = solve_ivp(rate, (0.0, 3.0), [0, 0, 0.3, 0, 0, 0], method="DOP853", rtol=1e-13, atol=1e-13)
    np.testing.assert_allclose(np.concatenate([sol.q[:, -1], sol.v[:, -1]]), exact.y[:, -1], atol=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-9


def test_start_is_moved_onto_the_constraints_and_that_is_said():
    body = fm.RigidBody("bar", mass=1.0, inertia=1.0, position=(1.01, 0.0), velocity=(1.0, 0.0))
    sol = fm.simulate(fm.Scene("s", [body, fm.Revolute("pin", body.point("end", (-1.0, 0.0)))]), t_end=0.1)
    assert np.hypot(sol["bar.x"][0], sol["bar.y"][0]) == pytest.approx(1.0, abs=1e-15)
    assert any("positions at the start were moved" in note and "bar.x" in note for note in sol.stats.notes)
    assert any("velocities at the start were moved" in note for note in sol.stats.notes)


def test_a_mechanism_that_cannot_close_names_its_joints():
    a = fm.RigidBody("a", mass=1.0, inertia=1.0, position=(0.5, 0.0), points={"l": (-0.5, 0.0), "r": (0.5, 0.0)})
    b = fm.RigidBody("b", mass=1.0, inertia=1.0, position=(1.5, 0.0), points={"l": (-0.5, 0.0), "r": (0.5, 0.0)})
    parts = [
        a, b, fm.Revolute("left", a.point("l")), fm.Revolute("middle", b.point("l"), a.point("r")),
        fm.Revolute("right", b.point("r"), fm.ground_point(3.0, 0.0)),
    ]  # fmt: skip
    with pytest.raises(fm.SceneError, match=r"cannot be assembled.*'right'"):
        fm.simulate(fm.Scene("gap", parts), t_end=1.0)


def parallelogram(friction=None):
    """Five bars in two loops: one constraint too many, but consistent."""
    bars = [
        fm.RigidBody(f"leg{i}", mass=1.0, inertia=0.1, position=(float(i), 0.5), angle=np.pi / 2,
                     points={"foot": (-0.5, 0.0), "head": (0.5, 0.0)})
        for i in range(3)
    ]  # fmt: skip
    heads = {f"h{i}": (i - 1.0, 0.0) for i in range(3)}
    top = fm.RigidBody("top", mass=1.0, inertia=0.3, position=(1.0, 1.0), points=heads, velocity=(1.0, 0.0))
    feet = [fm.Revolute(f"foot{i}", bar.point("foot"), fm.ground_point(float(i), 0.0)) for i, bar in enumerate(bars)]
    pins = [
        fm.Revolute(f"head{i}", top.point(f"h{i}"), bar.point("head"), radius=0.1, friction=friction)
        for i, bar in enumerate(bars)
    ]
    return fm.Scene("table", [*bars, top, *feet, *pins, fm.Gravity("g")])


def test_redundant_constraints_are_named_and_the_motion_is_right():
    sol = fm.simulate(parallelogram(), t_end=0.5, rtol=1e-9)
    assert any("redundant constraints: 1 of" in note for note in sol.stats.notes)
    # one coordinate: (3 (0.1 + 0.25) + 1) a'' = (3/2 + 1) G sin(lean)
    lean = solve_ivp(
        lambda t, y: [y[1], 2.5 * G * np.sin(y[0]) / 2.05], (0.0, 0.5), [0.0, sol.velocity("top.x")[0]],
        method="DOP853", rtol=1e-12, atol=1e-13,
    )  # fmt: skip
    assert np.pi / 2 - sol["leg1.angle"][-1] == pytest.approx(lean.y[0, -1], abs=1e-8)
    np.testing.assert_allclose(sol["top.angle"], 0.0, atol=1e-13)
    # least norm: the outer legs bear alike
    assert np.isfinite(sol.reaction("head0")).all()


def test_friction_on_an_undetermined_reaction_is_refused():
    with pytest.raises(fm.SceneError, match=r"'head.'.*redundant"):
        fm.simulate(parallelogram(fm.laws.Coulomb(mu_s=0.3)), t_end=0.1)


def test_a_singular_start_is_refused_by_name():
    """A parallelogram stretched flat may go on as an antiparallelogram."""
    names = ("foot0", "foot1")
    bars = [
        fm.RigidBody(f"leg{i}", mass=1.0, inertia=0.1, position=(i + 0.5, 0.0), points={"a": (-0.5, 0), "b": (0.5, 0)})
        for i in range(2)
    ]
    top = fm.RigidBody("top", mass=1.0, inertia=0.3, position=(1.5, 0.0), points={"l": (-0.5, 0.0), "r": (0.5, 0.0)})
    parts = [
        *bars, top, *(fm.Revolute(n, b.point("a"), fm.ground_point(float(i), 0)) for i, (n, b) in
                      enumerate(zip(names, bars, strict=True))),
        fm.Revolute("left", top.point("l"), bars[0].point("b")),
        fm.Revolute("right", top.point("r"), bars[1].point("b")),
    ]  # fmt: skip
    with pytest.raises(fm.SceneError, match="singular position"):
        fm.simulate(fm.Scene("flat", parts), t_end=0.1)


def test_declarations_that_cannot_be():
    body = fm.RigidBody("b", mass=1.0, inertia=1.0)
    with pytest.raises(fm.SceneError, match="mass must be a finite number > 0"):
        fm.RigidBody("b", mass=0.0, inertia=1.0)
    with pytest.raises(fm.SceneError, match="different parts"):
        fm.Revolute("pin", body, body.point("p", (1.0, 0.0)))
    with pytest.raises(fm.SceneError, match="radius must be a finite number > 0"):
        fm.Revolute("pin", body, friction=fm.laws.Coulomb(mu_s=0.1))
    with pytest.raises(fm.SceneError, match="no slip"):
        fm.Rod("rod", body, length=1.0, friction=fm.laws.Coulomb(mu_s=0.1))
    with pytest.raises(KeyError, match="point of"):
        body.point("tip")
    with pytest.raises(fm.SceneError, match="one of angle and speed"):
        fm.DrivenAngle("d", body)


def test_contacts_act_on_points():
    block = fm.RigidBody("block", mass=2.0, inertia=1.0, velocity=(3.0, 0.0))
    rail = fm.RollerOnLine("rail", block)
    law = fm.laws.Coulomb(mu_s=0.3)
    level = fm.TorsionSpring("level", block, stiffness=1e4)
    shoe = fm.Contact("shoe", block.point("foot", (0.0, -1.0)), law=law, normal_force=10.0, axes="x")
    sol = fm.simulate(fm.Scene("sled", [block, rail, level, shoe]), t_end=3.0, rtol=1e-8)
    assert [event.kind for event in sol.events][-1] == "stick"
    # what friction takes is the kinetic energy, less what the leaning spring keeps
    assert np.abs(sol.energy.residual).max() < 1e-8
    assert sol.energy.friction_loss[-1] == pytest.approx(9.0, rel=1e-3)
    both = fm.Contact("shoe", block, law=law, normal_force=10.0)
    sol = fm.simulate(fm.Scene("sled", [block, rail, both]), t_end=3.0, rtol=1e-8)
    np.testing.assert_allclose(sol.events.t, [3.0 / (0.3 * 10.0 / 2.0)], rtol=1e-9)


def test_gravity_without_anything_that_turns():
    body = fm.Body("stone", mass=3.0, axes="xy", velocity={"x": 1.0})
    scene = fm.Scene("throw", [body, fm.Gravity("g"), fm.Spring("k", body, axis="x", stiffness=12.0)])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-9)
    assert sol["stone.y"][-1] == pytest.approx(-G * 2.0, rel=1e-8)
    assert np.abs(sol.energy.residual).max() < 1e-8


def test_equations_of_a_mechanism():
    equations = fm.models.dry_pendulum().equations()
    assert [str(symbol) for symbol in equations.q] == ["x_arm", "y_arm", "theta_arm"]
    (pin,) = equations.constraints
    assert [str(e) for e in pin.expressions] == ["x_arm - 0.7*cos(theta_arm)", "y_arm - 0.7*sin(theta_arm)"]
    # the pin's torque about the centre of mass
    assert "0.7*lambda_pin_1*sin(theta_arm) - 0.7*lambda_pin_2*cos(theta_arm)" in str(equations.rhs[2])
    assert equations.latex().count("lambda_{pin, 1}") > 0


def test_nothing_is_derived_for_more_links():
    from fricmb.equations import derivations
    from fricmb.system import build

    def chain(n):
        links = [
            fm.RigidBody(
                f"l{i}", mass=1.0, inertia=0.1, position=(i + 0.5, 0.0), points={"a": (-0.5, 0), "b": (0.5, 0)}
            )
            for i in range(n)
        ]
        pins = [
            fm.Revolute(f"j{i}", links[i].point("a"), links[i - 1].point("b") if i else fm.GROUND) for i in range(n)
        ]
        return fm.Scene("chain", [*links, *pins, fm.Gravity("g")])

    build(chain(2))
    before = len(derivations)
    build(chain(100))
    assert len(derivations) == before


def test_parameters_sweep_save_and_go_on(tmp_path):
    scene = fm.models.four_bar(friction=fm.laws.Coulomb(mu_s=0.1))
    light = scene.with_parameters({"coupler.mass": 0.1, "A.friction.mu_s": 0.3})
    first = fm.simulate(light, t_end=0.3, rtol=1e-9)
    whole = fm.simulate(light, t_end=0.6, rtol=1e-9)
    second = fm.simulate(light, t_end=0.6, rtol=1e-9, initial=first)
    np.testing.assert_allclose(second.q[:, -1], whole.q[:, -1], atol=1e-8)
    first.save(tmp_path / "run.npz")
    loaded = fm.Solution.load(tmp_path / "run.npz")
    np.testing.assert_array_equal(loaded["coupler.tip.x"], first["coupler.tip.x"])
    np.testing.assert_allclose(loaded(0.15), first(0.15))
    np.testing.assert_allclose(loaded.reaction("A"), first.reaction("A"))
    ends = fm.sweep(
        light, [{"A.friction.mu_s": x} for x in (0.0, 0.2)], t_end=0.2,
        reduce=lambda s: float(s.energy.friction_loss[-1]), workers=1, progress=False,
    )  # fmt: skip
    assert ends[0] < ends[1]


@pytest.mark.parametrize("wrong", [None, "x", (1.0, 0.0), np.nan, True])
@pytest.mark.parametrize(("kind", "field"), [
    ("Gear", "ratio"), ("Prismatic", "angle"), ("RollerOnLine", "angle"), ("DrivenSlide", "angle"),
    ("TorsionSpring", "stiffness"), ("TorsionSpring", "angle"), ("TorsionDamper", "damping"),
])  # fmt: skip
def test_a_field_that_is_no_number_is_named_where_it_is_declared(kind, field, wrong):
    one, other = (fm.RigidBody(name, mass=1.0, inertia=0.1) for name in ("one", "other"))
    right = {"DrivenSlide": {"speed": 1.0}, "TorsionSpring": {"stiffness": 1.0}}.get(kind, {})
    with pytest.raises(fm.SceneError, match=f"{kind} 'part': {field} must be a finite number, got "):
        getattr(fm, kind)("part", one, other, **{**right, field: wrong})
