"""A mass on a spring that rubs on the ground, free or driven by a harmonic force."""

from __future__ import annotations

import fricmb as fm
from fricmb.values import DIMENSIONLESS

from ._arguments import checked


@checked
def friction_oscillator(
    *,
    mass: float = 1.0,
    stiffness: float = 1.0,
    damping: float = 0.0,
    friction: float = 0.1,
    amplitude: float = 0.0,
    frequency: float = 1.0,
    x0: float | None = None,
    v0: float = 0.0,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Oscillator with Coulomb friction against the ground, free or under a harmonic force.

    ``m x'' + c x' + k x + friction sign(x') = amplitude cos(frequency t)``; any consistent units, dimensionless by
    default (m = k = 1).

    Parameters
    ----------
    mass, stiffness, damping : float
        Of the oscillator.
    friction : float
        Friction force: the normal force of a contact whose Coulomb coefficient is 1.
    amplitude, frequency : float
        Of the driving force; with amplitude 0 the oscillator is free and no force is declared.
    x0, v0 : float
        Initial position and velocity; ``x0`` defaults to 1 for the free oscillator, to 0 for the driven one.
    law : FrictionLaw, optional
        Another law, acted on by the normal force ``friction``.

    Returns
    -------
    Scene
        Dof mass.x; contact "sole"; driven: force "drive" with the parameters "amplitude" and "frequency".

    Notes
    -----
    Free: rests at ``(-1)^k (x0 - 2 k friction/stiffness)`` after k half cycles.  Driven: J. P. Den Hartog, Forced
    vibrations with combined Coulomb and viscous friction, Trans. ASME 53 (1931) 107-115.
    """
    start = x0 if x0 is not None else (0.0 if amplitude else 1.0)
    body = fm.Body("mass", mass=mass, axes="x", position={"x": start}, velocity={"x": v0})
    forces = []
    omega = fm.parameter("frequency", frequency)  # refused by name also where nothing drives
    if amplitude:
        import sympy  # a free oscillator does without

        drive = fm.parameter("amplitude", amplitude) * sympy.cos(omega * fm.t)
        forces.append(fm.Force("drive", body, axis="x", value=drive))
    return fm.Scene(
        "friction oscillator",
        [
            body,
            fm.Spring("spring", body, axis="x", stiffness=stiffness),
            fm.Damper("damper", body, axis="x", damping=damping),
            fm.Contact("sole", body, law=law or fm.laws.Coulomb(mu_s=1.0), normal_force=friction),
            *forces,
        ],
        units=DIMENSIONLESS,
    )
