"""The toy woodpecker on its pole."""

from __future__ import annotations

import math
from operator import mul
from typing import TypeAlias

import fricmb as fm
from fricmb.values import SI

from ._arguments import check_positive, checked

# Of the toy, as in the literature: radii of the pole and of the sleeve's hole, half the sleeve's height, places of the
# spring's foot, the bird's centre of mass and its beak.
POLE, HOLE, HALF_HEIGHT = 0.0025, 0.0031, 0.0058
FOOT, CENTRE, BEAK_HEIGHT, BEAK = 0.010, 0.015, 0.02, 0.0201


@checked
def woodpecker(
    *,
    mass: float = 4.5e-3,
    inertia: float = 7e-7,
    sleeve_mass: float = 3e-4,
    sleeve_inertia: float = 5e-9,
    stiffness: float = 0.0056,
    mu: float = 0.3,
    restitution: float = 0.5,
    angle: float = -0.2,
    rate: float = 17.0,
    gravity: float = 9.81,
) -> fm.Scene:
    """Woodpecker toy: it pecks its way down a pole, held by friction and let go by impacts, in a steady cycle.

    SI units.

    Parameters
    ----------
    mass, inertia : float
        Of the bird about its centre of mass.
    sleeve_mass, sleeve_inertia : float
        Of the sleeve that carries it.
    stiffness : float
        Of the spring between them, torque per angle.
    mu : float
        Coefficient of friction of all contacts.
    restitution : float
        Of the beak, from 0 to 1; the sleeve's edges do not bounce.
    angle, rate : float
        Of the bird at the start, towards the pole; the sleeve's lower edge is on the pole.
    gravity : float

    Returns
    -------
    Scene
        Modal body bird with points low, high (edges of the sleeve), beak, sleeve and centre, x towards the pole;
        contacts low, high, beak.

    Notes
    -----
    C. Glocker, Dynamik von Starrkorpersystemen mit Reibung und Stossen, VDI 1995; R. I. Leine, C. Glocker, D. H. van
    Campen, Nonlinear dynamics and modeling of various wooden toys with impact and friction, J. Vib. Control 9 (2003)
    25-78.  Height and both angles are small, kinematics linear: two rigid modes, and one of the spring.  The default
    values, those of the literature, have a cycle of 0.1460 s in which it drops 19.4 mm; a deviation is multiplied by
    -0.84 each period.
    """
    check_positive("woodpecker", mass=mass, inertia=inertia, sleeve_mass=sleeve_mass, sleeve_inertia=sleeve_inertia)
    check_positive("woodpecker", stiffness=stiffness)
    inertias = mass, inertia, sleeve_mass, sleeve_inertia
    modes = _modes(*inertias)
    masses = [_inner(a, a, *inertias) for a in modes]
    lean = -(HOLE - POLE) / HALF_HEIGHT
    bird = fm.ModalBody(
        "bird",
        frequencies=[0.0, 0.0, math.sqrt(stiffness / masses[2])],
        damping_ratios=0.0,
        masses=masses,
        shapes={
            name: [[sum(map(mul, row, a)) for a in modes] for row in rows] for name, rows in _POINTS.items()
        },
        axes="xy",
        position=_shares(modes, lean, angle),
        velocity=_shares(modes, 0.0, rate),
    )
    law = fm.laws.Coulomb(mu_s=mu)
    return fm.Scene(
        "woodpecker",
        [
            bird,
            _edge("low", bird, HOLE - POLE, 0.0, law),
            _edge("high", bird, HOLE - POLE, 0.0, law),
            _edge("beak", bird, FOOT + CENTRE - BEAK - POLE, restitution, law),
            fm.Force("weight of the sleeve", bird.point("sleeve"), axis="y", value=-sleeve_mass * gravity),
            fm.Force("weight of the bird", bird.point("centre"), axis="y", value=-mass * gravity),
        ],
        units=SI,
    )


#: Way towards the pole and height of points, of (height, angle of the sleeve, angle of the bird).
_POINTS = {
    "low": ((0.0, -HALF_HEIGHT, 0.0), (1.0, HOLE, 0.0)),
    "high": ((0.0, HALF_HEIGHT, 0.0), (1.0, HOLE, 0.0)),
    "beak": ((0.0, 0.0, BEAK_HEIGHT), (1.0, FOOT, CENTRE - BEAK)),
    "sleeve": ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
    "centre": ((0.0, 0.0, 0.0), (1.0, FOOT, CENTRE)),
}
Three: TypeAlias = tuple[float, float, float]


def _inner(a: Three, b: Three, mass: float, inertia: float, sleeve_mass: float, sleeve_inertia: float) -> float:
    """Of the mass matrix of (height, angle of the sleeve, angle of the bird)."""
    height = [x[0] + FOOT * x[1] + CENTRE * x[2] for x in (a, b)]
    moving = sleeve_mass * a[0] * b[0] + mass * height[0] * height[1]
    return moving + sleeve_inertia * a[1] * b[1] + inertia * a[2] * b[2]


def _modes(mass: float, inertia: float, sleeve_mass: float, sleeve_inertia: float) -> tuple[Three, Three, Three]:
    """Both move down; both turn, about what stays at rest; they turn against each other, without any momentum."""
    part = mass / (mass + sleeve_mass)
    arm, left = FOOT + CENTRE, mass * (1.0 - part) * (FOOT + CENTRE)
    sleeve, bird = sleeve_inertia + left * FOOT, inertia + left * CENTRE
    b, c = -bird / (sleeve + bird), sleeve / (sleeve + bird)
    return (1.0, 0.0, 0.0), (-part * arm, 1.0, 1.0), (-part * (FOOT * b + CENTRE * c), b, c)


def _shares(modes: tuple[Three, Three, Three], sleeve: float, bird: float) -> dict[str, float]:
    """Modal coordinates of both angles at height 0."""
    _, turn, bend = modes
    third = bird - sleeve
    second = sleeve - third * bend[1]
    return {"mode1": -second * turn[0] - third * bend[0], "mode2": second, "mode3": third}


def _edge(name: str, bird: fm.ModalBody, gap: float, restitution: float, law: fm.FrictionLaw) -> fm.RollerOnLine:
    """A contact with the pole, which is ``gap`` away; the free side is at smaller x."""
    return fm.RollerOnLine(
        name, bird.point(name), fm.ground_point(gap, 0.0), angle=math.pi / 2.0, push_only=True,
        restitution=restitution, friction=law,
    )  # fmt: skip
