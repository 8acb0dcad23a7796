"""Frequencies in hertz, where angular frequencies are meant."""

from __future__ import annotations

from math import tau
from typing import Any

import numpy as np


class Hertz(float):
    """2 pi, which a frequency in hertz is multiplied by; a list or array of them as well."""

    def __rmul__(self, other: Any) -> Any:
        return np.multiply(other, float(self)) if isinstance(other, list | tuple) else other * float(self)

    def __mul__(self, other: Any) -> Any:
        return self.__rmul__(other) if isinstance(other, list | tuple) else float(self) * other

    def __repr__(self) -> str:
        return "fm.Hz"


#: ``50 * fm.Hz`` is the angular frequency of 50 turns in a unit of time.
Hz = Hertz(tau)
