"""Kalker's coefficients of rolling contact, by the shape of the ellipse of contact and Poisson's ratio."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from fricmb._calls import answers
from fricmb.errors import SceneError, shown
from fricmb.values import as_float

#: Ratios a/b of the table: a along the direction of rolling.
RATIOS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1 / 0.9, 1 / 0.8, 1 / 0.7, 1 / 0.6, 2.0, 2.5, 1 / 0.3, 5.0,
          10.0)  # fmt: skip
#: Poisson's ratios of the table.
POISSON = (0.0, 0.25, 0.5)
#: For each ratio: C11, C22, C23 and C33, each for the three Poisson's ratios.  J. J. Kalker, On the rolling contact of
#: two elastic bodies in the presence of dry friction, thesis, Delft 1967.
TABLE = (
    (2.51, 3.31, 4.85, 2.51, 2.52, 2.53, 0.334, 0.473, 0.731, 6.42, 8.28, 11.7),
    (2.59, 3.37, 4.81, 2.59, 2.63, 2.66, 0.483, 0.603, 0.809, 3.46, 4.27, 5.66),
    (2.68, 3.44, 4.80, 2.68, 2.75, 2.81, 0.607, 0.715, 0.889, 2.49, 2.96, 3.72),
    (2.78, 3.53, 4.82, 2.78, 2.88, 2.98, 0.720, 0.823, 0.977, 2.02, 2.32, 2.77),
    (2.88, 3.62, 4.83, 2.88, 3.01, 3.14, 0.827, 0.929, 1.07, 1.74, 1.93, 2.22),
    (2.98, 3.72, 4.91, 2.98, 3.14, 3.31, 0.930, 1.03, 1.18, 1.56, 1.68, 1.86),
    (3.09, 3.81, 4.97, 3.09, 3.28, 3.48, 1.03, 1.14, 1.29, 1.43, 1.50, 1.60),
    (3.19, 3.91, 5.05, 3.19, 3.41, 3.65, 1.13, 1.25, 1.40, 1.34, 1.37, 1.42),
    (3.29, 4.01, 5.12, 3.29, 3.54, 3.82, 1.23, 1.36, 1.51, 1.27, 1.27, 1.27),
    (3.40, 4.12, 5.20, 3.40, 3.67, 3.98, 1.33, 1.47, 1.63, 1.21, 1.19, 1.16),
    (3.51, 4.22, 5.30, 3.51, 3.81, 4.16, 1.44, 1.59, 1.77, 1.16, 1.11, 1.06),
    (3.65, 4.36, 5.42, 3.65, 3.99, 4.39, 1.58, 1.75, 1.94, 1.10, 1.04, 0.954),
    (3.82, 4.54, 5.58, 3.82, 4.21, 4.67, 1.76, 1.95, 2.18, 1.05, 0.965, 0.852),
    (4.06, 4.78, 5.80, 4.06, 4.50, 5.04, 2.01, 2.23, 2.50, 1.01, 0.892, 0.751),
    (4.37, 5.10, 6.11, 4.37, 4.90, 5.56, 2.35, 2.62, 2.96, 0.958, 0.819, 0.650),
    (4.84, 5.57, 6.57, 4.84, 5.48, 6.31, 2.88, 3.24, 3.70, 0.912, 0.747, 0.549),
    (5.57, 6.34, 7.34, 5.57, 6.40, 7.51, 3.79, 4.32, 5.01, 0.868, 0.674, 0.446),
    (6.96, 7.78, 8.82, 6.96, 8.14, 9.79, 5.72, 6.63, 7.89, 0.828, 0.601, 0.341),
    (10.7, 11.7, 12.9, 10.7, 12.8, 16.0, 12.2, 14.6, 18.0, 0.795, 0.526, 0.228),
)


@dataclass(frozen=True, kw_only=True)
class KalkerCoefficients:
    """Coefficients of the linear theory; made by :func:`kalker`.

    Attributes
    ----------
    c11, c22, c23, c33 : float
        Without dimension: along the direction of rolling, across, across by spin, moment by spin.
    f11, f22 : float
        ``G a b c11`` and ``G a b c22``: force per creepage.
    f23, f33 : float
        ``G (a b)^(3/2) c23`` and ``G (a b)^2 c33``: force and moment per spin creepage (1/length).
    """

    c11: float
    c22: float
    c23: float
    c33: float
    f11: float
    f22: float
    f23: float
    f33: float


@answers
def kalker(*, a: float, b: float, shear_modulus: float, poisson: float) -> KalkerCoefficients:
    """Kalker's coefficients of an ellipse of contact, both bodies of one material.

    Parameters
    ----------
    a, b : float
        Half axes of the ellipse, along the direction of rolling and across; a/b from 0.1 to 10.
    shear_modulus : float
        > 0.
    poisson : float
        From 0 to 0.5.

    Returns
    -------
    KalkerCoefficients

    Raises
    ------
    SceneError
        If a value is outside what the table covers.

    Notes
    -----
    Kalker's table of 1967 has two to three digits.  Between its entries a cubic that keeps monotony over log(a/b),
    and the parabola through three values of Poisson's ratio.

    Examples
    --------
    >>> import fricmb as fm
    >>> found = fm.space.kalker(a=6e-3, b=6e-3, shear_modulus=8e10, poisson=0.25)
    >>> round(found.c11, 6), round(found.f22)
    (4.12, 10569600)
    """
    from scipy.interpolate import PchipInterpolator

    for name, value in (("a", a), ("b", b), ("shear_modulus", shear_modulus)):
        if not 0.0 < as_float(value) < math.inf:
            raise SceneError(f"kalker: {name} must be a finite number > 0, got {shown(value)}")
    if not RATIOS[0] <= a / b <= RATIOS[-1]:
        raise SceneError(f"kalker: a/b must be from {RATIOS[0]:g} to {RATIOS[-1]:g}, got {a / b:g}")
    if not POISSON[0] <= as_float(poisson) <= POISSON[-1]:
        raise SceneError(f"kalker: poisson must be from {POISSON[0]:g} to {POISSON[-1]:g}, got {shown(poisson)}")
    rows = PchipInterpolator(np.log(RATIOS), np.array(TABLE))(math.log(a / b)).reshape(4, 3)
    c11, c22, c23, c33 = (float(np.polyval(np.polyfit(POISSON, row, 2), poisson)) for row in rows)
    G, area = shear_modulus, a * b
    return KalkerCoefficients(
        c11=c11, c22=c22, c23=c23, c33=c33,
        f11=G * area * c11, f22=G * area * c22, f23=G * area**1.5 * c23, f33=G * area**2 * c33,
    )  # fmt: skip
