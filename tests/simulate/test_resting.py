"""What rests beside what moves is laid out when it is asked for."""

import pickle

import numpy as np
import pytest

import fricmb as fm
from fricmb.integrate.run.spread_motion import SpreadMotion


def scene(idle):
    moving = fm.Body("m", mass=1.0, velocity={"x": 1.0})
    parts = [fm.Body(f"b{i}", mass=1.0 + i) for i in range(idle)]
    parts += [fm.Spring(f"s{i}", part, axis="x", stiffness=2.0) for i, part in enumerate(parts) if i % 2]
    rub = fm.Contact("rub", moving, law=fm.laws.Coulomb(mu_s=0.2), normal_force=1.0)
    return fm.Scene("s", [*parts, moving, fm.Spring("s", moving, axis="x", stiffness=4.0), rub])


TIMES = np.linspace(0.0, 5.0, 51)


def test_values_are_those_of_what_moves_alone_and_rest():
    alone = fm.simulate(scene(0), t_end=5.0, t_eval=TIMES, initial={"position": {"m.x": 0.5}})
    sol = fm.simulate(scene(6), t_end=5.0, t_eval=TIMES, initial={"position": {"m.x": 0.5, "b0.x": 3.0}})
    assert isinstance(sol.record.samples, SpreadMotion)
    assert "q" not in vars(sol.record.samples)
    np.testing.assert_array_equal(sol["m.x"], alone["m.x"])
    np.testing.assert_array_equal(sol.velocity("m.x"), alone.velocity("m.x"))
    np.testing.assert_array_equal(sol["b0.x"], 3.0)
    others = [k for k, name in enumerate(sol.dof_names) if name not in ("m.x", "b0.x")]
    assert not sol.q[others].any()
    assert not sol.v[[*others, sol.dof_names.index("b0.x")]].any()
    assert sol.q is sol.q
    np.testing.assert_array_equal(sol.energy.friction_loss, alone.energy.friction_loss)


@pytest.mark.parametrize("read", [False, True])
def test_a_solution_pickles_before_and_after_it_was_read(read):
    sol = fm.simulate(scene(3), t_end=5.0, t_eval=TIMES)
    q = sol.q.copy() if read else None
    again = pickle.loads(pickle.dumps(sol))
    np.testing.assert_array_equal(again.q, sol.q if q is None else q)
    np.testing.assert_array_equal(again.v, sol.v)
    np.testing.assert_array_equal(again.force("rub"), sol.force("rub"))


def test_other_names_are_none_of_it():
    samples = fm.simulate(scene(3), t_end=5.0, t_eval=TIMES).record.samples
    with pytest.raises(AttributeError, match="SpreadMotion"):
        _ = samples.a
