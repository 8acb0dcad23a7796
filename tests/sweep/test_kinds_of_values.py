"""For every kind of parameter: a run that takes over all it can equals that of a scene made from nothing."""

import pickle
from itertools import pairwise

import numpy as np
import pytest

import fricmb as fm
from tests.sweep.test_other_values import forget, outcome

M = fm.models
STRIBECK = fm.laws.HyperbolicStribeck(mu_s=1.2, mu_k=1.0, delta=1.0)
DRY = fm.laws.Coulomb(mu_s=0.2, mu_k=0.1)

BRAKE = {
    "start": "rotor.velocity.x", "position": "pad.position.x", "stiffness": "k1x.stiffness", "damping": "c1x.damping",
    "coefficient": "lining.law.mu_s", "load": "lining.normal_force", "mass": "pad.mass",
}  # fmt: skip
SCENES = {
    "brake": (lambda: M.brake4dof(5), BRAKE, 12.0),
    "stribeck": (lambda: M.brake4dof(5, law=STRIBECK), BRAKE, 6.0),
    "chain": (lambda: M.stick_slip_chain(10, damping=0.1), {
        "start": "block1.velocity.x", "belt": "belt.velocity.x", "stiffness": "ground3.stiffness",
        "coupling": "coupling4.stiffness", "damping": "damper2.damping", "coefficient": "sole4.law.mu_s",
        "load": "sole4.normal_force", "mass": "block5.mass",
    }, 12.0),
    "slider crank": (lambda: M.slider_crank(friction=DRY, gravity=9.81, torque=1.0), {
        "start": "slider.position.x", "angle": "crank.angle", "mass": "slider.mass", "inertia": "rod.inertia",
        "coefficient": "guide.friction.mu_k", "radius": "bearing.radius", "load": "motor.value",
        "gravity": "gravity.acceleration.y",
    }, 0.01),
}  # fmt: skip
CASES = [(name, kind) for name, (_, kinds, _) in SCENES.items() for kind in kinds]


def states(run):
    """Motion, forces and transitions."""
    sol = run()
    return [x.tobytes() for x in (sol.t, sol.q, sol.v, sol.record.samples.F)], [(e.t, e.kind) for e in sol.events]


@pytest.mark.parametrize(("name", "kind"), CASES)
def test_a_new_value_is_seen_in_all_that_it_reaches(name, kind):
    make, kinds, t_end = SCENES[name]
    scene, key = make(), kinds[kind]
    value = scene.parameters[key] or 0.01
    fm.simulate(scene, t_end=t_end)
    near = [{key: value * (1.0 + 0.01 * i)} for i in range(1, 4)]
    found = [states(lambda v=v: fm.simulate(scene, t_end=t_end, parameters=v)) for v in near]
    assert len({repr(one) for one in found}) == len(near)
    for values, one in zip(near, found, strict=True):
        forget()
        anew = pickle.loads(pickle.dumps(make().with_parameters(values)))
        assert one == states(lambda s=anew: fm.simulate(s, t_end=t_end)), values


@pytest.mark.parametrize("name", SCENES)
def test_values_of_several_kinds_one_after_another(name):
    """What one value left must not serve where another one comes back."""
    make, kinds, t_end = SCENES[name]
    scene = make()
    parameters = scene.parameters
    order = [{key: (parameters[key] or 0.01) * 1.03} for key in kinds.values()]
    pairs = [{**one, **other} for one, other in pairwise(order)]
    for values in (*pairs, {}, *order):
        found = outcome(lambda v=values: fm.simulate(scene, t_end=t_end, parameters=v))
        forget()
        anew = pickle.loads(pickle.dumps(make().with_parameters(values)))
        assert found == outcome(lambda s=anew: fm.simulate(s, t_end=t_end)), values


def test_a_coefficient_leaves_the_weights_by_step_size_and_a_stiffness_makes_them_anew():
    forget()
    scene = M.brake4dof(2)
    made = [fm.simulate(scene, t_end=60.0, parameters=v).stats.n_lu for v in (
        {}, {"lining.law.mu_s": 1.1}, {"lining.normal_force": 14.0}, {"k1x.stiffness": 1.1},
    )]  # fmt: skip
    assert made[0] > 5
    assert max(made[1:3]) < made[0] / 2
    assert made[3] >= made[0] / 2


def test_a_sweep_in_one_process_gives_what_single_runs_give():
    scene = M.brake4dof(2)
    runs = [{"pad.mass": 1.0 + 0.01 * i} for i in range(4)]
    swept = fm.sweep(scene, runs, t_end=20.0, workers=1, progress=False)
    for values, sol in zip(runs, swept, strict=True):
        alone = fm.simulate(M.brake4dof(2).with_parameters(values), t_end=20.0)
        np.testing.assert_array_equal(sol.q, alone.q)
