"""Whose work is input: forces that the user gives, constant ones as well; weight is stored energy."""

import numpy as np
import pytest

import fricmb as fm


def pulled(value=2.0, **parts):
    body = fm.Body("b", mass=1.0)
    rub = fm.Contact("rub", body, law=fm.laws.Coulomb(mu_s=0.1), normal_force=10.0)
    return fm.Scene("pulled", [body, fm.Force("F", body, axis="x", value=value), rub])


@pytest.mark.parametrize("method", ["auto", "radau", "bdf", "taylor"])
def test_work_of_a_constant_force_is_input(method):
    """x = t^2/2 under a net force of 1: 100 J pulled in over 50 m, half of it lost, half kinetic."""
    sol = fm.simulate(pulled(), t_end=10.0, method=method)
    energy = sol.energy
    assert energy.input[-1] == pytest.approx(100.0)
    assert energy.input == pytest.approx(2.0 * sol["b.x"], abs=1e-6)
    assert energy.friction_loss[-1] == pytest.approx(50.0)
    assert np.all(energy.potential == 0.0)
    assert np.abs(energy.residual).max() < 1e-9
    assert sol.at([5.0]).energy.input == pytest.approx([25.0])


def test_work_goes_on_from_run_to_run(tmp_path):
    """The force is twice as large in the second half: no energy jumps where its potential would."""
    first = fm.simulate(pulled(), t_end=2.0, t_eval=[0.0, 1.0, 2.0])
    second = fm.simulate(pulled(4.0), t_end=3.0, initial=first)
    joined = fm.Solution.join([first, second])
    way = joined["b.x"]
    at = np.searchsorted(joined.t, 2.0)
    assert joined.energy.input[at] == pytest.approx(2.0 * way[at])
    assert joined.energy.input[-1] == pytest.approx(2.0 * way[at] + 4.0 * (way[-1] - way[at]))
    assert np.abs(joined.energy.residual).max() < 1e-9
    joined.save(tmp_path / "run.npz")
    assert fm.Solution.load(tmp_path / "run.npz").at([3.0]).energy.input[0] == pytest.approx(joined.energy.input[-1])


def test_torque_of_a_motor_is_input_and_weight_is_stored():
    """A drum with a torque of 3 J/rad, beside a body that falls: 0.5 m v^2 = m g h."""
    drum = fm.RigidBody("drum", mass=1.0, inertia=0.5)
    stone, motor = fm.Body("stone", mass=2.0, axes="y"), fm.Torque("motor", drum, value=3.0)
    scene = fm.Scene("drum", [drum, fm.Revolute("pin", drum), motor, stone, fm.Gravity("g")])
    sol = fm.simulate(scene, t_end=2.0, rtol=1e-9)
    assert sol.energy.input == pytest.approx(3.0 * sol["drum.angle"], abs=1e-7)
    assert sol["drum.angle"][-1] == pytest.approx(0.5 * 6.0 * 4.0)
    fall = 0.5 * 9.81 * 4.0
    assert sol.energy.potential[-1] - sol.energy.potential[0] == pytest.approx(-2.0 * 9.81 * fall)
    assert np.abs(sol.energy.residual).max() < 1e-8


@pytest.mark.parametrize("kind", ["ball", "rotor"])
def test_torque_in_space_is_input(kind):
    """0.4 J/rad about an axis of inertia 0.2 for one second: 1 rad."""
    if kind == "ball":
        body = fm.space.Ball("b", mass=1.0, radius=0.5, inertia=0.2)
    else:
        body = fm.space.Rotor("b", mass=1.0, inertia_across=0.1, inertia_axial=0.2)
    sol = fm.simulate(fm.Scene("spun", [body, fm.space.Torque("T", body, axis=(0, 0, 1), value=0.4)]), t_end=1.0)
    assert sol.energy.input[-1] == pytest.approx(0.4)
    assert sol.energy.kinetic[-1] == pytest.approx(0.4)
    assert np.all(sol.energy.potential == 0.0)


def test_force_linear_in_a_coordinate_is_input_like_any_other():
    """-4 x on a body that starts at 1: what it does in a quarter period is the kinetic energy there."""
    body = fm.Body("b", mass=1.0, position={"x": 1.0})
    field = fm.Force("F", body, axis="x", value=-4.0 * fm.coordinate("b.x"))
    sol = fm.simulate(fm.Scene("field", [body, field]), t_end=np.pi / 4, rtol=1e-10)
    assert sol.energy.input[-1] == pytest.approx(2.0)
    assert sol.energy.kinetic[-1] == pytest.approx(2.0)
    assert np.abs(sol.energy.residual).max() < 1e-9
