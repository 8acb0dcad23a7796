"""Contacts that are at rest without sticking: joints of a mechanism that others hold."""

from __future__ import annotations

import numpy as np

from fricmb.integrate import Samples
from fricmb.integrate.problem import Floats

#: A relative velocity below this share of the contact's largest is none: rest, not a passage through 0.
STILL = 1e-10
#: The mode of a contact that slips, and as what one at rest counts that does not stick.
_SLIP = 1


def rest_spans(samples: Samples, rows: slice, contact: int) -> Floats:
    """Stretches (n, 2) between accepted steps in which a contact neither sticks nor moves."""
    speed = np.sqrt((samples.g[rows] ** 2).sum(axis=0))
    still = (speed <= STILL * speed.max(initial=0.0)) & (samples.mode[contact] == _SLIP)
    loss = samples.friction_loss[contact]
    quiet = np.diff(loss) <= STILL * loss.max(initial=0.0)  # else it moved in between, from one reversal to the next
    both = still[:-1] & still[1:] & quiet & (np.diff(samples.t) > 0.0)
    return np.column_stack((samples.t[:-1][both], samples.t[1:][both]))
