"""The four-degree-of-freedom brake: a pad on springs against a turning rotor."""

from __future__ import annotations

import math
from types import MappingProxyType

import fricmb as fm
from fricmb.errors import shown
from fricmb.values import DIMENSIONLESS, as_float

from ._arguments import Own, checked

#: Case -> (Omega1, Omega2, delta).
CASES = MappingProxyType(
    {
        "1": (1.0, 1.0, 0.0),
        "2": (10 * math.sqrt(math.pi / 2), math.sqrt(5 / 2) / 100, 0.0),
        "3": (2 * math.sqrt(5), 5 * math.sqrt(2), 0.0),
        "3b": (10 * math.sqrt(math.pi / 2), 10 * math.sqrt(5 / 2), 0.0),
        "4": (10 * math.sqrt(math.pi / 2), 5 * math.sqrt(2), 0.0),
        "5": (10 * math.sqrt(math.pi / 2), math.sqrt(5 / 2) / 100, 0.01),
    }
)


@checked
def brake4dof(
    case: str | int = "1",
    *,
    Omega1: float | None = None,
    Omega2: float | None = None,
    delta: float | None = None,
    mu_k_N: float = 15.0,
    mu_s_N: float | None = None,
    mass_ratio: Own = 1000.0,
    u0: float = 10.0,
    v0: float = 0.01,
    law: fm.FrictionLaw | None = None,
) -> fm.Scene:
    """Disc brake with four degrees of freedom: a pad on springs rubs in the plane on a slowing rotor.

    Dimensionless: mass in pad masses, time in 1/omega1 (the pad's frequency along x), so k1x = 1.

    Parameters
    ----------
    case : {"1", "2", "3", "3b", "4", "5"}
        Frequencies and damping of the source; an int will do.
    Omega1, Omega2 : float, optional
        Frequencies of pad and rotor along y over omega1; default: those of the case.
    delta : float, optional
        Damping, c1x = c1y = delta and c2y = delta mass_ratio; default: that of the case.
    mu_k_N, mu_s_N : float
        Friction force in slip and at break-away; ``mu_s_N`` defaults to ``mu_k_N``.  The normal force is ``mu_k_N``,
        the coefficients are 1 and ``mu_s_N/mu_k_N``.
    mass_ratio : float
        Rotor mass over pad mass.
    u0, v0 : float
        Initial velocity of the rotor along x and y.
    law : FrictionLaw, optional
        Another friction law; the normal force stays ``mu_k_N``.

    Returns
    -------
    Scene
        Bodies pad and rotor; dofs pad.x, pad.y, rotor.x, rotor.y; contact "lining".

    Notes
    -----
    B. Kinkaid, O. O'Reilly, P. Papadopoulos, On the transient dynamics of a multi-degree-of-freedom friction
    oscillator: a new mechanism for disc brake noise, J. Sound and Vibration 287 (2005) 901-917.  The mass ratio and
    the length of the run (700) are not given there; those used here were found by comparing spectra.
    """
    name = str(case)
    if name not in CASES:
        raise fm.SceneError(f"brake4dof: case must be one of {', '.join(CASES)}; got {shown(case)}")
    if law is not None and mu_s_N is not None:
        raise fm.SceneError("brake4dof: mu_s_N belongs to the built-in Coulomb law; with law= leave it out")
    if not 0.0 < as_float(mass_ratio) < math.inf:
        raise fm.SceneError(f"brake4dof: mass_ratio must be a finite number > 0, got {shown(mass_ratio)}")
    Omega1, Omega2, delta = (
        given if given is not None else default
        for given, default in zip((Omega1, Omega2, delta), CASES[name], strict=True)
    )
    if law is None:
        law = fm.laws.Coulomb(mu_s=(mu_k_N if mu_s_N is None else mu_s_N) / mu_k_N if mu_k_N else 1.0, mu_k=1.0)
    pad = fm.Body("pad", mass=1.0, axes="xy")
    rotor = fm.Body("rotor", mass=mass_ratio, axes="xy", velocity={"x": u0, "y": v0})
    return fm.Scene(
        f"brake4dof case {name}",
        [
            pad,
            rotor,
            fm.Spring("k1x", pad, axis="x", stiffness=1.0),
            fm.Spring("k1y", pad, axis="y", stiffness=Omega1**2),
            fm.Spring("k2y", rotor, axis="y", stiffness=mass_ratio * Omega2**2),
            fm.Damper("c1x", pad, axis="x", damping=delta),
            fm.Damper("c1y", pad, axis="y", damping=delta),
            fm.Damper("c2y", rotor, axis="y", damping=mass_ratio * delta),
            fm.Contact("lining", pad, rotor, law=law, normal_force=mu_k_N),
        ],
        units=DIMENSIONLESS,
    )
