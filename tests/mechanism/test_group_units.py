"""A group of dry joints that holds together lets go at the same instant whatever the units: each row has its own scale.

Witness: motion does not depend on units.  A box on two feet slips once what pulls it is mu_s m g (by hand); a pin
without load changes nothing, so that a gear beside it moves as without its friction.
"""

from __future__ import annotations

import numpy as np
import pytest
import sympy

import fricmb as fm

#: Factors of mass, length and time: grams and millimetres, micrometres, microseconds, and large ones.
UNITS = [(1.0, 1.0, 1.0), (1e-3, 1e-3, 1.0), (1.0, 1e6, 1.0), (1.0, 1e-6, 1.0), (1.0, 1.0, 1e-6), (1e3, 1e3, 1e3)]


def feet(mass, length, time):
    """A box that a growing force pulls, on two feet whose loads follow what each of them holds."""
    force = mass * length / time**2
    law = fm.laws.Coulomb(mu_s=1.0, mu_k=0.5)
    box = fm.RigidBody("b", mass=mass, inertia=0.1 * mass * length**2, position=(0.0, 0.2 * length))
    left, right = box.point("p1", (-0.5 * length, -0.2 * length)), box.point("p2", (0.5 * length, -0.2 * length))
    return fm.Scene("box", [
        box, fm.Gravity("g", acceleration={"y": -length / time**2}),
        fm.Force("F", box, axis="x", value=0.1 * force * fm.t / time),
        fm.RollerOnLine("r1", left, friction=law), fm.RollerOnLine("r2", right, friction=law),
    ])  # fmt: skip


def drive(mass, length, time, angle, pin):
    """A motor that drives a loaded drum through a gear with losses; the drum rubs, and so may the motor's pin."""
    torque = mass * length**2 / time**2
    motor = fm.RigidBody("motor", mass=mass, inertia=0.01 * mass * length**2)
    drum = fm.RigidBody("drum", mass=5.0 * mass, inertia=0.4 * mass * length**2, position=(0.5 * length, 0.0))
    rubs = {"radius": 0.01 * length, "friction": fm.laws.Coulomb(mu_s=0.1)} if pin else {}
    return fm.Scene("drive", [
        motor, drum, fm.Revolute("p1", motor, **rubs), fm.Revolute("p2", drum, fm.ground_point(0.5 * length, 0.0)),
        fm.Gear("w", motor, drum, ratio=3.0, efficiency=0.8, pressure_angle=angle),
        fm.Torque("load", drum, value=-6.0 * torque),
        fm.Torque("drive", motor, value=-6.0 * torque * sympy.sin(3.0 * fm.t / time)),
        fm.DryFriction("dd", drum, axis="angle", static=0.5 * torque, normal_force=1.0),
    ])  # fmt: skip


@pytest.mark.parametrize("unit", UNITS)
def test_two_feet_let_go_together_when_both_are_at_their_limits(unit):
    sol = fm.simulate(feet(*unit), t_end=12.0 * unit[2], rtol=1e-8)
    assert [e.kind for e in sol.events] == ["slip", "slip"]
    assert np.allclose([e.t / unit[2] for e in sol.events], 10.0, rtol=1e-10)
    # x'' = 0.1 t - 0.5 from t = 10 on
    assert np.isclose(sol["b.x"][-1] / unit[1], 0.1 * (12**3 - 10**3) / 6 - 0.25 * 4 - 0.05 * 100 * 2, rtol=1e-9)


@pytest.mark.parametrize("unit", UNITS)
@pytest.mark.parametrize(("angle", "pin", "right"), [
    (0.349, True, 4.863475126858), (0.349, False, 4.942407692560), (None, True, 4.942407692560),
], ids=["loaded pin", "no pin", "pin without load"])  # fmt: skip
def test_a_gear_a_pin_and_dry_friction_hold_alike_in_all_units(unit, angle, pin, right):
    sol = fm.simulate(drive(*unit, angle, pin), t_end=1.2 * unit[2], rtol=1e-8)
    assert np.isclose(sol["drum.angle"][-1], right, rtol=1e-8)
