"""What friction holds at rest beside what moves: it asks for no steps of its own, and its round-off is no motion."""

import numpy as np
import pytest
import sympy

import fricmb as fm

C = fm.laws.Coulomb
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12)


def row(q, v):
    """One body held for good between one that swings and one that comes to rest."""
    swings = fm.Body("swings", mass=1.0, velocity={"x": 1.0})
    held = fm.Body("held", mass=1.0)
    lands = fm.Body("lands", mass=2.0, position={"x": q}, velocity={"x": v})
    load = 1.0 + 0.25 * sympy.sin(fm.t)
    ties = [("tie1", swings, held, 1.0), ("tie2", held, lands, 0.3)]
    return fm.Scene(
        "row",
        [
            swings, held, lands,
            fm.Spring("ground", swings, axis="x", stiffness=2.0),
            *[fm.Spring(name, a, b, axis="x", stiffness=k) for name, a, b, k in ties],
            fm.Contact("hold", held, law=C(mu_s=10.0, mu_k=5.0), normal_force=load),
            fm.Contact("rub", lands, law=C(mu_s=1.0, mu_k=0.5), normal_force=0.21),
        ],
    )  # fmt: skip


@pytest.mark.parametrize(("q", "v"), [(-0.475, -0.158), (0.2827, 0.7053), (0.5, 0.5), (-0.9, 0.3), (0.1, -0.8)])
def test_a_landing_elsewhere_sets_nothing_in_motion(q, v):
    """The held body is left with the round-off of a landing, which was then followed as if it moved."""
    sols = {rtol: fm.simulate(row(q, v), t_end=200.0, rtol=rtol, method="radau") for rtol in TOLERANCES[:5]}
    fine = sols[1e-8].stats.n_steps
    for rtol, sol in sols.items():
        assert sol.stats.n_steps + sol.stats.n_rejected < 1.2 * fine, rtol
        assert np.abs(sol["held.x"]).max() < 1e-6 * max(rtol, 1e-4) / 1e-4
    # alone against a wall that it hangs on: x'' = -3 x
    swings = sols[1e-8]["swings.x"]
    assert swings == pytest.approx(np.sin(3**0.5 * sols[1e-8].t) / 3**0.5, abs=1e-6)


def stack(slope, law):
    """Two bodies held on one another, of which the upper presses by where it is, below one that slides."""
    low, mid = fm.Body("low", mass=0.9, position={"x": 0.14}), fm.Body("mid", mass=0.6, position={"x": 0.59})
    top = fm.Body("top", mass=1.0, position={"x": -0.9})
    load = 0.376 * (1 + slope * fm.coordinate("mid.x"))
    return fm.Scene(
        "stack",
        [
            low, mid, top,
            fm.Spring("k", top, axis="x", stiffness=0.44),
            fm.Force("f0", low, axis="x", value=0.33),
            fm.Force("f1", mid, axis="x", value=-0.56 + 0.65 * sympy.sin(0.56 * fm.t)),
            fm.Contact("c0", low, law=C(mu_s=1.1, mu_k=0.7), normal_force=1.56),
            fm.Contact("c1", mid, low, law=C(mu_s=2.0), normal_force=load, axes="x"),
            fm.Contact("c2", top, mid, law=law, normal_force=0.336),
        ],
    )  # fmt: skip


@pytest.mark.parametrize("method", ["radau", "bdf"])
@pytest.mark.parametrize("law", [C(mu_s=0.93, mu_k=0.71), fm.laws.Stribeck(mu_s=0.93, mu_k=0.71, v_s=0.036)])
def test_what_rests_is_not_solved_below_its_round_off(law, method):
    """Newton's method was asked for velocities of 1e-23 where forces leave 1e-18: steps crept, or were given up."""
    counts = []
    for rtol in TOLERANCES:
        sol = fm.simulate(stack(-0.1, law), t_end=1.66, rtol=rtol, method=method, time_limit=30.0)
        assert not sol.events
        assert np.ptp(sol["mid.x"]) < 1e-15
        counts.append(sol.stats.n_steps + sol.stats.n_rejected)
    assert max(counts) < 400


@pytest.mark.parametrize("method", ["auto", "radau", "bdf"])
@pytest.mark.parametrize("power", [-16, -8, 0, 8, 16])
def test_events_do_not_depend_on_units(power, method):
    """A normal force was compared with a slip speed: of small forces it was the force that seemed to end."""
    f = 10.0**power
    block = fm.Body("block", mass=f, velocity={"x": 1.0})
    scene = fm.Scene(
        "units",
        [
            block,
            fm.Spring("k", block, axis="x", stiffness=f),
            fm.Force("push", block, axis="x", value=2 * f * sympy.sin(1.3 * fm.t)),
            fm.Contact(
                "c", block, law=C(mu_s=0.5, mu_k=0.4), normal_force=f * (1 + 0.3 * sympy.sin(fm.t))
            ),
        ],
    )
    sol = fm.simulate(scene, t_end=40.0, rtol=1e-8, method=method)
    assert {event.kind for event in sol.events} == {"reversal"}
    assert len(sol.events) == 16
