"""Derivatives of slip in two directions under every law that knows two, beside differences of runs."""

from typing import Any

import numpy as np
import pytest
import sympy

import fricmb as fm
from tests.oracle.table import LAWS

from .differences import said, shares_off

_RTOL = 1e-8
_WIDE = sorted(name for name, law in LAWS.items() if 2 in law.dimensions)
_HARD = [name for name in _WIDE if LAWS[name].kind != "smooth"]
#: Of many elements, whose kinks cost a step each: Jenkins and Bristle stand for them.
_COSTLY = ("ElastoPlastic", "GeneralisedMaxwellSlip", "Iwan", "Leuven")


def block(law: Any, *, load: Any, belt: Any, stiffness: Any, start: Any, pull: Any = (0.0, 0.0), damping: float = 0.0):
    """A block on springs and dampers on a belt, pulled along both directions; ``load`` in units of sliding friction."""
    where, speed = (dict(zip("xy", own, strict=True)) for own in start)
    body = fm.Body("m", mass=1.0, axes="xy", position=where, velocity=speed)
    parts: list[Any] = [body, fm.Driven("belt", velocity=dict(zip("xy", belt, strict=True)))]
    for axis, k, F in zip("xy", stiffness, pull, strict=True):
        parts.append(fm.Spring(f"k{axis}", body, axis=axis, stiffness=k))
        parts.append(fm.Damper(f"c{axis}", body, axis=axis, damping=damping))
        parts.append(fm.Force(f"f{axis}", body, axis=axis, value=F))
    N = load / float(law.coefficient(0.3, 1.0))
    return fm.Scene("block", [*parts, fm.Contact("rub", body, parts[1], law=law, normal_force=N, axes="xy")])


def on_a_belt(law):
    """It lands, sticks and breaks away under a load that varies, with directions that turn."""
    load = 1.0 + 0.3 * sympy.sin(2.0 * fm.t)
    return block(law, load=load, belt=(0.2, 0.1), stiffness=(1.0, 1.7), start=((0.5, 0.1), (0.2, -0.3)))


def beside_rest(law):
    """Slip that passes rest closely, or comes to rest and sets out at once."""
    return block(law, load=0.3, belt=(0.0, 0.0), stiffness=(1.0, 2.3), start=((2.0, 0.0), (0.0, 0.01)))


def driven(law):
    """Two forces of different frequencies."""
    pull = 3.0 * sympy.sin(1.3 * fm.t), 1.1 * sympy.sin(2.1 * fm.t + 0.4)
    return block(law, load=1.0, belt=(0.0, 0.0), stiffness=(4.0, 5.2), start=((0.0, 0.0), (0.0, 0.05)), pull=pull)


def broken_away(law):
    """From rest on, along a direction that turns with the pull."""
    pull = 0.7 * fm.t, 0.3 * fm.t + 0.1 * fm.t**2
    start = ((0.0, 0.0), (0.0, 0.0))
    return block(law, load=1.0, belt=(0.0, 0.0), stiffness=(1.0, 1.3), start=start, pull=pull, damping=0.5)


@pytest.mark.parametrize(
    ("make", "name", "parameter", "t_end"),
    [
        *((on_a_belt, name, "kx.stiffness", 9.0) for name in _HARD),
        *((broken_away, name, "m.mass", 5.0) for name in _HARD),
        *((driven, name, "ky.stiffness", 3.0) for name in _WIDE if name not in _COSTLY),
        *((beside_rest, name, "kx.stiffness", 7.0) for name in ("Coulomb", "Elliptic", "CoulombViscous", "Threlfall")),
    ],
)
def test_law_in_two_directions(make, name, parameter, t_end):
    """To a thousand tolerances of the largest derivative, or a note says to how much."""
    scene = make(LAWS[name])
    sol = fm.simulate(scene, t_end=t_end, rtol=_RTOL, sensitivities=(parameter,))
    off = shares_off(sol, (parameter,), enough=1e3 * _RTOL, t_end=t_end)
    assert max(off.values()) < max(said(sol), default=1e3 * _RTOL), (off, sol.stats.notes)


@pytest.mark.parametrize(
    ("scene", "parameter", "t_end"),
    [
        (on_a_belt(fm.laws.BlimanSorine(f1=0.7, f2=0.3, distance=1e-3, eta=0.2)), "kx.stiffness", 2.5),
        (fm.models.billiard(law=LAWS["LuGre"]), "gravity.acceleration.z", 0.45),
    ],
    ids=["BlimanSorine", "a ball under LuGre"],
)
def test_contacts_that_creep(scene, parameter, t_end):
    """Bristles that hold let slip oscillate about rest, which it misses by little, each time within one step.

    Directions have poles there, at which steps were far too long: derivatives were off by up to 1e-3.
    """
    sol = fm.simulate(scene, t_end=t_end, rtol=_RTOL, sensitivities=(parameter,))
    off = shares_off(sol, (parameter,), steps=(2e-4, 2e-5), enough=1e2 * _RTOL, t_end=t_end)
    assert off[parameter] < 1e2 * _RTOL, (off, sol.stats.notes)
    assert sol.stats.notes == ()


def test_slip_that_sets_out_under_friction_that_depends_on_its_speed():
    """A step from rest on was divided until its direction was round-off: derivatives had the wrong sign.

    The second time is that of a release, the third of the landing behind it, which knows what was made of the slip.
    """
    scene = on_a_belt(LAWS["CoulombViscous"])
    ends = [fm.simulate(scene, t_end=9.0, rtol=1e-12, parameters={"kx.stiffness": 1.0 + h}) for h in (1e-5, -1e-5)]
    expected = (ends[0].events.t - ends[1].events.t) / 2e-5
    sol = fm.simulate(scene, t_end=9.0, rtol=1e-8, sensitivities=("kx.stiffness",))
    found = [event.sensitivity("kx.stiffness") for event in sol.events]
    assert [event.kind for event in sol.events] == ["stick", "slip", "stick", "slip"]
    assert np.array(found) == pytest.approx(expected, rel=2e-6)
