"""Audits pass right runs and fail wrong ones: right runs are made wrong on purpose, one thing at a time."""

import dataclasses

import numpy as np
import pytest
import sympy

import fricmb as fm
from tests.audit.changed import Changed


def oscillator(law, *, force=None, belt=None, normal_force=1.0, stiffness=4.0):
    block = fm.Body("block", mass=1.0)
    parts = [block, fm.Spring("spring", block, axis="x", stiffness=stiffness)]
    ground = fm.Driven("belt", velocity={"x": belt}) if belt is not None else fm.GROUND
    parts += [ground] if belt is not None else []
    parts.append(fm.Contact("sole", block, ground, law=law, normal_force=normal_force))
    if force is not None:
        parts.append(fm.Force("push", block, axis="x", value=force))
    return fm.Scene("oscillator", parts)


def stick_slip():
    return oscillator(fm.laws.Coulomb(mu_s=1.5, mu_k=1.0), belt=0.1, stiffness=1.0)


def changed(sol, change):
    """The audit of a run with other values."""
    (piece,) = sol.run.pieces
    piece._trajectory = Changed(piece.trajectory, change)
    return sol.audit()


def with_(**rows):
    return lambda samples: dataclasses.replace(samples, **{k: f(samples) for k, f in rows.items()})


@pytest.mark.parametrize("method", ["auto", "bdf", "radau", "taylor"])
@pytest.mark.parametrize("scene", [stick_slip(), fm.models.friction_oscillator()], ids=["belt", "decay"])
def test_right_runs_pass(scene, method):
    sol = fm.simulate(scene, t_end=30.0, rtol=1e-6, method=method)
    audit = sol.audit()
    assert audit.ok, audit.table()
    assert {"equations of motion", "friction law", "cone of friction", "creep in stick", "energy"} <= {
        check.name for check in audit.checks
    }
    assert len(str(audit).splitlines()) == 3


@pytest.mark.parametrize(
    ("scene", "t_end"),
    [
        (fm.models.brake4dof("2"), 60.0),
        (fm.models.pad_rotor(), 0.01),
        (fm.models.dry_pendulum(), 4.0),
        (fm.models.slider_crank(), 2.0),
        (fm.models.minimal_flutter(), 3.0),
    ],
    ids=lambda value: getattr(value, "name", ""),
)
def test_two_directions_modes_and_joints_pass(scene, t_end):
    audit = fm.simulate(scene, t_end=t_end, rtol=1e-7).audit()
    assert audit.ok, audit.table()


@pytest.mark.parametrize(
    ("change", "check"),
    [
        (with_(v=lambda s: s.v * (1 + 1e-3)), "equations of motion"),
        (with_(q=lambda s: s.q + 1e-3 * np.sin(5.0 * s.t)), "velocity and position"),
        (with_(F=lambda s: s.F * (1 + 1e-3)), "friction law"),
        (with_(F=lambda s: s.F * np.where(s.mode == 0, 1 + 1e-3, 1.0)), "cone of friction"),
        (with_(v=lambda s: s.v + 1e-3 * (s.mode == 0)), "creep in stick"),
        (with_(mode=lambda s: np.where((s.t > 5.0) & (s.t < 12.0), 1, s.mode).astype(np.int8)), "release from stick"),
        (with_(N=lambda s: s.N * 1.001), "normal force"),
        (with_(friction_loss=lambda s: s.friction_loss * 1.01), "friction losses"),
    ],
    ids=["v", "q", "F in slip", "F in stick", "creep", "slip without cause", "N", "loss"],
)
def test_a_right_run_made_wrong_fails(change, check):
    sol = fm.simulate(stick_slip(), t_end=40.0, rtol=1e-6, method="radau")
    assert sol.audit().ok
    audit = changed(sol, change)
    assert not audit[check].ok, audit.table()
    assert audit[check].part in ("block.x", "sole")


def test_states_that_stay_behind_fail():
    """A law state that rests at its limit through a reversal, as a solver leaves it that never looks at its rate."""
    scene = oscillator(fm.laws.Dahl(sigma0=20.0, mu=0.5), force=0.4 * fm.t)
    sol = fm.simulate(scene, t_end=4.0, rtol=1e-7)
    assert sol.audit().ok, sol.audit().table()
    audit = changed(sol, with_(z=lambda s: np.where(s.t > 1.0, s.z * 0.99 + 0.01 * s.z.max(), s.z)))
    assert not audit["states of laws"].ok


def test_a_shifted_transition_fails():
    """The instant of a break-away is wrong by a thousandth of the run."""
    sol = fm.simulate(stick_slip(), t_end=40.0, rtol=1e-6, method="radau")
    held = sol.run.pieces[0].trajectory

    def late(samples):
        slow = held.sample(np.clip(samples.t - 0.04, 0.0, None))
        return dataclasses.replace(slow, t=samples.t)

    assert not changed(sol, late).ok


