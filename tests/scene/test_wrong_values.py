"""Values of declarations that numpy or Python itself would stumble over are named like all others."""

import numpy as np
import pytest

import fricmb as fm

LAW = fm.laws.Coulomb(mu_s=0.5)
BODY = fm.Body("b", mass=1.0, axes="xy")
SCALAR = np.array(1.0)
PAIR = np.array([0.0, 1.0])
BALL = fm.space.Ball("ball", mass=1.0, radius=0.5, position=(0, 0, 0.5))


@pytest.mark.parametrize(("make", "named"), [
    (lambda: fm.Spring("s", BODY, axis=SCALAR, stiffness=1.0), "axis must be"),
    (lambda: fm.Contact("c", BODY, law=LAW, normal_force=1.0, axes=SCALAR), "axes must be"),
    (lambda: fm.Contact("c", BODY, law=LAW, normal_force=1.0, slide=SCALAR), "slide must be"),
    (lambda: fm.RigidBody("r", mass=1.0, inertia=1.0, position=SCALAR), "position must be"),
    (lambda: fm.Scene("s", SCALAR), "parts must be a list"),
    (lambda: fm.ModalBody("m", frequencies=[1.0], damping_ratios=[[1, 2], [3]], shapes={"a": [[1]]}), "damping_ratios"),
    (lambda: fm.laws.Iwan(stiffness=3.0, limits=(1.0,)), "stiffness must be"),
    (lambda: fm.laws.Coulomb(mu_s=[[1, 2], [3]]), "mu_s must be"),
    (lambda: fm.space.kalker(a=None, b=1.0, shear_modulus=1.0, poisson=0.3), "a must be a finite number > 0, got None"),
    (lambda: fm.space.kalker(a=1.0, b=1.0, shear_modulus=1.0, poisson="x"), "poisson must be from"),
    (lambda: fm.space.turned(axis=(0, 0, 1), angle=10**400), "angle must be a finite number"),
    (lambda: fm.space.ground_point(10**400, 0, 0), "x must be a finite number"),
    (lambda: fm.space.OnPlane("p", BALL, normal=(0, 0, 1), when_lost=PAIR), "when_lost must be 'end' or 'open'"),
    (lambda: fm.space.OnPlane("p", BALL, normal=(0, 0, 1), shape=PAIR), "shape must be left out"),
    (lambda: fm.Spring("s", np.zeros((2, 3)), axis="x", stiffness=1.0), "a must be a Body"),
    (lambda: fm.Body(10**400, mass=1.0), "name must be a non-empty string"),
    (lambda: fm.Scene("s", [BODY]).equations(joint_coordinates=PAIR), "joint_coordinates must be True or False"),
])  # fmt: skip
def test_it_is_named_in_one_line(make, named):
    with pytest.raises(fm.FricmbError, match=named) as raised:
        make()
    assert "\n" not in str(raised.value)
    assert len(str(raised.value)) < 400


@pytest.mark.parametrize(("given", "named"), [
    ({"dense": np.zeros(2)}, "dense: got .*; expected True, False or None"),
    ({"progress": np.zeros(2)}, "progress: got .*; expected True or False"),
    ({"observe": SCALAR}, "observe: got .*; expected a list of names"),
    ({"sensitivities": SCALAR}, "sensitivities: got .*; expected names"),
    ({"initial": np.zeros((2, 3))}, "initial: got .*; expected a Solution"),
    ({"method": 10**400}, "method: got a value of type int|method: got 1000"),
])  # fmt: skip
def test_an_argument_of_a_run_is_named_in_one_line(given, named):
    with pytest.raises(fm.FricmbError, match=named) as raised:
        fm.simulate(fm.models.belt_oscillator(), t_end=1.0, **given)
    assert "\n" not in str(raised.value)


def test_arguments_of_results_are_named():
    sol = fm.simulate(fm.models.belt_oscillator(), t_end=1.0)
    for call, named in (
        (lambda: sol.audit(rtol="x"), "audit: rtol: got 'x'"),
        (lambda: sol.audit(atol="x"), "atol: got 'x'"),
        (lambda: sol.audit(seed=-1), "audit: seed: got -1"),
        (lambda: sol.time_share("sole", []), r"mode: got \[\]; expected 0 \(stick\)"),
        (lambda: fm.Solution.join(SCALAR), "expected a list of solutions"),
    ):
        with pytest.raises(fm.FricmbError, match=named):
            call()


def test_an_audit_takes_one_error_a_degree_of_freedom():
    sol = fm.simulate(fm.models.brake4dof(2), t_end=2.0)
    each = np.array([1.0, 1e-9, 1e-9, 1.0])
    assert sol.audit(atol=each).table() == sol.audit(atol=np.tile(each, 2)).table() != sol.audit(atol=1e-9).table()


@pytest.mark.filterwarnings("error")
def test_single_precision_is_no_overflow():
    x = np.float32(0.25)
    assert fm.ground_point(x, x).x == 0.25
