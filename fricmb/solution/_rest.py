"""Contacts that are at rest without sticking: joints of a mechanism that others hold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fricmb.integrate import Samples
from fricmb.integrate.problem import Ints

#: A relative velocity below this share of the contact's largest is none: rest, not a passage through 0.
STILL = 1e-10
#: The mode of a contact that slips, and as what one at rest counts that does not stick.
_SLIP = 1


def resting(samples: Samples, row: Ints) -> NDArray[np.bool_]:
    """Which contacts (n_c,) neither stick nor move between which accepted steps (n_t - 1,); ``row``: first rows."""
    speed = np.sqrt(np.add.reduceat(samples.g**2, row[:-1], axis=0)) if len(row) > 1 else np.zeros(samples.mode.shape)
    still = (speed <= STILL * speed.max(axis=1, initial=0.0, keepdims=True)) & (samples.mode == _SLIP)
    loss = samples.friction_loss
    # else it moved in between, from one reversal to the next
    quiet = np.diff(loss) <= STILL * loss.max(axis=1, initial=0.0, keepdims=True)
    found: NDArray[np.bool_] = still[:, :-1] & still[:, 1:] & quiet & (np.diff(samples.t) > 0.0)
    return found