def test_slip_that_skips_its_growth_fails():
    """Steep weakening: the beginning of slip is a straight line instead of an exponential."""
    law = fm.laws.Stribeck(mu_s=1.5, mu_k=1.0, v_s=3e-3, exponent=1.0)
    sol = fm.simulate(oscillator(law, belt=0.1, stiffness=1.0), t_end=20.0, rtol=1e-4, method="taylor")
    assert sol.audit().ok, sol.audit().table()
    begin = next(e.t for e in sol.events if e.kind == "slip")

    def jumped(samples):
        tau = np.clip(samples.t - begin, 0.0, 0.05)
        sooner = -0.4 * tau * (samples.t > begin)
        return dataclasses.replace(samples, v=samples.v + sooner, g=samples.g + sooner)

    assert not changed(sol, jumped).ok


def test_what_others_have_is_kept(tmp_path):
    """Islands, runs that go on, saved files, long runs, and an absolute tolerance."""
    pads = [fm.Body(f"b{i}", mass=1.0, velocity={"x": 1.0 + i}) for i in range(3)]
    parts = [*pads, *(fm.Spring(f"k{i}", b, axis="x", stiffness=1.0 + i) for i, b in enumerate(pads))]
    parts += [fm.Contact(f"c{i}", b, law=fm.laws.Coulomb(mu_s=0.1), normal_force=1.0) for i, b in enumerate(pads)]
    islands = fm.simulate(fm.Scene("three", parts), t_end=10.0)
    assert islands.audit().ok, islands.audit().table()
    first = fm.simulate(stick_slip(), t_end=20.0)
    both = fm.Solution.join([first, fm.simulate(stick_slip(), t_end=40.0, initial=first)])
    assert both.audit().ok, both.audit().table()
    both.save(tmp_path / "run.npz")
    loaded = fm.Solution.load(tmp_path / "run.npz")
    assert loaded.audit().ok
    assert loaded.audit().rtol == pytest.approx(1e-6)
    grid = np.linspace(0.0, 40.0, 101)
    coarse = fm.simulate(stick_slip(), t_end=40.0, rtol=1e-5, atol=1e-7, t_eval=grid)
    assert coarse.audit().ok
    assert coarse.stats.atol == (1e-7, 1e-7)


def test_loads_in_time_and_springs_of_belts():
    """Expressions of time, prescribed positions, normal forces that vary."""
    t = fm.t
    block = fm.Body("block", mass=2.0)
    shaker = fm.Driven("shaker", position={"x": 0.3 * sympy.sin(2.0 * t)})
    scene = fm.Scene("shaken", [
        block, shaker,
        fm.Spring("k", block, shaker, axis="x", stiffness=10.0, cubic=3.0),
        fm.Force("kick", block, axis="x", value=sympy.Piecewise((1.0, t < 2.0), (-0.5, True))),
        fm.Contact("sole", block, law=fm.laws.Coulomb(mu_s=0.4, mu_k=0.3), normal_force=2.0 + sympy.cos(t)),
    ])  # fmt: skip
    audit = fm.simulate(scene, t_end=10.0, rtol=1e-7).audit()
    assert audit.ok, audit.table()


@pytest.mark.parametrize("axis", [(0, 1, 0), (1, 1, 0), (1, 2, 3)])
@pytest.mark.parametrize("weight", [0.0, 9.81])
def test_what_slides_evenly_in_a_guide_is_not_found_wrong(axis, weight):
    """Nothing turns and nothing changes: the round-off of reactions is all there is in most of the equations."""
    along = np.array(axis) / np.linalg.norm(axis)
    body = fm.space.RigidBody(
        "slide", mass=2.0, inertia=(0.1, 0.2, 0.15), velocity=along, points={"shoe": (0.1, 0.05, -0.2)}
    )
    guide = fm.space.Prismatic("guide", body.point("shoe"), fm.space.ground_point(0.1, 0.05, -0.2), axis=axis)
    across = np.cross(along, (1.0, 0.0, 0.0))
    push = fm.Gravity("push", acceleration=dict(zip("xyz", weight * across / np.linalg.norm(across), strict=True)))
    found = fm.simulate(fm.Scene("guide", [body, guide, push]), t_end=1.0, rtol=1e-8).audit()
    assert found.ok


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_knots_of_a_table_are_no_errors(rtol):
    """Slip passes knots, where the integrand of its growth bends: a rule over them erred by 1e5 times the bar."""
    law = fm.laws.Tabulated(speed=(0.0, 0.2, 1.0, 3.0), mu=(1.2, 0.9, 0.7, 0.8))
    scene = fm.models.belt_oscillator(law=law, belt=0.1)
    found = fm.simulate(scene, t_end=60.0, rtol=rtol).audit()
    assert found.ok, found
