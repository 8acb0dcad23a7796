"""What a law gives way under a load that set-valued friction would hold."""

from __future__ import annotations

from typing import Any

import numpy as np

from fricmb.analysis._paths import pull
from fricmb.errors import LawError, shown
from fricmb.laws import Creep
from fricmb.values import as_float


def creep(law: Any, load: float = 0.5) -> Creep:
    """See :meth:`fricmb.FrictionLaw.creep`."""
    if not 0.0 < as_float(load) < 1.0:
        raise LawError(f"{law._label()}: load must be between 0 and 1, got {shown(load)}")
    if law.kind != "smooth":
        return Creep(load=load, break_away=law.break_away(), velocity=0.0, displacement=0.0)
    if law.states:
        pulled = pull(law)
        force = -pulled.force
        most = float(force.max())
        first = int(np.argmax(force >= load * most))
        low, high = max(first - 1, 0), max(first, 1)
        distance = np.interp(load * most, force[[low, high]], pulled.displacement[[low, high]])
        return Creep(load=load, break_away=most, velocity=0.0, displacement=float(distance))
    most, velocity = _rising(law, load)
    return Creep(load=load, break_away=most, velocity=velocity, displacement=0.0)


def _rising(law: Any, load: float) -> tuple[float, float]:
    """Largest coefficient without the viscous rise, and the speed on the way to it at a share of it."""
    from scipy.optimize import brentq

    speeds = np.logspace(-15, 6, 2101)
    mu = np.asarray(law.coefficient(speeds))
    # the first maximum; where there is none, the shoulder: where a tenfold speed brings less than a percent
    falls = np.flatnonzero((np.diff(mu) < 0.0) & (mu[1:] > 0.0))
    level = np.flatnonzero((mu[100:] <= 1.01 * mu[:-100]) & (mu[:-100] > 0.0))
    top = int(next((i[0] for i in (falls, level) if len(i)), len(mu) - 1))
    most = float(mu[top])
    at = int(np.argmax(mu >= load * most))
    if at == 0:
        return most, 0.0
    root = brentq(lambda x: float(law.coefficient(10.0**x)) - load * most, *np.log10(speeds[at - 1 : at + 1]))
    return most, float(10.0**root)
