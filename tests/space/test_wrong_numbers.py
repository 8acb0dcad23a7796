"""Arguments of bodies and joints in space that are no numbers or no words: each is named, with what is accepted."""

import numpy as np
import pytest

import fricmb as fm

SPACE = fm.space
DISC = SPACE.Rotor("disc", mass=1.0, inertia_across=0.1, inertia_axial=0.2, axis=(0, 1, 0), stations={"left": 0.5})
BALL = SPACE.Ball("ball", mass=1.0, radius=0.1, position=(0, 0, 1))
DRY = fm.laws.Coulomb(mu_s=0.4)


def rail(**given):
    """A wheel on a rail."""
    return SPACE.WheelRail("rail", DISC.station("left"), through=(0, 0.5, -0.4), rolling_radius=0.4, **given)


def pad(**given):
    """A pad."""
    known = {"at": (0.1, 0, 0), "normal": (0, 1, 0), "preload": 1.0, "stiffness": 1.0, "friction": DRY}
    return SPACE.Pad("pad", DISC, **(known | given))


def rod(**given):
    """A rod in space."""
    return SPACE.Rod("rod", BALL, SPACE.ground_point(0, 0, 0), **given)


def floor(**given):
    """A plane."""
    return SPACE.OnPlane("floor", BALL, normal=(0, 0, 1), friction=DRY, **given)


def tube(**given):
    """A tube."""
    return SPACE.InCylinder("tube", BALL, axis=(1, 0, 0), radius=1.0, **given)


def ball_joint(**given):
    """A dry ball joint."""
    return SPACE.Spherical("hook", DISC, radius=0.1, friction=DRY, **given)


@pytest.mark.parametrize("value", [None, "wide", (1.0, 2.0), [], {}, object(), 1j, True, np.zeros(3), float("nan")])
@pytest.mark.parametrize(
    ("make", "argument"), [(rail, "conicity"), (pad, "preload"), (pad, "stiffness"), (rod, "length")]
)
def test_what_is_no_number_is_refused_by_name(make, argument, value):
    with pytest.raises(fm.SceneError, match=rf"{argument} must be a finite number"):
        make(**{argument: value})


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (floor, "when_lost"), (tube, "when_lost"), (floor, "shape"), (pad, "turning"), (ball_joint, "turning"),
        (rail, "end"),
    ],
)
def test_what_is_no_word_is_refused_by_name(make, argument):
    for value in (np.zeros(3), "sideways", 3):
        with pytest.raises(fm.SceneError, match=rf"{argument} must be "):
            make(**{argument: value})


@pytest.mark.parametrize("argument", ["a", "b", "shear_modulus", "poisson"])
@pytest.mark.parametrize("value", [None, "thick", (1.0, 2.0), 1j, np.zeros(3), float("nan")])
def test_kalkers_coefficients_name_what_is_no_number(argument, value):
    with pytest.raises(fm.SceneError, match=rf"kalker: {argument} must be "):
        SPACE.kalker(**({"a": 1.0, "b": 1.0, "shear_modulus": 1.0, "poisson": 0.3} | {argument: value}))


@pytest.mark.parametrize("law", [SPACE.LinearCreep, SPACE.ShenHedrickElkins, SPACE.Polach])
def test_laws_of_creepage_take_one_number_each(law):
    given = {"f11": 1.0, "f22": 1.0, "speed": 1.0} | ({} if law is SPACE.LinearCreep else {"mu": 0.3})
    for argument in given:
        with pytest.raises(fm.LawError, match=rf"{argument} must be a finite number"):
            law(**(given | {argument: (1.0, 2.0)}))
