"""Models name an argument that cannot be, its value and what is accepted."""

import inspect

import numpy as np
import pytest

import fricmb as fm

WRONG = (
    None, "x", [], {}, np.nan, np.inf, 1j, np.zeros((2, 3)), np.ones(2), object(), [None], [[1, 2], [3]], b"x",
    10**400, True, -1.0, 0, fm.parameter("q", 1.0), fm.t,
)  # fmt: skip


@pytest.mark.parametrize("name", sorted(fm.models.catalogue))
def test_a_wrong_argument_is_an_error_of_our_own(name):
    build = fm.models.catalogue[name].build
    said = []
    for argument in inspect.signature(build).parameters:
        for wrong in WRONG:
            try:
                build(**{argument: wrong})
            except fm.FricmbError as error:
                said.append((argument, str(error)))
    assert len(said) > 8
    assert [text for argument, text in said if "\n" in text or len(text) > 400] == []


@pytest.mark.parametrize(("name", "given", "text"), [
    ("brake4dof", {"Omega1": "x"}, "brake4dof: Omega1 must be a finite number or None; got 'x'"),
    ("brake4dof", {"mu_k_N": []}, r"brake4dof: mu_k_N must be a finite number; got \[\]"),
    ("belt_oscillator", {"law": 0.5}, "belt_oscillator: law must be a friction law, such as .* or None; got 0.5"),
    ("planar_oscillator", {"stiffness": 1.0}, "planar_oscillator: stiffness must be two finite numbers; got 1.0"),
    ("stick_slip_chain", {"n": True}, "stick_slip_chain: n must be an integer; got True"),
    ("stick_slip_chain", {"laws": 3}, "stick_slip_chain: laws must be a list of friction laws or None; got 3"),
    ("minimal_flutter", {"mu": fm.parameter("q", 0.5)}, "minimal_flutter: mu must be a plain number"),
    ("slider_crank", {"rod": 0.0}, "slider_crank: rod must be longer than"),
    ("drive_train", {"ratio": 0.0}, "drive_train: ratio must be a finite number other than 0; got 0"),
    ("turntable", {"radius": 0.0}, "turntable: radius must be a finite number > 0; got 0"),
    ("pad_rotor", {"modes": 3}, "pad_rotor: modes must be a PadRotorModes; got 3"),
    ("pad_rotor", {"n_contacts": 10**400}, "pad_rotor: n_contacts must be an integer from 1 to 1000000"),
])  # fmt: skip
def test_what_a_model_cannot_take_is_named(name, given, text):
    with pytest.raises(fm.SceneError, match=text):
        fm.models.catalogue[name].build(**given)


def test_numbers_of_numpy_named_parameters_and_expressions_are_taken():
    scene = fm.models.belt_oscillator(stiffness=np.float32(0.5), damping=fm.parameter("c", 0.1), normal_force=1 + fm.t)
    assert scene.parameters["spring.stiffness"] == 0.5
    assert scene.parameters["c"] == 0.1


@pytest.mark.filterwarnings("error")
def test_a_parameter_of_single_precision_is_no_overflow():
    assert fm.parameter("q", np.float32(0.25)).value == 0.25
